"""Figures, the program of the package, and the example for mypy."""

import subprocess
import sys

import pytest

import example
import fjr


def test_figures_show_the_plan(reach):
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    figure = reach.plot()
    torques = figure.axes[3].lines[0]
    assert (torques.get_ydata() == reach.tau[:, 0]).all() and (torques.get_xdata() == reach.time).all()
    error = fjr.simulate(reach).plot().axes[1].lines[0]
    assert abs(error.get_ydata()).max() <= fjr.simulate(reach).max_link_error


def test_the_example_runs(capsys):
    example.main()
    assert "certified: True" in capsys.readouterr().out


def test_the_package_brings_the_program(tmp_path):
    said = subprocess.run(
        [sys.executable, "-m", "fjr", "--version"], capture_output=True, text=True, check=True, cwd=tmp_path
    )
    assert fjr.__version__ in said.stdout
    keys = subprocess.run(
        [sys.executable, "-m", "fjr", "keys"], capture_output=True, text=True, check=True, cwd=tmp_path
    )
    assert all(f"`{key.name}`" in keys.stdout for key in fjr.keys())
