"""The transcription that Ipopt and FATROP are given: Hermite-Simpson with the midpoints' states as variables.

Kept separate, defects are linear in f and their Hessian is that of single points: the form that is cheapest for both.
"""
import casadi as ca
import numpy as np

SHORTEST, LONGEST = 0.1, 5.0  # bounds of a free duration [s]


class Transcription:
    def __init__(self, problem, arm, intervals, guess):
        self.nodes, self.via_nodes = problem.mesh(intervals)
        self.problem, self.arm = problem, arm
        self.duration = guess.duration
        self.span = (SHORTEST, LONGEST) if problem.free else (guess.duration, guess.duration)
        middles = (self.nodes[:-1] + self.nodes[1:]) / 2
        self.node_guess, self.middle_guess = guess.at(self.nodes), guess.at(middles)
        self.state_bound = np.concatenate([arm.limits["link_position"], [np.inf] * 4, arm.limits["motor_velocity"]])
        self.path_bound = np.concatenate([arm.limits["spring_deflection"], arm.limits["torque"]])
        x, u = ca.SX.sym("x", 8), ca.SX.sym("u", 2)
        self.path = ca.Function("path", [x, u], [ca.vertcat(x[4:6] - x[0:2], arm.torque(x, u))])
        self.interval = self._interval()

    def _interval(self):
        """(x, u at begin, middle and end, h) -> defects, integral of the running cost."""
        x, u, h = ([ca.SX.sym(f"{name}{i}", size) for i in range(3)] for name, size in (("x", 8), ("u", 2), ("h", 1)))
        h = h[0]
        f, cost = [list(map(function, x, u)) for function in (self.arm.f, running_cost(self.arm, self.problem.weights))]
        hermite = x[1] - (x[0] + x[2]) / 2 - h / 8 * (f[0] - f[2])
        simpson = x[2] - x[0] - h / 6 * (f[0] + 4 * f[1] + f[2])
        integral = h / 6 * (cost[0] + 4 * cost[1] + cost[2])
        return ca.Function("interval", [x[0], u[0], x[1], u[1], x[2], u[2], h], [ca.vertcat(hermite, simpson), integral])

    def node_bounds(self, k):
        """Of the state at node k: limits, or where the motion has to be."""
        low, high = -self.state_bound, self.state_bound.copy()
        if k in (0, len(self.nodes) - 1):
            low = high = self.arm.rest(self.problem.start if k == 0 else self.problem.goal)
        elif k in self.via_nodes:
            via = self.problem.via[self.via_nodes.index(k)]
            low[:2] = high[:2] = via.q
            if via.dq is not None:
                low[2:4] = high[2:4] = via.dq
        return low, high


def running_cost(arm, weights):
    """(x, u) -> what is integrated beside time."""
    x, u = ca.SX.sym("x", 8), ca.SX.sym("u", 2)
    return ca.Function("cost", [x, u], [weights.get("effort", 0) * ca.sumsqr(arm.torque(x, u))
                                        + weights.get("link_acceleration", 0) * ca.sumsqr(arm.acceleration(x))])
