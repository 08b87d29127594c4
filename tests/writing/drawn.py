"""Random robots that model files can represent: round wheels and smooth belts of all kinds."""

import dataclasses
import math
from typing import Any

import numpy as np

import crawler2d as c2d
from crawler2d.parameters.track import Track

Generator = np.random.Generator


def drawn(number: int, *, wheels_only: bool = False) -> c2d.Robot:
    """Make a random robot: the same number makes the same one."""
    rng = np.random.default_rng([23, number])
    length = float(rng.uniform(0.25, 1.2))
    rear = float(rng.uniform(0.12, 0.3)) * length
    front = rear if rng.random() < 0.6 else rear * float(rng.uniform(0.7, 1.4))
    robot = c2d.Robot.simple(
        float(rng.uniform(4.0, 120.0)),
        axle_distance=length,
        radius=rear,
        name=f"drawn {number}",
        max_speed=float(rng.uniform(0.2, 3.0)),
    )
    robot = dataclasses.replace(
        robot,
        outline=dataclasses.replace(robot.outline, front_radius=front),
        center_of_mass=(length * float(rng.uniform(-0.1, 0.1)), rear * float(rng.uniform(-0.3, 1))),
        moment_of_inertia=robot.moment_of_inertia * float(rng.uniform(0.9, 1.6)),
        track_mass=robot.mass * float(rng.uniform(0.02, 0.25)),
        belly=_belly(rng, length, min(front, rear)),
        gauge=length * float(rng.uniform(0.3, 1.0)),
    )
    torque = robot.drivetrain.max_torque * float(rng.uniform(0.3, 3.0))
    motors = dataclasses.replace(robot.drivetrain, max_torque=torque)
    track = _track(rng, length, rear, front, wheels_only=wheels_only)
    robot = dataclasses.replace(robot, drivetrain=motors, track=track)
    # Small wheels end beside the end axles, on which flippers pivot.
    if rng.random() < 0.5 and not isinstance(track, c2d.CircumferentialWheels):
        robot = _with_flippers(rng, robot, wheels_only=wheels_only)
    return robot


def drawn_on_discs(number: int) -> c2d.Robot:
    """Make a random robot on a belt round three to five discs: ends, idlers above, wheels below."""
    rng = np.random.default_rng([24, number])
    robot = drawn(number).without_flippers()
    track = c2d.ClosedTrack(c2d.BeltTrack()) if number % 2 else c2d.BeltTrack()
    robot = robot.with_track(track)
    robot = dataclasses.replace(robot, outline=_outline(rng, robot))
    return _with_flippers(rng, robot, wheels_only=False) if rng.random() < 0.5 else robot


def drawn_on_gears(number: int, *, is_tapered: bool) -> c2d.Robot:
    """Make a random robot on gear wheels, also on flippers; grousers may taper."""
    rng = np.random.default_rng([25, number])
    robot = drawn(number, wheels_only=True)
    robot = robot.with_track(_on_gears(rng, robot.track, robot.wheels()["radius"], is_tapered))
    arms = robot.flippers
    if arms is None:
        return robot
    radii = np.linspace(arms.tip_radius, arms.root_radius, 2)
    assert arms.track is not None
    return dataclasses.replace(
        robot,
        flippers=dataclasses.replace(arms, track=_on_gears(rng, arms.track, radii, is_tapered)),
    )


def _on_gears(rng: Generator, track: Any, radii: Any, is_tapered: bool) -> Any:
    """Wheels with grousers that suit the smallest of them."""
    smallest, count = float(radii.min()), int(rng.integers(3, 13))
    height = smallest * float(rng.uniform(0.05, 0.4))
    tip = smallest * float(rng.uniform(0.02, 0.9)) / count
    wheel = c2d.GearWheel(
        grouser_count=count,
        grouser_height=height,
        tip_thickness=tip,
        base_thickness=tip * float(rng.uniform(1.05, 1.6)) if is_tapered else None,
        phase_fraction=float(rng.choice([0.0, 1.0 / 3.0, 0.5, rng.random()])),
    )
    return dataclasses.replace(track, wheel=wheel)


def _outline(rng: Generator, robot: c2d.Robot) -> c2d.TrackOutline:
    """Discs that all bend the belt, in any order; ends may be raised."""
    length, radius = robot.outline.axle_distance, robot.outline.rear_radius
    while True:
        count = int(rng.integers(3, 6))
        x = length * np.array([-0.5, 0.5, *rng.uniform(-0.45, 0.45, count - 2)])
        y = radius * np.array([*rng.uniform(-0.2, 1.0, 2), *rng.uniform(-2.0, 2.0, count - 2)])
        discs = np.column_stack([x, y, radius * rng.uniform(0.4, 1.0, count)])
        outline = c2d.TrackOutline(
            discs=rng.permutation(discs),
            grouser_height=0.0,
            grouser_pitch=0.2 * radius,
            grouser_thickness=0.0,
        )
        try:
            dataclasses.replace(robot, outline=outline).wheels()
        except c2d.ScenarioError as error:
            if "discs" not in error.path:  # one that bends nothing is drawn again
                raise
        else:
            return outline


def _belly(rng: Generator, length: float, radius: float) -> Any:
    """A rectangle, a trapezoid, a polygon with any corners, or none."""
    kind = rng.integers(4)
    low, high = -0.6 * radius, radius * float(rng.uniform(0.2, 2.0))
    half, top = 0.5 * length, 0.5 * length * float(rng.uniform(0.4, 1.3))
    if kind == 0:
        return None
    if kind == 1:
        return ((-half, low), (half, low), (half, high), (-half, high))
    if kind == 2:
        return ((-half, low), (half, low), (top, high), (-top, high))
    angles = np.sort(rng.uniform(0.0, 0.9, 6)) + np.arange(6)
    turns = 2.0 * math.pi * angles / 6.0
    return np.column_stack([half * np.cos(turns), 0.9 * radius * np.sin(turns)])


def _track(rng: Generator, length: float, rear: float, front: float, *, wheels_only: bool) -> Track:
    line = c2d.LineOfWheels(
        int(rng.integers(2, 8)),
        wheel_radius=None if rng.random() < 0.5 else rear * float(rng.uniform(0.5, 1.1)),
        as_track=bool(rng.random() < 0.8),
    )
    inner = [
        (x * length, y * rear, share * rear)
        for x, y, share in zip(
            np.sort(rng.uniform(-0.45, 0.45, 3)).tolist(),
            rng.uniform(-0.5, 0.5, 3).tolist(),
            rng.uniform(0.3, 0.6, 3).tolist(),
            strict=True,
        )
    ]
    ends = [(-0.5 * length, 0.0, rear)], [(0.5 * length, 0.0, front)]
    small = 0.4 * min(front, rear)
    around = 2.0 * length + math.pi * (front + rear)
    models: list[Track] = [
        line,
        c2d.HybridWheels((*ends[0], *inner, *ends[1])),
        c2d.CircumferentialWheels(int(around / small / 2.2), wheel_radius=small),
    ]
    if not wheels_only:
        models += [c2d.BeltTrack(), c2d.ClosedTrack(c2d.LineOfWheels(4))]
    return models[rng.integers(len(models))]


def _with_flippers(rng: Generator, robot: c2d.Robot, *, wheels_only: bool) -> c2d.Robot:
    radius = min(robot.outline.front_radius, robot.outline.rear_radius)
    tracks: list[Track] = [c2d.LineOfWheels(int(rng.integers(2, 6)))]
    if not wheels_only:
        tracks.append(c2d.BeltTrack())
    return robot.with_flippers(
        c2d.Flippers(
            length=radius * float(rng.uniform(2.0, 4.0)),
            root_radius=radius,
            tip_radius=radius * float(rng.uniform(0.4, 1.0)),
            mass=robot.mass * float(rng.uniform(0.01, 0.05)),
            ends=str(rng.choice(["front", "rear", "both"])),  # type: ignore[arg-type]
            angle=float(rng.uniform(-1.5, 2.5)),
            rate_limit=float(rng.uniform(0.2, 3.0)),
            torque_limit=float(rng.uniform(5.0, 200.0)),
            track=tracks[rng.integers(len(tracks))],
        )
    )
