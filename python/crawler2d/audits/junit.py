"""Audits as JUnit XML, which Jenkins, GitLab and GitHub show as tests."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence
from xml.etree import ElementTree

from crawler2d.audits import words
from crawler2d.audits.issues import SEIZES, Check, Issue

__all__ = ["junit_of"]

XML = ElementTree.Element

_NOT_IN_XML = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")


def junit_of(checks: Sequence[Check]) -> str:
    """Write a test suite for each file: a test case for each obstacle, and for each broken rule.

    An obstacle fails if the robot seizes on it, a rule if it is broken with an error; what else is
    found is in the ``system-out`` of its case. With a baseline only what is new fails, and what is
    not is skipped.

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
    _count(root, root.iter("testcase"), "tests", "failures", "errors")
    ElementTree.indent(root)
    body = ElementTree.tostring(root, encoding="unicode")
    return f'<?xml version="1.0" encoding="utf-8"?>\n{body}\n'


def _suite(check: Check) -> XML:
    name = check.path.as_posix()
    suite = _element("testsuite", name=name)
    for verdict in () if check.found is None else check.found.verdicts:
        issues = [issue for issue in check.issues if issue.obstacle == verdict.obstacle]
        said = ": ".join(filter(None, [verdict.obstacle, verdict.word]))
        clears = f"clears {words.share(verdict.cleared)}, seizes {words.share(verdict.seized)}"
        belt = f"belt clears {words.percent(verdict.belt_cleared.rate)}"
        suite.append(
            _case(check, f"{SEIZES}: {verdict.obstacle}", issues, f"{said}; {clears}, {belt}")
        )
    of_lint = [issue for issue in check.issues if not issue.obstacle]
    for rule in dict.fromkeys(issue.rule for issue in of_lint):
        broken = [issue for issue in of_lint if issue.rule == rule]
        said = "\n".join(f"{issue.severity}: {_placed(issue, name)}" for issue in broken)
        suite.append(_case(check, f"lint: {rule}", broken, said))
    _count(suite, suite.iter("testcase"), "tests", "failures", "errors", "skipped")
    return suite


def _case(check: Check, name: str, issues: Iterable[Issue], said: str) -> XML:
    """Return a test case, which fails or is skipped if one of its issues is severe."""
    case = _element("testcase", name=name, classname=check.path.as_posix())
    severe = [issue for issue in issues if issue.severity != "note"]
    failing = [issue for issue in severe if check.fails(issue)]
    known = [issue for issue in severe if check.known and issue in check.known]
    if failing:
        failure = _element("failure", type=failing[0].rule, message=failing[0].text)
        failure.text = _legal("\n".join(_placed(each, check.path.as_posix()) for each in failing))
        case.append(failure)
    elif known:
        case.append(_element("skipped", message=f"in the baseline: {known[0].text}"))
    out = _element("system-out")
    out.text = _legal(said)
    case.append(out)
    return case


def _placed(issue: Issue, name: str) -> str:
    """Write an issue after file and line, as compilers do."""
    line = f":{issue.lines[0]}" if issue.lines else ""
    return f"{name}{line}: {issue.text}"


def _count(element: XML, cases: Iterator[XML], *names: str) -> None:
    each = list(cases)
    counts = {
        "tests": len(each),
        "failures": sum(case.find("failure") is not None for case in each),
        "errors": 0,  # a file that cannot be read is a failure, too
        "skipped": sum(case.find("skipped") is not None for case in each),
    }
    for name in names:
        element.set(name, str(counts[name]))


def _element(tag: str, **attributes: str) -> XML:
    return ElementTree.Element(tag, {name: _legal(text) for name, text in attributes.items()})


def _legal(text: str) -> str:
    """Replace what XML cannot hold, as names of files may have it."""
    return _NOT_IN_XML.sub("\ufffd", text)
