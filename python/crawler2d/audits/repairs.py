"""Repairs: the smallest changes that end the seizures, searched, and confirmed on fresh draws."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from crawler2d.audits.beside import Belt
from crawler2d.audits.candidates import Candidate, candidates_of, wheel_count
from crawler2d.audits.runs import Runs, raised
from crawler2d.audits.screen import screened
from crawler2d.audits.share import Share
from crawler2d.audits.verdicts import (
    CLEARS,
    OWN,
    SEIZES,
    Verdict,
    cleared_beside,
    seized_at,
    shares,
)
from crawler2d.parameters.robot import Robot
from crawler2d.parameters.scenario import Scenario
from crawler2d.parameters.terrain import Flat, Terrain
from crawler2d.studies.search import search

if TYPE_CHECKING:
    import xarray

__all__ = ["LEVEL", "Repair", "Repaired", "judged", "repaired"]

_FIRST = 10  # runs of every candidate on each terrain in the first round of a search
_GROUNDS = 4  # obstacles of a search: those that seize most
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
        belt clears with the same draws, and the lower bound of its rate of seizing is above 5 % on
        none of all obstacles, neither at all speeds together nor at any of them.
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
    hopeless : tuple of str
        Kinds of which no candidate passed the screen.
    before : mapping of str to Share
        How often the robot as it is seizes in the same fresh runs, by obstacle.
    table : xarray.Dataset
        The fresh runs: the models "model" and the repairs by their words, the obstacles and "level
        ground".
    """

    repairs: tuple[Repair, ...]
    tried: int
    hopeless: tuple[str, ...]
    before: Mapping[str, Share]
    table: xarray.Dataset


def repaired(
    robot: Robot,
    belt: Belt,
    *,
    grounds: Mapping[str, Terrain],
    verdicts: Sequence[Verdict],
    table: xarray.Dataset,
    runs: Runs,
) -> Repaired:
    """Search for changes that end the seizures of a robot.

    Candidates first drive the runs in which the robot seized; see `screened`. Of those that pass,
    round wheels and gear wheels apart, the least changed is searched for that clears 95 % as often
    as the belt on the four obstacles that seize most; see `crawler2d.studies.search`. Then these,
    the belt and the robot as it is drive over all obstacles with draws that nothing before has had.

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
    """
    seizing = [each for each in verdicts if each.word == "seizes"]
    worst = sorted(seizing, key=lambda each: -each.seized.rate)[:_GROUNDS]
    carriers = {"chassis" if each.carrier == "chassis" else "flippers" for each in seizing}
    every = candidates_of(robot, carriers)
    passed = screened(every, table, worst[0].obstacle, runs.threads)
    chosen, hopeless = [], []
    for kind in ("wheels", "gears"):
        space = [each for each in passed if each.kind == kind]
        if not space and any(each.kind == kind for each in every):
            hopeless.append(kind)
        elif space:
            chosen.append(_searched(space, worst, grounds, runs))
    beside = OWN
    if belt.robot != robot:
        beside = what = f"belts moved by a track plugin ({belt.reason})"
        belts = wheel_count(robot) + 1
        chosen.append(Candidate(what=what, kind="belt", robot=belt.robot, change=belts))
    models = {OWN: robot, **{each.what: each.robot for each in chosen}}
    # Stops that rattle cost most, so what driving costs is measured where nothing stops.
    level = Flat(length=5.0 * robot.outline.axle_distance)
    fresh = runs.table(models, {**grounds, LEVEL: level}, is_confirming=True)
    found = [judged(fresh, each, list(grounds), seizing, beside) for each in chosen]
    order = sorted(found, key=lambda each: (not each.confirmed, each.change))
    before = {name: shares(fresh, OWN, name)[1] for name in grounds}
    return Repaired(
        repairs=tuple(order),
        tried=len(every) + (belt.robot != robot),
        hopeless=tuple(hopeless),
        before=before,
        table=fresh,
    )


def _searched(
    space: list[Candidate], worst: Sequence[Verdict], grounds: Mapping[str, Terrain], runs: Runs
) -> Candidate:
    """Return the least changed candidate that gets over the worst obstacles, or the best of all."""
    drive = runs.scenario.drive
    changes = {raised(each.robot, drive): each.change for each in space}

    def change(scenario: Scenario) -> float:
        return float(changes[scenario.robot])

    found = search(
        runs.scenario,
        {each.what: {"robot": raised(each.robot, drive)} for each in space},
        change,
        terrains={each.obstacle: grounds[each.obstacle] for each in worst},
        # No wheels do better than the belt where that fails, as on slippery floors.
        at_least=CLEARS * min(each.belt_cleared.rate for each in worst),
        first=_FIRST,
        confirm=1,  # the fresh runs of `repaired` confirm
        vary=runs.vary,
        unknown=runs.unknown,
        samples=1,
        seed=runs.seed,
        store=runs.store,
        executor=runs.executor,
        threads=runs.threads,
        progress=runs.progress,
    )
    return next(each for each in space if each.what == found.attrs["winner"])


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
    seizes = any(each.low > SEIZES for each in rates)
    return Repair(
        what=chosen.what,
        kind=chosen.kind,
        robot=chosen.robot,
        change=chosen.change,
        wheels=wheel_count(chosen.robot),
        confirmed=clears and not seizes,
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
