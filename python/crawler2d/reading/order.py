"""Links and joints as one tree: parents before children, nothing twice, nothing in a circle."""

from __future__ import annotations

import difflib
from collections.abc import Collection, Mapping

from crawler2d.errors import ScenarioError
from crawler2d.models.where import Where
from crawler2d.reading.telling import Doubt

__all__ = ["carrying", "checked"]

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
