"""The studies of this project: over an edge, of chains, of flippers, of drives."""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from crawler2d.runs.batch import BatchInterrupted
from research import report, stops_report
from research import tables as rows
from research.chain_steps import chain_steps, chain_steps_text
from research.chains import CHAINS, CHAINS_QUICK, chain_models
from research.drive import (
    Plan,
    cases,
    design,
    highest_edges,
    highest_edges_text,
    other_cases,
    paired_text,
)
from research.flippers import HEIGHTS, highest_steps, highest_steps_text
from research.models import gear_pairs
from research.public_model import posts, public_wheel_model
from research.replays import write_replays
from research.stops import gear_against_round, stops
from research.sweeps import FULL, QUICK, Study

if TYPE_CHECKING:
    from crawler2d.runs.run import Run

__all__ = ["STUDIES", "add_arguments"]


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options that all studies have."""
    parser.add_argument("--full", action="store_true", help="all heights and repeats; minutes")
    parser.add_argument("--out", type=Path, default=Path("out"), help="folder for the results")
    parser.add_argument("--threads", type=int, default=None, help="default: all cores")
    parser.add_argument("--seed", type=int, default=0, help="seed of the draws (default: 0)")


def _command(study: Callable[[argparse.Namespace], None]) -> Callable[[argparse.Namespace], int]:
    def run(options: argparse.Namespace) -> int:
        options.out.mkdir(parents=True, exist_ok=True)
        try:
            study(options)
        except BatchInterrupted as interrupt:
            print(interrupt, file=sys.stderr)
            return 130
        return 0

    return run


def _run_chain_steps(options: argparse.Namespace) -> None:
    repeats = 40 if options.full else 2
    steps = chain_steps(repeats=repeats, seed=options.seed, threads=options.threads)
    text = f"{chain_steps_text(steps)}\n"
    print(f"\n{text}")
    (options.out / "chain_steps.txt").write_text(text, encoding="utf-8")


def _run_flippers(options: argparse.Namespace) -> None:
    heights, repeats = (HEIGHTS, 6) if options.full else (HEIGHTS[1::4], 2)
    highest = highest_steps(heights, repeats=repeats, seed=options.seed, threads=options.threads)
    text = f"{highest_steps_text(highest)}\n"
    print(f"\n{text}")
    (options.out / "flippers.txt").write_text(text, encoding="utf-8")


def _run_seizure(options: argparse.Namespace) -> None:
    design, out = FULL if options.full else QUICK, options.out
    study = Study(design=design, seed=options.seed, threads=options.threads)
    begin = time.perf_counter()
    print(report.header(study), flush=True)
    sweeps = {obstacle: study.on_obstacle(obstacle) for obstacle in study.design.heights}
    robots, flat, turned = study.on_other_robots(), study.on_the_flat(), study.over_phases()
    runs = public_wheel_model(study.threads)
    replays = write_replays(sweeps, out / "replays", threads=study.threads)
    took = time.perf_counter() - begin

    cells = [row for name, table in sweeps.items() for row in rows.cells(table, name)]
    climbs = [row for name, table in sweeps.items() for row in rows.climbs(table, name)]
    stopped = [row for name, table in sweeps.items() for row in stops(table, name)]
    pairs, strong = gear_pairs(study.models), "torque doubled"
    against = [
        *gear_against_round(sweeps["step"], "step", pairs),
        *gear_against_round(robots.sel(robot=strong), "step", pairs, strong),
    ]
    others = [
        row
        for robot in robots["robot"].to_numpy().tolist()
        for row in rows.cells(robots.sel(robot=robot), "step", robot)
    ]
    rides, phases, found = rows.rides(flat), rows.phases(turned), posts(runs)

    text = "\n\n\n".join(
        (
            report.rates_text(cells),
            stops_report.stops_text(stopped),
            stops_report.against_text(against),
            stops_report.replays_text(replays, f"{out}/replays"),
            report.robots_text(others),
            report.rides_text(rides),
            report.phases_text(phases),
            report.posts_text(found),
            report.beside_the_paper(study.models, climbs),
            report.climbs_text(study.models, climbs),
        )
    )
    print(f"\n{text}\n")
    (out / "study.txt").write_text(f"{report.header(study)}\n\n\n{text}\n", encoding="utf-8")
    for obstacle, table in sweeps.items():
        # The scenarios follow from the seed, and would be most of the file.
        frame = table.drop_vars("scenario").to_dataframe()
        frame.to_csv(out / f"runs_{obstacle.replace(' ', '_')}.csv")
    written: dict[str, list[Any]] = {
        "rates": [*cells, *others],
        "heights": climbs,
        "stops": stopped,
        "gear_against_round": against,
        "replays": replays,
        "flat": rides,
        "phases": phases,
        "posts": found,
    }
    for name, listed in written.items():
        rows.write_csv(out / f"{name}.csv", listed)
    _draw(cells, phases, runs, out)
    count = sum(table["outcome"].size for table in (*sweeps.values(), robots, flat, turned))
    print(f"{count + len(runs)} runs in {took:.0f} s; tables and pictures are in {out}")
    if not options.full:
        print("This was a look at few heights; the whole study: make study ARGS=--full (minutes)")


def _run_chains(options: argparse.Namespace) -> None:
    design, out = CHAINS if options.full else CHAINS_QUICK, options.out
    study = Study(design=design, models=chain_models(), seed=options.seed, threads=options.threads)
    begin = time.perf_counter()
    print(report.header(study), flush=True)
    table = study.on_obstacle("step")
    took = time.perf_counter() - begin
    found = rows.cells(table, "step")
    text = report.rates_text(found)
    print(f"\n{text}\n")
    (out / "chains.txt").write_text(f"{report.header(study)}\n\n\n{text}\n", encoding="utf-8")
    table.drop_vars("scenario").to_dataframe().to_csv(out / "runs_chains.csv")
    rows.write_csv(out / "chains.csv", found)
    try:
        from research.chains_plot import plot_chains  # noqa: PLC0415 - optional

        plot_chains(found).savefig(out / "chains.png", dpi=100)
    except ImportError as missing:
        print(f"no picture: {missing}", file=sys.stderr)
    print(f"{table['outcome'].size} runs in {took:.0f} s; table and picture are in {out}")


def _run_drive(options: argparse.Namespace) -> None:
    out = options.out
    plan = Plan(seed=options.seed, threads=options.threads, store=out / "drive.sqlite")
    asked, others = design(), other_cases()
    if not options.full:
        plan = replace(plan, repeats=3)
        asked = cases(("line of 5",), speeds=(0.4,), inertias=(0.0, 0.1))
        others = others[:1]
    rotors, drives = highest_edges(asked, plan), highest_edges(others, plan)
    tables = (highest_edges_text(rotors), paired_text(rotors), highest_edges_text(drives))
    text = "\n\n\n".join(tables) + "\n"
    print(f"\n{text}")
    (out / "drive.txt").write_text(text, encoding="utf-8")
    rows.write_csv(out / "drive.csv", [*rotors, *drives])
    try:
        from research.drive_plot import plot_drive  # noqa: PLC0415 - optional

        plot_drive(rotors).savefig(out / "drive.png", dpi=100)
    except ImportError as missing:
        print(f"no picture: {missing}", file=sys.stderr)


def _draw(
    cells: list[rows.Cell],
    phases: list[rows.Phase],
    runs: dict[tuple[float, bool], Run],
    out: Path,
) -> None:
    try:
        from research import plot  # noqa: PLC0415 - optional

        plot.plot_rates(cells).savefig(out / "rates.png", dpi=100)
        plot.plot_phases(phases).savefig(out / "phases.png", dpi=100)
        plot.plot_posts(runs).savefig(out / "posts.png", dpi=100)
    except ImportError as missing:
        print(f"no pictures: {missing}", file=sys.stderr)


STUDIES = {
    "seizure": (
        "Which track models get the Engineer over an edge, how often, and why not.",
        _command(_run_seizure),
    ),
    "chains": (
        "Chains of shoes on steps, compared with simpler models.",
        _command(_run_chains),
    ),
    "chain-steps": (
        "How finely a chain of shoes must be stepped.",
        _command(_run_chain_steps),
    ),
    "flippers": (
        "The highest step that the Engineer climbs with its flippers.",
        _command(_run_flippers),
    ),
    "drive": (
        "The highest edge that the Engineer clears with rotors in its motors; runs are stored.",
        _command(_run_drive),
    ),
}
"""What each study asks, and its command."""
