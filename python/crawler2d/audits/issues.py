"""Issues of a model as JUnit XML and SARIF for other programs."""

from __future__ import annotations

import json
import os
import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any
from urllib.parse import quote
from xml.etree import ElementTree

from crawler2d import _core
from crawler2d.audits import words
from crawler2d.audits.lint import RULES
from crawler2d.audits.record import names_of
from crawler2d.errors import Crawler2dError, ScenarioError

if TYPE_CHECKING:
    from crawler2d.audits.lint import Finding
    from crawler2d.audits.record import AuditRecord
    from crawler2d.audits.text import LintResult
    from crawler2d.reading.reading import Reading

__all__ = [
    "SEIZES",
    "Check",
    "Issue",
    "check_of",
    "junit_of",
    "repository_of",
    "sarif_of",
    "unreadable",
]

SEIZES = "seizes"
"""Rule broken by an obstacle on which the robot seizes."""

_UNREAD = "unread"
"""Rule broken by a file that cannot be read, or whose robot cannot be simulated."""

_RULES = {
    SEIZES: "The robot clears what it clears on belts: no edge jams between wheels.",
    _UNREAD: "The file can be read, and its robot simulated.",
    **{rule.name: rule.text for rule in RULES},
}

_SCHEMA = "https://json.schemastore.org/sarif-2.1.0.json"
_ROOT = "%SRCROOT%"

_NOT_IN_XML = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")

XML = ElementTree.Element


@dataclass(frozen=True, slots=True, kw_only=True)
class Issue:
    """One issue.

    Parameters
    ----------
    rule : str
        "seizes", or a rule of lint.
    severity : {"error", "warning", "note"}
        Severity as in lint; a seizure is an error.
    text : str
        A sentence.
    lines : tuple of int
        Lines of the file; empty if unknown, or if they refer to another text.
    obstacle : str
        Obstacle on which the robot seizes; "" for lint.
    """

    rule: str
    severity: str
    text: str
    lines: tuple[int, ...] = ()
    obstacle: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class Check:
    """Results for one file, and which of them fail.

    Parameters
    ----------
    path : Path
        The file.
    found : AuditRecord or LintResult, optional
        Result; None for a file that cannot be read.
    issues : tuple of Issue
        Seizures, then lint.
    known : frozenset of Issue, optional
        Issues that are in the baseline; None without one.
    """

    path: Path
    found: AuditRecord | LintResult | None
    issues: tuple[Issue, ...]
    known: frozenset[Issue] | None = None

    def fails(self, issue: Issue) -> bool:
        """Whether an issue fails: errors, or with a baseline new errors and warnings."""
        if self.known is None:
            return issue.severity == "error"
        return issue not in self.known and issue.severity != "note"

    @property
    def failing(self) -> tuple[Issue, ...]:
        """All issues that fail."""
        return tuple(issue for issue in self.issues if self.fails(issue))


def repository_of(path: Path) -> Path | None:
    """Return the root of the repository of a file."""
    return next((up for up in path.resolve().parents if (up / ".git").exists()), None)


def check_of(path: Path, found: AuditRecord | LintResult) -> Check:
    """List the issues of a model, without a baseline."""
    issues = (*_seizures(found), *(_issue(each, found.reading) for each in found.lint))
    return Check(path=path, found=found, issues=issues)


def unreadable(path: Path, error: Crawler2dError) -> Check:
    """Return the check of a file without an audit: only the error, at its line if known."""
    lines = _lines_in(path.name, error.path) if isinstance(error, ScenarioError) else ()
    issue = Issue(rule=_UNREAD, severity="error", text=str(error), lines=lines)
    return Check(path=path, found=None, issues=(issue,))


def _seizures(found: AuditRecord | LintResult) -> Iterator[Issue]:
    read = found.reading
    names = names_of(found.robot, read)
    for verdict in found.verdicts:
        if verdict.result == SEIZES:
            bodies = [int(body) for body in verdict.jam_wheels.split("-") if body]
            wheels = [names[body] for body in bodies if body in names]
            yield Issue(
                rule=SEIZES,
                severity="error",
                text=words.seizure(verdict, wheels),
                lines=_lines_of(wheels, read),
                obstacle=verdict.obstacle,
            )


def _issue(finding: Finding, reading: Reading | None) -> Issue:
    is_own = reading is not None and _has_own_lines(reading)
    lines = _lines_in(reading.tree.file, finding.where) if reading and is_own else ()
    return Issue(rule=finding.rule, severity=finding.severity, text=finding.message, lines=lines)


def _lines_in(file: str, where: str) -> tuple[int, ...]:
    """Read line numbers from a text such as "cart.sdf:3, 7"."""
    place = re.match(re.escape(file) + r":(\d+(?:, \d+)*)", where)
    return tuple(map(int, place[1].split(", "))) if place else ()


def _lines_of(names: list[str], reading: Reading | None) -> tuple[int, ...]:
    """Return the lines of wheels in the order of their names."""
    if reading is None or not _has_own_lines(reading):
        return ()
    at = dict(zip(reading.wheels["name"].tolist(), reading.wheels["line"].tolist(), strict=True))
    return tuple(at[name] for name in names)


def _has_own_lines(reading: Reading) -> bool:
    """Whether lines refer to the file itself, not to its expansion."""
    return reading.tree.file == reading.path.name


def junit_of(checks: Sequence[Check]) -> str:
    """Write a test suite for each file, with a test case per obstacle and per broken rule.

    An obstacle fails if the robot seizes on it, a rule if it is broken with an error; other
    findings are in the ``system-out`` of the case. With a baseline only new issues fail, and known
    ones are skipped. A file that cannot be read is an error, not a failure.

    Parameters
    ----------
    checks : sequence of Check
        One for each file.

    Returns
    -------
    str
        The text of the file.
    """
    root = _element("testsuites", name="crawler2d audit")
    root.extend(_suite(check) for check in checks)
    _set_counts(root, "tests", "failures", "errors")
    ElementTree.indent(root)
    body = ElementTree.tostring(root, encoding="unicode")
    return f'<?xml version="1.0" encoding="utf-8"?>\n{body}\n'


def _suite(check: Check) -> XML:
    name = check.path.as_posix()
    suite = _element("testsuite", name=name)
    for verdict in () if check.found is None else check.found.verdicts:
        issues = [issue for issue in check.issues if issue.obstacle == verdict.obstacle]
        out = words.verdict_line(verdict)
        suite.append(_case(check, f"{SEIZES}: {verdict.obstacle}", issues, out))
    of_lint = [issue for issue in check.issues if not issue.obstacle]
    for rule in dict.fromkeys(issue.rule for issue in of_lint):
        broken = [issue for issue in of_lint if issue.rule == rule]
        out = "\n".join(f"{issue.severity}: {_with_line(issue, name)}" for issue in broken)
        suite.append(_case(check, f"lint: {rule}", broken, out))
    _set_counts(suite, "tests", "failures", "errors", "skipped")
    return suite


def _case(check: Check, name: str, issues: Iterable[Issue], out: str) -> XML:
    """Return a test case; it fails or is skipped if one of its issues is severe."""
    case = _element("testcase", name=name, classname=check.path.as_posix())
    severe = [issue for issue in issues if issue.severity != "note"]
    failing = [issue for issue in severe if check.fails(issue)]
    known = [issue for issue in severe if check.known and issue in check.known]
    if failing:
        texts = "\n".join(_with_line(each, check.path.as_posix()) for each in failing)
        message = {"type": failing[0].rule, "message": failing[0].text}
        tag = "error" if check.found is None else "failure"
        case.append(_element(tag, texts, **message))
    elif known:
        case.append(_element("skipped", message=f"in the baseline: {known[0].text}"))
    case.append(_element("system-out", out))
    return case


def _with_line(issue: Issue, name: str) -> str:
    """Write file, line and issue, as compilers do."""
    line = f":{issue.lines[0]}" if issue.lines else ""
    return f"{name}{line}: {issue.text}"


def _set_counts(element: XML, *names: str) -> None:
    cases = list(element.iter("testcase"))
    counts = {
        "tests": len(cases),
        "failures": len(list(element.iter("failure"))),
        "errors": len(list(element.iter("error"))),
        "skipped": len(list(element.iter("skipped"))),
    }
    for name in names:
        element.set(name, str(counts[name]))


def _element(tag: str, text: str | None = None, **attributes: str) -> XML:
    element = ElementTree.Element(tag, {name: _legal(each) for name, each in attributes.items()})
    element.text = None if text is None else _legal(text)
    return element


def _legal(text: str) -> str:
    """Replace characters that XML cannot hold; file names may have them."""
    return _NOT_IN_XML.sub("\ufffd", text)


def sarif_of(checks: Sequence[Check]) -> str:
    """Write all issues of some files as one SARIF run.

    Paths are relative to the repository or, outside of one, to the current folder. A seizure is at
    the line of the first of the two wheels, with the other one as a related location; lint is at
    its first line. The expansion of a xacro file has no lines of the file.

    Parameters
    ----------
    checks : sequence of Check
        One for each file. With a baseline each result says whether it is new.

    Returns
    -------
    str
        The text of the file.
    """
    rules = [
        {"id": _id(name), "name": name, "shortDescription": {"text": text}}
        for name, text in _RULES.items()
    ]
    version = str(_core.build_info()["version"])
    driver = {"name": "crawler2d", "semanticVersion": version, "rules": rules}
    results = [_result(issue, check) for check in checks for issue in check.issues]
    run = {"tool": {"driver": driver}, "columnKind": "unicodeCodePoints", "results": results}
    text = json.dumps({"$schema": _SCHEMA, "version": "2.1.0", "runs": [run]}, indent=2)
    return f"{text}\n"


def _id(rule: str) -> str:
    return rule.replace(" ", "-")


def _result(issue: Issue, check: Check) -> dict[str, Any]:
    first, *others = issue.lines or (0,)
    result: dict[str, Any] = {
        "ruleId": _id(issue.rule),
        "ruleIndex": list(_RULES).index(issue.rule),
        "level": issue.severity,
        "message": {"text": issue.text},
        "locations": [_location(check.path, first)],
    }
    if others:
        result["relatedLocations"] = [_location(check.path, line) for line in others]
    if check.known is not None:
        result["baselineState"] = "unchanged" if issue in check.known else "new"
    return result


def _location(path: Path, line: int) -> dict[str, Any]:
    """Return a file's path from the root of its repository, which scanners resolve."""
    whole = path.resolve()
    root = repository_of(path) or Path.cwd()
    file = {"uri": whole.as_uri()}
    if whole.is_relative_to(root):
        file = {"uri": quote(os.fsencode(whole.relative_to(root).as_posix())), "uriBaseId": _ROOT}
    place: dict[str, Any] = {"artifactLocation": file}
    if line:
        place["region"] = {"startLine": line}
    return {"physicalLocation": place}
