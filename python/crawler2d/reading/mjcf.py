"""MJCF as a neutral tree, by MuJoCo's own parser in a child process."""

from __future__ import annotations

import math
import os
import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import PurePath
from typing import Any

import numpy as np

from crawler2d.common.extras import extra
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
from crawler2d.reading.child import answered, no_more_files, serve
from crawler2d.reading.elements import Element
from crawler2d.reading.files import LARGEST_TOGETHER, Files, why
from crawler2d.reading.meshes import MOST_CORNERS, Meshes
from crawler2d.reading.parts import checked, collisions, ellipsoid

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
    plain = answered("crawler2d.reading.mjcf", question, file=file, folder=folder)
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


# MuJoCo numbers the kinds of joints and shapes; what is not here is refused by its number.
_JOINTS = {0: "free", 1: "ball", 2: "slide", 3: "hinge"}


_SHAPES = {0: "plane", 1: "hfield", 2: "sphere", 3: "capsule", 4: "ellipsoid", 5: "cylinder"}


_SHAPES |= {6: "box", 7: "mesh"}


_INTEGRATOR = 1  # the number of the dynamics of an actuator whose activation is a position


def prepare() -> Callable[[dict[str, Any]], dict[str, Any]]:
    """Import MuJoCo."""
    mujoco = extra("mujoco", "models")
    return lambda question: _described(mujoco, **question)


def _described(mujoco: Any, *, text: str, file: str, files: dict[str, Any]) -> dict[str, Any]:
    lacking: list[_Lacking] = []
    try:
        with no_more_files():
            spec = mujoco.MjSpec.from_string(text)
        _undress(spec)
        lacking = list(_hand_over(spec, Files(**files), file))
        with no_more_files():
            model = spec.compile()
    except ScenarioError:
        raise
    except Exception as error:  # MuJoCo has several classes of errors for a bad file
        if lacking:  # without it, perhaps nothing tells what a body weighs
            raise lacking[0].error from None
        said = " ".join(str(error).split())
        line = re.search(r"line (\d+)", said)
        at = f"{file}:{line[1]}" if line else file
        raise ScenarioError(at, said, "must be a model that MuJoCo compiles") from None
    return {
        "name": spec.modelname,
        "bodies": [_body(model, body) for body in spec.bodies],
        "joints": [_joint(model, joint) for joint in spec.joints],
        "shapes": [_shape(model, geom) for geom in spec.geoms],
        "motors": [_motor(model, actuator) for actuator in spec.actuators],
        "lacking": [each.plain for each in lacking],
    }


@dataclass(frozen=True, slots=True)
class _Lacking:
    """A geom that is left out, for its mesh or height map could not be read."""

    body: Any
    what: dict[str, Any]
    error: ScenarioError

    @property
    def plain(self) -> dict[str, Any]:
        return {"body": self.body.id, **self.what}


def _undress(spec: Any) -> None:
    """Take off what is only seen: its files need not be there, nor be read."""
    for material in spec.materials:
        material.textures = [""] * len(material.textures)
    for kind in (spec.textures, spec.skins):
        for item in list(kind):
            spec.delete(item)


def _hand_over(spec: Any, files: Files, file: str) -> Iterator[_Lacking]:
    """Read the meshes and height maps of a model, and give MuJoCo what they hold for their names.

    What cannot be read is taken off the model, with the geoms that it is the shape of.
    """
    folder, spec.meshdir = spec.meshdir, ""
    lowest, highest = spec.compiler.inertiagrouprange
    for kind, named in (("meshes", "meshname"), ("hfields", "hfieldname")):
        for item in list(getattr(spec, kind)):
            if not item.file:
                continue
            inner = PurePath(item.file).name if spec.strippath else item.file
            place = os.path.join(folder, inner)
            try:
                at = f"{file}:{_line(item)}: {kind}[{item.name}]"
                data = files.read(place, at=at, most=LARGEST_TOGETHER)
            except ScenarioError as error:
                for geom in list(spec.geoms):
                    if getattr(geom, named) == item.name:
                        body = geom.parent
                        weighs = not body.explicitinertial and lowest <= geom.group <= highest
                        what = {
                            "name": geom.name,
                            "file": place,
                            "reason": why(error),
                            "collides": bool(geom.contype or geom.conaffinity),
                            "weighs": bool(weighs and (geom.mass > 0.0 or geom.density > 0.0)),
                            "line": _line(geom),
                        }
                        spec.delete(geom)
                        yield _Lacking(body, what, error)
                spec.delete(item)
            else:
                item.file = f"{len(spec.assets)}{PurePath(item.file).suffix}"
                spec.assets[item.file] = data


def _line(item: Any) -> int:
    """Return the line that MuJoCo noted for an item of the file; 0 for what it added itself."""
    found = re.search(r"line (\d+)", item.info)
    return int(found[1]) if found else 0


def _body(model: Any, body: Any) -> dict[str, Any]:
    i = body.id
    return {
        "name": body.name or f"body {i}",
        "parent": int(model.body_parentid[i]),
        "place": model.body_pos[i].tolist(),
        "turn": model.body_quat[i].tolist(),
        "mass": float(model.body_mass[i]),
        "center": model.body_ipos[i].tolist(),
        "axes": model.body_iquat[i].tolist(),
        "inertia": model.body_inertia[i].tolist(),
        "line": _line(body),
    }


def _joint(model: Any, joint: Any) -> dict[str, Any]:
    i = joint.id
    limited = bool(model.jnt_limited[i])
    first = int(model.jnt_dofadr[i])  # the only one of hinges and slides
    return {
        "name": joint.name or f"joint {i}",
        "kind": _JOINTS.get(int(model.jnt_type[i]), "unknown"),
        "body": int(model.jnt_bodyid[i]),
        "place": model.jnt_pos[i].tolist(),
        "axis": model.jnt_axis[i].tolist(),
        "range": model.jnt_range[i].tolist() if limited else None,
        "stiffness": float(model.jnt_stiffness[i].flat[0]),
        "damping": float(model.dof_damping[first]),
        "friction": float(model.dof_frictionloss[first]),
        "armature": float(model.dof_armature[first]),
        "effort": float(model.jnt_actfrcrange[i, 1]) if model.jnt_actfrclimited[i] else None,
        "line": _line(joint),
    }


def _shape(model: Any, geom: Any) -> dict[str, Any]:
    i = geom.id
    kind = _SHAPES.get(int(model.geom_type[i]), "unknown")
    collides = bool(model.geom_contype[i] or model.geom_conaffinity[i])
    points = None
    if kind == "mesh" and collides:
        mesh = int(model.geom_dataid[i])
        first, count = int(model.mesh_vertadr[mesh]), int(model.mesh_vertnum[mesh])
        points = model.mesh_vert[first : first + count].tolist()
    return {
        "name": geom.name or f"geom {i}",
        "kind": kind,
        "body": int(model.geom_bodyid[i]),
        "place": model.geom_pos[i].tolist(),
        "turn": model.geom_quat[i].tolist(),
        "size": model.geom_size[i].tolist(),
        "points": points,
        # In one dimension, a contact has no friction.
        "friction": float(model.geom_friction[i, 0]) if model.geom_condim[i] > 1 else 0.0,
        "priority": int(model.geom_priority[i]),
        "collides": collides,
        "moved": geom.surfacevel.tolist() if hasattr(geom, "surfacevel") else [0.0] * 6,
        "line": _line(geom),
    }


def _motor(model: Any, actuator: Any) -> dict[str, Any]:
    """Return what an actuator can do at its joint; None where it has no limit."""
    i = actuator.id
    gear = abs(float(model.actuator_gear[i, 0]))
    gain, bias = float(model.actuator_gainprm[i, 0]), model.actuator_biasprm[i]
    most = float(model.actuator_ctrlrange[i, 1]) if model.actuator_ctrllimited[i] else None
    effort = None
    if model.actuator_forcelimited[i]:
        effort = float(model.actuator_forcerange[i, 1]) * gear
    elif most is not None and not bias.any():  # a motor: its force is its control
        effort = most * gain * gear
    # A servo of speed holds control / gear; one of position has a bias on the position, too, and
    # holds a speed if it integrates its control.
    is_integrator = int(model.actuator_dyntype[i]) == _INTEGRATOR
    is_of_speed = not is_integrator and bias[2] < 0.0 and bias[1] == 0.0
    is_servo = is_integrator or is_of_speed
    return {
        "joint": actuator.target,
        "effort": effort,
        "damping": float(model.actuator_damping[i]) * gear**2,
        "armature": float(model.actuator_armature[i]) * gear**2,
        "gain": -float(bias[2]) * gear**2 if is_of_speed else None,
        "velocity": most / gear if is_servo and most is not None and gear > 0.0 else None,
        "line": _line(actuator),
    }


if __name__ == "__main__":
    serve(prepare)
