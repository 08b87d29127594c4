"""Options of the audit for continuous integration: reports for other programs, and a baseline."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import Any, TextIO

from crawler2d.audits.baseline import against, read_baseline, write_baseline
from crawler2d.audits.issues import Check, Found, checked, unread
from crawler2d.audits.junit import junit_of
from crawler2d.audits.sarif import sarif_of
from crawler2d.errors import ScenarioError

__all__ = ["add_arguments", "baseline_of", "refuse_together", "report"]


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options to those of ``crawler2d audit``."""
    group = parser.add_argument_group("for continuous integration; see docs/ci.md")
    group.add_argument(
        "--lint",
        action="store_true",
        help="lint and pockets only, no runs; the exit status is 1 if lint has errors",
    )
    group.add_argument("--junit", type=Path, metavar="FILE", help="write JUnit XML")
    group.add_argument("--sarif", type=Path, metavar="FILE", help="write SARIF 2.1.0")
    group.add_argument(
        "--baseline",
        type=Path,
        metavar="FILE",
        help="the exit status is 1 for what is new since then, and for nothing else",
    )
    group.add_argument(
        "--update-baseline",
        action="store_true",
        help="write the file of --baseline, with what was found",
    )


def refuse_together(options: argparse.Namespace) -> None:
    """Refuse options that do not go together.

    Raises
    ------
    ScenarioError
        If there are some.
    """
    ones = {"--html": options.html, "--json": options.json, "--patch": options.patch}
    given = [name for name, value in ones.items() if value]
    if given and len(options.file) > 1:
        raise ScenarioError(given[0], f"{len(options.file)} files", "must go with one file")
    if given and options.lint:
        raise ScenarioError(given[0], "--lint", "must go with runs")
    if options.update_baseline and options.baseline is None:
        rule = "must go with --baseline FILE, which says where"
        raise ScenarioError("--update-baseline", "none", rule)


def baseline_of(options: argparse.Namespace) -> dict[str, Any] | None:
    """Read the baseline that is asked for, before anything takes time.

    Returns
    -------
    dict or None
        None without the option, or if there is none yet and one is to be written.

    Raises
    ------
    ScenarioError
        If the file is no baseline, or is not there and is not to be written.
    """
    path: Path | None = options.baseline
    if path is None or (options.update_baseline and not path.exists()):
        return None
    if not path.exists():
        rule = "must exist: --update-baseline writes it"
        raise ScenarioError("--baseline", str(path), rule)
    return read_baseline(path)


def report(
    found: Sequence[tuple[Path, Found | ScenarioError]],
    options: argparse.Namespace,
    baseline: dict[str, Any] | None,
    beside: TextIO,
) -> int:
    """Write the reports that are asked for, and say what is new.

    Parameters
    ----------
    found : sequence of tuple of Path and Found or ScenarioError
        Each file with what was found in it, or why it could not be read.
    options : Namespace
        Of the command.
    baseline : dict or None
        What `baseline_of` returned.
    beside : text file
        Where to say what is new.

    Returns
    -------
    int
        How many issues fail.
    """
    checks = [
        unread(path, each) if isinstance(each, ScenarioError) else checked(path, each)
        for path, each in found
    ]
    if baseline is not None:
        checks = [_compared(check, baseline, options.baseline, beside) for check in checks]
    for path, written in ((options.junit, junit_of), (options.sarif, sarif_of)):
        if path is not None:
            path.write_text(written(checks), encoding="utf-8")
    if options.update_baseline:
        write_baseline(options.baseline, checks, baseline)
        print(f"\nThe baseline is in {options.baseline}", file=beside)
        return 0
    if baseline is not None:
        return _count(checks, beside)
    return sum(len(check.failing) for check in checks)


def _compared(check: Check, baseline: dict[str, Any], path: Path, beside: TextIO) -> Check:
    check, told = against(check, baseline, path)
    print(f"\nSince the baseline, {check.path}: {'' if told else 'nothing moved'}", file=beside)
    for line in told:
        print(f"  {line}", file=beside)
    return check


def _count(checks: Sequence[Check], beside: TextIO) -> int:
    count = sum(len(check.failing) for check in checks)
    known = sum(len(check.known or ()) for check in checks)
    print(f"{count} new, {known} known from the baseline", file=beside)
    return count
