"""Wheels and belts of chassis and flippers, their masses and widths, and what formats support."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any, NoReturn

import numpy as np

from crawler2d import _core
from crawler2d.common.arrays import real_number
from crawler2d.common.bodies import BodyKind
from crawler2d.drawings.scene import Scene, place
from crawler2d.errors import ScenarioError
from crawler2d.model_tree import Array

__all__ = [
    "Across",
    "Carrier",
    "Format",
    "Part",
    "Wheel",
    "across_of",
    "carriers_of",
    "refuse_tapering",
    "refuse_unsupported",
    "remainder",
    "tensor",
]

# Default widths: of a track relative to the gauge, of a flipper relative to the track. The tracks
# of Absolem's public model are 97 mm wide at a gauge of 397 mm; those of its flippers are half as
# wide, against the outside of the tracks.
_TRACK = 0.25

_FLIPPER = 0.5

# A body with less than this fraction of the mass or moment of inertia would make the simulation
# stiff, or be physically impossible.
_LEAST = 0.01

_REASONS = {
    "belt": "{} has no surface that moves",
    "grouser_belt": "{} has no grousers that travel along a belt",
    "segmental": "a chain is a closed loop of links, and {} has only trees",
    "force": "{} has no motor that pushes the chassis",
}


@dataclass(frozen=True, slots=True, kw_only=True)
class Across:
    """Widths and lateral positions.

    Parameters
    ----------
    gauge : float
        [m] Lateral distance between the centres of the tracks.
    track_width, chassis_width, flipper_width : float
        [m] Their widths.
    """

    gauge: float
    track_width: float
    chassis_width: float
    flipper_width: float

    @property
    def flippers(self) -> float:
        """[m] Lateral position of the left flippers, directly outside the track."""
        return 0.5 * (self.gauge + self.track_width + self.flipper_width)


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Part:
    """A body in the chassis frame of the side view.

    Parameters
    ----------
    mass : float
        [kg] Its mass.
    center : ndarray, shape (2,)
        [m] Its centre of mass.
    inertia : float
        [kg m^2] Moment of inertia about the centre of mass.
    """

    mass: float
    center: Array
    inertia: float


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Wheel:
    """A wheel of one side.

    Parameters
    ----------
    body : int
        Its number in runs and diagnoses.
    center : ndarray, shape (2,)
        [m] Its axle in the chassis frame.
    radius : float
        [m] Radius of its circumscribed circle.
    mass : float
        [kg] Mass of a uniform wheel with its outline and moment of inertia.
    inertia : float
        [kg m^2] Moment of inertia about its axle.
    outline : ndarray, shape (n, 2), optional
        [m] Outline of a gear wheel about its axle, at its initial angle; None if round.
    """

    body: int
    center: Array
    radius: float
    mass: float
    inertia: float
    outline: Array | None

    def part(self, *, is_hoop: bool) -> Part:
        """Return its mass: uniform, or the smallest with its moment of inertia."""
        mass = self.inertia / self.radius**2 if is_hoop else self.mass
        return Part(mass=mass, center=self.center, inertia=self.inertia)


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Carrier:
    """The chassis, or the flippers at one end, of one side.

    Parameters
    ----------
    end : {"", "front", "rear"}
        End of the robot; empty for the chassis.
    surface : {"wheels", "belt", "grouser_belt", "segmental", "force"}
        The contact with the ground; skids and free wheels are "force".
    middle : ndarray, shape (2,)
        [m] Origin of its frame in the chassis frame, with flippers at their angle.
    direction : ndarray, shape (2,)
        Direction of the x axis of that frame.
    wheels : tuple of Wheel
        Its wheels; empty if it carries a belt.
    discs : ndarray, shape (n, 3)
        [m] Centres in the chassis frame and radii of the discs of a belt; none if it has wheels.
    loop : Part or None
        The belt as a closed line with a mass of 1 kg; None if it has wheels.
    """

    end: str
    surface: str
    middle: Array
    direction: Array
    wheels: tuple[Wheel, ...]
    discs: Array
    loop: Part | None


@dataclass(frozen=True, slots=True, kw_only=True)
class Format:
    """What a format can represent.

    Parameters
    ----------
    name : str
        Its name.
    moves_surfaces : bool
        Whether it can move the surface of a shape, as a belt needs.
    has_hulls : bool
        Whether it can contain the corners of a convex hull.
    has_rotors : bool
        Whether it can represent the rotor inertia of a motor at its joint, and the gain of a servo.
    reserved : str
        Regular expression of names that it reserves.
    """

    name: str
    moves_surfaces: bool
    has_hulls: bool
    has_rotors: bool
    reserved: str = ""


def across_of(gauge: float, track_width: float | None, chassis_width: float | None) -> Across:
    """Return the given widths, with estimates for missing ones.

    Raises
    ------
    ScenarioError
        If a width is not a number above 0, or the tracks would meet in the middle.
    """
    track = _TRACK * gauge if track_width is None else real_number(track_width, "track_width")
    if not 0.0 < track < gauge:
        rule = f"must be above 0 and less than robot.gauge = {gauge:g} m"
        raise ScenarioError("track_width", track, rule)
    chassis = gauge - track
    if chassis_width is not None:
        chassis = real_number(chassis_width, "chassis_width")
    if not 0.0 < chassis <= 100.0:
        raise ScenarioError("chassis_width", chassis, "must be above 0 and at most 100 m")
    return Across(
        gauge=gauge,
        track_width=track,
        chassis_width=chassis,
        flipper_width=_FLIPPER * track,
    )


def tensor(part: Part, *, length: float, height: float, width: float) -> Array:
    """[kg m^2] Extend a moment of inertia to three axes: x along the part, y lateral, z up.

    The moment about y is that of the part. The others are estimates: mean squares of x and z have
    the ratio of a uniform box of this length and height, and the mass is spread evenly over the
    width. A body with these three moments therefore exists for any size.
    """
    along = part.inertia * length**2 / (length**2 + height**2)
    across = part.mass * width**2 / 12.0
    moments: Array = np.diag([part.inertia - along + across, part.inertia, along + across])
    return moments


def carriers_of(robot: dict[str, Any], text: str) -> list[Carrier]:
    """List the carriers of wheels and belts, the chassis first.

    Parameters
    ----------
    robot : dict
        The robot, as in a scenario in JSON.
    text : str
        This scenario, with the robot on level ground.
    """
    scene = Scene.of_robot(text)
    columns = _core.wheels(text)
    rows = [
        {name: columns[name][row] for name in columns}
        for row, side in enumerate(columns["side"])
        if side == "left"
    ]
    found = []
    for each in scene.carriers:
        wheels = tuple(_wheel(scene, row) for row in rows if row["carrier"] == each.name)
        pose = each.poses[0]
        end = "" if each.name == "chassis" else each.name.split()[0]
        discs = np.zeros((0, 3))
        if not wheels:
            discs = np.column_stack([place(each.circles[:, :2], pose), each.circles[:, 2]])
        found.append(
            Carrier(
                end=end,
                surface=_surface(
                    {scene.kinds[body] for body in each.bodies if scene.bodies["body"][body] >= 0},
                    track_of(robot, end)[1]["kind"],
                ),
                middle=pose[:2],
                direction=np.array([np.cos(pose[2]), np.sin(pose[2])]),
                wheels=wheels,
                discs=discs,
                loop=None if wheels else _loop(place(each.envelope, pose)),
            )
        )
    return found


def remainder(whole: Part, parts: list[Part], wheels: Iterable[Wheel]) -> tuple[Part | None, bool]:
    """Return the whole minus parts and wheels, and whether the wheels are hoops.

    With a given moment of inertia, a wheel is lightest as a hoop. Hoops are used only if uniform
    wheels would leave too little mass.
    """
    wheels = list(wheels)
    for is_hoop in (False, True):
        left = _rest(whole, [*parts, *(wheel.part(is_hoop=is_hoop) for wheel in wheels)])
        if left is not None:
            return left, is_hoop
    return None, True


def track_of(robot: dict[str, Any], end: str) -> tuple[str, dict[str, Any]]:
    """Return path and track model of the chassis, or of the flippers at an end."""
    flippers = robot["flippers"]
    if end and flippers["track"] is not None:
        return "robot.flippers.track", flippers["track"]
    return "robot.track", robot["track"]


def refuse_unsupported(robot: dict[str, Any], carriers: Iterable[Carrier], target: Format) -> None:
    """Refuse a robot if a format cannot represent its tracks or name.

    Parameters
    ----------
    robot : dict
        The robot, as in a scenario in JSON.
    carriers : iterable of Carrier
        Its chassis and flippers.
    target : Format
        The format.

    Raises
    ------
    ScenarioError
        If the track of chassis or flippers is of a kind that no model file can represent, or a belt
        in a format without moving surfaces; or if the name cannot be written.
    """
    for carrier in carriers:
        if carrier.surface == "wheels" or (carrier.surface == "belt" and target.moves_surfaces):
            continue
        path, track = track_of(robot, carrier.end)
        supported = "wheels or a smooth belt" if target.moves_surfaces else "wheels"
        reason = _REASONS[carrier.surface].format(target.name)
        raise ScenarioError(f"{path}.kind", track["kind"], f"must be {supported}: {reason}")
    name = robot["name"]
    if not all(letter >= " " and letter not in "\x7f\ufffe\uffff" for letter in name):
        raise ScenarioError("robot.name", name, "must have only characters that XML allows")
    if target.reserved and re.fullmatch(target.reserved, name):
        rule = f"must not be a name that {target.name} reserves"
        rule += " (world, with :: in it, or between pairs of _)"
        raise ScenarioError("robot.name", name, rule)


def refuse_tapering(robot: dict[str, Any], end: str, target: Format) -> NoReturn:
    """Refuse gear wheels whose grousers taper, of the chassis or of the flippers at an end.

    Raises
    ------
    ScenarioError
        Always.
    """
    path, track = track_of(robot, end)
    rule = f"must be as thick as the tip: {target.name} has boxes for grousers, and no hulls"
    thickness = track["wheel"]["base_thickness"]
    raise ScenarioError(f"{path}.wheel.base_thickness", thickness, rule)


def _wheel(scene: Scene, row: dict[str, Any]) -> Wheel:
    """Return a wheel, with its exact outline if it is a gear wheel."""
    body = int(np.flatnonzero(scene.bodies["body"] == row["body"])[0])
    outline = None
    # The core has radii for discs.
    if scene.kinds[body] == BodyKind.WHEEL and np.isnan(scene.bodies["radius"][body]):
        # Raising a flipper turns the wheels on it, those farther from the pivot more.
        turned = np.array([0.0, 0.0, scene.poses[0, body, 2]])
        outline = place(scene.bodies["outline"][body], turned)
    return Wheel(
        body=int(row["body"]),
        center=np.array([row["x"], row["y"]]),
        radius=float(row["radius"]),
        mass=float(row["mass"]),
        inertia=float(row["moment_of_inertia"]),
        outline=outline,
    )


def _surface(kinds: set[BodyKind], track: str) -> str:
    """Return the kind of surface of a carrier, from its bodies and the kind of its track."""
    if BodyKind.SHOE in kinds:
        return "segmental"
    if BodyKind.BELT in kinds:
        return "grouser_belt" if BodyKind.GROUSER in kinds else "belt"
    return "force" if track == "force" else "wheels"


def _loop(polygon: Array) -> Part:
    """Return a belt along a polygon, with 1 kg spread evenly over its length."""
    start, end = polygon, np.roll(polygon, -1, axis=0)
    lengths = np.hypot(*(end - start).T)
    shares, middles = lengths / lengths.sum(), 0.5 * (start + end)
    center = shares @ middles
    inertia = shares @ (lengths**2 / 12.0 + ((middles - center) ** 2).sum(axis=1))
    return Part(mass=1.0, center=center, inertia=float(inertia))


def _rest(whole: Part, parts: Iterable[Part]) -> Part | None:
    """Return the whole minus its parts; None if the result is not physically possible.

    Examples
    --------
    >>> rod = Part(mass=3.0, center=np.zeros(2), inertia=0.5)
    >>> tip = Part(mass=1.0, center=np.array([0.5, 0.0]), inertia=0.0)
    >>> left = _rest(rod, [tip])
    >>> left.mass, left.center.tolist(), round(left.inertia, 3)
    (2.0, [-0.25, 0.0], 0.125)
    """
    parts = list(parts)
    mass = whole.mass - sum(part.mass for part in parts)
    if not mass >= _LEAST * whole.mass:
        return None
    moment: Array = whole.mass * whole.center - sum(
        (part.mass * part.center for part in parts), np.zeros(2)
    )
    center = moment / mass
    inertia = whole.inertia - mass * _squared(center - whole.center)
    for part in parts:
        inertia -= part.inertia + part.mass * _squared(part.center - whole.center)
    if not inertia >= _LEAST * whole.inertia:
        return None
    return Part(mass=mass, center=center, inertia=inertia)


def _squared(vector: Array) -> float:
    return float(vector @ vector)
