"""Planning a request, and what comes of it."""

from __future__ import annotations

import dataclasses
import html
import json
import os
import warnings
from collections.abc import Callable
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fjr import _core
from fjr.errors import raise_for
from fjr.request import Document, RequestLike
from fjr.robot import Robot, RobotLike, robot_of

if TYPE_CHECKING:
    import matplotlib.figure
    import pandas

Array = NDArray[np.float64]

ProgressListener = Callable[["_core.Progress"], Union[bool, None]]
"""Called up to 20 times a second, in the calling thread; what it raises ends the planning, and so does ``False``."""


@dataclasses.dataclass(frozen=True)
class Samples:
    """A motion at some instants. Columns of two are joint 1 and joint 2."""

    time: Array
    """(n) [s]"""
    q: Array
    """(n, 2) angles of the links [rad]"""
    dq: Array
    """(n, 2) [rad/s]"""
    theta: Array
    """(n, 2) angles of the motors, after the gear [rad]"""
    dtheta: Array
    """(n, 2) [rad/s]"""
    tau: Array
    """(n, 2) torques of the motors, after the gear [N m]"""


class Price(NamedTuple):
    """What a limit costs: the shadow price of one that the motion stands on."""

    name: str
    joint: int | None
    """1 or 2; None for the tip."""
    limit: float
    unit: str
    worth: float
    """By how much the objective falls per unit of the limit."""
    saved_by_1_percent: float
    """What one per cent more of it would save, in units of the objective."""
    active_share: float
    """Of the duration that the motion stands on it, 0 to 1."""
    active: list[tuple[float, float]]
    """When, from and to [s]."""


class Plan:
    """A planned motion, or why there is none.

    The arrays are views of the plan's own memory: they are not copied, cannot be written to, and stay when the plan is
    gone. Their rows are those of trajectory.csv: times strictly increase, and are not equally far apart.

    >>> import fjr
    >>> plan = fjr.plan({"start": {"q": [0, 0]}, "goal": {"q": [0.4, -0.3]}})
    >>> plan.status, plan.q.shape == (len(plan), 2), plan.q[-1].round(9).tolist()
    ('certified', True, [0.4, -0.3])
    >>> plan.interpolate(plan.duration / 2).tau.shape
    (1, 2)
    """

    def __init__(self, core: _core.Plan) -> None:
        self._core = core

    @classmethod
    def load(cls, folder: str | os.PathLike[str]) -> Plan:
        """A plan from its folder, as ``fjr plan --out`` or :meth:`save` left it.

        Raises BadInput where there is none, or files do not belong together.
        """
        return cls(_core.Plan.load(Path(folder)))

    # ---- what became of it ----

    @cached_property
    def _json(self) -> dict[str, Any]:
        document: dict[str, Any] = json.loads(self._core.to_json())
        return document

    def to_dict(self) -> dict[str, Any]:
        """plan.json, all of it (docs/plan-json.md); a new copy each time."""
        document: dict[str, Any] = json.loads(self._core.to_json())
        return document

    @property
    def name(self) -> str:
        """Of the request: its file's, without extension."""
        return str(self._json["request"])

    @property
    def status(self) -> str:
        """``certified``, ``infeasible``, ``not_converged``, ``uncertified``, ``deadline``, ``cancelled`` or
        ``bad_input``."""
        return str(self._json["status"])

    @property
    def certified(self) -> bool:
        return self.status == "certified"

    @property
    def reason(self) -> str | None:
        """One sentence; None of a certified plan."""
        reason: str | None = self._json["reason"]
        return reason

    @property
    def duration(self) -> float:
        """[s]; NaN without a motion."""
        return _number(self._json["duration"])

    @property
    def objective(self) -> float:
        """The weighted sum that was minimised; NaN without a motion."""
        return _number(self._json["objective"]["total"])

    @property
    def terms(self) -> dict[str, float]:
        """All terms of an objective, weighted or not, unweighted; those that cannot be told are NaN. Units are in
        docs/requests.md."""
        return {name: _number(value) for name, value in self._json["objective"]["terms"].items()}

    @property
    def certificate(self) -> dict[str, Any]:
        """The certificate, as in plan.json; empty without a motion."""
        return self.to_dict()["certificate"] or {}

    @property
    def prices(self) -> list[Price]:
        """The limits that the motion stands on, those first that cost most."""
        sensitivity = self._json["sensitivity"] or {"limits": []}
        prices = [
            Price(
                limit["name"],
                limit["joint"],
                limit["limit"],
                limit["unit"],
                _number(limit["worth"]),
                _number(limit["saved_by_1_percent"]),
                limit["active_share"],
                [(first, last) for first, last in limit["active"]],
            )
            for limit in sensitivity["limits"]
            if limit["active_share"] > 0
        ]
        return sorted(prices, key=lambda price: -abs(price.saved_by_1_percent))

    @property
    def robot(self) -> Robot:
        """The arm that it was planned for, with the request's payload."""
        return Robot(self._core.robot)

    # ---- the motion ----

    def __len__(self) -> int:
        """The number of rows; 0 without a motion."""
        return len(self.time)

    @property
    def time(self) -> Array:
        """(n) [s], strictly increasing from 0; two rows 1e-6 s apart where a torque jumps."""
        return self._core.time

    @property
    def q(self) -> Array:
        """(n, 2) angles of the links [rad]; 0 hangs straight down, the second is relative to link 1."""
        return self._core.q

    @property
    def dq(self) -> Array:
        """(n, 2) [rad/s]"""
        return self._core.dq

    @property
    def theta(self) -> Array:
        """(n, 2) angles of the motors, after the gear [rad]"""
        return self._core.theta

    @property
    def dtheta(self) -> Array:
        """(n, 2) [rad/s]"""
        return self._core.dtheta

    @property
    def tau(self) -> Array:
        """(n, 2) torques of the motors, after the gear [N m]"""
        return self._core.tau

    def interpolate(self, times: ArrayLike) -> Samples:
        """The motion between its rows: positions are cubic Hermite, velocities their derivative, torques linear.

        times: one or more, in any order [s]; those outside are taken to the nearer end. Returns (n) and (n, 2) arrays.
        Raises ValueError for times that are not finite, BadInput without a motion.
        """
        instants = np.ascontiguousarray(np.atleast_1d(np.asarray(times, dtype=np.float64)))
        if instants.ndim != 1 or not np.isfinite(instants).all():
            raise ValueError("times must be finite numbers, one or a list of them")
        return Samples(**self._core.interpolate(instants))

    def mean_torque(self, tick: float = 0.001) -> Array:
        """(n, 2) what a drive that holds its torque for a tick is to be given, tick by tick from the start [N m]: the
        means of the piecewise linear torque, as the executor commands them before feedback. Beyond the end the last
        row's torque is held.

        tick: [s], 0.0001 to 0.1, as in ``fjr export``. Raises ValueError for another one, BadInput without a motion.
        """
        if not 1e-4 <= tick <= 0.1:
            raise ValueError(f"a tick is 0.0001 to 0.1 s, not {tick}")
        return self._core.mean_torque(tick)

    # ---- files and views ----

    def save(
        self, folder: str | os.PathLike[str], *, report: bool = False, keep_uncertified: bool = False
    ) -> list[str]:
        """Stores it as ``fjr plan --out`` does, byte for byte: plan.json, and of a certified plan trajectory.csv and
        solution.cbor. Earlier results are replaced all at once; a certified plan among them is kept in ``previous``.

        report: report.html too. keep_uncertified: the motion of an uncertified plan too, under another name.
        Returns the paths of what was written.
        """
        return self._core.save(Path(folder), report, keep_uncertified)

    def to_pandas(self) -> pandas.DataFrame:
        """A table indexed by ``time`` [s], with the columns of trajectory.csv: q1, q2, dq1, ... Needs pandas."""
        import pandas

        names = ("q", "dq", "theta", "dtheta", "tau")
        columns = {f"{name}{joint + 1}": getattr(self, name)[:, joint] for name in names for joint in range(2)}
        table = pandas.DataFrame(columns, index=pandas.Index(self.time, name="time"))
        table.attrs["request"] = self.name
        return table

    def plot(self) -> matplotlib.figure.Figure:
        """Positions, deflections of the springs, velocities and torques with their limits. Needs matplotlib."""
        from fjr.plotting import plot_plan

        return plot_plan(self)

    def report(self) -> str:
        """The page that ``fjr report`` writes: the animated arm and everything about the plan. HTML that needs nothing
        but itself."""
        return self._core.page()

    def _repr_html_(self) -> str:
        page = html.escape(self.report())
        style = "width: 100%; height: 46em; border: 0"
        return f'<iframe srcdoc="{page}" style="{style}" title="{html.escape(self.name)}"></iframe>'

    def __repr__(self) -> str:
        motion = f", {self.duration:.6g} s, objective {self.objective:.6g}" if len(self) else ""
        return f"<fjr.Plan {self.name}: {self.status}{motion}>"


def plan(
    request: RequestLike,
    *,
    robot: RobotLike | None = None,
    name: str = "request",
    progress: ProgressListener | None = None,
    jobs: int = 0,
    deadline: float | None = None,
    starts: int | None = None,
    warm: Plan | str | os.PathLike[str] | None = None,
    linear_solver: str = "stage",
    proven: bool = False,
    check: bool = True,
) -> Plan:
    """Plans a request, as ``fjr plan`` does: the same request comes to the same bytes.

    request: a mapping with the keys of a request file, a :class:`fjr.Request`, or the path of such a file.
    robot: the arm, or its robot.yaml; without one the request's, or the one shipped with fjr.
    name: what a request that is no file is called in messages and files.
    progress: called with what is being done, up to 20 times a second; ``False`` from it cancels.
    jobs: threads; the plan does not depend on it. 0: as many as there are cores.
    deadline: wall time allowed [s].
    starts: of the optimiser; by the request and its objective without.
    warm: the plan of a similar request, or its folder: tried first, and instead of a search where it leads somewhere.
    linear_solver: ``stage``, which is fjr's own, or ``mumps``, or one of the HSL's.
    proven: certified only with bounds that hold with mathematical certainty; ``certificate["proof"]`` has them.
    check: raise unless the plan is certified.

    Other Python threads run meanwhile. Ctrl-C cancels: KeyboardInterrupt comes within a tenth of a second or so.

    Raises BadInput for a request that makes no sense; with ``check`` Infeasible, NotConverged, Uncertified,
    DeadlineExpired or Cancelled, which have the plan with the reason. Doubts about the robot are warnings.

    >>> import fjr
    >>> plan = fjr.plan(fjr.Request(start=fjr.Start(q=(0, 0)), goal=fjr.Goal(q=(0.4, -0.3))))
    >>> f"{plan.duration:.2f} s"
    '0.30 s'
    """
    document = Document.of(request, name)
    arm = robot_of(robot)
    before = Plan.load(warm) if isinstance(warm, (str, os.PathLike)) else warm
    _check_numbers(jobs, deadline, starts)
    with document.explained():
        planned = Plan(
            _core.plan(
                document.text,
                document.source,
                document.folder,
                arm._core if arm else None,
                before._core if before else None,
                jobs,
                deadline or 0,
                starts or 0,
                linear_solver,
                proven,
                progress,
            )
        )
    for doubt in planned.robot.doubts:
        warnings.warn(f"robot: {doubt}", stacklevel=2)
    if check:
        raise_for(planned)
    return planned


def _check_numbers(jobs: int, deadline: float | None, starts: int | None) -> None:
    if not 0 <= jobs <= 1024:
        raise ValueError(f"jobs must be 0 to 1024, not {jobs}")
    if deadline is not None and not (np.isfinite(deadline) and deadline > 0):
        raise ValueError(f"a deadline is a number of seconds above 0, not {deadline}")
    if starts is not None and not 1 <= starts <= 100:
        raise ValueError(f"starts must be 1 to 100, not {starts}")


def _number(value: float | None) -> float:
    return float("nan") if value is None else float(value)
