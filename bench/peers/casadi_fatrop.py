"""CasADi and FATROP: the same collocation as Ipopt's, cast into the stages that FATROP's factorisation wants.

The state of a stage is (x, u, T) at its node; its controls are x and u at the midpoint and at the next node, which the
dynamics copy there; the defects are equality constraints of the stage. (Multiple shooting by two Runge-Kutta steps, the
usual form, took two to three times as long: its Hessians are dearer.)
"""
import casadi as ca
import numpy as np

from hermite_simpson import Transcription
from trajectory import Solution

STATE, CONTROL = 11, 20


def cannot(problem):
    return None


def versions():
    return f"FATROP of the wheel of CasADi {ca.__version__}"


class Rows:
    """Variables, or constraints: expressions, their bounds and guesses, one after the other."""

    def __init__(self):
        self.expressions, self.low, self.high, self.guess = [], [], [], []

    def add(self, expression, low, high, guess=()):
        self.expressions.append(expression)
        self.low.extend(low)
        self.high.extend(high)
        self.guess.extend(guess)


def build(problem, arm, intervals, guess):
    t = Transcription(problem, arm, intervals, guess)
    n = len(t.nodes) - 1
    (x, u), (xm, um) = t.node_guess, t.middle_guess
    states = [ca.MX.sym(f"s{k}", STATE) for k in range(n + 1)]
    variables, constraints, cost, paths = Rows(), Rows(), 0, []
    for k, s in enumerate(states):
        low, high = t.node_bounds(k)
        # T is bounded once: bounded in every stage beside T' = T, its multipliers would not be unique.
        span = t.span if k == 0 else (-np.inf, np.inf)
        variables.add(s, [*low, -np.inf, -np.inf, span[0]], [*high, np.inf, np.inf, span[1]], [*x[k], *u[k], t.duration])
        before = len(constraints.low)
        if k < n:
            c = ca.MX.sym(f"c{k}", CONTROL)
            bound = np.concatenate([t.state_bound, np.full(12, np.inf)])
            variables.add(c, -bound, bound, [*xm[k], *um[k], *x[k + 1], *u[k + 1]])
            constraints.add(states[k + 1] - ca.vertcat(c[10:], s[10]), np.zeros(STATE), np.zeros(STATE))
            before = len(constraints.low)
            h = (t.nodes[k + 1] - t.nodes[k]) * s[10]
            defects, integral = t.interval(s[:8], s[8:10], c[:8], c[8:10], c[10:18], c[18:], h)
            cost += integral
            constraints.add(defects, np.zeros(16), np.zeros(16))
            constraints.add(t.path(c[:8], c[8:10]), -t.path_bound, t.path_bound)
        constraints.add(t.path(s[:8], s[8:10]), -t.path_bound, t.path_bound)
        paths.append(len(constraints.low) - before)
    cost += problem.weights.get("time", 0) * states[-1][10]
    equality = [bool(low == high) for low, high in zip(constraints.low, constraints.high)]
    options = {"expand": True, "print_time": False, "structure_detection": "manual", "N": n, "nx": [STATE] * (n + 1),
               "nu": [CONTROL] * n + [0], "ng": paths, "equality": equality,
               "fatrop": {"print_level": 0, "tolerance": 1e-6, "max_iter": 1000}}
    program = {"x": ca.vertcat(*variables.expressions), "f": cost, "g": ca.vertcat(*constraints.expressions)}
    start = {"x0": variables.guess, "lbx": variables.low, "ubx": variables.high, "lbg": constraints.low,
             "ubg": constraints.high}
    return t.nodes, ca.nlpsol("peer", "fatrop", program, options), start


def solve(nodes, solver, start):
    z = np.array(solver(**start)["x"]).ravel()
    stages = np.concatenate([z, np.zeros(CONTROL)]).reshape(len(nodes), STATE + CONTROL)
    u, middle = stages[:, 8:10], stages[:-1, 19:21]
    stats = solver.stats()
    message = "solved" if stats["success"] else f"return status {stats['return_status']}"
    return Solution(nodes * stages[0, 10], stages[:, :8], np.stack([u[:-1], middle, u[1:]], axis=1), stats["iter_count"],
                    stats["success"], message)
