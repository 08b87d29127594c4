"""Time points in turns, and batches on threads.

No pool could call a function of `__main__`.
"""

import os
import time
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

import crawler2d as c2d
from benches.scaling import scenes
from benches.scaling.scenes import Point, line_of_gears
from benches.shared.measuring import interleaved, machine, pools, seconds, spin
from benches.shared.results import progress
from crawler2d import Scenario

_ROUNDS = 15
# One round of the points takes most of a minute.
_ROUNDS_OF_POINTS = 4
_QUICK_PIECES = 1_000


def run(*, quick: bool) -> dict[str, Any]:
    """Measure everything, panel by panel."""
    start, build = time.perf_counter(), c2d.build_info()["build_id"]
    found = machine({"crawler2d": f"{c2d.__version__}, build {build}"})
    rows: list[dict[str, Any]] = []
    points = list(scenes.points())
    if quick:
        points = [point for point in points if point.x <= _QUICK_PIECES]
    for (figure, panel), own in scenes.panels(points).items():
        progress(f"{figure}: {panel}")
        rounds = _ROUNDS_OF_POINTS if figure == "points" else _ROUNDS
        rows += measure(own, 1 if quick else rounds)
    progress("threads")
    spread = threads(*((8, 4, 1) if quick else (64, 16, _ROUNDS)))
    wall = time.perf_counter() - start
    return {"machine": found, "wall": wall, "rows": rows, "threads": spread}


def measure(points: Sequence[Point], repeats: int) -> list[dict[str, Any]]:
    """Time points in turns: all of them once, then all of them again.

    Parameters
    ----------
    points : sequence of Point
        Points of one panel.
    repeats : int
        Number of rounds.

    Returns
    -------
    list of dict
        One per point: `per_second` [s] of wall time is the minimum over the rounds, `final_x` [m]
        the final x.
    """
    ends: dict[int, float] = {}
    jobs: dict[int, Callable[[], float]] = {
        index: partial(_drive, point, index, ends) for index, point in enumerate(points)
    }
    times = interleaved(jobs, repeats)
    return [
        {name: value for name, value in point._asdict().items() if name != "scenario"}
        | {"per_second": times[index], "final_x": ends[index]}
        for index, point in enumerate(points)
    ]


def _drive(point: Point, index: int, ends: dict[int, float]) -> float:
    """[s] Run to the scenario's end, and return the mean wall time of a simulated second."""
    scenario = point.scenario
    simulation = c2d.Simulation(scenario)
    wall = seconds(lambda: simulation.advance(scenario.duration))
    ends[index] = float(simulation.state().position[0])
    return wall / scenario.duration


# [m] Shift from world to world, so that no two are equal.
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
    base = line_of_gears()
    batch = [base.replace({"start.approach": 0.1 + _APPROACH * i}) for i in range(worlds)]
    counts = range(1, (os.cpu_count() or 1) + 1)
    jobs: dict[tuple[str, int], Callable[[], float]] = {}
    with pools(counts, _warm) as opened:
        for count, pool in opened.items():
            jobs["worlds", count] = partial(_wall_time, batch, count)
            jobs["loops", count] = partial(spin, pool, loops)
        least = interleaved(jobs, repeats)
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
    return seconds(lambda: c2d.simulate_many(batch, threads=count, record="summary"))


def _warm(_: int) -> None:
    time.sleep(0.1)  # so that each process of the pool gets its turn
