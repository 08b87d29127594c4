"""Random stops of belts with grousers, chains of shoes, robots with flippers, and two lanes."""

import dataclasses
import math
from typing import Any

import numpy as np

import crawler2d as c2d
from crawler2d.parameters.scenario import Scenario
from tests.census.strata import (
    Generator,
    Strata,
    any_track,
    barrier,
    gear,
    ground,
    knife,
    line,
    posts,
    profile,
    ridge,
    robot,
    scenario,
    slotted,
    stairs,
    step,
    wheel,
)

# Tracks


def grouser_belt(rng: Generator) -> c2d.GrouserBeltTrack:
    count = int(rng.integers(5, 40)) if rng.random() < 0.5 else None
    return c2d.GrouserBeltTrack(grouser_count=count)


def chain(rng: Generator, mechanism: Any) -> c2d.SegmentalTrack:
    count = int(rng.choice([22, 22, 36, 44]))
    shape: Any = str(rng.choice(["rectangle", "trapezoid"]))
    few = None if mechanism == "guide" or rng.random() < 0.5 else 3
    return c2d.SegmentalTrack(
        shoe_count=count, mechanism=mechanism, shoe_shape=shape, road_wheel_count=few
    )


def new_track(rng: Generator) -> Any:
    kind = rng.integers(3)
    if kind == 0:
        return grouser_belt(rng)
    return chain(rng, "guide" if kind == 1 else "sprocket")


# Robots


def without_grousers(model: c2d.Robot) -> c2d.Robot:
    outline = dataclasses.replace(model.outline, grouser_height=0.0)
    return dataclasses.replace(model, outline=outline)


def shod(rng: Generator, mechanism: str, **fields: Any) -> c2d.Robot:
    """A robot on a chain, now and then without grousers."""
    model = robot(rng, chain(rng, mechanism), **fields)
    return without_grousers(model) if rng.random() < 0.3 else model


def arm_track(rng: Generator) -> Any:
    kind = rng.integers(4)
    if kind == 0:
        return c2d.LineOfWheels(int(rng.integers(2, 6)), wheel=wheel(rng))
    if kind == 1:
        spacing = float(rng.uniform(0.02, 0.037))
        return c2d.LineOfWheels(int(rng.integers(2, 5)), wheel_radius=spacing, wheel=wheel(rng))
    return c2d.BeltTrack() if kind == 2 else grouser_belt(rng)


def with_arms(rng: Generator, model: c2d.Robot, arms: Any) -> c2d.Robot:
    """The robot with flippers that have strong or weak motors."""
    flippers = c2d.Flippers(
        length=float(rng.uniform(0.2, 0.36)),
        root_radius=0.064,
        tip_radius=float(rng.uniform(0.03, 0.05)),
        mass=0.775,
        ends=str(rng.choice(["front", "rear", "both"])),  # type: ignore[arg-type]
        angle=float(rng.uniform(-0.6, 1.4)),
        torque_limit=float(np.exp(rng.uniform(*np.log((3.0, 60.0))))),
        track=arms,
    )
    return dataclasses.replace(model, flippers=flippers)


def armed(rng: Generator, **fields: Any) -> c2d.Robot:
    """Wheels, gears, belts or, now and then, a chain, with arms."""
    arms = arm_track(rng)
    kind = rng.integers(6)
    if kind < 2:
        track: Any = line(rng, wheel(rng)) if kind else slotted(rng, wheel(rng))
    elif kind == 2:
        track = c2d.BeltTrack()
    elif kind == 3:
        track = grouser_belt(rng)
    elif kind == 4:
        track = c2d.CircumferentialWheels(int(rng.integers(14, 31)), wheel=wheel(rng))
    else:
        track = chain(rng, str(rng.choice(["guide", "sprocket"])))
    return with_arms(rng, robot(rng, track, **fields), arms)


# Grounds


BLADES = (knife, posts, barrier, ridge, step)
WALLS = (step, barrier, stairs, profile)


def lanes(rng: Generator) -> Any:
    """Different under both tracks, as drawn or as a field."""
    kind = rng.integers(4)
    friction = float(rng.uniform(0.2, 1.4))
    if kind == 0:
        yaw = float(rng.uniform(-1.0, 1.0))
        height, thickness = float(rng.uniform(0.03, 0.16)), float(rng.uniform(0.01, 0.3))
        return c2d.terrains.diagonal_barrier(
            yaw, height=height, thickness=thickness, friction=friction
        )
    if kind == 1:
        return c2d.terrains.random_stepfield(
            int(rng.integers(1000)),
            rise=float(rng.uniform(0.02, 0.06)),
            post=float(rng.uniform(0.06, 0.2)),
            friction=friction,
        )
    left, right = (ground(rng) for _ in range(2))
    return c2d.terrains.lanes(left, right)


# Strata


def of_grouser_belts(rng: Generator) -> Scenario:
    model = robot(rng, grouser_belt(rng), clearance=(-0.01, 0.06), bellyless=0.5)
    return brief(rng, model, ground(rng))


def of_weak_grouser_belts(rng: Generator) -> Scenario:
    """Grousers that hook into edges and posts."""
    model = robot(rng, grouser_belt(rng), torque=(0.3, 5.0), bellyless=0.6)
    return brief(rng, model, ground(rng, (0.3, 1.5), BLADES))


def of_guides(rng: Generator) -> Scenario:
    return brief(rng, shod(rng, "guide"), ground(rng))


def of_weak_guides(rng: Generator) -> Scenario:
    """Shoes that close on edges, or that an edge gets through."""
    model = shod(rng, "guide", torque=(0.3, 5.0), bellyless=0.7)
    return brief(rng, model, ground(rng, (0.5, 1.5), BLADES))


def of_slippery_guides(rng: Generator) -> Scenario:
    model = shod(rng, "guide", torque=(6.0, 20.0), bellyless=0.7)
    return brief(rng, model, ground(rng, (0.1, 0.5)))


def of_sprockets(rng: Generator) -> Scenario:
    return brief(rng, shod(rng, "sprocket"), ground(rng))


def of_weak_sprockets(rng: Generator) -> Scenario:
    model = shod(rng, "sprocket", torque=(0.3, 5.0), bellyless=0.7)
    return brief(rng, model, ground(rng, (0.5, 1.5), BLADES))


def of_few_road_wheels(rng: Generator) -> Scenario:
    """Shoes that give way between wheels: pockets of a chain."""
    track = dataclasses.replace(chain(rng, "sprocket"), road_wheel_count=int(rng.integers(4)))
    model = robot(rng, track, torque=(2.0, 20.0), bellyless=0.7)
    return brief(rng, model, ground(rng, (0.2, 1.2), BLADES))


def of_arms_held(rng: Generator) -> Scenario:
    """Arms held at their initial angle."""
    model = armed(rng)
    assert model.flippers is not None
    drive = c2d.Drive(
        speed=float(rng.uniform(0.05, 0.4)), gait=c2d.Hold(angle=model.flippers.angle)
    )
    return brief(rng, model, ground(rng), drive=drive)


def of_arms_climbing(rng: Generator) -> Scenario:
    drive = c2d.Drive(speed=float(rng.uniform(0.1, 0.4)), gait=c2d.Climb())
    return brief(rng, armed(rng), ground(rng, kinds=WALLS), drive=drive)


def of_pockets_of_arms(rng: Generator) -> Scenario:
    """Arms with few wheels on the ground, so that edges get between them."""
    arms = c2d.LineOfWheels(
        int(rng.integers(2, 4)), wheel_radius=float(rng.uniform(0.02, 0.037)), wheel=wheel(rng)
    )
    track: Any = c2d.BeltTrack() if rng.random() < 0.4 else slotted(rng, c2d.RoundWheel())
    model = with_arms(rng, robot(rng, track, torque=(3.0, 20.0), bellyless=0.6), arms)
    assert model.flippers is not None
    angle = float(rng.uniform(-0.2, 0.4))
    flippers = dataclasses.replace(model.flippers, angle=angle)
    model = dataclasses.replace(model, flippers=flippers)
    drive = c2d.Drive(speed=float(rng.uniform(0.05, 0.3)), gait=c2d.Hold(angle=angle))
    return brief(rng, model, ground(rng, (0.2, 1.0), BLADES), drive=drive)


def of_lanes(rng: Generator) -> Scenario:
    """Wheels, belts and gears as in the other census."""
    track = any_track(rng)
    while track.kind == "force":  # it is not lateral
        track = any_track(rng)
    return brief(rng, robot(rng, track), lanes(rng))


def of_new_models_on_lanes(rng: Generator) -> Scenario:
    model = robot(rng, new_track(rng), torque=(0.5, 20.0), bellyless=0.5)
    return brief(rng, model, lanes(rng), duration=float(rng.uniform(5.0, 8.0)))


def of_arms_on_lanes(rng: Generator) -> Scenario:
    model = armed(rng)
    assert model.flippers is not None
    gait: Any = c2d.Climb() if rng.random() < 0.5 else c2d.Hold(angle=model.flippers.angle)
    drive = c2d.Drive(speed=float(rng.uniform(0.1, 0.4)), gait=gait)
    return brief(rng, model, lanes(rng), drive=drive, duration=float(rng.uniform(5.0, 8.0)))


def of_gear_arms(rng: Generator) -> Scenario:
    """Grousers of arms that hook into the ground."""
    arms = c2d.LineOfWheels(int(rng.integers(2, 5)), wheel=gear(rng))
    track = line(rng, gear(rng))
    model = with_arms(rng, robot(rng, track, torque=(0.5, 8.0), bellyless=0.6), arms)
    return brief(rng, model, ground(rng, (0.3, 1.4), BLADES))


def brief(rng: Generator, model: c2d.Robot, terrain: Any, **fields: Any) -> Scenario:
    """A scenario that lasts until a stop is certain."""
    drawn = scenario(rng, model, terrain, **fields)
    if "duration" in fields:
        return drawn
    # A slow robot needs more time.
    slow = min(0.3 / abs(drawn.drive.speed), 2.0)
    return dataclasses.replace(drawn, duration=math.ceil(4.0 + 3.0 * slow))


STRATA: Strata = {
    "grouser belts": of_grouser_belts,
    "weak grouser belts": of_weak_grouser_belts,
    "guides": of_guides,
    "weak guides": of_weak_guides,
    "slippery guides": of_slippery_guides,
    "sprockets": of_sprockets,
    "weak sprockets": of_weak_sprockets,
    "few road wheels": of_few_road_wheels,
    "arms held": of_arms_held,
    "arms climbing": of_arms_climbing,
    "pockets of arms": of_pockets_of_arms,
    "gear arms": of_gear_arms,
    "lanes": of_lanes,
    "new models on lanes": of_new_models_on_lanes,
    "arms on lanes": of_arms_on_lanes,
}
"""What is drawn from, by name; the order is part of the seeds."""
