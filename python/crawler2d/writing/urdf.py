"""A neutral tree as URDF, with friction as Gazebo and as Bullet read it."""

from __future__ import annotations

from crawler2d.models.poses import Pose
from crawler2d.models.tree import Joint, Link, Shape, Tree
from crawler2d.writing.held import Format
from crawler2d.writing.xml import XML, element, exactly, numbers

__all__ = ["URDF", "urdf_of"]

URDF = Format(name="URDF", moves_surfaces=False, has_hulls=False, has_rotors=False)
"""URDF has meshes in files of their own only, and nothing that moves a surface. A rotor inertia has
a place in extensions of Drake only."""

_UPPER = [(row, column) for row in range(3) for column in range(row, 3)]


def urdf_of(tree: Tree) -> XML:
    """Write a robot in the frame of its root."""
    links = tree.by_name
    root = element("robot", name=tree.name)
    for link in tree.links:
        root.append(_link(link))
        if link.name in tree.joints:
            joint = tree.joints[link.name]
            root.append(_joint(joint, link, links[joint.parent]))
    for link in tree.links:
        friction = _friction(link)
        if friction is not None:
            pair = (element(f"mu{n}", text=numbers(friction)) for n in (1, 2))
            root.append(element("gazebo", *pair, reference=link.name))
    return root


def _origin(pose: Pose) -> XML:
    return element("origin", xyz=numbers(pose.place), rpy=numbers(pose.rpy))


def _link(link: Link) -> XML:
    center = Pose(place=link.center).seen_from(link.pose)
    moments = link.pose.turn.T @ link.inertia @ link.pose.turn
    inertia = {f"i{'xyz'[i]}{'xyz'[j]}": exactly(float(moments[i, j])) for i, j in _UPPER}
    made = element(
        "link",
        element(
            "inertial",
            _origin(Pose(place=center.place)),
            element("mass", value=numbers(link.mass)),
            element("inertia", **inertia),
        ),
        name=link.name,
    )
    for shape in link.shapes:
        origin = shape.pose.seen_from(link.pose)
        for tag in ("collision", "visual"):
            made.append(element(tag, _origin(origin), _geometry(shape), name=f"{shape.name}_{tag}"))
    friction = _friction(link)
    if friction is not None:
        made.append(element("contact", element("lateral_friction", value=numbers(friction))))
    return made


def _geometry(shape: Shape) -> XML:
    if shape.kind == "box":
        return element("geometry", element("box", size=numbers(shape.size)))
    sizes = {"radius": numbers(shape.radius), "length": numbers(shape.length)}
    return element("geometry", element("cylinder", **sizes))


def _friction(link: Link) -> float | None:
    """[-] Return the coefficient of a link: URDF has one for all of its shapes."""
    return next((shape.friction.first for shape in link.shapes if shape.friction), None)


def _joint(joint: Joint, link: Link, parent: Link) -> XML:
    kind = {"fixed": "fixed", "hinge": "continuous" if joint.is_unlimited else "revolute"}
    made = element(
        "joint",
        element("parent", link=joint.parent),
        element("child", link=joint.child),
        _origin(link.pose.seen_from(parent.pose)),
        name=joint.name,
        type=kind[joint.kind],
    )
    if joint.kind == "fixed":
        return made
    limits = [("effort", joint.effort), ("velocity", joint.velocity)]
    if not joint.is_unlimited:
        limits += [("lower", joint.lower), ("upper", joint.upper)]
    given = {name: numbers(value) for name, value in limits if value is not None}
    axis = link.pose.turn.T @ joint.axis
    made.extend([element("axis", xyz=numbers(axis)), element("limit", **given)])
    return made
