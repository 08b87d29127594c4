"""XML text: numbers of few digits, and a comment that holds any text."""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Iterator
from xml.etree import ElementTree

from crawler2d.models.poses import Array

__all__ = ["XML", "commented", "document", "element", "exactly", "numbers"]

XML = ElementTree.Element
"""An element."""


def element(tag: str, *children: XML | None, text: str = "", **attributes: str) -> XML:
    """Make an element with attributes, text and children; None stands for no child."""
    made = ElementTree.Element(tag, attributes)
    made.text = text or None
    made.extend([child for child in children if child is not None])
    return made


def numbers(values: Iterable[float] | Array | float) -> str:
    """Write numbers of twelve digits; there is only one zero.

    The last four digits of a sum or a turn are rounding, and nobody wants to read them. The exact
    robot is in the comment.

    Examples
    --------
    >>> numbers((0.1 + 0.2, -0.0, 1e-7))
    '0.3 0 1e-07'
    """
    return " ".join(f"{value:.12g}" for value in _each(values))


def exactly(values: Iterable[float] | Array | float) -> str:
    """Write numbers that read back to the same bits.

    Moments of inertia are: those of thin bodies just obey their inequality, and still must.

    Examples
    --------
    >>> exactly((0.1 + 0.2, -0.0))
    '0.30000000000000004 0.0'
    """
    return " ".join(repr(value) for value in _each(values))


def _each(values: Iterable[float] | Array | float) -> Iterator[float]:
    for value in [values] if isinstance(values, float | int) else values:
        yield float(value) + 0.0


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
