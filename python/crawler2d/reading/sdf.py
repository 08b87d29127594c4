"""Read one model of an SDF 1.4 to 1.12 file, by itself or in a world, as a neutral tree."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import cached_property, partial

import numpy as np

from crawler2d.errors import ScenarioError
from crawler2d.model_tree import (
    TWO_TURNS,
    Array,
    Friction,
    Joint,
    Link,
    Pose,
    Shape,
    Tree,
    Unread,
    from_quaternion,
    from_rpy,
    unit,
)
from crawler2d.reading.log import ReadingWarning
from crawler2d.reading.meshes import Meshes
from crawler2d.reading.parsing import Element, real
from crawler2d.reading.parts import (
    Limit,
    coefficient,
    collision_ancestors,
    collisions,
    driven_by,
    inertia,
    joint_of,
    joint_or_fixed,
    mimic_coupling,
    moving_joint,
    named_tracks,
    order_links,
    plugin_of,
    shape_of,
    slips_of,
    solid,
    warn_of_tilt,
)
from crawler2d.reading.unused import warn_of_gravity, warn_of_unmoved

__all__ = ["MODEL", "SCOPE", "read_sdf"]

MODEL = "__model__"
SCOPE = "::"
_USUAL_MASS = 1.0  # [kg] Of a link without a stated mass.
_USUAL_DENSITY = 1000.0  # [kg/m^3] Default for masses computed from volumes: that of water.
_DYNAMICS = {"stiffness": "spring_stiffness", "damping": "damping", "friction": "friction"}


@dataclass(slots=True)
class _Frames:
    """Poses of named frames relative to the model, computed on demand.

    Names in a nested model start with its scope, such as ``arm::``. A nested model may be placed by
    one of its own frames instead of by its origin.
    """

    warnings: list[ReadingWarning]
    given: dict[str, tuple[Pose, str, Element]] = field(default_factory=dict)
    known: dict[str, Pose] = field(default_factory=lambda: {MODEL: Pose()})
    placed: dict[str, str] = field(default_factory=dict)

    def add(self, name: str, element: Element, usual: str, scope: str) -> None:
        """Add a frame, whose pose is relative to the frame that it names, or to the usual one."""
        pose, relative = _pose_of(element, self.warnings)
        within = scope + relative if relative else usual
        self.given.setdefault(name, (pose, within, element))

    def of(self, name: str, asked: Element) -> Pose:
        """Return the pose of a frame.

        Raises
        ------
        ScenarioError
            If there is no such frame, or its definition is circular.
        """
        chain: dict[str, None] = {}
        while name not in self.known:
            if name not in self.given:
                asked.refuse(name, "must name a link, joint or frame of the model")
            if name in chain:
                asked.refuse(name, "must not be defined relative to itself")
            chain[name] = None
            _, name, asked = self.given[name]
        for name in reversed(chain):
            pose, within, element = self.given[name]
            if placed := self.placed.pop(name, ""):  # once, however deep models are nested
                inside = _Frames(self.warnings, self.given, {name: Pose()}, self.placed)
                pose = pose.then(Pose().seen_from(inside.of(placed, element)))
                self.given[name] = pose, within, element
            self.known[name] = self.known[within].then(pose)
        return self.known[name]

    def inside(self, element: Element, usual: str, scope: str) -> Pose:
        """Return the pose of an element that is not a frame itself, such as a collision."""
        pose, relative = _pose_of(element, self.warnings)
        return self.of(scope + relative if relative else usual, element).then(pose)


@dataclass(frozen=True, slots=True)
class _Part:
    """A link, joint or frame, with the scope of its nested model."""

    element: Element
    scope: str

    @property
    def name(self) -> str:
        return self.scope + self.element.attribute("name")

    @property
    def attached_to(self) -> str:
        return self.scope + (self.element.attributes.get("attached_to", "") or MODEL)


def read_sdf(root: Element, model: str | None, meshes: Meshes) -> Tree:
    """Read one model.

    Parameters
    ----------
    root : Element
        Root element of the file.
    model : str, optional
        Name of the model. None takes the only model that is not static, or if there are several
        of these, the only one that can drive.
    meshes : Meshes
        Reads meshes, and collects warnings.

    Raises
    ------
    ScenarioError
        If the file breaks a rule of the format, or needs something that it does not contain.
    """
    version = root.attributes.get("version", "")
    match = re.fullmatch(r"1\.(\d{1,2})", version, re.ASCII)
    minor = int(match[1]) if match else 0
    if not 4 <= minor <= 12:
        cure = '"gz sdf -p FILE" rewrites a file of an older version'
        root.refuse(version or "none", f"must be of version 1.4 to 1.12; {cure}", "@version")
    chosen = _choose(root, model)
    meshes.read(
        {
            uri.text: mesh
            for collision in chosen.within()
            if collision.tag == "collision"
            for mesh in collision.within()
            if mesh.tag == "mesh"
            for uri in mesh.all("uri")
        }
    )
    world = chosen.parent
    if world is None or world.tag != "world":
        return _Model(chosen, minor, meshes).tree()
    for gravity in world.all("gravity"):
        warn_of_gravity(gravity, None, meshes.warnings)
    for joint in world.all("joint"):
        ends = (each.text for tag in ("parent", "child") for each in joint.all(tag))
        reason = "is left out: here models are not joined to others"
        meshes.warnings.append((joint.at, " to ".join(ends), reason))
    return replace(_Model(chosen, minor, meshes).tree(), floors=tuple(_floors(world)))


def _floors(world: Element) -> Iterator[Limit]:
    """[-] Yield the friction that a world gives to its ground.

    This is planes and height maps of static models, or else all their collisions. What breaks a
    rule of the format is passed over, as it is no part of the robot.
    """
    shapes: dict[bool, list[Limit]] = {True: [], False: []}
    for model in world.all("model"):
        with suppress(ScenarioError):
            if _flag(model, "static") is True:
                for collision in (each for each in model.within() if each.tag == "collision"):
                    kinds = (collision.only(f"geometry/{kind}") for kind in ("plane", "heightmap"))
                    is_ground = any(kind is not None for kind in kinds)
                    ode = collision.only("surface/friction/ode")
                    stated = () if ode is None else (*ode.all("mu"), *ode.all("mu2"))
                    shapes[is_ground] += [coefficient(each, each) for each in stated]
    yield from shapes[True] or shapes[False]


def _pose_of(element: Element, warnings: list[ReadingWarning]) -> tuple[Pose, str]:
    """Read the pose of an element, and the name of the frame that it is relative to, if any."""
    pose = element.first("pose", warnings)
    if pose is None:
        return Pose(), ""
    relative = pose.attributes.get("relative_to", "")
    if frame := pose.attributes.get("frame", ""):
        reason = "is left out: it has no meaning; from SDF 1.7 on relative_to has"
        warnings.append((f"{pose.at}@frame", frame, reason))
    if not pose.text:
        return Pose(), relative
    rotation = pose.attributes.get("rotation_format", "euler_rpy")
    if rotation == "quat_xyzw":
        x, y, z, *xyzw = pose.reals(7)
        if math.hypot(*xyzw) < 1e-6:
            pose.refuse(pose.text, "must have a quaternion that is not 0")
        return from_quaternion((xyzw[3], *xyzw[:3]), (x, y, z)), relative
    if rotation != "euler_rpy":
        pose.refuse(rotation, "must be euler_rpy or quat_xyzw", "@rotation_format")
    numbers = pose.reals(6)
    if pose.attributes.get("degrees", "false") in ("true", "1"):
        numbers[3:] = [math.radians(angle) for angle in numbers[3:]]
    return from_rpy(numbers[3:], numbers[:3]), relative


def _choose(root: Element, name: str | None) -> Element:
    """Return the model with this name, or else the only one that moves or that can drive."""
    models = [*root.all("model"), *(m for world in root.all("world") for m in world.all("model"))]
    if name is not None:
        same = [model for model in models if model.attributes.get("name") == name]
        if len(same) != 1:
            raise ScenarioError("model", name, f"must be one of {_names(models)}")
        return same[0]
    moving = [model for model in models if _flag(model, "static") is not True]
    driving = [model for model in moving if len(moving) == 1 or _drives(model)]
    if len(driving) != 1:
        rule = (
            "must have one model that is not static, or one of several with wheels or moved tracks:"
            " model= names it; an included model is read from its own file"
        )
        root.refuse(_names(driving or moving) or "none", rule)
    return driving[0]


def _names(models: list[Element]) -> str:
    return ", ".join(model.attributes.get("name", "")[:40] for model in models[:10])


def _flag(element: Element, tag: str) -> bool | None:
    child = element.only(tag)
    return None if child is None else child.text.lower() in ("1", "true")


def _text(element: Element, tag: str) -> str:
    child = element.only(tag)
    return "" if child is None else child.text


def _drives(model: Element) -> bool:
    """Whether a model has joints that turn without limit, or a plugin that moves tracks."""
    plugins = tuple(plugin_of(each) for each in model.within() if each.tag == "plugin")
    return any(named_tracks(plugins)) or any(
        _turns(joint) for joint in model.within() if joint.tag == "joint"
    )


def _turns(joint: Element) -> bool:
    """Whether a joint turns at least twice, as those of wheels do."""
    lower, upper = (
        unlimited if limit is None else real(limit, limit.text, unlimited=True)
        for limit, unlimited in (
            (joint.only("axis/limit/lower"), -math.inf),
            (joint.only("axis/limit/upper"), math.inf),
        )
    )
    kind = joint.attributes.get("type")
    return kind == "continuous" or (kind == "revolute" and upper - lower >= TWO_TURNS)


class _Model:
    """Converts one model to a tree; a class, because every step needs its frames."""

    def __init__(self, model: Element, minor: int, meshes: Meshes) -> None:
        self.model = model
        self.minor = minor
        self.meshes = meshes
        self.warnings = meshes.warnings
        self.frames = _Frames(meshes.warnings)
        self.models = list(self.nested(model, ""))
        self.has_includes = bool(self.parts("include"))
        self.links = {part.name: part for part in self.parts("link")}

    def nested(self, model: Element, scope: str) -> Iterator[_Part]:
        """Yield a model and the models nested in it, without those included from other files."""
        yield _Part(model, scope)
        for include in model.all("include"):
            name = (include.only("name") or include.only("uri") or include).text
            reason = "is left out: it is in another file; its mass is missing here"
            self.warnings.append((include.at, name, reason))
        for inner in model.all("model"):
            within = f"{scope}{inner.attribute('name')}{SCOPE}"
            self.frames.add(within + MODEL, inner, scope + MODEL, scope)
            if placed := inner.attributes.get("placement_frame", ""):
                self.frames.placed[within + MODEL] = within + placed
            yield from self.nested(inner, within)

    def parts(self, tag: str) -> list[_Part]:
        return [
            _Part(element, each.scope) for each in self.models for element in each.element.all(tag)
        ]

    def tree(self) -> Tree:
        placed, _ = _pose_of(self.model, [])
        warn_of_tilt(f"{self.model.at}: pose", placed, "model", self.warnings)
        warn_of_unmoved(self.model, self.warnings)
        joints = {}
        ends = []
        for part in self.parts("joint"):
            joined = self.ends(part)
            if joined is not None:
                joints[joined[1]] = part
                ends.append((part.name, *joined, part.element.where))
        plugins = tuple(plugin_of(part.element) for part in self.parts("plugin"))
        turning = [child for child, part in joints.items() if _turns(part.element)]
        order = order_links(
            [(part.name, part.element.where) for part in self.parts("link")],
            ends,
            self.model.where,
            self.warnings,
            driving=[*turning, *(name for name, _ in named_tracks(plugins))],
        )
        for name, part in self.links.items():
            self.frames.add(name, part.element, part.scope + MODEL, part.scope)
        for name, _, child, _ in ends:
            part = joints[child]
            held = part.scope + part.element.needed("child").text  # may be a frame of the link
            self.frames.add(name, part.element, held, part.scope)
        for part in self.parts("frame"):
            self.frames.add(part.name, part.element, part.attached_to, part.scope)
        for each in self.models[1:]:  # the name of a model is also that of its frame
            name, own = each.scope[: -len(SCOPE)], each.scope + MODEL
            self.frames.given.setdefault(name, (Pose(), own, each.element))
        parent_of = {child: parent for _, parent, child, _ in ends if child in order}
        links = [self.link(self.links[name]) for name in order]
        carriers = collision_ancestors(links, parent_of)
        return Tree(
            name=self.model.attributes.get("name", ""),
            format=f"SDF 1.{self.minor}",
            file=self.model.where.file,
            links=tuple(links),
            joints={
                child: self.joint(joints[child], parent, child, carries=child in carriers)
                for child, parent in parent_of.items()
            },
            plugins=plugins,
            driven=driven_by(plugins),
            couplings=tuple(
                mimic_coupling(
                    part.name, mimic, *(_text(mimic, tag) for tag in ("multiplier", "offset"))
                )
                for part in self.parts("joint")
                for axis in part.element.all("axis")
                for mimic in axis.all("mimic")
            ),
            at=self.model.where,
        )

    def ends(self, part: _Part) -> tuple[str, str] | None:
        """Return the links that a joint joins; None if it is left out."""
        joint = part.element
        parent, child = (joint.needed(end).text for end in ("parent", "child"))
        ends = self.carrier(part.scope + parent), self.carrier(part.scope + child)
        for end in ends:
            if end in self.attached:
                joint.refuse(end, "must join links, not frames that are attached in a circle")
        reason = ""
        if "world" in (parent, child):
            reason = "it fixes the robot to the world, but the robot has to drive"
        elif joint.attribute("type") == "gearbox":
            reason = "it couples joints, and carries nothing"
        elif self.has_includes and not self.links.keys() >= set(ends):
            reason = "it joins a link in another file"
        if reason:
            self.warnings.append((joint.at, part.name, f"is left out: {reason}"))
            return None
        return ends

    def carrier(self, name: str) -> str:
        """Return the link that a frame, joint or nested model is attached to, or else its name.

        Of frames in a circle, it is the name of one of them.
        """
        passed: dict[str, None] = {}
        while name in self.attached and name not in passed:
            passed[name] = None
            name = self.attached[name]
        self.attached |= dict.fromkeys(passed, name)  # long chains are followed once
        return name

    @cached_property
    def attached(self) -> dict[str, str]:
        """What frames, joints and models are attached to; a model to a link, usually its first."""
        names = {}
        for each in self.models:
            inner = [*each.element.all("link"), *each.element.all("model")]
            first = inner[0].attribute("name") if inner else ""
            names[each.scope + MODEL] = each.scope + (
                each.element.attributes.get("canonical_link", "") or first
            )
        names |= {
            each.scope[: -len(SCOPE)]: each.scope + MODEL for each in self.models if each.scope
        }
        for part in self.parts("frame"):
            names.setdefault(part.name, part.attached_to)
        for part in self.parts("joint"):
            names.setdefault(part.name, part.scope + part.element.needed("child").text)
        return {name: held for name, held in names.items() if name not in self.links}

    def link(self, part: _Part) -> Link:
        link, name = part.element, part.name
        pose = self.frames.of(name, link)
        mass, frame, tensor, mass_at = _USUAL_MASS, pose, np.eye(3), link.where
        shapes, unread = collisions(self.shape(c, part) for c in link.all("collision"))
        inertial = link.first("inertial", self.warnings)
        is_auto = inertial is not None and inertial.attributes.get("auto", "") in ("1", "true")
        if inertial is not None:
            mass_at, frame = inertial.where, Pose()
        if inertial is not None and not is_auto:
            mass = inertial.real("mass", _USUAL_MASS)
            mass_at = (inertial.only("mass") or inertial).where
            frame = self.frames.inside(inertial, name, part.scope)
            values = inertial.only("inertia")
            if values is not None:
                tensor = inertia(
                    values,
                    lambda word: values.real(word, 1.0 if word[1] == word[2] else 0.0),
                    self.warnings,
                )
        place, tensor = frame.place, frame.turn @ tensor @ frame.turn.T
        if inertial is not None and is_auto:
            mass, place, tensor = self.solid(part, inertial)
        if mass < 0.0:
            link.refuse(mass, "must have a mass >= 0 kg")
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

    def solid(self, part: _Part, inertial: Element) -> tuple[float, Array, Array]:
        """Return mass, centre and inertia of a link, computed from its collision shapes.

        A shape has its own density, or else that of the link. A stated mass is that of all shapes.
        """
        usual = inertial.real("density", _USUAL_DENSITY)
        shapes, densities = [], []
        for collision in part.element.all("collision"):
            shape = self.geometry(collision, part)
            if isinstance(shape, Shape) and shape.kind != "hull":
                shapes.append(shape)
                densities.append(collision.real("density", usual))
                if not densities[-1] > 0.0:
                    collision.refuse(densities[-1], "must have a density > 0 kg/m^3")
            elif shape is not None:
                shapes = []
                break
        if not shapes:
            rule = "must state mass and inertia, or have boxes, cylinders, capsules or spheres"
            inertial.refuse("auto", rule)
        mass, place, tensor = solid(shapes, densities)
        stated = inertial.real("mass", mass)
        return stated, place, tensor * (stated / mass)

    def shape(self, collision: Element, part: _Part) -> Shape | Unread | None:
        bitmask = collision.only("surface/contact/collide_bitmask")
        if bitmask is not None and re.fullmatch(r"0x0+|0+", bitmask.text):
            return None  # it collides with nothing
        return self.geometry(collision, part)

    def geometry(self, collision: Element, part: _Part) -> Shape | Unread | None:
        pose = self.frames.inside(collision, part.name, part.scope)
        shape = Shape(
            name=collision.attributes.get("name", part.name),
            kind="",
            pose=pose,
            friction=self.friction(collision, pose, part.scope),
            pose_at=next(collision.all("pose"), collision).where,
        )
        return shape_of(
            shape,
            collision,
            self.meshes,
            numbers=lambda element, name, count: element.needed(name).reals(count),
            mesh_name=lambda mesh: mesh.needed("uri").text,
        )

    def friction(self, collision: Element, pose: Pose, scope: str) -> Friction | None:
        ode = collision.only("surface/friction/ode")
        if ode is None:
            return None
        (first, first_at), (second, second_at) = (
            coefficient(ode.only(name), ode) for name in ("mu", "mu2")
        )
        fdir1 = ode.only("fdir1")
        direction = None
        if fdir1 is not None:
            for prefix in ("gz", "ignition"):
                frame = fdir1.attributes.get(f"{prefix}:expressed_in", "")
                pose = self.frames.of(scope + frame, fdir1) if frame else pose
            direction = unit(pose.along(fdir1.reals(3)))
        return Friction(
            first=first,
            second=second,
            direction=direction,
            first_at=first_at,
            second_at=second_at,
            slips=slips_of([ode.only(name) for name in ("slip1", "slip2")], ode.where),
        )

    def joint(self, part: _Part, parent: str, child: str, *, carries: bool) -> Joint:
        pose = self.frames.of(part.name, part.element)
        joint = joint_of(part.element, part.name, parent, child, pose)
        if joint.kind == "fixed":
            return joint
        complete = partial(self.moving, joint, part)
        return joint_or_fixed(joint, complete, carries=carries, warnings=self.warnings)

    def moving(self, joint: Joint, part: _Part) -> Joint:
        element = part.element
        axis = element.only("axis")
        if axis is None:
            if joint.kind in ("hinge", "slide"):
                element.refuse("none", "must have an axis")
            return joint
        xyz = axis.only("xyz")
        frame = self.frames.of(joint.name, element)
        if xyz is not None and xyz.attributes.get("expressed_in", ""):
            frame = self.frames.of(part.scope + xyz.attributes["expressed_in"], xyz)
        elif self.minor == 4 or (self.minor <= 6 and _flag(axis, "use_parent_model_frame")):
            frame = self.frames.of(part.scope + MODEL, axis)
        along = frame.along((0.0, 0.0, 1.0) if xyz is None else xyz.reals(3))
        limit = axis.only("limit")
        figures = {
            each.tag: (real(each, each.text, unlimited=True), each.where)
            for each in (() if limit is None else limit.children)
            if each.tag in ("lower", "upper", "effort", "velocity")
        }
        for name, tag in _DYNAMICS.items():
            if (each := axis.only(f"dynamics/{tag}")) is not None:
                figures[name] = (real(each, each.text, unlimited=True), each.where)
        return moving_joint(joint, axis, along, figures)
