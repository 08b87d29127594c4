"""Many worlds on one thread and on two, in the way that each engine offers from Python.

crawler2d and MuJoCo have thread pools of their own; the others get one process per world at a time.
A loop that only counts shows what the machine itself gains with a second thread.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from typing import Any

from benches.peers import scenes, workers
from benches.peers.engine import Setting
from benches.peers.engines import NAMES, at, engine
from benches.peers.scenes import Draw, Scene
from benches.peers.timing import interleaved, progress

# [s] Time step of the other engines' worlds.
_TIME_STEP = 1e-3


def batches(
    names: Sequence[str], draws: list[Draw], engines: Sequence[str], repeats: int
) -> list[dict[str, Any]]:
    """Time a batch of a scene's draws on one and on two threads or processes."""
    rows = []
    for name in names:
        progress(f"batches: {name}")
        variants = [scenes.load(name).vary(draw) for draw in draws]
        with workers.pools((1, 2), _warm) as pools:
            jobs: dict[tuple[str, int], Callable[[], float]] = {}
            for count, pool in pools.items():
                for each in engines:
                    jobs[each, count] = _job(each, variants, count, pool)
                jobs["spin", count] = partial(workers.spin, pool, len(draws))
            times = interleaved(jobs, repeats)
        simulated = len(variants) * variants[0].duration
        for each in (*engines, "spin"):
            one, two = times[each, 1].least, times[each, 2].least
            row = {"scene": name, "engine": each, "worlds": len(variants), "scaling": one / two}
            if each != "spin":
                row |= {"real_time": [simulated / one, simulated / two]}
            rows.append(row)
    return rows


def _job(
    name: str, variants: list[Scene], count: int, pool: ProcessPoolExecutor
) -> Callable[[], float]:
    setting = at(engine(name), _TIME_STEP, tuned=True)
    if name == "crawler2d":
        return partial(_crawler2d, variants, setting, count)
    if name == "MuJoCo":
        return partial(_mujoco, variants, setting, count)
    tasks = [(name, scene, setting) for scene in variants]
    return partial(workers.spread, pool, _one_world, tasks)


def _crawler2d(variants: list[Scene], setting: Setting, threads: int) -> float:
    import crawler2d as c2d  # noqa: PLC0415 - a worker process needs its own engine alone
    from benches.peers.engine_crawler2d import scenario  # noqa: PLC0415

    ready = [scenario(scene, setting, scene.duration) for scene in variants]
    start = time.perf_counter()
    c2d.simulate_many(ready, threads=threads, record="summary")
    return time.perf_counter() - start


def _mujoco(variants: list[Scene], setting: Setting, threads: int) -> float:
    from mujoco.batch import Batch  # noqa: PLC0415

    from benches.peers.engine_mujoco import build  # noqa: PLC0415

    models, data = zip(*(build(scene, setting) for scene in variants), strict=True)
    batch = Batch(models[0], nsim=len(models), nthread=threads)
    batch.set_models(list(models))
    batch.bind("ctrl")[:] = [each.ctrl for each in data]
    start = time.perf_counter()
    batch.step(nstep=setting.steps(variants[0].duration))
    return time.perf_counter() - start


def _one_world(task: tuple[str, Scene, Setting]) -> None:
    name, scene, setting = task
    engine(name).wall_time(scene, setting, scene.duration)


def _warm(_: int) -> None:
    for name in NAMES:
        if name not in ("crawler2d", "MuJoCo"):
            engine(name)
    time.sleep(0.2)  # so that each process of the pool gets its turn
