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


def test_limits_are_drawn_around_the_middle_of_a_range():
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    robot = fjr.Robot.load().replace(limits={"link_position": [1.2, 1.5], "link_middle": [0.4, -0.5]})
    plan = fjr.plan({"start": {"q": [0, 0]}, "goal": {"q": [1.2, -0.8]}}, robot=robot)
    positions = plan.plot().axes[0].lines
    drawn = sorted(line.get_ydata()[0] for line in positions if line.get_linestyle() == ":")
    assert drawn == pytest.approx([-2, -0.8, 1, 1.6])  # of both joints, lowest and highest


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
