"""Joints and plugins as SDF and URDF write them, and links and joints in the order of one tree."""

from __future__ import annotations

import difflib
import math
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from dataclasses import replace

from crawler2d.errors import ScenarioError
from crawler2d.model_tree import Array, Joint, Plugin, Pose, Tree, Where, unit
from crawler2d.reading.elements import Element
from crawler2d.reading.log import Doubt

__all__ = [
    "Limit",
    "carrying",
    "checked",
    "driven_by",
    "joint_of",
    "moved_links",
    "moving",
    "named_tracks",
    "plugin_of",
    "settled",
    "wheel_torques",
]

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
