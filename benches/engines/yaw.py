"""Jams of the side view in three dimensions, at edges that are not square to the robot."""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

import crawler2d as c2d
from benches.adapters.ground import turned
from benches.adapters.space import load, scene_of
from benches.engines.cells import DRIVES, ROBOTS, with_motors
from benches.engines.runs import run_in
from benches.shared.measuring import rate
from benches.shared.results import Results, progress
from crawler2d import Diagnosis, Scenario, simulate_many
from crawler2d.parameters.track import Track
from research.models import obstacle
from research.tables import markdown_table

Jam = Mapping[str, Any]
"""A jam with its runs by yaw."""

_SEED = 1
_EACH = 20  # jams per model
_YAWS = (0, 1, 3, 5)  # degrees
_MODELS: dict[str, Track] = {
    "line of 2": c2d.LineOfWheels(2),
    "line of 3": c2d.LineOfWheels(3),
    "line of 5": c2d.LineOfWheels(5),
    "24 all round": c2d.CircumferentialWheels(24),
}
_DRIVES = tuple(name for name in DRIVES if name != "6 N m, track")  # which takes gears in between
_GROUNDS = ("step", "knife edge", "barrier")
_SPEED = 0.2  # [m/s]
_LENGTHS = 5.5  # axle distances at that speed: the longest time
_ESCAPE = c2d.SeizureCriteria().escape_distance
_PUSH = 0.15  # [-] weights


def turn(path: Path) -> None:
    """Run the missing jams of each model in Bullet at its fine setting, at each yaw.

    Each one is driven from the pose of the stop, and from the start of the run.
    """
    engine: Any = load("Bullet")
    results = Results(path, {"engine": engine.version, "jams": {model: [] for model in _MODELS}})
    for model, jams in results.data["jams"].items():
        for label, scenario, stop, push in list(draw_jams(model))[len(jams) :]:
            jam = {
                "label": label,
                "mechanism": str(stop.mechanism),
                "x": round(stop.position[0], 5),
                "push": round(push, 4),
                "set": {str(yaw): _set(engine, scenario, stop, yaw) for yaw in _YAWS},
                "start": {str(yaw): _started(engine, scenario, yaw) for yaw in _YAWS},
            }
            jams.append(jam)
            progress(f"{model}; {label}: {', '.join(_verdict(jam, yaw) for yaw in _YAWS)}")
            results.save()


def draw_jams(model: str) -> Iterator[tuple[str, Scenario, Diagnosis, float]]:
    """Yield drawn runs of a model that seize in crawler2d: label, scenario, stop and push.

    The push, in weights, is the largest level of the escape force that does not move the robot on.

    Robot, motors and obstacle are drawn, its height (0.4 to 1.6 radii), the friction (0.5 to 1),
    the approach (a quarter of the axle distance) and the phase of the wheels (a turn).
    """
    draw = np.random.default_rng([_SEED, list(_MODELS).index(model)])
    count = 0
    while count < _EACH:
        label, scenario = _draw(_MODELS[model], draw)
        (run,) = simulate_many([scenario], record="summary", threads=1)
        if run.outcome == "seized" and run.diagnosis is not None:
            count += 1
            push = run.escape_force().low / (scenario.robot.mass * scenario.gravity)
            yield label, scenario, run.diagnosis, push


def holds(jam: Jam, yaw: int) -> bool:
    """Whether a robot that starts in its jam stays within crawler2d's distance of an escape.

    Examples
    --------
    >>> jam = {"x": 0.1, "set": {"3": {"x": 0.12}, "5": {"x": 0.2}}}
    >>> holds(jam, 3), holds(jam, 5)
    (True, False)
    """
    return bool(jam["set"][str(yaw)]["x"] - jam["x"] < _ESCAPE)


def fails(jam: Jam, yaw: int) -> bool:
    """Whether a robot that starts as in the scenario does not clear."""
    return bool(jam["start"][str(yaw)]["end"] != "cleared")


def table(found: dict[str, Any]) -> str:
    """Return how many hold or fail square to the edge, and how many of these do at each yaw."""
    jams = found["jams"]
    every = [jam for mine in jams.values() for jam in mine]
    groups = {
        **jams,
        "all": every,
        f"all that withstand a push of {_PUSH} weights": [
            jam for jam in every if jam["push"] >= _PUSH
        ],
        "all others": [jam for jam in every if jam["push"] < _PUSH],
    }
    rows = [
        [kind, model, *_row(mine, rule)]
        for kind, rule in (("from rest in the jam", holds), ("from the start", fails))
        for model, mine in groups.items()
    ]
    head = ["robot", "jams", "stays at 0 degrees", *(f"of these at {yaw}" for yaw in _YAWS[1:])]
    return markdown_table(head, rows)


def _set(engine: Any, scenario: Scenario, stop: Diagnosis, yaw: int) -> dict[str, Any]:
    """Drive from rest in the pose of a stop, or nearby where no ground is inside the robot.

    The ground is turned about the vertical through the edge in the pocket, between the tracks.
    """
    start, (x, z) = scene_of(scenario), stop.position
    edge = stop.intrusion.x if stop.intrusion else 0.0
    ground = turned(start.ground, math.radians(yaw), edge)
    scene = engine.clear(replace(start, ground=ground, x=x, z=z, angle=stop.chassis_angle))
    moved = round(scene.x - x, 5), round(scene.z - z, 5)
    return {**run_in(engine, scenario, scene), "moved": moved}


def _started(engine: Any, scenario: Scenario, yaw: int) -> dict[str, Any]:
    """Drive from the start, the ground turned about the vertical through x = 0."""
    start = scene_of(scenario)
    return run_in(engine, scenario, replace(start, ground=turned(start.ground, math.radians(yaw))))


def _verdict(jam: Jam, yaw: int) -> str:
    return f"{'holds' if holds(jam, yaw) else 'gets on'}/{'fails' if fails(jam, yaw) else 'clears'}"


def _row(jams: Sequence[Jam], counts: Callable[[Jam, int], bool]) -> list[str]:
    base = [jam for jam in jams if counts(jam, 0)]
    numbers = [sum(counts(jam, yaw) for jam in base) for yaw in _YAWS[1:]]
    return [rate(len(base), len(jams)), *(rate(count, len(base)) for count in numbers)]


def _draw(track: Track, draw: np.random.Generator) -> tuple[str, Scenario]:
    name, drive = str(draw.choice(list(ROBOTS))), str(draw.choice(_DRIVES))
    robot = with_motors(ROBOTS[name](track=track), drive)
    length, radius = robot.outline.axle_distance, robot.outline.front_radius
    ground = str(draw.choice(_GROUNDS))
    height, friction = radius * draw.uniform(0.4, 1.6), draw.uniform(0.5, 1.0)
    approach = length * draw.uniform(0.075, 0.325)
    phase = draw.uniform(0.0, 2.0 * np.pi * radius)
    scenario = Scenario(
        robot,
        obstacle(ground, height, friction),
        drive=c2d.Drive(speed=_SPEED),
        start=c2d.Start(approach=approach, track_phase=phase),
        duration=round(_LENGTHS * length / _SPEED, 2),
    )
    where = f"{ground} of {1e3 * height:.4g} mm, friction {friction:.3g}"
    return f"{name}; {drive}; {where}", scenario
