"""Read shapes, inertias, joints and plugins of SDF and URDF, and order links in a tree."""

from __future__ import annotations

import difflib
import math
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from crawler2d.errors import ScenarioError
from crawler2d.model_tree import (
    Array,
    Coupling,
    Joint,
    Link,
    Plugin,
    Pose,
    Shape,
    Tree,
    Unread,
    Where,
    unit,
)
from crawler2d.reading.log import ReadingWarning
from crawler2d.reading.meshes import Meshes
from crawler2d.reading.parsing import Element, real

__all__ = [
    "ON_ITS_OWN",
    "Limit",
    "coefficient",
    "collision_ancestors",
    "collisions",
    "driven_by",
    "driven_on",
    "ellipsoid",
    "inertia",
    "is_drive",
    "joint_of",
    "joint_or_fixed",
    "mimic_coupling",
    "moved_links",
    "moving_joint",
    "named_tracks",
    "order_links",
    "plugin_of",
    "shape_of",
    "slips_of",
    "solid",
    "warn_of_tilt",
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

_CIRCLE = np.linspace(0.0, 2.0 * math.pi, 64, endpoint=False)  # chords are up to 0.12 % inside

Numbers = Callable[[Element, str, int], list[float]]
"""Reads so many numbers of a name: SDF has them as elements, URDF as attributes."""

_DEEPEST_SETTING = 3  # settings of plugins are at most this deep

# Gazebo's TrackController has link; its TrackedVehicle left_track/link and right_track/link; the
# plugins of Gazebo classic name the links of tracks and flippers like this.
_TRACKS = {"link", "left_track", "right_track", "left_flipper", "right_flipper"}

# Gazebo's DiffDrive has left_joint; those of Gazebo classic leftJoint, and for four wheels these.
_DRIVEN = (
    *("left_joint", "right_joint", "leftJoint", "rightJoint"),
    *("leftFrontJoint", "rightFrontJoint", "leftRearJoint", "rightRearJoint"),
)

_KINDS = {"revolute": "hinge", "continuous": "hinge", "prismatic": "slide"}

ON_ITS_OWN = "is left out: the joint is read as one that moves by itself, within its own limits"
"""Treatment of a joint that follows another one."""

Limit = tuple[float, Where]
"""A figure of a joint and its line. A negative or infinite effort or speed is no limit."""

_MOST_LINKS = 1000
_USUAL_FRICTION = 1.0  # default of SDF
_LONGEST_NAME = 200
_UPRIGHT = 0.01  # [rad] A root with a smaller tilt counts as upright.


def shape_of(
    shape: Shape,
    collision: Element,
    meshes: Meshes,
    *,
    numbers: Numbers,
    mesh_name: Callable[[Element], str],
) -> Shape | Unread | None:
    """Return a shape with the geometry of its collision; None if that is empty."""
    geometry = collision.needed("geometry")
    kinds = [child for child in geometry.children if child.tag != "empty"]
    if not kinds:
        return None
    if len(kinds) > 1:
        kinds[1].refuse(kinds[1].tag, "must be the only shape of its collision")
    (element,) = kinds
    kind = element.tag
    size_at = (element.only("radius") or element).where
    shape = replace(shape, kind=kind, size_at=size_at, at=collision.where)
    if kind == "mesh":
        has_scale = element.only("scale") is not None or "scale" in element.attributes
        scale = numbers(element, "scale", 3) if has_scale else [1.0, 1.0, 1.0]
        return meshes.hull(shape, element, mesh_name(element), scale)
    if kind not in _SIZES:
        return meshes.leave_out(element, kind, "unsupported shape")
    sizes = [size for word, count in _SIZES[kind] for size in numbers(element, word, count)]
    if min(sizes) < 0.0:
        element.refuse(min(sizes), "must have sizes >= 0 m")
    if kind == "capsule" and sizes[1] == 0.0:
        kind = "sphere"
    elif 0.0 in sizes:
        return meshes.leave_out(element, kind, "its size is 0, and it touches nothing")
    if kind == "box":
        shape = replace(shape, size=np.array(sizes))
    elif kind in ("cone", "ellipsoid"):
        points = _cone(*sizes) if kind == "cone" else ellipsoid(sizes)
        shape = replace(shape, kind="hull", points=shape.pose.at(points))
    else:
        length = sizes[1] if kind != "sphere" else 0.0
        shape = replace(shape, kind=kind, radius=sizes[0], length=length)
    return shape


def collisions(
    parts: Iterable[Shape | Unread | None],
) -> tuple[tuple[Shape, ...], tuple[Unread, ...]]:
    """Return the shapes of a link, and those that were left out."""
    every = list(parts)
    shapes = tuple(each for each in every if isinstance(each, Shape))
    return shapes, tuple(each for each in every if isinstance(each, Unread))


def ellipsoid(radii: list[float]) -> Array:
    """[m] Return points on an ellipsoid about the origin, whose hull approximates it."""
    turns, heights = np.meshgrid(_CIRCLE, np.linspace(0.0, math.pi, 33))
    ball = [np.sin(heights) * np.cos(turns), np.sin(heights) * np.sin(turns), np.cos(heights)]
    points: Array = np.stack(ball, axis=-1).reshape(-1, 3) * radii
    return points


def inertia(
    element: Element, value: Callable[[str], float], warnings: list[ReadingWarning]
) -> Array:
    """Read a tensor of inertia [kg m^2] by the names of its six components.

    A tensor with a negative moment is taken as 0, that of a point, with a warning: guessing its
    size would be worse, and the position of a link matters more than its own inertia.
    """
    tensor = np.zeros((3, 3))
    for name, row, column in _AXES:
        tensor[row, column] = tensor[column, row] = value(name)
    least = float(tensor.diagonal().min())
    if least < 0.0:
        warnings.append((element.at, least, "is taken as 0 kg m^2: no body has a negative moment"))
        return np.zeros((3, 3))
    return tensor


def solid(shapes: Sequence[Shape], densities: Sequence[float]) -> tuple[float, Array, Array]:
    """Return mass [kg], centre [m] and inertia [kg m^2] about it, of solid shapes."""
    parts = [_filled(*each) for each in zip(shapes, densities, strict=True)]
    masses = np.array([own for own, _ in parts])
    places = np.array([shape.pose.place for shape in shapes])
    center = masses @ places / masses.sum()
    tensor = np.zeros((3, 3))
    for shape, (own, moments), away in zip(shapes, parts, places - center, strict=True):
        tensor += shape.pose.turn @ np.diag(moments) @ shape.pose.turn.T
        tensor += own * (away @ away * np.eye(3) - np.outer(away, away))
    return float(masses.sum()), center, tensor


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


def is_drive(plugin: Plugin) -> bool:
    """Whether a plugin is a differential or skid-steer drive."""
    return plugin.is_one_of("diff", "skid")


def driven_on(plugin: Plugin, side: str) -> list[tuple[str, Where]]:
    """Return the joints that a drive has as those on the left or right, with their lines."""
    return plugin.values(*(name for name in _DRIVEN if name.startswith(side)))


def driven_by(plugins: tuple[Plugin, ...]) -> dict[str, Where]:
    """Return the joints that a differential or skid-steer drive turns, with their lines."""
    return {
        joint: where
        for plugin in plugins
        if is_drive(plugin)
        for joint, where in plugin.values(*_DRIVEN)
    }


def wheel_torques(plugins: tuple[Plugin, ...]) -> dict[str, tuple[float, Where]]:
    """[N m] Return the torques that differential drives of Gazebo Classic give to joints."""
    torques: dict[str, tuple[float, Where]] = {}
    for plugin in plugins:
        for torque, where in plugin.numbers("max_wheel_torque", "wheelTorque", "torque"):
            if 0.0 < torque < math.inf:
                torques |= dict.fromkeys(driven_by((plugin,)), (torque, where))
    return torques


def moved_links(tree: Tree) -> dict[str, Where]:
    """Return the links with moved surfaces, and the lines that say so."""
    links = tree.by_name
    moved = {name: where for name, where in named_tracks(tree.plugins) if name in links}
    return moved | {name: links[name].at for name in tree.tracks}


def named_tracks(plugins: Iterable[Plugin]) -> Iterator[tuple[str, Where]]:
    """Yield the names of tracks in plugins, with lines; some may not be links."""
    for plugin in plugins:
        if plugin.is_one_of("track"):
            for path, text, where in plugin.settings:
                if path.rpartition("/")[2] in _TRACKS:
                    yield text, where


def joint_of(element: Element, name: str, parent: str, child: str, pose: Pose) -> Joint:
    """Return a joint without its axis and limits.

    Parameters
    ----------
    element : Element
        The joint.
    name : str
        Its name.
    parent, child : str
        The joined links.
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
    )


def joint_or_fixed(
    joint: Joint, complete: Callable[[], Joint], *, carries: bool, warnings: list[ReadingWarning]
) -> Joint:
    """Return a joint with axis and limits, or a fixed one if its faults do not matter.

    Parameters
    ----------
    joint : Joint
        As from `joint_of`.
    complete : callable
        Returns the joint with axis and limits, or raises the error of a broken rule.
    carries : bool
        Whether anything in its subtree collides.
    warnings : list of ReadingWarning
        Gets a warning about the fault.
    """
    try:
        return complete()
    except ScenarioError as error:
        if carries:
            raise
        reason = f"is taken as fixed, as nothing on its joint collides: {error.rule}"
        warnings.append((error.path, error.value, reason))
        return replace(joint, kind="fixed")


def moving_joint(
    joint: Joint, element: Element, along: Array, figures: Mapping[str, Limit]
) -> Joint:
    """Return a joint with its axis and limits.

    Parameters
    ----------
    joint : Joint
        As from `joint_of`.
    element : Element
        The element of its axis, for errors.
    along : ndarray, shape (3,)
        Along its axis, of any length.
    figures : mapping of str to Limit
        "lower", "upper", "effort", "velocity", "stiffness", "damping" and "friction" as far as the
        file has them.

    Raises
    ------
    ScenarioError
        If a joint that is not locked has an axis without a direction, or the lower limit is above
        the upper.
    """
    axis = unit(along)
    value = {name: number for name, (number, _) in figures.items()}
    lower, upper = value.get("lower", -math.inf), value.get("upper", math.inf)
    if axis is None and lower == upper:
        return replace(joint, kind="fixed")  # locked, so it needs none
    if axis is None:
        element.refuse("0 0 0", "must have an axis with a direction")
    if lower > upper:
        element.refuse(lower, f"must have a lower limit of at most the upper, {upper}")
    effort, velocity = (
        value[name] if 0.0 <= value.get(name, math.inf) < math.inf else None
        for name in ("effort", "velocity")
    )
    at = {name: where for name, (_, where) in figures.items()}
    dynamics = ("stiffness", "damping", "friction")
    return replace(
        joint,
        axis=axis,
        lower=lower,
        upper=upper,
        effort=effort,
        velocity=velocity,
        stiffness=value.get("stiffness", 0.0),
        damping=max(0.0, value.get("damping", 0.0)),
        friction=max(0.0, value.get("friction", 0.0)),
        range_at=at.get("lower", at.get("upper", joint.at)),
        effort_at=at.get("effort", joint.at),
        velocity_at=at.get("velocity", joint.at),
        dynamics_at=next((at[name] for name in dynamics if name in at), joint.at),
    )


def mimic_coupling(name: str, mimic: Element, multiplier: str, offset: str) -> Coupling:
    """Return the coupling by which a joint of this name follows another one."""
    leader = mimic.attributes.get("joint", "none")
    value = f"{leader}, times {multiplier or '1'} plus {offset or '0'} rad"
    return Coupling(
        joints=(name,), name=f"mimic[{name}]", value=value, reason=ON_ITS_OWN, at=mimic.where
    )


def warn_of_tilt(path: str, pose: Pose, what: str, warnings: list[ReadingWarning]) -> None:
    """Warn of the pose of a root that is not upright: a model is read in the frame of its root."""
    tilt = math.acos(min(1.0, max(-1.0, float(pose.turn[2, 2]))))
    if tilt > _UPRIGHT:
        reason = f"is left out: the z axis of the {what} is taken as upwards"
        warnings.append((path, f"{math.degrees(tilt):.3g} degrees off upright", reason))


def coefficient(element: Element | None, owner: Element) -> Limit:
    """[-] Read a coefficient of friction from a text or a value; 1 where there is none."""
    if element is None:
        return _USUAL_FRICTION, owner.where
    value = real(element, element.attributes.get("value", "") or element.text, unlimited=True)
    if value < 0.0:
        element.refuse(value, "must be >= 0")
    return value, element.where


def slips_of(slips: Sequence[Element | None], at: Where) -> tuple[Limit, ...]:
    """[m/s per N] Read the slip along both directions of a surface; empty if neither is given."""
    return tuple(
        (0.0, at) if each is None else (real(each, each.text), each.where)
        for each in (slips if any(slips) else ())
    )


def order_links(
    names: list[tuple[str, Where]],
    joints: list[tuple[str, str, str, Where]],
    at: Where,
    warnings: list[ReadingWarning],
    *,
    driving: Collection[str] = (),
    remedy: str = "",
) -> list[str]:
    """Return the links of one tree in an order in which parents precede children.

    Of several trees, the one with the most links that may drive it counts, and of equal ones the
    largest.

    Parameters
    ----------
    names : list of (str, Where)
        The links.
    joints : list of (str, str, str, Where)
        Name, parent and child of each joint.
    at : Where
        Line of the model.
    warnings : list of ReadingWarning
        Takes trees that are left out, and names that repeat.
    driving : collection of str
        Links that turn without limit, or whose surface moves.
    remedy : str
        What to do about joints of links that are missing, as the end of a rule.

    Raises
    ------
    ScenarioError
        If names of links repeat, or a link is missing, has two parents, or hangs on itself.
    """
    links = _check_names(names, at)
    if len(joints) > _MOST_LINKS:
        raise ScenarioError(str(at), len(joints), f"must have at most {_MOST_LINKS} joints")
    known: set[str] = set()
    children: dict[str, list[str]] = {name: [] for name, _ in names}
    parent_of: dict[str, str] = {}
    for name, parent, child, where in joints:
        path = f"{where}: joint[{name}]"
        if name in known:
            warnings.append((path, name, "is also the name of another joint"))
        known.add(name)
        for end in (parent, child):
            if end not in links:
                close = difflib.get_close_matches(end, links, n=1)
                meant = f" (did you mean {close[0]}?)" if close else ""
                raise ScenarioError(path, end, f"must join links of the model{meant}{remedy}")
        if child in parent_of:
            rule = "must be the only joint that holds its child: a chain of links must be open"
            raise ScenarioError(path, child, rule)
        parent_of[child] = parent
        children[parent].append(child)
    if len(parent_of) == len(links):
        rule = "must have one link that hangs on no other"
        raise ScenarioError(str(at), "links in a circle", rule)
    trees = {name: [name] for name, _ in names if name not in parent_of}
    for tree in trees.values():
        for name in tree:
            tree.extend(children[name])
    reached = {name for tree in trees.values() for name in tree}
    if len(reached) < len(links):
        rule = "must hang on the root, not on itself in a circle"
        raise ScenarioError(str(at), min(links - reached), rule)
    drives = set(driving)
    root = max(trees, key=lambda name: (len(drives.intersection(trees[name])), len(trees[name])))
    for name, where in names:
        if name in trees and name != root:
            more = len(trees[name]) - 1
            hanging = f" with {more} that hang on it" if more else ""
            reason = f"is left out{hanging}: it is not joined to {root}"
            warnings.append((f"{where}: link[{name}]", name, reason))
    return trees[root]


def collision_ancestors(links: Sequence[Link], parent_of: Mapping[str, str]) -> set[str]:
    """Return the links that collide, and those from which such hang.

    Parameters
    ----------
    links : sequence of Link
        All links, parents before their children.
    parent_of : mapping of str to str
        The link from which each hangs.
    """
    names: set[str] = set()
    for link in reversed(links):
        if link.shapes or link.unread or link.name in names:
            names |= {link.name, parent_of.get(link.name, link.name)}
    return names


def _cone(radius: float, length: float) -> Array:
    """[m] Return corners of a cone, with half of its length on either side of the origin."""
    rim = [radius * np.cos(_CIRCLE), radius * np.sin(_CIRCLE), np.full_like(_CIRCLE, -0.5 * length)]
    return np.concatenate([np.stack(rim, axis=1), [[0.0, 0.0, 0.5 * length]]])


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


def _check_names(names: list[tuple[str, Where]], at: Where) -> set[str]:
    """Return the names of the links, if there are some, not too many, and no two alike."""
    if not names:
        raise ScenarioError(str(at), "no link", "must have a link")
    if len(names) > _MOST_LINKS:
        raise ScenarioError(str(at), len(names), f"must have at most {_MOST_LINKS} links")
    unique: set[str] = set()
    for name, where in names:
        if len(name) > _LONGEST_NAME:
            raise ScenarioError(str(where), name, f"must have at most {_LONGEST_NAME} letters")
        if name in unique:
            raise ScenarioError(str(where), name, "must be a name that no other link has")
        unique.add(name)
    return unique
