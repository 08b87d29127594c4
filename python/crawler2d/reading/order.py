"""Links and joints as one tree: parents before children, nothing twice, nothing in a circle."""

from __future__ import annotations

import difflib

from crawler2d.errors import ScenarioError
from crawler2d.models.where import Where

__all__ = ["checked"]

_MOST_LINKS = 1000
_LONGEST_NAME = 200


def checked(
    names: list[tuple[str, Where]],
    joints: list[tuple[str, str, str, Where]],
    at: Where,
    *,
    remedy: str = "",
) -> list[str]:
    """Return the links in an order in which parents precede children, if they are one tree.

    Parameters
    ----------
    names : list of (str, Where)
        The links.
    joints : list of (str, str, str, Where)
        Name, parent and child of each joint.
    at : Where
        Line of the model.
    remedy : str
        What to do about joints of links that are missing, as the end of a rule.

    Raises
    ------
    ScenarioError
        If names repeat, a link is missing, has two parents, hangs on nothing or on itself.
    """
    seen = _links_of(names, at)
    if len(joints) > _MOST_LINKS:
        raise ScenarioError(str(at), len(joints), f"must have at most {_MOST_LINKS} joints")
    named: set[str] = set()
    children: dict[str, list[str]] = {name: [] for name, _ in names}
    parent_of: dict[str, str] = {}
    for name, parent, child, where in joints:
        if name in named:
            raise ScenarioError(str(where), name, "must be a name that no other joint has")
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
    roots = [name for name, _ in names if name not in parent_of]
    if len(roots) != 1:
        got = ", ".join(roots[:5]) if roots else "links in a circle"
        raise ScenarioError(str(at), got, "must have one link that hangs on no other")
    order = [roots[0]]
    for name in order:
        order.extend(children[name])
    if len(order) < len(names):
        raise ScenarioError(
            str(at), min(seen - set(order)), "must hang on the root, not on itself in a circle"
        )
    return order


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
