"""A robot in space as plain data: rigid bodies with their shapes, and wheels on hinges."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import Any

import numpy as np

from benches.models.files import cleaned
from benches.models.ode_child import plain_body
from crawler2d.model_tree import Array, Shape, Tree
from crawler2d.parameters.robot import Robot
from crawler2d.parameters.scenario import Scenario
from crawler2d.parameters.terrain import Flat
from crawler2d.writing.carriers import across_of
from crawler2d.writing.formats import URDF, document, urdf_of
from crawler2d.writing.model import model_of

__all__ = ["Solid", "Wheel", "solid_of"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Wheel:
    """A wheel on its hinge, which turns about +y when it drives forward.

    Parameters
    ----------
    link : str
        Of the tree.
    axle : tuple of float, shape (3,)
        [m] In the chassis frame: forward, to the left, up.
    radius : float
        [m] Of its circumscribed circle.
    torque : float
        [N m] Limit of its motor.
    """

    link: str
    axle: tuple[float, float, float]
    radius: float
    torque: float


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Solid:
    """A robot.

    Parameters
    ----------
    tree : Tree
        Its links, in the chassis frame; gear wheels are a cylinder and a box for each grouser.
    wheels : tuple of Wheel
        The left side first.
    is_coupled : bool
        Whether all wheels of a side are on one motor, whose torque the first wheel of the side has.
    """

    tree: Tree
    wheels: tuple[Wheel, ...]
    is_coupled: bool

    @property
    def mass(self) -> float:
        """[kg] Of all links."""
        return sum(link.mass for link in self.tree.links)

    @property
    def foremost(self) -> float:
        """[m] Of the wheels, in the chassis frame."""
        return max(wheel.axle[0] + wheel.radius for wheel in self.wheels)

    def lowest(self, phase: float) -> float:
        """[m] Height of the lowest point of all wheels, turned by a phase [m], in that frame."""
        links = self.tree.by_name
        return min(
            _low(shape, np.array(wheel.axle), phase / wheel.radius)
            for wheel in self.wheels
            for shape in links[wheel.link].shapes
        )

    def urdf(self) -> str:
        """Return it as a file, with a friction of 1: that of the ground decides."""
        return cleaned(document(urdf_of(self.tree), "a robot of the comparison of engines"))

    def plain(self) -> list[dict[str, Any]]:
        """Return its links as data for JSON, the chassis first, each with its motor if it has one.

        Rotations are rows of a matrix, one after the other.
        """
        wheels = {wheel.link: (wheel.axle, wheel.radius, wheel.torque) for wheel in self.wheels}
        free = None, None, None
        return [plain_body(link, *wheels.get(link.name, free)) for link in self.tree.links]


def solid_of(robot: Robot) -> Solid:
    """Make one of a robot, as its model file in URDF has it.

    With one motor a track, each wheel of an engine without gears has all of its torque.

    Examples
    --------
    >>> from benches.engines.robots import robot_of
    >>> solid = solid_of(robot_of("engineer", "line of 3", "60 N m, servos"))
    >>> round(solid.mass, 6), [wheel.link for wheel in solid.wheels][:2]
    (21.2, ['left_wheel_1', 'left_wheel_2'])
    """
    text = Scenario(robot, Flat()).to_json()
    data = json.loads(text)["robot"]
    across = across_of(robot.gauge, None, None)
    tree = model_of(data, text, across, friction=1.0, form=URDF)
    is_coupled = robot.drivetrain.torque_sharing == "track"
    joints = [joint for joint in tree.joints.values() if joint.kind == "hinge"]
    many = len(joints) // 2 if is_coupled else 1
    speed = robot.drivetrain.max_speed
    wheels = tuple(
        Wheel(
            link=joint.child,
            axle=tuple(joint.place.tolist()),
            radius=speed / float(joint.velocity or 0.0),
            torque=many * float(joint.effort or 0.0),
        )
        for joint in joints
    )
    return Solid(tree=tree, wheels=wheels, is_coupled=is_coupled)


def _low(shape: Shape, axle: Array, angle: float) -> float:
    place = axle + _about_y(angle) @ (shape.pose.place - axle)
    if shape.kind == "cylinder":
        return float(place[2]) - shape.radius
    reach: Array = np.abs((_about_y(angle) @ shape.pose.turn)[2]) @ shape.size
    return float(place[2] - 0.5 * reach)


def _about_y(angle: float) -> Array:
    cos, sin = np.cos(angle), np.sin(angle)
    return np.array([[cos, 0.0, sin], [0.0, 1.0, 0.0], [-sin, 0.0, cos]])
