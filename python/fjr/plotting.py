"""Figures by matplotlib."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import matplotlib.pyplot as plt
import numpy as np

from fjr.planning import Array, Plan

if TYPE_CHECKING:
    import matplotlib.axes
    import matplotlib.figure

    from fjr.simulation import Simulation

_COLOURS = ("#1f77b4", "#d62728")


def plot_plan(plan: Plan) -> matplotlib.figure.Figure:
    """Positions, deflections of the springs, velocities of the motors and torques over time, each with its limits."""
    document = plan.to_dict()
    limits = document["resolved_request"]["limits"]
    middle = document["robot"]["limits"].get("link_middle", (0, 0))
    figure, axes = plt.subplots(2, 2, sharex=True, figsize=(9, 6), layout="constrained")
    _pair(axes[0, 0], plan.time, plan.q, "q [rad]", limits.get("link_position"), middle)
    _pair(axes[0, 1], plan.time, plan.theta - plan.q, "theta - q [rad]", limits.get("spring_deflection"))
    _pair(axes[1, 0], plan.time, plan.dtheta, "dtheta [rad/s]", limits.get("motor_velocity"))
    _pair(axes[1, 1], plan.time, plan.tau, "tau [N m]", limits.get("torque"))
    for axis in axes[1]:
        axis.set_xlabel("time [s]")
    axes[0, 0].legend()
    figure.suptitle(f"{plan.name}: {plan.status}, {plan.duration:.4g} s")
    return figure


def plot_simulation(run: Simulation) -> matplotlib.figure.Figure:
    """The links beside the plan, and how far they are off it."""
    figure, (motion, error) = plt.subplots(2, 1, sharex=True, figsize=(9, 6), layout="constrained")
    _pair(motion, run.time, run.q, "q [rad]", None)
    motion.plot(run.plan.time, run.plan.q, color="0.4", linewidth=0.8, linestyle="--", label="planned")
    motion.legend()
    _pair(error, run.time, run.link_error, "off the plan [rad]", None)
    error.set_xlabel("time [s]")
    figure.suptitle(f"{run.plan.name}: links within {run.max_link_error:.3g} rad")
    return figure


def _pair(
    axis: matplotlib.axes.Axes, time: Array, values: Array, label: str, limits: Any, middle: Any = (0, 0)
) -> None:
    """Limits are to either side of the middle."""
    for joint in range(2):
        axis.plot(time, values[:, joint], color=_COLOURS[joint], label=f"joint {joint + 1}")
        limit = limits[joint] if limits else None
        # Limits that are far away would flatten the curves.
        if limit is not None and limit < 2 * np.abs(values - np.asarray(middle)).max():
            for end in (middle[joint] - limit, middle[joint] + limit):
                axis.axhline(end, color=_COLOURS[joint], linewidth=0.6, linestyle=":")
    axis.set_ylabel(label)
