"""What a child process may use and open, and how it answers: JSON in, JSON out."""

from __future__ import annotations

import contextlib
import json
import os
import signal
import sys
from collections.abc import Callable, Iterator
from typing import Any

from crawler2d.errors import ScenarioError

__all__ = ["CLOCK", "MEGABYTES", "SECONDS", "no_more_files", "serve"]

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
