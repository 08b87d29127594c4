"""What a search has found, as a data set and in words: candidates, and the two that it chose."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from crawler2d.common.extras import extra
from crawler2d.runs.labelled import build_attributes
from crawler2d.studies.campaign import Campaign, Tally
from crawler2d.studies.halving import Candidate
from crawler2d.sweeps.labels import Label
from crawler2d.sweeps.rates import banded
from crawler2d.sweeps.statistics import Interval, wilson

if TYPE_CHECKING:
    import xarray

    from crawler2d.sweeps.found import Found

__all__ = ["Confirmation", "judged"]

_BOTH = ("candidate", "terrain")

_SPOKEN = {
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
        Which one.
    pooled : sequence of Tally
        By terrain: runs that each have a draw of everything.
    robots : sequence of sequence of Tally
        By terrain and sample of the unknowns; empty without unknowns.
    """

    candidate: Candidate
    pooled: Sequence[Tally]
    robots: Sequence[Sequence[Tally]]

    @property
    def intervals(self) -> list[Interval]:
        """The rate on each terrain; the number of runs was fixed beforehand."""
        return [wilson(t.successes, len(t.made), t.until.confidence) for t in self.pooled]

    def reaches(self, goal: float) -> bool:
        """Whether the rate is high enough on every terrain."""
        return all(each.rate >= goal for each in self.intervals)


def judged(
    study: Campaign,
    candidates: Sequence[Candidate],
    grounds: Sequence[Label],
    confirmed: Sequence[Confirmation],
    goal: float,
) -> Found:
    """Arrange a search.

    Parameters
    ----------
    study : Campaign
        The study.
    candidates : sequence of Candidate
        All that were tried.
    grounds : sequence of str or number
        Labels of the terrains.
    confirmed : sequence of Confirmation
        Winner and runner-up.
    goal : float
        [-] The rate that is wanted on each terrain.

    Returns
    -------
    Found
        As `search` says.
    """
    from crawler2d.sweeps.found import Found  # noqa: PLC0415 - needs xarray

    xr = extra("xarray", "analysis")
    tallies = [each.tallies for each in candidates]
    labels = [each.label for each in candidates]
    found = xr.Dataset(
        {
            **_intervals([[tally.interval for tally in row] for row in tallies]),
            "count": (_BOTH, [[len(tally.made) for tally in row] for row in tallies]),
            "ending": (_BOTH, [[_ending(tally) for tally in row] for row in tallies]),
            "cost": ("candidate", [each.cost for each in candidates]),
            "round": ("candidate", [each.rounds for each in candidates]),
        },
        {"candidate": labels, "terrain": list(grounds)},
    )
    again = _confirmed(xr, confirmed, grounds, goal)
    gaps = {"confirmed": False, "confirmed_count": 0}
    found = found.merge(again.reindex(candidate=labels, fill_value=gaps))
    for name, text in _SPOKEN.items():
        if name in found:
            found[name].attrs["long_name"] = text
    runs = [*(t for row in tallies for t in row), *(t for each in confirmed for t in each.pooled)]
    runs += [tally for each in confirmed for robots in each.robots for tally in robots]
    vary, unknown = study.planner.variation.text, study.planner.unknowns.text
    return Found(found.data_vars, found.coords).assign_attrs(
        figure="search",
        winner=confirmed[0].candidate.label,
        runner_up=confirmed[1].candidate.label if len(confirmed) > 1 else "",
        verdict=_verdict(candidates, grounds, confirmed, goal),
        at_least=goal,
        scenario=study.base.to_json(),
        vary=vary,
        unknown=unknown,
        population="; ".join(filter(None, [unknown, vary])),
        confidence_level=study.until.confidence,
        interval="sequential",
        seed=study.planner.seed,
        settings=study.settings,
        runs=sum(len(tally.rows) for tally in runs),
        **build_attributes(),
    )


def _confirmed(
    xr: Any, confirmed: Sequence[Confirmation], grounds: Sequence[Label], goal: float
) -> xarray.Dataset:
    """Arrange the fresh runs of winner and runner-up."""
    columns = {f"confirmed_{k}": v for k, v in _intervals([c.intervals for c in confirmed]).items()}
    columns["confirmed_count"] = (_BOTH, [[len(t.made) for t in c.pooled] for c in confirmed])
    columns["confirmed"] = ("candidate", [each.reaches(goal) for each in confirmed])
    coordinates = {"candidate": [c.candidate.label for c in confirmed], "terrain": list(grounds)}
    found: xarray.Dataset = xr.Dataset(columns, coordinates)
    if not confirmed[0].robots:
        return found
    rates = [[[t.interval.rate for t in robots] for robots in c.robots] for c in confirmed]
    found["robot_rate"] = ((*_BOTH, "sample"), rates)
    return found.assign(banded(found["robot_rate"]))


def _intervals(rows: Sequence[Sequence[Interval]]) -> dict[str, Any]:
    parts = np.array(rows, dtype=float)
    return {name: (_BOTH, parts[..., k], {"units": "1"}) for k, name in enumerate(Interval._fields)}


def _ending(tally: Tally) -> str:
    """Tell how most runs that did not succeed ended."""
    ends = Counter(row.outcome for row in tally.made if not tally.counts(row))
    return ends.most_common(1)[0][0] if ends else ""


def _verdict(
    candidates: Sequence[Candidate],
    grounds: Sequence[Label],
    confirmed: Sequence[Confirmation],
    goal: float,
) -> str:
    """Say what was chosen, why, and whether fresh runs bear it out."""
    first = confirmed[0].candidate
    reached = sum(each.rate >= goal for each in candidates)
    if first.rate >= goal:
        why = f"the cheapest that reached {goal:g}, as {reached} of {len(candidates)} did"
    else:
        why = f"the best of {len(candidates)}, none of which reached {goal:g}"
    parts = [f"In the search {first.label} is {why}."]
    for each, place in zip(confirmed, ("winner", "runner-up"), strict=False):
        intervals = each.intervals
        rates = [interval.rate for interval in intervals]
        at = rates.index(min(rates))
        rate, low, high = intervals[at]
        where = f" on {grounds[at]}" if len(grounds) > 1 else ""
        parts.append(
            f"In {len(each.pooled[at].made)} fresh runs{where}, the {place} {each.candidate.label}"
            f" clears {rate:.3f} ({low:.3f} to {high:.3f}):"
            f" {'confirmed' if each.reaches(goal) else 'below the goal'}."
        )
    return " ".join(parts)
