"""MJCF as a neutral tree, by MuJoCo's own parser in a child process."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np

from crawler2d.errors import ScenarioError
from crawler2d.model_tree import (
    Friction,
    Joint,
    Link,
    Pose,
    Shape,
    Tree,
    Unread,
    Where,
    from_quaternion,
    unit,
)
from crawler2d.reading.child import answered
from crawler2d.reading.elements import Element
from crawler2d.reading.joints import checked
from crawler2d.reading.shapes import MOST_CORNERS, Meshes, collisions, ellipsoid

__all__ = ["read_mjcf"]

Plain = dict[str, Any]

_LARGEST = 1e6  # [m, kg, ...] as in other formats; limits may be infinite
_SIZES = ("place", "center", "size", "points", "mass", "inertia", "moved")


def read_mjcf(root: Element, text: str, model: str | None, meshes: Meshes) -> Tree:
    """Read the robot of an MJCF file: what hangs on one free joint.

    Parameters
    ----------
    root : Element
        Of the file.
    text : str
        All of it, which MuJoCo reads for itself.
    model : str, optional
        Name of the body with the free joint; None takes the only one.
    meshes : Meshes
        What is done with meshes, and the files of the model.

    Returns
    -------
    Tree
        The robot, in the frame of its root body.

    Raises
    ------
    ScenarioError
        If MuJoCo does not compile it, or no body floats.
    ImportError
        If MuJoCo is missing; the message names the extra to install.
    """
    _refuse_includes(root)
    file = root.where.file
    question = {"text": text, "file": file, "files": meshes.files.plain}
    folder = meshes.files.folder
    plain = answered("crawler2d.reading.mjcf_child", question, file=file, folder=folder)
    _refuse_wild(plain, file)
    return _Model(plain, root.where, meshes).tree(model)


def _refuse_includes(root: Element) -> None:
    """Refuse files in several parts, whose lines would be those of any of them."""
    for element in root.within():
        if element.tag in ("include", "model"):
            rule = "must hold the robot itself: read the file that is named, or write it in here"
            element.refuse(element.attributes.get("file", ""), rule)


def _refuse_wild(plain: Plain, file: str) -> None:
    """Refuse numbers that no robot has, as in other formats, and turns that are none."""
    for kind in ("bodies", "joints", "shapes", "motors"):
        for item in plain[kind]:
            path = f"{file}:{item['line']}: {kind}[{item.get('name', '')}]"
            for name, value in item.items():
                numbers = np.array(value if isinstance(value, list) else [value]).ravel()
                if numbers.dtype.kind not in "fi":
                    continue
                most = np.abs(numbers).max(initial=0.0)
                if not most <= (_LARGEST if name in _SIZES else math.inf) or math.isnan(most):
                    rule = f"must be finite and at most {_LARGEST:g} in magnitude"
                    raise ScenarioError(f"{path}: {name}", float(most), rule)
                # Squares of numbers that are too large leave MuJoCo with no direction at all.
                if name in ("turn", "axes") and not numbers.any():
                    raise ScenarioError(f"{path}: {name}", 0.0, "must be a rotation")


class _Model:
    """What MuJoCo told about a model, on its way to a tree."""

    def __init__(self, plain: Plain, at: Where, meshes: Meshes) -> None:
        self.plain = plain
        self.at = at
        self.meshes = meshes
        self.corners = 0  # of all meshes
        every = (*plain["shapes"], *plain["lacking"])
        self.colliding: set[int] = {each["body"] for each in every if each["collides"]}
        self.bodies: list[Plain] = plain["bodies"]
        self.joints: dict[int, list[Plain]] = {}
        for joint in plain["joints"]:
            self.joints.setdefault(joint["body"], []).append(joint)
        self.motors = {motor["joint"]: motor for motor in plain["motors"]}

    def where(self, item: Plain) -> Where:
        return Where(self.at.file, item["line"] or self.at.line)

    def tree(self, name: str | None) -> Tree:
        root = self.root(name)
        poses = {root: Pose()}
        names = [(self.bodies[root]["name"], self.where(self.bodies[root]))]
        joints: dict[str, Joint] = {}
        for number, body in enumerate(self.bodies):  # parents come before their children
            if number and body["parent"] in poses:
                inner = from_quaternion(body["turn"], body["place"])
                poses[number] = poses[body["parent"]].then(inner)
                names.append((body["name"], self.where(body)))
                joints[body["name"]] = self.joint(number, poses[number])
        ends = [(j.name, j.parent, j.child, j.at) for j in joints.values()]
        order = {
            each: rank
            for rank, each in enumerate(checked(names, ends, self.at, self.meshes.doubts))
        }
        links = [self.link(number, pose) for number, pose in poses.items()]
        return Tree(
            name=self.plain["name"],
            format="MJCF",
            file=self.at.file,
            links=tuple(sorted(links, key=lambda link: order[link.name])),
            joints=joints,
            driven={name: self.where(motor) for name, motor in self.motors.items() if name},
            at=self.at,
        )

    def root(self, name: str | None) -> int:
        """Return the body that floats."""
        floating = [
            number
            for number, joints in self.joints.items()
            if [joint["kind"] for joint in joints] == ["free"]
        ]
        called = [self.bodies[number]["name"] for number in floating]
        if name is not None:
            if name not in called:
                raise ScenarioError("model", name, f"must be one of {', '.join(called[:10])}")
            return floating[called.index(name)]
        driving = [n for n in floating if len(floating) == 1 or self.drives(n)]
        if len(driving) != 1:
            rule = (
                "must have one body with a free joint, or one of several with wheels or moved"
                " surfaces: model= names it"
            )
            names = [self.bodies[number]["name"] for number in driving or floating]
            raise ScenarioError(str(self.at), ", ".join(names[:10]) or "none", rule)
        return driving[0]

    def below(self, root: int) -> set[int]:
        """Return a body and those that hang on it."""
        on = {root}
        for number, body in enumerate(self.bodies):  # parents come before their children
            if number and body["parent"] in on:
                on.add(number)
        return on

    def drives(self, root: int) -> bool:
        """Whether anything on a body turns without limit, or has a surface that moves."""
        on = self.below(root)
        joints = [joint for number in on for joint in self.joints.get(number, [])]
        turns = any(joint["kind"] == "hinge" and not joint["range"] for joint in joints)
        return turns or any(s["body"] in on and any(s["moved"]) for s in self.plain["shapes"])

    def joint(self, number: int, pose: Pose) -> Joint:
        body = self.bodies[number]
        child, parent = body["name"], self.bodies[body["parent"]]["name"]
        found = self.joints.get(number, [])
        if len(found) > 1:
            path = f"{self.where(body)}: body[{child}]"
            got, rule = f"{len(found)} joints", "must have at most one joint"
            if self.below(number) & self.colliding:
                raise ScenarioError(path, got, rule)
            reason = f"is taken as fixed, for nothing on its joints collides: {rule}"
            self.meshes.doubts.append((path, got, reason))
            found = []
        if not found:
            return Joint(
                name=f"of {child}",
                kind="fixed",
                parent=parent,
                child=child,
                place=pose.place,
                axis=pose.turn[:, 2],
                at=self.where(body),
                effort_at=self.where(body),
                velocity_at=self.where(body),
                dynamics_at=self.where(body),
            )
        (joint,) = found
        motor = self.motors.get(joint["name"], {})
        lower, upper = joint["range"] or (-math.inf, math.inf)
        efforts = [e for e in (joint["effort"], motor.get("effort")) if e is not None and e >= 0.0]
        axis = unit(pose.along(joint["axis"]))
        motor_at = self.where(motor or joint)
        return Joint(
            name=joint["name"],
            kind=joint["kind"],
            parent=parent,
            child=child,
            place=pose.at(joint["place"]),
            axis=pose.turn[:, 2] if axis is None else axis,
            lower=lower,
            upper=upper,
            effort=min(efforts, default=None),
            velocity=motor.get("velocity"),
            stiffness=joint["stiffness"],
            damping=joint["damping"] + motor.get("damping", 0.0),
            friction=joint["friction"],
            armature=joint["armature"] + motor.get("armature", 0.0),
            gain=motor.get("gain"),
            at=self.where(joint),
            effort_at=motor_at if motor.get("effort") is not None else self.where(joint),
            velocity_at=motor_at,
            dynamics_at=self.where(joint),
            gain_at=motor_at,
        )

    def link(self, number: int, pose: Pose) -> Link:
        body = self.bodies[number]
        axes = pose.then(from_quaternion(body["axes"], body["center"]))
        own = [self.shape(s, pose) for s in self.plain["shapes"] if s["body"] == number]
        shapes, unread = collisions([*own, *self.lacking(number)])
        return Link(
            name=body["name"],
            pose=pose,
            mass=body["mass"],
            center=axes.place,
            inertia=axes.turn @ np.diag(body["inertia"]) @ axes.turn.T,
            shapes=shapes,
            unread=unread,
            at=self.where(body),
            pose_at=self.where(body),
            mass_at=self.where(body),
        )

    def lacking(self, number: int) -> Iterator[Unread]:
        """Yield what a body lacks, and doubt it; what is only seen makes no difference."""
        for each in self.plain["lacking"]:
            if each["body"] == number:
                geom = self.stand_in(each)
                if each["weighs"]:
                    reason = "weighs nothing here, but its volume counts in MuJoCo"
                    self.meshes.doubts.append((geom.at, each["file"], reason))
                if each["collides"]:
                    yield self.meshes.missing(geom, each["file"], each["reason"])

    def stand_in(self, plain: Plain) -> Element:
        """Return an element that has the name and line of a geom."""
        return Element("geom", {"name": plain["name"]}, None, self.where(plain))

    def shape(self, plain: Plain, body: Pose) -> Shape | Unread | None:
        if not plain["collides"]:
            return None
        at, geom = self.where(plain), self.stand_in(plain)
        kind, sizes = plain["kind"], plain["size"]
        pose = body.then(from_quaternion(plain["turn"], plain["place"]))
        points = np.zeros((0, 3))
        if kind == "mesh":
            self.corners += len(plain["points"])
            if self.meshes.rule != "hull" or self.corners > MOST_CORNERS:
                reason = f"must, with the other meshes, have at most {MOST_CORNERS} corners"
                return self.meshes.missing(geom, plain["name"], reason)
            kind, points = "hull", pose.at(np.array(plain["points"], dtype=float).reshape(-1, 3))
        elif kind == "ellipsoid":
            kind, points = "hull", pose.at(ellipsoid(sizes))
        elif kind not in ("box", "cylinder", "capsule", "sphere"):
            return self.meshes.left_out(geom, kind, "no shape that a side view knows")
        return Shape(
            name=plain["name"],
            kind=kind,
            pose=pose,
            radius=sizes[0] if kind in ("cylinder", "capsule", "sphere") else 0.0,
            length=2.0 * sizes[1] if kind in ("cylinder", "capsule") else 0.0,
            size=2.0 * np.array(sizes) if kind == "box" else np.zeros(3),
            points=points,
            friction=Friction(
                first=plain["friction"],
                second=plain["friction"],
                priority=plain["priority"],
                first_at=at,
                second_at=at,
            ),
            surface_speed=_surface_speed(kind, sizes, plain["moved"]),
            at=at,
            pose_at=at,
            size_at=at,
        )


def _surface_speed(kind: str, sizes: list[float], moved: list[float]) -> float:
    """[m/s] Return the speed of a surface: as given, or by its turning at the radius it has.

    A box or hull has none; it is moved, and how fast, its drums tell.
    """
    lever = sizes[0] if kind in ("cylinder", "capsule", "sphere") else 1.0
    return max(math.hypot(*moved[:3]), math.hypot(*moved[3:]) * lever)
