"""The robots of the comparison: which, on what wheels, with which motors."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Literal

from crawler2d.parameters.robot import Robot
from crawler2d.parameters.track import (
    CircumferentialWheels,
    GearWheel,
    HybridWheels,
    LineOfWheels,
    Track,
)
from crawler2d.presets.robots.engineer import engineer
from crawler2d.presets.robots.subt import absolem, marv

__all__ = ["DRIVES", "MODELS", "ROBOTS", "motorized", "robot_of"]

_AHEAD = (0.026, 0.02)  # [m] 26 mm ahead of the preset's

ROBOTS: dict[str, Callable[[Track], Robot]] = {
    "engineer": lambda track: engineer(flippers=None, track=track),
    "engineer, ahead": lambda track: engineer(flippers=None, center_of_mass=_AHEAD, track=track),
    "absolem": lambda track: absolem(flippers=None, track=track),
    "marv": lambda track: marv(flippers=None, track=track),
}
"""Robots without flippers; "ahead" has its centre of mass 26 mm farther ahead."""

_THREE = tuple((x, 0.0, 0.08) for x in (-0.186, 0.0, 0.186))

MODELS: dict[str, Track] = {
    "line of 3": LineOfWheels(3),
    "line of 5": LineOfWheels(5),
    "line of 9": LineOfWheels(9),
    "3 gears": LineOfWheels(3, wheel=GearWheel()),
    "5 gears": LineOfWheels(5, wheel=GearWheel()),
    "24 all round": CircumferentialWheels(24),
    "24 gears": CircumferentialWheels(24, wheel=GearWheel()),
    "public 3": HybridWheels(_THREE),
}
"""Wheels in a track's place; "public 3" are those of the Engineer's public model."""

DRIVES: dict[str, tuple[float, Literal["track", "wheel"]]] = {
    "6 N m, track": (6.0, "track"),
    "6 N m, servos": (6.0, "wheel"),
    "60 N m, track": (60.0, "track"),
    "60 N m, servos": (60.0, "wheel"),
    "100 N m a wheel": (100.0, "wheel"),
}
"""Torque and its sharing: [N m] of a sprocket, in the last one of every wheel."""

_ACCELERATION = 1.0  # [m/s^2] The same for all, so that the approach does not set the speed.


def robot_of(robot: str, model: str, drive: str) -> Robot:
    """Return a robot by its names.

    Parameters
    ----------
    robot, model, drive : str
        In `ROBOTS`, `MODELS` and `DRIVES`.

    Examples
    --------
    >>> robot_of("marv", "line of 5", "6 N m, servos").drivetrain.torque_sharing
    'wheel'
    """
    return motorized(ROBOTS[robot](MODELS[model]), drive)


def motorized(made: Robot, drive: str) -> Robot:
    """Return a robot with motors by their name in `DRIVES`, without rotors: rapier holds none."""
    torque, sharing = DRIVES[drive]
    if drive == "100 N m a wheel":
        # The sprocket's torque acts at the belt, each wheel's at its own radius.
        wheels = made.wheels()
        belt = made.outline.rear_radius - made.outline.grouser_height
        torque *= 0.5 * len(wheels) * belt / float(wheels["radius"].max())
    return replace(
        made,
        drivetrain=replace(
            made.drivetrain,
            max_torque=torque,
            torque_sharing=sharing,
            max_acceleration=_ACCELERATION,
        ),
    ).without_rotors()
