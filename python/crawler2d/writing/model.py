"""Convert a robot in side view to a tree of links in three dimensions, with motors at joints."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from crawler2d.common.bodies import belly_corners, belly_polygons, discs_in, end_discs
from crawler2d.errors import ScenarioError
from crawler2d.model_tree import NOWHERE, Array, Joint, Link, Pose, Shape, Tree
from crawler2d.writing.carriers import (
    Across,
    Carrier,
    Format,
    Part,
    Wheel,
    carriers_of,
    refuse_tapering,
    refuse_unsupported,
    remainder,
    tensor,
)
from crawler2d.writing.shapes import Solids, belly_shapes, belt_shapes, gear_shapes, in_space

__all__ = ["CHASSIS", "Limits", "flipper_joints", "model_of", "moved_links", "wheels_by_radius"]

CHASSIS = "chassis"
"""The root link; its frame is the chassis frame."""

_SIDES = (("left", 1.0), ("right", -1.0))
_AXLE = np.array([0.0, 1.0, 0.0])  # A wheel that turns about it by a positive angle drives forward.
_HALF_TURN = math.pi  # [rad] by which a flipper may turn in either direction


@dataclass(frozen=True, slots=True, kw_only=True)
class Limits:
    """Overall limits of the motors of a robot.

    Parameters
    ----------
    speed : float
        [m/s] Largest speed of the tracks.
    acceleration, deceleration : float
        [m/s^2] Largest rates at which the commanded speed rises and falls.
    track_height : float
        [m] Height from the lower to the upper run.
    """

    speed: float
    acceleration: float
    deceleration: float
    track_height: float


def model_of(
    robot: dict[str, Any], text: str, across: Across, *, friction: float, target: Format
) -> Tree:
    """Build the tree of a robot.

    Parameters
    ----------
    robot : dict
        The robot, as in a scenario in JSON.
    text : str
        This scenario, with the robot on level ground.
    across : Across
        Widths and lateral positions.
    friction : float
        [-] Coefficient of friction of all surfaces.
    target : Format
        The format.

    Raises
    ------
    ScenarioError
        If the format cannot represent its tracks, or the remaining mass or inertia is impossible.
    """
    carriers = carriers_of(robot, text)
    refuse_unsupported(robot, carriers, target)
    return _Model(robot, carriers, across, friction, target).tree()


def wheels_by_radius(tree: Tree, limits: Limits) -> list[tuple[float, list[Joint]]]:
    """[m] Return the joints of all wheels, by the radius at which they have the largest speed."""
    joints: dict[float, list[Joint]] = {}
    for joint in tree.joints.values():
        if joint.is_unlimited and joint.velocity:
            joints.setdefault(joint.velocity, []).append(joint)
    return [(limits.speed / velocity, group) for velocity, group in joints.items()]


def flipper_joints(tree: Tree) -> list[Joint]:
    """Return the joints that turn flippers."""
    return [
        joint for joint in tree.joints.values() if not joint.is_locked and not joint.is_unlimited
    ]


def moved_links(tree: Tree) -> list[Link]:
    """Return the links whose surface moves."""
    return [link for link in tree.links if any(shape.surface_speed for shape in link.shapes)]


class _Model:
    """Builds a tree, adding links and joints from the chassis outwards."""

    def __init__(
        self,
        robot: dict[str, Any],
        carriers: list[Carrier],
        across: Across,
        friction: float,
        target: Format,
    ) -> None:
        self.robot = robot
        self.chassis, *self.arms = carriers
        self.wheels = sum(len(each.wheels) for each in carriers)  # share the motor of a side
        self.across = across
        self.friction = friction
        self.target = target
        outline, drivetrain = robot["outline"], robot["drivetrain"]
        self.speed = float(drivetrain["max_speed"])
        # [N] Thrust of one side; the torque acts at the radius of the belt round the rear end.
        rear, front = end_discs(discs_in(outline))
        belt_radius = rear[2] - outline["grouser_height"]
        self.force = drivetrain["max_torque"] / belt_radius
        # [kg] Mass at the surface of one side that is equivalent to the rotor of its motor.
        self.rotor = drivetrain.get("rotor_inertia", 0.0) / belt_radius**2
        # [N s/m] Gain of its controller; None if it holds the speed exactly.
        controller = drivetrain.get("controller")
        self.gain = None if controller is None else controller["gain"] / belt_radius**2
        # [m] The end axles, on which flippers pivot, and the size of the track between them.
        self.axles = {"rear": np.array(rear[:2]), "front": np.array(front[:2])}
        self.length = front[0] - rear[0]
        self.radius = max(rear[2], front[2])
        self.links: list[Link] = []
        self.joints: dict[str, Joint] = {}

    def tree(self) -> Tree:
        self.add_chassis()
        for arm in self.arms:
            self.add_arms(arm)
        return Tree(
            name=self.robot["name"] or "robot",
            format=self.target.name,
            file="",
            links=tuple(self.links),
            joints=self.joints,
            driven={joint.name: NOWHERE for joint in self.joints.values() if joint.kind == "hinge"},
        )

    def add_chassis(self) -> None:
        """Add the chassis with the remaining mass, its belly and the tracks."""
        robot = self.robot
        whole = Part(
            mass=robot["mass"],
            center=np.array(robot["center_of_mass"]),
            inertia=robot["moment_of_inertia"],
        )
        arms = [self.rod(arm.end) for arm in self.arms for _ in _SIDES]
        loop, mass = self.chassis.loop, 0.5 * robot["track_mass"]
        belt = None
        if loop is not None:
            belt = Part(mass=mass, center=loop.center, inertia=mass * loop.inertia)
        tracks = [] if belt is None else [belt, belt]
        left, is_hoop = remainder(whole, [*arms, *tracks], 2 * self.chassis.wheels)
        if left is None:
            rule = "must exceed that of tracks and flippers at their positions, as must the mass"
            raise ScenarioError("robot.moment_of_inertia", robot["moment_of_inertia"], rule)
        corners = belly_corners(robot["belly"])
        sizes = np.ptp(corners, axis=0) if len(corners) else (self.length, self.radius)
        width, has_hulls = self.across.chassis_width, self.target.has_hulls
        solids = self.solids(CHASSIS, 0.0, width)
        belly = belly_shapes(belly_polygons(robot["belly"]), solids, hulls=has_hulls)
        self.links.append(
            Link(
                name=CHASSIS,
                pose=Pose(),
                mass=left.mass,
                center=in_space(left.center, 0.0),
                inertia=tensor(left, length=sizes[0], height=sizes[1], width=width),
                shapes=tuple(belly),
            )
        )
        for side, sign in _SIDES:
            y = sign * 0.5 * self.across.gauge
            if belt is not None:
                self.add_track(f"{side}_track", y, belt)
            for wheel in self.chassis.wheels:
                name = f"{side}_wheel_{wheel.body}"
                self.add_wheel(name, CHASSIS, self.chassis, wheel, y, is_hoop=is_hoop)

    def rod(self, end: str) -> Part:
        """Return a flipper at angle 0."""
        flippers, sign = self.robot["flippers"], _sign(end)
        mass, length = flippers["mass"], flippers["length"]
        center = self.axles[end] + np.array([sign * 0.5 * length, 0.0])
        return Part(mass=mass, center=center, inertia=mass * length**2 / 12.0)

    def add_track(self, name: str, y: float, belt: Part) -> None:
        """Add a belt, which is fixed to the chassis, with a moving surface."""
        width, height = self.across.track_width, 2.0 * self.radius
        solids = self.solids(name, y, width, self.speed)
        self.add(
            name,
            CHASSIS,
            np.array([0.0, y, 0.0]),
            belt,
            inertia=tensor(belt, length=self.length + height, height=height, width=width),
            shapes=belt_shapes(self.chassis.discs, solids),
            kind="fixed",
        )

    def add_arms(self, arm: Carrier) -> None:
        """Add the flippers at one end: uniform rods, with everything that they carry."""
        flippers, sign = self.robot["flippers"], _sign(arm.end)
        rod = self.rod(arm.end)
        turned = Part(mass=rod.mass, center=arm.middle, inertia=rod.inertia)
        left, is_hoop = remainder(turned, [], arm.wheels)
        if left is None:
            rule = "must give a uniform rod more inertia than the wheels on it have"
            raise ScenarioError("robot.flippers.length", flippers["length"], rule)
        width = self.across.flipper_width
        radius = max(flippers["root_radius"], flippers["tip_radius"])
        moments = tensor(left, length=flippers["length"], height=radius, width=width)
        (x, z) = arm.direction
        turn = np.array([[x, 0.0, -z], [0.0, 1.0, 0.0], [z, 0.0, x]])
        for side, lateral in _SIDES:
            name, y = f"{arm.end}_{side}_flipper", lateral * self.across.flippers
            solids = self.solids(name, y, width, self.speed)
            self.add(
                name,
                CHASSIS,
                in_space(self.axles[arm.end], y),
                left,
                inertia=turn @ moments @ turn.T,
                shapes=belt_shapes(arm.discs, solids) if arm.loop is not None else (),
                axis=-sign * _AXLE,  # upwards is positive
                lower=-_HALF_TURN,
                upper=_HALF_TURN,
                effort=flippers["torque_limit"],
                velocity=flippers["rate_limit"],
                armature=flippers.get("rotor_inertia", 0.0),
            )
            for wheel in arm.wheels:
                wheel_name = f"{name}_wheel_{wheel.body}"
                self.add_wheel(wheel_name, name, arm, wheel, y, is_hoop=is_hoop)

    def add_wheel(
        self, name: str, parent: str, carrier: Carrier, wheel: Wheel, y: float, *, is_hoop: bool
    ) -> None:
        """Add a wheel with its own motor, an equal share of the motor of its side."""
        part, count = wheel.part(is_hoop=is_hoop), self.wheels
        # If the chassis has a belt, the rotor turns with that.
        rotor = 0.0 if self.chassis.loop is not None else self.rotor / count
        width = self.across.flipper_width if carrier.end else self.across.track_width
        self.add(
            name,
            parent,
            in_space(wheel.center, y),
            part,
            inertia=tensor(part, length=1.0, height=1.0, width=width),
            shapes=self.wheel_shapes(wheel, self.solids(name, y, width), carrier.end),
            effort=self.force / count * wheel.radius,
            velocity=self.speed / wheel.radius,
            armature=rotor * wheel.radius**2,
            gain=None if self.gain is None else self.gain / count * wheel.radius**2,
        )

    def wheel_shapes(self, wheel: Wheel, solids: Solids, end: str) -> Sequence[Shape]:
        if wheel.outline is None:
            return [solids.cylinder(0, wheel.center, wheel.radius)]
        hulls = self.target.has_hulls
        shapes = gear_shapes(wheel.outline, solids, wheel.center, hulls=hulls)
        if shapes is None:
            refuse_tapering(self.robot, end, self.target)
        return shapes

    def solids(self, name: str, y: float, width: float, speed: float = 0.0) -> Solids:
        return Solids(name=name, across=y, width=width, friction=self.friction, speed=speed)

    def add(
        self,
        name: str,
        parent: str,
        place: Array,
        part: Part,
        *,
        inertia: Array,
        shapes: Sequence[Shape],
        kind: str = "hinge",
        axis: Array = _AXLE,
        **motor: Any,
    ) -> None:
        """Add a link, with its joint at its origin."""
        self.links.append(
            Link(
                name=name,
                pose=Pose(place=place),
                mass=part.mass,
                center=in_space(part.center, place[1]),
                inertia=inertia,
                shapes=tuple(shapes),
            )
        )
        self.joints[name] = Joint(
            name=f"{name}_joint",
            kind=kind,
            parent=parent,
            child=name,
            place=place,
            axis=axis,
            **motor,
        )


def _sign(end: str) -> float:
    return 1.0 if end == "front" else -1.0
