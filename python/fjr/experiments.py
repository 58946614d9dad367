"""Experiments: motions that tell an arm's parameters best."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from fjr._program import run


class ExperimentDesign:
    """Certified motions, one after the other, and what they are expected to tell."""

    def __init__(self, folder: Path, design: dict[str, Any]) -> None:
        self.folder = folder
        """Of the requests, and of design.json."""
        self._design = design

    def to_dict(self) -> dict[str, Any]:
        """design.json (docs/identification.md)."""
        return self._design

    @property
    def duration(self) -> float:
        """[s] of all motions together."""
        return float(self._design["duration"])

    @property
    def requests(self) -> list[Path]:
        """The files, in the order in which they are to be executed: each starts where the one before it ended."""
        return [self.folder / motion["request"] for motion in self._design["motions"]]

    @property
    def standard_errors(self) -> dict[str, tuple[float, float]]:
        """Of each parameter, by its name in robot.yaml as ``spring.stiffness[0]``: before and after, as expected."""
        told = self._design["parameters"]
        return {name: (row["standard_error_before"], row["standard_error"]) for name, row in told.items()}

    def __len__(self) -> int:
        return len(self._design["motions"])

    def __repr__(self) -> str:
        return f"<fjr.ExperimentDesign of {len(self)} motions, {self.duration:.3g} s, in {self.folder}>"


def design_experiment(
    out: str | os.PathLike[str],
    *,
    robot: str | os.PathLike[str] | None = None,
    start: Sequence[float] = (0.0, 0.0),
    duration: float = 20.0,
    candidates: int = 16,
    seed: int = 1,
    widen: float | None = None,
    payload_known: bool = False,
) -> ExperimentDesign:
    """Plans motions that tell the arm's parameters best in a given time, as ``fjr experiment design`` does
    (docs/identification.md); ``Client.execute`` runs them, and ``fjr identify executed`` reads the logs.

    out: a folder that is empty or not there.
    robot: the robot.yaml of what is known so far; without one the one shipped with fjr.
    start: link angles where the arm rests before the first motion [rad].
    duration: of all motions together at most [s].
    candidates: how many are planned for each motion, of which the best is taken.
    seed: of the candidates.
    widen: take the standard errors of the robot file for so many times as large.
    payload_known: the mass at the tip is as in the robot file; otherwise it is taken for unknown within 0.5 kg.

    Ctrl-C ends it, nothing is written, and KeyboardInterrupt comes. Raises BadInput for what the program refuses.
    """
    folder = Path(out)
    words = ["--out", str(folder), "--start", *(repr(float(angle)) for angle in start)]
    words += ["--duration", str(duration), "--candidates", str(candidates), "--seed", str(seed)]
    words += [] if robot is None else ["--robot", os.fspath(robot)]
    words += [] if widen is None else ["--widen", str(widen)]
    words += ["--payload-known"] if payload_known else []
    return ExperimentDesign(folder, run(["experiment", "design", "--json", *words]))
