"""The cost of a simulated second."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

import crawler2d as c2d
from benches.peers.timing import interleaved
from benches.scaling.scenes import Point


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
        {
            "figure": point.figure,
            "panel": point.panel,
            "curve": point.curve,
            "x": point.x,
            "per_second": times[index].least,
            "final_x": ends[index],
        }
        for index, point in enumerate(points)
    ]


def _drive(point: Point, index: int, ends: dict[int, float]) -> float:
    """[s] Drive to the scenario's end, and return the mean wall time of a simulated second."""
    scenario = point.scenario
    simulation = c2d.Simulation(scenario)
    start = time.perf_counter()
    simulation.advance(scenario.duration)
    wall = time.perf_counter() - start
    ends[index] = float(simulation.state().position[0])
    return wall / scenario.duration
