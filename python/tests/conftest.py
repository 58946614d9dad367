"""What the tests share: the package as it is installed, and the program to hold it against."""

import os
import subprocess
from pathlib import Path

import pytest

import fjr
from fjr._files import program as own_program

ROOT = Path(__file__).resolve().parents[2]
REACH = ROOT / "config" / "requests" / "reach.yaml"


@pytest.fixture(scope="session")
def program():
    """The fjr of the build tree, where FJR_PROGRAM names it; otherwise the package's own."""
    return Path(os.environ.get("FJR_PROGRAM") or own_program()).resolve()


@pytest.fixture(scope="session")
def reach():
    return fjr.plan(REACH)


@pytest.fixture(scope="session")
def reach_files(program, tmp_path_factory):
    """The folder that `fjr plan` makes of the same request."""
    folder = tmp_path_factory.mktemp("program") / "reach"
    subprocess.run([program, "plan", REACH, "--out", folder, "--report"], check=True, capture_output=True)
    return folder
