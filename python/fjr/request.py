"""Requests: what a motion is to be.

A request is a mapping with the keys of a request file, a :class:`Request`, or the path of such a file. All keys, their
units and what they may be: docs/requests.md, or :func:`keys`.
"""

from __future__ import annotations

import dataclasses
import json
import os
import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NamedTuple, Union

import numpy as np

from fjr import _core
from fjr.errors import BadInput

Pair = Sequence[float]
"""Two numbers, of joint 1 and joint 2, or x and y."""


@dataclasses.dataclass(kw_only=True)
class Start:
    """State at the start, at rest unless velocities are given."""

    q: Pair | None = None
    """Link angles [rad]."""
    dq: Pair | None = None
    """Link velocities [rad/s]."""
    theta: Pair | None = None
    """Motor angles [rad]."""
    dtheta: Pair | None = None
    """Motor velocities [rad/s]."""


@dataclasses.dataclass(kw_only=True)
class Goal:
    """State at the end: ``q``, or a position of the tip."""

    q: Sequence[float | str] | None = None
    """Link angles [rad]; one of the two may be ``"free"``."""
    dq: Pair | str | None = None
    """Link velocities [rad/s], or ``"free"``; at rest without."""
    theta: Pair | None = None
    """Motor angles of a moving goal [rad]."""
    dtheta: Pair | None = None
    """Motor velocities of a moving goal [rad/s]."""
    tip: Pair | None = None
    """Position of the tip [m]."""
    elbow: str | None = None
    """``any``, ``left`` or ``right``."""
    tip_velocity: Pair | None = None
    """Velocity of the tip [m/s]."""


@dataclasses.dataclass(kw_only=True)
class Via:
    """A point that is passed."""

    q: Pair
    """Link angles [rad]."""
    time: float | None = None
    """When, with a fixed duration [s]."""
    dq: Pair | None = None
    """Link velocities [rad/s]."""
    release: bool | None = None
    """What is thrown is let go here."""


@dataclasses.dataclass(kw_only=True)
class Duration:
    """A free duration within bounds."""

    min: float | None = None
    """[s]"""
    max: float | None = None
    """[s]"""


Part = Mapping[str, Any]


@dataclasses.dataclass(kw_only=True)
class Request:
    """A motion to be planned; every field is a key of a request file, and None what is left out.

    >>> request = Request(start=Start(q=(0, 0)), goal=Goal(q=(1.2, -0.8)), limits={"torque": (10, 4)})
    >>> request.to_dict()
    {'start': {'q': (0, 0)}, 'goal': {'q': (1.2, -0.8)}, 'limits': {'torque': (10, 4)}}
    """

    start: Start | Part | None = None
    goal: Goal | Part
    robot: str | None = None
    """File, relative to the working directory; none: the one shipped with fjr."""
    duration: float | str | Duration | Part | None = None
    """[s], or ``"free"``, or bounds."""
    objective: str | Mapping[str, float | Mapping[str, float]] | None = None
    """A preset (``fastest``, ``gentle``, ``efficient``), or weights of the terms, each a number or ``{"weight": w}``."""
    via: Sequence[Via | Part] | None = None
    obstacles: Sequence[Part] | None = None
    """Discs ``{"center": (x, y), "radius": r, "margin": m}`` [m]."""
    walls: Sequence[Part] | None = None
    """Lines ``{"point": (x, y), "normal": (x, y), "margin": m}`` [m]."""
    tip: Part | None = None
    """Where the tip may be: ``box``, ``line`` or ``arc``."""
    path: Part | None = None
    """Straight lines in the joint angles: ``{"points": [...], "tolerance": t}`` [rad]."""
    limits: Part | None = None
    """Magnitudes that are not exceeded, two numbers for the two joints or one for the tip."""
    sample_period: float | None = None
    """Between rows [s]."""
    seed: int | None = None
    payload: float | Part | None = None
    """At the tip [kg], or ``{"mass": kg, "inertia": kg m^2}``."""
    method: str | None = None
    """Collocation scheme."""
    search: str | None = None
    """``quick``, ``default`` or ``thorough``."""
    robust: Part | None = None
    """``{"confidence": 0.99}``: margins for the arms that the robot's uncertainty leaves possible."""
    proven: bool | None = None
    """Certified only with bounds that hold with mathematical certainty."""

    def to_dict(self) -> dict[str, Any]:
        """As the mapping of a request file: nothing that is None."""
        mapping: dict[str, Any] = _plain(self)
        return mapping


RequestLike = Union[Mapping[str, Any], Request, str, "os.PathLike[str]"]
"""What :func:`fjr.plan` plans."""


class Key(NamedTuple):
    """A key of a request, as docs/requests.md has it."""

    name: str
    """With those above it: ``goal.q``, ``via[].time``."""
    unit: str
    meaning: str
    otherwise: str
    """What holds where it is left out."""
    allowed: str


def keys() -> list[Key]:
    """All keys of requests.

    >>> [key for key in keys() if key.name == "sample_period"]  # doctest: +NORMALIZE_WHITESPACE
    [Key(name='sample_period', unit='s', meaning='between published rows', otherwise='0.001',
         allowed='0.0005 to 0.005; at most 32768 rows come of it; where nothing is said, long motions have them farther apart')]
    """
    return [Key(*key) for key in _core.keys()]


def _plain(value: Any) -> Any:
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        fields = {field.name: getattr(value, field.name) for field in dataclasses.fields(value)}
        return {name: _plain(part) for name, part in fields.items() if part is not None}
    if isinstance(value, Mapping):
        return {key: _plain(part) for key, part in value.items()}
    if isinstance(value, list):
        return [_plain(part) for part in value]
    if isinstance(value, tuple):
        return tuple(_plain(part) for part in value)
    return value


def _number(value: Any) -> Any:
    """What JSON does not know by itself."""
    if isinstance(value, np.ndarray):
        return value.tolist()
    if isinstance(value, np.generic):
        return value.item()
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    raise TypeError(f"a request cannot hold {value!r}")


@dataclasses.dataclass(frozen=True)
class Document:
    """A request as the library reads it."""

    text: str | None
    """None: it is in the file ``source``."""
    source: str
    folder: Path
    """That a relative ``robot`` is relative to."""

    @staticmethod
    def of(request: RequestLike, name: str = "request") -> Document:
        if isinstance(request, (str, os.PathLike)):
            path = Path(os.fspath(request))
            return Document(None, str(path), path.parent)
        if not isinstance(request, (Mapping, Request)):
            raise TypeError(
                f"a request is a mapping, a fjr.Request or the path of a file, not {type(request).__name__}"
            )
        text = json.dumps(_plain(request), default=_number, ensure_ascii=False)
        return Document(text, name, Path.cwd())

    def value_at(self, field: str) -> Any:
        """What stands there; None where nothing does."""
        try:
            flow = _core.value_at(self.text, self.source, field) if field else None
        except BadInput:
            return None
        if flow is None:
            return None
        try:
            return json.loads(flow)
        except ValueError:
            return flow

    @contextmanager
    def explained(self) -> Iterator[None]:
        """Adds to a BadInput what was given, and what may be."""
        try:
            yield
        except BadInput as error:
            if error.source != self.source:
                raise
            name = re.sub(r"\[\d+\]", "[]", error.field)
            told = {key.name: key.allowed or key.meaning for key in keys()}
            allowed = told.get(name) or told.get(name.removesuffix("[]"), "")
            raise BadInput(error.source, error.field, error.reason, self.value_at(error.field), allowed) from None
