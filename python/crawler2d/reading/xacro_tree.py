"""A xacro file as the tree on which xacro works: with lines, and old names as of today."""

from __future__ import annotations

from typing import Any
from xml.dom import minidom

from crawler2d.reading.parsing import parsed
from crawler2d.reading.telling import Doubt

__all__ = ["OWN_OF_URDF", "place_of", "tree_of_text"]

# What xacro took as its own without a prefix until 2016, if it has these attributes.
_OLD = {
    "arg": {"name", "default"},
    "if": {"value"},
    "include": {"filename"},
    "insert_block": {"name"},
    "macro": {"name"},
    "property": {"name"},
    "unless": {"value"},
}

OWN_OF_URDF = frozenset(
    (
        *("robot", "link", "joint", "transmission", "gazebo", "material", "sensor", "plugin"),
        *("inertial", "visual", "collision", "origin", "mass", "inertia", "geometry"),
        *("box", "cylinder", "sphere", "capsule", "mesh", "color", "texture", "contact", "group"),
        *("parent", "child", "axis", "limit", "dynamics", "calibration", "mimic", "type"),
        *("safety_controller", "actuator", "hardwareInterface", "mechanicalReduction"),
    )
)
"""Elements that are never calls of a macro without a prefix."""


def tree_of_text(data: str | bytes, file: str) -> tuple[minidom.Document, list[Doubt]]:
    """Make the tree of a file.

    Parameters
    ----------
    data : str or bytes
        What it holds.
    file : str
        Its name, for the lines.

    Returns
    -------
    document : Document
        With the place of each element; see `place_of`.
    doubts : list of Doubt
        One if it has elements of old xacro.

    Raises
    ------
    ScenarioError
        If it is no XML, has a document type or entities, or is larger than a robot needs.
    """
    root = parsed(data.encode() if isinstance(data, str) else data, file)
    document = minidom.parseString(data)
    old: list[str] = []
    nodes = document.getElementsByTagName("*")
    for node, element in zip(nodes, root.within(), strict=True):
        node.setUserData(_PLACE, str(element.where), _COPIED)
        if _is_old(node):
            old.append(f"{element.where} <{node.tagName}>")
            node.tagName = node.nodeName = f"xacro:{node.tagName}"
    if not old:
        return document, []
    place, _, name = old[0].rpartition(" ")
    others = f", and so are {len(old) - 1} more elements of the file" if len(old) > 1 else ""
    return document, [(place, name, f"is taken as one of xacro, without its prefix{others}")]


def place_of(node: minidom.Element) -> str:
    """Return file and line of an element of a tree, or of the one that it is a copy of."""
    place: str = node.getUserData(_PLACE) or ""
    return place


def _is_old(node: minidom.Element) -> bool:
    """Whether an element is one of xacro without the prefix, and none of a plugin's own."""
    wanted = _OLD.get(node.tagName)
    if wanted is None or not wanted <= set(node.attributes.keys()):
        return False
    filled = any(each.nodeType == each.ELEMENT_NODE for each in node.childNodes)
    if node.tagName == "property" and not filled and not node.hasAttribute("value"):
        return False
    if node.tagName == "macro" and not filled:
        return False
    outer: Any = node.parentNode
    while outer is not None:
        if outer.nodeName == "plugin":
            return False
        outer = outer.parentNode
    return True


_PLACE = "place"


class _Copied:
    """Lets a copy of an element be where the element is."""

    def handle(self, _operation: int, key: str, data: Any, _source: Any, copy: Any) -> None:
        copy.setUserData(key, data, self)


_COPIED = _Copied()
