"""The subject of an audit: a robot or model file, its unknowns, and standard obstacles."""

from __future__ import annotations

import math
import os
from collections.abc import Collection, Mapping
from dataclasses import replace
from typing import Literal, NamedTuple, TypedDict

from crawler2d.audits.lint import lint
from crawler2d.audits.repairs import LEVEL
from crawler2d.common.bodies import BELLY_HEIGHTS
from crawler2d.errors import ScenarioError, ignore_warnings
from crawler2d.parameters.outline import TrackOutline
from crawler2d.parameters.robot import Robot
from crawler2d.parameters.settings import Drive
from crawler2d.parameters.terrain import (
    Barrier,
    DiagonalBarrier,
    Gap,
    Lane,
    RandomStepfield,
    Ridge,
    Stairs,
    Step,
    Terrain,
)
from crawler2d.presets.unknowns import of_ground, of_robot
from crawler2d.reading.engines import Engine
from crawler2d.reading.log import span
from crawler2d.reading.meshes import MeshRule
from crawler2d.reading.reading import Reading, read_robot
from crawler2d.variation.distributions import Distribution, Levels, Ranges, scaled, shifted, uniform
from crawler2d.variation.variability import of_contact, of_field, of_start

__all__ = [
    "ReadKeywords",
    "check_size",
    "read_obstacles",
    "standard_obstacles",
    "subject_of",
    "unknown_of",
    "unknown_of_file",
    "vary_of",
]

FLOORS = (0.5, 1.0)
"""[-] Range of the floor's own coefficient, if no floor is given."""

_MOST_FROM_FLOORS = 0.05
"""[-] Smallest relative effect of the floor on the friction that counts."""

_ROUNDED = 0.1
"""[-] Relative error of a friction or torque stated by a file."""

SPEEDS = (0.1, 1.0 / 3.0, 1.0)
"""[-] Fractions of the speed of an audit: a slow robot may stop where a fast one jumps."""

_TIMES = tuple((1.0 / part + 2.0) / 3.0 for part in SPEEDS)
"""[-] Factors of the duration: at the slowest speed enough for six lengths of the robot. They grow
less than the speed falls, as runs that rattle until the end cost most."""

_SIZE = 0.05
"""[-] Relative error of the size of an obstacle."""

_STEPS = (0.5, 0.8, 1.1)  # radii
_HIGH = 1.5  # radii: too high for a belt without flippers, unless its centre of mass is low
_KNIVES = (0.4, 0.8)


class ReadKeywords(TypedDict, total=False):
    """Keywords of `read_robot`, for the audit of a file."""

    engine: Engine | None
    forward: Literal["+x", "-x", "+y", "-y"] | None
    model: str | None
    mesh: MeshRule
    missing: Literal["leave_out", "refuse"]
    tracks: Collection[str]
    ground_friction: float | None
    tolerance: float
    scale: float | None
    trusted: bool
    packages: Mapping[str, str | os.PathLike[str]] | None
    arguments: Mapping[str, str] | None


class Subject(NamedTuple):
    """The subject of an audit.

    Parameters
    ----------
    robot : Robot
        The robot.
    reading : Reading, optional
        The reading, if it comes from a file.
    floors : mapping of float to float, optional
        [-] Friction on each of `FLOORS`; None if the floor is given.
    """

    robot: Robot
    reading: Reading | None = None
    floors: Mapping[float, float] | None = None


def standard_obstacles(robot: Robot, friction: float) -> dict[str, Terrain]:
    """Return the standard obstacles of a robot, by description.

    Every length is a multiple of R, the height of the front axle above the lowest point of the
    outline, which is the radius of equal ends, or of L, the axle distance:

    - steps of 0.5, 0.8 and 1.1 R, with flippers also of 1.5 R;
    - a kerb, 0.8 R high, whose edge is rounded by 0.3 R;
    - a barrier, 0.8 R high and R thick, and the same at a yaw of 30 degrees;
    - knife edges of 0.4 and 0.8 R, 0.1 R thick, which fit between wheels;
    - ridges, 0.8 R high with an edge of 60 degrees and 0.5 R with one of 120;
    - three stairs of 0.8 R on 2 R, a slope of 22 degrees, which a friction of 0.5 still holds;
    - a gap of 0.3 L, which a belt bridges with its centre of mass anywhere in the middle third;
    - a random step field, eight posts of 1.5 R long with four levels of 0.25 R, different in every
      run.

    The highest are near the limit of a closed track of these proportions (a rigid belt with its
    centre of mass in the middle, at axle height, climbs 1.3 to 1.7 R), so that a belt has a chance
    where wheels stop. None depends on the ground clearance: the lower run of a belt covers the
    belly, and carries the robot over a thin obstacle.

    Parameters
    ----------
    robot : Robot
        The robot.
    friction : float
        [-] Friction of all obstacles.

    Returns
    -------
    dict of str to terrain
        Terrains by kind and size in mm.

    Examples
    --------
    >>> import crawler2d as c2d
    >>> found = standard_obstacles(c2d.robots.engineer(flippers=None), friction=0.8)
    >>> len(found), list(found)[:3], found["knife edge 51 mm"].thickness
    (13, ['step 32 mm', 'step 51 mm', 'step 70 mm'], 0.0064)
    """
    radius, axles = _front_axle_height(robot.outline), robot.outline.axle_distance
    heights = _STEPS if robot.flippers is None else (*_STEPS, _HIGH)
    high = 0.8 * radius
    found: dict[str, Lane | DiagonalBarrier | RandomStepfield] = {
        f"step {_mm(part * radius)}": Step(part * radius) for part in heights
    }
    found[f"rounded kerb {_mm(high)}"] = Step(high, edge_radius=0.3 * radius)
    found[f"barrier {_mm(high)}"] = Barrier(high, radius)
    found[f"diagonal barrier {_mm(high)}"] = DiagonalBarrier(
        math.radians(30.0), height=high, thickness=radius
    )
    for part in _KNIVES:
        found[f"knife edge {_mm(part * radius)}"] = Barrier(part * radius, 0.1 * radius)
    found[f"sharp ridge {_mm(high)}"] = Ridge(high, math.radians(60.0))
    found[f"blunt ridge {_mm(0.5 * radius)}"] = Ridge(0.5 * radius, math.radians(120.0))
    found[f"stairs of {_mm(high)}"] = Stairs(count=3, rise=high, run=2.0 * radius)
    found[f"gap {_mm(0.3 * axles)}"] = Gap(0.3 * axles, depth=2.0 * radius)
    found["step field"] = RandomStepfield(posts=8, post=1.5 * radius, rise=0.25 * radius)
    return {name: replace(ground, friction=friction) for name, ground in found.items()}


def read_obstacles(obstacles: object) -> dict[str, Terrain]:
    """Read the argument `obstacles`: a mapping from labels to terrains.

    Raises
    ------
    ScenarioError
        If it is not a mapping or is empty, or a label is not a string or is reserved.
    """
    if not isinstance(obstacles, Mapping) or not obstacles:
        raise ScenarioError("obstacles", obstacles, "must be a mapping from labels to terrains")
    for label, ground in obstacles.items():
        if not isinstance(label, str):
            raise ScenarioError("obstacles", label, "must have strings as labels")
        if label == LEVEL:
            rule = "must not be the label of the ground on which repairs are timed"
            raise ScenarioError("obstacles", label, rule)
        if not isinstance(ground, Terrain):
            raise ScenarioError(f"obstacles[{label!r}]", ground, "must be a terrain")
    return dict(obstacles)


def _front_axle_height(outline: TrackOutline) -> float:
    """[m] Return the height of an edge level with the front axle, about what belts climb.

    The radius of the front end is less useful: a raised idler is small.
    """
    _, (_, y, _) = outline.ends
    return y - min(y - radius for _, y, radius in outline.discs)


def _mm(length: float) -> str:
    return f"{1e3 * length:.0f} mm"


def vary_of(drive: Drive | None = None) -> Ranges:
    """Return the default variation from run to run.

    Start, contact and step field; height, rise, radius or width of the obstacle; and a tenth, a
    third and all of the speed in turn, with longer durations at lower speeds, unless a schedule
    sets the speed.
    """
    sizes = [f"terrain.{name}" for name in ("height", "rise", "radius", "width")]
    source = "whether a robot gets over must not depend on a millimetre"
    within = scaled(1.0 - _SIZE, 1.0 + _SIZE)
    found = of_start() | of_contact() | of_field()
    found |= Ranges(dict.fromkeys(sizes, within), dict.fromkeys(sizes, source), sizes)
    if drive is not None and drive.schedule:
        return found
    speeds = {
        "drive.speed": Levels(SPEEDS, spread=0.02),
        "duration": Levels(_TIMES, along="drive.speed"),
    }
    sources = {
        "drive.speed": "a tenth, a third and all of it in turn, each within 2 %",
        "duration": "4, 5/3 and 1 times: the slowest has time for six of its lengths",
    }
    return found | Ranges(speeds, sources, speeds)


def unknown_of(subject: Subject, *, with_friction: bool) -> Ranges:
    """Return the unknowns of a subject.

    Parameters
    ----------
    subject : Subject
        A preset, with ranges from its sources; any other robot; or the reading of a file.
    with_friction : bool
        Whether the floor is also unknown; terrains of the user keep their own friction.
    """
    if subject.reading is not None:
        return unknown_of_file(subject.reading, subject.floors, with_friction=with_friction)
    found = of_robot(subject.robot)
    return found | of_ground() if with_friction else found


def unknown_of_file(
    reading: Reading, floors: Mapping[float, float] | None, *, with_friction: bool = True
) -> Ranges:
    """Return the unknowns of a robot from a file.

    Figures stated by the file have a narrow range: a tenth of torque and friction, 2 % of the axle
    distance for the centre of mass, a twentieth of the radius for the belly. Estimates have a wide
    one, that of `unknowns.of_robot` for robots that are not presets. A robot drives on many floors,
    whatever that of its file is: unless given, their coefficient is between 0.5 and 1, and the rule
    of the engine combines it with that of the tracks.

    Parameters
    ----------
    reading : Reading
        What was read.
    floors : mapping of float to float, optional
        Friction on each of `FLOORS`; None if the floor is given.
    with_friction : bool
        See `unknown_of`.
    """
    ranges: dict[str, tuple[Distribution, str]] = {}
    stated, about = reading.sources, scaled(1.0 - _ROUNDED, 1.0 + _ROUNDED)
    slack = "2 % of the axle distance, for parts added or removed"
    for axis in (0, 1):
        place = shifted(-0.02, 0.02, unit="robot.outline.axle_distance")
        source = f"{stated['robot.center_of_mass']}; {slack}"
        ranges[f"robot.center_of_mass[{axis}]"] = place, source
    torque = stated["robot.drivetrain.max_torque"]
    if torque.startswith("estimate"):
        ranges["robot.drivetrain.max_torque"] = scaled(0.5, 2.0), f"{torque}; half to twice"
    else:
        ranges["robot.drivetrain.max_torque"] = about, f"{torque}; a tenth"
    if reading.robot.belly is not None:
        height = shifted(-0.05, 0.05, unit="robot.outline.front_radius")
        source = f"{stated['robot.belly']}; a twentieth of the radius"
        ranges[BELLY_HEIGHTS] = height, source
    if with_friction:
        low, high = (0.0, 0.0) if floors is None else (min(floors.values()), max(floors.values()))
        if high - low <= _MOST_FROM_FLOORS * reading.friction:
            ranges["terrain.friction"] = about, f"{stated['friction']}; a tenth"
        else:
            own = [friction for friction, _ in reading.tree.floors]
            file = f"{span(own)} in the file" if own else "which the file does not state"
            source = (
                f"that of the floor, {file}, is taken as {FLOORS[0]:g} to {FLOORS[1]:g};"
                f" {reading.engine} combines it with {stated['friction']}"
            )
            ranges["terrain.friction"] = uniform(low, high), source
    return Ranges.with_sources(ranges)


def subject_of(robot: object, how: ReadKeywords) -> Subject:
    """Take a robot or a reading, or read a file; lint reports warnings of the reader.

    Raises
    ------
    ScenarioError
        If it is none of these, a keyword is given without a file, or the file cannot be read.
    """
    if isinstance(robot, (Robot, Reading)):
        for name, value in how.items():
            raise ScenarioError(name, value, "must not be given without a file")
    if isinstance(robot, Robot):
        return Subject(robot)
    read = robot if isinstance(robot, Reading) else _read(robot, how)
    if read.how.ground_friction is not None:
        return Subject(read.robot, read)
    return Subject(read.robot, read, {floor: read.friction_on(floor) for floor in FLOORS})


def _read(path: object, how: ReadKeywords) -> Reading:
    if not isinstance(path, (str, os.PathLike)):
        rule = "must be a Robot, a Reading, or the name of a file"
        raise ScenarioError("robot", path, rule)
    with ignore_warnings():
        return read_robot(path, **how)


def check_size(read: Reading) -> None:
    """Refuse a file that is probably not in metres.

    Raises
    ------
    ScenarioError
        If the robot has a size that no tracked robot has, and no `scale` was given.
    """
    found = next((each for each in lint(read.robot) if each.rule == "size"), None)
    if found is None or "scale" in read.how.given:
        return
    where = read.sources["robot.outline.axle_distance"]
    size = f"{read.tree.file} is {found.message} [{where}]"
    rule = f"must be given: {size}, and scale=1 leaves it as it is"
    raise ScenarioError("scale", None, rule)
