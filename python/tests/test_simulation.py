"""fjr.simulate and fjr.verify."""

import dataclasses

import numpy as np
import pytest

import fjr


def test_a_simulation_is_what_the_certificate_saw(reach):
    """The same integrator, started alike, stopped at the same instants: the same numbers."""
    for closed_loop, part in ((False, "open_loop"), (True, "closed_loop")):
        run = fjr.simulate(reach, closed_loop=closed_loop)
        seen = reach.certificate[part]
        assert run.completed and run.failure == ""
        assert run.max_link_error == pytest.approx(seen["max_link_error_rad"], rel=1e-6)
        worst = np.unravel_index(np.abs(run.link_error).argmax(), run.link_error.shape)[0]
        assert run.time[worst] == pytest.approx(seen["time_of_max_link_error"], abs=1e-9)
        assert np.abs(run.link_error[-1]).max() == pytest.approx(seen["final_link_error_rad"], rel=1e-6)


def test_without_feedback_the_planned_torque_is_commanded(reach):
    run = fjr.simulate(reach, closed_loop=False)
    assert np.array_equal(run.tau, reach.interpolate(run.time).tau)
    closed = fjr.simulate(reach)
    feedback = np.abs(closed.tau - reach.interpolate(closed.time).tau).max(axis=0)
    # The certificate looks at the ends of the integrator's steps, too.
    assert (feedback > 0).all()
    assert (feedback <= np.array(reach.certificate["closed_loop"]["max_feedback_torque"]) * (1 + 1e-9)).all()


def test_energy_goes_where_physics_says(reach):
    """An independent balance: work of the motors = energy of the arm + friction's heat, by the paper."""
    run = fjr.simulate(reach, closed_loop=False)
    robot = reach.robot.to_dict()
    link, spring, motor, friction = (robot[name] for name in ("link", "spring", "motor", "friction"))

    def law(j, v):
        f, eta, omega, h = (friction[name][j] for name in ("amplitude", "width", "second_weight", "second_shape"))
        return friction["viscous"][j] * v + f * np.tanh(v / eta) - f * omega * np.tanh(v / eta - h * np.tanh(v / eta))

    def energy(row):
        q, dq, theta, dtheta = run.q[row], run.dq[row], run.theta[row], run.dtheta[row]
        coupling = link["com_fraction"][1] * link["mass"][1] * link["length"][0] * link["length"][1]
        m22 = link["inertia"][1] + link["mass"][1] * (link["com_fraction"][1] * link["length"][1]) ** 2
        m11 = link["inertia"][0] + link["mass"][1] * link["length"][0] ** 2 + m22 + 2 * coupling * np.cos(q[1])
        m12 = m22 + coupling * np.cos(q[1])
        kinetic = 0.5 * (m11 * dq[0] ** 2 + 2 * m12 * dq[0] * dq[1] + m22 * dq[1] ** 2)
        kinetic += 0.5 * np.dot(motor["inertia"], dtheta**2)
        gravity = link["gravity_torque"]
        potential = gravity[0] * (1 - np.cos(q[0])) + gravity[1] * (1 - np.cos(q[0] + q[1]))
        return kinetic + potential + 0.5 * np.dot(spring["stiffness"], (theta - q) ** 2)

    power = sum((run.tau[:, j] - law(j, run.dtheta[:, j])) * run.dtheta[:, j] for j in range(2))
    work = np.trapezoid(power, run.time)
    # Samples 0.25 ms apart, friction's steps between them: the trapezoid rule is off by 1e-3 of the work or so.
    assert work == pytest.approx(energy(-1) - energy(0), rel=5e-3)


def test_the_executor_holds_its_torque_for_ticks(reach):
    run = fjr.simulate(reach, executor=True)
    assert np.allclose(np.diff(run.time)[:-1], 0.001, rtol=0, atol=1e-12)
    predicted = reach.certificate["tracking"]
    assert np.abs(run.tau[1:]).max(axis=0) == pytest.approx(predicted["peak_torque"], rel=1e-9)
    with pytest.raises(ValueError, match="closed loop"):
        fjr.simulate(reach, closed_loop=False, executor=True)


def test_an_arm_is_held_after_the_end(reach):
    run = fjr.simulate(reach, hold=0.5)
    assert run.completed
    assert run.time[-1] == pytest.approx(reach.duration + 0.5, abs=1e-9)
    assert (run.residual < 9.59e-5).all()  # as every certificate has it for a second
    softer = reach.robot.replace(friction={"viscous": [0.52, 0.53]})
    assert (fjr.simulate(reach, true_robot=softer, hold=0.5).residual > run.residual).all()
    for wrong in ({"hold": -1}, {"hold": 11}, {"hold": 1, "closed_loop": False}):
        with pytest.raises(ValueError, match="held"):
            fjr.simulate(reach, **wrong)


def test_a_run_that_broke_down_says_why_it_has_no_residual(reach):
    run = fjr.simulate(reach)
    columns = {name: getattr(run, name)[:20] for name in ("time", "q", "dq", "theta", "dtheta", "tau")}
    broken = dataclasses.replace(run, **columns, completed=False, failure="the steps became too small")
    with pytest.raises(ValueError, match="broke down at .* s, before the end .*: the steps became too small"):
        broken.residual  # noqa: B018
    assert broken.max_link_error <= run.max_link_error


def test_another_arm_leaves_the_plan_and_feedback_brings_it_back(reach):
    softer = reach.robot.replace(friction={"viscous": [0.52, 0.53]})
    open_loop = fjr.simulate(reach, closed_loop=False, true_robot=softer)
    closed = fjr.simulate(reach, true_robot=softer)
    assert open_loop.max_link_error > 10 * reach.certificate["open_loop"]["max_link_error_rad"]
    assert closed.max_link_error < 0.5 * open_loop.max_link_error


def test_verify_agrees_with_the_program(program, reach, reach_files):
    import json
    import subprocess

    said = subprocess.run(
        [program, "verify", reach_files / "trajectory.csv", "--json"], capture_output=True, check=True
    )
    for trajectory in (reach, reach_files / "trajectory.csv"):
        found = fjr.verify(trajectory)
        assert found and found.certified and found.failures == [] and found.contradictions == []
        assert found.to_dict() == json.loads(said.stdout)


def test_what_is_proven_agrees_with_what_is_computed(reach_files):
    short = fjr.plan({"start": {"q": [0, 0]}, "goal": {"q": [0.4, -0.3]}}, proven=True)
    assert short.certificate["proof"]["verdict"] == "proven"
    found = fjr.verify(short, proven=True)
    proof = found.to_dict()["proof"]
    assert found.certified and proof["verdict"] == "proven"
    # The integrator controls its error to 1e-8 a step (measured: 1.1e-8 here); the bound holds of the exact motion.
    assert max(proof["closed_loop"]["link_error_rad"]) == pytest.approx(found.max_link_error, abs=1e-7)
    assert fjr.verify(reach_files / "trajectory.csv").to_dict()["proof"] is None  # which takes longer


def test_verify_holds_a_plan_against_its_task_and_against_a_request(tmp_path):
    asked = {"start": {"q": [0, 0]}, "goal": {"q": [0.4, -0.3]}, "obstacles": [{"center": [0.085, -0.7], "radius": 0.02}]}
    plan = fjr.plan(asked)
    plan.save(tmp_path / "plan")
    wider = asked | {"obstacles": [{"center": [0.085, -0.7], "radius": 0.07}], "goal": {"q": [0.4, -0.31]}}
    for trajectory in (plan, tmp_path / "plan"):
        assert len(fjr.verify(trajectory).to_dict()["task"]) == 2  # both links
        assert fjr.verify(trajectory, request=asked).certified
        other = fjr.verify(trajectory, request=wider)
        assert any("obstacles[0] (link 2) is missed" in failure for failure in other.failures)
        assert "the last row is not the goal" in other.failures
    assert fjr.verify(tmp_path / "plan" / "trajectory.csv", request=asked).certified
    with pytest.raises(ValueError, match="the payload is the request's"):
        fjr.verify(plan, request=asked, payload=0.1)
    with pytest.raises(fjr.BadInput, match="goal.q"):
        fjr.verify(plan, request=asked | {"goal": {"q": [9, 0]}})


def test_verify_says_what_is_wrong(reach, reach_files, tmp_path):
    lines = (reach_files / "trajectory.csv").read_text().splitlines()
    short = tmp_path / "short.csv"
    short.write_text("\n".join(lines[:-5]) + "\n")
    found = fjr.verify(short)
    assert not found and any("rows" in failure for failure in found.failures)
    heavier = fjr.verify(reach, payload=0.3)
    assert not heavier.certified and any("payload" in sentence for sentence in heavier.contradictions)
    with pytest.raises(fjr.BadInput, match="no such file"):
        fjr.verify(tmp_path / "none.csv")
    (tmp_path / "bad.csv").write_text("time,q1\n0,0\n")
    with pytest.raises(fjr.BadInput):
        fjr.verify(tmp_path / "bad.csv")
