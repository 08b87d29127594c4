"""The highest edge that the Engineer clears, over rotor inertia, torque curve and controller."""

from __future__ import annotations

from collections.abc import Generator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import stats  # type: ignore[import-untyped]

import crawler2d as c2d
from crawler2d import _core
from crawler2d.drawings.canvas import moved
from crawler2d.drawings.palette import look_of
from crawler2d.errors import raise_first
from crawler2d.parameters.fields import json_pointer
from crawler2d.parameters.terrain import Terrain
from crawler2d.parameters.track import Track
from crawler2d.runs.progress import reporter, thread_count
from crawler2d.sweeps.collect import Collector, RowsInterrupted
from research.figures import add_legend, make_panels
from research.models import study_models
from research.study import Job, Study
from research.tables import aligned_table, group_by, mm

if TYPE_CHECKING:
    from matplotlib.figure import Figure

INERTIAS = (0.0, 0.005, 0.02, 0.04, 0.1, 0.2, 0.5)
"""[kg m^2] Rotor inertia of a track."""
_SPEEDS = (0.1, 0.2, 0.4)
"""[m/s]"""
_OBSTACLES = ("step", "knife edge")
FIRM = "firm"
"""Name of the motor that holds its speed through any impact."""

_FAST = (
    *("belt", "line of 3", "line of 5", "line of 9", "24 all round"),
    *("force on skids", "force on wheels"),
)
# Their runs take ten times as long. Those of chains take even longer, and are left out.
_SLOW = ("belt with grousers", "line of 3 gears", "line of 5 gears")
_FRICTION = 0.5
_THICKNESS = 0.002
# [kg m^2], [N m] Equivalent to a mass of 74 t at the belt, which holds its speed against a robot of
# 21 kg, and a torque that accelerates it.
_FIRM_ROTOR, _FIRM_TORQUE = 100.0, 1e6
# [m] Unit of the heights that are tried, the largest number of units, and the first one. Upward
# steps are at most 8 units: models with teeth clear some heights above those that stop them.
_UNIT = 0.001
_COUNT = 150
_FIRST = 32
_REACH = 8
# [point] Distance between the intervals of two models.
_ASIDE = 1.2
# [m] Distance to the edge left at full speed, before draws of +- 46 mm.
_STEADY = 0.1
# [s], [m] A run may last this time plus the time for this distance at full speed; it goes 1.4 m.
_STANDING, _TRAVEL = 10.0, 2.0
_FIELDS = ("terrain.height", "start.approach", "start.track_phase")


class Case(NamedTuple):
    """One track model at one obstacle and speed [m/s], with the drives to compare."""

    model: str
    track: Track
    obstacle: str
    speed: float
    drives: Mapping[str, c2d.Drivetrain]


@dataclass(frozen=True, slots=True, kw_only=True)
class HighestEdge:
    """The height that half of the runs clear with one drive."""

    model: str
    obstacle: str
    speed: float
    """[m/s]"""
    drive: str
    height: float
    """[m] Median over the draws of the highest edge cleared, in whole millimetres; 0 for none."""
    low: float
    """[m] Bounds of its interval, of at least 95 % from 6 draws on: two of `heights`."""
    high: float
    higher: int
    """Number of draws that clear more than with the first drive of the case."""
    lower: int
    """Number of draws that clear less."""
    heights: tuple[float, ...]
    """[m] The highest edge cleared with each draw."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Plan:
    """Parameters of the search.

    Attributes
    ----------
    repeats : int
        Draws of approach and phase, the same for every case and drive.
    seed, threads, store, progress
        See `sweep`.
    """

    repeats: int = 6
    seed: int = 0
    threads: int | None = None
    store: Path | None = None
    progress: bool = True


def design() -> list[Case]:
    """List the cases of the study: all speeds and rotors, except for expensive models."""
    return cases() + cases(_SLOW, speeds=(0.4,), inertias=(0.0, 0.04, 0.5))


def cases(
    models: Sequence[str] = _FAST,
    obstacles: Sequence[str] = _OBSTACLES,
    speeds: Sequence[float] = _SPEEDS,
    inertias: Sequence[float] = INERTIAS,
) -> list[Case]:
    """List the cases with rotors, last with the firm motor, which is useless on a force track."""
    own = c2d.robots.engineer(flippers=None).drivetrain
    rotors = {f"{each:g}": replace(own, rotor_inertia=each) for each in inertias}
    strong = replace(own, rotor_inertia=_FIRM_ROTOR, max_torque=_FIRM_TORQUE)
    tracks = study_models()
    asked = []
    for model, obstacle, speed in product(models, obstacles, speeds):
        track = tracks[model].track
        firm = {} if isinstance(track, c2d.ForceTrack) else {FIRM: strong}
        asked.append(Case(model, track, obstacle, speed, rotors | firm))
    return asked


def other_cases() -> list[Case]:
    """List the cases with other drives, each without a rotor and with one of 0.04 kg m^2."""
    own = c2d.robots.engineer(flippers=None).drivetrain
    kinds = {
        "ideal": own,
        "no load 1.39 m/s": replace(own, no_load_speed=1.39),
        "no load 0.8 m/s": replace(own, no_load_speed=0.8),
        "gain 20": replace(own, controller=c2d.PI(gain=20.0)),
        "gain 5": replace(own, controller=c2d.PI(gain=5.0)),
        "gain 1": replace(own, controller=c2d.PI(gain=1.0)),
    }
    drives = {
        name + with_rotor: replace(drive, rotor_inertia=inertia)
        for with_rotor, inertia in (("", 0.0), (", J = 0.04", 0.04))
        for name, drive in kinds.items()
    }
    some = cases(("line of 5",), ("knife edge",), (0.4,), ())
    some += cases(("line of 3 gears",), ("step",), (0.4,), ())
    return [case._replace(drives=drives) for case in some]


def highest_edges(asked: Sequence[Case], plan: Plan) -> list[HighestEdge]:
    """Find the highest edge that each draw clears with every drive of every case.

    The search for a draw starts where that of the previous drive ended, and moves away in growing
    steps until one height is cleared and one is not; then it bisects. It assumes that a draw that
    clears a height clears all lower ones, and may miss narrow gaps.

    Raises
    ------
    BatchInterrupted
        On Ctrl-C; the store keeps finished runs.
    """
    rows: list[HighestEdge] = []
    draws, cells = _draws(plan), sum(len(case.drives) for case in asked)
    try:
        with (
            Collector((), store=plan.store, threads=thread_count(plan.threads)) as collector,
            reporter(plan.progress, cells, unit="cell") as report,
        ):
            for own in group_by(asked, "model", "obstacle").values():
                units, reach = [_FIRST] * plan.repeats, _REACH
                for case in own:
                    first: list[int] = []
                    for name, drivetrain in case.drives.items():
                        scenario = _scenario(case, drivetrain)
                        searches = [_search(guess, reach) for guess in units]
                        units, reach = _highest(collector, scenario, searches, draws), 1
                        first = first or units
                        rows.append(_row(case, name, units, first))
                        report(1)
    except RowsInterrupted as interrupt:
        raise interrupt.as_batch(plan.store) from None
    return rows


def highest_edges_text(rows: Sequence[HighestEdge]) -> str:
    """Write one row per case and one column per drive."""
    missing = dict.fromkeys(group_by(rows, "drive"), "-")
    lines = (
        {"highest edge [mm]": model, "obstacle": obstacle, "[m/s]": f"{speed:g}"}
        | missing
        | {row.drive: f"{mm(row.height)} ({mm(row.low)} to {mm(row.high)})" for row in case}
        for (model, obstacle, speed), case in group_by(rows, "model", "obstacle", "speed").items()
    )
    return aligned_table(lines, left=["obstacle"])


def paired_text(rows: Sequence[HighestEdge]) -> str:
    """Write how often a draw clears more or less with each drive than with the first."""
    (first, _), *others = group_by(rows, "drive").items()
    lines = []
    for drive, own in others:
        count = sum(len(row.heights) for row in own)
        higher, lower = sum(row.higher for row in own), sum(row.lower for row in own)
        counts = {"count": count, "higher": higher, "equal": count - higher - lower, "lower": lower}
        lines.append({f"draws beside {first}": drive} | {k: str(n) for k, n in counts.items()})
    return aligned_table(lines)


def plot_drive(rows: Sequence[HighestEdge]) -> Figure:
    """Draw the heights that half of the runs clear, one row per obstacle, one column per speed.

    Parameters
    ----------
    rows : sequence of HighestEdge
        The drives of all cases in the same order, which is that of the x axis.
    """
    obstacles, speeds, models, drives = (
        list(group_by(rows, name)) for name in ("obstacle", "speed", "model", "drive")
    )
    cases = group_by(rows, "model", "obstacle", "speed")
    size = (3.2 * len(speeds) + 2.0, 3.0 * len(obstacles) + 0.6)
    figure, axes = make_panels(len(obstacles), len(speeds), size, sharex=True, sharey="row")
    for (line, column), ax in np.ndenumerate(axes):
        obstacle, speed = obstacles[line], speeds[column]
        for index, model in enumerate(models):
            own = cases.get((model, obstacle, speed), [])
            look, places = look_of(index), [drives.index(row.drive) for row in own]
            heights = [1e3 * row.height for row in own]
            ax.plot(places, heights, **look, markersize=4.0, linewidth=1.2, label=model)
            # Side by side, so that intervals do not hide each other.
            beside = moved(ax, _ASIDE * (index - 0.5 * (len(models) - 1)))
            lows, highs = [1e3 * row.low for row in own], [1e3 * row.high for row in own]
            ax.vlines(places, lows, highs, look["color"], linewidth=0.7, transform=beside)
        ax.set_title(f"{obstacle}, {speed:g} m/s", fontsize="medium")
        ax.set_xticks(range(len(drives)), drives, fontsize="small")
        ax.grid(alpha=0.25)
    for ax, obstacle in zip(axes[:, 0], obstacles, strict=True):
        ax.set_ylabel("cleared by half of the runs [mm]")
        tallest = max(row.high for row in rows if row.obstacle == obstacle)
        ax.set_ylim(0.0, 1e3 * 1.05 * tallest + 1.0)
    for ax in axes[-1]:
        ax.set_xlabel("rotor inertia of a track [kg m²]")
    add_legend(figure, axes[0, 0], "right center", fontsize="small", ncols=1)
    count = len(rows[0].heights)
    figure.suptitle(
        f"Engineer without flippers, friction 0.5: median and interval of {count} draws"
    )
    return figure


def _draws(plan: Plan) -> NDArray[np.float64]:
    """[m] Draw changes of approach and phase, shape (repeats, 2)."""
    outline = c2d.robots.engineer().outline
    quarter = 0.125 * outline.axle_distance
    numbers = np.random.default_rng(plan.seed).uniform(size=(plan.repeats, 2))
    return np.column_stack(
        [quarter * (2.0 * numbers[:, 0] - 1.0), outline.grouser_pitch * numbers[:, 1]]
    )


def _scenario(case: Case, drivetrain: c2d.Drivetrain) -> c2d.Scenario:
    ground: Terrain = c2d.terrains.step(0.05, friction=_FRICTION)
    if case.obstacle != "step":
        ground = c2d.terrains.knife_edge(0.05, thickness=_THICKNESS, friction=_FRICTION)
    return c2d.Scenario(
        replace(c2d.robots.engineer(flippers=None, track=case.track), drivetrain=drivetrain),
        ground,
        drive=c2d.Drive(speed=case.speed),
        duration=_STANDING + _TRAVEL / case.speed,
    )


def _search(guess: int, reach: int) -> Generator[int, bool, int]:
    """Ask whether heights are cleared, starting at a guess; return the highest that is."""
    low, high = 0, _COUNT + 1
    at = min(max(guess, 1), _COUNT)
    while True:
        if (yield at):
            low = at
        else:
            high = at
        if high - low == 1:
            return low
        if high > _COUNT:
            at = min(low + reach, _COUNT)
        elif low == 0:
            at = max(high - reach, 1)
        else:
            at = (low + high) // 2
        reach = min(2 * reach, _REACH)


def _highest(
    collector: Collector,
    scenario: c2d.Scenario,
    searches: Sequence[Generator[int, bool, int]],
    draws: NDArray[np.float64],
) -> list[int]:
    """Return the highest edge that each draw clears, in units."""
    whole = _core.PreparedScenario(scenario.to_json(), None)
    acceleration = scenario.robot.drivetrain.max_acceleration
    run_up = scenario.drive.speed**2 / (2.0 * acceleration) + _STEADY
    asked = {draw: next(search) for draw, search in enumerate(searches)}
    highest = [0] * len(searches)
    while asked:
        drawn = draws[list(asked)] + (run_up, 0.0)
        values = np.column_stack([_UNIT * np.array(list(asked.values())), drawn])
        checked = whole.varied([(json_pointer(path), False) for path in _FIELDS], values)
        raise_first(checked)
        rows = collector.rows(collector.batch(checked), lambda _more: None)
        raise_first([row.error for row in rows])
        tried, asked = list(asked), {}
        for draw, row in zip(tried, rows, strict=True):
            try:
                asked[draw] = searches[draw].send(row.outcome == c2d.Outcome.CLEARED)
            except StopIteration as end:
                highest[draw] = end.value
    return highest


def _row(case: Case, drive: str, units: Sequence[int], first: Sequence[int]) -> HighestEdge:
    heights = [_UNIT * each for each in units]
    ordered = sorted(heights)
    rank = _rank(len(heights))
    return HighestEdge(
        model=case.model,
        obstacle=case.obstacle,
        speed=case.speed,
        drive=drive,
        height=float(np.median(heights)),
        low=ordered[rank],
        high=ordered[-1 - rank],
        higher=sum(each > before for each, before in zip(units, first, strict=True)),
        lower=sum(each < before for each, before in zip(units, first, strict=True)),
        heights=tuple(round(each, 6) for each in heights),
    )


def _rank(count: int) -> int:
    """Return the index of the sorted value that bounds the median from below at 97.5 %."""
    return max(int(stats.binom.ppf(0.025, count, 0.5)) - 1, 0)


def _run_drive(job: Job) -> None:
    plan = Plan(store=job.out / "drive.sqlite", **job.sampling)
    asked, others = design(), other_cases()
    if not job.full:
        plan = replace(plan, repeats=3)
        asked = cases(("line of 5",), speeds=(0.4,), inertias=(0.0, 0.1))
        others = others[:1]
    rotors, drives = highest_edges(asked, plan), highest_edges(others, plan)
    tables = (highest_edges_text(rotors), paired_text(rotors), highest_edges_text(drives))
    job.report("drive", "\n\n\n".join(tables))
    job.write_rows(drive=[*rotors, *drives])
    job.draw({"drive": partial(plot_drive, rotors)})


DRIVE = Study(
    text="The highest edge that the Engineer clears with rotors in its motors; runs are stored.",
    run=_run_drive,
)
