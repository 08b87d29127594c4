"""SDF 1.4 to 1.11 as a neutral tree: one model, by itself or in a world, with its frames."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cached_property

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
    from_rpy,
    unit,
)
from crawler2d.reading.elements import Element, real
from crawler2d.reading.log import Doubt
from crawler2d.reading.meshes import Meshes
from crawler2d.reading.parts import (
    carrying,
    checked,
    collisions,
    driven_by,
    inertia,
    joint_of,
    moving,
    named_tracks,
    plugin_of,
    settled,
    shape_of,
    solid,
)

__all__ = ["MODEL", "read_sdf"]

MODEL = "__model__"


def pose_of(element: Element, doubts: list[Doubt]) -> tuple[Pose, str]:
    """Read the pose of an element, and the name of the frame that it is given in, if any."""
    pose = element.first("pose", doubts)
    if pose is None or not (pose.text or pose.attributes):
        return Pose(), ""
    relative = pose.attributes.get("relative_to", "")
    if not pose.text:
        return Pose(), relative
    form = pose.attributes.get("rotation_format", "euler_rpy")
    if form == "quat_xyzw":
        x, y, z, *xyzw = pose.reals(7)
        if math.hypot(*xyzw) < 1e-6:
            pose.refuse(pose.text, "must have a quaternion that is not 0")
        return from_quaternion((xyzw[3], *xyzw[:3]), (x, y, z)), relative
    if form != "euler_rpy":
        pose.refuse(form, "must be euler_rpy or quat_xyzw", "@rotation_format")
    numbers = pose.reals(6)
    if pose.attributes.get("degrees", "false") in ("true", "1"):
        numbers[3:] = [math.radians(angle) for angle in numbers[3:]]
    return from_rpy(numbers[3:], numbers[:3]), relative


@dataclass(slots=True)
class Frames:
    """Poses by name in the frame of the model, worked out when asked for.

    What is in a nested model has names of its own: its scope, such as ``arm::``, goes before them.
    """

    doubts: list[Doubt]
    given: dict[str, tuple[Pose, str, Element]] = field(default_factory=dict)
    known: dict[str, Pose] = field(default_factory=lambda: {MODEL: Pose()})

    def add(self, name: str, element: Element, usual: str, scope: str) -> None:
        """Add a frame, given in the one that it names, or else in the usual one."""
        pose, relative = pose_of(element, self.doubts)
        within = scope + relative if relative else usual
        self.given.setdefault(name, (pose, within, element))

    def of(self, name: str, asked: Element) -> Pose:
        """Return the pose of a frame.

        Raises
        ------
        ScenarioError
            If there is no such frame, or it is given in itself by way of others.
        """
        chain: list[str] = []
        waiting: set[str] = set()
        while name not in self.known:
            if name not in self.given:
                asked.refuse(name, "must name a link, joint or frame of the model")
            if name in waiting:
                asked.refuse(name, "must not be a frame that is given in itself")
            chain.append(name)
            waiting.add(name)
            _, name, asked = self.given[name]
        for name in reversed(chain):
            pose, within, _ = self.given[name]
            self.known[name] = self.known[within].then(pose)
        return self.known[name] if not chain else self.known[chain[0]]

    def inside(self, element: Element, usual: str, scope: str) -> Pose:
        """Return the pose of something that is no frame itself, such as a collision."""
        pose, relative = pose_of(element, self.doubts)
        return self.of(scope + relative if relative else usual, element).then(pose)


# What SDF takes where a file says nothing: a link of 1 kg, a friction of 1.
_USUAL_MASS = _USUAL_FRICTION = 1.0
_USUAL_DENSITY = 1000.0  # [kg/m^3] Where masses are to be worked out: that of water.

_DYNAMICS = {"stiffness": "spring_stiffness", "damping": "damping", "friction": "friction"}

_LONGEST_CHAIN = 100  # Frames, each of which is attached to the next.


def read_sdf(root: Element, model: str | None, meshes: Meshes, doubts: list[Doubt]) -> Tree:
    """Read one model.

    Parameters
    ----------
    root : Element
        Of the file.
    model : str, optional
        Name of the model; None takes the only one that is not static, or of several the only one
        that can drive.
    meshes : Meshes
        What is done with meshes.
    doubts : list of Doubt
        Where to note what is left out.

    Returns
    -------
    Tree
        The model.

    Raises
    ------
    ScenarioError
        If anything breaks a rule of the format, or needs what this file does not hold.
    """
    version = root.attributes.get("version", "")
    found = re.fullmatch(r"1\.(\d{1,2})", version, re.ASCII)
    minor = int(found[1]) if found else 0
    if not 4 <= minor <= 11:
        cure = '"gz sdf -p FILE" writes a file of an older version anew'
        root.refuse(version or "none", f"must be of version 1.4 to 1.11; {cure}", "@version")
    chosen = _chosen(root, model)
    meshes.find(
        {
            uri.text: mesh
            for collision in chosen.within()
            if collision.tag == "collision"
            for mesh in collision.within()
            if mesh.tag == "mesh"
            for uri in mesh.all("uri")
        }
    )
    return _Model(chosen, minor, meshes, doubts).tree()


def _chosen(root: Element, name: str | None) -> Element:
    """Return the model of a name, or the only one that moves, or the only one that can drive."""
    models = [*root.all("model"), *(m for world in root.all("world") for m in world.all("model"))]
    if name is not None:
        named = [m for m in models if m.attributes.get("name") == name]
        if len(named) != 1:
            raise ScenarioError("model", name, f"must be one of {_names(models)}")
        return named[0]
    moving = [m for m in models if _flag(m, "static") is not True]
    driving = [m for m in moving if len(moving) == 1 or _drives(m)]
    if len(driving) != 1:
        rule = (
            "must hold one model that is not static, or one of several with wheels or moved tracks:"
            " model= names it; what a world includes is read from its own file"
        )
        root.refuse(_names(driving or moving) or "none", rule)
    return driving[0]


def _drives(model: Element) -> bool:
    """Whether a model has joints that turn without limit, or a plugin that moves tracks."""
    plugins = tuple(plugin_of(each) for each in model.within() if each.tag == "plugin")
    return any(named_tracks(plugins)) or any(
        _turns(joint) for joint in model.within() if joint.tag == "joint"
    )


def _turns(joint: Element) -> bool:
    """Whether a joint turns twice or more, as those of wheels do."""
    lower, upper = (
        unlimited if found is None else real(found, found.text, unlimited=True)
        for found, unlimited in (
            (joint.only("axis/limit/lower"), -math.inf),
            (joint.only("axis/limit/upper"), math.inf),
        )
    )
    kind = joint.attributes.get("type")
    return kind == "continuous" or (kind == "revolute" and upper - lower >= 4.0 * math.pi)


def _names(models: list[Element]) -> str:
    return ", ".join(model.attributes.get("name", "")[:40] for model in models[:10])


def _flag(element: Element, tag: str) -> bool | None:
    found = element.only(tag)
    return None if found is None else found.text.lower() in ("1", "true")


@dataclass(frozen=True, slots=True)
class _Part:
    """A link, joint or frame, with the scope of the nested model that it is in."""

    element: Element
    scope: str

    @property
    def name(self) -> str:
        return self.scope + self.element.attribute("name")


class _Model:
    """One model on its way to a tree: its frames are needed at every step."""

    def __init__(self, model: Element, minor: int, meshes: Meshes, doubts: list[Doubt]) -> None:
        self.model = model
        self.minor = minor
        self.meshes = meshes
        self.doubts = doubts
        self.frames = Frames(doubts)
        self.models = list(self.nested(model, ""))
        self.has_includes = bool(self.parts("include"))
        self.links = {part.name: part for part in self.parts("link")}

    def nested(self, model: Element, scope: str) -> Iterator[_Part]:
        """Yield a model and those in it; what is in other files is left out."""
        yield _Part(model, scope)
        for include in model.all("include"):
            name = (include.only("name") or include.only("uri") or include).text
            reason = "is left out: it is in another file; what it carries weighs nothing here"
            self.doubts.append((include.at, name, reason))
        for inner in model.all("model"):
            within = f"{scope}{inner.attribute('name')}::"
            self.frames.add(within + MODEL, inner, scope + MODEL, scope)
            yield from self.nested(inner, within)

    def parts(self, tag: str) -> list[_Part]:
        return [
            _Part(element, each.scope) for each in self.models for element in each.element.all(tag)
        ]

    def tree(self) -> Tree:
        joints = {}
        ends = []
        for part in self.parts("joint"):
            found = self.ends(part)
            if found is not None:
                joints[found[1]] = part
                ends.append((part.name, *found, part.element.where))
        plugins = tuple(plugin_of(part.element) for part in self.parts("plugin"))
        turning = [child for child, part in joints.items() if _turns(part.element)]
        order = checked(
            [(part.name, part.element.where) for part in self.parts("link")],
            ends,
            self.model.where,
            self.doubts,
            driving=[*turning, *(name for name, _ in named_tracks(plugins))],
        )
        for name, part in self.links.items():
            self.frames.add(name, part.element, part.scope + MODEL, part.scope)
        for name, _, child, _ in ends:
            part = joints[child]
            held = part.scope + part.element.needed("child").text  # which may be a frame of it
            self.frames.add(name, part.element, held, part.scope)
        for part in self.parts("frame"):
            attached = part.element.attributes.get("attached_to", "") or MODEL
            self.frames.add(part.name, part.element, part.scope + attached, part.scope)
        parent_of = {child: parent for _, parent, child, _ in ends if child in order}
        made = [self.link(self.links[name]) for name in order]
        colliding = [link.name for link in made if link.shapes or link.unread]
        carriers = carrying(order, parent_of, colliding)
        return Tree(
            name=self.model.attributes.get("name", ""),
            format=f"SDF 1.{self.minor}",
            file=self.model.where.file,
            links=tuple(made),
            joints={
                child: self.joint(joints[child], parent, child, carries=child in carriers)
                for child, parent in parent_of.items()
            },
            plugins=plugins,
            driven=driven_by(plugins),
            at=self.model.where,
        )

    def ends(self, part: _Part) -> tuple[str, str] | None:
        """Return the links that a joint joins; None if it is left out."""
        joint = part.element
        parent, child = (joint.needed(end).text for end in ("parent", "child"))
        ends = self.carrier(part.scope + parent), self.carrier(part.scope + child)
        reason = ""
        if "world" in (parent, child):
            reason = "it holds the robot to the world, where it is to drive"
        elif joint.attribute("type") == "gearbox":
            reason = "it couples joints, and carries nothing"
        elif self.has_includes and not self.links.keys() >= set(ends):
            reason = "what it joins is in another file"
        if reason:
            self.doubts.append((joint.at, part.name, f"is left out: {reason}"))
            return None
        return ends

    def carrier(self, name: str) -> str:
        """Return the link that a frame or a nested model is attached to; or else the name."""
        for _ in range(_LONGEST_CHAIN):  # what is longer is a circle, and ends at no link
            if name not in self.attached:
                break
            name = self.attached[name]
        return name

    @cached_property
    def attached(self) -> dict[str, str]:
        """What frames and models are attached to: models to their first link."""
        found = {
            each.scope + MODEL: each.scope + link.attribute("name")
            for each in self.models
            for link in reversed(list(each.element.all("link")))
        }
        found |= {each.scope[:-2]: each.scope + MODEL for each in self.models if each.scope}
        for part in self.parts("frame"):
            to = part.element.attributes.get("attached_to", "") or MODEL
            found.setdefault(part.name, part.scope + to)
        return found

    def link(self, part: _Part) -> Link:
        link, name = part.element, part.name
        pose = self.frames.of(name, link)
        mass, center, tensor, mass_at = _USUAL_MASS, Pose(), Pose().turn, link.where
        shapes, unread = collisions(self.shape(c, part) for c in link.all("collision"))
        inertial = link.first("inertial", self.doubts)
        is_auto = inertial is not None and inertial.attributes.get("auto", "") in ("1", "true")
        if inertial is not None and not is_auto:
            mass = inertial.real("mass", _USUAL_MASS)
            found = inertial.only("mass")
            mass_at = inertial.where if found is None else found.where
            center = self.frames.inside(inertial, name, part.scope)
            given = inertial.only("inertia")
            if given is not None:
                values = given
                tensor = inertia(
                    given,
                    lambda word: values.real(word, 1.0 if word[1] == word[2] else 0.0),
                    self.doubts,
                )
        if mass < 0.0:
            link.refuse(mass, "must have a mass >= 0 kg")
        frame = center if inertial is not None else pose
        place, tensor = frame.place, frame.turn @ tensor @ frame.turn.T
        if inertial is not None and is_auto:
            if unread or any(shape.kind == "hull" for shape in shapes) or not shapes:
                rule = "must state mass and inertia, or be of boxes, cylinders, capsules, spheres"
                inertial.refuse("auto", rule)
            mass_at = inertial.where
            mass, place, tensor = solid(shapes, inertial.real("density", _USUAL_DENSITY))
        return Link(
            name=name,
            pose=pose,
            mass=mass,
            center=place,
            inertia=tensor,
            shapes=shapes,
            unread=unread,
            at=link.where,
            pose_at=next(link.all("pose"), link).where,
            mass_at=mass_at,
        )

    def shape(self, collision: Element, part: _Part) -> Shape | Unread | None:
        bitmask = collision.only("surface/contact/collide_bitmask")
        if bitmask is not None and re.fullmatch(r"0x0+|0+", bitmask.text):
            return None  # it meets nothing
        pose = self.frames.inside(collision, part.name, part.scope)
        return shape_of(
            collision,
            name=collision.attributes.get("name", part.name),
            pose=pose,
            pose_at=next(collision.all("pose"), collision),
            friction=self.friction(collision, pose, part.scope),
            numbers=lambda element, name, count: element.needed(name).reals(count),
            mesh_name=lambda mesh: mesh.needed("uri").text,
            meshes=self.meshes,
        )

    def friction(self, collision: Element, pose: Pose, scope: str) -> Friction | None:
        ode = collision.only("surface/friction/ode")
        if ode is None:
            return None
        first, second = (_coefficient(ode, name) for name in ("mu", "mu2"))
        direction = ode.only("fdir1")
        along = None
        if direction is not None:
            for prefix in ("gz", "ignition"):
                frame = direction.attributes.get(f"{prefix}:expressed_in", "")
                pose = self.frames.of(scope + frame, direction) if frame else pose
            along = unit(pose.along(direction.reals(3)))
        return Friction(
            first=first[0],
            second=second[0],
            direction=along,
            first_at=first[1],
            second_at=second[1],
        )

    def joint(self, part: _Part, parent: str, child: str, *, carries: bool) -> Joint:
        made = joint_of(
            part.element, part.name, parent, child, self.frames.of(part.name, part.element)
        )
        if made.kind == "fixed":
            return made
        return settled(made, lambda: self.moving(made, part), carries=carries, doubts=self.doubts)

    def moving(self, made: Joint, part: _Part) -> Joint:
        joint = part.element
        axis = joint.only("axis")
        if axis is None:
            if made.kind in ("hinge", "slide"):
                joint.refuse("none", "must have an axis")
            return made
        xyz = axis.only("xyz")
        frame = self.frames.of(made.name, joint)
        if xyz is not None and xyz.attributes.get("expressed_in", ""):
            frame = self.frames.of(part.scope + xyz.attributes["expressed_in"], xyz)
        elif self.minor == 4 or (self.minor <= 6 and _flag(axis, "use_parent_model_frame")):
            frame = self.frames.of(part.scope + MODEL, axis)
        limit = axis.only("limit")
        values = {
            each.tag: (real(each, each.text, unlimited=True), each.where)
            for each in (() if limit is None else limit.children)
            if each.tag in ("lower", "upper", "effort", "velocity")
        }
        return moving(
            made,
            axis,
            frame.along((0.0, 0.0, 1.0) if xyz is None else xyz.reals(3)),
            bounds=(
                values["lower"][0] if "lower" in values else -math.inf,
                values["upper"][0] if "upper" in values else math.inf,
            ),
            effort=values.get("effort"),
            velocity=values.get("velocity"),
            dynamics={
                name: (real(found, found.text, unlimited=True), found.where)
                for name, tag in _DYNAMICS.items()
                if (found := axis.only(f"dynamics/{tag}")) is not None
            },
        )


def _coefficient(ode: Element, name: str) -> tuple[float, Where]:
    found = ode.only(name)
    if found is None:
        return _USUAL_FRICTION, ode.where
    value = real(found, found.text, unlimited=True)
    if value < 0.0:
        found.refuse(value, "must be >= 0")
    return value, found.where
