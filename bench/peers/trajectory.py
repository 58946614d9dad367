"""What every peer returns, and the same rows, file and objective from it for all."""
import dataclasses

import casadi as ca
import numpy as np

from problems import Guess

PERIOD = 1e-3  # of the rows [s]
JUMP = 1e-6    # between the two rows of a jump [s]


@dataclasses.dataclass
class Solution:
    times: np.ndarray     # (N + 1,) of the nodes [s]
    states: np.ndarray    # (N + 1, 8) at them
    controls: np.ndarray  # (N, 3, 2): u at the begin, the middle and the end of each interval, quadratic between
    iterations: int
    solved: bool
    message: str          # the solver's own

    def guess(self):
        """To start another mesh from."""
        u = np.vstack([self.controls[:, 0], self.controls[-1:, 2]])
        return Guess(self.times, np.hstack([self.states, u]))


def quadratic(values, s):
    begin, middle, end = values
    return begin * (1 - s) * (1 - 2 * s) + middle * 4 * s * (1 - s) + end * s * (2 * s - 1)


def rows(arm, solution, exact):
    """(n, 11) as in trajectory.csv: every millisecond, at the nodes, and both sides of the control's jumps. tau is what the
    peer solved with or, where `exact`, u with the exact law of friction.

    Between nodes the motion is integrated from each node under the peer's control, and what it then lacks to the next node
    is added in proportion to time: the miss is the peer's and not an interpolation's, and nothing jumps."""
    step, controls = rk4(arm), solution.controls
    times, states, us = [solution.times[0]], [solution.states[0]], [controls[0, 0]]
    for k, values in enumerate(controls):
        begin, end, x = solution.times[k], solution.times[k + 1], solution.states[k]
        inner = PERIOD * np.arange(np.floor(begin / PERIOD) + 1, np.ceil(end / PERIOD))
        inner = inner[(inner > begin + 2 * JUMP) & (inner < end - 2 * JUMP)]
        if k > 0 and np.max(np.abs(values[0] - controls[k - 1, 2])) > 1e-6:
            inner = np.concatenate([[begin + JUMP], inner])
        at, piece = begin, []
        for time in [*inner, end]:
            shares = (np.array([at, (at + time) / 2, time]) - begin) / (end - begin)
            x = np.array(step(x, *(quadratic(values, share) for share in shares), time - at)).ravel()
            piece.append(x)
            us.append(quadratic(values, shares[2]))
            at = time
        times += [*inner, end]
        shares = (np.array([*inner, end]) - begin) / (end - begin)
        states += list(np.array(piece) + shares[:, None] * (solution.states[k + 1] - x))
    x, u = np.array(states), np.array(us)
    tau = np.array((arm.exact_torque if exact else arm.torque)(x.T, u.T)).T
    return np.column_stack([times, x, tau])


def rk4(arm):
    """(x, u at begin, middle and end, h) -> x after h."""
    x, h = ca.SX.sym("x", 8), ca.SX.sym("h")
    u = [ca.SX.sym(f"u{i}", 2) for i in range(3)]
    k1 = arm.f(x, u[0])
    k2 = arm.f(x + h / 2 * k1, u[1])
    k3 = arm.f(x + h / 2 * k2, u[1])
    k4 = arm.f(x + h * k3, u[2])
    return ca.Function("rk4", [x, *u, h], [x + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)])


def objective(arm, weights, table):
    """Of the rows, whoever made them: quantities are linear between them."""
    h = np.diff(table[:, 0])

    def integral_of_square(values):
        a, b = values[:-1], values[1:]
        return float(np.sum(h[:, None] / 3 * (a * a + a * b + b * b)))

    terms = {"time": lambda: table[-1, 0], "effort": lambda: integral_of_square(table[:, 9:11]),
             "link_acceleration": lambda: integral_of_square(np.array(arm.acceleration(table[:, 1:9].T)).T)}
    return sum(weight * terms[name]() for name, weight in weights.items())
