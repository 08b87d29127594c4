"""One chart that judges the paper: which drive, if any, gives its Table 2.

Its cells are simulated over motor torque, rotor inertia and friction, and compared with the paper's
rates all at once. A store keeps every run: after Ctrl-C the same call goes on where it was.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from functools import partial
from pathlib import Path

from crawler2d.runs.batch import BatchInterrupted
from research.markdown import spliced
from research.paper.design import Work
from research.paper.drives import Drives, drive_cells
from research.paper.drives_plot import plot_drives
from research.paper.drives_report import drives_text
from research.paper.fields import BESIDE_TABLE_2
from research.paper.joint import TABLES, DriveCell, Judged, judged
from research.paper.parts import Pages

__all__ = ["CHART", "add_arguments", "run"]

CHART = Drives(
    torques=(1.0, 10.0, 100.0, 1000.0),
    inertias=(0.0, 0.1),
    frictions=(0.5, 0.7, 0.8, 0.9),
    runs=(4, 4, 2, 1),
    most=20,
)
"""Coarse: gears that grind in a jam until the time is over take most of it."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of ``python -m research chart``."""
    parser.add_argument("--out", type=Path, default=Path("out"), help="folder for the results")
    parser.add_argument("--threads", type=int, default=None, help="default: all cores")
    parser.add_argument("--seed", type=int, default=0, help="seed of the draws (default: 0)")
    for name, what, default in (
        ("--torques", "[N m] of a sprocket", CHART.torques),
        ("--inertias", "[kg m^2] of the rotor of a track", CHART.inertias),
        ("--frictions", "between track and ground", CHART.frictions),
    ):
        text = f"{what} (default: {' '.join(f'{each:g}' for each in default)})"
        parser.add_argument(name, type=float, nargs="+", default=default, help=text)
    parser.add_argument(
        "--runs",
        type=int,
        nargs=len(BESIDE_TABLE_2),
        default=CHART.runs,
        help=f"runs a cell of {', '.join(BESIDE_TABLE_2)} (default:"
        f" {' '.join(map(str, CHART.runs))})",
    )
    parser.add_argument(
        "--most",
        type=int,
        default=CHART.most,
        help=f"runs a cell of drives that these leave (default: {CHART.most})",
    )
    parser.add_argument(
        "--into", type=Path, default=None, help="a page in Markdown whose part to replace"
    )


def run(options: argparse.Namespace) -> int:
    """Draw the chart; returns the exit status."""
    out: Path = options.out
    out.mkdir(parents=True, exist_ok=True)
    work = Work(store=out / "paper.sqlite", seed=options.seed, threads=options.threads)
    drives = Drives(
        torques=tuple(sorted(options.torques)),
        inertias=tuple(sorted(options.inertias)),
        frictions=tuple(options.frictions),
        runs=tuple(options.runs),
        most=options.most,
    )
    try:
        for rows in drive_cells(work, drives):
            print(_written(rows, Pages(out, work, options.into)), flush=True)
    except BatchInterrupted as interrupt:
        print(interrupt, file=sys.stderr)
        return 130
    return 0


def _written(rows: Sequence[DriveCell], pages: Pages) -> str:
    """Write tables and picture of what has been made so far, and the part of the page."""
    own: dict[tuple[float, float, float], list[DriveCell]] = {}
    for row in rows:
        own.setdefault((row.friction, row.torque, row.inertia), []).append(row)
    verdicts: list[Judged] = [
        judged(cells, table, reading) for reading, table in TABLES.items() for cells in own.values()
    ]
    verdicts.sort(key=lambda each: each.friction)
    pages.rows("drives", rows)
    pages.rows("drives_joint", verdicts)
    pages.picture("drives", partial(plot_drives, rows, verdicts))
    text = drives_text(rows, verdicts)
    if pages.into is not None:
        page = pages.into.read_text(encoding="utf-8")
        pages.into.write_text(spliced(page, {"drives": text}), encoding="utf-8")
    return text
