"""Random stops of every kind: strata of robots, grounds and commands, each drawn from a seed."""

import dataclasses
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

import crawler2d as c2d
from crawler2d.parameters.scenario import Scenario

Generator = np.random.Generator

HALF, RADIUS = 0.1825, 0.064  # [m] of the Engineer


Strata = dict[str, Callable[[Generator], Scenario]]


def draw(stratum: str, index: int, seed: int = 0, strata: Strata | None = None) -> Scenario:
    """Scenario number `index` of a stratum; the same arguments give the same scenario."""
    strata = strata or STRATA
    number = list(strata).index(stratum)
    rng = np.random.default_rng([seed, number, index])
    for _ in range(20):
        scenario = strata[stratum](rng)
        try:
            scenario.validate()
        except c2d.ScenarioError:  # such as wheels that are too few to touch
            continue
        return scenario
    raise AssertionError(f"stratum {stratum} draws nothing that is valid")


def drawn(
    stratum: str, count: int, seed: int = 0, strata: Strata | None = None
) -> Iterator[Scenario]:
    """The first scenarios of a stratum."""
    return (draw(stratum, index, seed, strata) for index in range(count))


# Tracks


def gear(rng: Generator) -> c2d.GearWheel:
    if rng.random() < 0.5:
        return c2d.GearWheel()
    return c2d.GearWheel(
        grouser_count=int(rng.integers(5, 14)), phase_fraction=float(rng.uniform(0.0, 1.0))
    )


def wheel(rng: Generator) -> Any:
    return gear(rng) if rng.random() < 0.5 else c2d.RoundWheel()


def line(rng: Generator, shape: Any) -> Any:
    count = int(rng.integers(2, 10))
    kind = rng.integers(3)
    if kind == 0 or count < 4:
        return c2d.LineOfWheels(count, wheel=shape)
    # Slots, or a little overlap.
    spacing = 2.0 * HALF / (count - 1)
    radius = min(float(rng.uniform(0.3, 0.6)) * spacing, RADIUS) if kind == 1 else 0.5 * spacing
    return c2d.LineOfWheels(count, wheel_radius=min(radius, RADIUS), wheel=shape)


def slotted(rng: Generator, shape: Any) -> Any:
    """Wheels with slots wide enough to let edges in."""
    count = int(rng.integers(3, 7))
    spacing = 2.0 * HALF / (count - 1)
    radius = float(rng.uniform(0.3, 0.55)) * spacing
    return c2d.LineOfWheels(count, wheel_radius=float(np.clip(radius, 0.02, RADIUS)), wheel=shape)


def circumferential(rng: Generator, shape: Any) -> Any:
    if rng.random() < 0.5:
        return c2d.CircumferentialWheels(int(rng.integers(14, 31)), wheel=shape)
    radius = float(rng.uniform(0.010, 0.03))
    return c2d.CircumferentialWheels(int(rng.integers(8, 25)), wheel_radius=radius, wheel=shape)


def hybrid(rng: Generator, shape: Any) -> Any:
    small = float(rng.uniform(0.02, 0.045))
    inner = np.linspace(-0.09, 0.09, int(rng.integers(1, 5)))
    placements = [
        (-HALF, 0.0, RADIUS),
        *((float(x), small - RADIUS, small) for x in inner),
        (HALF, 0.0, RADIUS),
    ]
    return c2d.HybridWheels(tuple(placements), wheel=shape)


def force(rng: Generator) -> Any:
    if rng.random() < 0.5:
        return c2d.ForceTrack(skid_friction=float(rng.choice([0.0, 0.2, 0.5])))
    return c2d.ForceTrack(support="wheels", wheel_count=int(rng.integers(2, 7)))


def any_track(rng: Generator) -> Any:
    kind = rng.integers(8)
    if kind < 3:
        return line(rng, wheel(rng))
    if kind < 5:
        return circumferential(rng, wheel(rng))
    if kind == 5:
        return hybrid(rng, wheel(rng))
    return c2d.BeltTrack() if kind == 6 else force(rng)


def wheeled(rng: Generator) -> Any:
    shape = wheel(rng)
    return [line, slotted, circumferential, hybrid][rng.integers(4)](rng, shape)


# Robots


def robot(
    rng: Generator,
    track: Any,
    *,
    torque: tuple[float, float] = (0.5, 20.0),
    clearance: tuple[float, float] = (0.0, 0.06),
    bellyless: float = 0.25,
) -> c2d.Robot:
    """The Engineer with another mass distribution, belly and motors."""
    center = (float(rng.uniform(-0.06, 0.06)), float(rng.uniform(-0.02, 0.07)))
    base = c2d.robots.engineer(
        flippers=None,
        center_of_mass=center,
        belly_clearance=float(rng.uniform(*clearance)),
        track=track,
    )
    shared = rng.random() < 0.7
    drivetrain = dataclasses.replace(
        base.drivetrain,
        max_torque=float(np.exp(rng.uniform(*np.log(torque)))),
        torque_sharing="track" if shared or track.kind != "line" else "wheel",
    )
    belly = None if rng.random() < bellyless else base.belly
    return dataclasses.replace(base, drivetrain=drivetrain, belly=belly)


# Grounds


def step(rng: Generator, friction: float) -> Any:
    return c2d.terrains.step(float(rng.uniform(0.04, 0.25)), friction=friction)


def barrier(rng: Generator, friction: float) -> Any:
    thickness = float(rng.uniform(0.01, 0.3))
    return c2d.terrains.barrier(float(rng.uniform(0.03, 0.16)), thickness, friction=friction)


def knife(rng: Generator, friction: float) -> Any:
    thickness = float(rng.uniform(0.002, 0.02))
    height = float(rng.uniform(0.02, 0.12))
    return c2d.terrains.knife_edge(height, thickness=thickness, friction=friction)


def ridge(rng: Generator, friction: float) -> Any:
    angle = float(rng.uniform(0.2, 2.6))
    return c2d.terrains.ridge(float(rng.uniform(0.02, 0.14)), angle, friction=friction)


def gap(rng: Generator, friction: float) -> Any:
    return c2d.terrains.gap(float(rng.uniform(0.05, 0.5)), friction=friction)


def stairs(rng: Generator, friction: float) -> Any:
    rise, run = float(rng.uniform(0.03, 0.2)), float(rng.uniform(0.1, 0.3))
    return c2d.terrains.stairs(count=3, rise=rise, run=run, friction=friction)


def posts(rng: Generator, friction: float) -> Any:
    points, x = [(-3.0, 0.0)], 0.0
    for _ in range(int(rng.integers(2, 7))):
        thick, high = float(rng.uniform(0.004, 0.04)), float(rng.uniform(0.01, 0.12))
        points += [(x, 0.0), (x, high), (x + thick, high), (x + thick, 0.0)]
        x += thick + float(rng.uniform(0.02, 0.25))
    return c2d.terrains.from_points([*points, (x + 3.0, 0.0)], goal=x, friction=friction)


def profile(rng: Generator, friction: float) -> Any:
    """Random ground, now and then with a vertical face."""
    points, x, y = [(-3.0, 0.0), (0.0, 0.0)], 0.0, 0.0
    for _ in range(int(rng.integers(3, 12))):
        if rng.random() > 0.3:
            x += float(rng.uniform(0.01, 0.15))
        y = float(np.clip(y + rng.normal(0.0, 0.05), -0.15, 0.2))
        points.append((x, y))
    x += 0.05
    return c2d.terrains.from_points([*points, (x, y), (x + 3.0, y)], goal=x, friction=friction)


GROUNDS = (step, barrier, knife, ridge, gap, stairs, posts, profile)


def ground(rng: Generator, friction: tuple[float, float] = (0.2, 1.5), kinds: Any = GROUNDS) -> Any:
    return kinds[rng.integers(len(kinds))](rng, float(rng.uniform(*friction)))


def scenario(rng: Generator, model: c2d.Robot, terrain: Any, **fields: Any) -> Scenario:
    return Scenario(
        model,
        terrain,
        **{
            "drive": c2d.Drive(speed=float(rng.uniform(0.05, 0.4))),
            "start": c2d.Start(
                approach=float(rng.uniform(0.01, 0.12)), track_phase=float(rng.uniform(0.0, 0.048))
            ),
            "duration": float(rng.uniform(8.0, 15.0)),
            **fields,
        },
    )


# Strata


def of_anything(rng: Generator) -> Scenario:
    return scenario(rng, robot(rng, any_track(rng)), ground(rng))


def of_wheels(rng: Generator) -> Scenario:
    return scenario(rng, robot(rng, wheeled(rng)), ground(rng))


def of_slots(rng: Generator) -> Scenario:
    """Edges between wheels: straddled and undercut."""
    model = robot(rng, slotted(rng, c2d.RoundWheel()), torque=(3.0, 20.0), bellyless=0.6)
    return scenario(rng, model, ground(rng, (0.2, 1.0), (knife, posts, barrier, step, ridge)))


def of_weak_motors(rng: Generator) -> Scenario:
    """Stalled; blocked where an edge is inside."""
    model = robot(rng, wheeled(rng), torque=(0.3, 3.0), bellyless=0.6)
    return scenario(rng, model, ground(rng, (0.5, 1.5)))


def of_weak_gears(rng: Generator) -> Scenario:
    """Grousers that hook into edges and posts."""
    shape = gear(rng)
    track = [line, slotted, circumferential, hybrid][rng.integers(4)](rng, shape)
    model = robot(rng, track, torque=(0.5, 6.0), bellyless=0.6)
    return scenario(rng, model, ground(rng, (0.3, 1.5), (knife, posts, step, barrier, stairs)))


def of_low_bellies(rng: Generator) -> Scenario:
    """Hung up, the belly even below the track."""
    model = robot(rng, any_track(rng), clearance=(-0.015, 0.03), bellyless=0.0)
    return scenario(rng, model, ground(rng))


def of_little_grip(rng: Generator) -> Scenario:
    model = robot(rng, any_track(rng), torque=(6.0, 20.0), bellyless=0.6)
    return scenario(rng, model, ground(rng, (0.1, 0.5)))


def of_smooth_tracks(rng: Generator) -> Scenario:
    """Belts, skids and free wheels, into which no edge gets, or which do not turn."""
    track = c2d.BeltTrack() if rng.random() < 0.4 else force(rng)
    return scenario(rng, robot(rng, track, clearance=(-0.01, 0.06)), ground(rng))


def of_walls(rng: Generator) -> Scenario:
    """Too high for anything."""
    wall = c2d.terrains.step(0.6, friction=float(rng.uniform(0.2, 1.5)))
    return scenario(rng, robot(rng, any_track(rng)), wall)


def of_gears_at_walls(rng: Generator) -> Scenario:
    """Grousers that climb and fall: cycling."""
    shape = gear(rng)
    track = [line, circumferential, hybrid][rng.integers(3)](rng, shape)
    model = robot(rng, track, torque=(3.0, 20.0), bellyless=0.4)
    return scenario(rng, model, ground(rng, (0.4, 1.2), (step, barrier, gap, profile)))


def of_long_grousers(rng: Generator) -> Scenario:
    """A few long grousers that push off a wall and come back: cycling."""
    shape = c2d.GearWheel(
        grouser_count=int(rng.integers(3, 6)),
        grouser_height=float(rng.uniform(0.02, 0.04)),
        tip_thickness=0.006,
        phase_fraction=float(rng.uniform(0.0, 1.0)),
    )
    track = c2d.LineOfWheels(int(rng.integers(2, 4)), wheel=shape)
    model = robot(rng, track, torque=(6.0, 20.0), bellyless=0.7)
    wall = c2d.terrains.step(float(rng.uniform(0.12, 0.4)), friction=float(rng.uniform(0.2, 0.9)))
    return scenario(rng, model, wall)


def of_small_obstacles(rng: Generator) -> Scenario:
    """Cleared."""
    terrain = c2d.terrains.step(float(rng.uniform(0.005, 0.04)), friction=0.9)
    model = robot(rng, any_track(rng), torque=(6.0, 20.0), clearance=(0.05, 0.06))
    return scenario(rng, model, terrain, drive=c2d.Drive(speed=float(rng.uniform(0.2, 0.4))))


def of_high_steps(rng: Generator) -> Scenario:
    """Tipped over."""
    terrain = c2d.terrains.step(float(rng.uniform(0.2, 0.3)), friction=float(rng.uniform(0.9, 1.5)))
    model = robot(rng, c2d.BeltTrack(), torque=(10.0, 20.0), bellyless=1.0)
    return scenario(rng, model, terrain, drive=c2d.Drive(speed=float(rng.uniform(0.2, 0.4))))


def of_ends(rng: Generator) -> Scenario:
    """Ground that ends before the goal."""
    end = float(rng.uniform(0.1, 0.5))
    terrain = c2d.terrains.from_points([(-1.0, 0.0), (0.0, 0.001), (end, 0.0)], goal=end)
    return scenario(rng, robot(rng, any_track(rng)), terrain)


def of_short_times(rng: Generator) -> Scenario:
    """Timed out."""
    length = float(rng.uniform(3.0, 8.0))
    return scenario(
        rng, robot(rng, any_track(rng), torque=(4.0, 20.0)), c2d.terrains.flat(length=length)
    )


STRATA: Strata = {
    "anything": of_anything,
    "wheels": of_wheels,
    "slots": of_slots,
    "weak motors": of_weak_motors,
    "weak gears": of_weak_gears,
    "low bellies": of_low_bellies,
    "little grip": of_little_grip,
    "smooth tracks": of_smooth_tracks,
    "walls": of_walls,
    "gears at walls": of_gears_at_walls,
    "long grousers": of_long_grousers,
    "small obstacles": of_small_obstacles,
    "high steps": of_high_steps,
    "ends": of_ends,
    "short times": of_short_times,
}
"""What is drawn from, by name; the order is part of the seeds."""
