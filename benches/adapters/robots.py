"""A robot for engines in three dimensions: a model file, its wheels, and rigid bodies as data."""

import json
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np

from crawler2d import Robot, Scenario
from crawler2d.model_tree import Array, Joint, Link, Pose, Shape, Tree, from_quaternion, from_rpy
from crawler2d.parameters.terrain import Flat
from crawler2d.reading.wheels import subtrees
from crawler2d.writing.carriers import across_of
from crawler2d.writing.formats import URDF, document, urdf_of
from crawler2d.writing.model import model_of

AMPLE = 1e4
"""[N m] Limit of motors that have none, and of those that hold flippers."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Wheel:
    """A wheel on its hinge.

    Parameters
    ----------
    link : str
        Name in the tree.
    axle : tuple of float, shape (3,)
        [m] In the chassis frame: forward, to the left, up.
    radius : float
        [m] Of its circumscribed circle.
    torque : float
        [N m] Limit of its motor.
    rate : float, optional
        [1/m] Angle of its joint for each metre that the surface runs; None takes 1 / radius.
    """

    link: str
    axle: tuple[float, float, float]
    radius: float
    torque: float = AMPLE
    rate: float | None = None

    def turn(self, distance: float) -> float:
        """[rad] Return the angle by which the joint turns while the surface runs a distance [m]."""
        return distance / self.radius if self.rate is None else distance * self.rate


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class RobotModel:
    """A robot; its model file has +x forward and z up.

    Parameters
    ----------
    file : str
        Name of its file; the ending, .urdf or .sdf, is the format.
    tree : Tree
        Its links.
    text : str
        Content of the file, without visuals, sensors and plugins; if empty, URDF of the tree.
    wheels : tuple of Wheel
        All of them, the left side first in a robot of crawler2d.
    bodies : list of dict
        Chassis and wheels, see `rigid_bodies`, for engines that read no files.
    height : float, optional
        [m] Of the lowest point of round wheels, in the chassis frame; None finds that of any wheels
        from their shapes.
    held : mapping of str to float
        [rad] Angle at which the joint of each flipper is held, by link.
    origin : ndarray, shape (3,)
        [m] Of the chassis frame, in the frame of the model.
    is_coupled : bool
        Whether all wheels of a side have one motor, whose torque each wheel has here.
    holds_speed : bool
        Whether the motors hold the speed that they are given, without a limit of torque.
    """

    file: str
    tree: Tree
    wheels: tuple[Wheel, ...]
    bodies: list[dict[str, Any]]
    text: str = ""
    height: float | None = None
    held: dict[str, float] = field(default_factory=dict)
    origin: Array = field(default_factory=lambda: np.zeros(3))
    is_coupled: bool = False
    holds_speed: bool = False

    @property
    def mass(self) -> float:
        """[kg] Of all links."""
        return sum(link.mass for link in self.tree.links)

    @property
    def foremost(self) -> float:
        """[m] Of the wheels, in the chassis frame."""
        return max(wheel.axle[0] + wheel.radius for wheel in self.wheels)

    def lowest(self, phase: float) -> float:
        """[m] Height of the lowest point of all wheels, whose surfaces have advanced by a phase."""
        if self.height is not None:
            return self.height
        bodies = {body["name"]: body for body in self.bodies}
        return min(
            _low(shape, np.array(wheel.axle), phase / wheel.radius)
            for wheel in self.wheels
            for shape in bodies[wheel.link]["shapes"]
        )

    @contextmanager
    def path(self) -> Iterator[str]:
        """Write the file into a temporary folder."""
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / self.file
            text = self.text or cleaned(document(urdf_of(self.tree), "a robot of crawler2d"))
            path.write_text(text, encoding="utf-8")
            yield str(path)


def model_of_robot(robot: Robot) -> RobotModel:
    """Return a robot as in its URDF.

    With one motor a track, each wheel of an engine without gears has all of its torque.

    Examples
    --------
    >>> import crawler2d as c2d
    >>> robot = c2d.robots.engineer(flippers=None, track=c2d.LineOfWheels(3))
    >>> model = model_of_robot(robot)
    >>> round(model.mass, 6), [wheel.link for wheel in model.wheels][:2]
    (21.2, ['left_wheel_0', 'left_wheel_1'])
    """
    text = Scenario(robot, Flat()).to_json()
    across = across_of(robot.gauge, None, None)
    tree = model_of(json.loads(text)["robot"], text, across, friction=1.0, target=URDF)
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
    by_link = {wheel.link: wheel for wheel in wheels}
    return RobotModel(
        file="robot.urdf",
        tree=tree,
        wheels=wheels,
        bodies=[_body(link, by_link.get(link.name)) for link in tree.links],
        is_coupled=is_coupled,
    )


def cleaned(text: str) -> str:
    """Remove parts of a file that no engine needs for driving: visuals, sensors, plugins, meshes.

    Joints of links that are not in the file are removed, too, and SDF gets the zeros for missing
    damping that Bullet's reader asks for. All masses, shapes but meshes, joints and their places
    stay.
    """
    root = ElementTree.fromstring(text)
    for parent in list(root.iter()):
        for tag in ("visual", "sensor", "plugin", "gazebo", "transmission"):
            for child in parent.findall(tag):
                parent.remove(child)
        for child in parent.findall("collision"):
            if child.find("geometry/mesh") is not None:
                parent.remove(child)
    if root.tag == "robot":
        links = {link.get("name") for link in root.findall("link")}
        for joint in root.findall("joint"):
            ends = [joint.find(tag) for tag in ("parent", "child")]
            if any(end is None or end.get("link") not in links for end in ends):
                root.remove(joint)
    else:
        for dynamics in root.iter("dynamics"):
            for tag in ("damping", "friction"):
                if dynamics.find(tag) is None:
                    ElementTree.SubElement(dynamics, tag).text = "0"
    return ElementTree.tostring(root, encoding="unicode")


def rigid_bodies(
    tree: Tree, wheels: Sequence[Wheel], held: dict[str, float], origin: Array
) -> list[dict[str, Any]]:
    """Return the links of a model file as rigid bodies: the chassis with its flippers, the wheels.

    Parameters
    ----------
    tree : Tree
        The links.
    wheels, held, origin
        See `RobotModel`. What is attached to a wheel turns with it; all else is one body, with the
        flippers at their angles.

    Returns
    -------
    list of dict
        The chassis first, all in the chassis frame; rotations are rows of a matrix, one after the
        other.
    """
    attached = subtrees(tree)
    to_chassis = Pose(place=-origin)
    moves = dict.fromkeys(attached, to_chassis)
    for flipper, angle in held.items():
        turn = to_chassis.then(_turn(tree.joints[flipper], angle))
        moves |= dict.fromkeys(attached[flipper], turn)
    links = {link.name: _moved(link, moves[link.name]) for link in tree.links}
    parts = {wheel.link: [links[name] for name in attached[wheel.link]] for wheel in wheels}
    turning = {link.name for own in parts.values() for link in own}
    chassis = _merged([link for name, link in links.items() if name not in turning])
    return [_body(chassis, None), *(_body(_merged(parts[w.link]), w) for w in wheels)]


def _turn(joint: Joint, angle: float) -> Pose:
    """Return the frame of the model after a turn about a joint."""
    along = np.sin(0.5 * angle) * joint.axis / np.linalg.norm(joint.axis)
    turn = from_quaternion((np.cos(0.5 * angle), *along)).turn
    return Pose(place=joint.place - turn @ joint.place, turn=turn)


def _moved(link: Link, move: Pose) -> Link:
    """Return a link in another frame, without meshes."""
    shapes = (shape for shape in link.shapes if shape.kind != "mesh")
    return replace(
        link,
        center=move.at(link.center),
        inertia=move.turn @ link.inertia @ move.turn.T,
        shapes=tuple(replace(shape, pose=move.then(shape.pose)) for shape in shapes),
    )


def _merged(links: Sequence[Link]) -> Link:
    """Return one body of several links, under the name of the first."""
    mass = sum(link.mass for link in links)
    center = sum((link.mass * link.center for link in links), np.zeros(3)) / mass
    inertia = np.zeros((3, 3))
    for link in links:
        arm = link.center - center
        inertia += link.inertia + link.mass * (arm @ arm * np.eye(3) - np.outer(arm, arm))
    shapes = tuple(shape for link in links for shape in link.shapes)
    return replace(links[0], mass=mass, center=center, inertia=inertia, shapes=shapes)


def _body(link: Link, wheel: Wheel | None) -> dict[str, Any]:
    return {
        "name": link.name,
        "mass": link.mass,
        "center": link.center.tolist(),
        "inertia": link.inertia.ravel().tolist(),
        "shapes": [_shape(shape) for shape in link.shapes],
        "axle": None if wheel is None else list(wheel.axle),
        "radius": None if wheel is None else wheel.radius,
        "torque": None if wheel is None else wheel.torque,
    }


def _shape(shape: Shape) -> dict[str, Any]:
    return {
        "kind": shape.kind,
        "place": shape.pose.place.tolist(),
        "turn": shape.pose.turn.ravel().tolist(),
        "radius": shape.radius,
        "length": shape.length,
        "size": shape.size.tolist(),
    }


def _low(shape: dict[str, Any], axle: Array, angle: float) -> float:
    about_y = from_rpy((0.0, angle, 0.0)).turn
    place = axle + about_y @ (np.array(shape["place"]) - axle)
    if shape["kind"] == "cylinder":
        return float(place[2]) - float(shape["radius"])
    turn = np.array(shape["turn"]).reshape(3, 3)
    reach: Array = np.abs((about_y @ turn)[2]) @ np.array(shape["size"])
    return float(place[2] - 0.5 * reach)
