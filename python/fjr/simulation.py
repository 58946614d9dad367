"""A plan on a simulated arm, which need not be the one it was planned for."""

from __future__ import annotations

import dataclasses
from typing import TYPE_CHECKING

import numpy as np

from fjr import _core
from fjr.planning import Array, Plan, Samples
from fjr.robot import RobotLike, robot_of

if TYPE_CHECKING:
    import matplotlib.figure


@dataclasses.dataclass(frozen=True)
class Simulation(Samples):
    """What the arm did. Torques are as commanded, feedback included."""

    plan: Plan
    completed: bool
    """False: the integration broke down before the end."""
    failure: str
    """How; empty otherwise."""

    @property
    def link_error(self) -> Array:
        """(n, 2) how far the links are off the plan [rad]"""
        error: Array = self.q - self.plan.interpolate(self.time).q
        return error

    @property
    def residual(self) -> Array:
        """(2) how far each link comes off the goal from the end of the plan on [rad]. Raises ValueError for a run that
        broke down before."""
        after = self.time >= self.plan.duration
        if not after.any():
            raise ValueError(
                f"the run broke down at {self.time[-1]:.6g} s, before the end of the plan at {self.plan.duration:.6g} s "
                f"from which on it would have a residual: {self.failure}"
            )
        residual: Array = np.abs(self.q[after] - self.plan.q[-1]).max(axis=0)
        return residual

    @property
    def max_link_error(self) -> float:
        """The largest of both joints [rad]."""
        return float(np.abs(self.link_error).max())

    def plot(self) -> matplotlib.figure.Figure:
        """The motion beside the plan, and how far the links are off it. Needs matplotlib."""
        from fjr.plotting import plot_simulation

        return plot_simulation(self)

    def __repr__(self) -> str:
        ended = "" if self.completed else f", broke down: {self.failure}"
        return f"<fjr.Simulation of {self.plan.name}: links within {self.max_link_error:.3g} rad of the plan{ended}>"


def simulate(
    plan: Plan,
    *,
    closed_loop: bool = True,
    executor: bool = False,
    true_robot: RobotLike | None = None,
    hold: float = 0,
) -> Simulation:
    """Rolls a plan out on the exact model, by the integrator behind every certificate.

    closed_loop: with the executor's motor-side feedback, on the exact state and at every instant, as the certificate
        has it; otherwise the planned torque alone.
    executor: as the executor does it: from encoder counts, with torques held for 1 ms ticks, within the drives' peak
        torque.
    true_robot: the arm that moves; without one that of the plan. Gains, encoders and drives are the plan's. It begins
        where the plan does; where that is rest, the motors are where this arm rests.

    hold: how long the arm is then held where the plan ends at rest, by the executor's law [s].

    The samples are the rows and instants between them at most 0.25 ms apart; with ``executor``, and while
    it is held, the ends of the ticks.
    Raises BadInput for a plan without a motion; ValueError for the executor without feedback, and for what cannot be held.

    >>> import fjr
    >>> plan = fjr.plan({"start": {"q": [0, 0]}, "goal": {"q": [0.4, -0.3]}})
    >>> softer = plan.robot.replace(spring={"stiffness": [19.5, 17.0]})
    >>> fjr.simulate(plan).max_link_error < 9.6e-5 < fjr.simulate(plan, true_robot=softer).max_link_error
    True
    """
    if executor and not closed_loop:
        raise ValueError("the executor is a closed loop")
    if not 0 <= hold <= 10:
        raise ValueError(f"an arm is held for 0 to 10 s, not {hold}")
    if hold > 0 and not (closed_loop and plan._core.ends_at_rest):
        raise ValueError("only an arm in closed loop, at rest, can be held")
    control = _core.Control.OPEN_LOOP
    if closed_loop:
        control = _core.Control.EXECUTOR if executor else _core.Control.CLOSED_LOOP
    arm = robot_of(true_robot)
    return Simulation(plan=plan, **plan._core.simulate(arm._core if arm else None, control, hold))
