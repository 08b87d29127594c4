"""XML text that is edited in place, and its elements with byte offsets."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from xml.parsers import expat
from xml.sax.saxutils import escape

from crawler2d.writing.formats import exactly, numbers

__all__ = ["Document", "Span", "joint_in", "lengths", "links_in", "spans_of"]

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
        Values of attributes by name, without quotes and entities.
    parent : Span or None
        The element that contains it.
    start, end : int
        Range of the whole element.
    inner, outer : int
        Range of its content; both are `end` if the tag is self-closing.
    values : dict of str to (int, int)
        Range of each attribute's value, without the quotes.
    children : list of Span
        Children in order.
    text : str
        Its own text, without surrounding space.
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
        """Whether its tag is self-closing, without content."""
        return self.inner == self.end

    def within(self) -> Iterator[Span]:
        """Yield itself and everything in it, in the order of the text."""
        waiting = [self]
        while waiting:
            span = waiting.pop()
            yield span
            waiting.extend(reversed(span.children))

    def all(self, *tags: str) -> list[Span]:
        """Return the children with these names."""
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


class Document:
    r"""A text with its elements and pending changes.

    Parameters
    ----------
    text : str
        The XML.

    Examples
    --------
    >>> document = Document('<link name="hull">\n  <mass value="8"/>\n</link>')
    >>> document.set_attribute(document.root.children[0], "value", "9")
    >>> document.append(document.root, "<inertia/>")
    >>> print(document.text)
    <link name="hull">
      <mass value="9"/>
      <inertia/>
    </link>
    """

    def __init__(self, text: str) -> None:
        self._data = text.encode()
        self.root = spans_of(self._data)
        self._changes: list[tuple[int, int, bytes]] = []

    @property
    def text(self) -> str:
        """The text with all changes."""
        parts, at = [], 0
        for start, end, new in sorted(self._changes, key=lambda change: change[:2]):
            assert start >= at  # changes do not overlap
            parts += [self._data[at:start], new]
            at = end
        return b"".join([*parts, self._data[at:]]).decode()

    def source(self, span: Span) -> str:
        """Return the text of an element."""
        return self._data[span.start : span.end].decode()

    def set_attribute(self, span: Span, name: str, value: str) -> None:
        """Change the value of an attribute, or add it."""
        new = escape(value, {'"': "&quot;", "'": "&apos;"})
        if name in span.values:
            self._change(*span.values[name], new)
            return
        mark = b"/>" if span.is_closed else b">"
        at = self._data.rindex(mark, span.start, span.inner)
        self._change(at, at, f' {name}="{new}"')

    def set_text(self, span: Span, value: str) -> None:
        """Replace the content of an element by a text."""
        new = escape(value)
        if span.is_closed:
            self._open(span, new)
        else:
            self._change(span.inner, span.outer, new)

    def add_to(self, span: Span, shift: Sequence[float], attribute: str = "") -> None:
        """Add lengths [m] to the first numbers of a text or attribute, and round to a micrometre.

        Missing numbers count as 0.
        """
        text = span.attributes.get(attribute, "") if attribute else span.text
        words = text.split() or ["0"] * len(shift)
        moved = [round(float(word) + more, 6) for word, more in zip(words, shift, strict=False)]
        self._write(span, attribute, " ".join([lengths(moved), *words[len(shift) :]]))

    def multiply(
        self,
        span: Span | None,
        factors: Sequence[float],
        attribute: str = "",
        *,
        is_exact: bool = False,
    ) -> None:
        """Multiply the first numbers of a text or attribute, if present, and round to 12 digits.

        Exact products are not rounded, so that moments of inertia on the limit of their inequality
        remain valid.
        """
        if span is None or set(factors) == {1.0}:
            return
        text = span.attributes.get(attribute, "") if attribute else span.text
        words = text.split()
        if words:
            many = zip(words, factors, strict=False)
            products = [float(word) * factor for word, factor in many]
            first = exactly(products) if is_exact else numbers(products)
            self._write(span, attribute, " ".join([first, *words[len(factors) :]]))

    def _write(self, span: Span, attribute: str, value: str) -> None:
        if attribute:
            self.set_attribute(span, attribute, value)
        else:
            self.set_text(span, value)

    def remove(self, span: Span) -> None:
        """Remove an element, with its line if nothing else is on it."""
        self._change(span.start - len(self._indent(span)), span.end, "")

    def insert_after(self, span: Span, text: str) -> None:
        """Insert an element after another one, with the same indentation."""
        self._change(span.end, span.end, self._indent(span) + text)

    def append(self, span: Span, text: str, *, is_inline: bool = False) -> None:
        """Append a child to an element, on a line of its own unless inline."""
        if span.children and not is_inline:
            self.insert_after(span.children[-1], text)
        elif span.is_closed:
            self._open(span, text)
        else:
            self._change(span.outer, span.outer, text)

    def _open(self, span: Span, content: str) -> None:
        """Give content to a self-closing element."""
        opening = self.source(span)[:-2].rstrip()
        self._change(span.start, span.end, f"{opening}>{content}</{span.tag}>")

    def _indent(self, span: Span) -> str:
        """Return the white space before an element, from the end of the line above."""
        before = self._data[: span.start]
        bare = before.rstrip(b" \t")
        for end in (b"\r\n", b"\n"):
            if bare.endswith(end):
                return before[len(bare) - len(end) :].decode()
        return before[len(bare) :].decode()

    def _change(self, start: int, end: int, new: str) -> None:
        self._changes.append((start, end, new.encode()))


def links_in(scope: Span, names: Collection[str]) -> list[Span]:
    """Find the links with these names in URDF and SDF."""
    return [each for each in scope.within() if each.tag == "link" and each.name in names]


def joint_in(scope: Span, name: str) -> Span:
    """Find a joint in URDF and SDF, except in transmissions, where joints have no links."""
    every = (each for each in scope.within() if each.tag == "joint" and each.only("child"))
    return next(each for each in every if each.name == name)


def spans_of(data: bytes) -> Span:
    """Find the elements of a text that is known to be valid XML.

    Parameters
    ----------
    data : bytes
        The text in UTF-8.

    Returns
    -------
    Span
        The root element.

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
        assert opening is not None  # expat has accepted the whole tag
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


def lengths(values: Iterable[float]) -> str:
    """Write lengths with the usual number of digits in model files.

    Examples
    --------
    >>> lengths((0.1 + 0.2, -1e-13, 12.5))
    '0.3 0 12.5'
    """
    return " ".join(f"{round(value, 12) + 0.0:.8g}" for value in values)
