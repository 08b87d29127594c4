"""A baseline: stored results of audits, so that a check fails only on new issues.

A baseline stores verdicts, counts and intervals, not bits. A seizure is new

- on an obstacle on which the robot did not seize, or that is not in the baseline;
- or if the interval of its rate is above the stored one, over all speeds or at one of them.

Equal builds of crawler2d give equal runs. With another build a verdict near a bound may change:
unless it was "does not seize", then only the interval decides whether the seizure is new.

A finding of lint is new if none of its rule had the same text, apart from numbers, at this severity
or above.
"""

from __future__ import annotations

import json
import math
import os
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from crawler2d import _core
from crawler2d.audits.issues import SEIZES, Check, Issue, repository_of
from crawler2d.audits.lint import SEVERITIES
from crawler2d.audits.verdicts import Proportion, Verdict
from crawler2d.common.files import write_text
from crawler2d.errors import ScenarioError
from crawler2d.parameters.fields import to_dict
from crawler2d.reading.log import list_names

__all__ = ["compare", "entry_of", "read_baseline", "write_baseline"]

VERSION = 1
"""Version of the file format."""

Plain = dict[str, Any]

# Numbers, except in names such as left_wheel_3.
_NUMBER = re.compile(r"(?<![\w.])[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?(?!\w)")
_LINE = re.compile(r"(:\d+)(?=[:,; ]|$)")
_LIST = re.compile(r"\[([^][{}]*)\]")
_SAME = 1e-6  # [-] relative, as files round figures
_ENTRY = {"crawler2d", "build", "robot", "lint"}  # keys of an entry
_VERDICT = {"word", "seized"}  # compared keys of a verdict
_MOST = 4  # fields listed by name


def read_baseline(path: Path) -> Plain:
    """Read a baseline.

    Raises
    ------
    ScenarioError
        If it is not a baseline, or has another version of the format.
    OSError
        If the file cannot be read.
    """
    try:
        kept = json.loads(path.read_text(encoding="utf-8"))
        version = kept["baseline"]
        models = kept["models"]
        is_whole = version != VERSION or all(map(_is_whole, models.values()))
    except (AttributeError, ValueError, KeyError, TypeError) as error:
        rule = f"must be a file that --update-baseline wrote ({type(error).__name__}: {error})"
        raise ScenarioError("baseline", str(path), rule) from None
    if version != VERSION:
        rule = f"must have format {VERSION}: write it again with --update-baseline"
        raise ScenarioError("baseline", version, rule)
    if not is_whole:
        rule = "must have whole entries, with robot and lint: write it again with --update-baseline"
        raise ScenarioError("baseline", str(path), rule)
    return dict(kept)


def write_baseline(path: Path, checks: Sequence[Check], before: Plain | None) -> None:
    """Write the results for some files; entries of other files are kept.

    After lint alone, earlier verdicts are kept.
    """
    models: Plain = {} if before is None else dict(before["models"])
    for check in checks:
        if check.found is None:  # unreadable: its entry is kept
            continue
        name = _name(check.path, path)
        models[name] = {**models.get(name, {}), **entry_of(check)}
    text = json.dumps({"baseline": VERSION, "models": dict(sorted(models.items()))}, indent=1)
    # One line per list, so a diff of two versions shows one line per change.
    text = _LIST.sub(
        lambda found: f"[{' '.join(map(str.strip, found[1].splitlines())).strip()}]", text
    )
    write_text(path, f"{text}\n")


def entry_of(check: Check) -> Plain:
    """Return the entry of a file that was read."""
    assert check.found is not None
    build = _core.build_info()
    kept: Plain = {
        "crawler2d": build["version"],
        "build": build["build_id"],
        "robot": to_dict(check.found.robot),
        "lint": [
            [each.severity, each.rule, _portable(each.message, check.path)]
            for each in check.found.lint
        ],
    }
    if check.found.verdicts:
        kept["verdicts"] = {each.obstacle: _verdict(each) for each in check.found.verdicts}
    return kept


def compare(check: Check, baseline: Plain, path: Path) -> tuple[Check, list[str]]:
    """Compare the results for a file with a baseline.

    Parameters
    ----------
    check : Check
        Results for the file.
    baseline : dict
        Result of `read_baseline`.
    path : Path
        Path of the baseline.

    Returns
    -------
    Check and list of str
        The check with its known issues, and lines about what is new, gone or changed.
    """
    before: Plain | None = baseline["models"].get(_name(check.path, path))
    if check.found is None:
        return replace(check, known=frozenset()), [issue.text for issue in check.issues]
    if before is None:
        return replace(check, known=frozenset()), ["not in the baseline: everything is new"]
    now = entry_of(check)
    is_known = (issue for issue in check.issues if not _is_new(issue, check.path, now, before))
    known = frozenset(is_known)
    check = replace(check, known=known)
    changes = [*_robot_moved(before["robot"], now["robot"]), *_verdicts_moved(check, now, before)]
    changes += _lint_moved(check, now, before)
    if changes and not _are_of_one_build(now, before):
        was, is_now = (f"{each['crawler2d']} ({each['build']})" for each in (before, now))
        changes.append(
            f"crawler2d {was} is now {is_now}: CHANGELOG.md says what moved, under Physics"
        )
    return check, changes


def _is_whole(kept: Plain) -> bool:
    """Whether an entry has everything to compare: robot, lint and verdicts."""
    verdicts = kept.get("verdicts", {}).values()
    return (
        kept.keys() >= _ENTRY
        and isinstance(kept["robot"], Mapping)
        and all(_is_finding(each) for each in kept["lint"])
        and all(each.keys() >= _VERDICT and each["seized"] for each in verdicts)
        and all(_is_rate(rate) for each in verdicts for rate in each["seized"])
    )


def _is_finding(kept: Sequence[object]) -> bool:
    """Whether it is a stored finding of lint: severity, rule and text."""
    return len(kept) == 3 and all(isinstance(each, str) for each in kept) and kept[0] in SEVERITIES


def _is_rate(kept: Sequence[object]) -> bool:
    """Whether it is a stored rate: count, total and interval."""
    return len(kept) == 4 and all(isinstance(each, (int, float)) for each in kept)


def _name(path: Path, baseline: Path) -> str:
    """Return a file's path relative to the baseline, wherever the command runs."""
    return Path(os.path.relpath(path.resolve(), baseline.resolve().parent)).as_posix()


def _verdict(verdict: Verdict) -> Plain:
    kept: Plain = {"word": verdict.result}
    if verdict.jam_wheels:
        kept["where"] = f"{verdict.jam_wheels} of the {verdict.carrier}"
    rates = [verdict.seized, *verdict.seized_at.values()]
    return {
        **kept,
        "cleared": _counts(verdict.cleared),
        "belt_cleared": _counts(verdict.belt_cleared),
        "seized": [_counts(each) for each in rates],
    }


def _counts(of: Proportion) -> list[float]:
    """Return count, total and interval."""
    hits = round(of.rate * of.runs) if of.runs else 0
    return [hits, of.runs, round(of.low, 4), round(of.high, 4)]


def _are_of_one_build(now: Plain, before: Plain) -> bool:
    return all(before[name] == now[name] for name in ("crawler2d", "build"))


def _is_new(issue: Issue, path: Path, now: Plain, before: Plain) -> bool:
    if issue.rule != SEIZES:
        was = _lint(before).get(_key(issue.rule, _portable(issue.text, path)))
        return was is None or SEVERITIES.index(issue.severity) < SEVERITIES.index(was)
    label, then = _matched(before, issue.obstacle, now)
    if label is None or then["word"] == "does not seize":
        return True
    if then["word"] != SEIZES and _are_of_one_build(now, before):
        return True
    pairs = zip(now["verdicts"][issue.obstacle]["seized"], then["seized"], strict=False)
    return any(low > high for (*_, low, _), (*_, high) in pairs)


def _matched(kept: Plain, obstacle: str, now: Plain) -> tuple[str | None, Plain]:
    """Return the stored verdict that corresponds to a current obstacle, with its label.

    Obstacles are scaled to the robot, whose size may have changed: those whose labels differ only
    in numbers correspond in order of size.
    """
    place = _places(now)[obstacle]
    found = {each: label for label, each in _places(kept).items()}.get(place)
    return found, {} if found is None else kept["verdicts"][found]


def _places(kept: Plain) -> dict[str, tuple[str, int]]:
    """Return the kind of each obstacle, and its rank by size within the kind."""
    kinds: dict[str, list[str]] = {}
    for label in kept.get("verdicts", {}):
        kinds.setdefault(_NUMBER.sub("#", label), []).append(label)
    return {
        label: (kind, rank)
        for kind, labels in kinds.items()
        for rank, label in enumerate(sorted(labels, key=_sizes))
    }


def _sizes(label: str) -> list[float]:
    return [float(number) for number in _NUMBER.findall(label)]


def _lint(kept: Plain) -> dict[tuple[str, str], str]:
    """Return the worst severity of each finding of lint, by its text."""
    worst: dict[tuple[str, str], str] = {}
    for severity, rule, message in sorted(kept["lint"], key=lambda each: SEVERITIES.index(each[0])):
        worst.setdefault(_key(rule, message), severity)
    return worst


def _key(rule: str, message: str) -> tuple[str, str]:
    return rule, _NUMBER.sub("#", _LINE.sub("", message))


def _robot_moved(before: Plain, now: Plain) -> Iterator[str]:
    was, is_now = dict(_leaves(before)), dict(_leaves(now))
    moved = [
        f"{path} {_figure(was.get(path))} is now {_figure(is_now.get(path))}"
        for path in dict.fromkeys([*was, *is_now])
        if not _is_same(was.get(path), is_now.get(path))
    ]
    if moved:
        yield f"another robot: {list_names(moved, _MOST)}"


def _leaves(value: Any, path: str = "robot") -> Iterator[tuple[str, object]]:
    if isinstance(value, Mapping):
        for name, each in value.items():
            yield from _leaves(each, f"{path}.{name}")
    elif isinstance(value, list):
        for number, each in enumerate(value):
            yield from _leaves(each, f"{path}[{number}]")
    else:
        yield path, value


def _figure(value: object) -> str:
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def _is_same(was: object, is_now: object) -> bool:
    if isinstance(was, (int, float)) and isinstance(is_now, (int, float)):
        return math.isclose(was, is_now, rel_tol=_SAME, abs_tol=_SAME)
    return was == is_now


def _verdicts_moved(check: Check, now: Plain, before: Plain) -> Iterator[str]:
    if check.found is None or not check.found.verdicts:
        return
    if "verdicts" not in before:
        yield "the baseline has lint alone: every seizure is new"
        return
    new = {issue.obstacle for issue in check.failing if issue.rule == SEIZES}
    gone = dict.fromkeys(before["verdicts"])
    sizes = []
    for label, here in now["verdicts"].items():
        found, then = _matched(before, label, now)
        if found is None:
            yield f"{label}: {here['word']}; the baseline has no such obstacle"
            continue
        del gone[found]
        if found != label:
            sizes.append(f"{found} is now {label}")
        (hits, runs, *_), (was_hits, was_runs, *_) = here["seized"][0], then["seized"][0]
        counts = f"seizes in {hits} of {runs} runs, was {was_hits} of {was_runs}"
        if label in new:
            yield f"{label}: {then['word']} is now {here['word']}: {counts}; this is new"
        elif here["word"] != then["word"]:
            kept = (
                ""
                if here["word"] != SEIZES
                else "; another build, and the intervals overlap: not counted as new"
            )
            yield f"{label}: {then['word']} is now {here['word']}: {counts}{kept}"
    if sizes:
        yield f"obstacles of other sizes: {', '.join(sizes)}"
    if gone:
        yield f"no longer driven over: {', '.join(gone)}"


def _lint_moved(check: Check, now: Plain, before: Plain) -> Iterator[str]:
    for issue in check.issues:
        if not issue.obstacle and check.known is not None and issue not in check.known:
            yield f"new {issue.severity} of lint, {issue.rule}: {issue.text}"
    found = _lint(now)
    for severity, rule, message in before["lint"]:
        if _key(rule, message) not in found:
            yield f"{severity} of lint is gone, {rule}: {message}"


def _portable(message: str, path: Path) -> str:
    """Remove line numbers from a text of lint, and make paths relative to the repository."""
    root = repository_of(path) or path.resolve().parent
    return _LINE.sub("", message.replace(f"{root}{os.sep}", "").replace(str(root), "."))
