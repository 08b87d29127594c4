"""Audits as SARIF 2.1.0, which code scanning shows at the lines of the model."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any
from urllib.parse import quote

from crawler2d import _core
from crawler2d.audits.finding import RULES
from crawler2d.audits.issues import SEIZES, UNREAD, Check, Issue, repository_of

__all__ = ["sarif_of"]

_SCHEMA = "https://json.schemastore.org/sarif-2.1.0.json"
_RULES = {
    SEIZES: "The robot clears what it clears on belts: no edge jams between wheels.",
    UNREAD: "The file can be read, and its robot simulated.",
    **RULES,
}
_ROOT = "%SRCROOT%"


def sarif_of(checks: Sequence[Check]) -> str:
    """Write all issues of some files as one run.

    Files are named as in their repository, or, outside of any, in the folder that is current. A
    seizure is at the line of the first wheel between which it is jammed, with the other one as a
    related place; lint at its first line. What a xacro file expands to has no lines of the file.

    Parameters
    ----------
    checks : sequence of Check
        One for each file. With a baseline each result says whether it is new.

    Returns
    -------
    str
        The text of the file.
    """
    names = list(_RULES)
    rules = [
        {"id": _id(name), "name": name, "shortDescription": {"text": text}}
        for name, text in _RULES.items()
    ]
    version = str(_core.build_info()["version"])
    driver = {"name": "crawler2d", "semanticVersion": version, "rules": rules}
    results = [_result(issue, check, names) for check in checks for issue in check.issues]
    run = {"tool": {"driver": driver}, "columnKind": "unicodeCodePoints", "results": results}
    text = json.dumps({"$schema": _SCHEMA, "version": "2.1.0", "runs": [run]}, indent=2)
    return f"{text}\n"


def _id(rule: str) -> str:
    return rule.replace(" ", "-")


def _result(issue: Issue, check: Check, rules: list[str]) -> dict[str, Any]:
    first, *others = issue.lines or (0,)
    result: dict[str, Any] = {
        "ruleId": _id(issue.rule),
        "ruleIndex": rules.index(issue.rule),
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
    place: dict[str, Any] = {"artifactLocation": _artifact(path)}
    if line:
        place["region"] = {"startLine": line}
    return {"physicalLocation": place}


def _artifact(path: Path) -> dict[str, str]:
    """Name a file by its way from the root of its repository, which is what scanners resolve."""
    whole = path.resolve()
    root = repository_of(path) or Path.cwd()
    if not whole.is_relative_to(root):
        return {"uri": whole.as_uri()}
    return {"uri": quote(whole.relative_to(root).as_posix()), "uriBaseId": _ROOT}
