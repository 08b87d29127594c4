"""Progress of long computations, and the number of threads of a batch."""

from __future__ import annotations

import contextlib
import os
import sys
import time
from collections.abc import Callable, Iterator

from crawler2d.common.arrays import read_scalar
from crawler2d.common.extras import extra
from crawler2d.errors import LimitError, ScenarioError

# More threads are surely a mistake: each needs its own stack.
_MOST = 1024
_VARIABLE = "CRAWLER2D_THREADS"
_RULE = f"must be a whole number from 1 to {_MOST}"


def thread_count(threads: int | None, path: str = "threads") -> int:
    """Determine the number of threads.

    Parameters
    ----------
    threads : int, optional
        Requested number, 1 to 1024; None requests every core of this process.
    path : str
        What errors call it.

    Returns
    -------
    int
        That number, or the environment variable CRAWLER2D_THREADS if that is smaller.

    Raises
    ------
    LimitError
        If either is not a whole number from 1 to 1024.
    """
    limit = _limit()
    if threads is None:
        return min(_cores(), limit)
    asked = read_scalar(threads, whole=True)
    if type(asked) is not int or not 1 <= asked <= _MOST:
        raise LimitError(f"{path} {_RULE}, got {repr(threads)[:40]}")
    return min(asked, limit)


def _cores() -> int:
    if hasattr(os, "sched_getaffinity"):  # Linux: the cores this process may use, not all cores
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def _limit() -> int:
    text = os.environ.get(_VARIABLE, "").strip()
    if not text:
        return _MOST
    if not (text.isascii() and text.isdigit() and len(text) <= 4 and 1 <= int(text) <= _MOST):
        raise LimitError(f"environment variable {_VARIABLE} {_RULE}, got {text[:40]!r}")
    return int(text)


Progress = Callable[[int, int], None]
"""Called with the numbers of finished and of all runs."""

_LINES = 10
"""Number of lines if the output is not a terminal: one for each such part of the runs."""


class Reporter:
    """Counts finished runs, and shows them.

    Parameters
    ----------
    show : callable
        Called with the numbers of finished and of all runs.
    total : int
        Number of runs.
    done : int
        Number of runs that are already finished.
    """

    def __init__(self, show: Progress, total: int, done: int = 0) -> None:
        self._show, self._total, self._done = show, total, done
        show(done, total)

    def __call__(self, more: int) -> None:
        """Count more finished runs."""
        self._done += more
        self._show(self._done, self._total)

    def expect(self, more: int) -> None:
        """Add runs to the total."""
        self._total += more
        self._show(self._done, self._total)


@contextlib.contextmanager
def reporter(
    progress: bool | Progress | None, total: int, done: int = 0, *, unit: str = "run"
) -> Iterator[Reporter]:
    """Turn the argument `progress` into a `Reporter`.

    Parameters
    ----------
    progress : bool, callable or None
        True shows a bar or a line, False and None nothing; a callable gets the numbers of finished
        and of all runs.
    total, done : int
        See `Reporter`.
    unit : str
        What is counted.

    Raises
    ------
    ScenarioError
        If `progress` is something else.
    """
    if progress is None or progress is False:
        yield Reporter(lambda _done, _total: None, total, done)
    elif callable(progress):
        yield Reporter(progress, total, done)
    elif progress is True:
        with _bar(total, done, unit) as show:
            yield Reporter(show, total, done)
    else:
        raise ScenarioError("progress", progress, "must be True, False or a callable")


@contextlib.contextmanager
def _bar(total: int, begun: int, unit: str) -> Iterator[Progress]:
    if sys.stderr is None:  # if the process was started without one
        yield lambda _done, _total: None
        return
    # Notebooks are not terminals but draw their own bar; a log would get a new bar every second.
    if not sys.stderr.isatty() and not _in_a_notebook():
        yield _line(unit)
        return
    try:
        tqdm = extra("tqdm.auto", "progress").tqdm
    except ImportError:  # use a line instead
        yield _line(unit)
        return
    with tqdm(total=total, initial=begun, unit=unit) as bar:

        def advance(done: int, total: int) -> None:
            bar.total = total
            bar.update(done - bar.n)

        yield advance


def _in_a_notebook() -> bool:
    """Whether this code runs in a kernel; importing parts of one is not enough."""
    ipython = sys.modules.get("IPython")
    shell = ipython.get_ipython() if ipython is not None else None
    return hasattr(shell, "kernel")


def _line(unit: str) -> Progress:
    """Write one line that is overwritten on a terminal; elsewhere a new line for every tenth."""
    begin = time.monotonic()
    last = 0

    def write(done: int, total: int) -> None:
        nonlocal last
        now = time.monotonic()
        terminal = sys.stderr.isatty()
        part = _LINES * done // max(total, 1)
        if not terminal and part <= last:
            return
        last = part
        end = "\r" if terminal and done < total else "\n"
        # Do not lose the runs over a full disk or a closed terminal.
        with contextlib.suppress(OSError):
            sys.stderr.write(f"{done} of {total} {unit}s, {now - begin:.0f} s{end}")
            sys.stderr.flush()

    return write
