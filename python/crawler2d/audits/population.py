"""What is not known of an audited robot and its floor, and what differs from run to run."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from crawler2d.parameters.robot import Robot
from crawler2d.parameters.settings import Drive
from crawler2d.presets.unknowns import of_ground, of_robot
from crawler2d.reading.reading import Reading
from crawler2d.variation.distributions import Distribution, Levels, scaled, shifted, uniform
from crawler2d.variation.ranges import Ranges
from crawler2d.variation.variability import of_contact, of_field, of_start

__all__ = ["FLOORS", "SPEEDS", "unknown_of", "vary_of"]

FLOORS = (0.5, 1.0)
"""[-] Coefficients of the floor's own surface between which a floor that nobody named may lie."""

_FRICTION = "terrain.friction"
_MOST_FROM_FLOORS = 0.05
"""[-] Floors that move the friction by less than that share do not decide it."""

_ROUNDED = 0.1
"""[-] By which share a friction or a torque that is written down may be off."""


SPEEDS = (0.1, 1.0 / 3.0, 1.0)
"""[-] Shares of the speed of an audit: what a fast robot jumps over, a slow one may not."""

_TIMES = tuple((1.0 / part + 2.0) / 3.0 for part in SPEEDS)
"""[-] Times the longest time: at the slowest speed enough to drive six lengths of the robot. It is
less than the speed asks for, because what rattles until the end costs most."""

_SIZE = 0.05
"""[-] By which share an obstacle may be larger or smaller than its measures say."""


def vary_of(drive: Drive | None = None) -> Ranges:
    """Return what differs from run to run by default.

    Start, contact and step field; the height, rise, radius or width of the obstacle; and the speed,
    a tenth, a third and all of it in turn, with the longer time the slower, unless a schedule says
    how fast to drive.
    """
    found = of_start() | of_contact() | of_field() | _of_size()
    return found if drive is not None and drive.schedule else found | _of_speed()


def _of_speed() -> Ranges:
    speeds = {
        "drive.speed": Levels(SPEEDS, spread=0.02),
        "duration": Levels(_TIMES, along="drive.speed"),
    }
    said = {
        "drive.speed": "a tenth, a third and all of it in turn, each within 2 %",
        "duration": "4, 5/3 and 1 times: the slowest has time for six of its lengths",
    }
    return Ranges(speeds, said, speeds)


def _of_size() -> Ranges:
    sizes = [f"terrain.{name}" for name in ("height", "rise", "radius", "width")]
    within = scaled(1.0 - _SIZE, 1.0 + _SIZE)
    source = "whether a robot gets over must not hang on a millimetre"
    return Ranges(dict.fromkeys(sizes, within), dict.fromkeys(sizes, source), sizes)


def unknown_of(robot: Robot, *, with_friction: bool) -> Ranges:
    """Return what is not known of a robot that was not read from a file.

    Parameters
    ----------
    robot : Robot
        A preset, whose ranges rest on its sources, or any other robot.
    with_friction : bool
        Whether the floor is not known either.
    """
    found = of_robot(robot)
    return found | of_ground() if with_friction else found


def unknown_of_file(reading: Reading, floors: Mapping[float, float] | None) -> Ranges:
    """Return what is not known of a robot that was read from a file.

    What the file states has a narrow range: a tenth of torque and friction, 2 % of the axle
    distance for the centre of mass, a twentieth of the radius for the belly. An estimate has a wide
    one, that of `unknowns.of_robot` for robots that are no presets. Of the floor a model of a robot
    says nothing: unless it is given, it has a coefficient of its own between 0.5 and 1, which the
    rule of the engine combines with that of the tracks.

    Parameters
    ----------
    reading : Reading
        What was read.
    floors : mapping of float to float, optional
        The friction with the floor of each of `FLOORS`; None: that of the floor is given.
    """
    ranges: dict[str, tuple[Distribution, str]] = {}
    at = reading.sources["robot.center_of_mass"]
    slack = "2 % of the axle distance for what is mounted or left off"
    for axis in (0, 1):
        place = shifted(-0.02, 0.02, of="robot.outline.axle_distance")
        ranges[f"robot.center_of_mass[{axis}]"] = place, f"{at}; {slack}"
    torque = reading.sources["robot.drivetrain.max_torque"]
    if torque.startswith("estimate"):
        ranges["robot.drivetrain.max_torque"] = scaled(0.5, 2.0), f"{torque}; half to twice"
    else:
        part = scaled(1.0 - _ROUNDED, 1.0 + _ROUNDED)
        ranges["robot.drivetrain.max_torque"] = part, f"{torque}; a tenth"
    if reading.robot.belly is not None:
        source = f"{reading.sources['robot.belly']}; a twentieth of the radius"
        height = shifted(-0.05, 0.05, of="robot.outline.front_radius")
        ranges["robot.belly[*][1]"] = height, source
    if floors is None or _spread(floors) <= _MOST_FROM_FLOORS * reading.friction:
        part = scaled(1.0 - _ROUNDED, 1.0 + _ROUNDED)
        ranges[_FRICTION] = part, f"{reading.sources['friction']}; a tenth"
    else:
        low, high = min(floors.values()), max(floors.values())
        source = (
            f"a floor of {FLOORS[0]:g} to {FLOORS[1]:g}, which no file of a robot states, combined"
            f" by the rule of {reading.engine} with {reading.sources['friction']}"
        )
        ranges[_FRICTION] = uniform(low, high), source
    return Ranges(
        {path: distribution for path, (distribution, _) in ranges.items()},
        {path: source for path, (_, source) in ranges.items()},
    )


def without_friction(ranges: Ranges) -> Ranges:
    """Leave the friction of the floor out: terrains of a user's own keep theirs."""
    kept: dict[str, Any] = {path: each for path, each in ranges.items() if path != _FRICTION}
    return Ranges(kept, {path: ranges.sources[path] for path in kept if path in ranges.sources})


def _spread(floors: Mapping[float, float]) -> float:
    return max(floors.values()) - min(floors.values())
