"""The sections of the report with times only: defaults, yardstick and batches.

Batches are many worlds on one thread and on two, in the way that each engine offers from Python.
crawler2d and MuJoCo have thread pools of their own; the others get one process per world at a time.
A loop that only counts shows what the machine itself gains with a second thread.
"""

import time
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from itertools import product
from typing import Any

from benches.adapters import planar
from benches.peers.accuracy import measure, wall_times
from benches.shared.measuring import interleaved, pools, spin, spread
from benches.shared.results import progress

# [s] Time step at which all other engines are also timed.
_COMMON_STEP = 2e-3
# [s] Time step of the bare engine.
_YARDSTICK_STEP = 1e-3


def defaults(
    names: Sequence[str], engines: Sequence[planar.Engine], repeats: int
) -> list[dict[str, Any]]:
    """Time all engines and measure their errors, at their defaults and with steps of 2 ms."""
    rows = []
    for name in names:
        progress(f"defaults: {name}")
        scene = planar.load_scene(name)
        cases = {
            (each.name, kind): (each, scene, setting)
            for kind, time_step in (("own", None), ("common", _COMMON_STEP))
            for each in engines
            for setting in [each.defaults if time_step is None else planar.at(each, time_step)]
        }
        times = wall_times(cases, repeats)
        for key, (each, _, setting) in cases.items():
            run = measure(each, scene, setting)
            rows.append(
                {
                    "scene": name,
                    "engine": each.name,
                    "kind": key[1],
                    "setting": str(setting),
                    "per_second": times[key] / scene.duration,
                    "cleared": run.cleared,
                    "final_x": float(run.motion.poses[-1, 0, 0]),
                    "penetration": run.penetration,
                    "gap": run.gap,
                }
            )
    return rows


def yardstick(robots: Sequence[str], terrains: Sequence[str], repeats: int) -> list[dict[str, Any]]:
    """Time crawler2d's gear wheels against round wheels on cuboids in the bare engine.

    The bare engine takes steps of 1 ms with 4 substeps, with its default tolerances and with those
    that suit grousers; crawler2d has its default accuracy.
    """
    own, bare = planar.load_engine("crawler2d"), planar.load_engine("rapier2d")
    rows = []
    for robot, terrain in product(robots, terrains):
        progress(f"yardstick: {robot}, {terrain}")
        gear, round_ = (
            planar.load_scene(f"{robot}-{wheel}-{terrain}") for wheel in ("gear", "round")
        )
        cases = {
            "crawler2d gear": (own, gear, own.defaults),
            "crawler2d round": (own, round_, own.defaults),
            "bare round": (bare, round_, planar.at(bare, _YARDSTICK_STEP)),
            "bare round, tuned": (bare, round_, planar.at(bare, _YARDSTICK_STEP, tuned=True)),
            "bare gear, tuned": (bare, gear, planar.at(bare, _YARDSTICK_STEP, tuned=True)),
        }
        times = wall_times(cases, repeats)
        costs = {case: time / gear.duration for case, time in times.items()}
        rows.append({"robot": robot, "terrain": terrain, "per_second": costs})
    return rows


_TIME_STEP = 1e-3  # [s] of the other engines' worlds
_THREADED = ("crawler2d", "MuJoCo")


def batches(
    names: Sequence[str], draws: list[planar.Draw], engines: Sequence[str], repeats: int
) -> list[dict[str, Any]]:
    """Time a batch of a scene's draws on one and on two threads or processes."""
    rows = []
    for name in names:
        progress(f"batches: {name}")
        variants = [planar.load_scene(name).vary(draw) for draw in draws]
        with pools((1, 2), _warm) as opened:
            jobs: dict[tuple[str, int], Callable[[], float]] = {}
            for count, pool in opened.items():
                for each in engines:
                    jobs[each, count] = _job(each, variants, count, pool)
                jobs["spin", count] = partial(spin, pool, len(draws))
            times = interleaved(jobs, repeats)
        simulated = len(variants) * variants[0].duration
        for each in (*engines, "spin"):
            one, two = times[each, 1], times[each, 2]
            row = {"scene": name, "engine": each, "worlds": len(variants), "scaling": one / two}
            if each != "spin":
                row |= {"real_time": [simulated / one, simulated / two]}
            rows.append(row)
    return rows


def _job(
    name: str, variants: list[planar.Scene], count: int, pool: ProcessPoolExecutor
) -> Callable[[], float]:
    setting = planar.at(planar.load_engine(name), _TIME_STEP, tuned=True)
    if name in _THREADED:
        own: Any = planar.load_engine(name)
        return partial(own.batch_time, variants, setting, count)
    tasks = [(name, scene, setting) for scene in variants]
    return partial(spread, pool, _one_world, tasks)


def _one_world(task: tuple[str, planar.Scene, planar.Setting]) -> None:
    name, scene, setting = task
    planar.load_engine(name).wall_time(scene, setting, scene.duration)


def _warm(_: int) -> None:
    for name in planar.ENGINES:
        if name not in _THREADED:
            planar.load_engine(name)
    time.sleep(0.2)  # so that each process of the pool gets its turn
