"""How many threads a batch may use."""

from __future__ import annotations

import os

from crawler2d.common.arrays import frozen_scalar
from crawler2d.errors import LimitError

# More threads than this are surely a mistake; each has a stack of its own.
_MOST = 1024
_VARIABLE = "CRAWLER2D_THREADS"


def thread_count(threads: int | None) -> int:
    """Determine the number of threads.

    Parameters
    ----------
    threads : int, optional
        Requested number, 1 to 1024; None requests every core of this process.

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
    asked = frozen_scalar(threads, whole=True)
    if type(asked) is not int or not 1 <= asked <= _MOST:
        raise LimitError(
            f"threads must be a whole number from 1 to {_MOST}, got {repr(threads)[:40]}"
        )
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
        rule = f"must be a whole number from 1 to {_MOST}"
        raise LimitError(f"environment variable {_VARIABLE} {rule}, got {text[:40]!r}")
    return int(text)
