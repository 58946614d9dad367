"""Drake's DirectCollocation with SNOPT: its own transcription (Hermite-Simpson with midpoints eliminated, controls linear
between nodes, costs by trapezoids) and first derivatives. Arm, cost and limits come from CasADi with their Jacobians."""
import importlib.metadata
import re
import tempfile

import casadi as ca
import numpy as np
from pydrake.planning import DirectCollocation
from pydrake.solvers import CommonSolverOption, SnoptSolver, SolverOptions
from pydrake.systems.framework import LeafSystem_
from pydrake.systems.scalar_conversion import TemplateSystem
from pydrake.trajectories import PiecewisePolynomial

from hermite_simpson import LONGEST, SHORTEST, running_cost
from lifted import Lifted
from trajectory import Solution



def cannot(problem):
    return None


def versions():
    return f"Drake {importlib.metadata.version('drake')} with its SNOPT"


@TemplateSystem.define("DrakeArm_")
def DrakeArm_(T):
    class Impl(LeafSystem_[T]):
        def _construct(self, lifted, converter=None):
            LeafSystem_[T].__init__(self, converter=converter)
            self.lifted = lifted
            self.DeclareContinuousState(8)
            self.torque = self.DeclareVectorInputPort("u", 2)

        def _construct_copy(self, other, converter=None):
            Impl._construct(self, other.lifted, converter=converter)

        def DoCalcTimeDerivatives(self, context, derivatives):
            x = context.get_continuous_state_vector().CopyToVector()
            derivatives.get_mutable_vector().SetFromVector(self.lifted(np.concatenate([x, self.torque.Eval(context)])))

    return Impl


def stacked(*sizes):
    parts = [ca.SX.sym(f"z{i}", size) for i, size in enumerate(sizes)]
    return ca.vertcat(*parts), parts


def build(problem, arm, intervals, guess):
    nodes, vias = problem.mesh(intervals)
    n = len(nodes) - 1
    z, (x, u) = stacked(8, 2)
    system = DrakeArm_[float](Lifted(z, arm.f(x, u)))
    longest = LONGEST if problem.free else guess.duration
    shortest = SHORTEST if problem.free else guess.duration
    steps = np.diff(nodes)
    collocation = DirectCollocation(system, system.CreateDefaultContext(), n + 1, shortest * min(steps) * 0.99,
                                    longest * max(steps) * 1.01)
    program = collocation.prog()
    x_at, u_at = [collocation.state(k) for k in range(n + 1)], [collocation.input(k) for k in range(n + 1)]
    h = np.array([collocation.time_step(k)[0] for k in range(n)])
    if problem.free:
        collocation.AddEqualTimeIntervalsConstraints()
        collocation.AddDurationBounds(SHORTEST, LONGEST)
    else:
        program.AddBoundingBoxConstraint(steps * guess.duration, steps * guess.duration, h)

    limits = arm.limits
    path = Lifted(z, arm.torque(x, u))
    for k in range(n + 1):
        program.AddConstraint(path, -limits["torque"], limits["torque"], np.concatenate([x_at[k], u_at[k]]))
        program.AddBoundingBoxConstraint(-limits["link_position"], limits["link_position"], x_at[k][0:2])
        program.AddBoundingBoxConstraint(-limits["motor_velocity"], limits["motor_velocity"], x_at[k][6:8])
        program.AddLinearConstraint(np.hstack([-np.eye(2), np.eye(2)]), -limits["spring_deflection"],
                                    limits["spring_deflection"], np.concatenate([x_at[k][0:2], x_at[k][4:6]]))
    for k, at in ((0, problem.start), (n, problem.goal)):
        program.AddBoundingBoxConstraint(arm.rest(at), arm.rest(at), x_at[k])
    for k, via in zip(vias, problem.via):
        program.AddBoundingBoxConstraint(via.q, via.q, x_at[k][0:2])
        if via.dq is not None:
            program.AddBoundingBoxConstraint(via.dq, via.dq, x_at[k][2:4])

    if problem.weights.keys() - {"time"}:
        cost = running_cost(arm, problem.weights)
        piece, (step, x0, u0, x1, u1) = stacked(1, 8, 2, 8, 2)
        trapezoid = Lifted(piece, step / 2 * (cost(x0, u0) + cost(x1, u1)))
        for k in range(n):
            program.AddCost(lambda v: trapezoid(v)[0], np.concatenate([[h[k]], x_at[k], u_at[k], x_at[k + 1], u_at[k + 1]]))
    if "time" in problem.weights:
        program.AddLinearCost(np.full(n, problem.weights["time"]), 0, h)

    first = nodes * guess.duration
    states, controls = guess.at(nodes)
    collocation.SetInitialTrajectory(PiecewisePolynomial.FirstOrderHold(first, controls.T),
                                     PiecewisePolynomial.FirstOrderHold(first, states.T))
    return collocation, program


def solve(collocation, program):
    with tempfile.NamedTemporaryFile("r") as log:
        options = SolverOptions()
        options.SetOption(CommonSolverOption.kPrintFileName, log.name)
        for name, value in (("Major print level", 1), ("Major iterations limit", 3000), ("Iterations limit", 500000),
                            ("Major feasibility tolerance", 1e-6), ("Major optimality tolerance", 1e-5)):
            options.SetOption(SnoptSolver.id(), name, value)
        result = SnoptSolver().Solve(program, None, options)
        found = re.search(r"No\. of major iterations\s+(\d+)", log.read())
    u = collocation.GetInputSamples(result).T
    pieces = np.stack([u[:-1], (u[:-1] + u[1:]) / 2, u[1:]], axis=1)
    return Solution(collocation.GetSampleTimes(result), collocation.GetStateSamples(result).T, pieces,
                    int(found[1]), result.is_success(),
                    f"{result.get_solution_result().name}, SNOPT's info {result.get_solver_details().info}")
