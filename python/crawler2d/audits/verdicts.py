"""The verdict on each obstacle, by fixed rules, from the runs over it."""

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
"""Names of both robots in the table."""

SEIZES, _SELDOM, CLEARS, _QUARTER = 0.05, 0.10, 0.95, 0.25

_RESULTS = tuple(str(each) for each in Outcome)
"""Outcomes of runs with a result."""

_TRIED = ("closed track", "closed track, clear of the ground", *TRIED)


@dataclass(frozen=True, slots=True, kw_only=True)
class Proportion:
    """Rate of an event over one obstacle; by default without runs.

    Parameters
    ----------
    rate : float
        [-] Fraction of the runs with a result; NaN without any.
    low, high : float
        [-] 95 % interval of the rate, with samples of the unknowns as clusters: see
        `sweeps.statistics.clustered`; with fewer runs than planned, see `proportion_of`. Without
        unknowns every repeat counts.
    band_low, band_median, band_high : float
        [-] 5, 50 and 95 % quantiles of the rates of single samples, each a robot on a floor; equal
        to the rate without unknowns.
    runs, samples : int
        Number of runs with a result, and of samples with any.
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
    """Return the rate of an event.

    Parameters
    ----------
    happened, counted : ndarray of bool, shape (samples, repeats)
        Whether the event happened in a run, and whether the run has a result.
    is_stopped : bool
        Whether these results ended the runs early: then the interval is that of
        `sweeps.sequential`, which stays valid for repeated checks.

    Examples
    --------
    Twenty robots with four runs each; five seize in every run, one in half of them:

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
        The runs of an audit, by `model`, `terrain`, `sample` and `repeat`.
    model, obstacle : str
        Selected model and obstacle.

    Attributes
    ----------
    ends : ndarray of str
        Outcomes; "" for missing runs.
    cleared, seized, has_result : ndarray of bool
        Whether each run cleared, seized and has a result.
    speeds : ndarray
        [m/s] Speed of each run, without its scatter.
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
        """Return the rate of an event in the runs with a result, or in some of them."""
        counted = self.has_result if among is None else self.has_result & among
        return proportion_of(happened, counted, is_stopped=bool((self.ends == "").any()))

    def by_speed(self, happened: NDArray[np.bool_]) -> dict[float, Proportion]:
        """Return the rate of an event at each speed [m/s], the slowest first."""
        return {
            speed: self.proportion(happened, self.speeds == speed)
            for speed in np.unique(self.speeds).tolist()
        }

    def least_rate(self, happened: NDArray[np.bool_]) -> float:
        """[-] Return the lower bound of a rate if the event happens in none of the missing runs.

        The larger one of those at all speeds together and at each speed; with one repeat each.
        """
        among = [np.ones_like(happened), *(self.speeds == v for v in np.unique(self.speeds))]
        return max(wilson(int((happened & own).sum()), int(own.sum())).low for own in among)


@dataclass(frozen=True, slots=True, kw_only=True)
class TrialCount:
    """Result of a trial over all seized runs.

    Parameters
    ----------
    trial : str
        Name of the trial, see `Run.trials`.
    freed, runs : int
        Number of freed runs, and of runs with this trial.
    """

    trial: str
    freed: int
    runs: int


@dataclass(frozen=True, slots=True, kw_only=True)
class Verdict:
    """Verdict on one obstacle.

    Parameters
    ----------
    obstacle : str
        Its label.
    result : {"seizes", "belt fails, too", "does not seize", "not certain"}
        Result by the rules in ``docs/conventions.md``, "Audit".
    cleared, seized : Proportion
        Rates of the model.
    belt_cleared, belt_seized : Proportion
        Rates of the same robot on belts; no runs where the robot clears 95 % or more and never
        seizes.
    outcome, belt_outcome : str
        Commonest outcome; "" without runs.
    jam_wheels : str
        The wheels between which most seized runs are jammed, such as "8-9"; "" without any.
    carrier : str
        Carrier of these wheels: "chassis", "front flipper", "rear flipper"; "" without any.
    jam_counts : tuple of int, shape (2,)
        Number of seized runs jammed between these wheels, and of all seized runs.
    seized_alone_count : int
        Number of seized runs in which the belt, with the same draws, clears.
    seized_alone : Proportion
        Rate at which the model seizes while the belt, with the same draws, clears.
    freed : tuple of TrialCount
        Results of trials in the seized runs.
    friction : tuple of float, shape (2,)
        [-] Range of the drawn friction in the seized runs; NaN without any.
    seized_at : mapping of float to Proportion
        Rate of seizing at each speed [m/s].
    """

    obstacle: str
    result: str
    cleared: Proportion
    seized: Proportion
    belt_cleared: Proportion
    belt_seized: Proportion
    outcome: str
    belt_outcome: str
    jam_wheels: str
    carrier: str
    jam_counts: tuple[int, int]
    seized_alone_count: int
    seized_alone: Proportion
    freed: tuple[TrialCount, ...]
    friction: tuple[float, float]
    seized_at: Mapping[float, Proportion]

    @property
    def clears_less(self) -> bool:
        """Whether it certainly clears less often than the belt: the intervals do not overlap."""
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
    jam_wheels, carrier, jam_counts = _commonest_jam(own)
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
        jam_wheels=jam_wheels,
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
    above 5 %, and the belt clears in 95 % of its runs or more; or, if the belt clears in fewer,
    such as on slippery floors, the lower bound of the rate of seizing while the belt clears with
    the same draws is above 5 %. "belt fails, too": the belt clears in fewer, and so does the model.
    "does not seize": the upper bound of the rate of seizing is below 10 %. "not certain": anything
    else.

    Parameters
    ----------
    cleared : Proportion
        Rate at which the model clears.
    seized : sequence of Proportion
        Rate at which it seizes: at all speeds together, then at each.
    belt : Proportion
        Rate at which the belt clears.
    alone : sequence of Proportion
        Rate at which the model seizes while the belt clears, likewise.
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
    """Find the wheels and carrier at which most seized runs are jammed, and count them."""
    if not runs.seized.any():
        return "", "", (0, 0)
    columns = (runs.column(name)[runs.seized].tolist() for name in ("stop_bodies", "stop_carrier"))
    counts = Counter(zip(*columns, strict=True))
    (pair, carrier), count = counts.most_common(1)[0]
    return str(pair), str(carrier), (count, counts.total())


def _trial_counts(runs: ObstacleRuns) -> Iterator[TrialCount]:
    for trial in _TRIED:
        name = short_name(trial)
        if f"tried_{name}" in runs:  # a quick audit makes fewer trials
            made = runs.column(f"tried_{name}") & runs.seized
            freed = runs.column(f"freed_by_{name}") & made
            if made.any():
                yield TrialCount(trial=trial, freed=int(freed.sum()), runs=int(made.sum()))


def _friction(runs: ObstacleRuns) -> tuple[float, float]:
    if "unknown_friction" not in runs or not runs.seized.any():
        return math.nan, math.nan
    drawn = runs.column("unknown_friction")[runs.seized]
    return float(drawn.min()), float(drawn.max())


def is_certain(table: xarray.Dataset, verdict: Verdict) -> bool:
    """Whether a verdict on part of the runs needs no more runs.

    "seizes" is final once so many runs have seized while the belt cleared that the remaining runs
    cannot change it; so it is wrong no more often than after all runs. "belt fails, too" is final
    once a quarter of the samples is made, none of them seized while the belt cleared, and both have
    failed so often that neither can reach 95 % of all runs. Repeats of one robot may be equal, so
    with repeats all runs are made.

    Parameters
    ----------
    table : xarray.Dataset
        Runs of the models "model" and "belt"; missing runs have the outcome "".
    verdict : Verdict
        Verdict on the finished runs.
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
    """Return the smallest number of samples that can show that a model does not seize.

    Examples
    --------
    >>> least_samples()
    35
    """
    return next(n for n in itertools.count(1) if wilson(0, n).high < _SELDOM)
