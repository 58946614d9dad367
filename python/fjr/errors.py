"""What can go wrong, as exceptions.

>>> import fjr
>>> try:
...     fjr.plan({"start": {"q": [0, 0]}, "goal": {"q": [1.2, -9]}})
... except fjr.BadInput as error:
...     print(error.field, error.value, error.allowed)
goal.q[1] -9 within `link_position`
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from fjr.planning import Plan


class Error(Exception):
    """Whatever fjr raises by itself."""


class BadInput(Error, ValueError):
    """Input that makes no sense, or contradicts the robot. Nothing was planned."""

    source: str
    """What the input is called: a file, or the name of a request."""
    field: str
    """Path of the field within it, as ``goal.q[1]``; empty where it is about no field."""
    reason: str
    """What is wrong, a clause with the value and what would be allowed."""
    value: Any
    """What was given there; None where nothing was, or where that cannot be said."""
    allowed: str
    """What requests may have there in general, as ``fjr keys`` says; empty for what is no field of a request."""

    def __init__(self, source: str, field: str, reason: str, value: Any = None, allowed: str = "") -> None:
        super().__init__(source, field, reason, value, allowed)
        self.source, self.field, self.reason, self.value, self.allowed = source, field, reason, value, allowed

    def __str__(self) -> str:
        return ": ".join(part for part in (self.source, self.field, self.reason) if part)


class NoPlan(Error):
    """A request that led to no certified plan."""

    plan: Plan
    """What became of it: the whole of plan.json, and the motion of an uncertified plan."""

    def __init__(self, plan: Plan) -> None:
        super().__init__(plan)
        self.plan = plan

    @property
    def status(self) -> str:
        """As in plan.json: ``infeasible``, ``not_converged``, ..."""
        return self.plan.status

    @property
    def reason(self) -> str:
        """One sentence."""
        return self.plan.reason or ""

    def __str__(self) -> str:
        return f"{self.plan.name}: {self.status}: {self.reason}"


class Infeasible(NoPlan):
    """The limits exclude every motion that was found."""

    @property
    def infeasibility(self) -> dict[str, Any]:
        """What is in the way, and the least changes that would make it possible: ``limit``, ``joint``, ``time`` [s],
        ``relaxations``, ``shortest_duration`` [s]. Empty where that is not known."""
        known: dict[str, Any] | None = self.plan.to_dict()["infeasibility"]
        return known or {}


class NotConverged(NoPlan):
    """The optimiser stopped without a solution."""


class Uncertified(NoPlan):
    """There is a motion, but its certificate failed: ``error.plan.certificate["failures"]`` says why."""


class DeadlineExpired(NoPlan):
    """The deadline passed before there was a certified plan."""


class Cancelled(NoPlan):
    """The caller had it stopped."""


class NoAnswer(Error):
    """No service or executor was found, or it fell silent. The message says what to look at."""


_BY_STATUS: dict[str, type[NoPlan]] = {
    "infeasible": Infeasible,
    "not_converged": NotConverged,
    "uncertified": Uncertified,
    "deadline": DeadlineExpired,
    "cancelled": Cancelled,
}


def raise_for(plan: Plan) -> None:
    """Raises what goes with the plan's status; nothing where it is certified."""
    if plan.status == "bad_input":
        raise BadInput(plan.name, "", plan.reason or "")
    if plan.status in _BY_STATUS:
        raise _BY_STATUS[plan.status](plan)
