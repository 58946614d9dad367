"""A planning service and an executor, over DDS."""

from __future__ import annotations

import dataclasses
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any, Union

from fjr import _core
from fjr.errors import BadInput, Error, raise_for
from fjr.planning import Plan
from fjr.request import Document, RequestLike
from fjr.robot import Robot

Pair = tuple[float, float]


class Refused(Error):
    """A service or an executor did not take what it was sent, for a reason that may be gone a moment later: its queue
    is full, the arm does not rest, a trajectory is not known any more."""

    def __init__(self, state: str, reason: str) -> None:
        super().__init__(state, reason)
        self.state, self.reason = state, reason

    def __str__(self) -> str:
        return f"{self.state}: {self.reason}"


class ServedPlan(Plan):
    """A plan from a service. It has no solution for warm starts."""

    def __init__(self, core: _core.Plan, trajectory_id: str, solve_time: float, wait_time: float) -> None:
        super().__init__(core)
        self.trajectory_id = trajectory_id
        """By which :meth:`Client.execute` has it executed."""
        self.solve_time = solve_time
        """[s]"""
        self.wait_time = wait_time
        """In the service's queue [s]."""


@dataclasses.dataclass(frozen=True)
class Execution:
    """How an executor fared with a trajectory. Pairs are joint 1 and joint 2."""

    code: int
    """FollowJointTrajectory's: 0 for success, otherwise below 0; -6 where the executor refused a repetition's rows."""
    name: str
    """``SUCCESSFUL``, ``PATH_TOLERANCE_VIOLATED``, ..."""
    sentence: str
    link_error: Pair
    """Largest, by the encoders [rad]."""
    link_error_rms: Pair
    """[rad]"""
    final_link_error: Pair
    """[rad]"""
    residual_vibration: Pair
    """Largest distance from the goal after the end [rad]."""
    feedback_torque: Pair
    """Largest [N m]."""
    log_file: str
    """On the executor's machine; empty: none."""

    @property
    def successful(self) -> bool:
        return self.code == 0

    def __bool__(self) -> bool:
        return self.successful


@dataclasses.dataclass(frozen=True)
class Overview:
    """Who is there."""

    services: list[dict[str, Any]]
    """``instance``, ``robot_id``, ``robot_hash``, ``version``, ``answers`` (False: a standby), ``uptime`` [s],
    ``queued``, ``workers``, ``solving``, ``solved``."""
    executors: list[dict[str, Any]]
    """``robot_id``, ``robot_hash``, ``mode``, ``time`` [s], and pairs ``q``, ``theta`` [rad], ``dq``, ``dtheta``
    [rad/s], ``tau`` [N m]."""
    strangers: str | None
    """Where no service was heard: one sentence on who lets nothing be seen."""


Listener = Callable[["_core.ServiceProgress"], Union[bool, None]]
Follower = Callable[["_core.ExecutionProgress"], Union[bool, None]]


class Client:
    """Asks a planning service (``fjr serve``), and through it an executor (``fjr executor``).

    domain: of DDS.
    robot_id: which arm; needed only where several are served.
    security: folder of credentials; without one what the environment variable FJR_SECURITY names.
    allow_insecure_network: beyond the loopback interface without DDS Security, where everybody can have the arm moved.
    find: how long to look for a service, and for an executor [s].
    silence: after which nobody is expected to answer any more [s].

    Everything here waits without the GIL. Ctrl-C cancels what was asked for, and so does a listener that returns
    ``False`` or raises; an arm under way is then brought to rest by its executor. Without a service: NoAnswer.
    """

    def __init__(
        self,
        *,
        domain: int = 0,
        robot_id: str = "",
        security: str | os.PathLike[str] | None = None,
        allow_insecure_network: bool = False,
        find: float = 3,
        silence: float = 10,
    ) -> None:
        if not 0 <= domain <= 230:
            raise ValueError(f"a domain is 0 to 230, not {domain}")
        self._robot_id = robot_id
        self._core = _core.Connection(
            domain, Path(security) if security is not None else None, allow_insecure_network, find, silence
        )

    def plan(
        self,
        request: RequestLike,
        *,
        name: str = "request",
        priority: int = 0,
        budget: float | None = None,
        progress: Listener | None = None,
        check: bool = True,
    ) -> ServedPlan:
        """Has a request planned.

        priority: larger goes first. budget: time that the service may take [s]. progress: called with the place in the
        queue, the time since arrival and what the search is doing. The others are as in :func:`fjr.plan`, and so is
        what is raised; beside that Refused, and NoAnswer.
        """
        answered = self._request(request, name, False, priority, budget, progress, None)
        return self._plan_of(answered, check)

    def plan_and_execute(
        self,
        request: RequestLike,
        *,
        name: str = "request",
        priority: int = 0,
        budget: float | None = None,
        progress: Listener | None = None,
        follow: Follower | None = None,
    ) -> tuple[ServedPlan, Execution]:
        """Has a request planned, and the arm moved as soon as there is a certified plan. The request may leave out its
        start: it is then wherever the arm rests.

        follow: called up to 20 times a second while the arm moves, with the time and the links' errors.
        """
        answered = self._request(request, name, True, priority, budget, progress, follow)
        return self._plan_of(answered, True), _execution_of(answered)

    def execute(self, trajectory: ServedPlan | str, *, follow: Follower | None = None) -> Execution:
        """Has the arm moved along what the service planned before: a plan of :meth:`plan`, or its ``trajectory_id``.

        Raises Refused where it is not known any more, or the arm does not rest at its start; an execution that ends
        early is no error: ask ``successful``.
        """
        return _execution_of(self._execute(trajectory, False, follow))

    def repeat(
        self, trajectory: ServedPlan | str, *, follow: Follower | None = None
    ) -> tuple[ServedPlan, Execution]:
        """Has the arm moved along it once more, corrected by what the motion's last run was off the plan: any run of
        the motion names it. A motion that has not run yet runs as it was planned.

        The plan that is returned has the corrected rows, and what was learnt in ``to_dict()["repetition"]``. Raises
        Refused as :meth:`execute` does, where the last run did not reach its end, and where no correction, nor the same rows
        again, would keep the limits.
        """
        answered = self._execute(trajectory, True, follow)
        return self._plan_of(answered, True), _execution_of(answered)

    def _execute(self, trajectory: ServedPlan | str, repeat: bool, follow: Follower | None) -> _core.Answered:
        identity = trajectory if isinstance(trajectory, str) else trajectory.trajectory_id
        answered = self._core.execute(identity, repeat, self._robot_id, _heard_by(None, follow))
        self._refuse(answered)
        return answered

    def overview(self, wait: float = 1) -> Overview:
        """Everybody heard within ``wait`` seconds."""
        services, executors, strangers = self._core.overview(wait)
        return Overview(services, executors, strangers)

    def _request(
        self,
        request: RequestLike,
        name: str,
        execute: bool,
        priority: int,
        budget: float | None,
        progress: Listener | None,
        follow: Follower | None,
    ) -> _core.Answered:
        document = Document.of(request, name)
        if document.text is None:
            path = Path(document.source)
            document = dataclasses.replace(document, text=_text_of(path), source=path.name)
        robot = document.value_at("robot")
        # The service has a robot of its own; a request for another one must not be planned for that.
        wanted = Robot.load(document.folder / robot).hash if isinstance(robot, str) else ""
        with document.explained():
            answered = self._core.request(
                document.source,
                document.text or "",
                execute,
                self._robot_id,
                wanted,
                priority,
                budget or 0,
                _heard_by(progress, follow),
            )
            if answered.plan is None and answered.bad_input:
                raise BadInput(document.source, answered.field, answered.sentence)
        return answered

    def _plan_of(self, answered: _core.Answered, check: bool) -> ServedPlan:
        core = answered.plan
        if core is None:
            raise Refused(answered.state, answered.sentence)
        plan = ServedPlan(core, answered.id, answered.solve_time, answered.wait_time)
        if check:
            raise_for(plan)
        return plan

    def _refuse(self, answered: _core.Answered) -> None:
        if answered.result is None:
            raise Refused(answered.state, answered.sentence)


def _text_of(path: Path) -> str:
    try:
        return path.read_text(encoding="utf-8")
    except (OSError, UnicodeError) as error:
        raise BadInput(str(path), "", f"cannot be read: {error}") from None


def _execution_of(answered: _core.Answered) -> Execution:
    result = answered.result
    if result is None:
        raise Refused(answered.state, answered.sentence)
    return Execution(**result)


def _heard_by(progress: Listener | None, follow: Follower | None) -> Callable[[Any], Any]:
    def listen(told: Any) -> bool | None:
        listener: Callable[[Any], bool | None] | None = (
            follow if isinstance(told, _core.ExecutionProgress) else progress
        )
        return listener(told) if listener is not None else None

    return listen
