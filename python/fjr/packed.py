"""Batches in few files, which many machines plan: docs/cluster.md."""

from __future__ import annotations

import json
import os
import sqlite3
import tempfile
import zlib
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fjr.errors import BadInput
from fjr.planning import Plan

if TYPE_CHECKING:
    import pandas


class PackedBatch:
    """A packed batch, ``fjr batch prepare --out FOLDER``: its table of results and its plans, read where they are.

    The table is that of the last ``fjr batch gather``; the plans are there as soon as they are planned, also while others
    are. Raises BadInput where there is no such batch.
    """

    def __init__(self, folder: str | os.PathLike[str]) -> None:
        self.folder = Path(folder)
        if not (self.folder / "manifest.sqlite").exists():
            raise BadInput(str(self.folder), "", "holds no manifest.sqlite: it is no packed batch (fjr batch prepare)")

    def to_pandas(self) -> pandas.DataFrame:
        """The table, indexed by name. Needs pandas."""
        import pandas

        return pandas.DataFrame(self.rows).set_index("name")

    @property
    def rows(self) -> list[dict[str, Any]]:
        """For each request ``name``, ``status``, ``reason``, ``duration`` [s], ..., in the order of the names; terms and
        axes are called ``terms.time``, ``axes.goal.q[0]``. Raises BadInput where nothing was gathered yet."""
        if not (self.folder / "results.sqlite").exists():
            raise BadInput(str(self.folder), "", "holds no results.sqlite yet (fjr batch gather)")
        with closing(_open(self.folder / "results.sqlite")) as results:
            results.row_factory = sqlite3.Row
            return [dict(row) for row in results.execute("SELECT * FROM results")]

    @property
    def statuses(self) -> dict[str, int]:
        """How many there are of each status; ``open`` are those that were not planned yet."""
        counts: dict[str, int] = {}
        for row in self.rows:
            counts[row["status"]] = counts.get(row["status"], 0) + 1
        return counts

    def __len__(self) -> int:
        with closing(_open(self.folder / "manifest.sqlite")) as manifest:
            return int(manifest.execute("SELECT count(*) FROM requests").fetchone()[0])

    def __iter__(self) -> Iterator[str]:
        """The names."""
        with closing(_open(self.folder / "manifest.sqlite")) as manifest:
            return iter([name for (name,) in manifest.execute("SELECT name FROM requests")])

    def files(self, name: str) -> dict[str, bytes]:
        """What ``fjr plan`` has written for it: plan.json, trajectory.csv, solution.cbor. Empty where it was not planned
        yet. Raises KeyError where there is no such request."""
        with closing(_open(self.folder / "manifest.sqlite")) as manifest:
            found = manifest.execute("SELECT chunk FROM requests WHERE name = ?", [name]).fetchone()
        if found is None:
            raise KeyError(name)
        file = self.folder / "chunks" / f"{found[0]:05}.sqlite"
        if not file.exists():
            return {}
        with closing(_open(file)) as chunk:
            packed = chunk.execute("SELECT file, deflated FROM files WHERE name = ? AND previous = 0", [name])
            return {file: zlib.decompress(deflated) for file, deflated in packed}

    def __getitem__(self, name: str) -> Plan:
        """The plan of that name. Raises KeyError where there is no such request or it was not planned yet, BadInput for
        one that was refused."""
        files = self.files(name)
        if not files:
            raise KeyError(name)
        with tempfile.TemporaryDirectory() as folder:
            for file, content in files.items():
                (Path(folder) / file).write_bytes(content)
            return Plan.load(folder)

    def plan_json(self, name: str) -> dict[str, Any]:
        """plan.json of that name (docs/plan-json.md), without reading the motion. Raises KeyError as ``[]`` does."""
        document: dict[str, Any] = json.loads(self.files(name)["plan.json"])
        return document

    def __repr__(self) -> str:
        return f"<fjr.PackedBatch of {len(self)} in {self.folder}>"


def _open(file: Path) -> sqlite3.Connection:
    """Not made where it is not there; opened to be written to, for a process that was killed may have left something to
    be undone."""
    return sqlite3.connect(f"{file.resolve().as_uri()}?mode=rw", uri=True, timeout=60)
