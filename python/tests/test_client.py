"""fjr.Client, against a service and an executor of the program: scripts/test_python.sh gives them their own network."""

import contextlib
import os
import subprocess
import time

import numpy as np
import pytest

import fjr
from conftest import REACH, ROOT

DOMAIN = 71
REQUEST = {"start": {"q": [0, 0]}, "goal": {"q": [0.4, -0.3]}}


@contextlib.contextmanager
def running(*command, log, **environment):
    environment = {**os.environ, **environment}
    with open(log, "w") as out, subprocess.Popen(command, stdout=out, stderr=subprocess.STDOUT, env=environment) as process:
        try:
            yield process
        finally:
            process.terminate()
            process.wait(timeout=30)


@pytest.fixture(scope="module")
def client(program, tmp_path_factory):
    folder = tmp_path_factory.mktemp("client")
    service = running(program, "serve", "--domain", str(DOMAIN), log=folder / "serve.log")
    words = ("--domain", str(DOMAIN), "--state", folder / "state", "--logs", folder)
    executor = running(program, "executor", *words, log=folder / "executor.log")
    with service, executor:
        client = fjr.Client(domain=DOMAIN, find=20)
        for _ in range(40):  # they start within a second or two where the machine is not busy
            seen = client.overview(0.5)
            if seen.services and seen.executors:
                break
        yield client


def test_who_is_there(client):
    seen = client.overview()
    assert [service["answers"] for service in seen.services] == [True]
    assert seen.executors[0]["mode"] == "resting" and np.allclose(seen.executors[0]["q"], 0, atol=1e-4)
    assert seen.services[0]["robot_hash"] == seen.executors[0]["robot_hash"] == fjr.Robot.load().hash


def test_the_service_plans_what_fjr_plans(client, reach):
    plan = client.plan(REACH)
    assert plan.certified and len(plan.trajectory_id.split("-")) == 2 and plan.solve_time > 0
    for name in ("time", "q", "dq", "theta", "dtheta", "tau"):
        assert np.array_equal(getattr(plan, name), getattr(reach, name)), name
    assert plan.robot == reach.robot and plan.name == "reach"


def test_it_is_executed_and_followed(client):
    """Control ticks are real time: on a busy machine an execution may be stopped for missed ones, as it should be."""
    for _ in range(3):
        q = client.overview(0.5).executors[0]["q"]
        goal = [0.4, -0.3] if abs(q[0]) < 0.2 else [0, 0]
        followed = []
        plan, done = client.plan_and_execute(
            {"goal": {"q": goal}, "duration": 1}, follow=lambda progress: followed.append(progress.time)
        )
        if done:
            break
        time.sleep(1)
    assert done.successful and done.code == 0 and done.name == "SUCCESSFUL"
    assert max(done.link_error) < 0.01 and max(done.feedback_torque) > 0
    assert len(set(followed)) > 5 and max(followed) <= plan.duration + 1
    assert np.allclose(client.overview(0.5).executors[0]["q"], goal, atol=1e-3)


def test_who_no_longer_follows_has_the_arm_brought_to_rest(client):
    goal = [0.9, -0.6]
    request = {"goal": {"q": goal}, "duration": 3, "search": "quick"}
    plan, done = client.plan_and_execute(request, follow=lambda told: told.time < 0.3)
    assert plan.certified and not done.successful and done.sentence
    arm = client.overview(0.5).executors[0]
    assert arm["mode"] in ("holding", "resting") and not np.allclose(arm["q"], goal, atol=1e-3)


def test_what_was_planned_before_is_executed(client):
    """Tried again where the ticks of a busy machine were missed."""
    for _ in range(3):
        q = client.overview(0.5).executors[0]["q"]
        goal = [0.4, -0.3] if abs(q[0]) < 0.2 else [0, 0]
        plan = client.plan({"goal": {"q": goal}, "duration": 1}, priority=3, budget=30)
        done = client.execute(plan)
        if done:
            break
        time.sleep(1)
    assert done.successful and np.allclose(client.overview(0.5).executors[0]["q"], goal, atol=1e-3)


def test_a_motion_is_repeated_and_learnt(client):
    """Tried again where the ticks of a busy machine were missed."""
    for _ in range(3):
        q = client.overview(0.5).executors[0]["q"]
        via = [q[0] + (0.2 if q[0] < 0.3 else -0.2), q[1] + 0.1]
        request = {"start": {"q": q}, "via": [{"q": via}], "goal": {"q": q}, "duration": 1, "search": "quick"}
        plan, done = client.plan_and_execute(request)
        if done:
            break
        time.sleep(1)
    assert done.successful and "repetition" not in plan.to_dict()
    for number in (2, 3):
        time.sleep(0.5)
        repeated, done = client.repeat(plan)
        learnt = repeated.to_dict()["repetition"]
        assert done.successful, done.sentence
        assert learnt["number"] == number and learnt["motion"] == plan.trajectory_id
        assert repeated.trajectory_id != plan.trajectory_id and repeated.duration == plan.duration
    with pytest.raises(fjr.Refused, match="NO_TRAJECTORY|not among the requests"):
        client.repeat("0" * 32 + "-7")


def test_what_was_planned_before_is_not_executed_from_elsewhere(client):
    plan = client.plan({"start": {"q": [1, 0.5]}, "goal": {"q": [0.4, -0.3]}})
    done = client.execute(plan)
    assert not done and done.name == "INVALID_GOAL" and "starts at q1 = 1 rad" in done.sentence
    with pytest.raises(fjr.BadInput, match="hexadecimal"):
        client.execute("nothing")


def test_errors_are_those_of_plan(client):
    with pytest.raises(fjr.BadInput) as caught:
        client.plan({**REQUEST, "goal": {"q": [1.2, -9]}})
    assert (caught.value.field, caught.value.value) == ("goal.q[1]", -9)


def test_a_listener_cancels(client):
    long = {
        "start": {"q": [0, 0]},
        "goal": {"q": [2.8, -0.8]},
        "duration": 15,
        "objective": "efficient",
        "search": "thorough",
    }
    with pytest.raises((fjr.Cancelled, fjr.Refused), match="(?i)cancelled"):
        client.plan(long, progress=lambda told: told.progress.iteration < 5)


def test_the_arm_that_is_named(client):
    assert fjr.Client(domain=DOMAIN, robot_id="arm", find=20).plan(REQUEST).certified
    with pytest.raises(fjr.Refused, match="other"):
        fjr.Client(domain=DOMAIN, robot_id="other", find=20).plan(REQUEST)


def test_credentials_are_needed_where_the_service_has_some(program, tmp_path):
    folder, domain = tmp_path / "security", DOMAIN + 2
    subprocess.run([ROOT / "config/security/make_credentials.sh", folder], check=True, capture_output=True)
    service = running(
        program, "serve", "--domain", str(domain), log=tmp_path / "serve.log", FJR_SECURITY=str(folder / "service")
    )
    with service:
        known = fjr.Client(domain=domain, security=folder / "client", find=20)
        assert known.plan(REQUEST).certified
        assert [seen["answers"] for seen in known.overview(2).services] == [True]
        stranger = fjr.Client(domain=domain, find=1)
        assert stranger.overview(1).services == []
        with pytest.raises(fjr.NoAnswer):
            stranger.plan(REQUEST)


def test_nobody_there():
    with pytest.raises(fjr.NoAnswer, match="nobody serves"):
        fjr.Client(domain=DOMAIN + 1, find=0.5).plan(REQUEST)
