"""Successive halving: all candidates a few times, the better half twice as often, down to two."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

from crawler2d.studies.campaign import Campaign, Tally
from crawler2d.sweeps.labels import Label
from crawler2d.sweeps.plan import Plan, Planner, World

__all__ = ["Candidate", "Fresh", "halve", "ranked"]


class Fresh(Planner):
    """Draws everything anew for every run: run k has sample k of the unknowns, and its repeat k."""

    __slots__ = ()

    def runs(self, world: World, begin: int, end: int) -> Plan:
        """Draw some runs of a cell; see `Planner`."""
        if not self.unknowns.distributions:
            return Planner.runs(self, world, begin, end)
        worlds = replace(self, samples=end).worlds(world.cell, world.labels)[begin:]
        plans = [Planner.runs(self, each, k, k + 1) for k, each in enumerate(worlds, begin)]
        return Plan(world, begin, [run for plan in plans for run in plan.checked], {})


@dataclass(slots=True)
class Candidate:
    """What may be chosen.

    Attributes
    ----------
    label : str or number
        Its name.
    cost : float
        What is to be small.
    tallies : list of Tally
        By terrain.
    rounds : int
        How many rounds it has been through.
    """

    label: Label
    cost: float
    tallies: list[Tally]
    rounds: int = 0

    @property
    def count(self) -> int:
        """How often it has been simulated on each terrain."""
        return len(self.tallies[0].rows)

    @property
    def lowest(self) -> int:
        """The terrain on which its rate is lowest."""
        rates = [tally.successes / max(len(tally.made), 1) for tally in self.tallies]
        return rates.index(min(rates))

    @property
    def rate(self) -> float:
        """[-] Its lowest rate; 0 without runs."""
        tally = self.tallies[self.lowest]
        return tally.successes / max(len(tally.made), 1)

    def fails(self, goal: float) -> bool:
        """Whether its rate certainly lies below the goal on some terrain."""
        return any(tally.interval.high < goal for tally in self.tallies)


def ranked(candidates: Sequence[Candidate], goal: float) -> list[Candidate]:
    """Sort those that reach the goal by cost, then the others by rate; ties keep their order."""

    def key(each: Candidate) -> tuple[bool, float]:
        return (False, each.cost) if each.rate >= goal else (True, -each.rate)

    return sorted(candidates, key=key)


def halve(study: Campaign, candidates: Sequence[Candidate], goal: float, first: int) -> int:
    """Simulate all candidates a few times, the better half twice as often, down to two.

    What certainly fails has no more runs, unless everything does. What was left behind returns if
    those before it turn out worse: in the end the first two of all have been through every round.

    Parameters
    ----------
    study : Campaign
        What simulates.
    candidates : sequence of Candidate
        At least one; their tallies are changed.
    goal : float
        [-] The rate that is wanted on each terrain.
    first : int
        Runs of every candidate on each terrain in the first round.

    Returns
    -------
    int
        How many rounds there were.
    """
    rounds = max(math.ceil(math.log2(len(candidates))), 1)
    for number in range(rounds):
        kept = max(math.ceil(len(candidates) / 2**number), 2)
        order = ranked(candidates, goal)
        alive = [each for each in order if not each.fails(goal)]
        _advance(study, (alive or order)[:kept], number + 1, first)
    while due := [each for each in ranked(candidates, goal)[:2] if each.rounds < rounds]:
        _advance(study, due, rounds, first)
    return rounds


def _advance(study: Campaign, chosen: Sequence[Candidate], rounds: int, first: int) -> None:
    """Bring candidates to the number of runs that they have after so many rounds."""
    wanted = first * 2 ** (rounds - 1)
    study.simulate([(tally, wanted - each.count) for each in chosen for tally in each.tallies])
    for each in chosen:
        each.rounds = rounds
