"""Ruckig and TOPP-RA on the rigid arm: each returns the rows of a trajectory file, and what it was given."""
import dataclasses

import numpy as np
import ruckig
import toppra
import toppra.algorithm
import toppra.constraint

PERIOD = 1e-3   # of the rows [s]
GRID = 400      # intervals along TOPP-RA's path

toppra.setup_logging("ERROR")


@dataclasses.dataclass
class Plan:
    rows: np.ndarray
    settings: dict  # what else there is to say of it


def row_times(duration):
    """Every millisecond, and the end."""
    times = PERIOD * np.arange(int(np.ceil(duration / PERIOD)))
    return np.append(times[times < duration - PERIOD / 10], duration)


def at_rest_at_both_ends(samples, start, goal):
    """Without what rounding leaves of it."""
    q, dq, _ = samples
    q[0], q[-1], dq[0], dq[-1] = start, goal, 0, 0
    return samples


# ---- Ruckig ----

def ruckig_motion(arm, motion, acceleration, ramp, slower=1.0):
    """Times and samples (q, dq, ddq). acceleration: (2) limits; ramp: [s] in which one is built up; slower: factor on all
    times."""
    given = ruckig.InputParameter(2)
    given.current_position, given.target_position = map(list, motion.ends)
    given.max_velocity = list(arm.limits["motor_velocity"] / slower)
    given.max_acceleration, given.max_jerk = list(acceleration / slower**2), list(acceleration / ramp / slower**3)
    trajectory = ruckig.Trajectory(2)
    result = ruckig.Ruckig(2).calculate(given, trajectory)
    if result not in (ruckig.Result.Working, ruckig.Result.Finished):
        raise ValueError(f"Ruckig: {result}")
    times = row_times(trajectory.duration)
    samples = np.array([trajectory.at_time(time) for time in times]).transpose(1, 0, 2)
    return times, at_rest_at_both_ends(samples, *motion.ends)


def plan_ruckig(arm, motion, ramp, slower=1.0):
    """Constant limits on acceleration cannot say what a torque limit allows, which depends on place and speed. So they are
    chosen for each motion: in proportion to what the torque limits accelerate at least, and as large as keeps the torques
    of the motors and of the springs along the whole of this motion within their limits. slower: afterwards, by this factor."""
    stretched = np.diagonal(arm.mass(np.zeros((1, 2)))[0])
    least = arm.limits["torque"] / (stretched + arm.p["motor.inertia"])

    def load(scale):
        _, samples = ruckig_motion(arm, motion, scale * least, ramp)
        return arm.load(*samples)

    low, high = 1e-3, 10.0
    if load(low) > 1:
        raise ValueError("Ruckig: no acceleration is slow enough")
    while high / low > 1.001:
        middle = np.sqrt(low * high)
        low, high = (middle, high) if load(middle) <= 1 else (low, middle)
    times, samples = ruckig_motion(arm, motion, low * least, ramp, slower)
    return Plan(arm.rows(times, *samples), {"max_acceleration": list(low * least), "max_jerk": list(low * least / ramp),
                                            "rigid_load": arm.load(*samples)})


# ---- TOPP-RA ----

class Straight(toppra.interpolator.AbstractGeometricPath):
    """q(s) from start to goal, s from 0 to 1."""

    def __init__(self, start, goal):
        self.start, self.step = start, goal - start

    def __call__(self, s, order=0):
        s = np.asarray(s, float)
        along = (s, np.ones_like(s), np.zeros_like(s))[order]
        return along[..., None] * self.step + (self.start if order == 0 else 0)

    dof = 2
    path_interval = np.array([0.0, 1.0])
    waypoints = None


def path_of(q):
    """Through the links' angles (n, 2) of a motion, by the length of the way in them."""
    length = np.append(0, np.cumsum(np.linalg.norm(np.diff(q, axis=0), axis=1)))
    s = length / length[-1]
    chosen = [0]
    for i in range(1, len(s)):
        if s[i] - s[chosen[-1]] >= 1 / 60:
            chosen.append(i)
    chosen[-1] = len(s) - 1
    return toppra.SplineInterpolator(s[chosen], q[chosen])


def plan_toppra(arm, path, most_rounds=40, settled=1e-3):
    """Time along a path, by constraints of second order: velocities, torques of the motors, torques of the springs. The
    friction of the motors depends on the speed, which such constraints cannot say; it is that of the solution before, until
    it no longer changes."""
    grid = np.linspace(0, 1, GRID + 1)
    velocity = arm.limits["motor_velocity"]
    friction = np.zeros((GRID + 1, 2))

    def rigid(of):
        return lambda q, dq, ddq: of(np.array([q]), np.array([dq]), np.array([ddq]))[0]

    def within(of, limit, custom=None):
        both = np.vstack([np.eye(2), -np.eye(2)])
        return toppra.constraint.SecondOrderConstraint(
            rigid(of), lambda q: both, lambda q: np.concatenate([limit, limit]), 2, custom,
            discretization_scheme=toppra.constraint.DiscretizationType.Interpolation)

    def without_friction(q, dq, ddq):
        return arm.spring_torque(q, dq, ddq) + arm.p["motor.inertia"] * ddq

    def known_friction(_, s):
        return np.array([np.interp(s, grid, column) for column in friction.T])

    for _ in range(most_rounds):
        constraints = [toppra.constraint.JointVelocityConstraint(np.stack([-velocity, velocity], 1)),
                       within(without_friction, arm.limits["torque"], known_friction),
                       within(arm.spring_torque, arm.spring_torque_limit)]
        solver = toppra.algorithm.TOPPRA(constraints, path, gridpoints=grid, parametrizer="ParametrizeConstAccel")
        _, speeds, _ = solver.compute_parameterization(0, 0)
        if speeds is None:
            raise ValueError("TOPP-RA: no motion along this path")
        new = arm.friction(path(grid, 1) * speeds[:, None])
        change, friction = np.abs(new - friction).max(), friction + 0.5 * (new - friction)
        if change < settled:
            break
    trajectory = solver.compute_trajectory()
    times = row_times(trajectory.duration)
    samples = np.array([trajectory(times, order) for order in range(3)])
    samples = at_rest_at_both_ends(samples, path(0.0), path(1.0))
    return Plan(arm.rows(times, *samples), {"rigid_load": arm.load(*samples)})
