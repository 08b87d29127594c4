"""XML that nobody vouches for, as elements that know their line: every error names it.

The parser for text that nobody vouches for.

Entities, document types and external parts are refused before anything is expanded, and so is what
is too long, too deep or too much.
"""

from __future__ import annotations

import bisect
import math
import re
from collections.abc import Iterator
from typing import NoReturn
from xml.parsers import expat

from crawler2d.errors import ScenarioError
from crawler2d.model_tree import Where
from crawler2d.reading.files import LARGEST_MODEL
from crawler2d.reading.log import Doubt

__all__ = ["Element", "parse_xml", "real"]

# [m, kg, ...] No robot has a larger figure; an effort or a limit of an angle that is, is none.
_LARGEST = 1e6
_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?", re.ASCII)
_LONGEST_NUMBER = 60
_MOST_ELEMENTS = 50_000
_DEEPEST = 60


class Element:
    """An element with its attributes, its children in order, its text and its line.

    Parameters
    ----------
    tag : str
        Its name, with the prefix that the file gives it.
    attributes : dict of str to str
        As in the file.
    parent : Element or None
        What it stands in.
    where : Where
        File and line of its opening tag.
    """

    __slots__ = ("attributes", "children", "parent", "pieces", "tag", "where")

    def __init__(
        self, tag: str, attributes: dict[str, str], parent: Element | None, where: Where
    ) -> None:
        self.tag = tag
        self.attributes = attributes
        self.parent = parent
        self.where = where
        self.children: list[Element] = []
        self.pieces: list[str] = []

    @property
    def text(self) -> str:
        """Its own text, without the space round it."""
        return "".join(self.pieces).strip()

    @property
    def path(self) -> str:
        """The way to it from the root: ``model[absolem]/link[base_link]/pose``."""
        node: Element | None = self
        steps = []
        while node is not None:
            name = node.attributes.get("name", "")[:40]
            steps.append(f"{node.tag[:40]}[{name}]" if name else node.tag[:40])
            node = node.parent
        return "/".join(reversed(steps))

    @property
    def at(self) -> str:
        """Its line and its way, for errors."""
        return f"{self.where}: {self.path}"

    def refuse(self, value: object, rule: str, part: str = "") -> NoReturn:
        """Raise the error that this element, or an attribute of it, breaks a rule."""
        raise ScenarioError(f"{self.at}{part}", value, rule)

    def all(self, tag: str) -> Iterator[Element]:
        """Yield the children of a name."""
        return (child for child in self.children if child.tag == tag)

    def within(self) -> Iterator[Element]:
        """Yield itself and everything in it, in the order of the file."""
        waiting = [self]
        while waiting:
            element = waiting.pop()
            yield element
            waiting.extend(reversed(element.children))

    def only(self, path: str) -> Element | None:
        """Return the one child at a path; None if there is none. Two are refused."""
        node = self
        for tag in path.split("/"):
            found = list(node.all(tag))
            if not found:
                return None
            if len(found) > 1:
                found[1].refuse(f"{len(found)} of them", "must be given once")
            node = found[0]
        return node

    def first(self, tag: str, doubts: list[Doubt]) -> Element | None:
        """Return the first child of a name, as simulators do; others are doubted."""
        found = list(self.all(tag))
        doubts += [(other.at, tag, "is left out: the first one holds") for other in found[1:]]
        return found[0] if found else None

    def needed(self, path: str) -> Element:
        """Return the one child at a path, which must be there."""
        found = self.only(path)
        if found is None:
            self.refuse("none", f"must have an element <{path}>")
        return found

    def attribute(self, name: str) -> str:
        """Return an attribute, which must be there and not empty."""
        text = self.attributes.get(name, "").strip()
        if not text:
            self.refuse("none", f"must have an attribute {name}")
        return text

    def reals(self, count: int, attribute: str | None = None) -> list[float]:
        """Return so many numbers, from its text or an attribute."""
        text = self.text if attribute is None else self.attributes.get(attribute, "")
        words = text.split() if len(text) <= _LONGEST_NUMBER * (count + 1) else []
        part = "" if attribute is None else f"@{attribute}"
        if len(words) != count:
            rule = "must be a number" if count == 1 else f"must be {count} numbers"
            self.refuse(text, rule, part)
        return [real(self, word, part) for word in words]

    def real(self, path: str, usual: float | None = None) -> float:
        """Return the number that a child holds; `usual` if there is none and it may be left out."""
        found = self.only(path) if usual is not None else self.needed(path)
        return usual if found is None and usual is not None else found.reals(1)[0]  # type: ignore[union-attr]


def real(element: Element, word: str, part: str = "", *, unlimited: bool = False) -> float:
    """Read a number. One beyond a million is refused, or, where that may be meant, infinite."""
    text = word.strip()
    if unlimited and text.lower().lstrip("+-") in ("inf", "infinity"):
        return -math.inf if text.startswith("-") else math.inf
    if len(text) > _LONGEST_NUMBER or not _NUMBER.fullmatch(text):
        element.refuse(word, "must be a finite number", part)
    number = float(text)
    if abs(number) > _LARGEST:
        if not unlimited:
            element.refuse(word, f"must be at most {_LARGEST:g} in magnitude", part)
        return math.copysign(math.inf, number)
    return number


def parse_xml(data: bytes, file: str) -> Element:
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
    >>> root = parse_xml(b"<robot name='cart'>\n  <link name='hull'/>\n</robot>", "cart.urdf")
    >>> print(root.children[0].where)
    cart.urdf:2
    >>> parse_xml(b"<!DOCTYPE a [<!ENTITY b 'c'>]><a>&b;</a>", "bomb.sdf")
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
