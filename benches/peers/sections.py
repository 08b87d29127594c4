"""The sections of the report that only time and judge: defaults and yardstick."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Any

from benches.peers import scenes
from benches.peers.engine import Engine
from benches.peers.engines import at, engine
from benches.peers.errors import judge
from benches.peers.timing import interleaved, progress

# [s] Time step at which all other engines are also timed.
_COMMON_STEP = 2e-3
# [s] Time step of the bare engine.
_YARDSTICK_STEP = 1e-3


def defaults(names: Sequence[str], engines: Sequence[Engine], repeats: int) -> list[dict[str, Any]]:
    """Time and judge every engine at its defaults, and all others with steps of 2 ms."""
    rows = []
    for name in names:
        progress(f"defaults: {name}")
        scene = scenes.load(name)
        settings = {
            (each.name, kind): (each, setting)
            for kind, time_step in (("own", None), ("common", _COMMON_STEP))
            for each in engines
            for setting in [each.defaults if time_step is None else at(each, time_step)]
        }
        times = interleaved(
            {
                key: partial(each.wall_time, scene, setting, scene.duration)
                for key, (each, setting) in settings.items()
            },
            repeats,
        )
        for key, (each, setting) in settings.items():
            run = judge(each, scene, setting)
            rows.append(
                {
                    "scene": name,
                    "engine": each.name,
                    "kind": key[1],
                    "setting": str(setting),
                    "per_second": times[key].least / scene.duration,
                    "median": times[key].median / scene.duration,
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
    own, bare = engine("crawler2d"), engine("rapier2d")
    rows = []
    for robot in robots:
        for terrain in terrains:
            progress(f"yardstick: {robot}, {terrain}")
            gear, round_ = (
                scenes.load(f"{robot}-{wheel}-{terrain}") for wheel in ("gear", "round")
            )
            cases = {
                "crawler2d gear": (own, gear, own.defaults),
                "crawler2d round": (own, round_, own.defaults),
                "bare round": (bare, round_, at(bare, _YARDSTICK_STEP)),
                "bare round, tuned": (bare, round_, at(bare, _YARDSTICK_STEP, tuned=True)),
                "bare gear, tuned": (bare, gear, at(bare, _YARDSTICK_STEP, tuned=True)),
            }
            times = interleaved(
                {
                    case: partial(each.wall_time, scene, setting, scene.duration)
                    for case, (each, scene, setting) in cases.items()
                },
                repeats,
            )
            costs = {case: time.least / gear.duration for case, time in times.items()}
            rows.append({"robot": robot, "terrain": terrain, "per_second": costs})
    return rows
