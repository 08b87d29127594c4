"""Elements of an XML text with the places where they stand in it."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator
from dataclasses import dataclass, field
from xml.parsers import expat

__all__ = ["Span", "joint_in", "links_in", "spans_of"]

_QUOTED = rb"\"[^\"]*\"|'[^']*'"
_OPENING = re.compile(rb"<(?:%s|[^>\"'])*>" % _QUOTED)
_ATTRIBUTE = re.compile(rb"([^\s=<>/\"']+)\s*=\s*(%s)" % _QUOTED)


@dataclass(slots=True, eq=False, kw_only=True)
class Span:
    """An element of a text, by byte offsets.

    Parameters
    ----------
    tag : str
        Its name.
    attributes : dict of str to str
        As XML has them, without quotes and entities.
    parent : Span or None
        What it stands in.
    start, end : int
        Of all of it.
    inner, outer : int
        Where its content begins and ends; both are `end` if its tag closes itself.
    values : dict of str to (int, int)
        Of each attribute's value, without the quotes.
    children : list of Span
        In their order.
    text : str
        Its own text, without the space round it.
    """

    tag: str
    attributes: dict[str, str]
    parent: Span | None
    start: int
    inner: int
    outer: int = 0
    end: int = 0
    values: dict[str, tuple[int, int]] = field(default_factory=dict)
    children: list[Span] = field(default_factory=list)
    text: str = ""

    @property
    def name(self) -> str:
        """Its attribute `name`; empty without one."""
        return self.attributes.get("name", "")

    @property
    def is_closed(self) -> bool:
        """Whether its tag closes itself: it has no content."""
        return self.inner == self.end

    def within(self) -> Iterator[Span]:
        """Yield itself and everything in it, in the order of the text."""
        yield self
        for child in self.children:
            yield from child.within()

    def all(self, *tags: str) -> list[Span]:
        """Return the children of some names."""
        return [child for child in self.children if child.tag in tags]

    def only(self, path: str) -> Span | None:
        """Return the first child at a path; None if there is none."""
        node = self
        for tag in path.split("/"):
            found = node.all(tag)
            if not found:
                return None
            node = found[0]
        return node


def links_in(scope: Span, names: Collection[str]) -> list[Span]:
    """Find the links of some names, of URDF and SDF."""
    return [each for each in scope.within() if each.tag == "link" and each.name in names]


def joint_in(scope: Span, name: str) -> Span:
    """Find a joint of URDF and SDF; a transmission has one without links, which is none."""
    every = (each for each in scope.within() if each.tag == "joint" and each.only("child"))
    return next(each for each in every if each.name == name)


def spans_of(data: bytes) -> Span:
    """Find the elements of a text that the reader has parsed before.

    Parameters
    ----------
    data : bytes
        In UTF-8.

    Returns
    -------
    Span
        The root.

    Examples
    --------
    >>> root = spans_of(b"<link name='hull'> <mass value='8'/></link>")
    >>> mass = root.children[0]
    >>> mass.start, mass.end, mass.values
    (19, 36, {'value': (32, 33)})
    """
    parser = expat.ParserCreate("utf-8")
    stack: list[Span] = []
    roots: list[Span] = []

    def start(tag: str, attributes: dict[str, str]) -> None:
        at = parser.CurrentByteIndex
        opening = _OPENING.match(data, at)
        assert opening is not None  # expat has seen the whole tag
        parent = stack[-1] if stack else None
        span = Span(tag=tag, attributes=attributes, parent=parent, start=at, inner=opening.end())
        for found in _ATTRIBUTE.finditer(data, at + 1 + len(tag.encode()), opening.end()):
            span.values[found[1].decode()] = (found.start(2) + 1, found.end(2) - 1)
        if opening[0].endswith(b"/>"):
            span.outer = span.end = span.inner
        (parent.children if parent else roots).append(span)
        stack.append(span)

    def end(_: str) -> None:
        span = stack.pop()
        span.text = span.text.strip()
        if not span.end:
            span.outer = parser.CurrentByteIndex
            span.end = data.index(b">", span.outer) + 1

    def characters(text: str) -> None:
        stack[-1].text += text

    parser.StartElementHandler = start
    parser.EndElementHandler = end
    parser.CharacterDataHandler = characters
    parser.Parse(data, True)
    return roots[0]
