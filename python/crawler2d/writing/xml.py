"""XML text: numbers that read back to the same bits, and a comment that holds any text."""

from __future__ import annotations

import json
import re
from collections.abc import Iterable
from xml.etree import ElementTree

from crawler2d.models.poses import Array

__all__ = ["XML", "commented", "document", "element", "numbers"]

XML = ElementTree.Element
"""An element."""


def element(tag: str, *children: XML | None, text: str = "", **attributes: str) -> XML:
    """Make an element with attributes, text and children; None stands for no child."""
    made = ElementTree.Element(tag, attributes)
    made.text = text or None
    made.extend([child for child in children if child is not None])
    return made


def numbers(values: Iterable[float] | Array | float) -> str:
    """Write numbers with the fewest digits that read back to the same bits; there is only one zero.

    Examples
    --------
    >>> numbers((0.1, -0.0, 1e-7))
    '0.1 0.0 1e-07'
    """
    each = [values] if isinstance(values, float | int) else values
    return " ".join(repr(float(value) + 0.0) for value in each)


def document(root: XML, comment: str) -> str:
    """Write an element as a file of its own, with a comment before it.

    Parameters
    ----------
    root : Element
        The root.
    comment : str
        In lines of ASCII.

    Returns
    -------
    str
        The text, with a line feed at its end.
    """
    ElementTree.indent(root)
    body = ElementTree.tostring(root, encoding="unicode")
    return f'<?xml version="1.0" encoding="utf-8"?>\n<!--\n{comment}\n-->\n{body}\n'


def commented(value: object) -> str:
    r"""Write plain data as JSON that may stand in a comment: in ASCII, and without two hyphens.

    Examples
    --------
    >>> commented({"name": "a--b", "mass": -1.5})
    '{"name":"a-\\u002db","mass":-1.5}'
    """
    text = json.dumps(value, separators=(",", ":"))
    # Only a string can have two hyphens in a row, and JSON may write any letter of it like this.
    return re.sub("(?<=-)-", r"\\u002d", text)
