"""Write a page that replays a saved run or a scenario.

A scenario is simulated first. The page is a single file that opens in any browser.
"""

from __future__ import annotations

import argparse
import io
from pathlib import Path

from crawler2d.commands.files import (
    OUT,
    check_out,
    check_places,
    keeping,
    read_data,
    scenario_of,
    show_page,
)
from crawler2d.errors import ScenarioError
from crawler2d.results.run_file import SIGNATURE, read_open_run
from crawler2d.runs.batch import simulate
from crawler2d.runs.run import Run

__all__ = ["add_arguments", "run"]


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of ``crawler2d view``."""
    parser.add_argument(
        "file",
        type=Path,
        metavar="FILE",
        help="saved run, or scenario as JSON; - reads standard input",
    )
    parser.add_argument(
        "--out", type=Path, metavar="PAGE", help="page to write (default: out/NAME.html)"
    )
    parser.add_argument("--open", action="store_true", help="open the page in the browser")


def run(options: argparse.Namespace) -> int:
    """Write the page of a run; return the exit status."""
    check_places({"--out": options.out}, read=[options.file])
    if options.out is None:
        check_out("--out")
    written: list[Path] = []
    with keeping(written):
        shown = _run_of(options.file)
        path: Path | None = options.out
        if path is None:
            OUT.mkdir(parents=True, exist_ok=True)
            path = OUT / f"{options.file.stem.strip('-') or 'run'}.html"
        written.append(shown.to_html(path))
        print(f"{shown.title}\nThe page is in {path}")
        if options.open:
            show_page(path)
    return 0


def _run_of(path: Path) -> Run:
    """Load a saved run, or simulate a scenario."""
    data = read_data(path)
    if not data.startswith(SIGNATURE):
        return simulate(scenario_of(data, path))
    saved = read_open_run(io.BytesIO(data), path, Run)
    if not saved.has_history:
        rule = "must have a history: the run was saved without, recorded with record='summary'"
        raise ScenarioError("FILE", str(path), rule)
    return saved
