"""What an audit says of each obstacle, by one written rule, from proportions of the runs on it."""

from __future__ import annotations

import itertools
import math
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from crawler2d.audits.runs import TRIED
from crawler2d.results.outcome import Outcome
from crawler2d.sweeps.axes import short_name
from crawler2d.sweeps.sequential import sequential
from crawler2d.sweeps.statistics import clustered, wilson

if TYPE_CHECKING:
    import xarray
    from numpy.typing import NDArray

__all__ = [
    "BELT",
    "CLEARS",
    "OWN",
    "SEIZES",
    "ObstacleRuns",
    "Proportion",
    "Verdict",
    "is_certain",
    "least_samples",
    "proportion_of",
    "result_of",
    "verdict_of",
]

OWN, BELT = "model", "belt"
"""Names of the two in the table."""

SEIZES, _SELDOM, CLEARS, _QUARTER = 0.05, 0.10, 0.95, 0.25

_RESULTS = tuple(str(each) for each in Outcome)
"""Outcomes of runs that have a result."""

_TRIED = ("closed track", "closed track, clear of the ground", *TRIED)


@dataclass(frozen=True, slots=True, kw_only=True)
class Proportion:
    """How often something happened over one obstacle; by default in no runs.

    Parameters
    ----------
    rate : float
        [-] Of all runs with a result; NaN without one.
    low, high : float
        [-] 95 % interval of that, with the samples of the unknowns as its clusters: see
        `sweeps.statistics.clustered`; of fewer runs than were planned, see `proportion_of`. Without
        unknowns every repeat counts.
    band_low, band_median, band_high : float
        [-] Of the rates of single samples, each a robot on a floor, 5, 50 and 95 %; without
        unknowns all are the rate.
    runs, samples : int
        Runs with a result, and samples that have some.
    """

    rate: float = math.nan
    low: float = 0.0
    high: float = 1.0
    band_low: float = math.nan
    band_median: float = math.nan
    band_high: float = math.nan
    runs: int = 0
    samples: int = 0


def proportion_of(
    happened: NDArray[np.bool_], counted: NDArray[np.bool_], *, is_stopped: bool = False
) -> Proportion:
    """Count how often something happened.

    Parameters
    ----------
    happened, counted : ndarray of bool, shape (samples, repeats)
        Whether it happened in a run, and whether the run has a result.
    is_stopped : bool
        Whether these results decided that no more runs were made: then the interval is that of
        `sweeps.sequential`, which holds however often one looks.

    Examples
    --------
    Twenty robots in four runs each; five seize in every run, one in half of them:

    >>> happened = np.zeros((20, 4), dtype=bool)
    >>> happened[:5], happened[5, :2] = True, True
    >>> seized = proportion_of(happened, np.ones((20, 4), dtype=bool))
    >>> seized.rate, seized.band_median, seized.band_high
    (0.275, 0.0, 1.0)
    >>> round(seized.low, 3), round(seized.high, 3)  # about as 5 or 6 robots in 20
    (0.131, 0.488)
    """
    hits, counts = (happened & counted).sum(axis=1), counted.sum(axis=1)
    rates = hits[counts > 0] / counts[counts > 0]
    if not rates.size:
        return Proportion()
    rate, low, high = clustered(hits, counts)
    if is_stopped:
        _, low, high = sequential(int(hits.sum()), int(counts.sum()))
    band_low, band_median, band_high = np.quantile(rates, (0.05, 0.5, 0.95)).tolist()
    return Proportion(
        rate=rate,
        low=low,
        high=high,
        band_low=band_low,
        band_median=band_median,
        band_high=band_high,
        runs=int(counts.sum()),
        samples=int(rates.size),
    )


class ObstacleRuns:
    """The runs of one model over one obstacle; all arrays have the shape (samples, repeats).

    Parameters
    ----------
    table : xarray.Dataset
        The runs of an audit: by `model`, `terrain`, `sample` and `repeat`.
    model, obstacle : str
        Which of them.

    Attributes
    ----------
    ends : ndarray of str
        Their outcomes; "" of runs that were not made.
    cleared, seized, has_result : ndarray of bool
        Whether a run ended so, and whether it has a result.
    speeds : ndarray
        [m/s] How fast each drives, without its scatter.
    """

    def __init__(self, table: xarray.Dataset, model: str, obstacle: str) -> None:
        self._table = table
        labels = {"model": model, "terrain": obstacle}
        self._at = {dim: table.get_index(dim).get_loc(label) for dim, label in labels.items()}
        self.ends, self.speeds = self.column("outcome"), self.column("speed")
        self.cleared: NDArray[np.bool_] = self.ends == Outcome.CLEARED
        self.seized: NDArray[np.bool_] = self.ends == Outcome.SEIZED
        self.has_result: NDArray[np.bool_] = np.isin(self.ends, _RESULTS)

    def __contains__(self, name: str) -> bool:
        """Whether the table has a column."""
        return name in self._table

    def column(self, name: str) -> NDArray[Any]:
        """Return a column of the table."""
        own = self._table.variables[name].isel(self._at, missing_dims="ignore")
        return np.asarray(own.transpose("sample", "repeat").values)

    def proportion(
        self, happened: NDArray[np.bool_], among: NDArray[np.bool_] | None = None
    ) -> Proportion:
        """Count how often something happened in the runs with a result, or in some of them."""
        counted = self.has_result if among is None else self.has_result & among
        return proportion_of(happened, counted, is_stopped=bool((self.ends == "").any()))

    def by_speed(self, happened: NDArray[np.bool_]) -> dict[float, Proportion]:
        """Count how often something happened at each speed [m/s], the slowest first."""
        return {
            speed: self.proportion(happened, self.speeds == speed)
            for speed in np.unique(self.speeds).tolist()
        }

    def least_rate(self, happened: NDArray[np.bool_]) -> float:
        """[-] Return the lower bound of a rate if it happens in no run that was not made yet.

        At all speeds together or at one of them, whichever is higher; with one repeat each.
        """
        among = [np.ones_like(happened), *(self.speeds == v for v in np.unique(self.speeds))]
        return max(wilson(int((happened & own).sum()), int(own.sum())).low for own in among)


@dataclass(frozen=True, slots=True, kw_only=True)
class TrialCount:
    """What a trial came to, over all seized runs.

    Parameters
    ----------
    trial : str
        As in `Run.trials`.
    freed, made : int
        How many runs it freed, of how many.
    """

    trial: str
    freed: int
    made: int


@dataclass(frozen=True, slots=True, kw_only=True)
class Verdict:
    """What the runs over one obstacle say.

    Parameters
    ----------
    obstacle : str
        Its label.
    result : {"seizes", "belt fails, too", "does not seize", "not certain"}
        By the rule in ``docs/conventions.md``, "Audit".
    cleared, seized : Proportion
        Of the model's runs.
    belt_cleared, belt_seized : Proportion
        Of those of the same robot on belts, which do not drive where the robot clears 95 % or more
        and never seizes.
    outcome, belt_outcome : str
        How most runs ended; "" without any.
    where : str
        Between which wheels most seized runs are jammed, such as "8-9"; "" without any.
    carrier : str
        Of these wheels: "chassis", "front flipper", "rear flipper"; "" without any.
    jam_counts : tuple of int, shape (2,)
        Number of seized runs that are jammed between these wheels, and of all seized runs.
    seized_alone_count : int
        Number of seized runs in which the belt, with the same draws, clears.
    seized_alone : Proportion
        How often the model seizes while the belt, with the same draws, clears.
    freed : tuple of TrialCount
        What trials came to in the seized runs.
    friction : tuple of float, shape (2,)
        [-] Between which frictions of the drawn floors the runs seized; NaN without any.
    seized_at : mapping of float to Proportion
        How often it seizes at each speed [m/s].
    """

    obstacle: str
    result: str
    cleared: Proportion
    seized: Proportion
    belt_cleared: Proportion
    belt_seized: Proportion
    outcome: str
    belt_outcome: str
    where: str
    carrier: str
    jam_counts: tuple[int, int]
    seized_alone_count: int
    seized_alone: Proportion
    freed: tuple[TrialCount, ...]
    friction: tuple[float, float]
    seized_at: Mapping[float, Proportion]

    @property
    def clears_less(self) -> bool:
        """Whether it clears less often than the belt for certain: their intervals are apart."""
        return self.cleared.high < self.belt_cleared.low


def verdict_of(table: xarray.Dataset, obstacle: str) -> Verdict:
    """Judge an obstacle of a table with the models "model" and "belt"."""
    own, belt = (ObstacleRuns(table, model, obstacle) for model in (OWN, BELT))
    cleared, seized, seized_at = (
        own.proportion(own.cleared),
        own.proportion(own.seized),
        own.by_speed(own.seized),
    )
    belt_cleared = belt.proportion(belt.cleared)
    alone = own.seized & belt.cleared
    seized_alone = own.proportion(alone)
    where, carrier, jam_counts = _commonest_jam(own)
    return Verdict(
        obstacle=obstacle,
        result=result_of(
            cleared,
            [seized, *seized_at.values()],
            belt_cleared,
            [seized_alone, *own.by_speed(alone).values()],
        ),
        cleared=cleared,
        seized=seized,
        belt_cleared=belt_cleared,
        belt_seized=belt.proportion(belt.seized),
        outcome=_commonest(own),
        belt_outcome=_commonest(belt),
        where=where,
        carrier=carrier,
        jam_counts=jam_counts,
        seized_alone_count=int(alone.sum()),
        seized_alone=seized_alone,
        freed=tuple(_trial_counts(own)),
        friction=_friction(own),
        seized_at=seized_at,
    )


def result_of(
    cleared: Proportion, seized: Sequence[Proportion], belt: Proportion, alone: Sequence[Proportion]
) -> str:
    """Find the result of a verdict.

    "seizes": the lower bound of the rate of seizing, at all speeds together or at one of them, is
    above 5 %, and the belt clears in 95 % of its runs or more; or, where it clears in fewer, as on
    floors that may be slippery, the lower bound of the rate of seizing while the belt clears with
    the same draws is. "belt fails, too": the belt clears in fewer, and so does the model. "does not
    seize": the upper bound of the rate of seizing is below 10 %. "not certain": anything else.

    Parameters
    ----------
    cleared : Proportion
        How often the model clears.
    seized : sequence of Proportion
        How often it seizes: at all speeds together, then at each.
    belt : Proportion
        How often the belt clears.
    alone : sequence of Proportion
        How often the model seizes while the belt clears, likewise.
    """
    counted = [*alone, *(seized if belt.rate >= CLEARS else ())]
    if any(each.low > SEIZES for each in counted):
        return "seizes"
    if belt.rate < CLEARS and cleared.rate < CLEARS:
        return "belt fails, too"
    return "does not seize" if seized[0].high < _SELDOM else "not certain"


def _commonest(runs: ObstacleRuns) -> str:
    made = runs.ends[runs.ends != ""].tolist()
    return str(Counter(made).most_common(1)[0][0]) if made else ""


def _commonest_jam(runs: ObstacleRuns) -> tuple[str, str, tuple[int, int]]:
    """Find between which wheels of which carrier most seized runs are jammed, and how many."""
    if not runs.seized.any():
        return "", "", (0, 0)
    columns = (runs.column(name)[runs.seized].tolist() for name in ("stop_bodies", "stop_carrier"))
    counts = Counter(zip(*columns, strict=True))
    (pair, carrier), count = counts.most_common(1)[0]
    return str(pair), str(carrier), (count, counts.total())


def _trial_counts(runs: ObstacleRuns) -> Iterator[TrialCount]:
    for trial in _TRIED:
        name = short_name(trial)
        if f"tried_{name}" in runs:  # a quick audit tries less
            made = runs.column(f"tried_{name}") & runs.seized
            freed = runs.column(f"freed_by_{name}") & made
            if made.any():
                yield TrialCount(trial=trial, freed=int(freed.sum()), made=int(made.sum()))


def _friction(runs: ObstacleRuns) -> tuple[float, float]:
    if "unknown_friction" not in runs or not runs.seized.any():
        return math.nan, math.nan
    drawn = runs.column("unknown_friction")[runs.seized]
    return float(drawn.min()), float(drawn.max())


def is_certain(table: xarray.Dataset, verdict: Verdict) -> bool:
    """Whether a verdict on a part of the runs needs no more of them.

    "seizes" needs none, once so many runs have seized while the belt cleared that it is this word
    whatever the others come to: so it is wrong no more often than that of all runs. "belt fails,
    too" stays, once a quarter of the samples is made and none of them seized while the belt
    cleared, if both have failed so often that neither can reach 95 % of all. Repeats of one robot
    may be alike: with them, all runs are made.

    Parameters
    ----------
    table : xarray.Dataset
        With the models "model" and "belt", and the outcome "" of runs that were not made.
    verdict : Verdict
        On what was made.
    """
    if table.sizes["repeat"] > 1:
        return False
    own, belt = (ObstacleRuns(table, model, verdict.obstacle) for model in (OWN, BELT))
    if verdict.result == "belt fails, too":
        is_quarter = (own.ends != "").sum() >= _QUARTER * own.ends.size
        fails = min(int((each.has_result & ~each.cleared).sum()) for each in (own, belt))
        return bool(
            is_quarter
            and verdict.seized_alone_count == 0
            and fails > (1.0 - CLEARS) * own.ends.size
        )
    return verdict.result == "seizes" and own.least_rate(own.seized & belt.cleared) > SEIZES


def least_samples() -> int:
    """Return the fewest samples that can show that a model does not seize: none of them does.

    Examples
    --------
    >>> least_samples()
    35
    """
    return next(n for n in itertools.count(1) if wilson(0, n).high < _SELDOM)
