"""The program fjr, as the package has it: ``python -m fjr plan REQUEST.yaml --out DIR``."""

from __future__ import annotations

import os
import sys

from fjr._files import program


def main() -> None:
    """Becomes the program."""
    os.execv(program(), ["fjr", *sys.argv[1:]])


if __name__ == "__main__":
    main()
