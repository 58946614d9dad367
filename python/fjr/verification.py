"""The certificate of any trajectory."""

from __future__ import annotations

import json
import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Union

from fjr import _core
from fjr.planning import Plan
from fjr.request import Document, RequestLike
from fjr.robot import Robot, RobotLike, robot_of


class Verification:
    """What an independent integrator made of a trajectory, as ``fjr verify --json`` says it.

    >>> import fjr
    >>> plan = fjr.plan({"start": {"q": [0, 0]}, "goal": {"q": [0.4, -0.3]}})
    >>> fjr.verify(plan).certified
    True
    """

    def __init__(self, document: dict[str, Any]) -> None:
        self._json = document

    def to_dict(self) -> dict[str, Any]:
        """All of it: the certificate as in plan.json, and ``complete``, ``starts_at_rest``, ``ends_at_rest``,
        ``robot_hash``, ``payload``, ``contradictions``."""
        return self._json

    @property
    def certified(self) -> bool:
        return bool(self._json["verdict"] == "certified")

    @property
    def failures(self) -> list[str]:
        """Why it is not certified, one sentence each."""
        return list(self._json["failures"])

    @property
    def contradictions(self) -> list[str]:
        """Between the file and the robot, one sentence each."""
        return list(self._json["contradictions"])

    @property
    def max_link_error(self) -> float:
        """Largest of both joints, in closed loop [rad]."""
        return float(self._json["closed_loop"]["max_link_error_rad"])

    def __bool__(self) -> bool:
        return self.certified

    def __repr__(self) -> str:
        verdict = "certified" if self.certified else "; ".join(self.failures)
        return f"<fjr.Verification {verdict}>"


def verify(
    trajectory: Union[Plan, str, os.PathLike[str]],
    *,
    request: RequestLike | None = None,
    robot: RobotLike | None = None,
    payload: float | Sequence[float] | None = None,
    proven: bool = False,
) -> Verification:
    """Certifies a trajectory: exactness, the limits of the robot and those that the file says it was planned with, and
    for a plan or its folder what the plan says that the request was: start, goal, via points, duration and task.

    trajectory: a plan, its folder, or the path of a trajectory.csv, whoever made it.
    request: as in :func:`fjr.plan`: certified only if this is what the trajectory does, whatever the plan says, with the
        request's robot and payload, and proven and robust where it asks for that.
    robot: the arm; without one that of the plan (for a file the one shipped with fjr), or with a request the one it
        names. A request that names one is refused beside another.
    payload: at the tip [kg], or that and its inertia [kg m^2]; without it the robot's, or else the file's. Not with a
        request, which has its own.
    proven: bounds that hold with mathematical certainty too: certified only if everything is proven.

    Raises BadInput for a file that is no trajectory, and for a request that makes no sense. A trajectory that fails is
    no error: ask ``certified``.
    """
    arm = robot_of(robot)
    if request is not None:
        if payload is not None:
            raise ValueError("the payload is the request's: it cannot be given beside it")
        return _as_requested(trajectory, request, arm, proven)
    given = None if payload is None else _pair(payload)
    if isinstance(trajectory, Plan):
        return Verification(json.loads(trajectory._core.verify((arm or trajectory.robot)._core, given, proven)))
    return Verification(json.loads(_core.verify_file(Path(trajectory), (arm or Robot.load())._core, given, proven)))


def _as_requested(
    trajectory: Union[Plan, str, os.PathLike[str]], request: RequestLike, arm: Robot | None, proven: bool
) -> Verification:
    asked = Document.of(request)
    document = asked.text, asked.source, asked.folder, arm._core if arm else None, proven
    with asked.explained():
        if isinstance(trajectory, Plan):
            return Verification(json.loads(trajectory._core.verify_request(*document)))
        return Verification(json.loads(_core.verify_file_request(Path(trajectory), *document)))


def _pair(payload: float | Sequence[float]) -> tuple[float, float]:
    mass, inertia = (payload, 0.0) if isinstance(payload, (int, float)) else payload
    if not (mass >= 0 and inertia >= 0):
        raise ValueError(f"a payload is not below 0: {payload}")
    return float(mass), float(inertia)
