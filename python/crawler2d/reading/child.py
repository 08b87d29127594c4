"""Third-party parsers run in a child process with limits: it alone may hang, grow or crash."""

from __future__ import annotations

import contextlib
import json
import os
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from typing import Any

from crawler2d.errors import ScenarioError
from crawler2d.reading.files import Files

__all__ = ["ask_child", "no_more_files", "serve"]

SECONDS = 2
"""[s] Of computing, after the imports."""

CLOCK = 4 * SECONDS
"""[s] Of the clock, after the imports: it waits for nothing for ever."""

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
    """Prevent any file from being opened, by whatever means, where the system has such a limit."""
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
    """Set the limits, where the system has them."""
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


def ask_child(program: str, question: dict[str, Any], *, file: str, files: Files) -> dict[str, Any]:
    """Ask a program of this room, in a process of its own, for plain data.

    Parameters
    ----------
    program : str
        Dotted name of the module, which ends with `serve`.
    question : dict
        Plain data that JSON can represent.
    file : str
        The subject of errors.
    files : Files
        The files of the model, in whose folder the program runs.

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
            cwd=files.folder,
            timeout=_PATIENCE,
            check=False,
        )
    except subprocess.TimeoutExpired:
        rule = f"must be parsed within {_PATIENCE:g} s"
        raise ScenarioError(file, "no answer", rule) from None
    try:
        answer: dict[str, Any] = json.loads(done.stdout)
    except ValueError:
        rule = (
            f"must be parsed in {SECONDS} s of computing, {CLOCK} s of the clock and"
            f" {MEGABYTES} MB of memory"
        )
        errors = done.stderr.decode(errors="replace").strip().splitlines()
        said = errors[-1] if errors else f"an end by {_exit_name(done.returncode)}"
        raise ScenarioError(file, said, rule) from None
    if "missing" in answer:
        raise ImportError(answer["missing"])
    if "rule" in answer:
        raise ScenarioError(answer["path"], answer["value"], answer["rule"])
    return answer


def _exit_name(status: int) -> str:
    """Name the exit of a process; those that run out of time end by a signal."""
    if status >= 0:
        return f"status {status}"
    try:
        return signal.Signals(-status).name
    except ValueError:
        return f"signal {-status}"
