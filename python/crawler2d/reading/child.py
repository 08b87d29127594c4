"""Parsers of others run in a child process with limits: it alone may hang, grow or crash."""

from __future__ import annotations

import contextlib
import json
import os
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from crawler2d.errors import ScenarioError

__all__ = ["answered", "no_more_files", "serve"]

SECONDS = 2
"""[s] Of computing, after the imports."""

CLOCK = 4 * SECONDS
"""[s] Of the clock, after the imports: whatever it waits for, it does not wait for ever."""

MEGABYTES = 400
"""[MB] Of memory, beyond what the imports took."""


def serve(prepare: Callable[[], Callable[[dict[str, Any]], dict[str, Any]]]) -> None:
    """Answer the question on standard input, within limits.

    Parameters
    ----------
    prepare : callable
        Imports what is needed and returns what answers. It runs before the limits hold.
    """
    out, sys.stdout = sys.stdout, sys.stderr  # what a library prints is no answer
    try:
        work = prepare()
        _limit()
        answer = work(json.loads(sys.stdin.read()))
    except ImportError as error:
        answer = {"missing": str(error)}
    except ScenarioError as error:
        answer = {"path": error.path, "value": error.value, "rule": error.rule}
    out.write(json.dumps(answer))
    out.flush()


@contextlib.contextmanager
def no_more_files() -> Iterator[None]:
    """Let nothing be opened, by whatever means, where the system knows such a limit."""
    try:
        import resource  # noqa: PLC0415 - not on Windows
    except ImportError:
        yield
        return
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    resource.setrlimit(resource.RLIMIT_NOFILE, (0, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_NOFILE, (soft, hard))


def _limit() -> None:
    """Set the limits, where the system knows such."""
    with contextlib.suppress(ImportError):
        import resource  # noqa: PLC0415 - not on Windows, where only the patience of the parent holds

        # Their signals end the process. The limit knows whole seconds only, but nothing that runs
        # here can take it back.
        signal.setitimer(signal.ITIMER_PROF, SECONDS)
        signal.setitimer(signal.ITIMER_REAL, CLOCK)
        used = resource.getrusage(resource.RUSAGE_SELF)
        seconds = int(used.ru_utime + used.ru_stime) + 1 + SECONDS
        resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        with contextlib.suppress(OSError, ValueError):
            with open("/proc/self/statm", encoding="ascii") as file:
                pages = int(file.read().split()[0])
            most = pages * os.sysconf("SC_PAGE_SIZE") + 1_000_000 * MEGABYTES
            resource.setrlimit(resource.RLIMIT_AS, (most, most))


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
