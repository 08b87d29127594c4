"""Read MJCF into a tree, by MuJoCo's own parser in a child process.

The child answers with plain data. It reads meshes and height maps only through the files of the
model, and MuJoCo itself opens none.
"""

from __future__ import annotations

import math
import os
import re
from collections.abc import Callable, Collection, Iterator
from functools import partial
from pathlib import PurePath
from typing import Any

import numpy as np

from crawler2d.common.extras import extra
from crawler2d.errors import ScenarioError
from crawler2d.model_tree import (
    Coupling,
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
from crawler2d.reading.files import LARGEST_TOGETHER, Files, reason_of
from crawler2d.reading.log import list_names
from crawler2d.reading.meshes import MOST_CORNERS, Meshes
from crawler2d.reading.parsing import Element, ask_child, no_more_files, serve
from crawler2d.reading.parts import (
    ON_ITS_OWN,
    Limit,
    collisions,
    ellipsoid,
    order_links,
    warn_of_tilt,
)
from crawler2d.reading.unused import warn_of_gravity, warn_of_unmoved

__all__ = ["read_mjcf"]

Item = dict[str, Any]
"""A part of a model as plain data."""

_LARGEST = 1e6  # [m, kg, ...] as in other formats; limits may be infinite
_SIZES = ("place", "center", "size", "points", "mass", "inertia", "surface_velocity")

# MuJoCo numbers the kinds of joints and shapes; others are refused as unknown.
_JOINTS = {0: "free", 1: "ball", 2: "slide", 3: "hinge"}

_SHAPES = {0: "plane", 1: "hfield", 2: "sphere", 3: "capsule", 4: "ellipsoid", 5: "cylinder"}
_SHAPES |= {6: "box", 7: "mesh"}
_GROUND = (0, 1)  # planes and height maps
_THICK = 0.001  # [m] Smaller margins are within the usual tolerance between the sides.
_SHARED = "is left out: these joints are read as without the motor that pulls at it"
_PASSIVE = "is left out: these joints are read as without its spring, damper, friction or limit"
_HELD = "is left out: it fixes the robot to the world, but the robot has to drive"
_CLOSED = "is left out: here joints alone hold these bodies"
_ELSEWHERE = "is left out: here motors turn joints, and push nothing else"
_ON_JOINTS = (0, 1)  # the numbers of transmissions to a joint
_ON_TENDON = 3  # to a tendon
_ON_SITES = (2, 4)  # and to a site
_OF_JOINT = 1  # the number of what a fixed tendon runs over
_BY_BODIES = (0, 1)  # the numbers of equations that hold bodies or sites
_BY_JOINTS = 2  # and of those of joints
_OF_SITES = 6  # the number of sites among objects
_OF_TENDONS = ("stiffness", "damping", "frictionloss", "limited")  # what acts at a passive one
_FLAGS = ("gravity", "contact", "actuation")  # can be disabled, but not here
_INTEGRATOR = 1  # the number of the dynamics of an actuator whose activation is a position


def read_mjcf(root: Element, text: str, model: str | None, meshes: Meshes) -> Tree:
    """Read the robot of an MJCF file: the bodies on one free joint, in the root's frame.

    Parameters
    ----------
    root : Element
        Of the file.
    text : str
        The whole text, parsed by MuJoCo.
    model : str, optional
        Name of the body with the free joint; None takes the only one.
    meshes : Meshes
        The rule for meshes, the warnings, and the files of the model.

    Raises
    ------
    ScenarioError
        If MuJoCo cannot compile it, or no body has a free joint.
    ImportError
        If MuJoCo is missing; the message names the extra to install.
    """
    for element in root.within():
        if element.tag in ("include", "model"):  # lines would be those of another file
            rule = "must contain the robot itself: read the file that is named, or copy it in here"
            element.refuse(element.attributes.get("file", ""), rule)
    file = root.where.file
    question = {"text": text, "file": file, "files": meshes.files.parameters}
    answer = ask_child(__name__, question, file=file, files=meshes.files)
    _check_numbers(answer, file)
    warn_of_unmoved(root, meshes.warnings)
    pairs = [each for contact in root.all("contact") for each in contact.all("pair")]
    if pairs:
        reason = "is not used: here surfaces have the friction of their geoms"
        meshes.warnings.append((pairs[0].at, f"{len(pairs)} of them", reason))
    for option in root.all("option"):
        if "gravity" in option.attributes:
            warn_of_gravity(option, "gravity", meshes.warnings)
        for flag in option.all("flag"):
            meshes.warnings.extend(
                (f"{flag.at}@{name}", "disable", "is not used: here it is enabled")
                for name in _FLAGS
                if flag.attributes.get(name) == "disable"
            )
            if flag.attributes.get("override") == "enable":
                reason = "is not used: here surfaces have the figures of their geoms"
                meshes.warnings.append((f"{flag.at}@override", "enable", reason))
    return _Model(answer, root.where, meshes).tree(model)


def prepare() -> Callable[[Item], Item]:
    """Import MuJoCo, in the child process."""
    mujoco = extra("mujoco", "models")
    return lambda question: _compile(mujoco, **question)


def _check_numbers(answer: Item, file: str) -> None:
    """Refuse numbers that no robot has, as in other formats, and rotations of length 0."""
    for kind in ("bodies", "joints", "shapes", "motors"):
        for item in answer[kind]:
            path = f"{file}:{item['line']}: {kind}[{item.get('name', '')}]"
            for name, value in item.items():
                numbers = np.array(value if isinstance(value, list) else [value]).ravel()
                if numbers.dtype.kind not in "fi":
                    continue
                most = np.abs(numbers).max(initial=0.0)
                if not most <= (_LARGEST if name in _SIZES else math.inf) or math.isnan(most):
                    rule = f"must be finite and at most {_LARGEST:g} in magnitude"
                    raise ScenarioError(f"{path}: {name}", float(most), rule)
                # The squares of too large numbers overflow, which leaves MuJoCo without a
                # direction.
                if name in ("turn", "axes") and not numbers.any():
                    raise ScenarioError(f"{path}: {name}", 0.0, "must be a rotation")


class _Model:
    """The conversion of the answer of the child to a tree."""

    def __init__(self, answer: Item, at: Where, meshes: Meshes) -> None:
        self.answer = answer
        self.at = at
        self.meshes = meshes
        self.corners = 0  # of all meshes
        every = (*answer["shapes"], *answer["lacking"])
        self.colliding: set[int] = {each["body"] for each in every if each["collides"]}
        self.bodies: list[Item] = answer["bodies"]
        self.joints: dict[int, list[Item]] = {}
        for joint in answer["joints"]:
            self.joints.setdefault(joint["body"], []).append(joint)
        self.motors: dict[str, Item] = {}
        for motor in (each for each in answer["motors"] if each["joint"]):
            own = self.motors.setdefault(motor["joint"], motor)
            if own is not motor:
                self.motors[motor["joint"]] = _together(own, motor)
                reason = "has several actuators: their torques are added up, as in MuJoCo"
                meshes.warnings.append((f"{self.where(motor)}: actuator", motor["joint"], reason))

    def where(self, item: Item) -> Where:
        return Where(self.at.file, item["line"] or self.at.line)

    def tree(self, name: str | None) -> Tree:
        root = self.root(name)
        body = self.bodies[root]
        path = f"{self.where(body)}: body[{body['name']}]"
        placed = from_quaternion(body["turn"], body["place"])
        warn_of_tilt(path, placed, "body", self.meshes.warnings)
        poses = {root: Pose()}
        joints: dict[str, Joint] = {}
        for number in self.subtree(root)[1:]:
            body = self.bodies[number]
            inner = from_quaternion(body["turn"], body["place"])
            poses[number] = poses[body["parent"]].then(inner)
            joints[body["name"]] = self.joint(number, poses[number])
        names = [(self.bodies[n]["name"], self.where(self.bodies[n])) for n in poses]
        ends = [(joint.name, joint.parent, joint.child, joint.at) for joint in joints.values()]
        order = order_links(names, ends, self.at, self.meshes.warnings)
        self.warn_of_ties(poses)
        links = [self.link(number, pose) for number, pose in poses.items()]
        return Tree(
            name=self.answer["name"],
            format="MJCF",
            file=self.at.file,
            links=tuple(sorted(links, key=lambda link: order.index(link.name))),
            joints=joints,
            driven={name: self.where(motor) for name, motor in self.motors.items()},
            held={
                motor["joint"]: self.where(motor)
                for motor in self.answer["motors"]
                if motor["joint"] and motor["holds"]
            },
            couplings=tuple(
                Coupling(
                    joints=tuple(each["joints"]),
                    name=f"{each['kind']}[{each['name']}]",
                    value=list_names(each["joints"]),
                    reason=each["reason"],
                    at=self.where(each),
                )
                for each in self.answer["couplings"]
            ),
            floors=tuple(self.floors()),
            at=self.at,
        )

    def warn_of_ties(self, bodies: Collection[int]) -> None:
        """Warn of equations and actuators that act on the robot's bodies, not on joints."""
        for each in self.answer["holds"]:
            held = [body in bodies for body in each["bodies"]]
            if any(held):
                path = f"{self.where(each)}: equality[{each['name']}]"
                reason = _CLOSED if all(held) else _HELD
                self.meshes.warnings.append((path, list_names(each["ends"]), reason))
        wide = [
            each
            for each in self.answer["shapes"]
            if each["body"] in bodies and each["collides"] and each["margin"] > _THICK
        ]
        if wide:
            most = max(wide, key=lambda each: each["margin"])
            path = f"{self.where(most)}: geom[{most['name']}]@margin"
            value = f"up to {most['margin']:g} m, of {len(wide)} geoms"
            reason = "is not used: in MuJoCo they stand off the ground by as much"
            self.meshes.warnings.append((path, value, reason))
        for motor in self.answer["motors"]:
            if motor["body"] in bodies:
                path = f"{self.where(motor)}: actuator[{motor['name']}]"
                self.meshes.warnings.append((path, motor["target"], _ELSEWHERE))

    def floors(self) -> list[Limit]:
        """[-] Return the friction of the ground: of planes and height maps, or of all that stands.

        A file without ground has none.
        """
        still = [each for each in self.answer["shapes"] if each["body"] == 0 and each["collides"]]
        ground = [each for each in still if each["kind"] in ("plane", "hfield")]
        return [(each["friction"], self.where(each)) for each in ground or still]

    def root(self, name: str | None) -> int:
        """Return the body with the free joint."""
        floating = [
            number
            for number, joints in self.joints.items()
            if [joint["kind"] for joint in joints] == ["free"]
        ]
        if name is not None:
            names = [self.bodies[number]["name"] for number in floating]
            if name not in names:
                raise ScenarioError("model", name, f"must be one of {', '.join(names[:10])}")
            return floating[names.index(name)]
        driving = [n for n in floating if len(floating) == 1 or self.drives(n)]
        if len(driving) != 1:
            rule = (
                "must have one body with a free joint, or one of several with wheels or moved"
                " surfaces: model= names it"
            )
            names = [self.bodies[number]["name"] for number in driving or floating]
            raise ScenarioError(str(self.at), ", ".join(names[:10]) or "none", rule)
        return driving[0]

    def subtree(self, root: int) -> list[int]:
        """Return a body and its descendants, parents before their children."""
        numbers = {root: None}
        for number, body in enumerate(self.bodies):
            if number and body["parent"] in numbers:
                numbers[number] = None
        return list(numbers)

    def drives(self, root: int) -> bool:
        """Whether a body has parts that turn without limit, or moving surfaces."""
        on = self.subtree(root)
        joints = [joint for number in on for joint in self.joints.get(number, [])]
        turns = any(joint["kind"] == "hinge" and not joint["range"] for joint in joints)
        shapes = [shape for shape in self.answer["shapes"] if shape["body"] in on]
        return turns or any(any(shape["surface_velocity"]) for shape in shapes)

    def joint(self, number: int, pose: Pose) -> Joint:
        body = self.bodies[number]
        child, parent = body["name"], self.bodies[body["parent"]]["name"]
        joints = self.joints.get(number, [])
        if len(joints) > 1:
            path, rule = f"{self.where(body)}: body[{child}]", "must have at most one joint"
            value = f"{len(joints)} joints"
            if self.colliding.intersection(self.subtree(number)):
                raise ScenarioError(path, value, rule)
            reason = f"is taken as fixed, as nothing on its joints collides: {rule}"
            self.meshes.warnings.append((path, value, reason))
        if len(joints) != 1:
            return Joint(
                name=f"of {child}",
                kind="fixed",
                parent=parent,
                child=child,
                place=pose.place,
                axis=pose.turn[:, 2],
                at=self.where(body),
            )
        (joint,) = joints
        motor = self.motors.get(joint["name"], {})
        lower, upper = joint["range"] or (-math.inf, math.inf)
        axis = unit(pose.along(joint["axis"]))
        joint_at, motor_at = self.where(joint), self.where(motor or joint)
        limits = [(joint["effort"], joint_at), (motor.get("effort"), motor_at)]
        limits = [limit for limit in limits if limit[0] is not None and limit[0] >= 0.0]
        effort, effort_at = min(limits, key=lambda limit: limit[0], default=(None, joint_at))
        return Joint(
            name=joint["name"],
            kind=joint["kind"],
            parent=parent,
            child=child,
            place=pose.at(joint["place"]),
            axis=pose.turn[:, 2] if axis is None else axis,
            lower=lower,
            upper=upper,
            effort=effort,
            velocity=motor.get("velocity"),
            stiffness=joint["stiffness"],
            damping=joint["damping"] + motor.get("damping", 0.0),
            friction=joint["friction"],
            armature=joint["armature"] + motor.get("armature", 0.0),
            gain=motor.get("gain"),
            at=joint_at,
            effort_at=effort_at,
            velocity_at=motor_at,
            gain_at=motor_at,
        )

    def link(self, number: int, pose: Pose) -> Link:
        body = self.bodies[number]
        axes = pose.then(from_quaternion(body["axes"], body["center"]))
        own = [self.shape(s, pose) for s in self.answer["shapes"] if s["body"] == number]
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
        )

    def lacking(self, number: int) -> Iterator[Unread]:
        """Yield the colliding geoms that a body lacks; warn of a lack of mass."""
        for each in self.answer["lacking"]:
            if each["body"] == number:
                geom = self.element(each)
                if each["weighs"]:
                    reason = "has no mass here, but its volume counts in MuJoCo"
                    self.meshes.warnings.append((geom.at, each["file"], reason))
                if each["collides"]:
                    yield self.meshes.missing(geom, each["file"], each["reason"])

    def element(self, item: Item) -> Element:
        """Return an element with the name and line of a geom, for errors."""
        return Element("geom", {"name": item["name"]}, None, self.where(item))

    def shape(self, item: Item, body: Pose) -> Shape | Unread | None:
        if not item["collides"]:
            return None
        at, geom = self.where(item), self.element(item)
        kind, sizes = item["kind"], item["size"]
        pose = body.then(from_quaternion(item["turn"], item["place"]))
        points = np.zeros((0, 3))
        if kind == "mesh":
            self.corners += len(item["points"])
            if self.meshes.rule != "hull" or self.corners > MOST_CORNERS:
                reason = f"must, with the other meshes, have at most {MOST_CORNERS} corners"
                return self.meshes.missing(geom, item["name"], reason)
            kind, points = "hull", pose.at(np.array(item["points"], dtype=float).reshape(-1, 3))
        elif kind == "ellipsoid":
            kind, points = "hull", pose.at(ellipsoid(sizes))
        elif kind not in ("box", "cylinder", "capsule", "sphere"):
            return self.meshes.leave_out(geom, kind, "unsupported shape")
        is_round = kind in ("cylinder", "capsule", "sphere")
        # A surface moves as given, or by turning at its radius. A box or hull has no radius: only
        # that it moves counts, and its drums have the speed.
        velocity, lever = item["surface_velocity"], sizes[0] if is_round else 1.0
        return Shape(
            name=item["name"],
            kind=kind,
            pose=pose,
            radius=sizes[0] if is_round else 0.0,
            length=2.0 * sizes[1] if kind in ("cylinder", "capsule") else 0.0,
            size=2.0 * np.array(sizes) if kind == "box" else np.zeros(3),
            points=points,
            friction=Friction(
                first=item["friction"],
                second=item["friction"],
                priority=item["priority"],
                first_at=at,
                second_at=at,
            ),
            surface_speed=max(math.hypot(*velocity[:3]), math.hypot(*velocity[3:]) * lever),
            at=at,
        )


def _together(first: Item, second: Item) -> Item:
    """Return two actuators of one joint as one, at whose joint their forces add up."""
    both = {k: [each[k] for each in (first, second) if each[k] is not None] for k in first}
    return {
        **first,
        **{name: sum(both[name]) for name in ("damping", "armature")},
        "effort": sum(both["effort"]) if len(both["effort"]) > 1 else None,
        "gain": sum(both["gain"]) if both["gain"] else None,
        "velocity": min(both["velocity"], default=None),
    }


def _compile(mujoco: Any, *, text: str, file: str, files: Item) -> Item:
    lacking: list[tuple[Any, Item, ScenarioError]] = []
    try:
        with no_more_files():
            spec = mujoco.MjSpec.from_string(text)
        _remove_textures(spec)
        lacking = list(_load_assets(spec, Files(**files), file))
        with no_more_files():
            model = spec.compile()
    except ScenarioError:
        raise
    except Exception as error:  # MuJoCo has several classes of errors for a bad file
        if lacking:  # without it, perhaps nothing gives a body its mass
            raise lacking[0][2] from None
        said = " ".join(str(error).split())
        line = re.search(r"line (\d+)", said)
        at = f"{file}:{line[1]}" if line else file
        raise ScenarioError(at, said, "must be a model that MuJoCo compiles") from None
    parts: dict[str, tuple[Callable[[Any, Any], Item], Any]] = {
        "bodies": (_body, spec.bodies),
        "joints": (_joint, spec.joints),
        "shapes": (partial(_shape, _ground(model)), spec.geoms),
        "motors": (_motor, spec.actuators),
    }
    return {
        "name": spec.modelname,
        "lacking": [{"body": body.id, **geom} for body, geom, _ in lacking],
        **{name: [part(model, each) for each in items] for name, (part, items) in parts.items()},
        "couplings": [*_tendons(model, spec), *_equations(spec)],
        "holds": list(_holds(model, spec)),
    }


def _remove_textures(spec: Any) -> None:
    """Remove visual parts, so that their files are not needed."""
    for material in spec.materials:
        material.textures = [""] * len(material.textures)
    for kind in (spec.textures, spec.skins):
        for item in list(kind):
            spec.delete(item)


def _load_assets(spec: Any, files: Files, file: str) -> Iterator[tuple[Any, Item, ScenarioError]]:
    """Read the meshes and height maps of a model, and give MuJoCo their contents by name.

    Unreadable ones are removed from the model with their geoms, and each geom is yielded with its
    body and the error.
    """
    folder, spec.meshdir = spec.meshdir, ""
    lowest, highest = spec.compiler.inertiagrouprange
    for kind, attribute in (("meshes", "meshname"), ("hfields", "hfieldname")):
        for item in list(getattr(spec, kind)):
            if not item.file:
                continue
            inner = PurePath(item.file).name if spec.strippath else item.file
            place = os.path.join(folder, inner)
            try:
                at = f"{file}:{_line(item)}: {kind}[{item.name}]"
                data = files.read(place, at=at, most=LARGEST_TOGETHER)
            except ScenarioError as error:
                for geom in [g for g in spec.geoms if getattr(g, attribute) == item.name]:
                    body = geom.parent
                    counts = not body.explicitinertial and lowest <= geom.group <= highest
                    weight = geom.density if math.isnan(geom.mass) else geom.mass
                    what = {
                        "name": geom.name,
                        "file": place,
                        "reason": reason_of(error),
                        "collides": bool(geom.contype or geom.conaffinity),
                        "weighs": bool(counts and weight > 0.0),
                        "line": _line(geom),
                    }
                    spec.delete(geom)
                    yield body, what, error
                spec.delete(item)
            else:
                item.file = f"{len(spec.assets)}{PurePath(item.file).suffix}"
                spec.assets[item.file] = data


def _line(item: Any) -> int:
    """Return the line that MuJoCo noted for an item of the file; 0 for what it added itself."""
    match = re.search(r"line (\d+)", item.info)
    return int(match[1]) if match else 0


def _body(model: Any, body: Any) -> Item:
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


def _joint(model: Any, joint: Any) -> Item:
    i = joint.id
    first = int(model.jnt_dofadr[i])  # the only one of hinges and slides
    return {
        "name": joint.name or f"joint {i}",
        "kind": _JOINTS.get(int(model.jnt_type[i]), "unknown"),
        "body": int(model.jnt_bodyid[i]),
        "place": model.jnt_pos[i].tolist(),
        "axis": model.jnt_axis[i].tolist(),
        "range": model.jnt_range[i].tolist() if model.jnt_limited[i] else None,
        "stiffness": float(model.jnt_stiffness[i].flat[0]),
        "damping": float(model.dof_damping[first]),
        "friction": float(model.dof_frictionloss[first]),
        "armature": float(model.dof_armature[first]),
        "effort": float(model.jnt_actfrcrange[i, 1]) if model.jnt_actfrclimited[i] else None,
        "line": _line(joint),
    }


def _shape(ground: set[tuple[int, int]], model: Any, geom: Any) -> Item:
    i = geom.id
    kind = _SHAPES.get(int(model.geom_type[i]), "unknown")
    # A contact of dimension 1 has no friction. The ground has dimension 3, and the larger one
    # applies, unless the geom has the higher priority.
    priority = int(model.geom_priority[i])
    is_smooth = priority > 0 and int(model.geom_condim[i]) == 1
    collides = _touches_ground(model, i, ground)
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
        "friction": 0.0 if is_smooth else float(model.geom_friction[i, 0]),
        "priority": priority,
        "collides": collides,
        "margin": float(model.geom_margin[i]),
        "surface_velocity": geom.surfacevel.tolist() if hasattr(geom, "surfacevel") else [0.0] * 6,
        "line": _line(geom),
    }


def _ground(model: Any) -> set[tuple[int, int]]:
    """Return the bits of the ground: of planes and height maps, or else of all that stands."""
    still = [i for i in range(model.ngeom) if model.geom_bodyid[i] == 0 and any(_bits(model, i))]
    ground = [i for i in still if int(model.geom_type[i]) in _GROUND] or still
    return {_bits(model, each) for each in ground}


def _touches_ground(model: Any, geom: int, ground: set[tuple[int, int]]) -> bool:
    """Whether a geom collides with the ground of the file, or with anything if it has none."""
    own, body = _bits(model, geom), int(model.geom_bodyid[geom])
    if body == 0 or not ground:
        return any(own)
    if body in model.exclude_signature:  # of a pair with the world, whose number is 0
        return False
    return any(own[0] & other[1] or own[1] & other[0] for other in ground)


def _bits(model: Any, geom: int) -> tuple[int, int]:
    """Return the bits that say with which others a geom collides."""
    return int(model.geom_contype[geom]), int(model.geom_conaffinity[geom])


def _motor(model: Any, actuator: Any) -> Item:
    """Return the limits of an actuator at its joint; None where it has none."""
    i = actuator.id
    gear = abs(float(model.actuator_gear[i, 0]))
    gain, bias = float(model.actuator_gainprm[i, 0]), model.actuator_biasprm[i]
    most = float(model.actuator_ctrlrange[i, 1]) if model.actuator_ctrllimited[i] else None
    limits = []
    if model.actuator_forcelimited[i]:
        limits.append(float(model.actuator_forcerange[i, 1]))
    if most is not None and not bias.any():  # a motor: a gain times control
        limits += [force for force in (gain * most,) if force > 0.0]
    # A servo of speed holds control / gear, times its gain by that of its bias; one of position has
    # a bias on the position, too, and holds a speed if it integrates its control.
    is_integrator = int(model.actuator_dyntype[i]) == _INTEGRATOR
    kind, on = int(model.actuator_trntype[i]), int(model.actuator_trnid[i, 0])
    is_of_speed = not is_integrator and bias[2] < 0.0 and bias[1] == 0.0
    held = float(bias[1] if is_integrator else bias[2])
    has_speed = (is_of_speed or (is_integrator and held < 0.0)) and most is not None and gear > 0.0
    return {
        "name": actuator.name,
        "target": actuator.target,
        "joint": actuator.target if kind in _ON_JOINTS else "",
        "body": _body_under(model, kind, on),
        "effort": min(limits) * gear if limits else None,
        "damping": float(model.actuator_damping[i]) * gear**2,
        "armature": float(model.actuator_armature[i]) * gear**2,
        "gain": -float(bias[2]) * gear**2 if is_of_speed else None,
        "holds": not is_integrator and bool(bias[1] < 0.0),
        "velocity": abs(gain / held) * most / gear if has_speed and most is not None else None,
        "line": _line(actuator),
    }


def _body_under(model: Any, kind: int, number: int) -> int | None:
    """Return the body on which an actuator acts directly; None for one of a joint or tendon."""
    if kind in _ON_SITES:
        return int(model.site_bodyid[number])
    return None if kind in (*_ON_JOINTS, _ON_TENDON) else number


def _tendons(model: Any, spec: Any) -> Iterator[Item]:
    """Yield the fixed tendons that pull at joints: those with an actuator, and passive ones."""
    names = {joint.id: joint.name or f"joint {joint.id}" for joint in spec.joints}
    over: dict[int, list[str]] = {}
    for tendon in spec.tendons:
        first, count = int(model.tendon_adr[tendon.id]), int(model.tendon_num[tendon.id])
        wraps = [i for i in range(first, first + count) if model.wrap_type[i] == _OF_JOINT]
        over[tendon.id] = [names[int(model.wrap_objid[i])] for i in wraps]
        figures = (getattr(model, f"tendon_{each}") for each in _OF_TENDONS)
        if any(np.any(figure[tendon.id]) for figure in figures):
            what = {"kind": "tendon", "name": tendon.name, "line": _line(tendon)}
            yield {**what, "joints": over[tendon.id], "reason": _PASSIVE}
    for actuator in spec.actuators:
        if int(model.actuator_trntype[actuator.id]) == _ON_TENDON:
            number = int(model.actuator_trnid[actuator.id, 0])
            what = {"kind": "tendon", "name": actuator.target, "line": _line(actuator)}
            yield {**what, "joints": over[number], "reason": _SHARED}


def _equations(spec: Any) -> Iterator[Item]:
    """Yield the equations of a joint, which follows another one or stands still."""
    for each in spec.equalities:
        if int(each.type) == _BY_JOINTS and each.active:
            what = {"kind": "equality", "name": each.name or each.name1, "line": _line(each)}
            joints = [name for name in (each.name1, each.name2) if name]
            yield {**what, "joints": joints, "reason": ON_ITS_OWN}


def _holds(model: Any, spec: Any) -> Iterator[Item]:
    """Yield the equations that hold two bodies together, with the bodies."""
    for each in spec.equalities:
        if int(each.type) in _BY_BODIES and each.active:
            bodies = [int(model.eq_obj1id[each.id]), int(model.eq_obj2id[each.id])]
            if int(model.eq_objtype[each.id]) == _OF_SITES:
                bodies = [int(model.site_bodyid[site]) for site in bodies]
            ends = [each.name1 or "world", each.name2 or "world"]
            what = {"name": each.name or ends[0], "line": _line(each)}
            yield {**what, "bodies": bodies, "ends": ends}


if __name__ == "__main__":
    serve(prepare)
