"""The highest edge that the Engineer clears, over rotor inertia, torque curve and controller."""

from __future__ import annotations

import math
from collections.abc import Generator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from itertools import groupby
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from crawler2d import _core
from crawler2d.errors import raise_first
from crawler2d.parameters.drivetrain import PI, Drivetrain
from crawler2d.parameters.fields import json_pointer
from crawler2d.parameters.scenario import Scenario
from crawler2d.parameters.settings import Drive
from crawler2d.parameters.track import ForceTrack, Track
from crawler2d.presets import terrains
from crawler2d.presets.robots import engineer
from crawler2d.results.outcome import Outcome
from crawler2d.runs.batch import BatchInterrupted
from crawler2d.runs.progress import Reporter, reporter, thread_count
from crawler2d.sweeps.collect import Collector, RowsInterrupted, runs_of
from research.columns import aligned, mm
from research.models import study_models

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from numpy.typing import NDArray

    from crawler2d.parameters.terrain import Terrain

__all__ = [
    "FIRM",
    "INERTIAS",
    "OBSTACLES",
    "SPEEDS",
    "Case",
    "HighestEdge",
    "Plan",
    "cases",
    "design",
    "highest_edges",
    "highest_edges_text",
    "other_cases",
    "paired_text",
]

INERTIAS = (0.0, 0.005, 0.02, 0.04, 0.1, 0.2, 0.5)
"""[kg m^2] Rotor inertia of a track."""
SPEEDS = (0.1, 0.2, 0.4)
"""[m/s]"""
OBSTACLES = ("step", "knife edge")
FIRM = "firm"
"""Name of the motor that holds its speed through any blow."""

_QUICK = (
    *("belt", "line of 3", "line of 5", "line of 9", "24 all round"),
    *("force on skids", "force on wheels"),
)
# Their runs cost ten times as much. Those of chains cost even more, and are left out.
_DEAR = ("belt with grousers", "line of 3 gears", "line of 5 gears")
_FRICTION = 0.5
_THICKNESS = 0.002
# [kg m^2], [N m] A mass of 74 t at the belt holds its speed against a robot of 21 kg, and a torque
# that brings it up to that.
_FIRM_ROTOR, _FIRM_TORQUE = 100.0, 1e6
# [m] Heights are tried in whole multiples of this, up to so many, from a low one on. Upwards by
# no more than 8: models with teeth clear some heights above those that stop them.
_UNIT = 0.001
_COUNT = 150
_FIRST = 32
_REACH = 8
# [m] What is left of the way to the edge at full speed, before draws of +- 46 mm.
_STEADY = 0.1
# [s], [m] A run may last this long and as long as this takes at full speed; it goes some 1.4 m.
_STANDING, _TRAVEL = 10.0, 2.0
_FIELDS = ("terrain.height", "start.approach", "start.track_phase")


class Case(NamedTuple):
    """One track model before one obstacle at one speed [m/s], with the drives to compare."""

    model: str
    track: Track
    obstacle: str
    speed: float
    drives: Mapping[str, Drivetrain]


@dataclass(frozen=True, slots=True, kw_only=True)
class HighestEdge:
    """The height that half of the runs clear, with one drive."""

    model: str
    obstacle: str
    speed: float
    """[m/s]"""
    drive: str
    height: float
    """[m] Median over the draws of the highest edge cleared, in whole millimetres; 0 is none."""
    low: float
    """[m] Bounds of its interval, of at least 95 % from 6 draws on: two of the heights below."""
    high: float
    higher: int
    """How many draws clear more than with the first drive of the case."""
    lower: int
    """How many clear less."""
    heights: tuple[float, ...]
    """[m] The highest edge cleared with each draw."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Plan:
    """How the search is made.

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
    """List the cases of the study: all speeds and rotors, but not of models that cost much."""
    return cases() + cases(_DEAR, speeds=(0.4,), inertias=(0.0, 0.04, 0.5))


def cases(
    models: Sequence[str] = _QUICK,
    obstacles: Sequence[str] = OBSTACLES,
    speeds: Sequence[float] = SPEEDS,
    inertias: Sequence[float] = INERTIAS,
) -> list[Case]:
    """List the cases with rotors, and last the firm motor, which a force track has no use for."""
    robot = engineer(flippers=None)
    own = robot.drivetrain
    rotors = {f"{each:g}": replace(own, rotor_inertia=each) for each in inertias}
    strong = replace(own, rotor_inertia=_FIRM_ROTOR, max_torque=_FIRM_TORQUE)
    tracks = study_models(robot.outline.axle_distance)
    found = []
    for model in models:
        track = tracks[model].track
        firm = {} if isinstance(track, ForceTrack) else {FIRM: strong}
        found += [
            Case(model, track, obstacle, speed, rotors | firm)
            for obstacle in obstacles
            for speed in speeds
        ]
    return found


def other_cases() -> list[Case]:
    """List the cases with other drives, each without a rotor and with one of 0.04 kg m^2."""
    own = engineer(flippers=None).drivetrain
    kinds = {
        "ideal": own,
        "no load 1.39 m/s": replace(own, no_load_speed=1.39),
        "no load 0.8 m/s": replace(own, no_load_speed=0.8),
        "gain 20": replace(own, controller=PI(gain=20.0)),
        "gain 5": replace(own, controller=PI(gain=5.0)),
        "gain 1": replace(own, controller=PI(gain=1.0)),
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
    """Search for the highest edge that each draw clears, with every drive of every case.

    The search of a draw starts where that of the drive before ended, and moves away from there in
    growing steps until one height is cleared and one is not; then it halves what lies between. It
    supposes that a draw that clears a height clears those below, and may miss narrow gaps.

    Raises
    ------
    BatchInterrupted
        On Ctrl-C; the store keeps what was finished.
    """
    found: list[HighestEdge] = []
    cells = sum(len(case.drives) for case in asked)
    with _simulator(plan, cells) as simulator:
        for _, own in groupby(asked, key=lambda case: (case.model, case.obstacle)):
            guesses, reach = [_FIRST] * plan.repeats, _REACH
            for case in own:
                first: list[int] = []
                for name, drivetrain in case.drives.items():
                    guesses, reach = simulator.highest(case, drivetrain, guesses, reach), 1
                    first = first or guesses
                    found.append(_row(case, name, guesses, first))
                    simulator.report(1)
    return found


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
    """Return which of so many values, from 0, bounds their median from below at 97.5 %."""
    tail, rank = 0.5**count, 0
    while tail + math.comb(count, rank + 1) * 0.5**count <= 0.025:
        rank += 1
        tail += math.comb(count, rank) * 0.5**count
    return rank


@contextmanager
def _simulator(plan: Plan, cells: int) -> Iterator[_Simulator]:
    threads = thread_count(plan.threads)
    store = plan.store
    try:
        with (
            Collector((), store=store, threads=threads) as collector,
            reporter(plan.progress, cells, unit="cell") as report,
        ):
            yield _Simulator(collector, report, _draws(plan))
    except RowsInterrupted as interrupt:
        kept = "" if store is None else str(store)
        raise BatchInterrupted(runs_of(interrupt.rows), kept) from None


def _draws(plan: Plan) -> NDArray[np.float64]:
    """[m] Draw what is added to the approach, and the phase: shape (repeats, 2)."""
    outline = engineer().outline
    quarter = 0.125 * outline.axle_distance
    numbers = np.random.default_rng(plan.seed).uniform(size=(plan.repeats, 2))
    return np.column_stack(
        [quarter * (2.0 * numbers[:, 0] - 1.0), outline.grouser_pitch * numbers[:, 1]]
    )


class _Simulator:
    def __init__(self, collector: Collector, report: Reporter, draws: NDArray[np.float64]) -> None:
        self.report = report
        self._collector, self._draws = collector, draws

    def highest(
        self, case: Case, drivetrain: Drivetrain, guesses: Sequence[int], reach: int
    ) -> list[int]:
        """Return the highest edge that each draw clears, in units."""
        whole = _core.Passed(_scenario(case, drivetrain).to_json(), None)
        run_up = case.speed**2 / (2.0 * drivetrain.max_acceleration) + _STEADY
        searches = [_search(guess, reach) for guess in guesses]
        asked = {draw: next(search) for draw, search in enumerate(searches)}
        found = [0] * len(guesses)
        while asked:
            drawn = self._draws[list(asked)] + (run_up, 0.0)
            heights = _UNIT * np.array(list(asked.values()))
            cleared = self._cleared(whole, np.column_stack([heights, drawn]))
            answers = dict(zip(asked, cleared, strict=True))
            asked = {}
            for draw, answer in answers.items():
                try:
                    asked[draw] = searches[draw].send(answer)
                except StopIteration as end:
                    found[draw] = end.value
        return found

    def _cleared(self, whole: _core.Passed, rows: NDArray[np.float64]) -> list[bool]:
        checked = whole.varied([(json_pointer(path), False) for path in _FIELDS], rows)
        raise_first(checked)
        batch = self._collector.batch(checked)
        made = self._collector.rows(batch, lambda _more: None)
        raise_first([row.error for row in made])
        return [row.outcome == Outcome.CLEARED for row in made]


def _search(guess: int, reach: int) -> Generator[int, bool, int]:
    """Ask whether heights are cleared, from a guess on; returns the highest that is."""
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


def _scenario(case: Case, drivetrain: Drivetrain) -> Scenario:
    robot = engineer(flippers=None, track=case.track)
    return Scenario(
        replace(robot, drivetrain=drivetrain),
        _terrain(case.obstacle),
        drive=Drive(speed=case.speed),
        duration=_STANDING + _TRAVEL / case.speed,
    )


def _terrain(obstacle: str) -> Terrain:
    if obstacle == "step":
        return terrains.step(0.05, friction=_FRICTION)
    return terrains.knife_edge(0.05, thickness=_THICKNESS, friction=_FRICTION)


def highest_edges_text(found: Sequence[HighestEdge]) -> str:
    """Write one row per case and one column per drive."""
    drives = list(dict.fromkeys(row.drive for row in found))
    own: dict[tuple[str, str, float], dict[str, HighestEdge]] = {}
    for row in found:
        own.setdefault((row.model, row.obstacle, row.speed), {})[row.drive] = row
    rows = [
        (model, obstacle, f"{speed:g}", *(_cell(each.get(drive)) for drive in drives))
        for (model, obstacle, speed), each in own.items()
    ]
    head = ("highest edge [mm]", "obstacle", "[m/s]", *drives)
    return aligned(head, rows, left=[1])


def _cell(row: HighestEdge | None) -> str:
    if row is None:
        return "-"
    return f"{mm(row.height)} ({mm(row.low)} to {mm(row.high)})"


def paired_text(found: Sequence[HighestEdge]) -> str:
    """Write how often a draw clears more, or less, with each drive than with the first."""
    first = found[0].drive
    others = [row for row in found if row.drive != first]
    rows = []
    for drive in dict.fromkeys(row.drive for row in others):
        own = [row for row in others if row.drive == drive]
        count = sum(len(row.heights) for row in own)
        higher, lower = sum(row.higher for row in own), sum(row.lower for row in own)
        rows.append((drive, *map(str, (count, higher, count - higher - lower, lower))))
    head = (f"draws beside {first}", "count", "higher", "equal", "lower")
    return aligned(head, rows)
