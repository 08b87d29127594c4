"""Parsers of others run in a child process with limits: it alone may hang, grow or crash."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

from crawler2d.errors import ScenarioError
from crawler2d.reading.limits import CLOCK, MEGABYTES, SECONDS

__all__ = ["answered"]

# [s] Of the clock, in which the child starts, imports and works; what it may compute is less.
_PATIENCE = 30.0


def answered(program: str, question: dict[str, Any], *, file: str, folder: Path) -> dict[str, Any]:
    """Ask a program of this room, in a process of its own.

    Parameters
    ----------
    program : str
        Dotted name of the module, which ends with `limits.serve`.
    question : dict
        What JSON can hold.
    file : str
        What it is about, for errors.
    folder : Path
        In which it runs.

    Returns
    -------
    dict
        Its answer.

    Raises
    ------
    ScenarioError
        With the path, value and rule that the program gave, or if it exceeded its limits.
    ImportError
        If the library that the program needs is missing.
    """
    try:
        # Nothing of the folder of the model is imported: -P keeps it off the path.
        done = subprocess.run(
            [sys.executable, "-P", "-m", program],
            input=json.dumps(question).encode(),
            capture_output=True,
            cwd=folder,
            timeout=_PATIENCE,
            check=False,
        )
    except subprocess.TimeoutExpired:
        rule = f"must be understood within {_PATIENCE:g} s"
        raise ScenarioError(file, "no answer", rule) from None
    try:
        answer: dict[str, Any] = json.loads(done.stdout)
    except ValueError:
        rule = (
            f"must be understood in {SECONDS} s of computing, {CLOCK} s of the clock and"
            f" {MEGABYTES} MB of memory"
        )
        got = done.stderr.decode(errors="replace").strip().splitlines()
        said = got[-1] if got else f"an end by {_ended(done.returncode)}"
        raise ScenarioError(file, said, rule) from None
    if "missing" in answer:
        raise ImportError(answer["missing"])
    if "rule" in answer:
        raise ScenarioError(answer["path"], answer["value"], answer["rule"])
    return answer


def _ended(status: int) -> str:
    """Say how a process ended; those that run out of time end by a signal."""
    if status >= 0:
        return f"status {status}"
    try:
        return signal.Signals(-status).name
    except ValueError:
        return f"signal {-status}"
