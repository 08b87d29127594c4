"""Many worlds on more and more threads; processes that only count show what the machine gains."""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

import crawler2d as c2d
from benches.peers import workers
from benches.peers.timing import interleaved
from benches.scaling import scenes
from crawler2d.parameters.scenario import Scenario

# [m] From world to world: no two do the same.
_APPROACH = 5e-4


def threads(worlds: int, loops: int, repeats: int) -> list[dict[str, Any]]:
    """Time a batch of worlds, and loops that count beside, on one core, two, and so on.

    Parameters
    ----------
    worlds : int
        In the batch.
    loops : int
        For the pools of processes.
    repeats : int
        Rounds.

    Returns
    -------
    list of dict
        One a number of threads, with the speed-ups of both over one thread.
    """
    base = scenes.line_of_gears()
    batch = [base.replace({"start.approach": 0.1 + _APPROACH * i}) for i in range(worlds)]
    counts = range(1, (os.cpu_count() or 1) + 1)
    jobs: dict[tuple[str, int], Callable[[], float]] = {}
    with workers.pools(counts, _warm) as pools:
        for count, pool in pools.items():
            jobs["worlds", count] = partial(_wall_time, batch, count)
            jobs["loops", count] = partial(workers.spin, pool, loops)
        least = {job: time.least for job, time in interleaved(jobs, repeats).items()}
    steps = worlds * base.duration / base.solver.time_step
    return [
        {
            "threads": count,
            "steps_per_second": steps / least["worlds", count],
            "worlds": least["worlds", 1] / least["worlds", count],
            "loops": least["loops", 1] / least["loops", count],
        }
        for count in counts
    ]


def _wall_time(batch: Sequence[Scenario], count: int) -> float:
    """[s] Run a batch, from the scenarios to the runs."""
    start = time.perf_counter()
    c2d.simulate_many(batch, threads=count, record="summary")
    return time.perf_counter() - start


def _warm(_: int) -> None:
    time.sleep(0.1)  # so that each process of the pool gets its turn
