"""Repairs: the smallest changes that end the seizures, searched, and confirmed on fresh draws."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from crawler2d.audits.candidates import Candidate, candidates_of, wheel_count
from crawler2d.audits.runs import Belt, Counted, Runs, column
from crawler2d.audits.sampling import looks
from crawler2d.audits.verdicts import (
    BELT,
    CLEARS,
    OWN,
    RESULTS,
    SEIZES,
    Share,
    Verdict,
    cleared_beside,
    seized_at,
    shares,
    surely,
)
from crawler2d.common.extras import extra
from crawler2d.parameters.robot import Robot
from crawler2d.parameters.scenario import Scenario
from crawler2d.parameters.terrain import Flat, Terrain
from crawler2d.results.outcome import Outcome
from crawler2d.runs.batch import simulate_many
from crawler2d.runs.progress import Progress

if TYPE_CHECKING:
    import xarray

__all__ = ["LEVEL", "Repair", "Repaired", "best_of", "judged", "repaired"]

_ROUNDS, _QUICK = (3, 6, 12, 24), (1, 3, 6, 12)
"""Runs that those have driven who are still in it, and if it is to be quick."""
_LEAST = 2
"""Candidates that stay in it until the end."""


def best_of(
    space: Sequence[Candidate],
    table: xarray.Dataset,
    obstacles: Sequence[str],
    *,
    is_quick: bool,
    threads: int | None,
    show: Progress | None,
) -> Candidate:
    """Choose among candidates by halving, in runs in which the robot seized and the belt cleared.

    All drive three of them, from as many obstacles as there are; the better half drives three
    more, half of these six more, and the last two up to 24. A stop costs more to simulate than all
    else, and most candidates that stop do so at once. Of those that clear 95 % the least changed
    is chosen, else the one that clears most. What wins so was also lucky: only fresh runs can
    confirm it.

    Parameters
    ----------
    space : sequence of Candidate
        All of them, the least changed first.
    table : xarray.Dataset
        The runs behind the verdicts.
    obstacles : sequence of str
        Those that seize, the worst first.
    is_quick : bool
        Whether half of these runs, and one in the first round, are enough.
    threads : int, optional
        See `simulate_many`.
    show : Progress, optional
        Counts the runs.
    """
    rounds = _QUICK if is_quick else _ROUNDS
    bases = _seized(table, obstacles)[: rounds[-1]]
    left, lost, done = list(space), np.zeros(len(space), dtype=int), 0
    places = {each.what: place for place, each in enumerate(space)}
    for end in rounds:
        some = bases[done:end]
        runs = simulate_many(
            [base.replace(_fields(each)) for each in left for base in some],
            record="summary",
            trials=None,
            threads=threads,
            progress=show or False,
        )
        fails = np.array([run.outcome != Outcome.CLEARED for run in runs], dtype=bool)
        lost[[places[each.what] for each in left]] += fails.reshape(len(left), -1).sum(axis=1)
        done = min(end, len(bases))
        order = sorted(left, key=lambda each: lost[places[each.what]])
        left = order[: max(_LEAST, -(-len(order) // 2))]
    allowed = (1.0 - CLEARS) * done
    return min(
        left,
        key=lambda each: (
            max(lost[places[each.what]] - allowed, 0.0),
            places[each.what],
        ),
    )


def _seized(table: xarray.Dataset, obstacles: Sequence[str]) -> list[Scenario]:
    """Return runs that seized where the belt cleared: one of each obstacle, then the next."""
    found = []
    for obstacle in obstacles:
        ends, of_belt, texts = (
            column(table, name, model=model, terrain=obstacle)
            for name, model in (("outcome", OWN), ("outcome", BELT), ("scenario", OWN))
        )
        telling = (ends == Outcome.SEIZED) & (of_belt == Outcome.CLEARED)
        found.append(texts[telling].tolist())
    mixed = [text for texts in itertools.zip_longest(*found) for text in texts if text is not None]
    return [Scenario.from_json(text) for text in mixed]


def _fields(candidate: Candidate) -> dict[str, Any]:
    """Return what a candidate replaces in a robot whose other figures were drawn."""
    robot = candidate.robot
    fields: dict[str, Any] = {"robot.track": robot.track}
    if robot.flippers is not None:
        fields["robot.flippers.track"] = robot.flippers.track
    return fields


LEVEL = "level ground"
"""Where the cost of driving is measured."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Repair:
    """A change that was tried on fresh draws, and what it costs.

    Parameters
    ----------
    what : str
        What changes, in words.
    kind : {"wheels", "gears", "belt"}
        Other round wheels, gear wheels, or belts that a plugin moves.
    robot : Robot
        With the change; all else is as it was.
    change : int
        Wheels and belts of one side that are new, gone, or of another size or shape.
    wheels : int
        Wheels of one side, flippers included.
    confirmed : bool
        Whether it clears, on every obstacle that seized, 95 % or more of those fresh runs that the
        belt clears with the same draws, and seizes in more than 5 % of the runs on none of all
        obstacles but those on which the belt failed, too; nor is the lower bound of that rate above
        5 % at any of the speeds. All of these runs were made then.
    cleared, seized : mapping of str to Share
        In fresh runs, by obstacle.
    seized_at : mapping of str to mapping of float to Share
        In fresh runs, by obstacle and speed [m/s].
    cleared_beside : mapping of str to Share
        How many of the fresh runs that the belt clears it clears, by obstacle that seized.
    speed : float
        [-] Simulated time by computing time on level ground, each of the fastest run, relative to
        the robot as it is: above 1 it is simulated faster. It is that of this simulator.
    """

    what: str
    kind: str
    robot: Robot
    change: int
    wheels: int
    confirmed: bool
    cleared: Mapping[str, Share]
    seized: Mapping[str, Share]
    seized_at: Mapping[str, Mapping[float, Share]]
    cleared_beside: Mapping[str, Share]
    speed: float


class Repaired(NamedTuple):
    """What a search for repairs came to.

    Parameters
    ----------
    repairs : tuple of Repair
        The best of each kind, those that are confirmed first, the least changed first.
    tried : int
        Candidates that were simulated.
    table : xarray.Dataset
        The fresh runs: the models "model" and the repairs by their words, the obstacles and "level
        ground". Those that were not made have the outcome "".
    """

    repairs: tuple[Repair, ...]
    tried: int
    table: xarray.Dataset


def repaired(
    robot: Robot,
    belt: Belt,
    *,
    grounds: Mapping[str, Terrain],
    verdicts: Sequence[Verdict],
    table: xarray.Dataset,
    runs: Runs,
    is_quick: bool,
    show: Progress | None,
) -> Repaired:
    """Search for changes that end the seizures of a robot.

    Of round wheels and of gear wheels the best is chosen in the runs in which the robot seized; see
    `best_of`. Then these and the belt drive with draws that nothing before has had, over all
    obstacles but those on which the belt fails, too. One that can no longer be confirmed stops
    after the next look.

    Parameters
    ----------
    robot : Robot
        As it is.
    belt : Belt
        The same on belts.
    grounds : mapping of str to terrain
        All obstacles.
    verdicts : sequence of Verdict
        What was found on them.
    table : xarray.Dataset
        The runs behind these.
    runs : Runs
        How runs are made.
    is_quick : bool
        Whether gear wheels, which take longest, are tried only where there are no round ones.
    show : Progress, optional
        Counts the runs.
    """
    worst_first = sorted(verdicts, key=lambda each: -each.seized.rate)
    seizing = [each for each in worst_first if each.word == "seizes"]
    carriers = {"chassis" if each.carrier == "chassis" else "flippers" for each in seizing}
    every = candidates_of(robot, carriers)
    spaces = [[each for each in every if each.kind == kind] for kind in ("wheels", "gears")]
    spaces = [space for space in spaces if space]
    if is_quick:
        spaces = spaces[:1]
    names = [each.obstacle for each in seizing]
    chosen = [
        best_of(space, table, names, is_quick=is_quick, threads=runs.threads, show=show)
        for space in spaces
    ]
    beside = OWN
    if belt.robot != robot:
        beside = what = f"belts moved by a track plugin ({belt.reason})"
        belts = wheel_count(robot) + 1
        chosen.append(Candidate(what=what, kind="belt", robot=belt.robot, change=belts))
    over = {
        each.obstacle: grounds[each.obstacle]
        for each in worst_first
        if each.word != "belt fails, too"
    }
    models = {OWN: robot, **{each.what: each.robot for each in chosen}}
    fresh = _driven(models, over, beside=beside, seizing=names, runs=runs, show=show)
    found = [judged(fresh, each, list(over), seizing, beside) for each in chosen]
    return Repaired(
        repairs=tuple(sorted(found, key=lambda each: (not each.confirmed, each.change))),
        tried=sum(map(len, spaces)) + (belt.robot != robot),
        table=fresh,
    )


def _driven(
    models: Mapping[str, Robot],
    over: Mapping[str, Terrain],
    *,
    beside: str,
    seizing: Sequence[str],
    runs: Runs,
    show: Progress | None,
) -> xarray.Dataset:
    """Drive candidates over obstacles with fresh draws, until they fail or all are made."""
    xr = extra("xarray", "analysis")
    courses = {
        name: runs.course(models, name, ground, is_confirming=True) for name, ground in over.items()
    }
    samples = next(iter(courses.values())).samples
    count = Counted(show, samples * len(over) * (len(models) - 1))
    left = [what for what in models if what != OWN or what == beside]
    for made in looks(samples):
        for course in courses.values():
            for what in left:
                course.drive(what, made, count.part())
        tables = {name: course.table() for name, course in courses.items()}
        failed = [what for what in left if _fails(tables, what, beside, seizing)]
        left = [what for what in left if what == beside or what not in failed]
        if set(left) <= {OWN, *failed}:
            break
    # Stops that rattle cost most, so what driving costs is measured where nothing stops.
    ground = Flat(length=5.0 * models[OWN].outline.axle_distance)
    level = runs.course(models, LEVEL, ground, is_confirming=True)
    for what in models:
        level.drive(what, next(looks(samples)), count.part())
    fresh: xarray.Dataset = xr.concat([*tables.values(), level.table()], "terrain")
    return fresh


def _fails(
    tables: Mapping[str, xarray.Dataset], what: str, beside: str, seizing: Sequence[str]
) -> bool:
    """Whether no runs to come can confirm a candidate."""
    for name, table in tables.items():
        ends, of_belt = (
            column(table, "outcome", model=each, terrain=name) for each in (what, beside)
        )
        lost = np.isin(ends, RESULTS) & (ends != Outcome.CLEARED) & (of_belt == Outcome.CLEARED)
        if name in seizing and ends.size - int(lost.sum()) < CLEARS * ends.size:
            return True
        is_seized = ends == Outcome.SEIZED
        if is_seized.sum() > SEIZES * ends.size or surely(table, is_seized) > SEIZES:
            return True
    return False


def judged(
    table: xarray.Dataset,
    chosen: Candidate,
    grounds: list[str],
    seizing: Sequence[Verdict],
    belt: str,
) -> Repair:
    """Judge a candidate by its fresh runs, beside those of the belt."""
    pairs = {name: shares(table, chosen.what, name) for name in grounds}
    names = [each.obstacle for each in seizing]
    beside = {name: cleared_beside(table, chosen.what, belt, name) for name in names}
    clears = all(share.rate >= CLEARS for share in beside.values())
    at = {name: seized_at(table, chosen.what, name) for name in grounds}
    rates = [
        *(seized for _, seized in pairs.values()),
        *(r for own in at.values() for r in own.values()),
    ]
    # So that fewer runs confirm no more: the rate itself counts, too, where it is over all speeds.
    seizes = any(each.low > SEIZES for each in rates)
    seizes |= any(seized.rate > SEIZES for _, seized in pairs.values())
    ends = (column(table, "outcome", model=chosen.what, terrain=name) for name in grounds)
    is_whole = all((each != "").all() for each in ends)
    return Repair(
        what=chosen.what,
        kind=chosen.kind,
        robot=chosen.robot,
        change=chosen.change,
        wheels=wheel_count(chosen.robot),
        confirmed=clears and not seizes and is_whole,
        cleared={name: cleared for name, (cleared, _) in pairs.items()},
        seized={name: seized for name, (_, seized) in pairs.items()},
        seized_at=at,
        cleared_beside=beside,
        speed=_speed(table, chosen.what) / _speed(table, OWN),
    )


def _speed(table: xarray.Dataset, model: str) -> float:
    """[-] Return simulated time by computing time on level ground, of the fastest run.

    Whatever else the machine does makes the others slower, by a factor of four and more.
    """
    own = table.sel(model=model, terrain=LEVEL)
    return float(np.nanmax(own["time"].values / own["wall_time"].values))
