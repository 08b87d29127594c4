"""Many worlds on an increasing number of threads, beside processes that only count."""

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

# [m] Shift from world to world, so that no two are the same.
_APPROACH = 5e-4


def threads(worlds: int, loops: int, repeats: int) -> list[dict[str, Any]]:
    """Time a batch of worlds, and loops that only count, on one core, two, and so on.

    Parameters
    ----------
    worlds : int
        Number of worlds in the batch.
    loops : int
        Number of loops for the pools of processes.
    repeats : int
        Number of rounds.

    Returns
    -------
    list of dict
        One per number of threads, with the simulated seconds per second of all worlds together,
        and the speed-ups of both over one thread.
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
    simulated = sum(run.metrics["time"] for run in c2d.simulate_many(batch, record="summary"))
    return [
        {
            "threads": count,
            "real_time": simulated / least["worlds", count],
            "worlds": least["worlds", 1] / least["worlds", count],
            "loops": least["loops", 1] / least["loops", count],
        }
        for count in counts
    ]


def _wall_time(batch: Sequence[Scenario], count: int) -> float:
    """[s] Wall time of a batch, from the scenarios to the runs."""
    start = time.perf_counter()
    c2d.simulate_many(batch, threads=count, record="summary")
    return time.perf_counter() - start


def _warm(_: int) -> None:
    time.sleep(0.1)  # so that each process of the pool gets its turn
