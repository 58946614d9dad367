"""fjr.Robot."""

import pytest

import fjr
from conftest import ROOT


def test_the_shipped_robot_is_found_from_anywhere(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("FJR_CONFIG_DIR", raising=False)
    robot = fjr.Robot.load()
    assert robot == fjr.Robot.load(ROOT / "config" / "robot.yaml")
    assert robot["limits"]["torque"] == [12, 5]
    monkeypatch.setenv("FJR_CONFIG_DIR", str(tmp_path))
    with pytest.raises(fjr.BadInput, match="not in FJR_CONFIG_DIR"):
        fjr.Robot.load()


def test_values_go_round():
    robot = fjr.Robot.load()
    assert fjr.Robot.from_dict(robot.to_dict()) == robot
    loaded = robot.replace(payload=0.1)
    assert loaded["payload"] == {"mass": 0.1, "inertia": 0} and loaded != robot


def test_an_arm_is_mounted_otherwise():
    robot = fjr.Robot.load()
    table = robot.replace(mounting={"inclination": 0})
    assert fjr.Robot.from_dict(table.to_dict()) == table != robot
    still = fjr.plan({"start": {"q": [0.5, 0.3]}, "goal": {"q": [0.9, 0.1]}}, robot=table)
    assert abs(still.theta - still.q)[0].max() < 1e-12  # no gravity deflects the springs
    softer = table.replace(spring={"stiffness": [20, 17.5]})
    assert softer["mounting"] == {"inclination": 0, "down": 0}
    assert softer.replace(mounting={}) == robot.replace(spring={"stiffness": [20, 17.5]})
    with pytest.raises(fjr.BadInput, match="30 degrees are 0.523599 rad"):
        robot.replace(mounting={"inclination": 30})


def test_what_cannot_be_is_refused_with_its_field():
    robot = fjr.Robot.load()
    with pytest.raises(fjr.BadInput) as caught:
        robot.replace(spring={"stiffness": [-1, 17.5]})
    assert caught.value.field == "spring.stiffness.value[0]"
    with pytest.raises(fjr.BadInput, match="unknown key"):
        robot.replace(spring={"stiffnes": [20, 17.5]})
    with pytest.raises(fjr.BadInput, match="not finite"):
        robot.replace(payload=float("nan"))
    with pytest.raises(KeyError):
        robot.replace(sprung={"stiffness": [20, 17.5]})


def test_a_robot_decides_the_plan():
    request = {"start": {"q": [0, 0]}, "goal": {"q": [0.4, -0.3]}}
    robot = fjr.Robot.load()
    weaker = robot.replace(limits={"torque": [9, 4]})
    assert fjr.plan(request, robot=weaker).duration > fjr.plan(request, robot=robot).duration
    assert fjr.plan(request, robot=weaker).robot == weaker
    with pytest.raises(fjr.BadInput, match="the robot is given already"):
        fjr.plan({**request, "robot": "robot.yaml"}, robot=robot)
