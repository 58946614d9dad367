"""CasADi and Ipopt with MUMPS: Hermite-Simpson collocation, exact first and second derivatives."""
import re
import tempfile

import casadi as ca
import numpy as np

from hermite_simpson import Transcription
from trajectory import Solution

OPTIONS = {"expand": True, "print_time": False,
           "ipopt": {"print_level": 0, "sb": "yes", "linear_solver": "mumps", "tol": 1e-6, "max_iter": 1000}}


def cannot(problem):
    return None


def versions():
    """Ipopt tells its version and its linear solver's where it reports on a problem, and nowhere else."""
    x = ca.SX.sym("x")
    with tempfile.NamedTemporaryFile("r") as log:
        ipopt = {"print_level": 0, "output_file": log.name, "file_print_level": 5}
        ca.nlpsol("version", "ipopt", {"x": x, "f": x * x}, {**OPTIONS, "ipopt": ipopt})()
        found = re.search(r"Ipopt version (\S+), running with linear solver (MUMPS .*)\.\n", log.read())
    return f"CasADi {ca.__version__}, Ipopt {found[1]}, {found[2]}"


def build(problem, arm, intervals, guess):
    """Variables: x and u at the nodes, x and u at the midpoints, T."""
    t = Transcription(problem, arm, intervals, guess)
    n = len(t.nodes) - 1
    x, u, xm, um = ca.MX.sym("x", 8, n + 1), ca.MX.sym("u", 2, n + 1), ca.MX.sym("xm", 8, n), ca.MX.sym("um", 2, n)
    duration = ca.MX.sym("T")
    h = ca.DM(np.diff(t.nodes)).T * duration
    defects, cost = t.interval.map(n)(x[:, :-1], u[:, :-1], xm, um, x[:, 1:], u[:, 1:], h)
    paths = [ca.vec(t.path.map(count)(*point)) for count, point in ((n + 1, (x, u)), (n, (xm, um)))]
    program = {"x": ca.vertcat(*map(ca.vec, (x, u, xm, um)), duration), "g": ca.vertcat(ca.vec(defects), *paths),
               "f": ca.sum2(cost) + problem.weights.get("time", 0) * duration}
    low, high = map(np.array, zip(*map(t.node_bounds, range(n + 1))))
    middle, free = np.tile(t.state_bound, n), np.full(2 * n, np.inf)
    bound = np.concatenate([np.zeros(16 * n), np.tile(t.path_bound, 2 * n + 1)])
    start = {"x0": np.concatenate([*map(np.ravel, (*t.node_guess, *t.middle_guess)), [t.duration]]),
             "lbx": np.concatenate([low.ravel(), -free, [-np.inf] * 2, -middle, -free, [t.span[0]]]),
             "ubx": np.concatenate([high.ravel(), free, [np.inf] * 2, middle, free, [t.span[1]]]),
             "lbg": -bound, "ubg": bound}
    return t.nodes, ca.nlpsol("peer", "ipopt", program, OPTIONS), start


def solve(nodes, solver, start):
    z = np.array(solver(**start)["x"]).ravel()
    n = len(nodes) - 1
    x, u, _, um = (part.reshape(-1, size) for part, size in
                   zip(np.split(z[:-1], np.cumsum([8 * (n + 1), 2 * (n + 1), 8 * n])), (8, 2, 8, 2)))
    stats = solver.stats()
    return Solution(nodes * z[-1], x, np.stack([u[:-1], um, u[1:]], axis=1), stats["iter_count"], stats["success"],
                    stats["return_status"])
