"""Progress of what takes long: a bar on a terminal if tqdm is installed, else lines of text."""

from __future__ import annotations

import contextlib
import sys
import time
from collections.abc import Callable, Iterator

from crawler2d.common.extras import extra
from crawler2d.errors import ScenarioError

Progress = Callable[[int, int], None]
"""Called with the number of finished runs and of all runs."""

_LINES = 10
"""At most, if the output is not a terminal: one whenever so many parts more are finished."""


class Reporter:
    """Counts finished runs, and shows them.

    Parameters
    ----------
    show : callable
        Given the number of finished runs and of all runs.
    total : int
        Number of runs.
    done : int
        How many of them are finished at the beginning.
    """

    def __init__(self, show: Progress, total: int, done: int = 0) -> None:
        self._show, self._total, self._done = show, total, done
        show(done, total)

    def __call__(self, more: int) -> None:
        """Count runs that have been finished."""
        self._done += more
        self._show(self._done, self._total)

    def expect(self, more: int) -> None:
        """Count runs that are to be made besides."""
        self._total += more
        self._show(self._done, self._total)


@contextlib.contextmanager
def reporter(
    progress: bool | Progress | None, total: int, done: int = 0, *, unit: str = "run"
) -> Iterator[Reporter]:
    """Turn the argument `progress` into what counts the finished runs.

    Parameters
    ----------
    progress : bool, callable or None
        True shows a bar or a line, False and None nothing; a callable is given the number of
        finished runs and of all runs.
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
    # Notebooks draw their own bar and are no terminal; a log would get one copy of it a second.
    if not sys.stderr.isatty() and not _in_a_notebook():
        yield _line(unit)
        return
    try:
        tqdm = extra("tqdm.auto", "progress").tqdm
    except ImportError:  # then a line must do
        yield _line(unit)
        return
    with tqdm(total=total, initial=begun, unit=unit) as bar:

        def advance(done: int, total: int) -> None:
            bar.total = total
            bar.update(done - bar.n)

        yield advance


def _in_a_notebook() -> bool:
    """Whether this code runs in a kernel, not only beside imported parts of one."""
    ipython = sys.modules.get("IPython")
    shell = ipython.get_ipython() if ipython is not None else None
    return hasattr(shell, "kernel")


def _line(unit: str) -> Progress:
    """Write one line, overwritten on a terminal; elsewhere a new line for every tenth."""
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
        sys.stderr.write(f"{done} of {total} {unit}s, {now - begin:.0f} s{end}")
        sys.stderr.flush()

    return write
