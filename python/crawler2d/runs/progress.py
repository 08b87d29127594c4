"""How far a batch has come, for a person: a bar where tqdm is there, else a line."""

from __future__ import annotations

import contextlib
import sys
import time
from collections.abc import Callable, Iterator

from crawler2d.common.extras import extra
from crawler2d.errors import ScenarioError

Progress = Callable[[int, int], None]
"""Called with the number of finished runs and of all runs."""

# [s] Between two lines where there is no terminal to overwrite.
_BETWEEN_LINES = 5.0


@contextlib.contextmanager
def reporter(progress: bool | Progress | None, total: int) -> Iterator[Progress | None]:
    """Turn the argument `progress` into a callback for the time of a batch.

    Parameters
    ----------
    progress : bool, callable or None
        True reports to a person, False and None to nobody; a callable is used as it is.
    total : int
        Number of runs.

    Raises
    ------
    ScenarioError
        If `progress` is something else.
    """
    if progress is None or progress is False:
        yield None
    elif callable(progress):
        yield progress
    elif progress is True:
        with _bar(total) as callback:
            yield callback
    else:
        raise ScenarioError("progress", progress, "must be True, False or a callable")


@contextlib.contextmanager
def _bar(total: int) -> Iterator[Progress]:
    try:
        tqdm = extra("tqdm.auto", "progress").tqdm
    except ImportError:  # a line tells as much
        yield _line()
        return
    with tqdm(total=total, unit="run") as bar:

        def advance(done: int, _total: int) -> None:
            bar.update(done - bar.n)

        yield advance


def _line() -> Progress:
    """Write one line that overwrites itself on a terminal, and one every few seconds elsewhere."""
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
