"""Where the files of this package are: it is laid out as any installation of fjr."""

from __future__ import annotations

import shutil
from pathlib import Path


def program() -> Path:
    """The program ``fjr``: of this package, or the one that Debian's package python3-fjr depends on."""
    own = Path(__file__).resolve().parent / "bin" / "fjr"
    return own if own.exists() else Path(shutil.which("fjr") or "/usr/bin/fjr")
