"""Read a URDF with its extensions for Gazebo and Bullet as a neutral tree, after any xacro."""

from __future__ import annotations

import math
import re
from collections import defaultdict
from collections.abc import Collection, Iterable, Iterator
from contextlib import suppress
from dataclasses import replace
from functools import partial

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
    from_rpy,
    unit,
)
from crawler2d.reading.log import ReadingWarning, list_names
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
)
from crawler2d.reading.unused import warn_of_unmoved

__all__ = ["read_urdf"]

_FIXED = "is left out: it fixes the robot to the world, but the robot has to drive"
_WORLD = "world"  # A joint from an empty link of this name fixes a robot to the world.

_SURFACE = {"mu1": "mu", "mu2": "mu2", "fdir1": "fdir1", "slip1": "slip1", "slip2": "slip2"}
"""Elements about the friction of a surface: in an extension of URDF, and in SDF."""

# The interface of ros_control, with or without its package, and that of ros2_control.
_POSITION = re.compile(r"^(.*/)?(PositionJointInterface|position)$")


def read_urdf(root: Element, meshes: Meshes, *, leave_out: bool, is_bullet: bool) -> Tree:
    """Read the robot of a URDF, in the frame of its root link.

    Parameters
    ----------
    root : Element
        Root element of the file.
    meshes : Meshes
        Reads meshes, and collects warnings.
    leave_out : bool
        Whether to leave out joints whose links are missing, instead of refusing the file.
    is_bullet : bool
        Whether the file is for Bullet, which does not read the friction written for Gazebo.

    Raises
    ------
    ScenarioError
        If the file breaks a rule of the format.
    """
    for element in root.within():
        if element.tag.startswith("xacro:"):
            element.refuse(element.tag, "must be expanded: a file with xacro is named *.xacro")
    elements = {link.attribute("name"): link for link in root.all("link")}
    if not elements:
        rule = "must have a link: a file of macros only is read through the file that calls them"
        root.refuse("no link", rule)
    meshes.read(
        {
            mesh.attributes.get("filename", "").strip(): mesh
            for link in root.all("link")
            for collision in link.all("collision")
            for mesh in collision.within()
            if mesh.tag == "mesh"
        }
    )
    warnings = meshes.warnings
    warn_of_unmoved(root, warnings)
    warnings += [
        (each.at, each.text, _FIXED)
        for block in root.all("gazebo")
        for each in block.all("static")
        if each.text.lower() in ("1", "true")
    ]
    ends, ground = [], ""
    for element in root.all("joint"):
        parent, child = (element.needed(end).attribute("link") for end in ("parent", "child"))
        if leave_out and not {parent, child} <= elements.keys():
            warnings.append((element.at, f"{parent} to {child}", "is left out: a link is missing"))
        elif parent == _WORLD and parent in elements and not elements[parent].children:
            ground = parent
            if element.attribute("type") != "floating":
                warnings.append((element.at, f"{parent} to {child}", _FIXED))
        else:
            ends.append((element, element.attribute("name"), parent, child))
    plugins = tuple(
        plugin_of(plugin) for block in root.all("gazebo") for plugin in block.all("plugin")
    )
    names = [(link.attribute("name"), link.where) for link in root.all("link")]
    order = order_links(
        [(name, where) for name, where in names if name != ground],
        [(name, parent, child, element.where) for element, name, parent, child in ends],
        root.where,
        warnings,
        driving=[
            *(each for element, _, _, each in ends if element.attribute("type") == "continuous"),
            *(name for name, _ in named_tracks(plugins)),
        ],
        remedy='; missing="leave_out" leaves out joints of links that are missing on purpose',
    )
    by_child = {each: (element, parent) for element, _, parent, each in ends if each in order}
    frictions = _frictions(root, elements, warnings, is_bullet=is_bullet)
    poses: dict[str, Pose] = {}
    links = []
    for name in order:
        pose, pose_at = Pose(), elements[name].where
        if name in by_child:
            element, parent = by_child[name]
            pose = poses[parent].then(_origin(element, warnings))
            pose_at = _origin_element(element).where
        poses[name] = pose
        links.append(_link(elements[name], pose, pose_at, frictions.get(name), meshes))
    carriers = collision_ancestors(
        links, {child: parent for child, (_, parent) in by_child.items()}
    )
    joints = {}
    for child, (element, parent) in by_child.items():
        joint = joint_of(element, element.attribute("name"), parent, child, poses[child])
        if joint.kind in ("hinge", "slide"):
            complete = partial(_moving, joint, element, poses[child])
            joint = joint_or_fixed(joint, complete, carries=child in carriers, warnings=warnings)
        joints[child] = joint
    by_plugin = driven_by(plugins)
    return Tree(
        name=root.attributes.get("name", ""),
        format="URDF",
        file=root.where.file,
        links=tuple(links),
        joints=joints,
        plugins=plugins,
        driven=by_plugin | _driven(root),
        held={name: at for name, at in _held(root).items() if name not in by_plugin},
        commanded=dict(_commanded(root)),
        couplings=tuple(
            mimic_coupling(
                element.attribute("name"),
                mimic,
                *(mimic.attributes.get(name, "") for name in ("multiplier", "offset")),
            )
            for element, _ in by_child.values()
            for mimic in element.all("mimic")
        ),
        at=root.where,
    )


def _frictions(
    root: Element, names: Collection[str], warnings: list[ReadingWarning], *, is_bullet: bool
) -> dict[str, Friction]:
    """Return the friction that extensions give to links; directions are in collision frames."""
    frictions: dict[str, Friction] = {}
    for link in root.all("link"):
        lateral = link.only("contact/lateral_friction")
        if lateral is not None:
            value, at = coefficient(lateral, link)
            both = Friction(first=value, second=value, first_at=at, second_at=at)
            frictions[link.attribute("name")] = both
    astray: dict[str, Element] = {}
    blocks = defaultdict[str, list[Element]](list)
    for block in () if is_bullet else root.all("gazebo"):
        blocks[block.attributes.get("reference", "")].append(block)
    for name, of_link in blocks.items():
        stated = _stated(of_link)
        mu1, mu2, fdir1, *slips = (stated.get(tag) for tag in _SURFACE)
        if not name or not stated.keys() - {"fdir1"}:
            continue
        if name not in names:
            astray[name] = of_link[0]
            continue
        (first, first_at), (second, second_at) = (coefficient(mu, of_link[0]) for mu in (mu1, mu2))
        direction = None
        if fdir1 is not None:
            direction = unit(fdir1.reals(3, "value" if "value" in fdir1.attributes else None))
        frictions[name] = Friction(
            first=first,
            second=second,
            direction=direction,
            first_at=first_at,
            second_at=second_at,
            slips=slips_of(slips, of_link[0].where),
        )
    if astray:
        path = f"{next(iter(astray.values())).at}@reference"
        reason = "has friction that has no effect: no link has this name"
        warnings.append((path, list_names(list(astray)), reason))
    return frictions


def _stated(blocks: list[Element]) -> dict[str, Element]:
    """Return what the extensions of a link say of its friction.

    As in Gazebo, a later block replaces what it has of an earlier one, and the surface in a
    ``<collision>`` replaces all that was stated before.
    """
    stated: dict[str, Element] = {}
    for block in blocks:
        for surface in (each for own in block.all("collision") for each in own.all("surface")):
            ode = surface.only("friction/ode")
            inner = {} if ode is None else {tag: ode.only(word) for tag, word in _SURFACE.items()}
            stated = {tag: own for tag, own in inner.items() if own}
        given = {tag: block.only(tag) for tag in ("mu1", "mu2", "fdir1")}
        stated |= {tag: own for tag, own in given.items() if own}
    return stated


def _origin(element: Element, warnings: list[ReadingWarning]) -> Pose:
    origin = element.first("origin", warnings)
    if origin is None:
        return Pose()
    xyz, rpy = (
        origin.reals(3, name) if name in origin.attributes else [0.0, 0.0, 0.0]
        for name in ("xyz", "rpy")
    )
    return from_rpy(rpy, xyz)


def _origin_element(element: Element) -> Element:
    """Return the element whose line is cited for a position."""
    return next(element.all("origin"), element)


def _link(
    link: Element, pose: Pose, pose_at: Where, friction: Friction | None, meshes: Meshes
) -> Link:
    mass, center, tensor, mass_at = 0.0, pose, np.zeros((3, 3)), link.where
    inertial = link.first("inertial", meshes.warnings)
    if inertial is not None:
        given = inertial.needed("mass")
        (mass,), mass_at = given.reals(1, "value"), given.where
        center = pose.then(_origin(inertial, meshes.warnings))
        values = inertial.needed("inertia")
        tensor = inertia(values, lambda name: values.reals(1, name)[0], meshes.warnings)
    if mass < 0.0:
        link.refuse(mass, "must have a mass >= 0 kg")
    shapes, unread = collisions(
        _shape(collision, link, pose, friction, meshes) for collision in link.all("collision")
    )
    return Link(
        name=link.attribute("name"),
        pose=pose,
        mass=mass,
        center=center.place,
        inertia=center.turn @ tensor @ center.turn.T,
        shapes=shapes,
        unread=unread,
        at=link.where,
        pose_at=pose_at,
        mass_at=mass_at,
    )


def _shape(
    collision: Element, link: Element, pose: Pose, friction: Friction | None, meshes: Meshes
) -> Shape | Unread | None:
    pose = pose.then(_origin(collision, meshes.warnings))
    if friction is not None and friction.direction is not None:
        friction = replace(friction, direction=unit(pose.along(friction.direction)))
    shape = Shape(
        name=collision.attributes.get("name") or link.attribute("name"),
        kind="",
        pose=pose,
        friction=friction,
        pose_at=_origin_element(collision).where,
    )
    return shape_of(
        shape,
        collision,
        meshes,
        numbers=lambda element, name, count: element.reals(count, name),
        mesh_name=lambda mesh: mesh.attribute("filename"),
    )


def _moving(joint: Joint, element: Element, pose: Pose) -> Joint:
    axis, limit = element.only("axis"), element.only("limit")
    is_continuous = element.attribute("type") == "continuous"
    figures: dict[str, Limit] = {}
    if limit is not None:
        # A missing effort or speed is no limit; a missing angle is 0.
        usual = {"effort": math.inf, "velocity": math.inf, "lower": 0.0, "upper": 0.0}
        figures = {name: (value, limit.where) for name, value in usual.items()}
        figures |= _given(limit, usual)
    elif not is_continuous:
        element.refuse("none", "must have a limit")
    if is_continuous:
        figures = {name: each for name, each in figures.items() if name in ("effort", "velocity")}
    dynamics = next(element.all("dynamics"), None)
    if dynamics is not None:
        figures |= _given(dynamics, ("damping", "friction"))
    along = pose.along((1.0, 0.0, 0.0) if axis is None else axis.reals(3, "xyz"))
    return moving_joint(joint, element, along, figures)


def _given(element: Element, names: Iterable[str]) -> dict[str, Limit]:
    return {
        name: (real(element, element.attributes[name], f"@{name}", unlimited=True), element.where)
        for name in names
        if name in element.attributes
    }


def _motors(root: Element) -> Iterator[tuple[Element, list[tuple[str, Where]]]]:
    """Yield the joints of transmissions and of ros2_control, each with what may be commanded."""
    for block in root.all("transmission"):
        for joint in block.all("joint"):
            own = list(joint.all("hardwareInterface"))
            others = (i for each in block.all("actuator") for i in each.all("hardwareInterface"))
            yield joint, [(each.text, each.where) for each in own or others]
    for block in root.all("ros2_control"):
        for joint in block.all("joint"):
            commands = list(joint.all("command_interface"))
            if commands:
                yield joint, [(each.attributes.get("name", ""), each.where) for each in commands]


def _driven(root: Element) -> dict[str, Where]:
    """Return the joints that a transmission or ros2_control drives, with their lines."""
    return {joint.attribute("name"): joint.where for joint, _ in _motors(root)}


def _held(root: Element) -> dict[str, Where]:
    """Return those of which only the position may be commanded, with the lines that say so."""
    commands: dict[str, list[tuple[str, Where]]] = {}
    for joint, own in _motors(root):
        commands.setdefault(joint.attribute("name"), []).extend(own)
    return {
        name: every[0][1]
        for name, every in commands.items()
        if every and all(_POSITION.search(text) for text, _ in every)
    }


def _commanded(root: Element) -> Iterator[tuple[str, Limit]]:
    """Yield the joints whose speed ros2_control limits [rad/s], with the line of the limit.

    Limits in both directions are alike as a rule; the smaller one counts.
    """
    for block in root.all("ros2_control"):
        for joint in block.all("joint"):
            limits: list[Limit] = []
            for interface in joint.all("command_interface"):
                if interface.attributes.get("name") == "velocity":
                    for param in interface.all("param"):
                        if param.attributes.get("name") in ("min", "max"):
                            with suppress(ScenarioError):  # it is no part of the format
                                limits.append((abs(real(param, param.text)), param.where))
            if limits:
                yield joint.attribute("name"), min(limits, key=lambda limit: limit[0])
