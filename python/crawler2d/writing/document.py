"""A text that is changed in places, and stays as it was in all others."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from xml.sax.saxutils import escape

from crawler2d.writing.spans import Span, spans_of
from crawler2d.writing.xml import exactly, numbers

__all__ = ["Document", "written"]


def written(values: Iterable[float]) -> str:
    """Write lengths with as many digits as model files have.

    Examples
    --------
    >>> written((0.1 + 0.2, -1e-13, 12.5))
    '0.3 0 12.5'
    """
    return " ".join(f"{round(value, 12) + 0.0:.8g}" for value in values)


class Document:
    r"""A text with its elements, and the changes that are to be made.

    Parameters
    ----------
    text : str
        The whole.

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
            assert start >= at  # no change lies within another
            parts += [self._data[at:start], new]
            at = end
        return b"".join([*parts, self._data[at:]]).decode()

    def source(self, span: Span) -> str:
        """Return an element as it is written."""
        return self._data[span.start : span.end].decode()

    def set_attribute(self, span: Span, name: str, value: str) -> None:
        """Give an attribute another value, or add it."""
        new = escape(value, {'"': "&quot;", "'": "&apos;"})
        if name in span.values:
            self._change(*span.values[name], new)
            return
        mark = b"/>" if span.is_closed else b">"
        at = self._data.rindex(mark, span.start, span.inner)
        self._change(at, at, f' {name}="{new}"')

    def set_text(self, span: Span, value: str) -> None:
        """Put a text in the place of all that an element holds."""
        new = escape(value)
        if span.is_closed:
            self._open(span, new)
        else:
            self._change(span.inner, span.outer, new)

    def add_to(self, span: Span, shift: Sequence[float], attribute: str = "") -> None:
        """Add lengths [m] to the first numbers of a text or an attribute, to the micrometre.

        What is not there counts as 0.
        """
        text = span.attributes.get(attribute, "") if attribute else span.text
        words = text.split() or ["0"] * len(shift)
        moved = [round(float(word) + more, 6) for word, more in zip(words, shift, strict=False)]
        self._write(span, attribute, " ".join([written(moved), *words[len(shift) :]]))

    def multiply(
        self,
        span: Span | None,
        factors: Sequence[float],
        attribute: str = "",
        *,
        is_exact: bool = False,
    ) -> None:
        """Multiply the first numbers of a text or an attribute, if there is one, to 12 digits.

        Exact ones keep every bit: moments of inertia that just obey their inequality still do.
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
        """Take an element out, with its line if nothing else is on it."""
        self._change(span.start - len(self._indent(span)), span.end, "")

    def insert_after(self, span: Span, text: str) -> None:
        """Put an element behind another one, with the same indent."""
        self._change(span.end, span.end, self._indent(span) + text)

    def append(self, span: Span, text: str, *, is_inline: bool = False) -> None:
        """Put an element behind the last one in another, on a line of its own unless inline."""
        if span.children and not is_inline:
            self.insert_after(span.children[-1], text)
        elif span.is_closed:
            self._open(span, text)
        else:
            self._change(span.outer, span.outer, text)

    def _open(self, span: Span, content: str) -> None:
        """Give an element whose tag closes itself some content."""
        opening = self.source(span)[:-2].rstrip()
        self._change(span.start, span.end, f"{opening}>{content}</{span.tag}>")

    def _indent(self, span: Span) -> str:
        """Return the space before an element, from the end of the line above."""
        before = self._data[: span.start]
        bare = before.rstrip(b" \t")
        for end in (b"\r\n", b"\n"):
            if bare.endswith(end):
                return before[len(bare) - len(end) :].decode()
        return before[len(bare) :].decode()

    def _change(self, start: int, end: int, new: str) -> None:
        self._changes.append((start, end, new.encode()))
