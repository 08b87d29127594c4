"""The parser for text that nobody vouches for.

Entities, document types and external parts are refused before anything is expanded, and so is what
is too long, too deep or too much.
"""

from __future__ import annotations

import bisect
import re
from xml.parsers import expat

from crawler2d.errors import ScenarioError
from crawler2d.models.where import Where
from crawler2d.reading.elements import Element
from crawler2d.reading.files import LARGEST_MODEL

__all__ = ["parsed"]

_MOST_ELEMENTS = 50_000
_DEEPEST = 60


def parsed(data: bytes, file: str) -> Element:
    r"""Parse the bytes of a file.

    Parameters
    ----------
    data : bytes
        In an encoding that XML knows.
    file : str
        Its name, for the lines.

    Returns
    -------
    Element
        The root.

    Raises
    ------
    ScenarioError
        If it is no XML, has a document type or entities, or is larger than a robot needs.

    Examples
    --------
    >>> root = parsed(b"<robot name='cart'>\n  <link name='hull'/>\n</robot>", "cart.urdf")
    >>> print(root.children[0].where)
    cart.urdf:2
    >>> parsed(b"<!DOCTYPE a [<!ENTITY b 'c'>]><a>&b;</a>", "bomb.sdf")
    Traceback (most recent call last):
    ...
    crawler2d.errors.ScenarioError: bomb.sdf:1 must have no document type, got 'a'
    """
    if len(data) > LARGEST_MODEL:
        raise ScenarioError(file, len(data), f"must have at most {LARGEST_MODEL} bytes")
    return _Parser(file).parse(data)


class _Parser:
    """Builds the elements as expat reads them; one parser reads one file."""

    def __init__(self, file: str) -> None:
        self.file = file
        self.ends: list[int] = []
        self.root: Element | None = None
        self.open: list[Element] = []
        self.count = 0
        self.expat = expat.ParserCreate()
        self.expat.buffer_text = True
        self.expat.StartElementHandler = self.start
        self.expat.EndElementHandler = self.end
        self.expat.CharacterDataHandler = self.characters
        self.expat.StartDoctypeDeclHandler = self.doctype

    def parse(self, data: bytes) -> Element:
        # A stray carriage return ends a line for expat, but not for most editors.
        self.ends = [match.start() for match in re.finditer(rb"\n", data)]
        try:
            self.expat.Parse(data, True)
        except expat.ExpatError as error:
            reason = expat.ErrorString(error.code)
            where = self.at(self.expat.ErrorByteIndex)
            raise ScenarioError(str(where), reason, "must be well-formed XML") from None
        except ScenarioError:  # which is a ValueError, too
            raise
        except (ValueError, LookupError) as error:  # an encoding that Python lacks or cannot map
            raise ScenarioError(self.file, str(error), "must be in a known encoding") from None
        assert self.root is not None  # without one, expat has raised
        return self.root

    def at(self, offset: int) -> Where:
        return Where(self.file, bisect.bisect_left(self.ends, offset) + 1)

    def here(self) -> Where:
        return self.at(self.expat.CurrentByteIndex)

    def start(self, tag: str, attributes: dict[str, str]) -> None:
        self.count += 1
        if self.count > _MOST_ELEMENTS:
            rule = f"must have at most {_MOST_ELEMENTS} elements"
            raise ScenarioError(str(self.here()), self.count, rule)
        if len(self.open) >= _DEEPEST:
            rule = f"must be nested at most {_DEEPEST} deep"
            raise ScenarioError(str(self.here()), len(self.open) + 1, rule)
        parent = self.open[-1] if self.open else None
        element = Element(tag, attributes, parent, self.here())
        if parent is None:
            self.root = element
        else:
            parent.children.append(element)
        self.open.append(element)

    def end(self, _tag: str) -> None:
        self.open.pop()

    def characters(self, text: str) -> None:
        self.open[-1].pieces.append(text)

    def doctype(self, name: str, *_: object) -> None:
        raise ScenarioError(str(self.here()), repr(name), "must have no document type")
