"""What is wrong with a model, in one form for the reports that other programs read."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Protocol

from crawler2d.audits import words
from crawler2d.audits.names import names_of
from crawler2d.errors import ScenarioError

if TYPE_CHECKING:
    from crawler2d.audits.finding import Finding
    from crawler2d.audits.verdicts import Verdict
    from crawler2d.parameters.robot import Robot
    from crawler2d.reading.reading import Reading

__all__ = ["SEIZES", "UNREAD", "Check", "Found", "Issue", "checked", "repository_of", "unread"]

SEIZES = "seizes"
"""The rule that an obstacle breaks on which a robot seizes; the others are those of lint."""


UNREAD = "unread"
"""The rule that a file breaks which cannot be read, or whose robot cannot be simulated."""


class Found(Protocol):
    """What reports need of an `Audit` or of `Linted`."""

    @property
    def robot(self) -> Robot: ...  # noqa: D102
    @property
    def reading(self) -> Reading | None: ...  # noqa: D102
    @property
    def lint(self) -> tuple[Finding, ...]: ...  # noqa: D102
    @property
    def verdicts(self) -> tuple[Verdict, ...]: ...  # noqa: D102


@dataclass(frozen=True, slots=True, kw_only=True)
class Issue:
    """One thing that is wrong.

    Parameters
    ----------
    rule : str
        "seizes", or a rule of lint.
    severity : {"error", "warning", "note"}
        As of lint; a seizure is an error.
    text : str
        A sentence.
    lines : tuple of int
        Where in the file; empty if that is not known, or its lines are those of another text.
    obstacle : str
        On which it seizes; "" for lint.
    """

    rule: str
    severity: str
    text: str
    lines: tuple[int, ...] = ()
    obstacle: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class Check:
    """What was found in one file, and what of it fails.

    Parameters
    ----------
    path : Path
        The file.
    found : Found, optional
        The audit, or lint alone; None for a file that cannot be read.
    issues : tuple of Issue
        Seizures, then lint.
    known : frozenset of Issue, optional
        Those that a baseline has, too; None without one.
    """

    path: Path
    found: Found | None
    issues: tuple[Issue, ...]
    known: frozenset[Issue] | None = None

    def fails(self, issue: Issue) -> bool:
        """Whether an issue fails: a seizure or an error, or with a baseline what is new of them.

        With a baseline a new warning fails, too: the model had none of it.
        """
        if self.known is None:
            return issue.severity == "error"
        return issue not in self.known and issue.severity != "note"

    @property
    def failing(self) -> tuple[Issue, ...]:
        """All issues that fail."""
        return tuple(issue for issue in self.issues if self.fails(issue))


def repository_of(path: Path) -> Path | None:
    """Return the root of the repository that a file lies in."""
    return next((up for up in path.resolve().parents if (up / ".git").exists()), None)


def checked(path: Path, found: Found) -> Check:
    """List what is wrong with a model, with no baseline."""
    issues = (*_seizures(found), *(_of_lint(each, found.reading) for each in found.lint))
    return Check(path=path, found=found, issues=issues)


def unread(path: Path, error: ScenarioError) -> Check:
    """Return the check of a file that cannot be read: the error, at its line, is all of it."""
    place = re.match(re.escape(path.name) + r":(\d+)", error.path)
    lines = (int(place[1]),) if place else ()
    issue = Issue(rule=UNREAD, severity="error", text=str(error), lines=lines)
    return Check(path=path, found=None, issues=(issue,))


def _seizures(found: Found) -> Iterator[Issue]:
    names = {} if found.reading is None else names_of(found.robot, found.reading)
    for verdict in found.verdicts:
        if verdict.word != SEIZES:
            continue
        bodies = [int(body) for body in verdict.where.split("-") if body]
        called = [names[body] for body in bodies if body in names]
        yield Issue(
            rule=SEIZES,
            severity="error",
            text=words.seizure(verdict, called),
            lines=_lines_of(called, found.reading),
            obstacle=verdict.obstacle,
        )


def _of_lint(finding: Finding, reading: Reading | None) -> Issue:
    lines: tuple[int, ...] = ()
    if reading is not None and _has_own_lines(reading):
        place = re.match(re.escape(reading.tree.file) + r":(\d+(?:, \d+)*)", finding.where)
        lines = tuple(map(int, place[1].split(", "))) if place else ()
    return Issue(rule=finding.rule, severity=finding.severity, text=finding.what, lines=lines)


def _lines_of(names: list[str], reading: Reading | None) -> tuple[int, ...]:
    """Return the lines of wheels, in the order of their names."""
    if reading is None or not _has_own_lines(reading):
        return ()
    at = dict(zip(reading.wheels["name"].tolist(), reading.wheels["line"].tolist(), strict=True))
    return tuple(at[name] for name in names)


def _has_own_lines(reading: Reading) -> bool:
    """Whether lines are those of the file itself, and not of what it expands to."""
    return reading.tree.file == reading.path.name
