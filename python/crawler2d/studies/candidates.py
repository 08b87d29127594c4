"""Candidates of a search, successive halving, and the table of results."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from crawler2d.common.extras import extra
from crawler2d.studies.campaign import Campaign, Tally
from crawler2d.sweeps.axes import Label
from crawler2d.sweeps.plan import Plan, Planner, World
from crawler2d.sweeps.rates import quantile_band
from crawler2d.sweeps.statistics import Interval, wilson

if TYPE_CHECKING:
    import xarray

    from crawler2d.sweeps.figure_dataset import FigureDataset

__all__ = ["Candidate", "Confirmation", "FreshDraws", "halve", "ranked", "search_table"]


class FreshDraws(Planner):
    """Draws everything for each run: run k has sample k of the unknowns, and its repeat k."""

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
    """A candidate of a search.

    Attributes
    ----------
    label : str or number
        Name of the candidate.
    cost : float
        Cost to be minimized.
    tallies : list of Tally
        Tallies by terrain.
    rounds : int
        Number of rounds completed.
    """

    label: Label
    cost: float
    tallies: list[Tally]
    rounds: int = 0

    @property
    def count(self) -> int:
        """Number of runs on each terrain."""
        return len(self.tallies[0].rows)

    @property
    def lowest(self) -> int:
        """The terrain with the lowest rate."""
        rates = [tally.successes / max(len(tally.valid), 1) for tally in self.tallies]
        return rates.index(min(rates))

    @property
    def rate(self) -> float:
        """[-] Its lowest rate; 0 without runs."""
        tally = self.tallies[self.lowest]
        return tally.successes / max(len(tally.valid), 1)

    def fails(self, goal: float) -> bool:
        """Whether its rate is certainly below the goal on some terrain."""
        return any(tally.interval.high < goal for tally in self.tallies)


def ranked(candidates: Sequence[Candidate], goal: float) -> list[Candidate]:
    """Sort those that reach the goal by cost, then the others by rate; ties keep their order."""

    def key(each: Candidate) -> tuple[bool, float]:
        return (False, each.cost) if each.rate >= goal else (True, -each.rate)

    return sorted(candidates, key=key)


def halve(study: Campaign, candidates: Sequence[Candidate], goal: float, first: int) -> int:
    """Simulate all candidates a few times, then the better half twice as often, down to two.

    Candidates that certainly fail get no more runs, unless all do. Eliminated candidates return if
    the others turn out worse: in the end the best two have completed every round.

    Parameters
    ----------
    study : Campaign
        The campaign that simulates.
    candidates : sequence of Candidate
        One or more candidates; their tallies are changed.
    goal : float
        [-] The rate that is wanted on each terrain.
    first : int
        Runs of every candidate on each terrain in the first round.

    Returns
    -------
    int
        Number of rounds.
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
    """Bring candidates to the number of runs after a number of rounds."""
    wanted = first * 2 ** (rounds - 1)
    study.simulate([(tally, wanted - each.count) for each in chosen for tally in each.tallies])
    for each in chosen:
        each.rounds = rounds


_BOTH = ("candidate", "terrain")

_LONG_NAMES = {
    "rate": "rate of clearing in the search",
    "low": "lower bound",
    "high": "upper bound",
    "count": "number of runs",
    "round": "rounds that it has been through",
    "ending": "how most runs that did not clear ended",
    "confirmed": "the confirmed rate reaches the goal on every terrain",
    "confirmed_rate": "rate of clearing in fresh runs",
    "confirmed_low": "its lower bound",
    "confirmed_high": "its upper bound",
    "confirmed_count": "number of fresh runs",
    "robot_rate": "rate of clearing of a single sample of the unknowns",
}


@dataclass(frozen=True, slots=True)
class Confirmation:
    """The fresh runs of a candidate.

    Attributes
    ----------
    candidate : Candidate
        The candidate.
    pooled : sequence of Tally
        Tallies by terrain, of runs with a draw of everything each.
    robots : sequence of sequence of Tally
        Tallies by terrain and sample of the unknowns; empty without unknowns.
    """

    candidate: Candidate
    pooled: Sequence[Tally]
    robots: Sequence[Sequence[Tally]]

    @property
    def intervals(self) -> list[Interval]:
        """The rate on each terrain, for a number of runs fixed in advance."""
        return [wilson(t.successes, len(t.valid), t.until.confidence) for t in self.pooled]

    def reaches(self, goal: float) -> bool:
        """Whether the rate reaches the goal on every terrain."""
        return all(each.rate >= goal for each in self.intervals)


def search_table(
    study: Campaign,
    candidates: Sequence[Candidate],
    grounds: Sequence[Label],
    confirmed: Sequence[Confirmation],
    goal: float,
) -> FigureDataset:
    """Arrange the results of a search.

    Parameters
    ----------
    study : Campaign
        The study.
    candidates : sequence of Candidate
        All candidates tried.
    grounds : sequence of str or number
        Labels of the terrains.
    confirmed : sequence of Confirmation
        Winner and runner-up.
    goal : float
        [-] The rate that is wanted on each terrain.

    Returns
    -------
    FigureDataset
        See `search`.
    """
    from crawler2d.sweeps.figure_dataset import FigureDataset  # noqa: PLC0415 - needs xarray

    xr = extra("xarray", "analysis")
    tallies = [each.tallies for each in candidates]
    labels = [each.label for each in candidates]
    dataset = xr.Dataset(
        {
            **_intervals([[tally.interval for tally in row] for row in tallies]),
            "count": (_BOTH, [[len(tally.valid) for tally in row] for row in tallies]),
            "ending": (_BOTH, [[tally.commonest_failure for tally in row] for row in tallies]),
            "cost": ("candidate", [each.cost for each in candidates]),
            "round": ("candidate", [each.rounds for each in candidates]),
        },
        {"candidate": labels, "terrain": list(grounds)},
    )
    again = _confirmed(xr, confirmed, grounds, goal)
    gaps = {"confirmed": False, "confirmed_count": 0}
    dataset = dataset.merge(again.reindex(candidate=labels, fill_value=gaps))
    for name, text in _LONG_NAMES.items():
        if name in dataset:
            dataset[name].attrs["long_name"] = text
    runs = [*(t for row in tallies for t in row), *(t for each in confirmed for t in each.pooled)]
    runs += [tally for each in confirmed for robots in each.robots for tally in robots]
    attributes = study.attributes("search", runs)
    return FigureDataset(dataset.data_vars, dataset.coords).assign_attrs(
        winner=confirmed[0].candidate.label,
        runner_up=confirmed[1].candidate.label if len(confirmed) > 1 else "",
        verdict=_verdict(candidates, grounds, confirmed, goal),
        at_least=goal,
        population="; ".join(filter(None, [attributes["unknown"], attributes["vary"]])),
        confidence_level=study.until.confidence,
        interval="sequential",
        seed=study.planner.seed,
        **attributes,
    )


def _confirmed(
    xr: Any, confirmed: Sequence[Confirmation], grounds: Sequence[Label], goal: float
) -> xarray.Dataset:
    """Arrange the fresh runs of winner and runner-up."""
    columns = {f"confirmed_{k}": v for k, v in _intervals([c.intervals for c in confirmed]).items()}
    columns["confirmed_count"] = (_BOTH, [[len(t.valid) for t in c.pooled] for c in confirmed])
    columns["confirmed"] = ("candidate", [each.reaches(goal) for each in confirmed])
    coordinates = {"candidate": [c.candidate.label for c in confirmed], "terrain": list(grounds)}
    dataset: xarray.Dataset = xr.Dataset(columns, coordinates)
    if not confirmed[0].robots:
        return dataset
    rates = [[[t.interval.rate for t in robots] for robots in c.robots] for c in confirmed]
    dataset["robot_rate"] = ((*_BOTH, "sample"), rates)
    return dataset.assign(quantile_band(dataset["robot_rate"]))


def _intervals(rows: Sequence[Sequence[Interval]]) -> dict[str, Any]:
    parts = np.array(rows, dtype=float)
    return {name: (_BOTH, parts[..., k], {"units": "1"}) for k, name in enumerate(Interval._fields)}


def _verdict(
    candidates: Sequence[Candidate],
    grounds: Sequence[Label],
    confirmed: Sequence[Confirmation],
    goal: float,
) -> str:
    """Describe the choice, its reason, and whether fresh runs confirm it."""
    first = confirmed[0].candidate
    reached = sum(each.rate >= goal for each in candidates)
    if first.rate >= goal:
        why = f"the cheapest that reached {goal:g}, as {reached} of {len(candidates)} did"
    else:
        why = f"the best of {len(candidates)}, none of which reached {goal:g}"
    parts = [f"In the search {first.label} is {why}."]
    for each, place in zip(confirmed, ("winner", "runner-up"), strict=False):
        intervals = each.intervals
        rates = [math.inf if math.isnan(rate) else rate for rate, _, _ in intervals]
        at = rates.index(min(rates))
        rate, low, high = intervals[at]
        where = f" on {grounds[at]}" if len(grounds) > 1 else ""
        if math.isnan(rate):
            parts.append(f"No fresh run of the {place} {each.candidate.label} has a result.")
            continue
        parts.append(
            f"In {len(each.pooled[at].valid)} fresh runs{where}, the {place} {each.candidate.label}"
            f" clears {rate:.3f} ({low:.3f} to {high:.3f}):"
            f" {'confirmed' if each.reaches(goal) else 'below the goal'}."
        )
    return " ".join(parts)
