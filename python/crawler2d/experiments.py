"""The seizure study, first form: which track models get the Engineer over a step, and how often.

Run it with ``python -m crawler2d.experiments``; ``--help`` lists the options.
"""

from __future__ import annotations

import argparse
import csv
import math
import sys
import time
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import cast

import numpy as np

import crawler2d as c2d
from crawler2d.run import Outcome, Run
from crawler2d.scenario import Scenario
from crawler2d.statistics import Interval, wilson
from crawler2d.terrain import Step
from crawler2d.track import Track

__all__ = ["Cell", "main", "models", "repeat", "study", "summarise"]

HEIGHTS = (0.020, 0.030, 0.040, 0.050, 0.060, 0.075, 0.090, 0.100, 0.110, 0.125, 0.150)
REPEATS = 20
QUICK_HEIGHTS = (0.030, 0.060, 0.090, 0.125)
QUICK_REPEATS = 4

# Final poses closer than this are one pose.
_POSE_DISTANCE = 1e-3
_POSE_ANGLE = math.radians(0.1)


@dataclass(frozen=True, slots=True, kw_only=True)
class Cell:
    """One model on one step, all repeats together."""

    model: str
    height: float
    """[m] Height of the step."""
    cleared: int
    count: int
    rate: Interval
    failures: dict[str, int]
    """How the runs that did not clear ended."""
    poses: int
    """Number of distinct final poses, to 1 mm and 0.1 degree, of all runs."""


def models(axle_distance: float) -> dict[str, Track]:
    """List the track models of the study by name.

    Parameters
    ----------
    axle_distance : float
        [m] Of the robot; wheels of a sixth of it touch in a line of four.
    """
    return {
        "belt": c2d.BeltTrack(),
        "force": c2d.ForceTrack(),
        "line of 3": c2d.LineOfWheels(3),
        "line of 4, touching": c2d.LineOfWheels(4, wheel_radius=axle_distance / 6.0),
        "line of 5": c2d.LineOfWheels(5),
        "line of 9": c2d.LineOfWheels(9),
    }


def repeat(scenario: Scenario, index: int, seed: int) -> Scenario:
    """Draw one repeat; the draws depend on seed and index only, so that models compare in pairs.

    The approach is uniform over 0.1 m, the track phase over one grouser pitch, speed and friction
    within 2 %. What is drawn is written into the scenario, so that every run replays alone.
    """
    # Lanes have no friction of their own; the study has none.
    nominal = cast("Step", scenario.terrain).friction
    approach, phase, speed, friction = np.random.default_rng((seed, index)).random(4).tolist()
    return scenario.replace(
        {
            "start.approach": 0.05 + 0.1 * approach,
            "start.track_phase": phase * scenario.robot.outline.grouser_pitch,
            "drive.speed": scenario.drive.speed * (0.98 + 0.04 * speed),
            "terrain.friction": nominal * (0.98 + 0.04 * friction),
        }
    )


def study(
    heights: Sequence[float], repeats: int, *, seed: int = 0, threads: int | None = None
) -> dict[tuple[str, float], list[Run]]:
    """Simulate every model on every height.

    Parameters
    ----------
    heights : sequence of float
        [m] Heights of the step.
    repeats : int
        Runs a cell.
    seed : int
        Of the draws.
    threads : int, optional
        See `simulate_many`.

    Returns
    -------
    dict
        The runs of each cell by model and height.
    """
    robot = c2d.robots.engineer()
    cells = [(m, h) for m in models(robot.outline.axle_distance) for h in heights]
    tracks = models(robot.outline.axle_distance)
    scenarios = [
        repeat(Scenario(robot.with_track(tracks[model]), c2d.terrains.step(height)), index, seed)
        for model, height in cells
        for index in range(repeats)
    ]
    runs = c2d.simulate_many(
        scenarios, threads=threads, record="summary", progress=True, on_error="record"
    )
    return {cell: runs[i * repeats : (i + 1) * repeats] for i, cell in enumerate(cells)}


def summarise(runs_by_cell: dict[tuple[str, float], list[Run]]) -> list[Cell]:
    """Count successes, ways to fail and distinct final poses of every cell."""
    return [_cell(model, height, runs) for (model, height), runs in runs_by_cell.items()]


def _cell(model: str, height: float, runs: list[Run]) -> Cell:
    endings = Counter("diverged" if run.outcome is None else str(run.outcome) for run in runs)
    cleared = endings.pop(Outcome.CLEARED, 0)
    return Cell(
        model=model,
        height=height,
        cleared=cleared,
        count=len(runs),
        rate=wilson(cleared, len(runs)),
        failures=dict(endings.most_common()),
        poses=len({_pose(run) for run in runs if run.error is None}),
    )


def _pose(run: Run) -> tuple[int, int, int]:
    figures = run.metrics
    return (
        round(figures["final_x"] / _POSE_DISTANCE),
        round(figures["final_y"] / _POSE_DISTANCE),
        round(figures["final_angle"] / _POSE_ANGLE),
    )


def table(cells: Iterable[Cell]) -> str:
    """Write the cells as a table for a terminal."""
    lines = [
        "model                step    cleared  95 % interval  poses  how the others ended",
        "-------------------  ------  -------  -------------  -----  --------------------",
    ]
    model = ""
    for cell in cells:
        if model and cell.model != model:
            lines.append("")
        name, model = ("" if cell.model == model else cell.model), cell.model
        others = ", ".join(f"{count} {outcome}" for outcome, count in cell.failures.items())
        lines.append(
            f"{name:<19}  {1000 * cell.height:3.0f} mm  {cell.cleared:>3}/{cell.count:<3}"
            f"  {100 * cell.rate.low:3.0f} to {100 * cell.rate.high:3.0f} % "
            f"  {cell.poses:5}  {others}".rstrip()
        )
    return "\n".join(lines)


def real_time_factors(runs_by_cell: dict[tuple[str, float], list[Run]]) -> dict[str, float]:
    """Divide simulated time by the computing time of one thread, for every model."""
    factors = {}
    for name in dict.fromkeys(model for model, _ in runs_by_cell):
        runs = [run for (model, _), cell in runs_by_cell.items() if model == name for run in cell]
        finished = [run for run in runs if run.error is None]
        computed = sum(run.wall_time for run in finished)
        simulated = sum(run.metrics["time"] for run in finished)
        factors[name] = simulated / computed if computed > 0.0 else math.nan
    return factors


def write_runs(path: Path, runs_by_cell: dict[tuple[str, float], list[Run]]) -> None:
    """Write one row a run: cell, draws, outcome, metrics."""
    some = next(run for runs in runs_by_cell.values() for run in runs if run.error is None)
    metrics = list(some.metrics)
    draws = ["approach", "track_phase", "speed", "friction"]
    with path.open("w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["model", "height", "repeat", *draws, "outcome", *metrics, "wall_time"])
        for (model, height), runs in runs_by_cell.items():
            for index, run in enumerate(runs):
                s = run.scenario
                terrain_friction = getattr(s.terrain, "friction", math.nan)
                drawn = [s.start.approach, s.start.track_phase, s.drive.speed, terrain_friction]
                figures = [run.metrics.get(name, math.nan) for name in metrics]
                outcome = run.outcome or "diverged"
                writer.writerow([model, height, index, *drawn, outcome, *figures, run.wall_time])


def write_rates(path: Path, cells: Iterable[Cell]) -> None:
    """Write one row a cell: rate with its interval, failures, poses."""
    with path.open("w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(
            ["model", "height", "cleared", "count", "rate", "low", "high", "poses", "failures"]
        )
        for c in cells:
            failures = " ".join(f"{outcome}:{count}" for outcome, count in c.failures.items())
            writer.writerow(
                [c.model, c.height, c.cleared, c.count, *c.rate, c.poses, failures],
            )


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the study from the command line."""
    parser = argparse.ArgumentParser(prog="python -m crawler2d.experiments", description=__doc__)
    parser.add_argument("--quick", action="store_true", help="few heights and repeats")
    parser.add_argument("--out", type=Path, default=Path("out"), help="folder of the results")
    parser.add_argument("--threads", type=int, default=None, help="default: all cores")
    parser.add_argument("--seed", type=int, default=0, help="of the draws (default: 0)")
    options = parser.parse_args(arguments)
    heights, repeats = (QUICK_HEIGHTS, QUICK_REPEATS) if options.quick else (HEIGHTS, REPEATS)
    options.out.mkdir(parents=True, exist_ok=True)
    print(_header(heights, repeats, options.seed), flush=True)
    begin = time.perf_counter()
    try:
        runs_by_cell = study(heights, repeats, seed=options.seed, threads=options.threads)
    except c2d.BatchInterrupted as interrupt:
        print(interrupt, file=sys.stderr)
        return 130
    took = time.perf_counter() - begin
    cells = summarise(runs_by_cell)
    print(table(cells))
    print("\nReal-time factor of one thread (simulated / computing time):")
    for model, factor in real_time_factors(runs_by_cell).items():
        print(f"  {model:<19}  {factor:8.0f}")
    write_runs(options.out / "study.csv", runs_by_cell)
    write_rates(options.out / "rates.csv", cells)
    files = ["study.csv", "rates.csv"]
    if _draw(cells, options.out / "study.png"):
        files.append("study.png")
    print(
        f"\n{len(cells) * repeats} runs in {took:.1f} s; wrote {', '.join(files)} to {options.out}"
    )
    return 0


def _draw(cells: list[Cell], path: Path) -> bool:
    try:
        from crawler2d.study_plot import plot_rates  # noqa: PLC0415 - optional

        plot_rates(cells).savefig(path, dpi=150)
    except ImportError as missing:
        print(f"no picture: {missing}", file=sys.stderr)
        return False
    return True


def _header(heights: Sequence[float], repeats: int, seed: int) -> str:
    robot = c2d.robots.engineer()
    build = ", ".join(f"{name} {value}" for name, value in c2d.build_info().items())
    clearance = robot.outline.rear_radius + min(y for _, y in robot.belly or ((0.0, 0.0),))
    nominal = Scenario(robot, Step(heights[0]))
    friction = Step(heights[0]).friction
    return (
        f"Engineer without flippers over steps of {1000 * heights[0]:.0f} to "
        f"{1000 * heights[-1]:.0f} mm, {repeats} repeats, seed {seed}\n"
        f"build: {build}\n"
        f"estimates: centre of mass {robot.center_of_mass} m, belly clearance "
        f"{1000 * clearance:.0f} mm, track mass {robot.track_mass} kg,\n"
        f"  torque {robot.drivetrain.max_torque} N m a sprocket, friction {friction}\n"
        "drawn: approach 0.05 to 0.15 m, track phase over one grouser pitch, "
        f"speed {nominal.drive.speed} m/s and friction within 2 %\n"
    )


if __name__ == "__main__":
    raise SystemExit(main())
