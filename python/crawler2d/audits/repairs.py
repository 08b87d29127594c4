"""Repairs: search the smallest changes that end the seizures, and confirm them on fresh draws."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from crawler2d.audits.candidates import Candidate, candidates_of, wheel_count
from crawler2d.audits.jams import free_of_jams
from crawler2d.audits.runs import Belt, RunCounter, Runs
from crawler2d.audits.sampling import look_counts
from crawler2d.audits.verdicts import (
    BELT,
    CLEARS,
    OWN,
    SEIZES,
    ObstacleRuns,
    Proportion,
    Verdict,
)
from crawler2d.common.extras import extra
from crawler2d.parameters.robot import Robot
from crawler2d.parameters.scenario import Scenario
from crawler2d.parameters.terrain import Flat, Terrain
from crawler2d.results.outcome import Outcome
from crawler2d.runs.batch import simulate_many
from crawler2d.runs.progress import Progress
from crawler2d.variation.distributions import Ranges, scaled

if TYPE_CHECKING:
    import xarray

__all__ = ["LEVEL", "Repair", "RepairSearch", "assess", "search_repairs"]

_ROUNDS, _QUICK = (3, 6, 12, 24), (1, 3, 6, 12)
"""Runs of each remaining candidate after each round, in a full and a quick search."""
_LEAST = 2
"""Candidates that remain until the end."""

LEVEL = "level ground"
"""Ground on which computing time is measured."""

_OF_LEVEL = ("terrain.friction", "terrain.length")


@dataclass(frozen=True, slots=True, kw_only=True)
class Repair:
    """A change tested on fresh draws, and its cost.

    Parameters
    ----------
    description : str
        The change, in words.
    kind : {"wheels", "gears", "belt"}
        Other round wheels, gear wheels, or belts moved by a plugin.
    robot : Robot
        The robot with this change only.
    change : int
        Number of wheels and belts of one side that are new, removed, or have another size or shape.
    wheels : int
        Wheels of one side, including flippers.
    confirmed : bool
        Whether all fresh runs were made, and (1) on every obstacle that seized it clears at least
        95 % of the runs that the belt clears with the same draws, and (2) on all obstacles, except
        those on which the belt failed, too, it seizes in at most 5 % of the runs, and at no speed
        is the lower bound of that rate above 5 %.
    cleared, seized : mapping of str to Proportion
        Rates in fresh runs, by obstacle.
    seized_at : mapping of str to mapping of float to Proportion
        Rate of seizing in fresh runs, by obstacle and speed [m/s].
    cleared_given_belt : mapping of str to Proportion
        Rate of clearing among the fresh runs that the belt clears, by obstacle that seized.
    speed : float
        [-] Simulated time per computing time on level ground, each from the fastest run, relative
        to the unchanged robot: above 1 is faster. It holds for this simulator.
    """

    description: str
    kind: str
    robot: Robot
    change: int
    wheels: int
    confirmed: bool
    cleared: Mapping[str, Proportion]
    seized: Mapping[str, Proportion]
    seized_at: Mapping[str, Mapping[float, Proportion]]
    cleared_given_belt: Mapping[str, Proportion]
    speed: float


class RepairSearch(NamedTuple):
    """Result of a search for repairs.

    Parameters
    ----------
    repairs : tuple of Repair
        The best of each kind: confirmed ones first, then the smallest change first.
    candidate_count : int
        Number of simulated candidates.
    table : xarray.Dataset
        The fresh runs: the models "model" and the repairs by `Repair.description`, the obstacles
        and "level ground". Missing runs have the outcome "".
    """

    repairs: tuple[Repair, ...]
    candidate_count: int
    table: xarray.Dataset


def search_repairs(
    robot: Robot,
    belt: Belt,
    *,
    grounds: Mapping[str, Terrain],
    verdicts: Sequence[Verdict],
    table: xarray.Dataset,
    runs: Runs,
    is_quick: bool,
    show: Progress | None,
) -> RepairSearch:
    """Search for changes that end the seizures of a robot.

    The best candidates with round and with gear wheels are selected in runs in which the robot
    seized; see `_best_of`. Then these and the belt drive with fresh draws over all obstacles except
    those on which the belt fails, too. A candidate that can no longer be confirmed stops at the
    next check.

    Parameters
    ----------
    robot : Robot
        The unchanged robot.
    belt : Belt
        The same robot on belts.
    grounds : mapping of str to terrain
        All obstacles.
    verdicts : sequence of Verdict
        Verdicts on them.
    table : xarray.Dataset
        The runs behind the verdicts.
    runs : Runs
        Settings of the runs.
    is_quick : bool
        Whether to try gear wheels, the slowest, only if there are no round ones.
    show : Progress, optional
        Counts the runs.
    """
    worst_first = sorted(verdicts, key=lambda each: -each.seized.rate)
    seizing = [each for each in worst_first if each.result == "seizes"]
    carriers = {"chassis" if each.carrier == "chassis" else "flippers" for each in seizing}
    every = candidates_of(robot, carriers)
    spaces = [[each for each in every if each.kind == kind] for kind in ("wheels", "gears")]
    spaces = [space for space in spaces if space]
    if is_quick:
        spaces = spaces[:1]
    names = [each.obstacle for each in seizing]
    chosen = [
        _best_of(space, table, names, is_quick=is_quick, threads=runs.threads, show=show)
        for space in spaces
    ]
    reference = OWN
    if belt.robot != robot:
        reference = description = f"belts moved by a track plugin ({belt.reason})"
        belts = wheel_count(robot) + 1
        chosen.append(
            Candidate(description=description, kind="belt", robot=belt.robot, change=belts)
        )
    over = {
        each.obstacle: grounds[each.obstacle]
        for each in worst_first
        if each.result != "belt fails, too"
    }
    models = {OWN: robot, **{each.description: each.robot for each in chosen}}
    fresh = _drive(models, over, reference=reference, seizing=names, runs=runs, show=show)
    found = [assess(fresh, each, list(over), names, reference) for each in chosen]
    return RepairSearch(
        repairs=tuple(sorted(found, key=lambda each: (not each.confirmed, each.change))),
        candidate_count=sum(map(len, spaces)) + (belt.robot != robot),
        table=fresh,
    )


def _best_of(
    space: Sequence[Candidate],
    table: xarray.Dataset,
    obstacles: Sequence[str],
    *,
    is_quick: bool,
    threads: int | None,
    show: Progress | None,
) -> Candidate:
    """Choose among candidates by successive halving, in runs that only the belt cleared.

    The runs are those in which the robot seized and the belt cleared. If the computation finds
    candidates that cannot jam in the first of them, only these are driven. All drive three runs,
    from as many obstacles as possible; the better half drives three more, half of these six more,
    and the last two up to 24. Stops are the most expensive runs, and most candidates that stop do
    so at once. Among those that clear 95 % the smallest change is chosen, else the one that clears
    most. The winner was also lucky: only fresh runs can confirm it.

    Parameters
    ----------
    space : sequence of Candidate
        All candidates, the smallest change first.
    table : xarray.Dataset
        The runs behind the verdicts.
    obstacles : sequence of str
        Obstacles that seize, the worst first.
    is_quick : bool
        Whether to make half of these runs, and one in the first round.
    threads : int, optional
        See `simulate_many`.
    show : Progress, optional
        Counts the runs.
    """
    rounds = _QUICK if is_quick else _ROUNDS
    bases = _seized(table, obstacles)[: rounds[-1]]
    fields = [_fields(candidate) for candidate in space]
    left = free_of_jams(fields, bases[: rounds[0]]) or list(range(len(space)))
    fails, done = np.zeros(len(space), dtype=int), 0
    for end in rounds:
        some = bases[done:end]
        runs = simulate_many(
            [base.replace(fields[place]) for place in left for base in some],
            record="summary",
            trials=None,
            threads=threads,
            progress=show or False,
        )
        failed = np.array([run.outcome != Outcome.CLEARED for run in runs], dtype=bool)
        fails[left] += failed.reshape(len(left), -1).sum(axis=1)
        done = min(end, len(bases))
        left = sorted(left, key=lambda place: fails[place])[: max(_LEAST, -(-len(left) // 2))]
    allowed = (1.0 - CLEARS) * done
    return space[min(left, key=lambda place: (max(fails[place] - allowed, 0.0), place))]


def _seized(table: xarray.Dataset, obstacles: Sequence[str]) -> list[Scenario]:
    """Return runs that seized where the belt cleared, one per obstacle in turn."""
    texts = []
    for obstacle in obstacles:
        own, belt = (ObstacleRuns(table, model, obstacle) for model in (OWN, BELT))
        texts.append(own.column("scenario")[own.seized & belt.cleared].tolist())
    mixed = itertools.chain.from_iterable(itertools.zip_longest(*texts))
    return [Scenario.from_json(text) for text in mixed if text is not None]


def _fields(candidate: Candidate) -> dict[str, Any]:
    """Return the values that a candidate replaces in a robot with drawn figures."""
    robot = candidate.robot
    fields: dict[str, Any] = {"robot.track": robot.track}
    if robot.flippers is not None:
        fields["robot.flippers.track"] = robot.flippers.track
    return fields


def _drive(
    models: Mapping[str, Robot],
    over: Mapping[str, Terrain],
    *,
    reference: str,
    seizing: Sequence[str],
    runs: Runs,
    show: Progress | None,
) -> xarray.Dataset:
    """Drive candidates with fresh draws until they fail or all runs are made."""
    xr = extra("xarray", "analysis")
    courses = {
        name: runs.course(models, name, ground, is_confirming=True) for name, ground in over.items()
    }
    samples = next(iter(courses.values())).samples
    count = RunCounter(show, samples * len(over) * (len(models) - 1))
    left = [name for name in models if name != OWN or name == reference]
    for target in look_counts(samples):
        for course in courses.values():
            for name in left:
                course.drive(name, target, count.next_batch())
        tables = {name: course.table() for name, course in courses.items()}
        failed = [name for name in left if _fails(tables, name, reference, seizing)]
        left = [name for name in left if name == reference or name not in failed]
        if set(left) <= {OWN, *failed}:
            break
    # Rattling stops cost most, so computing time is measured where nothing stops.
    ground = Flat(length=5.0 * models[OWN].outline.axle_distance)
    on_level = replace(runs, vary=_on_level(runs.vary), unknown=_on_level(runs.unknown))
    level = on_level.course(models, LEVEL, ground, is_confirming=True)
    for name in models:
        level.drive(name, next(look_counts(samples)), count.next_batch())
    fresh: xarray.Dataset = xr.concat([*tables.values(), level.table()], "terrain")
    return fresh


def _on_level(draws: Mapping[str, Any]) -> Ranges:
    """Drop draws of fields that level ground lacks, such as a height."""
    lacking = [each for each in draws if each.startswith("terrain.") and each not in _OF_LEVEL]
    left = (Ranges({}) | draws).without(lacking)
    # Without unknowns, samples would be repeats.
    return Ranges({"terrain.friction": scaled(1.0, 1.0)}) if draws and not left else left


def _fails(
    tables: Mapping[str, xarray.Dataset], model: str, reference: str, seizing: Sequence[str]
) -> bool:
    """Whether the remaining runs cannot confirm a candidate."""
    for name, table in tables.items():
        own, belt = (ObstacleRuns(table, each, name) for each in (model, reference))
        lost, size = own.has_result & ~own.cleared & belt.cleared, own.ends.size
        if name in seizing and size - int(lost.sum()) < CLEARS * size:
            return True
        if own.seized.sum() > SEIZES * size or own.least_rate(own.seized) > SEIZES:
            return True
    return False


def assess(
    table: xarray.Dataset,
    chosen: Candidate,
    grounds: Sequence[str],
    seizing: Sequence[str],
    belt: str,
) -> Repair:
    """Assess a candidate by its fresh runs and those of the belt."""
    runs = {name: ObstacleRuns(table, chosen.description, name) for name in grounds}
    seized = {name: own.proportion(own.seized) for name, own in runs.items()}
    seized_at = {name: own.by_speed(own.seized) for name, own in runs.items()}
    cleared_given_belt = {
        name: runs[name].proportion(runs[name].cleared, ObstacleRuns(table, belt, name).cleared)
        for name in seizing
    }
    rates = [*seized.values(), *(each for at in seized_at.values() for each in at.values())]
    # The rate over all speeds must also be low, so that fewer runs do not confirm more easily.
    seizes = any(each.low > SEIZES for each in rates)
    seizes |= any(each.rate > SEIZES for each in seized.values())
    clears = all(each.rate >= CLEARS for each in cleared_given_belt.values())
    is_whole = all((own.ends != "").all() for own in runs.values())
    return Repair(
        description=chosen.description,
        kind=chosen.kind,
        robot=chosen.robot,
        change=chosen.change,
        wheels=wheel_count(chosen.robot),
        confirmed=clears and not seizes and is_whole,
        cleared={name: own.proportion(own.cleared) for name, own in runs.items()},
        seized=seized,
        seized_at=seized_at,
        cleared_given_belt=cleared_given_belt,
        speed=_speed(table, chosen.description) / _speed(table, OWN),
    )


def _speed(table: xarray.Dataset, model: str) -> float:
    """[-] Return simulated time per computing time on level ground, from the fastest run.

    Other load on the machine slows runs by a factor of four and more.
    """
    own = table.sel(model=model, terrain=LEVEL)
    return float(np.nanmax(own["time"].values / own["wall_time"].values))
