"""An audit in words: the short form that its command prints."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from crawler2d.audits import words
from crawler2d.variation.ranges import Ranges

if TYPE_CHECKING:
    from crawler2d.audits.audited import Audited, Begun
    from crawler2d.audits.finding import Finding
    from crawler2d.audits.pockets import Pocket
    from crawler2d.audits.repairs import Repaired
    from crawler2d.audits.verdicts import Verdict

__all__ = ["head_of", "lint_of", "rest_of", "row_of", "text_of", "text_of_lint"]

_WIDTH = 100


_WIDEST = ("runs", "100 % (95-100)", "100 % (95-100)", "belt clears", "left terrain", "")
"""Of the columns after the first, so that rows may be written before all are known."""


def text_of(audit: Audited) -> str:
    """Write an audit for a terminal: robot, lint, pockets, verdicts, repairs, and what follows."""
    rows = [row_of(audit, each) for each in audit.verdicts]
    return "\n".join([head_of(audit), *rows, rest_of(audit)])


def head_of(audit: Begun) -> str:
    """Write what is known before the first run, and the head of the table of verdicts."""
    parts = (_robot(audit), lint_of(audit.lint), _pockets(audit.pockets), _verdicts(audit))
    return "\n\n".join("\n".join(part) for part in parts)


def row_of(audit: Begun, verdict: Verdict) -> str:
    """Write a verdict as a row of their table."""
    return _row(audit, words.verdict(verdict))


def rest_of(audit: Audited) -> str:
    """Write what stands below the verdicts: jams, conclusion and repairs."""
    parts = ["\n".join(_jams(audit)), "\n".join(_conclusion(audit))]
    return "\n\n".join(filter(None, parts))


def text_of_lint(title: str, lint: Sequence[Finding], pockets: Sequence[Pocket]) -> str:
    """Write what is found without runs, below a title."""
    return "\n\n".join("\n".join(part) for part in ([title], lint_of(lint), _pockets(pockets)))


def _robot(audit: Begun) -> Iterator[str]:
    read = audit.reading
    yield words.subject(audit)
    yield from _wrapped(words.reservation(audit), 0)
    yield from _wrapped(words.robot_sentence(audit))
    if read is not None:
        names = ", ".join(path.removeprefix("robot.") for path in read.sources.estimates)
        yield from _wrapped(f"estimates, for the file does not say: {names or 'none'}")
        for note in read.notes:
            yield from _wrapped(f"note: {note}")
    yield "  not known, and drawn for every sample:" if audit.unknown else "  nothing is unknown"
    sources = audit.unknown.sources if isinstance(audit.unknown, Ranges) else {}
    for path, distribution in audit.unknown.items():
        source = f" [{sources[path]}]" if path in sources else ""
        text = f"{path.removeprefix('robot.')}: {words.range_of(path, distribution)}{source}"
        yield from _wrapped(text, 4)


def lint_of(lint: Sequence[Finding], title: str = "Lint") -> Iterator[str]:
    """Write what lint found, line by line."""
    yield title if lint else "Lint: nothing found"
    for each in lint:
        where = f" [{each.where}]" if each.where else ""
        yield from _wrapped(f"{each.severity}, {each.rule}: {each.what}{where}")


def _pockets(pockets: Sequence[Pocket]) -> Iterator[str]:
    if not pockets:
        yield "Pockets: none, for there are no neighbouring wheels"
        return
    yield "Pockets and slots between wheels: a screen of geometry, no verdict"
    groups: dict[tuple[str, bool], list[Pocket]] = {}
    for each in pockets:
        groups.setdefault((each.carrier, each.is_slot), []).append(each)
    for (carrier, is_slot), alike in groups.items():
        what = f"{len(alike)} {'slot' if is_slot else 'pocket'}{'s' * (len(alike) > 1)}"
        if is_slot:
            text = (
                f"{words.span([1e3 * p.gap for p in alike], '.1f')} mm open, an edge gets through"
            )
        else:
            held = [p.friction for p in alike]
            deep = words.span([1e3 * p.depth for p in alike], ".1f")
            text = f"{deep} mm deep, by their walls alone they hold {words.held(held)}"
        yield from _wrapped(f"{carrier}: {what}, {text}")


def _verdicts(audit: Begun) -> Iterator[str]:
    yield from _wrapped(f"Verdicts: {words.population(audit)}", 0)
    yield from _wrapped("runs over an obstacle stop as soon as its verdict is certain")
    belt = f"belt: {audit.belt.reason}; not simulated (-) where the robot clears"
    yield from _wrapped(belt)
    yield _row(audit, words.VERDICT_HEAD)


def _row(audit: Begun, cells: Sequence[str]) -> str:
    widths = (max(map(len, (*audit.obstacles, cells[0]))), *map(len, _WIDEST))
    padded = (cell.ljust(width) for cell, width in zip(cells, widths, strict=True))
    return f"  {'  '.join(padded)}".rstrip()


def _jams(audit: Audited) -> Iterator[str]:
    yield from _wrapped(words.lost(audit))
    jammed = [each for each in audit.verdicts if each.where]
    if jammed:
        yield "  where it is jammed, how often at each speed, and how many a change frees there:"
        yield from _columns([words.JAM_HEAD, *map(words.jam, jammed)])
        yield from _wrapped(words.calls(audit))


def _conclusion(audit: Audited) -> Iterator[str]:
    for sentence in words.conclusion(audit):
        yield from _wrapped(sentence, 0)
    if audit.repaired is not None:
        yield from _repairs(audit.repaired, audit.vary)


def _repairs(found: Repaired, vary: Mapping[str, Any]) -> Iterator[str]:
    yield from _wrapped(f"Repairs: {words.repairs_found(found, vary)}", 0)
    for each in found.repairs:
        yield from _wrapped(words.repair_sentence(each))


def _columns(rows: Sequence[tuple[str, ...]]) -> Iterator[str]:
    widths = [max(len(row[k]) for row in rows) for k in range(len(rows[0]))]
    for row in rows:
        cells = (cell.ljust(width) for cell, width in zip(row, widths, strict=True))
        yield f"  {'  '.join(cells)}".rstrip()


def _wrapped(text: str, indent: int = 2) -> list[str]:
    return textwrap.wrap(
        text,
        _WIDTH,
        initial_indent=" " * indent,
        subsequent_indent=" " * (indent + 4),
        break_long_words=False,
        break_on_hyphens=False,
    )
