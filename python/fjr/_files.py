"""Where the files of this package are: it is laid out as any installation of fjr."""

from __future__ import annotations

from pathlib import Path


def program() -> Path:
    """The program ``fjr``."""
    return Path(__file__).resolve().parent / "bin" / "fjr"
