"""The parameters of an arm."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Union

from fjr import _core


class Robot:
    """An arm: the numbers of a robot.yaml, checked as ``fjr plan`` checks them.

    >>> robot = Robot.load()
    >>> robot["spring"]["stiffness"]
    [20.48, 17.75]
    >>> softer = robot.replace(spring={"stiffness": [20.0, 17.5]})
    >>> softer["spring"]["stiffness"], softer.hash == robot.hash
    ([20.0, 17.5], False)
    """

    def __init__(self, core: _core.Robot) -> None:
        self._core = core

    @classmethod
    def load(cls, file: str | os.PathLike[str] | None = None) -> Robot:
        """Reads a robot.yaml; without one, the one shipped with fjr, or of the folder that FJR_CONFIG_DIR names.

        Raises BadInput for values that are missing, misspelt or unphysical.
        """
        return cls(_core.Robot.load(Path(file) if file is not None else _core.Robot.shipped_file()))

    @classmethod
    def from_dict(cls, values: Mapping[str, Any]) -> Robot:
        """From what :meth:`to_dict` gives. Raises BadInput as :meth:`load` does."""
        return cls(_core.Robot.from_json(json.dumps(values, default=float)))

    def to_dict(self) -> dict[str, Any]:
        """The values by section and name, in the units of docs/new-robot.md: lists of two, for joint 1 and joint 2.
        ``payload`` is ``{"mass": kg, "inertia": kg m^2}``; ``mounting``, of an arm that does not hang in an upright
        plane, ``{"inclination": rad, "down": rad}``."""
        values: dict[str, Any] = json.loads(self._core.to_json())
        return values

    def replace(
        self,
        *,
        payload: float | Mapping[str, float] | None = None,
        mounting: Mapping[str, float] | None = None,
        **sections: Mapping[str, Sequence[float]],
    ) -> Robot:
        """Another robot, of which these values are different. payload: [kg], or ``{"mass": kg, "inertia": kg m^2}``.
        mounting: ``{"inclination": rad, "down": rad}``, of which what is left out is upright and hanging at q = 0.

        Raises BadInput where there can be no such robot, and KeyError for a section that robots do not have.

        >>> table = Robot.load().replace(mounting={"inclination": 0})
        >>> table["mounting"]
        {'inclination': 0.0, 'down': 0.0}
        """
        values = self.to_dict()
        for section, entries in sections.items():
            if section not in values:
                raise KeyError(section)
            values[section].update({name: list(pair) for name, pair in entries.items()})
        if payload is not None:
            values["payload"] = dict(payload) if isinstance(payload, Mapping) else payload
        if mounting is not None:
            values["mounting"] = dict(mounting)
        return self.from_dict(values)

    def __getitem__(self, section: str) -> dict[str, Any]:
        part: dict[str, Any] = self.to_dict()[section]
        return part

    @property
    def hash(self) -> str:
        """SHA-256 over names and values, as in plan.json."""
        return self._core.hash

    @property
    def source(self) -> str:
        """The file that it was read from, or what it is called in messages."""
        return self._core.source

    @property
    def doubts(self) -> list[str]:
        """What is at odds with other values or with nature, a sentence each."""
        return self._core.doubts

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Robot) and self.hash == other.hash

    def __hash__(self) -> int:
        return hash(self.hash)

    def __repr__(self) -> str:
        return f"<fjr.Robot {self.source} {self.hash[:12]}>"


RobotLike = Union[Robot, str, "os.PathLike[str]"]
"""A robot, or the path of a robot.yaml."""


def robot_of(robot: RobotLike | None) -> Robot | None:
    return robot if robot is None or isinstance(robot, Robot) else Robot.load(robot)
