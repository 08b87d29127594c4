"""SDF 1.4 to 1.11 as a neutral tree: one model, by itself or in a world."""

from __future__ import annotations

import math
import re

from crawler2d.errors import ScenarioError
from crawler2d.models.poses import Pose, unit
from crawler2d.models.tree import Friction, Joint, Link, Shape, Tree
from crawler2d.models.where import Where
from crawler2d.reading.elements import Element, real
from crawler2d.reading.frames import MODEL, Frames
from crawler2d.reading.joints import joint_of, moving
from crawler2d.reading.meshes import Meshes
from crawler2d.reading.order import checked
from crawler2d.reading.plugins import driven_by, plugin_of
from crawler2d.reading.shapes import inertia, shape_of

__all__ = ["read_sdf"]

# What SDF takes where a file says nothing: a link of 1 kg, a friction of 1.
_USUAL_MASS = _USUAL_FRICTION = 1.0


def read_sdf(root: Element, model: str | None, meshes: Meshes) -> Tree:
    """Read one model.

    Parameters
    ----------
    root : Element
        Of the file.
    model : str, optional
        Name of the model; None takes the only one that is not static.
    meshes : Meshes
        What is done with meshes.

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
        root.refuse(version, "must be of version 1.4 to 1.11", "@version")
    chosen = _chosen(root, model)
    for part in chosen.children:
        if part.tag in ("model", "include"):
            part.refuse(
                part.attributes.get("name", part.tag),
                "must hold its parts itself: write its links and joints in its place",
            )
    return _Model(chosen, minor, meshes).tree()


def _chosen(root: Element, name: str | None) -> Element:
    """Return the model of a name, or the only one that moves."""
    models = [*root.all("model"), *(m for world in root.all("world") for m in world.all("model"))]
    if name is not None:
        named = [m for m in models if m.attributes.get("name") == name]
        if len(named) != 1:
            raise ScenarioError("model", name, f"must be one of {_names(models)}")
        return named[0]
    moving = [m for m in models if _flag(m, "static") is not True]
    if len(moving) != 1:
        rule = "must hold one model that is not static, or model= must name one"
        root.refuse(_names(moving) or "none", rule)
    return moving[0]


def _names(models: list[Element]) -> str:
    return ", ".join(model.attributes.get("name", "")[:40] for model in models[:10])


def _flag(element: Element, tag: str) -> bool | None:
    found = element.only(tag)
    return None if found is None else found.text.lower() in ("1", "true")


class _Model:
    """One model on its way to a tree: its frames are needed at every step."""

    def __init__(self, model: Element, minor: int, meshes: Meshes) -> None:
        self.model = model
        self.minor = minor
        self.meshes = meshes
        self.frames = Frames()
        self.links = {link.attribute("name"): link for link in model.all("link")}
        self.joints = list(model.all("joint"))

    def tree(self) -> Tree:
        names = [(link.attribute("name"), link.where) for link in self.model.all("link")]
        ends = []
        for joint in self.joints:
            parent, child = (joint.needed(end).text for end in ("parent", "child"))
            if "world" in (parent, child):
                joint.refuse("world", "must not fix the robot to the world")
            ends.append((joint.attribute("name"), parent, child, joint.where))
        order = checked(names, ends, self.model.where)
        for link in self.links.values():
            self.frames.add(link.attribute("name"), link, MODEL)
        for (name, _, child, _), joint in zip(ends, self.joints, strict=True):
            self.frames.add(name, joint, child)
        for frame in self.model.all("frame"):
            usual = frame.attributes.get("attached_to", "") or MODEL
            self.frames.add(frame.attribute("name"), frame, usual)
        plugins = tuple(plugin_of(plugin) for plugin in self.model.all("plugin"))
        return Tree(
            name=self.model.attributes.get("name", ""),
            format=f"SDF 1.{self.minor}",
            file=self.model.where.file,
            links=tuple(self.link(self.links[name]) for name in order),
            joints={
                child: self.joint(joint, name, parent, child)
                for (name, parent, child, _), joint in zip(ends, self.joints, strict=True)
            },
            plugins=plugins,
            driven=driven_by(plugins),
            at=self.model.where,
        )

    def link(self, link: Element) -> Link:
        name = link.attribute("name")
        pose = self.frames.of(name, link)
        mass, center, tensor, mass_at = _USUAL_MASS, Pose(), Pose().turn, link.where
        inertial = link.only("inertial")
        if inertial is not None:
            if inertial.attributes.get("auto", "").lower() in ("1", "true"):
                inertial.refuse("auto", "must state mass and inertia")
            mass = inertial.real("mass", _USUAL_MASS)
            found = inertial.only("mass")
            mass_at = inertial.where if found is None else found.where
            center = self.frames.inside(inertial, name)
            given = inertial.only("inertia")
            if given is not None:
                values = given
                tensor = inertia(
                    given, lambda part: values.real(part, 1.0 if part[1] == part[2] else 0.0)
                )
        if mass < 0.0:
            link.refuse(mass, "must have a mass >= 0 kg")
        frame = center if inertial is not None else pose
        shapes = (self.shape(c, name) for c in link.all("collision"))
        return Link(
            name=name,
            pose=pose,
            mass=mass,
            center=frame.place,
            inertia=frame.turn @ tensor @ frame.turn.T,
            shapes=tuple(shape for shape in shapes if shape is not None),
            at=link.where,
            pose_at=(link.only("pose") or link).where,
            mass_at=mass_at,
        )

    def shape(self, collision: Element, link: str) -> Shape | None:
        bitmask = collision.only("surface/contact/collide_bitmask")
        if bitmask is not None and re.fullmatch(r"0x0+|0+", bitmask.text):
            return None  # it meets nothing
        pose = self.frames.inside(collision, link)
        return shape_of(
            collision,
            name=collision.attributes.get("name", link),
            pose=pose,
            pose_at=collision.only("pose") or collision,
            friction=self.friction(collision, pose),
            numbers=lambda element, name, count: element.needed(name).reals(count),
            mesh_name=lambda mesh: mesh.needed("uri").text,
            meshes=self.meshes,
        )

    def friction(self, collision: Element, pose: Pose) -> Friction | None:
        ode = collision.only("surface/friction/ode")
        if ode is None:
            return None
        first, second = (_coefficient(ode, name) for name in ("mu", "mu2"))
        direction = ode.only("fdir1")
        along = None
        if direction is not None:
            for prefix in ("gz", "ignition"):
                frame = direction.attributes.get(f"{prefix}:expressed_in", "")
                pose = self.frames.of(frame, direction) if frame else pose
            along = unit(pose.along(direction.reals(3)))
        return Friction(
            first=first[0],
            second=second[0],
            direction=along,
            first_at=first[1],
            second_at=second[1],
        )

    def joint(self, joint: Element, name: str, parent: str, child: str) -> Joint:
        pose = self.frames.of(name, joint)
        made = joint_of(joint, parent, child, pose)
        axis = joint.only("axis")
        if made.kind == "fixed":
            return made
        if axis is None:
            if made.kind in ("hinge", "slide"):
                joint.refuse("none", "must have an axis")
            return made
        xyz = axis.only("xyz")
        frame = pose
        if xyz is not None and xyz.attributes.get("expressed_in", ""):
            frame = self.frames.of(xyz.attributes["expressed_in"], xyz)
        elif self.minor == 4 or (self.minor <= 6 and _flag(axis, "use_parent_model_frame")):
            frame = Pose()
        limit = axis.only("limit")
        values = {
            part.tag: (real(part, part.text, unlimited=True), part.where)
            for part in (() if limit is None else limit.children)
            if part.tag in ("lower", "upper", "effort", "velocity")
        }
        stiffness = axis.only("dynamics/spring_stiffness")
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
            stiffness=0.0 if stiffness is None else stiffness.reals(1)[0],
        )


def _coefficient(ode: Element, name: str) -> tuple[float, Where]:
    found = ode.only(name)
    if found is None:
        return _USUAL_FRICTION, ode.where
    value = real(found, found.text, unlimited=True)
    if value < 0.0:
        found.refuse(value, "must be >= 0")
    return value, found.where
