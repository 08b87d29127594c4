"""Jams of round wheels in another engine: at rest in the pose of the stop, with turning wheels."""

import math
from collections.abc import Callable
from typing import Any, cast

import numpy as np
import pytest

import crawler2d as c2d
from crawler2d.pictures.scenes import scene_of
from tests.shared import ROBOT
from tests.trials.robots import draw

pymunk = pytest.importorskip("pymunk")
# Drawn scenarios may be odd.
pytestmark = [
    pytest.mark.soak,
    pytest.mark.filterwarnings("ignore::crawler2d.ScenarioWarning"),
]

SEED, COUNT = 60, 60
STEP, ITERATIONS = 0.25e-3, 60  # [s]
FILTERS = [pymunk.ShapeFilter(categories=1, mask=2), pymunk.ShapeFilter(categories=2, mask=1)]


def jams() -> list[c2d.Run]:
    """Draw robots on lines of round wheels that are jammed while their wheels turn."""
    rng = np.random.default_rng(SEED)
    found: list[c2d.Run] = []
    while len(found) < COUNT:
        drawn = [scenario for _, scenario in (draw(rng) for _ in range(400))]
        fitting = [
            scenario
            for scenario in drawn
            if isinstance(scenario.robot.track, c2d.LineOfWheels)
            and scenario.robot.track.wheel == c2d.RoundWheel()
            and scenario.robot.track.as_track
            and scenario.robot.flippers is None
            and scenario.terrain.kind not in ("lanes", "random_stepfield")
        ]
        for run in c2d.simulate_many(fitting, on_error="record"):
            why = run.diagnosis
            if why is not None and why.jammed and why.stalled_share == 0.0 and not why.transient:
                found.append(run)
    return found[:COUNT]


def set_at_rest(run: c2d.Run) -> tuple[Any, Any]:
    """Build the robot in its last pose, with its wheels driven as commanded."""
    robot, terrain = run.scenario.robot, cast("Any", run.scenario.terrain)
    friction = float(terrain.friction)
    space = pymunk.Space()
    space.gravity, space.iterations = (0.0, -run.scenario.gravity), ITERATIONS
    space.collision_slop, space.collision_bias = 1e-5, math.exp(-60.0)
    profile = scene_of(run).lanes[0][1]
    for one, other in zip(profile[:-1].tolist(), profile[1:].tolist(), strict=True):
        finish(pymunk.Segment(space.static_body, one, other, 0.0), 0, friction, space)
    x, y = run.position[-1].tolist()
    angle = float(run.chassis_angle[-1])
    wheels = robot.wheels()
    own = wheels["carrier"] == "chassis"
    places = np.unique(np.column_stack([wheels[n] for n in ("x", "y", "radius")])[own], axis=0)
    masses = [float(wheels["mass"][own & (wheels["x"] == place[0])].sum()) for place in places]
    left = robot.mass - sum(masses)
    center = np.array(robot.center_of_mass) * robot.mass
    center = (center - np.array(masses) @ places[:, :2]) / left
    away = [
        m * ((p[:2] - robot.center_of_mass) ** 2).sum() for m, p in zip(masses, places, strict=True)
    ]
    inertia = robot.moment_of_inertia - sum(away)
    inertia -= sum(m * p[2] ** 2 for m, p in zip(masses, places, strict=True))
    inertia -= left * float(((center - robot.center_of_mass) ** 2).sum())
    chassis = pymunk.Body(left, max(inertia, 0.2 * robot.moment_of_inertia))
    chassis.center_of_gravity = tuple(center)
    chassis.position, chassis.angle = (x, y), angle
    space.add(chassis)
    if robot.belly is not None:
        finish(pymunk.Poly(chassis, [tuple(corner) for corner in robot.belly]), 1, 1.0, space)
    turn = np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])
    speed = float(run.track_speed[-1])
    for (px, py, radius), mass in zip(places.tolist(), masses, strict=True):
        wheel = pymunk.Body(mass, mass * radius**2)
        wheel.position = tuple(turn @ (px, py) + (x, y))
        space.add(wheel)
        finish(pymunk.Circle(wheel, radius), 1, 1.0, space)
        pin = pymunk.PivotJoint(chassis, wheel, (px, py), (0.0, 0.0))
        pin.error_bias, pin.collide_bodies = math.exp(-60.0), False
        # With one motor per track, every wheel keeps its speed.
        space.add(pin, pymunk.SimpleMotor(chassis, wheel, speed / radius))
    return space, chassis


def finish(shape: Any, kind: int, friction: float, space: Any) -> None:
    """Set the friction of a shape; the engine multiplies two coefficients, so the robot's is 1."""
    shape.friction, shape.filter = friction, FILTERS[kind]
    space.add(shape)


def test_a_robot_that_nothing_holds_drives_on_in_the_other_engine() -> None:
    track = c2d.LineOfWheels(3)
    run = c2d.simulate(ROBOT.with_track(track), c2d.terrains.step(0.05), duration=0.3)
    space, chassis = set_at_rest(run)
    begin = chassis.position.x
    for _ in range(round(0.5 / STEP)):
        space.step(STEP)
    assert chassis.position.x - begin == pytest.approx(0.5 * run.track_speed[-1], rel=0.1)


def test_a_robot_jammed_here_is_jammed_in_another_engine(say: Callable[[str], None]) -> None:
    stays, apart = 0, []
    for run in jams():
        criteria, speed = run.scenario.criteria, abs(run.scenario.drive.speed)
        direction = math.copysign(1.0, run.scenario.drive.speed)
        space, chassis = set_at_rest(run)
        begin, far = chassis.position.x, 0.0
        for _ in range(int((criteria.escape_time + criteria.escape_distance / speed) / STEP)):
            space.step(STEP)
            far = max(far, direction * (chassis.position.x - begin))
        if far <= criteria.escape_distance:
            stays += 1
        else:
            apart.append(
                f"{run.outcome}, {run.scenario.robot.name}, {run.scenario.terrain}: {run.diagnosis}"
            )
    say("\n  ".join([f"of {COUNT} jams {stays} stay in pymunk {pymunk.version}", *apart]))
    assert stays >= 0.9 * COUNT
