"""XML as elements that know their line: every error names it."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from typing import NoReturn

from crawler2d.errors import ScenarioError
from crawler2d.models.where import Where
from crawler2d.reading.telling import Doubt

__all__ = ["Element", "real"]

# [m, kg, ...] No robot has a larger figure; an effort or a limit of an angle that is, is none.
_LARGEST = 1e6
_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?", re.ASCII)
_LONGEST_NUMBER = 60


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
