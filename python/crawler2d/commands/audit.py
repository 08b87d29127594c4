"""Audit a model file: its mistakes, where the robot seizes, and the smallest change that helps.

Results are printed as they become known: lint and pockets first, then the verdicts, starting where
a seizure is likely. At the end it writes a page with replays of the seizures.

Exit status: 1 if the robot seizes where a belt clears (with --lint: if lint has errors; with
--baseline: if anything is new), 2 if a file or an option is invalid, else 0; 130 after Ctrl-C.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any, TextIO, get_args

from crawler2d.audits.audit import QUICK, REPEATS, SAMPLES, Audit, audit
from crawler2d.audits.baseline import compare, read_baseline, write_baseline
from crawler2d.audits.issues import Check, check_of, junit_of, sarif_of, unreadable
from crawler2d.audits.patches import best_change
from crawler2d.audits.record import READING, as_options
from crawler2d.audits.runs import LivePrinter
from crawler2d.audits.text import LintResult, lint_only, plain_of
from crawler2d.audits.verdicts import least_samples
from crawler2d.commands.files import OUT, check_out, check_places
from crawler2d.common.files import write_text
from crawler2d.errors import (
    Crawler2dError,
    InternalError,
    LimitError,
    ScenarioError,
    SimulationDiverged,
    StoreError,
)
from crawler2d.reading.engines import ENGINES
from crawler2d.reading.loading import TOLERANCE
from crawler2d.reading.meshes import MeshRule

__all__ = ["add_arguments", "run"]

_Results = Sequence[tuple[Path, Audit | LintResult | Crawler2dError]]
"""Each file with its result, or the error instead."""

_OF_ONE_FILE = (ScenarioError, LimitError, SimulationDiverged, InternalError)
"""Errors that end the audit of one file; other files are still audited."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of ``crawler2d audit``."""
    parser.add_argument("file", type=Path, nargs="+", help="SDF, URDF, xacro or MJCF")
    parser.add_argument(
        "--quick", action="store_true", help="fewer samples, and no gear wheels among the repairs"
    )
    parser.add_argument(
        "--json", action="store_true", help="print JSON; progress goes to standard error"
    )
    samples = "largest number of samples of the uncertain parameters"
    samples += f" (default: {SAMPLES}, with --quick {QUICK};"
    samples += f" fewer than {least_samples()} cannot show that it does not seize)"
    parser.add_argument("--samples", type=int, metavar="N", help=samples)
    repeats = f"runs of each sample (default: {REPEATS})"
    parser.add_argument("--repeats", type=int, metavar="N", default=REPEATS, help=repeats)
    parser.add_argument(
        "--seed", type=int, metavar="N", default=0, help="seed of the random numbers (default: 0)"
    )
    parser.add_argument(
        "--store",
        type=Path,
        metavar="FILE",
        help="keep every run in this file, from which the same command continues",
    )
    parser.add_argument(
        "--threads", type=int, metavar="N", help="number of threads (default: all cores)"
    )
    page = parser.add_mutually_exclusive_group()
    page.add_argument(
        "--html", type=Path, metavar="PAGE", help="page to write (default: out/audit-NAME.html)"
    )
    page.add_argument("--no-html", action="store_true", help="do not write a page")
    parser.add_argument("--no-repairs", action="store_true", help="do not search for repairs")
    parser.add_argument(
        "--patch",
        type=Path,
        metavar="FILE",
        help="write the model file with the best wheels found, confirmed or not, or else with"
        " belts (for URDF as .sdf)",
    )
    group = parser.add_argument_group("for continuous integration; see docs/guide/audit.md")
    group.add_argument(
        "--lint",
        action="store_true",
        help="lint and pockets only, nothing is simulated; exit status 1 if lint has errors",
    )
    group.add_argument("--junit", type=Path, metavar="FILE", help="write JUnit XML")
    group.add_argument("--sarif", type=Path, metavar="FILE", help="write SARIF 2.1.0")
    group.add_argument(
        "--baseline",
        type=Path,
        metavar="FILE",
        help="exit status 1 only for findings that are not in this file",
    )
    group.add_argument(
        "--update-baseline",
        action="store_true",
        help="write the findings to the --baseline file",
    )
    reading = parser.add_argument_group("how to read the file, as in crawler2d.read_robot")
    reading.add_argument(
        "--engine",
        choices=sorted(ENGINES),
        help="engine whose rules for friction and motors apply (default: mujoco for MJCF, else gz)",
    )
    reading.add_argument(
        "--forward",
        choices=["+x", "-x", "+y", "-y"],
        help="axis along which the model drives forward (default: the side of the links called"
        " front, else +x)",
    )
    reading.add_argument("--model", metavar="NAME", help="name of the model in a world")
    reading.add_argument(
        "--mesh",
        choices=get_args(MeshRule),
        default="hull",
        help="what to do with collision meshes (default: hull)",
    )
    reading.add_argument(
        "--missing",
        choices=["leave_out", "refuse"],
        default="leave_out",
        help="what to do with includes, macros and links that cannot be found (default: leave_out)",
    )
    reading.add_argument(
        "--track",
        action="append",
        default=[],
        metavar="LINK",
        help="link whose surface moves as a track; repeatable",
    )
    reading.add_argument(
        "--ground-friction",
        type=float,
        metavar="MU",
        help="friction coefficient of the floor's own surface",
    )
    reading.add_argument(
        "--tolerance",
        type=float,
        default=TOLERANCE,
        metavar="LENGTH",
        help=f"how far the two sides may differ, in m (default: {TOLERANCE})",
    )
    reading.add_argument(
        "--scale", type=float, metavar="FACTOR", help="multiply every length, e.g. 0.001 for mm"
    )
    reading.add_argument(
        "--trusted", action="store_true", help="let xacro evaluate any Python expression"
    )
    reading.add_argument(
        "--package",
        action="append",
        default=[],
        metavar="NAME=FOLDER",
        help="folder of a package, if it is not found automatically; repeatable",
    )
    reading.add_argument(
        "--argument",
        action="append",
        default=[],
        metavar="NAME=VALUE",
        help="value of an argument of a xacro file; repeatable",
    )


def run(options: argparse.Namespace) -> int:
    """Audit each file; return the exit status."""
    # With --json nothing else may go to the standard output.
    out = sys.stderr if options.json else sys.stdout
    live = LivePrinter(out, as_options)  # warnings give the same advice as errors
    try:
        _check_options(options)
        baseline = _read_baseline(options)
        found: list[tuple[Path, Audit | LintResult | Crawler2dError]] = []
        for file in options.file:
            if found:
                live.print("")
            try:
                found.append((file, _audit_file(file, options, live)))
            except _OF_ONE_FILE as error:
                if len(options.file) == 1 and options.junit is None and options.sarif is None:
                    raise
                found.append((file, error))  # reports show it, and other files are audited
                _print_error(error, file)
        count = _report(found, options, baseline, out)
    except KeyboardInterrupt as interrupt:
        kept = "no run is kept; --store FILE keeps every finished run"
        if options.store is not None:
            kept = (
                f"{options.store} keeps every finished run: the same command continues from there"
            )
        interrupt.add_note(kept)
        raise
    except (ScenarioError, LimitError, StoreError, ImportError, OSError) as error:
        if isinstance(error, OSError) and not isinstance(error, StoreError) and not error.filename:
            raise  # an output error: the reader closed the pipe, or the disk is full
        _print_error(error)
        return 2
    if any(isinstance(each, Crawler2dError) for _, each in found):
        return 2
    if options.lint or options.baseline is not None:
        return 1 if count else 0
    return 1 if any(isinstance(each, Audit) and each.seizes for _, each in found) else 0


def _print_error(error: Exception, file: Path | None = None) -> None:
    """Print an error and its notes, with the file of the audit unless it names one."""
    is_named = file is None or isinstance(error, ScenarioError)
    said = str(error) if is_named else f"{file}: {error}"
    texts = map(as_options, (said, *getattr(error, "__notes__", ())))
    print("crawler2d audit:", "\n  before that: ".join(texts), file=sys.stderr)


def _check_options(options: argparse.Namespace) -> None:
    """Refuse options that exclude each other, and output files that cannot be written.

    Raises
    ------
    ScenarioError
        If there are any.
    """
    ones = {"--html": options.html, "--json": options.json, "--patch": options.patch}
    given = [name for name, value in ones.items() if value]
    if given and len(options.file) > 1:
        raise ScenarioError(given[0], f"{len(options.file)} files", "takes one file")
    of_runs = {"--samples": options.samples, "--store": options.store}
    for name in given + [name for name, value in of_runs.items() if value is not None]:
        if options.lint and name != "--json":
            raise ScenarioError(name, "--lint", "needs runs")
    if options.update_baseline and options.baseline is None:
        raise ScenarioError("--update-baseline", "none", "needs --baseline FILE, where to write")
    places = {f"--{name}": getattr(options, name) for name in ("html", "junit", "sarif")}
    read = list(options.file)
    if options.update_baseline:
        places["--baseline"] = options.baseline
    elif options.baseline is not None:
        read.append(options.baseline)
    if not (options.lint or options.no_html or options.html):
        check_out("--html")
    check_places(places, read=read)
    # A changed file may replace the original.
    check_places({"--patch": options.patch, **places}, kept=options.store)


def _read_baseline(options: argparse.Namespace) -> dict[str, Any] | None:
    """Read the requested baseline; None if it does not exist and will be written."""
    path: Path | None = options.baseline
    if path is None or (options.update_baseline and not path.exists()):
        return None
    if not path.exists():
        rule = "must exist: --update-baseline writes it"
        raise ScenarioError("--baseline", str(path), rule)
    return read_baseline(path)


def _audit_file(file: Path, options: argparse.Namespace, live: LivePrinter) -> Audit | LintResult:
    """Audit a file, or only lint it, and show the results."""
    if file.is_dir():
        rule = "must be a file, not a folder (crawler2d atlas audits every model in a folder)"
        raise ScenarioError("FILE", str(file), rule)
    if options.lint:
        alone = lint_only(file, **_reading(options))
        live.print(alone.summary)
        if options.json:
            print(json.dumps(plain_of(alone), indent=2, allow_nan=False))
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
    _write_audit(found, file, options, live)
    return found


def _write_audit(found: Audit, file: Path, options: argparse.Namespace, live: LivePrinter) -> None:
    """Write the page of an audit and, if requested, the repaired file."""
    if options.json:
        print(json.dumps(plain_of(found), indent=2, allow_nan=False))
    if not options.no_html:
        path: Path | None = options.html
        if path is None:
            OUT.mkdir(parents=True, exist_ok=True)
            path = OUT / f"audit-{_short(file, options.file)}.html"
        found.to_html(path, threads=options.threads)
        live.print(f"\nThe page is in {path}")
        if found.reading is not None and found.reading.path.suffix == ".xacro":
            expanded = path.with_name(f"{path.stem}-expanded.urdf")
            write_text(expanded, found.reading.text)
            live.print(f"The lines are those of {expanded}")
    if options.patch is not None:
        change = best_change(found)
        if change is None:
            live.print("\nIt does not seize: no changed file is written")
        else:
            written = change.write(options.patch)
            live.print(f"\n{change.label}\n{change.summary}\nThe changed file is {written}")


def _short(file: Path, files: list[Path]) -> str:
    """Return a file's name without suffix; with its folders if the name is not unique."""
    if [other.stem for other in files].count(file.stem) == 1:
        return file.stem
    return "-".join(part for part in file.parts if part not in (file.anchor, "..", "."))


def _report(
    found: _Results, options: argparse.Namespace, baseline: dict[str, Any] | None, out: TextIO
) -> int:
    """Write the requested reports, print new issues, and count the issues that fail."""
    checks = [
        unreadable(path, each) if isinstance(each, Crawler2dError) else check_of(path, each)
        for path, each in found
    ]
    if baseline is not None:
        checks = [_compare(check, baseline, options.baseline, out) for check in checks]
    for path, report in ((options.junit, junit_of), (options.sarif, sarif_of)):
        if path is not None:
            write_text(path, report(checks))
    if options.update_baseline:
        write_baseline(options.baseline, checks, baseline)
        print(f"\nThe baseline is in {options.baseline}", file=out)
        return 0
    count = sum(len(check.failing) for check in checks)
    if baseline is not None:
        known = sum(len(check.known or ()) for check in checks)
        print(f"{count} new, {known} known from the baseline", file=out)
    return count


def _compare(check: Check, baseline: dict[str, Any], path: Path, out: TextIO) -> Check:
    check, changes = compare(check, baseline, path)
    print(f"\nSince the baseline, {check.path}: {'' if changes else 'nothing moved'}", file=out)
    for line in changes:
        print(f"  {line}", file=out)
    return check


def _reading(options: argparse.Namespace) -> dict[str, Any]:
    return {
        **{name: getattr(options, name) for name in (*READING, "trusted")},
        "tracks": options.track,
        "packages": _pairs(options.package, "packages", "NAME=FOLDER"),
        "arguments": _pairs(options.argument, "arguments", "NAME=VALUE"),
    }


def _pairs(texts: list[str], name: str, form: str) -> dict[str, str]:
    pairs = {}
    for text in texts:
        key, sign, value = text.partition("=")
        if not sign or not key:
            raise ScenarioError(name, text, f"must be {form}")
        pairs[key] = value
    return pairs
