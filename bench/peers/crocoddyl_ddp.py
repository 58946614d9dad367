"""Crocoddyl's feasibility-driven DDP: fixed durations; action models in Python on functions that CasADi writes as C.

DDP has neither bounds on states nor constraints at the end: squared violations of limits, via points and goal are costs,
whose weight grows from one solve to the next, each begun from the last. Hessians are those of Gauss and Newton.
"""
import functools
import pathlib
import subprocess
import tempfile

import casadi as ca
import crocoddyl
import numpy as np

from trajectory import Solution

WEIGHTS = (1e2, 1e4, 1e6)  # of squared violations
SUBSTEPS = 2               # Runge-Kutta steps in an interval
MOST_ITERATIONS = 300      # of each solve
REACHED = 1e-3             # what the goal and via points may be missed by [rad, rad/s]


def cannot(problem):
    if problem.free:
        return "fixed durations only"
    return None


def versions():
    compiler = subprocess.run(["gcc", "-dumpfullversion"], capture_output=True, text=True, check=True).stdout.strip()
    return f"Crocoddyl {crocoddyl.__version__}, derivatives by CasADi {ca.__version__} and gcc {compiler} -O2"


class Compiled:
    """CasADi functions through a C compiler, called through buffers that allocate nothing."""

    def __init__(self, function, folder):
        name = function.name()
        code = ca.CodeGenerator(name)
        code.add(function)
        source = code.generate(f"{folder}/")
        library = f"{folder}/{name}.so"
        subprocess.run(["gcc", "-O2", "-shared", "-fPIC", source, "-o", library, "-lm"], check=True)
        self._function = ca.external(name, library)
        self._buffer, self._run = self._function.buffer()
        self._in = [np.zeros(function.numel_in(i)) for i in range(function.n_in())]
        self._out = [np.zeros(function.size_out(i), order="F") for i in range(function.n_out())]
        for i, argument in enumerate(self._in):
            self._buffer.set_arg(i, memoryview(argument))
        for i, result in enumerate(self._out):
            self._buffer.set_res(i, memoryview(result.T))

    def __call__(self, *arguments):
        """Views of the results, until the next call."""
        for mine, argument in zip(self._in, arguments):
            mine[:] = argument
        self._run()
        return self._out


def functions(arm, weights, folder):
    """calc: (x, u, p) -> next x, cost; calc_diff: its derivatives. p = (h, weight of violations, mask, target): where the
    mask is 1, x is wanted at the target. At the end of the motion h is 0."""
    x, u, p = ca.SX.sym("x", 8), ca.SX.sym("u", 2), ca.SX.sym("p", 18)
    h, weight, mask, target = p[0], p[1], p[2:10], p[10:18]

    def running(y, share):
        return ca.sqrt(share * h) * ca.vertcat(np.sqrt(weights.get("effort", 0)) * arm.torque(y, u),
                                               np.sqrt(weights.get("link_acceleration", 0)) * arm.acceleration(y))

    y, d, residuals = x, h / SUBSTEPS, []
    for _ in range(SUBSTEPS):
        k1 = arm.f(y, u)
        k2 = arm.f(y + d / 2 * k1, u)
        k3 = arm.f(y + d / 2 * k2, u)
        k4 = arm.f(y + d * k3, u)
        middle, end = y + d / 2 * k2, y + d / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
        residuals += [running(point, part / 6 / SUBSTEPS) for point, part in ((y, 1), (middle, 4), (end, 1))]
        y = end
    limited = ca.vertcat(x[0:2], x[6:8], x[4:6] - x[0:2], arm.torque(x, u))
    bound = np.concatenate([arm.limits[name] for name in ("link_position", "motor_velocity", "spring_deflection", "torque")])
    residuals += [ca.sqrt(weight * h) * ca.fmax(0, ca.fabs(limited) - bound), ca.sqrt(weight) * mask * (x - target)]
    # At h = 0 the square roots have no derivative; h is a constant of each model and never differentiated.
    r = ca.vertcat(*residuals)
    rx, ru = ca.jacobian(r, x), ca.jacobian(r, u)
    derivatives = [ca.jacobian(y, x), ca.jacobian(y, u), rx.T @ r, ru.T @ r, rx.T @ rx, rx.T @ ru, ru.T @ ru]
    calc = ca.Function("calc", [x, u, p], [y, ca.sumsqr(r) / 2], {"cse": True})
    calc_diff = ca.Function("calc_diff", [x, u, p], [ca.densify(d) for d in derivatives], {"cse": True})
    return Compiled(calc, folder), Compiled(calc_diff, folder)


class Action(crocoddyl.ActionModelAbstract):
    NO_CONTROL = np.zeros(2)

    def __init__(self, calc, calc_diff, h, mask, target):
        crocoddyl.ActionModelAbstract.__init__(self, crocoddyl.StateVector(8), 2)
        self._calc, self._calc_diff = calc, calc_diff
        self.p = np.concatenate([[h, 0.0], mask, target])

    def calc(self, data, x, u=None):
        following, cost = self._calc(x, self.NO_CONTROL if u is None else u, self.p)
        data.xnext, data.cost = following.ravel(), cost.item()

    def calcDiff(self, data, x, u=None):
        fx, fu, lx, lu, lxx, lxu, luu = self._calc_diff(x, self.NO_CONTROL if u is None else u, self.p)
        data.Fx, data.Fu, data.Lx, data.Lu = fx, fu, lx.ravel(), lu.ravel()
        data.Lxx, data.Lxu, data.Luu = lxx, lxu, luu


def build(problem, arm, intervals, guess):
    nodes, vias = problem.mesh(intervals)
    n = len(nodes) - 1
    with tempfile.TemporaryDirectory() as folder:
        make = functools.partial(Action, *functions(arm, problem.weights, pathlib.Path(folder)))
    masks, targets = np.zeros((n + 1, 8)), np.zeros((n + 1, 8))
    masks[n], targets[n] = 1, arm.rest(problem.goal)
    for k, via in zip(vias, problem.via):
        masks[k, 0:2], targets[k, 0:2] = 1, via.q
        if via.dq is not None:
            masks[k, 2:4], targets[k, 2:4] = 1, via.dq
    steps = [*np.diff(nodes) * guess.duration, 0.0]
    models = [make(*row) for row in zip(steps, masks, targets)]
    states, controls = guess.at(nodes)
    controls = (controls[:-1] + controls[1:]) / 2
    return nodes * guess.duration, models, states, controls


def solve(times, models, states, controls):
    shooting = crocoddyl.ShootingProblem(states[0], models[:-1], models[-1])
    solver = crocoddyl.SolverFDDP(shooting)
    solver.th_stop = 1e-8
    xs, us, iterations, converged = list(states), list(controls), 0, True
    for weight in WEIGHTS:
        for model in models:
            model.p[1] = weight
        converged = solver.solve(xs, us, MOST_ITERATIONS, False)
        xs, us = list(solver.xs), list(solver.us)
        iterations += solver.iter
    x, u = np.array(xs), np.array(us)
    missed = max(np.max(np.abs(model.p[2:10] * (at - model.p[10:18]))) for model, at in zip(models, x))
    message = f"{'converged' if converged else 'iteration limit'}, goal and via points missed by {missed:.1g}"
    return Solution(times, x, np.repeat(u[:, None], 3, axis=1), iterations, converged and missed <= REACHED, message)
