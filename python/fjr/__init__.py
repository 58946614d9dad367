"""Certified motions for a two-joint arm with elastic gears.

>>> import fjr
>>> plan = fjr.plan({"start": {"q": [0, 0]}, "goal": {"q": [0.4, -0.3]}})
>>> plan.status
'certified'

Angles are in rad, times in s, torques in N m, all after the gear; columns of two are joint 1 and joint 2. All of it:
docs/python.md.
"""

from __future__ import annotations

from fjr._core import ExecutionProgress, Progress, ServiceProgress
from fjr._core import version as __version__
from fjr.batching import Batch, batch
from fjr.client import Client, Execution, Overview, Refused, ServedPlan
from fjr.errors import (
    BadInput,
    Cancelled,
    DeadlineExpired,
    Error,
    Infeasible,
    NoAnswer,
    NoPlan,
    NotConverged,
    Uncertified,
)
from fjr.experiments import ExperimentDesign, design_experiment
from fjr.identification import Estimate, Identification, Parameter, identify
from fjr.packed import PackedBatch
from fjr.planning import Plan, Price, Samples, plan
from fjr.request import Duration, Goal, Key, Request, Start, Via, keys
from fjr.robot import Robot
from fjr.simulation import Simulation, simulate
from fjr.verification import Verification, verify

__all__ = [
    "BadInput",
    "Batch",
    "Cancelled",
    "Client",
    "DeadlineExpired",
    "Duration",
    "Error",
    "Estimate",
    "Execution",
    "ExecutionProgress",
    "ExperimentDesign",
    "Goal",
    "Identification",
    "Infeasible",
    "Key",
    "NoAnswer",
    "NoPlan",
    "NotConverged",
    "Overview",
    "PackedBatch",
    "Parameter",
    "Plan",
    "Price",
    "Progress",
    "Refused",
    "Request",
    "Robot",
    "Samples",
    "ServedPlan",
    "ServiceProgress",
    "Simulation",
    "Start",
    "Uncertified",
    "Verification",
    "Via",
    "__version__",
    "batch",
    "design_experiment",
    "identify",
    "keys",
    "plan",
    "simulate",
    "verify",
]
