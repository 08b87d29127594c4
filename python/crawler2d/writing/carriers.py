"""What runs on chassis and flippers, in side view: wheels one by one, or the discs of a belt."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np

from crawler2d import _core
from crawler2d.common.bodies import BodyKind
from crawler2d.drawings.plane import placed
from crawler2d.drawings.scene import Scene, at_start, on_chassis
from crawler2d.models.poses import Array
from crawler2d.writing.inertia import Part, rest

__all__ = ["Carrier", "Wheel", "carriers_of", "left_of", "track_of"]


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Wheel:
    """A wheel of one side.

    Parameters
    ----------
    center : ndarray, shape (2,)
        [m] Its axle in the chassis frame.
    radius : float
        [m] Of its circumscribed circle.
    mass : float
        [kg] Of a uniform wheel with its outline and moment of inertia.
    inertia : float
        [kg m^2] About its axle.
    outline : ndarray, shape (n, 2), optional
        [m] Of a gear wheel about its axle, turned as it starts; None: it is round.
    """

    center: Array
    radius: float
    mass: float
    inertia: float
    outline: Array | None

    def part(self, *, is_hoop: bool) -> Part:
        """Return its mass: as a uniform wheel, or the least that has its moment of inertia."""
        mass = self.inertia / self.radius**2 if is_hoop else self.mass
        return Part(mass=mass, center=self.center, inertia=self.inertia)


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Carrier:
    """The chassis, or the flippers at one end, of one side.

    Parameters
    ----------
    end : {"", "front", "rear"}
        Of the robot; empty for the chassis.
    surface : {"wheels", "belt", "grouser_belt", "segmental", "force"}
        What meets the ground; skids and free wheels are "force".
    middle : ndarray, shape (2,)
        [m] The middle of its frame in the chassis frame, flippers at their angle.
    direction : ndarray, shape (2,)
        Of the x axis of that frame.
    wheels : tuple of Wheel
        None if it carries a belt.
    discs : ndarray, shape (n, 3)
        [m] Centres in the chassis frame and radii of the discs of a belt; none if it has wheels.
    loop : Part or None
        The belt as a loop, of 1 kg.
    """

    end: str
    surface: str
    middle: Array
    direction: Array
    wheels: tuple[Wheel, ...]
    discs: Array
    loop: Part | None


def carriers_of(robot: dict[str, Any], text: str) -> list[Carrier]:
    """List what carries something, the chassis first.

    Parameters
    ----------
    robot : dict
        As in a scenario in JSON.
    text : str
        That scenario, with the robot on level ground.
    """
    scene = Scene(text, on_chassis(at_start(text)))
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
            discs = np.column_stack([placed(each.circles[:, :2], pose), each.circles[:, 2]])
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
                loop=None if wheels else _loop(placed(each.envelope, pose)),
            )
        )
    return found


def left_of(whole: Part, parts: list[Part], wheels: Iterable[Wheel]) -> tuple[Part | None, bool]:
    """Return what is left without parts and wheels, and whether these are hoops.

    A wheel of a given moment of inertia is lightest as a hoop. It is one only where uniform wheels
    would leave too little.
    """
    wheels = list(wheels)
    for is_hoop in (False, True):
        left = rest(whole, [*parts, *(wheel.part(is_hoop=is_hoop) for wheel in wheels)])
        if left is not None:
            return left, is_hoop
    return None, True


def _wheel(scene: Scene, row: dict[str, Any]) -> Wheel:
    """Return a wheel with its exact outline, if it is a gear wheel."""
    body = int(np.flatnonzero(scene.bodies["body"] == row["body"])[0])
    outline = None
    # The core gives the radius of what is a disc.
    if scene.kinds[body] == BodyKind.WHEEL and np.isnan(scene.bodies["radius"][body]):
        # A flipper that is raised has turned the wheels on it, the farther ones more.
        turned = np.array([0.0, 0.0, scene.poses[0, body, 2]])
        outline = placed(scene.bodies["outline"][body], turned)
    return Wheel(
        center=np.array([row["x"], row["y"]]),
        radius=float(row["radius"]),
        mass=float(row["mass"]),
        inertia=float(row["moment_of_inertia"]),
        outline=outline,
    )


def _loop(polygon: Array) -> Part:
    """Return a belt along a polygon with 1 kg spread evenly over its length."""
    start, end = polygon, np.roll(polygon, -1, axis=0)
    lengths = np.hypot(*(end - start).T)
    shares, middles = lengths / lengths.sum(), 0.5 * (start + end)
    center = shares @ middles
    inertia = shares @ (lengths**2 / 12.0 + ((middles - center) ** 2).sum(axis=1))
    return Part(mass=1.0, center=center, inertia=float(inertia))


def _surface(kinds: set[BodyKind], track: str) -> str:
    """Tell what meets the ground, from the bodies of a carrier and the kind of its track."""
    if BodyKind.SHOE in kinds:
        return "segmental"
    if BodyKind.BELT in kinds:
        return "grouser_belt" if BodyKind.GROUSER in kinds else "belt"
    return "force" if track == "force" else "wheels"


def track_of(robot: dict[str, Any], end: str) -> tuple[str, dict[str, Any]]:
    """Return path and model of the track of the chassis, or of the flippers at an end."""
    flippers = robot["flippers"]
    if end and flippers["track"] is not None:
        return "robot.flippers.track", flippers["track"]
    return "robot.track", robot["track"]
