"""Requests for more than 512 MB in a process limited to that; run as a program.

It prints how each kind ended, as JSON; that it prints at all shows that nothing ended the process.
"""

import json
import random
import resource
import sys
from collections import Counter
from collections.abc import Callable
from dataclasses import replace

import numpy as np

import crawler2d as c2d
from crawler2d.parameters.terrain import Points

LIMIT = 512 << 20  # [bytes]

ENGINEER = c2d.robots.engineer(flippers=None)
SHORT = c2d.Scenario(ENGINEER, c2d.terrains.step(0.05), duration=0.3)


def rough(points: int, seed: int = 0) -> Points:
    x = np.linspace(-50.0, 50.0, points)
    y = 0.01 * np.random.default_rng(seed).random(points)
    return Points(np.column_stack([x, y]), goal=40.0, friction=0.8)  # type: ignore[arg-type]


def long_history() -> None:
    flat = SHORT.replace({"terrain": c2d.terrains.flat(length=9e3), "duration": 9e3})
    c2d.simulate(flat, sample_interval=1e-3)


def many_histories() -> None:
    still = SHORT.replace({"duration": 15.0, "criteria.stop_window": 100.0})
    c2d.simulate_many([still] * 2000, threads=2)


def fine_histories() -> None:
    c2d.simulate_many([SHORT] * 2000, threads=2, sample_interval=1e-3)


def forty_large_grounds() -> None:
    c2d.simulate_many([SHORT.replace({"terrain": rough(200_000)})] * 40, threads=2)


def forty_grounds() -> None:
    grounds = [SHORT.replace({"terrain": rough(40_000, seed)}) for seed in range(40)]
    c2d.simulate_many(grounds, threads=2, record="summary")


def a_million_points() -> None:
    c2d.simulate(SHORT.replace({"terrain": rough(1_000_000)}))


def many_threads() -> None:
    c2d.simulate_many([SHORT] * 1024, threads=1024, record="summary")


def many_grousers() -> None:
    outline = replace(
        ENGINEER.outline, axle_distance=80.0, grouser_pitch=1e-3, grouser_thickness=5e-4
    )
    long = replace(ENGINEER, outline=outline, belly=None, moment_of_inertia=1e4)
    c2d.simulate(long.with_track(c2d.GrouserBeltTrack()), c2d.terrains.flat())


def a_long_name() -> None:
    c2d.simulate(replace(ENGINEER, name="x" * 100_000_000), c2d.terrains.flat())


def a_long_text() -> None:
    c2d.Scenario.from_json("[" + "0," * 20_000_000 + "0]")


def a_large_simulation() -> None:
    simulation = c2d.Simulation(SHORT.replace({"terrain": rough(200_000)}))
    simulation.advance(0.1)
    simulation.snapshot()


def rounded_posts() -> None:
    c2d.simulate(SHORT.replace({"terrain": c2d.terrains.random_stepfield(1, posts=1000)}))


def a_chain() -> None:
    heavy = replace(ENGINEER, track_mass=4.0)
    chain = heavy.with_track(c2d.SegmentalTrack(shoe_count=400))
    c2d.simulate(chain, c2d.terrains.flat(), duration=0.02, sample_interval=1e-5)


def an_ordinary_run() -> None:
    c2d.simulate(SHORT)


def an_ordinary_sweep() -> None:
    heights = [0.01 * n for n in range(1, 40)]
    c2d.sweep(SHORT, {"terrain.height": heights}, repeats=2, progress=False)


REQUESTS: list[Callable[[], None]] = [
    long_history,
    many_histories,
    fine_histories,
    forty_large_grounds,
    many_threads,
    many_grousers,
    a_long_name,
    a_long_text,
    a_large_simulation,
    rounded_posts,
    a_chain,
    an_ordinary_run,
    an_ordinary_sweep,
    forty_grounds,
    a_million_points,
]


def main() -> None:
    count, seed = int(sys.argv[1]), int(sys.argv[2])
    # pandas imports the first where it is installed, and it takes 165 MB of addresses; xarray
    # imports the second, which takes longest.
    for name in ("pyarrow", "dask"):
        sys.modules[name] = None  # type: ignore[assignment]
    resource.setrlimit(resource.RLIMIT_AS, (LIMIT, LIMIT))
    rng = random.Random(seed)
    told: Counter[str] = Counter()
    for i in range(count):
        request = REQUESTS[i] if i < len(REQUESTS) else rng.choice(REQUESTS)
        try:
            request()
            end = "done"
        except (c2d.Crawler2dError, MemoryError) as error:
            end = type(error).__name__
        told[f"{request.__name__}: {end}"] += 1
    print(json.dumps(told))


if __name__ == "__main__":
    main()
