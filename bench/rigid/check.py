"""arm.py held against fjr: with springs a hundred times as stiff its rigid arm is very nearly the arm of `fjr simulate`."""
import numpy as np
import yaml

from arm import RigidArm
from files import ROBOT, write_rows
from planners import row_times

STIFFER = 100
# [rad] What is left of the springs is M ddq / K, up to 9 N m / 2048 N m/rad = 4e-3. Measured: 1.6e-3; without Coriolis and
# centrifugal torques 5.1e-3, with a tenth less of the masses, gravity or friction 7.8e-3, 8.9e-3, 1.8e-2.
MOST = 3e-3


def rigid_arm_is_the_limit_of_the_elastic_one(simulate, folder):
    """simulate(path of a trajectory, path of a robot.yaml) -> what fjr says."""
    document = yaml.safe_load(ROBOT.read_text())
    document["spring"]["stiffness"]["value"] = [STIFFER * value for value in document["spring"]["stiffness"]["value"]]
    robot = folder / "stiff_robot.yaml"
    robot.write_text(yaml.safe_dump(document, sort_keys=False))
    arm = RigidArm(robot)
    duration, start, step = 0.7, np.array([0.9, -1.2]), np.array([-1.3, 2.0])
    times = row_times(duration)
    c = (times / duration)[:, None]
    q = start + step * c**3 * (10 + c * (-15 + 6 * c))
    dq = step * 30 * c**2 * (1 - c)**2 / duration
    ddq = step * 60 * c * (1 + c * (-3 + 2 * c)) / duration**2
    path = folder / "minimum_jerk.csv"
    write_rows(path, arm.rows(times, q, dq, ddq))
    error = max(simulate(path, robot)["link_error_rad"])
    if not error < MOST:
        raise SystemExit(f"bench/rigid/arm.py is not fjr's arm: on springs {STIFFER} times as stiff links are {error:.3g} rad off")
