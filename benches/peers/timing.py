"""Interleaved timing of several jobs, so that disturbances of the machine affect all of them."""

from __future__ import annotations

import statistics
import sys
import time
from collections.abc import Callable, Hashable, Mapping
from typing import NamedTuple, TypeVar

Key = TypeVar("Key", bound=Hashable)


class Time(NamedTuple):
    """[s] Times of several repeats of a job."""

    least: float
    median: float


def interleaved(jobs: Mapping[Key, Callable[[], float]], repeats: int) -> dict[Key, Time]:
    """Time all jobs once, then all of them again, and so on.

    Parameters
    ----------
    jobs : mapping of callables
        Each does its job and returns the seconds [s] it took.
    repeats : int
        Number of rounds.
    """
    rounds = [{key: job() for key, job in jobs.items()} for _ in range(repeats)]
    return {
        key: Time(min(r[key] for r in rounds), statistics.median(r[key] for r in rounds))
        for key in jobs
    }


_START = time.perf_counter()


def progress(text: str) -> None:
    """Write a message and the elapsed time to stderr."""
    sys.stderr.write(f"{time.perf_counter() - _START:6.1f} s  {text}\n")
