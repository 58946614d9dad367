"""The program ``fjr``, for what is done by it in a process of its own."""

from __future__ import annotations

import json
import signal
import subprocess
from typing import Any

from fjr._files import program
from fjr.errors import BadInput, Error


def run(arguments: list[str]) -> dict[str, Any]:
    """Runs it with ``--json`` among the arguments, of which the first is the command, and returns what it tells. In a
    session of its own, so that Ctrl-C reaches it once, from here."""
    with subprocess.Popen(
        [program(), *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True
    ) as process:
        try:
            told, complaints = process.communicate()
        except KeyboardInterrupt:
            process.send_signal(signal.SIGINT)
            process.communicate()
            raise
    try:
        summary: dict[str, Any] = json.loads(told)
    except ValueError:  # it was killed, or could not write
        complaint = complaints.strip().removeprefix("fjr: ") or f"fjr {arguments[0]} ended with {process.returncode}"
        raise Error(complaint) from None
    if summary.get("status") == "bad_input":
        raise BadInput(arguments[0], "", summary["reason"])
    if summary.get("status") == "failed":
        raise Error(summary["reason"])
    return summary
