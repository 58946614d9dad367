"""fjr.plan and fjr.Plan."""

import gc
import json
import os
import signal
import subprocess
import sys
import textwrap
import threading
import time

import numpy as np
import pytest

import fjr
from conftest import REACH

REQUEST = {"start": {"q": [0, 0]}, "goal": {"q": [1.2, -0.8]}, "objective": "fastest"}
# Minutes of work: far more than a test waits for an interruption.
LONG = {
    "start": {"q": [0, 0]},
    "goal": {"q": [2.8, -0.8]},
    "duration": 15,
    "objective": "efficient",
    "search": "thorough",
}


def without_timing(document):
    return {key: value for key, value in document.items() if key != "timing"}


# ---- the same as the program ----


def test_saved_files_are_those_of_the_program(reach, reach_files, tmp_path):
    written = reach.save(tmp_path / "out", report=True)
    assert [os.path.basename(file) for file in written] == ["trajectory.csv", "plan.json", "report.html"]
    for name in ("trajectory.csv", "solution.cbor"):
        assert (tmp_path / "out" / name).read_bytes() == (reach_files / name).read_bytes(), name
    ours, theirs = (json.loads((folder / "plan.json").read_text()) for folder in (tmp_path / "out", reach_files))
    assert list(ours) == list(theirs) and without_timing(ours) == without_timing(theirs)


def test_the_report_is_that_of_the_program(program, reach_files):
    assert fjr.Plan.load(reach_files).report() == (reach_files / "report.html").read_text()


def test_mapping_dataclass_and_file_are_one_request(reach):
    mapping = fjr.plan(REQUEST, jobs=1)
    request = fjr.Request(start=fjr.Start(q=(0, 0)), goal=fjr.Goal(q=np.array([1.2, -0.8])), objective="fastest")
    classes = fjr.plan(request, jobs=2)
    assert mapping.to_dict()["request_hash"] == reach.to_dict()["request_hash"]
    for plan in (mapping, classes):
        for name in ("time", "q", "dq", "theta", "dtheta", "tau"):
            assert np.array_equal(getattr(plan, name), getattr(reach, name)), name


def test_dataclasses_have_the_keys_of_requests():
    import dataclasses

    keys = [key.name for key in fjr.keys()]

    def names(cls):
        return {field.name for field in dataclasses.fields(cls)}

    assert names(fjr.Request) == {key for key in keys if "." not in key}
    assert names(fjr.Start) == {key.split(".")[1] for key in keys if key.startswith("start.")}
    assert names(fjr.Goal) == {key.split(".")[1] for key in keys if key.startswith("goal.")}
    assert names(fjr.Via) == {key.split(".")[1] for key in keys if key.startswith("via[].")}
    assert names(fjr.Duration) == {key.split(".")[1] for key in keys if key.startswith("duration.")}


def test_a_loaded_plan_is_the_saved_one(reach, tmp_path):
    reach.save(tmp_path)
    again = fjr.Plan.load(tmp_path)
    assert again.to_dict() == reach.to_dict()
    assert np.array_equal(again.tau, reach.tau)
    again.save(tmp_path / "copy")
    assert (tmp_path / "copy" / "trajectory.csv").read_bytes() == (tmp_path / "trajectory.csv").read_bytes()


def test_a_warm_start_takes_fewer_iterations(reach, tmp_path):
    neighbour = {**REQUEST, "goal": {"q": [1.21, -0.8]}}
    cold, warm = fjr.plan(neighbour), fjr.plan(neighbour, warm=reach)
    assert warm.to_dict()["warm"]["used"]
    assert warm.to_dict()["solver"]["iterations"] < cold.to_dict()["solver"]["iterations"]
    reach.save(tmp_path)
    assert np.array_equal(fjr.plan(neighbour, warm=tmp_path).q, warm.q)


def test_a_warm_start_for_another_robot_is_refused(reach):
    softer = fjr.Robot.load().replace(spring={"stiffness": [20, 17.5]})
    with pytest.raises(fjr.BadInput, match="warm: is a plan for another robot"):
        fjr.plan(REQUEST, robot=softer, warm=reach)


# ---- arrays ----


def test_arrays_are_the_rows_of_the_file(reach, reach_files):
    rows = np.loadtxt(reach_files / "trajectory.csv", delimiter=",", comments="#", skiprows=8)
    ours = np.column_stack([reach.time, reach.q, reach.dq, reach.theta, reach.dtheta, reach.tau])
    assert np.array_equal(ours, rows)


def test_arrays_are_views_that_nobody_writes_to(reach):
    first, second = reach.q, reach.q
    assert first.__array_interface__["data"][0] == second.__array_interface__["data"][0]
    row = reach.time.strides[0]
    assert reach.dq.__array_interface__["data"][0] - first.__array_interface__["data"][0] == 2 * first.itemsize
    for array in (reach.time, reach.q, reach.tau):
        assert array.strides[0] == row and not array.flags.owndata
        with pytest.raises(ValueError):
            array[0] = 0
        with pytest.raises(ValueError):
            array.flags.writeable = True


def test_arrays_outlive_the_plan():
    plan = fjr.plan(REQUEST)
    others = sys.getrefcount(plan._core)
    tau = plan.tau
    assert sys.getrefcount(plan._core) > others
    expected, numbers = tau.copy(), 11 * len(plan)
    del plan
    gc.collect()
    rubbish = [np.full(numbers, 7.0) for _ in range(200)]  # of that size: what was freed would be overwritten
    assert np.array_equal(tau, expected) and len(rubbish) == 200


# ---- between the rows ----


def hermite(time, position, velocity, t):
    """Cubic Hermite in the usual basis: another way to write it than the library's. Returns position and velocity."""
    k = np.clip(np.searchsorted(time, t, side="right") - 1, 0, len(time) - 2)
    h = (time[k + 1] - time[k])[:, None]
    s = (t - time[k])[:, None] / h
    a, b, va, vb = position[k], position[k + 1], velocity[k], velocity[k + 1]
    at = (
        (2 * s**3 - 3 * s**2 + 1) * a
        + (s**3 - 2 * s**2 + s) * h * va
        + (3 * s**2 - 2 * s**3) * b
        + (s**3 - s**2) * h * vb
    )
    rate = (6 * s**2 - 6 * s) * (a - b) / h + (3 * s**2 - 4 * s + 1) * va + (3 * s**2 - 2 * s) * vb
    return at, rate


def test_interpolation_is_cubic_hermite_and_linear(reach):
    t = np.sort(np.random.default_rng(1).uniform(0, reach.duration, 5000))
    between = reach.interpolate(t)
    assert np.allclose(between.time, t, rtol=0, atol=1e-15)
    for name in ("q", "theta"):
        position, velocity = hermite(reach.time, getattr(reach, name), getattr(reach, "d" + name), t)
        # Positions of 1 rad in double precision; velocities divide their rounding by the shortest interval, 1e-6 s.
        assert np.allclose(getattr(between, name), position, rtol=0, atol=1e-14)
        assert np.allclose(getattr(between, "d" + name), velocity, rtol=0, atol=1e-8)
    for joint in range(2):
        # np.interp divides by intervals of 1e-6 s at a jump of the torque.
        assert np.allclose(between.tau[:, joint], np.interp(t, reach.time, reach.tau[:, joint]), rtol=0, atol=1e-9)


def test_rows_are_interpolated_to_themselves(reach):
    between = reach.interpolate(reach.time)
    for name in ("q", "theta", "tau"):
        assert np.array_equal(getattr(between, name), getattr(reach, name))


def test_times_outside_are_taken_to_the_ends(reach):
    ends = reach.interpolate([-1, 100])
    assert ends.time.tolist() == [0, reach.duration]
    assert np.array_equal(ends.q, reach.q[[0, -1]])
    with pytest.raises(ValueError, match="finite"):
        reach.interpolate([0.1, float("nan")])


@pytest.mark.parametrize("tick", [0.001, 0.004, 0.0173])
def test_mean_torques_have_the_integral_of_the_torque(reach, tick):
    means = reach.mean_torque(tick)
    assert len(means) == int(np.ceil(reach.duration / tick - 1e-9))
    # The last tick goes on beyond the end, where the torque is held.
    held = (len(means) * tick - reach.duration) * reach.tau[-1]
    assert np.allclose(means.sum(axis=0) * tick, np.trapezoid(reach.tau, reach.time, axis=0) + held, rtol=1e-12)


def test_mean_torque_of_a_tick_is_that_tick(reach):
    k, tick = 137, 0.001
    grid = np.unique(
        np.concatenate(
            [[k * tick, (k + 1) * tick], reach.time[(reach.time > k * tick) & (reach.time < (k + 1) * tick)]]
        )
    )
    expected = np.trapezoid(reach.interpolate(grid).tau, grid, axis=0) / tick
    assert np.allclose(reach.mean_torque(tick)[k], expected, rtol=1e-10)
    for bad in (0, -1, float("nan"), 1e-300, 0.99e-4, 0.101, float("inf")):
        with pytest.raises(ValueError, match="tick is 0.0001 to 0.1 s"):
            reach.mean_torque(bad)


# ---- what it says ----


def test_prices_are_those_of_plan_json(reach):
    prices = reach.prices
    assert prices and all(price.active_share > 0 for price in prices)
    assert [abs(p.saved_by_1_percent) for p in prices] == sorted(
        (abs(p.saved_by_1_percent) for p in prices), reverse=True
    )
    first = prices[0]
    assert first.saved_by_1_percent == pytest.approx(
        first.worth * first.limit / 100, rel=1e-4
    )  # five digits are written


def test_a_price_predicts_what_a_tighter_limit_costs(reach):
    price = next(p for p in reach.prices if p.name == "motor_velocity" and p.joint == 1)
    limits = {"motor_velocity": [0.99 * price.limit, 8]}
    tighter = fjr.plan({**REQUEST, "limits": limits}, warm=reach)  # on its mesh: another's accuracy costs as much
    # A difference over 1 % against a derivative; each plan keeps a little off its limits, which differs between plans.
    assert tighter.objective - reach.objective == pytest.approx(price.saved_by_1_percent, rel=0.25)


def test_representations(reach):
    assert repr(reach) == f"<fjr.Plan reach: certified, {reach.duration:.6g} s, objective {reach.objective:.6g}>"
    page = reach._repr_html_()
    assert page.startswith("<iframe srcdoc=") and "<canvas" not in page  # escaped, so that it stays within the frame


def test_pandas_table_has_the_columns_of_the_file(reach, reach_files):
    pandas = pytest.importorskip("pandas")
    table = reach.to_pandas()
    read = pandas.read_csv(reach_files / "trajectory.csv", comment="#", index_col="time")
    assert list(table.columns) == list(read.columns) and np.array_equal(table.to_numpy(), read.to_numpy())


# ---- errors ----


@pytest.mark.parametrize(
    ("change", "field", "value", "reason"),
    [
        ({"goal": {"q": [1.2, -9]}}, "goal.q[1]", -9, "-9 rad is outside [-2.6, 2.6]"),
        ({"sample_period": 1}, "sample_period", 1, "is outside"),
        ({"objective": "fast"}, "objective", "fast", "fastest"),
        ({"goal": {"q": [float("nan"), 0]}}, "goal.q[0]", None, "not a finite number"),
        ({"via": [{"q": [0.1, "x"]}]}, "via[0].q[1]", "x", "number"),
    ],
)
def test_bad_input_says_field_value_and_what_is_allowed(change, field, value, reason):
    with pytest.raises(fjr.BadInput) as caught:
        fjr.plan({**REQUEST, **change}, name="mine")
    error = caught.value
    assert error.source == "mine" and field.startswith(error.field.split("[")[0])
    assert reason in error.reason and error.allowed
    assert str(error).startswith(f"mine: {error.field}: ")
    if error.field == field and value is not None:
        assert error.value == value


def test_bad_input_of_a_file_has_its_value_too(tmp_path):
    file = tmp_path / "mine.yaml"
    file.write_text("start: {q: [0, 0]}\ngoal:\n  q: [1.2, -9.5]\n")
    with pytest.raises(fjr.BadInput) as caught:
        fjr.plan(file)
    assert (caught.value.source, caught.value.field, caught.value.value) == (str(file), "goal.q[1]", -9.5)
    with pytest.raises(fjr.BadInput, match="no such file"):
        fjr.plan(tmp_path / "none.yaml")
    with pytest.raises(TypeError, match="a request is"):
        fjr.plan(3)


@pytest.fixture(scope="module")
def infeasible():
    with pytest.raises(fjr.Infeasible) as caught:
        fjr.plan({**REQUEST, "duration": 0.3, "objective": "gentle"})
    return caught.value


def test_what_is_infeasible_says_what_would_do(infeasible):
    error = infeasible
    assert error.status == "infeasible" and error.plan.reason == error.reason
    assert error.infeasibility["limit"] == "duration"
    longer = fjr.plan({**REQUEST, "duration": {"max": 1.001 * error.infeasibility["shortest_duration"]}})
    assert longer.certified


def test_a_plan_without_a_motion_tells_why(infeasible, tmp_path):
    plan = infeasible.plan
    assert plan.status == "infeasible" and not plan.certified
    assert len(plan) == 0 and np.isnan(plan.duration) and plan.certificate == {} and plan.prices == []
    with pytest.raises(fjr.BadInput, match="has no trajectory"):
        plan.interpolate(0)
    assert [os.path.basename(name) for name in plan.save(tmp_path)] == ["plan.json"]


def test_a_deadline_that_is_too_short():
    assert fjr.plan(LONG, deadline=0.05, check=False).status == "deadline"
    with pytest.raises(fjr.DeadlineExpired):
        fjr.plan(LONG, deadline=0.05)
    with pytest.raises(ValueError, match="deadline"):
        fjr.plan(LONG, deadline=-1)


# ---- progress, cancellation, other threads ----


def test_progress_is_told_and_false_cancels():
    told = []

    def listen(progress):
        told.append((progress.stage, progress.iteration, progress.phase))
        return len(told) < 3

    with pytest.raises(fjr.Cancelled) as caught:
        fjr.plan(LONG, progress=listen)
    assert caught.value.plan.status == "cancelled"
    assert len(told) >= 3 and told[-1][1] > 0 and told[0][2] == "finding"


def test_what_a_listener_raises_ends_the_planning():
    def listen(progress):
        raise KeyError("mine")

    with pytest.raises(KeyError, match="mine"):
        fjr.plan(LONG, progress=listen)


def test_other_threads_go_on_meanwhile():
    """Were the GIL kept between two tellings, another thread could count once in each of them at most."""
    counted, over = [0], threading.Event()

    def count():
        while not over.is_set():
            counted[0] += 1
            time.sleep(0.001)

    seen = []
    counter = threading.Thread(target=count)
    counter.start()
    try:
        fjr.plan(LONG, progress=lambda progress: seen.append(counted[0]) or len(seen) < 10, check=False)
    finally:
        over.set()
        counter.join()
    assert seen[-1] - seen[0] > 3 * (len(seen) - 1)


def test_two_threads_plan_at_once(reach):
    plans = {}

    def make(name):
        plans[name] = fjr.plan(REACH, jobs=1)

    threads = [threading.Thread(target=make, args=(i,)) for i in range(2)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert np.array_equal(plans[0].tau, reach.tau) and np.array_equal(plans[1].tau, reach.tau)


def test_ctrl_c_cancels():
    script = textwrap.dedent(f"""
        import fjr, sys, threading
        # From another thread: a listener would be Python's own chance to see the signal.
        threading.Timer(0.3, print, ["begun"], {{"flush": True}}).start()
        try:
            fjr.plan({LONG!r})
        except KeyboardInterrupt:
            print("interrupted", flush=True)
            sys.exit(7)
    """)
    process = subprocess.Popen([sys.executable, "-c", script], stdout=subprocess.PIPE, text=True)
    assert process.stdout is not None and process.stdout.readline() == "begun\n"
    process.send_signal(signal.SIGINT)
    rest = process.communicate(timeout=60)[0]  # LONG takes minutes
    assert process.returncode == 7 and rest.endswith("interrupted\n")


def test_one_joint_alone_may_be_limited():
    request = {"start": {"q": [0, 0]}, "goal": {"q": [0.4, -0.3]}, "limits": {"torque": (9, np.inf)}}
    assert fjr.plan(request).to_dict()["resolved_request"]["limits"]["torque"] == [9, 5]
    with pytest.raises(fjr.BadInput) as caught:
        fjr.plan({**request, "limits": {"torque": (np.nan, 4)}})
    assert caught.value.field == "limits.torque[0]"
