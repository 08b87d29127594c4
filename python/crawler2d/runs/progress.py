"""Progress of a batch: a bar if tqdm is installed, else a line of text."""

from __future__ import annotations

import contextlib
import sys
import time
from collections.abc import Callable, Iterator

from crawler2d.common.extras import extra
from crawler2d.errors import ScenarioError

Progress = Callable[[int, int], None]
"""Called with the number of finished runs and of all runs."""

# [s] Time between two lines if the output is not a terminal.
_BETWEEN_LINES = 5.0


@contextlib.contextmanager
def reporter(
    progress: bool | Progress | None, total: int, done: int = 0
) -> Iterator[Callable[[int], None]]:
    """Turn the argument `progress` into a function that is told how many runs have been finished.

    Parameters
    ----------
    progress : bool, callable or None
        True shows a bar or a line, False and None nothing; a callable is given the number of
        finished runs and of all runs.
    total : int
        Number of runs.
    done : int
        How many of them are finished at the beginning.

    Raises
    ------
    ScenarioError
        If `progress` is something else.
    """
    if progress is None or progress is False:
        yield lambda _more: None
    elif callable(progress):
        yield _counted(progress, done, total)
    elif progress is True:
        with _bar(total) as shown:
            yield _counted(shown, done, total)
    else:
        raise ScenarioError("progress", progress, "must be True, False or a callable")


def _counted(progress: Progress, done: int, total: int) -> Callable[[int], None]:
    finished = done
    progress(finished, total)

    def add(more: int) -> None:
        nonlocal finished
        finished += more
        progress(finished, total)

    return add


@contextlib.contextmanager
def _bar(total: int) -> Iterator[Progress]:
    try:
        tqdm = extra("tqdm.auto", "progress").tqdm
    except ImportError:  # then a line must do
        yield _line()
        return
    with tqdm(total=total, unit="run") as bar:

        def advance(done: int, _total: int) -> None:
            bar.update(done - bar.n)

        yield advance


def _line() -> Progress:
    """Write one line, overwritten on a terminal; elsewhere a new line every few seconds."""
    begin = last = time.monotonic()

    def write(done: int, total: int) -> None:
        nonlocal last
        now = time.monotonic()
        terminal = sys.stderr.isatty()
        if not terminal and done < total and now - last < _BETWEEN_LINES:
            return
        last = now
        end = "\r" if terminal and done < total else "\n"
        sys.stderr.write(f"{done} of {total} runs, {now - begin:.0f} s{end}")
        sys.stderr.flush()

    return write
