"""Exports, read back with the field's own readers: pandas, SciPy, the mcap package and its ROS 2 decoder.

The environment variable FJR names the program, otherwise build/fjr is tested.
"""

import json
import math
import os
import subprocess
from pathlib import Path

import jsonschema
import numpy as np
import pandas as pd
import pytest
import scipy.io
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory

SOURCE = Path(__file__).resolve().parents[2]
FJR = os.environ.get("FJR", str(SOURCE / "build" / "fjr"))
TICK = 0.002  # [s], which the motion's duration is no multiple of
REQUEST = """start: {q: [0, 0]}
goal: {q: [0.9, -0.5]}
limits: {tip_speed: 4, motor_power: [80, .inf]}
obstacles: [{center: [0.15, -0.9], radius: 0.05}]
walls: [{point: [0, -0.75], normal: [0, 1]}]
"""


def fjr(*words, code=0):
    done = subprocess.run([FJR, *map(str, words)], capture_output=True, text=True)
    assert done.returncode == code, done.stderr
    return done


@pytest.fixture(scope="session")
def plan(tmp_path_factory):
    """The folder of a certified plan."""
    folder = tmp_path_factory.mktemp("plan")
    (folder / "request.yaml").write_text(REQUEST)
    fjr("plan", folder / "request.yaml", "--out", folder / "out", "--quiet")
    return folder / "out"


@pytest.fixture(scope="session")
def rows(plan):
    """trajectory.csv, between whose rows torque is linear."""
    return pd.read_csv(plan / "trajectory.csv", comment="#")


def experiment_log(folder):
    fjr("experiment", "motor_inertia", "--joint", "1", "--out", folder / "motor_inertia.csv")
    return folder / "motor_inertia.csv"


def executed_log(folder):
    """What the executor writes while it runs what a service has planned, both over the loopback interface."""
    network = ("--domain", "7")  # below those that tests/support/domain.h hands out
    (folder / "request.yaml").write_text(REQUEST)
    programs = [
        subprocess.Popen([FJR, *words, *network], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        for words in (("serve",), ("executor", "--fast", "--state", folder / "state", "--logs", folder / "logs"))
    ]
    try:
        fjr("request", folder / "request.yaml", "--execute", "--find", "20", *network)
    finally:
        for program in programs:
            program.terminate()
            program.wait(timeout=30)
    return next((folder / "logs").glob("*.csv"))


@pytest.fixture(scope="session", params=[experiment_log, executed_log])
def log(request, tmp_path_factory):
    return request.param(tmp_path_factory.mktemp("log"))


def export(plan, tmp_path, form, *more):
    file = tmp_path / ("plan." + form)
    assert fjr("export", plan, "--format", form, "--tick", TICK, "--out", file, *more).stdout == f"{file}\n"
    return file


def messages(file):
    """By topic: the schema's name, and (time [s], decoded message) in order."""
    topics = {}
    with open(file, "rb") as stream:
        reader = make_reader(stream, decoder_factories=[DecoderFactory()])
        summary = reader.get_summary()
        assert summary.statistics.message_count == sum(summary.statistics.channel_message_counts.values())
        assert len(summary.chunk_indexes) > 0  # Foxglove seeks by them
        for schema, channel, message in reader.iter_messages():
            decoded = json.loads(message.data) if channel.message_encoding == "json" else None
            topics.setdefault(channel.topic, (schema, []))[1].append((message.log_time * 1e-9, decoded))
        assert sum(len(list_) for _, list_ in topics.values()) == summary.statistics.message_count
    return topics


@pytest.fixture
def table(plan, tmp_path):
    return pd.read_csv(export(plan, tmp_path, "csv"))


def test_csv_needs_no_options_and_has_units(table):
    names = [f"{q}{j}_{unit}" for q, unit in [("q", "rad"), ("dq", "rad_per_s"), ("theta", "rad"), ("dtheta", "rad_per_s")]
             for j in (1, 2)]
    torques = ["tau1_N_m", "tau2_N_m", "tau1_mean_N_m", "tau2_mean_N_m"]
    assert list(table.columns) == ["time_s", *names, *torques, "tip_x_m", "tip_y_m", "tip_speed_m_per_s"]
    assert all(kind == np.float64 for kind in table.dtypes)


def test_rows_are_at_the_ticks(table, rows):
    end = rows.time.iloc[-1]
    assert np.allclose(table.time_s, TICK * np.arange(len(table)), rtol=0, atol=1e-12)
    assert table.time_s.iloc[-2] < end <= table.time_s.iloc[-1]
    # Positions are cubic between rows; where a row is at a tick it is the row.
    for name, column in [("q1_rad", "q1"), ("dtheta2_rad_per_s", "dtheta2")]:
        at_rows = rows[np.isclose((rows.time / TICK) % 1, 0, atol=1e-9)].drop_duplicates("time")
        for _, row in at_rows.iterrows():
            k = round(row.time / TICK)
            assert table[name][k] == pytest.approx(row[column], abs=1e-9)
    assert table.q1_rad.iloc[-1] == pytest.approx(0.9, abs=1e-9)
    assert table.q2_rad.iloc[-1] == pytest.approx(-0.5, abs=1e-9)


def test_mean_torque_gives_the_motion_its_impulse(table, rows):
    """The drive holds a value per tick: over every tick its impulse is that of the plan, whose torque is linear."""
    for joint in (1, 2):
        time, torque = rows.time.to_numpy(), rows[f"tau{joint}"].to_numpy()
        impulse = np.concatenate([[0], np.cumsum(0.5 * (torque[1:] + torque[:-1]) * np.diff(time))])

        def integral(t):  # exact: the antiderivative of a piecewise linear function
            k = min(np.searchsorted(time, t, side="right") - 1, len(time) - 2)
            s = t - time[k]
            slope = (torque[k + 1] - torque[k]) / (time[k + 1] - time[k])
            return impulse[k] + s * (torque[k] + 0.5 * s * slope)

        for k in range(int(time[-1] / TICK)):
            expected = (integral((k + 1) * TICK) - integral(k * TICK)) / TICK
            assert table[f"tau{joint}_mean_N_m"][k] == pytest.approx(expected, abs=1e-9)
    # A sample at the tick is another number wherever torque moves.
    assert np.abs(table.tau1_mean_N_m - table.tau1_N_m).max() > 0.1


def test_the_goal_is_held_after_the_end(plan, table):
    robot = json.loads((plan / "plan.json").read_text())["robot"]
    g1, g2 = robot["link"]["gravity_torque"]
    second = g2 * math.sin(0.9 - 0.5)
    assert table.tau1_mean_N_m.iloc[-1] == pytest.approx(g1 * math.sin(0.9) + second, abs=1e-9)
    assert table.tau2_mean_N_m.iloc[-1] == pytest.approx(second, abs=1e-9)


def test_the_tip_is_where_the_links_put_it(plan, table):
    l1, l2 = json.loads((plan / "plan.json").read_text())["robot"]["link"]["length"]
    both = table.q1_rad + table.q2_rad
    x, y = l1 * np.sin(table.q1_rad) + l2 * np.sin(both), -l1 * np.cos(table.q1_rad) - l2 * np.cos(both)
    assert np.allclose(table.tip_x_m, x, atol=1e-12) and np.allclose(table.tip_y_m, y, atol=1e-12)
    assert table.tip_speed_m_per_s.max() <= 4 * (1 + 1e-6)


def test_matlab(plan, table, tmp_path):
    mat = scipy.io.loadmat(export(plan, tmp_path, "mat"))
    for name in table.columns:
        assert mat[name].shape == (len(table), 1)
        assert np.array_equal(mat[name][:, 0], table[name].to_numpy())
    limits = mat["limits"][0, 0]
    assert limits["torque"].tolist() == [[12, 5]]
    assert limits["tip_speed"].tolist() == [[4]]
    assert limits["motor_power"].tolist() == [[80, math.inf]]
    assert mat["status"][0] == "certified"
    assert mat["tick_s"][0, 0] == TICK


def test_ranges_that_are_not_symmetric(tmp_path):
    robot = (SOURCE / "config" / "robot.yaml").read_text()
    symmetric = "link_middle: {value: [0, 0]"
    assert robot.count(symmetric) == 1
    (tmp_path / "robot.yaml").write_text(robot.replace(symmetric, "link_middle: {value: [0.5, 0]"))
    (tmp_path / "request.yaml").write_text("robot: robot.yaml\nstart: {q: [0, 0]}\ngoal: {q: [0.4, -0.3]}\n")
    fjr("plan", tmp_path / "request.yaml", "--out", tmp_path / "out", "--quiet")
    schema, limits = messages(export(tmp_path / "out", tmp_path, "mcap"))["/fjr/limits"]
    of_links = {name: value for name, value in limits[0][1].items() if "position" in name}
    assert of_links == {"link_position_1_lowest_rad": -2.7, "link_position_1_highest_rad": 3.7, "link_position_2_rad": 2.6}
    assert set(json.loads(schema.data)["properties"]) == set(limits[0][1])
    mat = scipy.io.loadmat(export(tmp_path / "out", tmp_path, "mat"))["limits"][0, 0]
    assert mat["link_position"].tolist() == [[3.2, 2.6]] and mat["link_middle"].tolist() == [[0.5, 0]]


def strict(schema):
    """The same, and objects have no other keys than those that it names."""
    if isinstance(schema, list):
        return [strict(item) for item in schema]
    if not isinstance(schema, dict):
        return schema
    more = {"additionalProperties": False} if schema.get("type") == "object" and "properties" in schema else {}
    return {key: strict(value) for key, value in schema.items()} | more


def test_the_scene_is_as_foxglove_has_it(plan, tmp_path):
    # Foxglove's own definition: SceneUpdate of the npm package @foxglove/schemas 2.1.0 (MIT, Foxglove Technologies Inc.), as it is.
    own = strict(json.loads((SOURCE / "tests" / "exports" / "foxglove.SceneUpdate.json").read_text()))
    jsonschema.Draft202012Validator.check_schema(own)
    validator = jsonschema.Draft202012Validator(own)
    schema, scene = messages(export(plan, tmp_path, "mcap"))["/fjr/scene"]
    assert schema.name == own["title"] and schema.encoding == "jsonschema"
    assert json.loads(schema.data)["properties"].keys() == own["properties"].keys()
    shapes = set()
    for _, message in scene:
        validator.validate(message)
        for entity in message["entities"]:
            shapes |= {key for key, value in entity.items() if isinstance(value, list) and value}
    assert shapes == {"lines", "cylinders"}
    # And it would have been seen: a key less, one more, and a number for a point.
    for spoil in (
        lambda entity: entity.pop("frame_id"),
        lambda entity: entity.update(frame="base"),
        lambda entity: entity["lines"][0]["points"].append(0.5),
    ):
        wrong = json.loads(json.dumps(scene[-1][1]))
        spoil(wrong["entities"][0])
        assert not validator.is_valid(wrong)


def test_the_scene_has_what_tip_and_joints_keep_to(tmp_path):
    still = {}
    for name, task in (
        ("box", "tip: {box: [[-0.1, -0.7], [0.5, -0.3]]}"),
        ("line", "tip: {line: {from: [0.05, -0.64], to: [0.2, -0.6], tolerance: 0.05}}"),
        ("path", "path: {points: [[0.2, 0.05]], tolerance: 0.05}"),
    ):
        request = tmp_path / f"{name}.yaml"
        request.write_text("start: {q: [0.08, 0]}\ngoal: {q: [0.3, 0.02]}\n" + task + "\n")
        fjr("plan", request, "--out", tmp_path / name, "--quiet")
        _, scene = messages(export(tmp_path / name, tmp_path, "mcap"))["/fjr/scene"]
        still |= {entity["id"]: entity["lines"][0] for entity in scene[0][1]["entities"]}
    corners = [(point["x"], point["y"]) for point in still["tip box"]["points"]]
    assert corners == [(-0.1, -0.7), (0.5, -0.7), (0.5, -0.3), (-0.1, -0.3), (-0.1, -0.7)]
    assert still["tip line"]["thickness"] == pytest.approx(0.1)
    # A straight line of the joints is a curve of the tip, at the arm's length from the base where q2 is zero.
    first = still["path"]["points"][0]
    assert (first["x"] ** 2 + first["y"] ** 2) ** 0.5 == pytest.approx(0.65)


def test_mcap(plan, table, log, tmp_path):
    topics = messages(export(plan, tmp_path, "mcap", "--log", log))
    assert set(topics) == {"/fjr/trajectory", "/fjr/tip", "/fjr/limits", "/fjr/scene", "/fjr/executed"}
    schema, trajectory = topics["/fjr/trajectory"]
    assert schema.encoding == "jsonschema"
    assert set(json.loads(schema.data)["properties"]) == set(trajectory[0][1])
    assert len(trajectory) == len(table)
    assert [time for time, _ in trajectory] == pytest.approx(table.time_s.tolist(), abs=1e-9)
    for name in ("q1_rad", "tau2_mean_N_m"):
        assert [message[name] for _, message in trajectory] == table[name].tolist()
    assert [m["tip_x_m"] for _, m in topics["/fjr/tip"][1]] == table.tip_x_m.tolist()
    limits = topics["/fjr/limits"][1]
    assert len(limits) == 2 and limits[0][1]["torque_1_N_m"] == 12 and limits[0][1]["tip_speed_m_per_s"] == 4
    assert [name for name in limits[0][1] if "power" in name] == ["motor_power_1_W"]

    schema, scene = topics["/fjr/scene"]
    assert schema.name == "foxglove.SceneUpdate"
    still = {entity["id"]: entity for entity in scene[0][1]["entities"]}
    assert set(still) == {"obstacle 1", "wall 1"}
    assert still["obstacle 1"]["cylinders"][0]["size"]["x"] == pytest.approx(0.1)
    assert still["obstacle 1"]["cylinders"][0]["pose"]["position"] == {"x": 0.15, "y": -0.9, "z": 0.0}
    assert {point["y"] for point in still["wall 1"]["lines"][0]["points"]} == {-0.75}
    arm = scene[-1][1]["entities"][0]["lines"]
    assert arm[1]["points"][1]["x"] == pytest.approx(table.tip_x_m.iloc[-1])

    recorded = pd.read_csv(log, comment="#")
    executed = topics["/fjr/executed"][1]
    assert len(executed) == len(recorded)
    assert [message["theta1_rad"] for _, message in executed] == recorded.theta1.tolist()


def test_ros2(plan, table, tmp_path):
    file = export(plan, tmp_path, "ros2", "--joint-names", "shoulder,elbow")
    with open(file, "rb") as stream:
        reader = make_reader(stream, decoder_factories=[DecoderFactory()])
        assert reader.get_header().profile == "ros2"
        decoded = list(reader.iter_decoded_messages())
    assert len(decoded) == 1
    assert decoded[0].schema.name == "trajectory_msgs/msg/JointTrajectory"
    message = decoded[0].decoded_message
    assert message.joint_names == ["shoulder", "elbow"]
    assert len(message.points) == len(table)
    for k, point in enumerate(message.points):
        assert list(point.positions) == [table.q1_rad[k], table.q2_rad[k]]
        assert list(point.velocities) == [table.dq1_rad_per_s[k], table.dq2_rad_per_s[k]]
        assert list(point.effort) == [table.tau1_mean_N_m[k], table.tau2_mean_N_m[k]]
        assert point.time_from_start.sec + 1e-9 * point.time_from_start.nanosec == pytest.approx(k * TICK, abs=1e-9)
    # Accelerations are the rate of the velocities: within a tick they change by less than the jerk allows.
    slope = (message.points[11].velocities[0] - message.points[9].velocities[0]) / (2 * TICK)
    assert message.points[10].accelerations[0] == pytest.approx(slope, rel=0.02)


def test_logs_by_themselves(log, tmp_path):
    recorded = pd.read_csv(log, comment="#")
    fjr("export", log, "--format", "csv", "--out", tmp_path / "log.csv")
    table = pd.read_csv(tmp_path / "log.csv")
    assert table.columns[0] == "time_s" and len(table) == len(recorded)
    assert table.tau1_N_m.tolist() == recorded.tau1.tolist()
    fjr("export", log, "--format", "mat", "--out", tmp_path / "log.mat")
    assert scipy.io.loadmat(tmp_path / "log.mat")["theta1_rad"][:, 0].tolist() == recorded.theta1.tolist()
    fjr("export", log, "--format", "mcap", "--out", tmp_path / "log.mcap")
    assert list(messages(tmp_path / "log.mcap")) == ["/fjr/executed"]


def test_what_cannot_be_exported_is_refused(plan, log, tmp_path):
    def refused(*words):
        return fjr("export", *words, "--out", tmp_path / "file", code=2).stderr

    assert "ros2 is for plans" in refused(log, "--format", "ros2")
    assert "did you mean mcap?" in refused(plan, "--format", "mcpa")
    assert "--tick" in refused(plan, "--format", "csv", "--tick", "1")
    assert "is no folder of a plan" in refused(tmp_path, "--format", "csv")
    assert "goes with the folder of a plan" in refused(log, "--format", "mcap", "--log", log)
    assert not (tmp_path / "file").exists()
    missing = fjr("export", plan, "--format", "mat", "--out", tmp_path / "none" / "plan.mat", code=2).stderr
    assert "plan.mat" in missing
    assert list(tmp_path.iterdir()) == []
