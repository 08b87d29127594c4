"""A map of rates, as a sweep of ours and as a loop over pymunk: what each costs.

Height of the step and friction, 12 x 12 cells, each with 20 repeats under `of_contact` for every
sample of `of_robot`. The loop builds each of its runs from the scenario of one of ours, and ends it
as soon as the robot has cleared or stands. Its setting is the cheapest whose runs clear or not as
those of the finest, in all but one of a hundred.

Usage, from the repository root: ``python -m benches.peers.maps [--quick]``; it writes the report.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

import crawler2d as c2d
from benches.peers import machine, markdown, scenes
from benches.peers.drawn_scene import scene_of
from benches.peers.engine import Setting
from benches.peers.engine_crawler2d import as_it_is
from benches.peers.engines import engine
from benches.peers.scenes import Scene
from benches.peers.timing import progress
from crawler2d.parameters.scenario import Scenario

__all__ = ["maps", "render"]

_SCENE = "lwa5-round-step"
_HEIGHT = ("terrain.points[2][1]", "terrain.points[3][1]")
_HEIGHTS = np.linspace(0.05, 0.16, 12)
_FRICTIONS = np.linspace(0.45, 1.0, 12)
_FINEST = Setting(0.125e-3, iterations=100)
_GRID = [Setting(dt * 1e-3, iterations=n) for dt in (1.0, 0.5, 0.25) for n in (5, 10, 30, 80)]
_AGREES = 0.99
# [s] How often the loop looks, and [m], [s] what it takes for a robot that stands.
_LOOK, _STANDS, _WINDOW = 0.1, 1e-3, 2.0

_REPORT = Path(__file__).parents[2] / "docs" / "studies" / "maps.md"


class Ended(NamedTuple):
    """A run of the loop."""

    wall_time: float
    time: float
    cleared: bool


def maps(samples: int = 5, repeats: int = 20, every: int = 100, cells: int = 12) -> dict[str, Any]:
    """Make the map on one thread, and every hundredth of its runs with pymunk."""
    base = as_it_is(_SCENE).replace({"criteria.clear_time": 0.5})
    heights, frictions = (np.array(v)[:cells].tolist() for v in (_HEIGHTS, _FRICTIONS))
    over = {_HEIGHT: [(h, h) for h in heights], "terrain.friction": frictions}
    unknown = c2d.unknowns.of_robot(base.robot)
    c2d.sweep(base, {}, repeats=1, progress=False)  # imports
    progress(f"map of {len(heights)} x {len(frictions)} cells")
    start = time.perf_counter()
    table = c2d.sweep(
        base,
        over,
        vary=c2d.variability.of_contact(),
        unknown=unknown,
        samples=samples,
        repeats=repeats,
        threads=1,
        wall_time=True,
        progress=False,
    )
    wall = time.perf_counter() - start
    cleared = table["outcome"].to_numpy().ravel()[::every] == "cleared"
    loops = _loops(base, table["scenario"].to_numpy().ravel()[::every].tolist())
    finest = [run.cleared for run in loops[_FINEST]]
    rows = [
        {
            "setting": str(setting),
            "wall": sum(run.wall_time for run in runs) / len(runs),
            "simulated": sum(run.time for run in runs) / len(runs),
            "as_finest": sum(r.cleared == f for r, f in zip(runs, finest, strict=True)),
            "as_ours": sum(r.cleared == c for r, c in zip(runs, cleared, strict=True)),
        }
        for setting, runs in loops.items()
    ]
    return {
        "cells": [len(heights), len(frictions)],
        "samples": samples,
        "repeats": repeats,
        "runs": int(table["outcome"].size),
        "wall": wall,
        "in_core": float(table["wall_time"].sum()),
        "simulated": float(table["time"].mean()),
        "outcomes": table["outcome"].to_series().value_counts().to_dict(),
        "looped": int(cleared.size),
        "loops": sorted(rows, key=lambda row: row["wall"]),
        "agrees": _AGREES,
    }


def _loops(base: Scenario, texts: Sequence[str]) -> dict[Setting, list[Ended]]:
    nominal = scenes.load(_SCENE)
    drawn = [scene_of(nominal, base, Scenario.from_json(text)) for text in texts]
    found = {}
    for setting in (*_GRID, _FINEST):
        progress(f"the same by a loop over pymunk: {len(drawn)} runs, {setting}")
        found[setting] = [_run(scene, setting, base.duration) for scene in drawn]
    return found


def _run(scene: Scene, setting: Setting, duration: float) -> Ended:
    from benches.peers.engine_pymunk import build  # noqa: PLC0415 - needs pymunk

    start = time.perf_counter()
    space, bodies = build(scene, setting)
    finish, dt = scene.finish(), setting.time_step
    seen, looks = [bodies[0].position.x], round(_WINDOW / _LOOK)
    cleared = False
    for _ in range(round(duration / _LOOK)):
        for _ in range(round(_LOOK / dt)):
            space.step(dt)
        seen.append(bodies[0].position.x)
        cleared = seen[-1] > finish
        if cleared or (len(seen) > looks and abs(seen[-1] - seen[-1 - looks]) < _STANDS):
            break
    return Ended(time.perf_counter() - start, _LOOK * (len(seen) - 1), cleared)


def render(found: dict[str, Any]) -> str:
    """Write the report."""
    columns, rows = found["cells"]
    agreed = found["agrees"] * found["looped"]
    cheapest = next(row for row in found["loops"] if row["as_finest"] >= agreed)
    own = found["wall"] / found["runs"]
    outside = 1.0 - found["in_core"] / found["wall"]
    outcomes = ", ".join(f"{count} {name}" for name, count in found["outcomes"].items())
    head = ["pymunk's setting", "ms a run", "s simulated a run", "as the finest", "as crawler2d"]
    table = [
        [
            row["setting"],
            f"{1e3 * row['wall']:.1f}",
            f"{row['simulated']:.2f}",
            f"{row['as_finest']} of {found['looped']}",
            f"{row['as_ours']} of {found['looped']}",
        ]
        for row in found["loops"]
    ]
    return markdown.page(
        [
            "# A map of rates, and what it costs",
            f"""
One `sweep` on one thread made a map of {columns} heights of a step by {rows} frictions at
{1.0 / own:.0f} runs a second: {found["runs"]:,} runs in {found["wall"]:.1f} s. The cheapest loop
over pymunk that clears or not as its finest setting in {100.0 * found["agrees"]:g} % of the runs is
{cheapest["setting"]}: {1e3 * cheapest["wall"]:.1f} ms a run, **{cheapest["wall"] / own:.1f} times**
crawler2d's {1e3 * own:.1f} ms.
""",
            markdown.table(head, table),
            f"""
The robot is on a line of five wheels, with {found["repeats"]} repeats under
`variability.of_contact` for each of {found["samples"]} samples of `unknowns.of_robot` (centre of
mass, torque, belly); {found["simulated"]:.2f} s are simulated a run. {100.0 * outside:.1f} % of the
time went by outside the core. Outcomes: {outcomes}.
""",
            "## What limits the answer",
            f"""
The loop, on one thread, has {found["looped"]} of these runs, spread evenly. It ends a run as soon
as the rear axle has passed the edge, or the robot has moved by less than {1e3 * _STANDS:g} mm in
{_WINDOW:g} s, and finds only whether it cleared; crawler2d also says how it stopped, and tries a
closed track where that needs it.
""",
            "## How to repeat it",
            f"`make bench-map`. {machine.sentence(found['machine'], found['took'])}",
        ]
    )


def main() -> None:
    """Measure, and write the report."""
    parser = argparse.ArgumentParser(prog="python -m benches.peers.maps", description=__doc__)
    parser.add_argument("--quick", action="store_true", help="four cells, and no report")
    quick = parser.parse_args().quick
    start = time.perf_counter()
    versions = {name: engine(name).version for name in ("pymunk", "crawler2d")}
    found: dict[str, Any] = {"machine": machine.describe(versions)}
    found |= maps(samples=1, repeats=1, every=1, cells=2) if quick else maps()
    text = render(found | {"took": time.perf_counter() - start})
    sys.stdout.write(text)
    if not quick:
        _REPORT.write_text(text, encoding="utf-8", newline="\n")


if __name__ == "__main__":
    main()
