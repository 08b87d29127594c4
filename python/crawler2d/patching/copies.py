"""What of a text is about a wheel, and copies of it under other names."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping

from crawler2d.writing.document import Document
from crawler2d.writing.spans import Span

__all__ = ["copied", "items_about", "names_of"]

_NO_NAMES = ("class", "childclass", "material", "mesh", "type", "filename")
"""Attributes whose values name something else than links and joints."""

_WITH_NAMES = ("transmission", "actuator")
"""Elements that are about one joint, and need names of their own."""


def names_of(scope: Span, links: Collection[str], joint: str) -> set[str]:
    """Return the names of a wheel, and of all that MJCF has within its bodies."""
    names = {*links, joint}
    for body in scope.within():
        if body.tag == "body" and body.name in links:
            names |= {each.name for each in body.within() if each.name}
    return names


def items_about(scope: Span, names: Collection[str]) -> list[Span]:
    """Return the outermost elements that are about a wheel.

    These are its links and joints; what names one of them in an attribute, such as a motor; a
    transmission with its joint; and of a plugin each setting that is one of its names.

    Parameters
    ----------
    scope : Span
        Where to look.
    names : collection of str
        Of the wheel.
    """
    found = []
    for child in scope.children:
        if _is_about(child, names):
            found.append(child)
        elif child.tag not in ("link", "joint"):
            found += items_about(child, names)
    return found


def _is_about(span: Span, names: Collection[str]) -> bool:
    if any(value in names for key, value in span.attributes.items() if key not in _NO_NAMES):
        return True
    if span.tag == "transmission":
        return any(joint.name in names for joint in span.all("joint"))
    if span.tag == "joint":
        child = span.only("child")
        return child is not None and (child.text or child.attributes.get("link")) in names
    return not span.children and span.text in names


def copied(
    document: Document,
    items: list[Span],
    names: Mapping[str, str],
    change: Callable[[Document, Span], None],
) -> list[str]:
    """Copy elements, changed and under other names.

    Parameters
    ----------
    document : Document
        In which they are.
    items : list of Span
        As from `items_about`.
    names : mapping of str to str
        The new name of each.
    change : callable
        What to do with the copies, together in one element.

    Returns
    -------
    list of str
        The text of each copy.
    """
    # Each stands in what it stands in: a motor is known by the <actuator> round it.
    tags = [item.parent.tag if item.parent is not None else "" for item in items]
    whole = "".join(
        f"<{tag}>{document.source(item)}</{tag}>" for tag, item in zip(tags, items, strict=True)
    )
    first = Document(f"<copies>{whole}</copies>")
    change(first, first.root)
    second = Document(first.text)
    for holder in second.root.children:
        _rename(second, holder.children[0], names)
    third = Document(second.text)
    return [third.source(holder.children[0]) for holder in third.root.children]


def _rename(document: Document, item: Span, names: Mapping[str, str]) -> None:
    suffix = next(new.removeprefix(old) for old, new in names.items())
    for span in item.within():
        for key, value in span.attributes.items():
            if value in names and key not in _NO_NAMES:
                document.set_attribute(span, key, names[value])
            elif key == "name" and (span.tag in _WITH_NAMES or (span is item and _is_mjcf(span))):
                document.set_attribute(span, key, value + suffix)
        if not span.children and span.text in names:
            document.set_text(span, names[span.text])


def _is_mjcf(item: Span) -> bool:
    """Whether it is a motor, a sensor or an exclusion, which MJCF names one by one."""
    holder = "" if item.parent is None else item.parent.tag
    return holder in ("actuator", "sensor", "contact", "tendon", "equality")
