"""What SDF and URDF share: shapes, inertias, joints, plugins, and the order of links in a tree."""

from __future__ import annotations

import difflib
import math
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from crawler2d.errors import ScenarioError
from crawler2d.model_tree import (
    Array,
    Friction,
    Joint,
    Plugin,
    Pose,
    Shape,
    Tree,
    Unread,
    Where,
    unit,
)
from crawler2d.reading.elements import Element
from crawler2d.reading.log import Doubt
from crawler2d.reading.meshes import Meshes

__all__ = [
    "Limit",
    "carrying",
    "checked",
    "collisions",
    "driven_by",
    "ellipsoid",
    "inertia",
    "joint_of",
    "moved_links",
    "moving",
    "named_tracks",
    "plugin_of",
    "settled",
    "shape_of",
    "solid",
    "wheel_torques",
]

_AXES = (("ixx", 0, 0), ("ixy", 0, 1), ("ixz", 0, 2), ("iyy", 1, 1), ("iyz", 1, 2), ("izz", 2, 2))


# The sizes of each shape, with how many numbers each has.
_SIZES = {
    "box": (("size", 3),),
    "capsule": (("radius", 1), ("length", 1)),
    "cone": (("radius", 1), ("length", 1)),
    "cylinder": (("radius", 1), ("length", 1)),
    "ellipsoid": (("radii", 3),),
    "sphere": (("radius", 1),),
}


_CIRCLE = np.linspace(0.0, 2.0 * math.pi, 64, endpoint=False)  # its chords fall short by 0.12 %


Numbers = Callable[[Element, str, int], list[float]]
"""Reads so many numbers of a name: SDF has them as elements, URDF as attributes."""


def shape_of(
    collision: Element,
    *,
    name: str,
    pose: Pose,
    pose_at: Element,
    friction: Friction | None,
    numbers: Numbers,
    mesh_name: Callable[[Element], str],
    meshes: Meshes,
) -> Shape | Unread | None:
    """Read the geometry of a collision; None if it is empty, what is left out is unread."""
    geometry = collision.needed("geometry")
    kinds = [child for child in geometry.children if child.tag != "empty"]
    if not kinds:
        return None
    if len(kinds) > 1:
        kinds[1].refuse(kinds[1].tag, "must be the only shape of its collision")
    (element,) = kinds
    kind = element.tag
    shape = Shape(
        name=name,
        kind=kind,
        pose=pose,
        friction=friction,
        at=collision.where,
        pose_at=pose_at.where,
        size_at=(element.only("radius") or element).where,
    )
    if kind == "mesh":
        scale = [1.0, 1.0, 1.0]
        if element.only("scale") is not None or "scale" in element.attributes:
            scale = numbers(element, "scale", 3)
        return meshes.hull(shape, element, mesh_name(element), scale)
    return _sized(shape, element, numbers, meshes)


def _sized(shape: Shape, element: Element, numbers: Numbers, meshes: Meshes) -> Shape | Unread:
    """Return a shape with its sizes."""
    kind = shape.kind
    if kind not in _SIZES:
        return meshes.left_out(element, kind, "no shape that a side view knows")
    sizes = [size for word, count in _SIZES[kind] for size in numbers(element, word, count)]
    if min(sizes) < 0.0:
        element.refuse(min(sizes), "must have sizes >= 0 m")
    if kind == "capsule" and sizes[1] == 0.0:
        kind = "sphere"
    elif 0.0 in sizes:
        return meshes.left_out(element, kind, "a size of 0, with which it touches nothing")
    if kind == "box":
        return replace(shape, size=np.array(sizes))
    if kind in ("cone", "ellipsoid"):
        points = _cone(*sizes) if kind == "cone" else ellipsoid(sizes)
        return replace(shape, kind="hull", points=shape.pose.at(points))
    radius, length = sizes[0], sizes[1] if kind != "sphere" else 0.0
    return replace(shape, kind=kind, radius=radius, length=length)


def collisions(
    found: Iterable[Shape | Unread | None],
) -> tuple[tuple[Shape, ...], tuple[Unread, ...]]:
    """Return the shapes of a link, and those that were left out."""
    every = list(found)
    shapes = tuple(each for each in every if isinstance(each, Shape))
    return shapes, tuple(each for each in every if isinstance(each, Unread))


def ellipsoid(radii: list[float]) -> Array:
    """[m] Return points on an ellipsoid about the origin, whose hull stands for it."""
    turns, heights = np.meshgrid(_CIRCLE, np.linspace(0.0, math.pi, 33))
    ball = [np.sin(heights) * np.cos(turns), np.sin(heights) * np.sin(turns), np.cos(heights)]
    points: Array = np.stack(ball, axis=-1).reshape(-1, 3) * radii
    return points


def _cone(radius: float, length: float) -> Array:
    """[m] Return corners of a cone, with half of its length on either side of the origin."""
    rim = [radius * np.cos(_CIRCLE), radius * np.sin(_CIRCLE), np.full_like(_CIRCLE, -0.5 * length)]
    return np.concatenate([np.stack(rim, axis=1), [[0.0, 0.0, 0.5 * length]]])


def inertia(element: Element, value: Callable[[str], float], doubts: list[Doubt]) -> Array:
    """Read a tensor of inertia [kg m^2] by the names of its six components.

    One with a negative moment is doubted and taken as 0, that of a point: a guess at its size would
    be worse, and what a link has of its own counts little beside where it is.
    """
    tensor = np.zeros((3, 3))
    for name, row, column in _AXES:
        tensor[row, column] = tensor[column, row] = value(name)
    least = float(tensor.diagonal().min())
    if least < 0.0:
        doubts.append((element.at, least, "is taken as 0 kg m^2: no body has a negative moment"))
        return np.zeros((3, 3))
    return tensor


def solid(shapes: Sequence[Shape], density: float) -> tuple[float, Array, Array]:
    """Return mass [kg], centre [m] and inertia [kg m^2] about it, of shapes that are filled."""
    parts = [_filled(shape, density) for shape in shapes]
    masses = np.array([own for own, _ in parts])
    places = np.array([shape.pose.place for shape in shapes])
    center = masses @ places / masses.sum()
    tensor = np.zeros((3, 3))
    for shape, (own, moments), away in zip(shapes, parts, places - center, strict=True):
        tensor += shape.pose.turn @ np.diag(moments) @ shape.pose.turn.T
        tensor += own * (away @ away * np.eye(3) - np.outer(away, away))
    return float(masses.sum()), center, tensor


def _filled(shape: Shape, density: float) -> tuple[float, list[float]]:
    """Return mass [kg] and principal moments [kg m^2] of a shape in its own frame."""
    if shape.kind == "box":
        mass = density * float(np.prod(shape.size))
        squares = shape.size**2
        return mass, [mass * (sum(squares) - own) / 12.0 for own in squares]
    radius, length = shape.radius, shape.length
    straight = density * math.pi * radius**2 * length
    ends = 0.0 if shape.kind == "cylinder" else density * 4.0 / 3.0 * math.pi * radius**3
    across = straight * (radius**2 / 4.0 + length**2 / 12.0)
    across += ends * (0.4 * radius**2 + length**2 / 4.0 + 0.375 * length * radius)
    along = straight * radius**2 / 2.0 + ends * 0.4 * radius**2
    return straight + ends, [across, across, along]


_DEEPEST_SETTING = 3  # no setting of a plugin that is read lies deeper


def plugin_of(plugin: Element) -> Plugin:
    """Flatten the settings of a plugin."""
    settings: list[tuple[str, str, Where]] = []
    waiting = [(child, child.tag) for child in reversed(plugin.children)]
    while waiting:
        element, path = waiting.pop()
        settings.append((path, element.text, element.where))
        if path.count("/") < _DEEPEST_SETTING:
            waiting.extend((child, f"{path}/{child.tag}") for child in reversed(element.children))
    name, filename = (plugin.attributes.get(key, "") for key in ("name", "filename"))
    return Plugin(name=name, filename=filename, settings=tuple(settings), at=plugin.where)


def driven_by(plugins: tuple[Plugin, ...]) -> dict[str, Where]:
    """Return the joints that a differential drive turns, and the lines that say so."""
    return {
        joint: where
        for plugin in plugins
        if "diff" in f"{plugin.name} {plugin.filename}".lower()
        for joint, where in plugin.values("left_joint", "right_joint", "leftJoint", "rightJoint")
    }


def wheel_torques(plugins: tuple[Plugin, ...]) -> dict[str, tuple[float, Where]]:
    """[N m] Return the torques that differential drives of Gazebo Classic give to joints."""
    found: dict[str, tuple[float, Where]] = {}
    for plugin in plugins:
        for text, where in plugin.values("max_wheel_torque", "wheelTorque", "torque"):
            try:
                torque = float(text)
            except ValueError:
                continue
            if 0.0 < torque < math.inf:
                found |= dict.fromkeys(driven_by((plugin,)), (torque, where))
    return found


def moved_links(tree: Tree) -> dict[str, Where]:
    """Return the links whose surface is moved, and the lines that say so."""
    links = tree.by_name
    named = {name: where for name, where in named_tracks(tree.plugins) if name in links}
    return named | {name: links[name].at for name in tree.tracks}


def named_tracks(plugins: Iterable[Plugin]) -> Iterator[tuple[str, Where]]:
    """Yield what plugins name as tracks, with the lines; not all of it need be links."""
    for plugin in plugins:
        if "track" in f"{plugin.name} {plugin.filename}".lower():
            for path, text, where in plugin.settings:
                if path.rpartition("/")[2] in _TRACKS:
                    yield text, where


# Gazebo's TrackController has link; its TrackedVehicle left_track/link and right_track/link; the
# plugins of Gazebo classic name the links of tracks and flippers like this.
_TRACKS = {"link", "left_track", "right_track", "left_flipper", "right_flipper"}


_KINDS = {"revolute": "hinge", "continuous": "hinge", "prismatic": "slide"}


Limit = tuple[float, Where]
"""A figure of a joint and its line. A negative or infinite limit of effort or speed is none."""


def joint_of(element: Element, name: str, parent: str, child: str, pose: Pose) -> Joint:
    """Return a joint as far as its axis plays no part.

    Parameters
    ----------
    element : Element
        The joint.
    name : str
        Its name.
    parent, child : str
        The links that it joins.
    pose : Pose
        Of its frame.
    """
    kind = element.attribute("type")
    return Joint(
        name=name,
        kind=_KINDS.get(kind, kind),
        parent=parent,
        child=child,
        place=pose.place,
        axis=pose.turn[:, 2],
        at=element.where,
        effort_at=element.where,
        velocity_at=element.where,
        dynamics_at=element.where,
    )


def settled(
    made: Joint, moves: Callable[[], Joint], *, carries: bool, doubts: list[Doubt]
) -> Joint:
    """Return a joint that moves, or a fixed one where what is wrong with it makes no difference.

    Parameters
    ----------
    made : Joint
        What `joint_of` made of it.
    moves : callable
        Returns it with its axis and limits, or raises what is wrong with them.
    carries : bool
        Whether anything that hangs on it collides.
    doubts : list of Doubt
        Where it is noted.
    """
    try:
        return moves()
    except ScenarioError as error:
        if carries:
            raise
        reason = f"is taken as fixed, for nothing on its joint collides: {error.rule}"
        doubts.append((error.path, error.value, reason))
        return replace(made, kind="fixed")


def moving(
    joint: Joint,
    element: Element,
    along: Array,
    *,
    bounds: tuple[float, float],
    effort: Limit | None,
    velocity: Limit | None,
    dynamics: Mapping[str, Limit],
) -> Joint:
    """Return a joint with its axis and limits.

    Parameters
    ----------
    joint : Joint
        What `joint_of` made of it.
    element : Element
        That errors are about.
    along : ndarray, shape (3,)
        Along its axis, of any length.
    bounds : tuple of float
        [rad] or [m] The lower and the upper limit.
    effort, velocity : Limit or None
        As the file has them.
    dynamics : mapping of str to Limit
        "stiffness", "damping" and "friction" as far as the file has them.

    Raises
    ------
    ScenarioError
        If a joint that is not locked has an axis without a direction, or the lower limit is above
        the upper.
    """
    axis, (lower, upper) = unit(along), bounds
    stiffness, damping, friction = (
        dynamics[name][0] if name in dynamics else 0.0
        for name in ("stiffness", "damping", "friction")
    )
    if axis is None and lower == upper:
        return replace(joint, kind="fixed")  # locked, so it needs none
    if axis is None:
        element.refuse("0 0 0", "must have an axis with a direction")
    if lower > upper:
        element.refuse(lower, f"must have a lower limit of at most the upper, {upper}")
    return replace(
        joint,
        axis=axis,
        lower=lower,
        upper=upper,
        effort=_figure(effort),
        velocity=_figure(velocity),
        stiffness=stiffness,
        damping=max(0.0, damping),
        friction=max(0.0, friction),
        effort_at=effort[1] if effort else joint.at,
        velocity_at=velocity[1] if velocity else joint.at,
        dynamics_at=next((where for _, where in dynamics.values()), joint.at),
    )


def _figure(limit: Limit | None) -> float | None:
    return limit[0] if limit is not None and 0.0 <= limit[0] < math.inf else None


_MOST_LINKS = 1000


_LONGEST_NAME = 200


def checked(
    names: list[tuple[str, Where]],
    joints: list[tuple[str, str, str, Where]],
    at: Where,
    doubts: list[Doubt],
    *,
    driving: Collection[str] = (),
    remedy: str = "",
) -> list[str]:
    """Return the links of one tree in an order in which parents precede children.

    If there are several trees, that is taken which has the most links that may drive it, and of
    equal ones the largest.

    Parameters
    ----------
    names : list of (str, Where)
        The links.
    joints : list of (str, str, str, Where)
        Name, parent and child of each joint.
    at : Where
        Line of the model.
    doubts : list of Doubt
        Where trees that are left out, and names that repeat, are noted.
    driving : collection of str
        Links that turn without limit, or whose surface moves.
    remedy : str
        What to do about joints of links that are missing, as the end of a rule.

    Raises
    ------
    ScenarioError
        If names of links repeat, or a link is missing, has two parents, or hangs on itself.
    """
    seen = _links_of(names, at)
    if len(joints) > _MOST_LINKS:
        raise ScenarioError(str(at), len(joints), f"must have at most {_MOST_LINKS} joints")
    named: set[str] = set()
    children: dict[str, list[str]] = {name: [] for name, _ in names}
    parent_of: dict[str, str] = {}
    for name, parent, child, where in joints:
        if name in named:
            doubts.append((f"{where}: joint[{name}]", name, "is the name of another joint, too"))
        named.add(name)
        for end in (parent, child):
            if end not in seen:
                near = difflib.get_close_matches(end, seen, n=1)
                meant = f", of which the nearest is {near[0]}" if near else ""
                rule = f"must join links of the model{meant}{remedy}"
                raise ScenarioError(f"{where}: joint[{name}]", end, rule)
        if child in parent_of:
            rule = "must be the only joint that holds its child: a chain of links must be open"
            raise ScenarioError(f"{where}: joint[{name}]", child, rule)
        parent_of[child] = parent
        children[parent].append(child)
    if len(parent_of) == len(seen):
        rule = "must have one link that hangs on no other"
        raise ScenarioError(str(at), "links in a circle", rule)
    trees = {name: [name] for name, _ in names if name not in parent_of}
    for tree in trees.values():
        for name in tree:
            tree.extend(children[name])
    reached = {name for tree in trees.values() for name in tree}
    if len(reached) < len(seen):
        rule = "must hang on the root, not on itself in a circle"
        raise ScenarioError(str(at), min(seen - reached), rule)
    drives = set(driving)
    root = max(trees, key=lambda name: (len(drives.intersection(trees[name])), len(trees[name])))
    for name, where in names:
        if name in trees and name != root:
            more = len(trees[name]) - 1
            hanging = f" with {more} that hang on it" if more else ""
            reason = f"is left out{hanging}: it is not joined to {root}"
            doubts.append((f"{where}: link[{name}]", name, reason))
    return trees[root]


def carrying(
    order: list[str], parent_of: Mapping[str, str], colliding: Collection[str]
) -> set[str]:
    """Return the links that collide, and those from which such hang.

    Parameters
    ----------
    order : list of str
        All links, parents before their children.
    parent_of : mapping of str to str
        The link from which each hangs.
    colliding : collection of str
        The links with shapes.
    """
    found = set(colliding)
    for name in reversed(order):
        if name in found and name in parent_of:
            found.add(parent_of[name])
    return found


def _links_of(names: list[tuple[str, Where]], at: Where) -> set[str]:
    """Return the names of the links, if there are some, not too many, and no two alike."""
    if not names:
        raise ScenarioError(str(at), "no link", "must have a link")
    if len(names) > _MOST_LINKS:
        raise ScenarioError(str(at), len(names), f"must have at most {_MOST_LINKS} links")
    seen: set[str] = set()
    for name, where in names:
        if len(name) > _LONGEST_NAME:
            raise ScenarioError(str(where), name, f"must have at most {_LONGEST_NAME} letters")
        if name in seen:
            raise ScenarioError(str(where), name, "must be a name that no other link has")
        seen.add(name)
    return seen
