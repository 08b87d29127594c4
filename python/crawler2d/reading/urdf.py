"""URDF as a neutral tree, with extensions for Gazebo and Bullet; xacro is expanded first."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

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
from crawler2d.reading.elements import Element, real
from crawler2d.reading.log import Doubt
from crawler2d.reading.meshes import Meshes
from crawler2d.reading.parts import (
    Limit,
    carrying,
    checked,
    collisions,
    inertia,
    joint_of,
    moving,
    named_tracks,
    plugin_of,
    settled,
    shape_of,
)

__all__ = ["read_urdf"]

_WORLD = "world"  # what holds a robot to it is a joint from a link of this name, which has nothing


def read_urdf(
    root: Element,
    meshes: Meshes,
    doubts: list[Doubt],
    *,
    leave_out: bool = False,
    is_bullet: bool = False,
) -> Tree:
    """Read the robot of a URDF.

    Parameters
    ----------
    root : Element
        Of the file.
    meshes : Meshes
        What is done with meshes.
    doubts : list of Doubt
        Where to note what is left out.
    leave_out : bool
        Whether joints whose links are missing are left out, or refused.
    is_bullet : bool
        Whether it is for Bullet, which does not read the friction that is meant for Gazebo.

    Returns
    -------
    Tree
        The robot, in the frame of its root link.

    Raises
    ------
    ScenarioError
        If anything breaks a rule of the format.
    """
    _refuse_macros(root)
    elements = {link.attribute("name"): link for link in root.all("link")}
    if not elements:
        rule = "must have a link: a file of macros only is read through the file that calls them"
        root.refuse("no link", rule)
    meshes.find(
        {
            mesh.attributes.get("filename", "").strip(): mesh
            for link in root.all("link")
            for collision in link.all("collision")
            for mesh in collision.within()
            if mesh.tag == "mesh"
        }
    )
    ends, ground = [], ""
    for joint in root.all("joint"):
        parent, child = (joint.needed(end).attribute("link") for end in ("parent", "child"))
        if leave_out and not {parent, child} <= elements.keys():
            doubts.append((joint.at, f"{parent} to {child}", "is left out: a link is missing"))
        elif parent == _WORLD and parent in elements and not elements[parent].children:
            ground = parent
            if joint.attribute("type") != "floating":
                reason = "is left out: it holds the robot to the world, where it is to drive"
                doubts.append((joint.at, f"{parent} to {child}", reason))
        else:
            ends.append((joint, joint.attribute("name"), parent, child))
    plugins = tuple(
        plugin_of(plugin) for block in root.all("gazebo") for plugin in block.all("plugin")
    )
    order = checked(
        [
            (link.attribute("name"), link.where)
            for link in root.all("link")
            if link.attribute("name") != ground
        ],
        [(name, parent, child, joint.where) for joint, name, parent, child in ends],
        root.where,
        doubts,
        driving=[
            *(child for joint, _, _, child in ends if joint.attribute("type") == "continuous"),
            *(name for name, _ in named_tracks(plugins)),
        ],
        remedy='; missing="leave_out" leaves joints of links that are meant to be missing out',
    )
    by_child = {child: (joint, parent) for joint, _, parent, child in ends if child in order}
    frictions = _frictions(root, is_bullet=is_bullet)
    poses: dict[str, Pose] = {}
    links = []
    for name in order:
        pose_at = elements[name].where
        poses[name] = Pose()
        if name in by_child:
            element, parent = by_child[name]
            poses[name] = poses[parent].then(_origin(element, doubts))
            pose_at = _place(element).where
        links.append(
            _link(
                elements[name],
                poses[name],
                pose_at,
                friction=frictions.get(name),
                meshes=meshes,
                doubts=doubts,
            )
        )
    parent_of = {child: parent for child, (_, parent) in by_child.items()}
    colliding = [link.name for link in links if link.shapes or link.unread]
    carriers = carrying(order, parent_of, colliding)
    return Tree(
        name=root.attributes.get("name", ""),
        format="URDF",
        file=root.where.file,
        links=tuple(links),
        joints={
            child: _joint(
                element, parent, child, poses[child], carries=child in carriers, doubts=doubts
            )
            for child, (element, parent) in by_child.items()
        },
        plugins=plugins,
        driven=_driven(root),
        at=root.where,
    )


def _refuse_macros(root: Element) -> None:
    """Refuse what xacro would have to expand, wherever it stands."""
    for element in root.within():
        if element.tag.startswith("xacro:"):
            element.refuse(element.tag, "must be expanded: a file with xacro is named *.xacro")


def _origin(element: Element, doubts: list[Doubt]) -> Pose:
    origin = element.first("origin", doubts)
    if origin is None:
        return Pose()
    xyz, rpy = (
        origin.reals(3, name) if name in origin.attributes else [0.0, 0.0, 0.0]
        for name in ("xyz", "rpy")
    )
    return from_rpy(rpy, xyz)


def _place(element: Element) -> Element:
    return next(element.all("origin"), element)


def _link(
    link: Element,
    pose: Pose,
    pose_at: Where,
    *,
    friction: Friction | None,
    meshes: Meshes,
    doubts: list[Doubt],
) -> Link:
    mass, center, tensor, mass_at = 0.0, pose, np.zeros((3, 3)), link.where
    inertial = link.first("inertial", doubts)
    if inertial is not None:
        given = inertial.needed("mass")
        (mass,), mass_at = given.reals(1, "value"), given.where
        center = pose.then(_origin(inertial, doubts))
        values = inertial.needed("inertia")
        tensor = inertia(values, lambda name: values.reals(1, name)[0], doubts)
    if mass < 0.0:
        link.refuse(mass, "must have a mass >= 0 kg")
    shapes, unread = collisions(
        _shape(collision, link, pose, friction=friction, meshes=meshes, doubts=doubts)
        for collision in link.all("collision")
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
    collision: Element,
    link: Element,
    pose: Pose,
    *,
    friction: Friction | None,
    meshes: Meshes,
    doubts: list[Doubt],
) -> Shape | Unread | None:
    place = pose.then(_origin(collision, doubts))
    if friction is not None and friction.direction is not None:
        friction = replace(friction, direction=unit(place.along(friction.direction)))
    return shape_of(
        collision,
        name=collision.attributes.get("name") or link.attribute("name"),
        pose=place,
        pose_at=_place(collision),
        friction=friction,
        numbers=lambda element, name, count: element.reals(count, name),
        mesh_name=lambda mesh: mesh.attribute("filename"),
        meshes=meshes,
    )


def _frictions(root: Element, *, is_bullet: bool) -> dict[str, Friction]:
    """Return what the extensions say, by link; the direction in the frame of the collision."""
    found: dict[str, Friction] = {}
    for link in root.all("link"):
        bullet = link.only("contact/lateral_friction")
        if bullet is not None:
            (value,) = bullet.reals(1, "value")
            found[link.attribute("name")] = _friction(bullet, [(value, bullet.where)] * 2, None)
    for block in () if is_bullet else root.all("gazebo"):
        name = block.attributes.get("reference", "")
        given = [block.only(tag) for tag in ("mu1", "mu2")]
        if not name or given == [None, None]:
            continue
        pair = [
            (1.0, block.where) if mu is None else (real(mu, _value(mu), unlimited=True), mu.where)
            for mu in given
        ]
        fdir1 = block.only("fdir1")
        along = None
        if fdir1 is not None:
            along = unit(fdir1.reals(3, "value" if "value" in fdir1.attributes else None))
        found[name] = _friction(block, pair, along)
    return found


def _value(element: Element) -> str:
    """Return the setting of an extension: its text, or its attribute."""
    return element.attributes.get("value", "") or element.text


def _friction(
    element: Element, pair: list[tuple[float, Where]], direction: np.ndarray[tuple[int]] | None
) -> Friction:
    (first, first_at), (second, second_at) = pair
    if min(first, second) < 0.0:
        element.refuse(min(first, second), "must have coefficients of friction >= 0")
    return Friction(
        first=first, second=second, direction=direction, first_at=first_at, second_at=second_at
    )


def _joint(
    element: Element, parent: str, child: str, pose: Pose, *, carries: bool, doubts: list[Doubt]
) -> Joint:
    made = joint_of(element, element.attribute("name"), parent, child, pose)
    if made.kind not in ("hinge", "slide"):
        return made
    return settled(made, lambda: _moving(made, element, pose), carries=carries, doubts=doubts)


def _moving(made: Joint, element: Element, pose: Pose) -> Joint:
    kind, axis, limit = element.attribute("type"), element.only("axis"), element.only("limit")
    if limit is None and kind != "continuous":
        element.refuse("none", "must have a limit")
    attributes = {} if limit is None else limit.attributes
    values = {
        name: real(limit or element, text, f"@{name}", unlimited=True)
        for name, text in attributes.items()
        if name in ("lower", "upper", "effort", "velocity")
    }
    bounds = (-math.inf, math.inf)
    if kind != "continuous":
        bounds = (values.get("lower", 0.0), values.get("upper", 0.0))
    effort, velocity = (
        None if limit is None else (values.get(name, math.inf), limit.where)
        for name in ("effort", "velocity")
    )
    return moving(
        made,
        element,
        pose.along((1.0, 0.0, 0.0) if axis is None else axis.reals(3, "xyz")),
        bounds=bounds,
        effort=effort,
        velocity=velocity,
        dynamics=_dynamics(element),
    )


def _dynamics(joint: Element) -> dict[str, Limit]:
    found = next(joint.all("dynamics"), joint)
    return {
        name: (real(found, found.attributes[name], f"@{name}", unlimited=True), found.where)
        for name in ("damping", "friction")
        if name in found.attributes
    }


def _driven(root: Element) -> dict[str, Where]:
    """Return the joints that a transmission or ros2_control turns, and the lines that say so."""
    found = {}
    for block in root.all("transmission"):
        for joint in block.all("joint"):
            found[joint.attribute("name")] = joint.where
    for block in root.all("ros2_control"):
        for joint in block.all("joint"):
            if any(joint.all("command_interface")):
                found[joint.attribute("name")] = joint.where
    return found
