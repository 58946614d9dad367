"""A node of ROS 2 itself, beside service, executor and `fjr ros2-action`:  node.py SOURCE_FOLDER PROGRAM SEND_GOAL

It finds the action with its type and services, and takes status messages and what goes to the executor; rclpy reads the bag that
`fjr export` writes. All that a node on any rmw may do: goals need rmw_cyclonedds_cpp, so one is sent by the client of these
tests, SEND_GOAL. Exit code 77: there is no rclpy here. It need not be a machine's: PyPI has wheels of ROS 2 Jazzy,
`pip install 'ros-jazzy-rclpy[fastrtps]' ros-jazzy-action-msgs ros-jazzy-trajectory-msgs`, in the environment of the Python that
FJR_ROS2_PYTHON names.
"""

import os
import struct
import subprocess
import sys
import tempfile
import time
from pathlib import Path

SUCCEEDED = 4
DOMAIN = 0  # of a network that is its own


def with_rclpy():
    """Again with the Python that has rclpy, where another one is named."""
    python = os.environ.get("FJR_ROS2_PYTHON")
    if python and os.path.abspath(python) != os.path.abspath(sys.executable):
        os.execv(python, [python, *sys.argv])


def alone():
    """Again in a network namespace of its own, where no other test's service is met."""
    for how in ("-n", "-rn"):
        if subprocess.run(["unshare", how, "true"], capture_output=True).returncode == 0:
            os.environ["FJR_ALONE"] = "1"
            script = 'ip link set lo up && exec "$@"'
            os.execvp("unshare", ["unshare", how, "sh", "-c", script, "sh", sys.executable, *sys.argv])
    sys.exit("network namespaces are not allowed here")


def wait_for(spin, holds, limit=60):
    end = time.monotonic() + limit
    while not holds():
        assert time.monotonic() < end, "it did not come true"
        spin()


def messages_of_bag(file):
    """The payloads of the message records of an uncompressed MCAP file: chunks (0x06) of records with messages (0x05)."""

    def records(data):
        while len(data) >= 9:
            kind, size = struct.unpack("<BQ", data[:9])
            yield kind, data[9 : 9 + size]
            data = data[9 + size :]

    for kind, body in records(file.read_bytes()[8:-8]):
        if kind != 0x06:
            continue
        name = struct.unpack("<I", body[28:32])[0]
        assert name == 0, "chunks are compressed"
        for inner, message in records(body[40:]):
            if inner == 0x05:
                yield message[22:]


def check_bag(program, folder):
    """ROS 2's own code reads the trajectory."""
    from rclpy.serialization import deserialize_message
    from trajectory_msgs.msg import JointTrajectory

    (folder / "request.yaml").write_text("start: {q: [0, 0]}\ngoal: {q: [0.4, -0.3]}\n")
    subprocess.run([program, "plan", folder / "request.yaml", "--out", folder / "plan", "-q"], check=True, stdout=subprocess.DEVNULL)
    subprocess.run([program, "export", folder / "plan", "--format", "ros2"], check=True, stdout=subprocess.DEVNULL)
    (message,) = messages_of_bag(folder / "plan" / "export.ros2.mcap")
    trajectory = deserialize_message(bytes(message), JointTrajectory)
    assert trajectory.joint_names == ["joint1", "joint2"]
    assert len(trajectory.points) > 100
    assert max(abs(a - b) for a, b in zip(trajectory.points[-1].positions, [0.4, -0.3])) < 1e-6
    assert trajectory.points[1].time_from_start.nanosec == 1_000_000


def check_node(send_goal):
    import rclpy
    from action_msgs.msg import GoalStatusArray
    from rclpy.action.graph import get_action_names_and_types
    from rclpy.qos import DurabilityPolicy, QoSProfile
    from trajectory_msgs.msg import JointTrajectory

    rclpy.init()
    node = rclpy.create_node("listener")
    statuses, trajectories = [], []
    latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    action = "/arm/follow_joint_trajectory"
    node.create_subscription(GoalStatusArray, action + "/_action/status", statuses.append, latched)
    node.create_subscription(JointTrajectory, "/joint_trajectory", trajectories.append, 10)

    def spin():
        rclpy.spin_once(node, timeout_sec=0.1)

    def graph():
        return dict(get_action_names_and_types(node)), dict(node.get_service_names_and_types())

    wait_for(spin, lambda: action in graph()[0] and statuses)  # status is there for who comes late
    actions, services = graph()
    assert actions[action] == ["control_msgs/action/FollowJointTrajectory"], actions
    assert services[action + "/_action/send_goal"] == ["control_msgs/action/FollowJointTrajectory_SendGoal"]
    assert services[action + "/_action/get_result"] == ["control_msgs/action/FollowJointTrajectory_GetResult"]
    assert services[action + "/_action/cancel_goal"] == ["action_msgs/srv/CancelGoal"]
    wait_for(spin, lambda: node.count_publishers("/joint_trajectory"))

    client = subprocess.Popen([send_goal, str(DOMAIN), "0.4", "-0.3"], stdout=subprocess.PIPE, text=True)
    wait_for(spin, lambda: client.poll() is not None)
    said = client.stdout.read().split()
    assert said[1:] == ["accepted", str(SUCCEEDED), "0"], said

    def of_goal():
        ids = [(bytes(one.goal_info.goal_id.uuid).hex(), one.status) for m in statuses for one in m.status_list]
        return [status for goal, status in ids if goal == said[0]]

    wait_for(spin, lambda: SUCCEEDED in of_goal() and trajectories)
    assert of_goal() == sorted(of_goal()), of_goal()
    (planned,) = trajectories
    assert planned.joint_names == ["joint1", "joint2"]
    assert max(abs(a - b) for a, b in zip(planned.points[-1].positions, [0.4, -0.3])) < 1e-6
    rclpy.shutdown()


def main():
    source, program, send_goal = Path(sys.argv[1]), sys.argv[2], sys.argv[3]
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        check_bag(program, folder)
        service = (source / "config" / "service.yaml").read_text()
        assert service.count("joint_trajectory: false") == 1
        (folder / "service.yaml").write_text(service.replace("joint_trajectory: false", "joint_trajectory: true"))
        (folder / "robot.yaml").write_text((source / "config" / "robot.yaml").read_text())
        started = []
        try:
            executor = ["executor", "--start", "0,0", "--state", folder / "state"]
            for words in (executor, ["serve", "--config", folder / "service.yaml"], ["ros2-action"]):
                with (folder / f"{words[0]}.log").open("w") as log:
                    started.append(subprocess.Popen([program, *words, "--domain", str(DOMAIN)], stdout=log, stderr=log))
            # Fast DDS is what the wheels have; it looks for others where fjr is.
            os.environ["FASTRTPS_DEFAULT_PROFILES_FILE"] = str(source / "config" / "fastdds.xml")
            os.environ["ROS_DOMAIN_ID"] = str(DOMAIN)
            check_node(send_goal)
        except BaseException:
            for log in sorted(folder.glob("*.log")):
                print(log.name, log.read_text(), sep="\n")
            raise
        finally:
            for process in started:
                process.terminate()
                process.wait()
    print("a node of ROS 2 sees the action, and takes its status and the trajectory")


if __name__ == "__main__":
    with_rclpy()
    try:
        import rclpy  # noqa: F401
    except ImportError:
        print(f"{sys.executable} has no rclpy (see the head of this file)")
        sys.exit(77)
    if "FJR_ALONE" not in os.environ:
        alone()
    main()
