"""fjr.batch and fjr.identify."""

import signal
import subprocess
import sys
import textwrap

import numpy as np
import pytest

import fjr
from conftest import REACH


def test_a_batch_has_the_plans_of_its_requests(reach, tmp_path):
    requests = {
        "near": {"start": {"q": [0, 0]}, "goal": {"q": [0.4, -0.3]}},
        "far": fjr.Request(start=fjr.Start(q=(0, 0)), goal=fjr.Goal(q=(1.2, -0.8))),
        "beyond": {"start": {"q": [0, 0]}, "goal": {"q": [1.2, -9]}},
    }
    done = fjr.batch(requests, out=tmp_path, jobs=2)
    assert list(done) == ["beyond", "far", "near"] and len(done) == 3
    assert done.statuses == {"certified": 2, "bad_input": 1}
    assert np.array_equal(done["far"].tau, reach.tau)
    assert done.to_dict()["planned"] == 2
    again = fjr.batch(requests, out=tmp_path)
    assert again.to_dict()["planned"] == 0 and again.to_dict()["finished_earlier"] == 2
    with pytest.raises(KeyError):
        done["nowhere"]
    with pytest.raises(fjr.BadInput, match="refused"):
        done["beyond"]
    assert done.to_pandas().loc["near", "status"] == "certified"


def test_files_are_planned_too(tmp_path):
    assert fjr.batch([REACH], out=tmp_path).statuses == {"certified": 1}
    with pytest.raises(fjr.Error):
        fjr.batch([], out=tmp_path)
    with pytest.raises(ValueError, match="no name"):
        fjr.batch({"../up": {}}, out=tmp_path)
    with pytest.raises(TypeError, match="as a list of paths"):
        fjr.batch({"reach": REACH}, out=tmp_path / "named")


def test_files_are_planned_whatever_their_names(tmp_path, monkeypatch):
    """A folder may have the name of a subcommand of ``fjr batch``, a file that of an option."""
    monkeypatch.chdir(tmp_path)
    request = "start: {q: [0.3, 0.2]}\ngoal: {q: [0.3, 0.21]}\nsample_period: 0.005\n"
    (tmp_path / "status").mkdir()
    (tmp_path / "status" / "near.yaml").write_text(request)
    (tmp_path / "--json.yaml").write_text(request)
    assert fjr.batch(["./status"], out="folder").statuses == {"certified": 1}
    assert fjr.batch(["--json.yaml"], out="file").statuses == {"certified": 1}


def test_a_packed_batch_is_read_where_it_is(reach, program, tmp_path):
    grid = tmp_path / "grid.yaml"
    grid.write_text("request: {start: {q: [0, 0]}, goal: {q: [1.2, -0.8]}}\naxes: {seed: [1]}\n")
    folder = tmp_path / "out"
    subprocess.run([program, "batch", "prepare", grid, "--out", folder], check=True, capture_output=True)
    batch = fjr.PackedBatch(folder)
    assert list(batch) == ["grid_1"] and len(batch) == 1
    with pytest.raises(KeyError):
        batch["grid_1"]
    with pytest.raises(fjr.BadInput, match="gather"):
        batch.statuses  # noqa: B018
    subprocess.run([program, "batch", "run", folder, "--quiet"], check=True, capture_output=True)
    assert batch.statuses == {"certified": 1}
    assert np.array_equal(batch["grid_1"].tau, reach.tau)
    assert batch.plan_json("grid_1")["duration"] == batch.rows[0]["duration"] == reach.duration
    assert batch.to_pandas().loc["grid_1", "axes.seed"] == 1
    with pytest.raises(KeyError):
        batch["nowhere"]
    with pytest.raises(fjr.BadInput, match="no packed batch"):
        fjr.PackedBatch(tmp_path)


def test_ctrl_c_ends_a_batch(tmp_path):
    script = textwrap.dedent(f"""
        import fjr, signal, sys
        signal.signal(signal.SIGINT, signal.default_int_handler)  # ignored where the tests run in the background
        request = {{"start": {{"q": [0, 0]}}, "goal": {{"q": [2.8, -0.8]}}, "duration": 15, "objective": "efficient",
                   "search": "thorough"}}
        try:
            fjr.batch({{"long": request}}, out={str(tmp_path)!r}, jobs=1)
        except KeyboardInterrupt:
            sys.exit(7)
    """)
    process = subprocess.Popen([sys.executable, "-c", script])
    try:
        process.wait(timeout=3)  # it takes minutes
    except subprocess.TimeoutExpired:
        process.send_signal(signal.SIGINT)
    assert process.wait(timeout=60) == 7


@pytest.fixture(scope="module")
def logs(program, tmp_path_factory):
    folder = tmp_path_factory.mktemp("logs")
    for joint in (1, 2):
        subprocess.run(
            [
                program,
                "experiment",
                "stiffness",
                "--joint",
                str(joint),
                "--ideal",
                "--out",
                folder / f"stiffness_{joint}.csv",
            ],
            check=True,
            capture_output=True,
        )
    return folder


def test_identification_finds_the_stiffness_of_an_ideal_rig(logs, tmp_path):
    found = fjr.identify("stiffness", [logs / "stiffness_1.csv", logs / "stiffness_2.csv"])
    known = fjr.Robot.load()["spring"]["stiffness"]
    for joint, estimate in enumerate(found.estimates):
        stiffness = estimate.parameters[0]
        assert estimate.joint == joint + 1 and stiffness.unit == "N m/rad"
        # Without noise, but with torques to 12 digits and no more.
        assert stiffness.value == pytest.approx(known[joint], rel=1e-3)
        assert estimate.covariance.shape == (len(estimate.parameters),) * 2
        assert estimate[stiffness.name] == stiffness
    robot = found.write(tmp_path / "robot.yaml")
    assert robot["spring"]["stiffness"] == pytest.approx(known, rel=1e-3)
    assert fjr.Robot.load(tmp_path / "robot.yaml") == robot
    assert found.report().startswith("<!DOCTYPE html>") or "<html" in found.report()


def test_logs_that_are_none_are_refused(logs, tmp_path):
    with pytest.raises(fjr.BadInput):
        fjr.identify("gravity", logs / "stiffness_1.csv")
    with pytest.raises(ValueError, match="none of all"):
        fjr.identify("stifness", logs / "stiffness_1.csv")
    with pytest.raises(fjr.BadInput):
        fjr.identify("all", tmp_path)
