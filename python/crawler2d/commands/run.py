"""Simulate a scenario file and print how and why the run ended.

Prints the outcome, the diagnosis if the robot stopped, and the main results with units.

Exit status: 0 if the robot cleared the obstacle, 1 if the run ended otherwise, 2 if the file or an
option is invalid or the run has no result, 130 after Ctrl-C.
"""

from __future__ import annotations

import argparse
import json
import math
import textwrap
from pathlib import Path
from typing import TYPE_CHECKING, Any

from crawler2d.commands.files import check_places, keeping, read_scenario
from crawler2d.common.units import METRICS
from crawler2d.pictures.page import main_figures
from crawler2d.results.outcome import Outcome
from crawler2d.results.run_file import check_suffix
from crawler2d.runs.batch import simulate

if TYPE_CHECKING:
    from crawler2d.runs.run import Run

__all__ = ["add_arguments", "run", "summary"]

_WIDTH = 80


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of ``crawler2d run``."""
    parser.add_argument(
        "file", type=Path, metavar="FILE", help="scenario as JSON; - reads standard input"
    )
    parser.add_argument("--html", type=Path, metavar="PAGE", help="write a page with a replay")
    parser.add_argument(
        "--save",
        type=Path,
        metavar="FILE",
        help="save the run as .npz, for crawler2d view and crawler2d.load",
    )
    parser.add_argument("--json", action="store_true", help="print JSON instead of text")


def run(options: argparse.Namespace) -> int:
    """Simulate a scenario file; return the exit status."""
    check_places({"--html": options.html, "--save": options.save}, read=[options.file])
    if options.save is not None:
        check_suffix(options.save, "--save")
    scenario = read_scenario(options.file)
    written: list[Path] = []
    with keeping(written):
        finished = simulate(scenario)
        try:
            if options.save is not None:
                written.append(finished.save(options.save))
            if options.html is not None:
                written.append(finished.to_html(options.html))
        finally:  # print results of a long run even if a file cannot be written
            if options.json:
                print(json.dumps(_plain(finished), indent=2, allow_nan=False))
            else:
                print(summary(finished), *(f"written: {path}" for path in written), sep="\n")
    return 0 if finished.outcome is Outcome.CLEARED else 1


def summary(run: Run) -> str:
    """Write outcome, reason and main figures of a run, as lines."""
    lines = [run.title]
    if run.reason:
        lines += ["", textwrap.fill(run.reason, _WIDTH)]
    figures = main_figures(run)
    wide = max(len(label) for label, _ in figures)
    return "\n".join([*lines, "", *(f"{label:{wide}}  {value}" for label, value in figures)])


def _plain(run: Run) -> dict[str, Any]:
    """Collect the results of a run as plain data, with None for non-finite numbers."""
    metrics = {
        name: {"value": value if math.isfinite(value) else None, "unit": METRICS[name]}
        for name, value in run.metrics.items()
    }
    return {
        "subject": run.subject,
        "scenario": run.scenario.identity,
        "outcome": str(run.outcome),
        "reason": run.reason,
        "mechanism": None if run.mechanism is None else str(run.mechanism),
        "metrics": metrics,
        "build": dict(run.build),
    }
