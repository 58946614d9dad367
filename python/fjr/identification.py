"""Identification: from logs of experiments to the parameters of an arm."""

from __future__ import annotations

import dataclasses
import os
import warnings as python_warnings
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import NamedTuple, Union

import numpy as np

from fjr import _core
from fjr.planning import Array
from fjr.robot import Robot

PROCEDURES: tuple[str, ...] = _core.procedures
"""In the order of the paper's section IV."""


class Parameter(NamedTuple):
    """A value that a log tells."""

    name: str
    value: float
    unit: str
    standard_error: float
    assumed: bool
    """Not identified: the log does not determine it."""


@dataclasses.dataclass(frozen=True)
class Estimate:
    """What one log tells, with its doubt."""

    procedure: str
    joint: int
    """1 or 2"""
    log: str
    """The file."""
    sha256: str
    """Of the file."""
    parameters: list[Parameter]
    covariance: Array
    """(m, m) of the parameters, in the products of their units; zero for what was assumed"""
    points: int
    """That the fit has used."""
    residual_rms: float
    """In ``residual_unit``."""
    residual_unit: str
    r_squared: float
    """Fraction of the variance that is explained."""
    warnings: list[str]

    def __getitem__(self, name: str) -> Parameter:
        for parameter in self.parameters:
            if parameter.name == name:
                return parameter
        raise KeyError(name)


class Identification:
    """What all logs tell together."""

    def __init__(self, core: _core.Identification, source: str, base: Path) -> None:
        self._core = core
        self._source = source
        self._base = base

    @property
    def estimates(self) -> list[Estimate]:
        """One for each log, in their order."""
        return [
            Estimate(
                e.procedure,
                e.joint,
                e.log,
                e.sha256,
                [Parameter(*p) for p in e.parameters],
                np.array(e.covariance),
                e.points,
                e.residual_rms,
                e.residual_unit,
                e.r_squared,
                e.warnings,
            )
            for e in self._core.estimates
        ]

    @property
    def warnings(self) -> list[str]:
        """Logs that disagree, and parameters that are far from what was known: a sentence each."""
        return self._core.warnings

    def write(
        self, file: str | os.PathLike[str], *, link_damping: bool = False, accept_inconsistent: bool = False
    ) -> Robot:
        """Writes a complete robot.yaml: what was identified, with standard errors, covariance and the logs it comes
        from; everything else as it was known. A file that is there stays where the new one would be unphysical.

        link_damping: write the identified damping of the links as the model's.
        accept_inconsistent: write even where two logs contradict each other.

        Returns the robot. Raises BadInput for contradictions, and for what there cannot be.
        """
        if not accept_inconsistent:
            self._core.refuse_contradictions(self._source)
        return Robot(self._core.write(Path(file), self._base, link_damping))

    def report(self) -> str:
        """Plots of fits and residuals with a table for each log: HTML that needs nothing but itself."""
        return self._core.report()

    def __repr__(self) -> str:
        return f"<fjr.Identification of {len(self._core.estimates)} logs>"


def identify(
    procedure: str,
    logs: Union[str, os.PathLike[str], Sequence[Union[str, "os.PathLike[str]"]]],
    *,
    joint: int | None = None,
    robot: str | os.PathLike[str] | None = None,
    columns: Mapping[str, str] | None = None,
) -> Identification:
    """Identifies parameters from logs, as ``fjr identify`` does (docs/identification.md).

    procedure: one of :data:`PROCEDURES`, or ``all`` over a folder of ``<experiment>_<joint>.csv``.
    logs: the log, or several of one experiment, or the folder.
    joint: 1 or 2, where the logs do not say.
    robot: the robot.yaml of what is known so far; without one the one shipped with fjr.
    columns: our names of columns and those in the logs, as ``{"q1": "link_1_position"}``.

    Raises BadInput for logs that cannot be what they are said to be. Doubts are warnings.
    """
    if procedure != "all" and procedure not in PROCEDURES:
        raise ValueError(f"{procedure!r} is none of all, {', '.join(PROCEDURES)}")
    if joint not in (None, 1, 2):
        raise ValueError(f"joint must be 1 or 2, not {joint}")
    files = [os.fspath(logs)] if isinstance(logs, (str, os.PathLike)) else [os.fspath(log) for log in logs]
    if not files or (procedure == "all" and len(files) != 1):
        raise ValueError("needs one folder" if procedure == "all" else "needs at least one log")
    base = Path(robot) if robot is not None else _core.Robot.shipped_file()
    found = Identification(_core.identify(procedure, files, joint or 0, dict(columns or {}), base), files[0], base)
    for warning in found.warnings:
        python_warnings.warn(warning, stacklevel=2)
    return found
