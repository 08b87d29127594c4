"""Pools of processes, and a loop that only counts, to see the gain by more cores."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from contextlib import ExitStack, contextmanager
from multiprocessing import get_context
from typing import Any

_SPINS = 2_000_000


@contextmanager
def pools(
    counts: Sequence[int], warm: Callable[[int], None]
) -> Iterator[dict[int, ProcessPoolExecutor]]:
    """Open one pool per number of processes; each process has run `warm`."""
    context = get_context("spawn")
    with ExitStack() as stack:
        opened = {n: stack.enter_context(ProcessPoolExecutor(n, context)) for n in counts}
        for count, pool in opened.items():
            list(pool.map(warm, range(4 * count)))
        yield opened


def spread(pool: ProcessPoolExecutor, work: Callable[[Any], None], tasks: Sequence[Any]) -> float:
    """[s] Run all tasks in a pool."""
    start = time.perf_counter()
    list(pool.map(work, tasks))
    return time.perf_counter() - start


def spin(pool: ProcessPoolExecutor, loops: int) -> float:
    """[s] Run counting loops in a pool."""
    return spread(pool, _count, [_SPINS] * loops)


def _count(down: int) -> None:
    while down > 0:
        down -= 1
