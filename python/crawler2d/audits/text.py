"""An audit as text for the command, and as plain data for JSON."""

from __future__ import annotations

import dataclasses
import math
import os
import textwrap
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Unpack

from crawler2d.audits import words
from crawler2d.audits.candidates import Pocket, pockets
from crawler2d.audits.lint import Finding, lint
from crawler2d.audits.subject import ReadKeywords, subject_of
from crawler2d.audits.verdicts import Verdict
from crawler2d.parameters.fields import to_dict
from crawler2d.parameters.robot import Robot
from crawler2d.parameters.terrain import Terrain
from crawler2d.reading.reading import Reading
from crawler2d.variation.distributions import Ranges

if TYPE_CHECKING:
    from crawler2d.audits.record import AuditRecord, AuditSetup

__all__ = [
    "LintResult",
    "head_of",
    "lint_of",
    "lint_only",
    "plain_of",
    "rest_of",
    "row_of",
    "text_of",
]

_WIDTH = 100


_WIDEST = ("runs", "100 % (95-100)", "100 % (95-100)", "belt clears", "left terrain", "")
"""Widest cells after the first column, so rows can be written as they become known."""


def text_of(audit: AuditRecord) -> str:
    """Write an audit for a terminal: robot, lint, pockets, verdicts, jams, conclusion, repairs."""
    rows = [row_of(audit, each) for each in audit.verdicts]
    return "\n".join([head_of(audit), *rows, rest_of(audit)])


def head_of(audit: AuditSetup) -> str:
    """Write what is known before the first run, and the table head of the verdicts."""
    parts = (_robot(audit), lint_of(audit.lint), _pockets(audit.pockets), _verdicts(audit))
    return "\n\n".join("\n".join(part) for part in parts)


def row_of(audit: AuditSetup, verdict: Verdict) -> str:
    """Write a verdict as a table row."""
    return _row(audit, words.verdict_row(verdict))


def rest_of(audit: AuditRecord) -> str:
    """Write the part after the verdicts: jams, conclusion and repairs."""
    parts = ["\n".join(_jams(audit)), "\n".join(_conclusion(audit))]
    return "\n\n".join(filter(None, parts))


def _robot(audit: AuditSetup) -> Iterator[str]:
    read = audit.reading
    yield words.subject(audit)
    yield from _wrap(words.reservation(audit), 0)
    yield from _wrap(words.robot_sentence(audit))
    if read is not None:
        names = ", ".join(path.removeprefix("robot.") for path in read.sources.estimates)
        yield from _wrap(f"estimates, not stated in the file: {names or 'none'}")
        for note in read.notes:
            yield from _wrap(f"note: {note}")
    yield "  uncertain, varied over the samples:" if audit.unknown else "  nothing is uncertain"
    sources = audit.unknown.sources if isinstance(audit.unknown, Ranges) else {}
    for path, distribution in audit.unknown.items():
        source = f" [{sources[path]}]" if path in sources else ""
        text = f"{path.removeprefix('robot.')}: {words.range_of(path, distribution)}{source}"
        yield from _wrap(text, 4)


def lint_of(lint: Sequence[Finding], title: str = "Lint") -> Iterator[str]:
    """Write the findings of lint, line by line."""
    yield title if lint else "Lint: nothing found"
    for each in lint:
        where = f" [{each.where}]" if each.where else ""
        yield from _wrap(f"{each.severity}, {each.rule}: {each.message}{where}")


def _pockets(pockets: Sequence[Pocket]) -> Iterator[str]:
    if not pockets:
        yield "Pockets: none, because there are no neighbouring wheels"
        return
    yield "Pockets and slots between wheels: a check of the geometry, not a verdict"
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
            holds = words.holding_friction([p.friction for p in alike])
            deep = words.span([1e3 * p.depth for p in alike], ".1f")
            text = f"{deep} mm deep; their walls alone hold an edge {holds}"
        yield from _wrap(f"{carrier}: {what}, {text}")


def _verdicts(audit: AuditSetup) -> Iterator[str]:
    yield from _wrap(f"Verdicts: {words.population(audit)}", 0)
    yield from _wrap("runs over an obstacle stop as soon as its verdict is certain")
    belt = f"belt: {audit.belt.reason}; not simulated (-) where the robot clears"
    yield from _wrap(belt)
    yield _row(audit, words.VERDICT_HEAD)


def _row(audit: AuditSetup, cells: Sequence[str]) -> str:
    widths = (max(map(len, (*audit.obstacles, words.VERDICT_HEAD[0]))), *map(len, _WIDEST))
    padded = (cell.ljust(width) for cell, width in zip(cells, widths, strict=True))
    return f"  {'  '.join(padded)}".rstrip()


def _jams(audit: AuditRecord) -> Iterator[str]:
    yield from _wrap(words.missing_results(audit))
    jammed = [each for each in audit.verdicts if each.jam_wheels]
    if jammed:
        yield "  where it jams, how often at each speed, and how many a change frees there:"
        yield from _columns([words.JAM_HEAD, *map(words.jam_row, jammed)])
        yield from _wrap(words.wheel_names(audit))


def _conclusion(audit: AuditRecord) -> Iterator[str]:
    for sentence in words.conclusion(audit):
        yield from _wrap(sentence, 0)
    if audit.repaired is not None:
        yield from _wrap(f"Repairs: {words.search_sentence(audit.repaired, audit)}", 0)
        for each in audit.repairs:
            yield from _wrap(words.repair_sentence(each))


def _columns(rows: Sequence[tuple[str, ...]]) -> Iterator[str]:
    widths = [max(len(row[k]) for row in rows) for k in range(len(rows[0]))]
    for row in rows:
        cells = (cell.ljust(width) for cell, width in zip(row, widths, strict=True))
        yield f"  {'  '.join(cells)}".rstrip()


def _wrap(text: str, indent: int = 2) -> list[str]:
    return textwrap.wrap(
        text,
        _WIDTH,
        initial_indent=" " * indent,
        subsequent_indent=" " * (indent + 4),
        break_long_words=False,
        break_on_hyphens=False,
    )


def plain_of(found: AuditRecord | LintResult) -> dict[str, Any]:
    """Return lint, pockets, verdicts and repairs; infinite or unknown values are None."""
    read = found.reading
    of_model = {
        "robot": found.robot,
        "file": None if read is None else read.tree.file,
        "engine": None if read is None else read.engine,
        "friction": None if read is None else read.friction,
        "sources": None if read is None else dict(read.sources),
        "lint": found.lint,
        "pockets": found.pockets,
    }
    of_runs = {} if isinstance(found, LintResult) else _of_runs(found)
    plain: dict[str, Any] = _plain(of_model | of_runs)
    return plain


def _of_runs(audit: AuditRecord) -> dict[str, Any]:
    return {
        "vary": audit.table.attrs["vary"],
        "unknown": audit.table.attrs["unknown"],
        "runs": words.run_count(audit.table),
        "belt": audit.belt.reason,
        "obstacles": audit.obstacles,
        "verdicts": audit.verdicts,
        "assumed": [{**_fields(each), "seizes": each.seizes} for each in audit.assumed],
        "repairs": audit.repairs,
        "seizes": audit.seizes,
    }


def _plain(value: Any) -> Any:
    if isinstance(value, (Robot, Terrain)):
        return to_dict(value)
    if isinstance(value, Ranges):
        return {path: str(distribution) for path, distribution in value.items()}
    if dataclasses.is_dataclass(value):
        value = _fields(value)
    if isinstance(value, Mapping):
        return {str(key): _plain(each) for key, each in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(each) for each in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value


def _fields(value: Any) -> dict[str, Any]:
    return {each.name: getattr(value, each.name) for each in dataclasses.fields(value)}


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class LintResult:
    """Result of lint without runs; the fields are those of `Audit`.

    Parameters
    ----------
    robot : Robot
        The checked robot.
    reading : Reading, optional
        The reading, if it came from a file.
    lint : tuple of Finding
        Probable mistakes in the model, errors first.
    pockets : tuple of Pocket
        Spaces between its wheels: a check of the geometry, not a verdict.
    verdicts : tuple of Verdict
        Empty: nothing was simulated.
    """

    robot: Robot
    reading: Reading | None
    lint: tuple[Finding, ...]
    pockets: tuple[Pocket, ...]
    verdicts: tuple[Verdict, ...] = ()

    @property
    def summary(self) -> str:
        """The short form, as printed by ``python -m crawler2d audit --lint``."""
        title = self.robot.description if self.reading is None else self.reading.description
        parts = ([title], lint_of(self.lint), _pockets(self.pockets))
        return "\n\n".join("\n".join(part) for part in parts)

    def __repr__(self) -> str:
        """Write the short form."""
        return self.summary


def lint_only(
    robot: Robot | Reading | str | os.PathLike[str], **reading: Unpack[ReadKeywords]
) -> LintResult:
    """Look for probable mistakes in a model and measure its pockets, without runs.

    It cannot find problems that only the simulator reports.

    Parameters
    ----------
    robot : Robot, Reading or path
        See `audit`.
    **reading
        For a file: keywords of `read_robot`.

    Raises
    ------
    ScenarioError
        If the file cannot be read.

    Examples
    --------
    >>> import crawler2d as c2d
    >>> found = lint_only(c2d.robots.marv(track="public"))
    >>> [each.rule for each in found.lint], len(found.pockets)
    (['no track'], 15)
    """
    own, read, _ = subject_of(robot, reading)
    return LintResult(robot=own, reading=read, lint=lint(own, read), pockets=pockets(own))
