"""The costs of a map of rates with a sweep of crawler2d and with a loop over pymunk.

Height of the step and friction, 12 x 12 cells, each with 20 repeats under `of_contact` for every
sample of `of_robot`. The loop builds each of its runs from the scenario of one of ours, and ends it
as soon as the robot has cleared or stands. Its setting is the cheapest whose runs clear or not as
those of the finest, in all but one of a hundred.

Usage, from the repository root: ``python -m benches.peers.maps [--quick]``; it writes the page.
"""

import argparse
import time
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

import crawler2d as c2d
from benches.adapters.own import nominal
from benches.adapters.planar import Draw, Scene, Setting, load_engine, load_scene
from benches.shared.measuring import machine, sentence, write_parts
from benches.shared.results import progress
from crawler2d import Scenario
from research.tables import table

_SCENE = "lwa5-round-step"
_HEIGHT = ("terrain.points[2][1]", "terrain.points[3][1]")
_HEIGHTS = np.linspace(0.05, 0.16, 12)
_FRICTIONS = np.linspace(0.45, 1.0, 12)
_FINEST = Setting(0.125e-3, iterations=100)
_GRID = [Setting(dt * 1e-3, iterations=n) for dt in (1.0, 0.5, 0.25) for n in (5, 10, 30, 80)]
_AGREES = 0.99
# [s] Interval of the checks of the loop, and [m], [s] criteria for a robot that stands.
_LOOK, _STANDS, _WINDOW = 0.1, 1e-3, 2.0

_PAGE = Path(__file__).parents[2] / "docs" / "studies" / "maps.md"


class Ended(NamedTuple):
    """A run of the loop."""

    wall_time: float
    time: float
    cleared: bool


def maps(samples: int = 5, repeats: int = 20, every: int = 101, cells: int = 12) -> dict[str, Any]:
    """Compute the map on one thread, and some of its runs with pymunk.

    Every 101st is of another robot and has other draws than the one before: each hundredth would
    be the first repeat of the first sample, in all cells.
    """
    base = nominal(_SCENE).replace({"criteria.clear_time": 0.5})
    heights, frictions = (np.array(v)[:cells].tolist() for v in (_HEIGHTS, _FRICTIONS))
    over = {_HEIGHT: [(h, h) for h in heights], "terrain.friction": frictions}
    unknown = c2d.unknowns.of_robot(base.robot)
    c2d.sweep(base, {}, repeats=1, progress=False)  # imports
    progress(f"map of {len(heights)} x {len(frictions)} cells")
    start = time.perf_counter()
    swept = c2d.sweep(
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
    cleared = swept["outcome"].to_numpy().ravel()[::every] == "cleared"
    in_core = swept["wall_time"].to_numpy().ravel()
    outside = (wall - float(in_core.sum())) / in_core.size
    loops = _loops(base, swept["scenario"].to_numpy().ravel()[::every].tolist())
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
        "runs": int(swept["outcome"].size),
        "wall": wall,
        "in_core": float(in_core.sum()),
        "simulated": float(swept["time"].mean()),
        "outcomes": swept["outcome"].to_series().value_counts().to_dict(),
        "looped": int(cleared.size),
        "own": float(in_core[::every].mean()) + outside,
        "loops": sorted(rows, key=lambda row: row["wall"]),
        "agrees": _AGREES,
    }


def _loops(base: Scenario, texts: Sequence[str]) -> dict[Setting, list[Ended]]:
    scene = load_scene(_SCENE)
    drawn = [scene_of(scene, base, Scenario.from_json(text)) for text in texts]
    found = {}
    for setting in (*_GRID, _FINEST):
        progress(f"the same by a loop over pymunk: {len(drawn)} runs, {setting}")
        found[setting] = [_run(scene, setting, base.duration) for scene in drawn]
    return found


def _run(scene: Scene, setting: Setting, duration: float) -> Ended:
    from benches.adapters.chipmunk import build  # noqa: PLC0415 - needs pymunk

    start = time.perf_counter()
    plane, bodies = build(scene, setting)
    finish, advance = scene.finish(), plane.steps(setting.time_step)
    seen, looks = [bodies[0].position.x], round(_WINDOW / _LOOK)
    cleared = False
    for _ in range(round(duration / _LOOK)):
        advance(round(_LOOK / setting.time_step))
        seen.append(bodies[0].position.x)
        cleared = seen[-1] > finish
        if cleared or (len(seen) > looks and abs(seen[-1] - seen[-1 - looks]) < _STANDS):
            break
    return Ended(time.perf_counter() - start, _LOOK * (len(seen) - 1), cleared)


def render(found: dict[str, Any]) -> dict[str, str]:
    """Return the parts of the page."""
    agreed = found["agrees"] * found["looped"]
    cheapest = next(row for row in found["loops"] if row["as_finest"] >= agreed)
    own = found["own"]
    columns, rows = found["cells"]
    outside = 1.0 - found["in_core"] / found["wall"]
    outcomes = ", ".join(f"{count} {name}" for name, count in found["outcomes"].items())
    loops = table(
        {
            "pymunk setting": row["setting"],
            "ms per run": f"{1e3 * row['wall']:.1f}",
            "simulated s per run": f"{row['simulated']:.2f}",
            "same as the finest": f"{row['as_finest']} of {found['looped']}",
            "same as crawler2d": f"{row['as_ours']} of {found['looped']}",
        }
        for row in found["loops"]
    )
    return {
        "answer": f"""
One `sweep` on one thread made a map of {columns} heights of a step by {rows} frictions at
{found["runs"] / found["wall"]:.0f} runs a second: {found["runs"]:,} runs in {found["wall"]:.1f} s.
The cheapest loop over pymunk that clears or not as its finest setting in
{100.0 * found["agrees"]:g} % of {found["looped"]} of these runs is {cheapest["setting"]}:
{1e3 * cheapest["wall"]:.1f} ms per run, **{cheapest["wall"] / own:.1f} times** crawler2d's
{1e3 * own:.1f} ms for the same runs.

{loops}
""".strip(),
        "runs": f"""
The robot is on a line of five wheels, with {found["repeats"]} repeats under
`variability.of_contact` for each of {found["samples"]} samples of `unknowns.of_robot` (centre of
mass, torque, belly); {found["simulated"]:.2f} s are simulated a run. {100.0 * outside:.1f} % of the
time went by outside the core. Outcomes: {outcomes}.
""".strip(),
        "measured": sentence(found["machine"], found["took"]),
    }


def main() -> None:
    """Measure, and write the page."""
    parser = argparse.ArgumentParser(prog="python -m benches.peers.maps", description=__doc__)
    parser.add_argument("--quick", action="store_true", help="four cells, and no page")
    quick = parser.parse_args().quick
    start = time.perf_counter()
    versions = {name: load_engine(name).version for name in ("pymunk", "crawler2d")}
    found: dict[str, Any] = {"machine": machine(versions)}
    found |= maps(samples=1, repeats=1, every=1, cells=2) if quick else maps()
    parts = render(found | {"took": time.perf_counter() - start})
    write_parts(parts, None if quick else _PAGE)


def scene_of(nominal: Scene, base: Scenario, drawn: Scenario) -> Scene:
    """Apply to a scene the changes of a drawn scenario.

    Centre of mass, torque, clearance of the belly, approach, speed, friction and height of the step
    may differ.
    """
    chassis, *wheels = nominal.bodies
    mass = sum(body.mass for body in nominal.bodies)
    center = np.subtract(drawn.robot.center_of_mass, base.robot.center_of_mass)
    moved = center * mass / chassis.mass  # so that the total centre moves by `center`
    polygons = tuple(polygon - moved for polygon in chassis.polygons)
    if base.robot.belly is not None and drawn.robot.belly is not None:
        raised = np.subtract(drawn.robot.belly, base.robot.belly)
        polygons = tuple(polygon + raised.mean(axis=0) for polygon in polygons)
    # The nominal centre of all is that of the chassis.
    offset, arms = moved - center, [np.subtract(joint.pa, center) for joint in nominal.joints]
    of_wheels = sum(w.inertia + w.mass * float(a @ a) for w, a in zip(wheels, arms, strict=True))
    inertia = drawn.robot.moment_of_inertia - of_wheels - chassis.mass * float(offset @ offset)
    body = replace(
        chassis,
        x=chassis.x + float(moved[0]),
        y=chassis.y + float(moved[1]),
        inertia=inertia,
        polygons=polygons,
    )
    ratio = drawn.robot.drivetrain.max_torque / base.robot.drivetrain.max_torque
    joints = tuple(
        replace(
            joint,
            pa=(joint.pa[0] - float(moved[0]), joint.pa[1] - float(moved[1])),
            torque=joint.torque * ratio,
        )
        for joint in nominal.joints
    )
    low, high = nominal.boxes
    top = high.copy()
    top[high[:, 1] > 0.0, 1] = drawn.terrain.points[2][1]  # type: ignore[union-attr]
    draw = Draw(
        drawn.start.approach - base.start.approach,
        drawn.drive.speed / base.drive.speed,
        drawn.terrain.friction / nominal.friction,  # type: ignore[union-attr]
    )
    changed = replace(nominal, bodies=(body, *wheels), joints=joints, boxes=(low, top))
    return changed.vary(draw)


if __name__ == "__main__":
    main()
