"""Stops of robots that no study uses: presets, public models, and robots drawn at random."""

import dataclasses
import math
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

import crawler2d as c2d
from crawler2d.parameters.scenario import Scenario

Generator = np.random.Generator

RANDOM_ROBOTS = 20
MODELS = (
    *("belt", "grouser belt", "force on wheels", "skids"),
    *("line", "line", "line", "gears", "gears", "small wheels", "small gears", "chain"),
)
PRESETS: dict[str, Callable[[], c2d.Robot]] = {
    "absolem": c2d.robots.absolem,
    "absolem, bare": lambda: c2d.robots.absolem(flippers=None),
    "absolem, public": lambda: c2d.robots.absolem(track="public"),
    "absolem, public, bare": lambda: c2d.robots.absolem(track="public", flippers=None),
    "marv": c2d.robots.marv,
    "marv, public": lambda: c2d.robots.marv(track="public"),
    "gazebo": c2d.robots.gz_tracked_vehicle,
    "gazebo, public": lambda: c2d.robots.gz_tracked_vehicle(track="public"),
}
NO_FREE_WHEELS = ("lanes", "random_stepfield")
GROUNDS = (
    *("step", "barrier", "knife", "ridge", "gap", "stairs"),
    *("posts", "profile", "field", "lanes"),
)


def simple(number: int) -> c2d.Robot:
    """Make a random robot: the same number makes the same one."""
    rng = np.random.default_rng([21, number])
    length = float(rng.uniform(0.25, 0.8))
    radius = float(rng.uniform(0.12, 0.24)) * length
    robot = c2d.Robot.simple(
        float(rng.uniform(5.0, 80.0)), axle_distance=length, radius=radius, name=f"random {number}"
    )
    x, y = robot.center_of_mass
    moved = (x + float(rng.uniform(-0.1, 0.1)) * length, y + float(rng.uniform(0.0, 0.1)) * length)
    robot = dataclasses.replace(robot, center_of_mass=moved)
    if rng.random() < 0.3:
        robot = dataclasses.replace(robot, belly=None)
    if rng.random() < 0.4:
        arms = c2d.Flippers(
            length=0.7 * length,
            root_radius=radius,
            tip_radius=0.6 * radius,
            mass=0.03 * robot.mass,
            ends=str(rng.choice(["front", "rear", "both"])),  # type: ignore[arg-type]
            angle=float(rng.uniform(0.0, 1.0)),
            torque_limit=1.5 * robot.mass * length,
        )
        robot = robot.with_flippers(arms)
    return robot


def modelled(rng: Generator, robot: c2d.Robot) -> c2d.Robot:
    """The robot with a model of its track."""
    outline = robot.outline
    radius = min(outline.front_radius, outline.rear_radius)
    name = MODELS[rng.integers(len(MODELS))]
    has_grousers = outline.grouser_height > 0.0
    shape: Any = c2d.GearWheel() if "gears" in name and has_grousers else c2d.RoundWheel()
    if name in ("skids", "force on wheels"):
        robot = robot.without_flippers()
    around = 2.0 * (math.pi * radius + outline.axle_distance)
    small = max(int(around / radius * rng.uniform(1.0, 1.6)), 14)
    track: Any = {
        "belt": c2d.BeltTrack(),
        "grouser belt": c2d.GrouserBeltTrack() if has_grousers else c2d.BeltTrack(),
        "force on wheels": c2d.ForceTrack(support="wheels"),
        "skids": c2d.ForceTrack(skid_friction=float(rng.uniform(0.0, 0.5))),
        "chain": c2d.SegmentalTrack(),
    }.get(name)
    if name.startswith("small"):
        track = c2d.CircumferentialWheels(small, wheel=shape)
    elif track is None:
        track = c2d.LineOfWheels(int(rng.integers(2, 8)), wheel=shape)
        if rng.random() < 0.25:
            motors = dataclasses.replace(robot.drivetrain, torque_sharing="wheel")
            robot = dataclasses.replace(robot, drivetrain=motors)
    return robot.with_track(track)


def ground(rng: Generator, size: float) -> Any:
    """Ground with obstacles of up to about the height of a track [m]."""
    kind = GROUNDS[rng.integers(len(GROUNDS))]
    high = size * float(rng.uniform(0.3, 1.8))
    friction: dict[str, Any] = {"friction": float(rng.uniform(0.3, 1.2))}
    on = c2d.terrains
    drawn = {"posts": posts, "profile": profile}
    if kind in drawn:
        return drawn[kind](rng, size, friction["friction"])
    if kind == "lanes":
        tall = on.step(high, friction=float(rng.uniform(0.3, 1.2)))
        return on.lanes(on.step(high * float(rng.uniform(0.3, 1.0)), **friction), tall)
    grounds: dict[str, Callable[[], Any]] = {
        "step": lambda: on.step(high, **friction),
        "barrier": lambda: on.barrier(high, size * float(rng.uniform(0.2, 3.0)), **friction),
        "knife": lambda: on.knife_edge(high, thickness=0.08 * size, **friction),
        "ridge": lambda: on.ridge(high, float(rng.uniform(0.3, 2.4)), **friction),
        "gap": lambda: on.gap(size * float(rng.uniform(1.0, 5.0)), **friction),
        "stairs": lambda: on.stairs(
            count=3, rise=0.8 * high, run=size * float(rng.uniform(1.5, 4.0)), **friction
        ),
        "field": lambda: on.random_stepfield(int(rng.integers(1000)), **friction),
    }
    return grounds[kind]()


def posts(rng: Generator, size: float, friction: float) -> Any:
    points, x = [(-20.0 * size, 0.0)], 0.0
    for _ in range(int(rng.integers(2, 7))):
        thick, high = size * float(rng.uniform(0.1, 0.6)), size * float(rng.uniform(0.2, 1.5))
        points += [(x, 0.0), (x, high), (x + thick, high), (x + thick, 0.0)]
        x += thick + size * float(rng.uniform(0.3, 3.0))
    return c2d.terrains.from_points([*points, (x + 60 * size, 0.0)], goal=x, friction=friction)


def profile(rng: Generator, size: float, friction: float) -> Any:
    points, x, y = [(-20.0 * size, 0.0), (0.0, 0.0)], 0.0, 0.0
    for _ in range(int(rng.integers(4, 12))):
        if rng.random() > 0.3:
            x += size * float(rng.uniform(0.2, 2.0))
        y = float(np.clip(y + rng.normal(0.0, 0.7 * size), -2.0 * size, 2.5 * size))
        points.append((x, y))
    x += size
    points += [(x, y), (x + 60.0 * size, y)]
    return c2d.terrains.from_points(points, goal=x, friction=friction)


def draw(rng: Generator) -> tuple[str, Scenario]:
    """Draw a scenario, and the name of its robot's group."""
    if rng.random() < 0.5:
        group = str(rng.choice(list(PRESETS)))
        robot = PRESETS[group]()
        if "public" not in group and group != "marv":
            robot = modelled(rng, robot)
    else:
        group = "random"
        robot = modelled(rng, simple(int(rng.integers(RANDOM_ROBOTS))))
    strength = float(np.exp(rng.uniform(*np.log((0.15, 4.0)))))
    limit = strength * robot.drivetrain.max_torque
    robot = dataclasses.replace(
        robot, drivetrain=dataclasses.replace(robot.drivetrain, max_torque=limit)
    )
    gait: Any = None
    if robot.flippers is not None:
        kind = rng.integers(3)
        gait = [None, c2d.Climb(), c2d.Hold(float(rng.uniform(-0.4, 1.0)))][kind]
    size = max(robot.outline.front_radius, robot.outline.rear_radius)
    terrain = ground(rng, size)
    # The second judge knows free wheels only on one lane.
    while robot.track == c2d.ForceTrack(support="wheels") and terrain.kind in NO_FREE_WHEELS:
        terrain = ground(rng, size)
    speed = min(0.4, robot.drivetrain.max_speed)
    start = c2d.Start(
        approach=float(rng.uniform(0.02, 0.2)),
        track_phase=float(rng.uniform(0.0, robot.outline.grouser_pitch)),
    )
    drive = c2d.Drive(speed=float(rng.uniform(0.3, 1.0)) * speed, gait=gait)
    return group, Scenario(
        robot, terrain, drive=drive, start=start, duration=float(rng.uniform(10.0, 16.0))
    )


def stops(seed: int, count: int, trials: Any) -> Iterator[tuple[str, c2d.Run]]:
    """Yield this many runs that ended in a stop, with their groups; trials are made of each."""
    rng, found, at_a_time = np.random.default_rng(seed), 0, min(count, 60)
    while found < count:
        drawn = [draw(rng) for _ in range(at_a_time)]
        runs = c2d.simulate_many(
            [scenario for _, scenario in drawn], threads=2, trials=trials, on_error="record"
        )
        for (group, _), run in zip(drawn, runs, strict=True):
            if run.diagnosis is not None and found < count:
                found += 1
                yield group, run
