"""Many requests, on all cores."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Union

from fjr._program import run
from fjr.planning import Plan
from fjr.request import Document, Request, RequestLike

if TYPE_CHECKING:
    import pandas


class Batch:
    """What became of many requests, in the order of their names."""

    def __init__(self, folder: Path, summary: dict[str, Any]) -> None:
        self.folder = folder
        """Of the results, one folder for each request below it."""
        self._summary = summary

    def to_dict(self) -> dict[str, Any]:
        """summary.json (docs/command-line.md)."""
        return self._summary

    @property
    def rows(self) -> list[dict[str, Any]]:
        """The table of summary.csv: for each request ``name``, ``status``, ``reason``, ``duration`` [s], ..."""
        return list(self._summary["rows"])

    @property
    def statuses(self) -> dict[str, int]:
        """How many there are of each status."""
        return dict(self._summary["status"])

    def __len__(self) -> int:
        return len(self._summary["rows"])

    def __getitem__(self, name: str) -> Plan:
        """The plan of that name, read from its folder. Raises KeyError where there is no such request, BadInput for one
        that was refused."""
        if all(row["name"] != name for row in self._summary["rows"]):
            raise KeyError(name)
        return Plan.load(self.folder / name)

    def __iter__(self) -> Iterator[str]:
        """The names."""
        return (str(row["name"]) for row in self._summary["rows"])

    def to_pandas(self) -> pandas.DataFrame:
        """The table, indexed by name. Needs pandas."""
        import pandas

        return pandas.DataFrame(self._summary["rows"]).set_index("name")

    def __repr__(self) -> str:
        counts = ", ".join(f"{count} {status}" for status, count in self.statuses.items())
        return f"<fjr.Batch of {len(self)} in {self.folder}: {counts}>"


Requests = Union[Mapping[str, Union[Mapping[str, Any], Request]], Sequence[Union[str, "os.PathLike[str]"]]]


def batch(
    requests: Requests,
    *,
    out: str | os.PathLike[str],
    jobs: int | None = None,
    deadline: float | None = None,
    starts: int | None = None,
    report: bool = False,
) -> Batch:
    """Plans many requests, each in a process of its own, as ``fjr batch`` does; a second call with the same folder
    plans only what is not finished.

    requests: request files, grids of requests and folders of them; or a mapping of names to requests, whose files are
        then written beside their results.
    out: the folder of the results.
    jobs: how many are planned at a time; without it as many as there are cores.
    deadline: wall time allowed for each [s].
    starts: of the optimiser, of each.
    report: report.html for each.

    Requests that lead to no plan are rows with their status, and so are bad ones. Ctrl-C ends the processes, and
    KeyboardInterrupt comes; what is finished stays. Raises BadInput where there is nothing to plan, Error where the
    program fails.
    """
    folder = Path(out)
    # Behind "./", for a folder named "status" would be taken for the subcommand, and a file named "-x" for an option.
    words = [os.path.join(".", file) for file in _files(requests, folder)]
    options = {"--jobs": jobs, "--deadline": deadline, "--starts": starts}
    for option, value in options.items():
        words += [] if value is None else [option, str(value)]
    if report:
        words.append("--report")
    return Batch(folder, run(["batch", "--json", "--out", str(folder), *words]))


def _files(requests: Requests, folder: Path) -> list[Path]:
    if not isinstance(requests, Mapping):
        if isinstance(requests, (str, os.PathLike)):
            raise TypeError("requests are a list of paths, or a mapping of names to requests")
        return [Path(request) for request in requests]
    files = []
    for name, request in requests.items():
        if not name or Path(name).name != name or name.startswith("."):
            raise ValueError(f"{name!r} is no name for a folder")
        file = folder / name / f"{name}.yaml"
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(_absolute(request), encoding="utf-8")
        files.append(file)
    return files


def _absolute(request: RequestLike) -> str:
    """The request's text, its robot relative to nothing: its file is not where it was written."""
    document = Document.of(request)
    if document.text is None:
        raise TypeError("a request of the mapping is a mapping or fjr.Request; give files as a list of paths")
    mapping = json.loads(document.text)
    if isinstance(mapping.get("robot"), str):
        mapping["robot"] = str(document.folder / mapping["robot"])
    return json.dumps(mapping, ensure_ascii=False) + "\n"
