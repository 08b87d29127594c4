"""Audit a model file: what it lacks, where the robot seizes, and what smallest change ends that.

It prints what it finds as it comes: lint and pockets at once, then each verdict, where the robot is
likely to seize first. At the end it writes a page, which replays where the robot seized.

Exit status: 1 if the robot seizes where a belt clears (with --lint if lint has errors, with
--baseline if anything is new since then), 2 if a file or an option is bad, else 0; 130 after
Ctrl-C.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any, TextIO, get_args

from crawler2d.audits.audit import QUICK, REPEATS, SAMPLES, Audit, audit
from crawler2d.audits.audited import as_options
from crawler2d.audits.baseline import against, read_baseline, write_baseline
from crawler2d.audits.issues import Check, Found, checked, junit_of, sarif_of, unread
from crawler2d.audits.patches import best_change
from crawler2d.audits.runs import Live
from crawler2d.audits.text import Linted, linted, plain_of
from crawler2d.audits.verdicts import least_samples
from crawler2d.errors import LimitError, ScenarioError, StoreError
from crawler2d.reading.engines import ENGINES
from crawler2d.reading.loading import TOLERANCE
from crawler2d.reading.meshes import MeshRule

__all__ = [
    "add_arguments",
    "add_report_arguments",
    "baseline_of",
    "refuse_together",
    "report",
    "run",
]


def add_report_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options to those of ``crawler2d audit``."""
    group = parser.add_argument_group("for continuous integration; see docs/guide/audit.md")
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


_OUT = Path("out")
"""Folder of the page, as of the other programs."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of ``crawler2d audit``."""
    parser.add_argument("file", type=Path, nargs="+", help="SDF, URDF, xacro or MJCF")
    parser.add_argument(
        "--quick", action="store_true", help="fewer samples, and no gear wheels among the repairs"
    )
    parser.add_argument(
        "--json", action="store_true", help="print plain data; what comes goes to standard error"
    )
    samples = f"of what is not known, at most (default: {SAMPLES}, with --quick {QUICK}; fewer than"
    samples += f" {least_samples()} cannot show that it does not seize)"
    parser.add_argument("--samples", type=int, help=samples)
    repeats = f"runs of each (default: {REPEATS})"
    parser.add_argument("--repeats", type=int, default=REPEATS, help=repeats)
    parser.add_argument("--seed", type=int, default=0, help="seed of the draws (default: 0)")
    parser.add_argument("--store", type=Path, help="a file that keeps every run")
    parser.add_argument("--threads", type=int, help="default: all cores")
    page = parser.add_mutually_exclusive_group()
    page.add_argument(
        "--html", type=Path, help="where to write the page (default: out/audit-NAME.html)"
    )
    page.add_argument("--no-html", action="store_true", help="write no page")
    parser.add_argument("--no-repairs", action="store_true", help="do not search for repairs")
    parser.add_argument(
        "--patch",
        type=Path,
        metavar="FILE",
        help="write the file with the best repair there is; belts of URDF as .sdf",
    )
    add_report_arguments(parser)
    reading = parser.add_argument_group("how to read the file, as in crawler2d.read_robot")
    reading.add_argument(
        "--engine", choices=sorted(ENGINES), help="whose rules of friction and of motors hold"
    )
    reading.add_argument("--forward", choices=["+x", "-x", "+y", "-y"])
    reading.add_argument("--model", help="name of the model in a world")
    reading.add_argument("--mesh", choices=get_args(MeshRule), default="hull")
    reading.add_argument("--missing", choices=["leave_out", "refuse"], default="leave_out")
    reading.add_argument(
        "--track", action="append", default=[], help="a link that moves; repeatable"
    )
    reading.add_argument("--ground-friction", type=float, help="of the floor's own surface")
    reading.add_argument("--tolerance", type=float, default=TOLERANCE, help="between sides, in m")
    reading.add_argument("--scale", type=float, help="multiply every length, as in 0.001 for mm")
    reading.add_argument("--trusted", action="store_true", help="let xacro evaluate anything")
    reading.add_argument("--package", action="append", default=[], metavar="NAME=FOLDER")
    reading.add_argument("--argument", action="append", default=[], metavar="NAME=VALUE")


def run(options: argparse.Namespace) -> int:
    """Audit each file; returns the exit status."""
    # With --json nothing else may be on the standard output.
    beside = sys.stderr if options.json else sys.stdout
    live = Live(beside, as_options)  # doubts advise as errors do
    try:
        refuse_together(options)
        _check_folders(options)
        baseline = baseline_of(options)
        found: list[tuple[Path, Audit | Linted | ScenarioError]] = []
        for file in options.file:
            if found:
                live.tell("")
            try:
                found.append((file, _found(file, options, live)))
            except ScenarioError as error:
                if len(options.file) == 1 and options.junit is None and options.sarif is None:
                    raise
                found.append((file, error))  # the reports have it, and the other files theirs
                _tell(error)
        count = report(found, options, baseline, beside)
    except KeyboardInterrupt:
        kept = "nothing is kept; with --store FILE every finished run is"
        if options.store is not None:
            kept = f"{options.store} keeps every finished run: the same command goes on from there"
        print(f"\ninterrupted: {kept}", file=sys.stderr)
        return 130
    except (ScenarioError, LimitError, StoreError, ImportError, OSError) as error:
        _tell(error)
        return 2
    if any(isinstance(each, ScenarioError) for _, each in found):
        return 2
    if options.lint or options.baseline is not None:
        return 1 if count else 0
    return 1 if any(isinstance(each, Audit) and each.seizes for _, each in found) else 0


def _tell(error: Exception) -> None:
    told = map(as_options, (str(error), *getattr(error, "__notes__", ())))
    print("crawler2d audit:", "\n  before that: ".join(told), file=sys.stderr)


def _check_folders(options: argparse.Namespace) -> None:
    """Refuse before the runs what could not be written after them."""
    for name in ("html", "patch"):
        path: Path | None = getattr(options, name)
        if path is not None and (path.is_dir() or not path.parent.is_dir()):
            raise ScenarioError(name, str(path), "must be a file in a folder that exists")


def _found(file: Path, options: argparse.Namespace, live: Live) -> Audit | Linted:
    """Audit a file, or only lint it, and show what was found."""
    if options.lint:
        alone = linted(file, **_reading(options))
        live.tell(alone.in_words)
        return alone
    found = audit(
        file,
        samples=options.samples,
        repeats=options.repeats,
        seed=options.seed,
        repair=not options.no_repairs,
        quick=options.quick,
        store=options.store,
        threads=options.threads,
        progress=live,
        **_reading(options),
    )
    _show(found, file, options, live)
    return found


def _show(found: Audit, file: Path, options: argparse.Namespace, live: Live) -> None:
    """Write the page of an audit, and the file with a repair if that is asked for."""
    if options.json:
        print(json.dumps(plain_of(found), indent=2, allow_nan=False))
    if not options.no_html:
        path: Path | None = options.html
        if path is None:
            _OUT.mkdir(parents=True, exist_ok=True)
            path = _OUT / f"audit-{_short(file, options.file)}.html"
        found.to_html(path, threads=options.threads)
        live.tell(f"\nThe page is in {path}")
        if found.reading is not None and found.reading.path.suffix == ".xacro":
            expanded = path.with_name(f"{path.stem}-expanded.urdf")
            expanded.write_text(found.reading.text, encoding="utf-8")
            live.tell(f"The lines are those of {expanded}")
    if options.patch is not None:
        change = best_change(found)
        if change is None:
            live.tell("\nIt does not seize: no changed file is written")
        else:
            written = change.write(options.patch)
            live.tell(f"\n{change.label}\n{change.summary}\nThe changed file is {written}")


def _short(file: Path, files: list[Path]) -> str:
    """Name a file without its ending; of several such, as many are model.sdf, with its folders."""
    if [other.stem for other in files].count(file.stem) == 1:
        return file.stem
    return "-".join(part for part in file.parts if part not in (file.anchor, "..", "."))


def _reading(options: argparse.Namespace) -> dict[str, Any]:
    names = (
        "engine",
        "forward",
        "model",
        "mesh",
        "missing",
        "ground_friction",
        "tolerance",
        "scale",
    )
    return {
        **{name: getattr(options, name) for name in (*names, "trusted")},
        "tracks": options.track,
        "packages": _pairs(options.package, "packages"),
        "arguments": _pairs(options.argument, "arguments"),
    }


def _pairs(texts: list[str], name: str) -> dict[str, str]:
    pairs = {}
    for text in texts:
        key, sign, value = text.partition("=")
        if not sign or not key:
            raise ScenarioError(name, text, "must be NAME=VALUE")
        pairs[key] = value
    return pairs
