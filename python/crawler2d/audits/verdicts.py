"""What an audit says of each obstacle, by one written rule, from shares of the runs on it."""

from __future__ import annotations

import itertools
import math
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from crawler2d.audits.runs import TRIED, column
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
    "RESULTS",
    "SEIZES",
    "WORDS",
    "Freed",
    "Share",
    "Verdict",
    "cleared_beside",
    "is_certain",
    "least_samples",
    "seized_at",
    "share_of",
    "surely",
    "verdict_word",
    "verdicts_of",
]


@dataclass(frozen=True, slots=True, kw_only=True)
class Share:
    """How often something happened over one obstacle.

    Parameters
    ----------
    rate : float
        [-] Of all runs with a result; nan without one.
    low, high : float
        [-] 95 % interval of that, with the samples of the unknowns as its clusters: see
        `sweeps.statistics.clustered`; of fewer runs than were planned, see `share_of`. Without
        unknowns every repeat counts.
    band_low, band_median, band_high : float
        [-] Of the rates of single samples, each a robot on a floor, 5, 50 and 95 %; without
        unknowns all are the rate.
    runs, samples : int
        Runs with a result, and samples that have some.
    """

    rate: float
    low: float
    high: float
    band_low: float
    band_median: float
    band_high: float
    runs: int
    samples: int


def share_of(
    happened: NDArray[np.bool_], made: NDArray[np.bool_], *, is_stopped: bool = False
) -> Share:
    """Count how often something happened.

    Parameters
    ----------
    happened, made : ndarray of bool, shape (samples, repeats)
        Whether it happened in a run, and whether the run has a result.
    is_stopped : bool
        Whether what came decided that no more runs were made: then the interval is that of
        `sweeps.sequential`, which holds however often one looks.

    Examples
    --------
    Twenty robots in four runs each; five seize in every run, one in half of them:

    >>> happened = np.zeros((20, 4), dtype=bool)
    >>> happened[:5], happened[5, :2] = True, True
    >>> share = share_of(happened, np.ones((20, 4), dtype=bool))
    >>> share.rate, share.band_median, share.band_high
    (0.275, 0.0, 1.0)
    >>> round(share.low, 3), round(share.high, 3)  # about as 5 or 6 robots in 20
    (0.131, 0.488)
    """
    hits, counts = (happened & made).sum(axis=1), made.sum(axis=1)
    rates = hits[counts > 0] / counts[counts > 0]
    if not rates.size:
        return Share(
            rate=math.nan,
            low=0.0,
            high=1.0,
            band_low=math.nan,
            band_median=math.nan,
            band_high=math.nan,
            runs=0,
            samples=0,
        )
    rate, low, high = clustered(hits, counts)
    if is_stopped:
        _, low, high = sequential(int(hits.sum()), int(counts.sum()))
    band = np.quantile(rates, (0.05, 0.5, 0.95))
    return Share(
        rate=rate,
        low=low,
        high=high,
        band_low=float(band[0]),
        band_median=float(band[1]),
        band_high=float(band[2]),
        runs=int(counts.sum()),
        samples=int(rates.size),
    )


OWN, BELT = "model", "belt"
"""Names of the two in the table."""

WORDS = ("seizes", "belt fails, too", "does not seize", "not certain")
"""The words of a verdict, in the order in which they are asked."""

SEIZES, _SELDOM, CLEARS, _QUARTER = 0.05, 0.10, 0.95, 0.25

RESULTS = tuple(str(each) for each in Outcome)
"""Outcomes of runs that have a result."""

_TRIED = ("closed track", "closed track, clear of the ground", *TRIED)


@dataclass(frozen=True, slots=True, kw_only=True)
class Freed:
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
    word : {"seizes", "belt fails, too", "does not seize", "not certain"}
        By the rule of `verdict_word`.
    cleared, seized : Share
        Of the model's runs.
    belt_cleared, belt_seized : Share
        Of those of the same robot on belts, which do not drive where the robot clears 95 % or more
        and never seizes.
    outcome, belt_outcome : str
        How most runs ended; "" without any.
    where : str
        Between which wheels most seized runs are jammed, such as "8-9"; "" without any.
    carrier : str
        Of these wheels: "chassis", "front flipper", "rear flipper"; "" without any.
    there : tuple of int, shape (2,)
        How many seized runs are jammed there, of how many.
    instead : int
        In how many seized runs the belt, with the same draws, clears.
    seized_alone : Share
        How often the model seizes while the belt, with the same draws, clears.
    freed : tuple of Freed
        What trials came to in the seized runs.
    friction : tuple of float, shape (2,)
        [-] Between which frictions of the drawn floors the runs seized; nan without any.
    seized_at : mapping of float to Share
        How often it seizes at each speed [m/s].
    """

    obstacle: str
    word: str
    cleared: Share
    seized: Share
    belt_cleared: Share
    belt_seized: Share
    outcome: str
    belt_outcome: str
    where: str
    carrier: str
    there: tuple[int, int]
    instead: int
    seized_alone: Share
    freed: tuple[Freed, ...]
    friction: tuple[float, float]
    seized_at: Mapping[float, Share]


def verdict_word(
    cleared: Share, seized: Sequence[Share], belt: Share, alone: Sequence[Share]
) -> str:
    """Judge an obstacle.

    "seizes": the lower bound of the rate of seizing, at all speeds together or at one of them, is
    above 5 %, and the belt clears in 95 % of its runs or more; or, where it clears in fewer, as on
    floors that may be slippery, the lower bound of the rate of seizing while the belt clears with
    the same draws is. "belt fails, too":
    the belt clears in fewer, and so does the model. "does not seize": the upper bound of the rate
    of seizing is below 10 %. "not certain": anything else.

    Parameters
    ----------
    cleared : Share
        How often the model clears.
    seized : sequence of Share
        How often it seizes: at all speeds together, then at each.
    belt : Share
        How often the belt clears.
    alone : sequence of Share
        How often the model seizes while the belt clears, likewise.
    """
    counted = [*alone, *(seized if belt.rate >= CLEARS else ())]
    if any(each.low > SEIZES for each in counted):
        return "seizes"
    if belt.rate < CLEARS and cleared.rate < CLEARS:
        return "belt fails, too"
    return "does not seize" if seized[0].high < _SELDOM else "not certain"


def least_samples() -> int:
    """Return the fewest samples that can show that a model does not seize: none of them does.

    Examples
    --------
    >>> least_samples()
    35
    """
    return next(n for n in itertools.count(1) if wilson(0, n).high < _SELDOM)


def verdicts_of(table: xarray.Dataset, obstacles: Sequence[str]) -> tuple[Verdict, ...]:
    """Judge every obstacle of a table with the models "model" and "belt"."""
    return tuple(_verdict(table, each) for each in obstacles)


def shares(table: xarray.Dataset, model: str, obstacle: str) -> tuple[Share, Share]:
    """Return how often a model clears an obstacle, and how often it seizes there."""
    ends = column(table, "outcome", model=model, terrain=obstacle)
    made, stopped = _has_result(ends), _is_stopped(ends)
    return (
        share_of(ends == Outcome.CLEARED, made, is_stopped=stopped),
        share_of(ends == Outcome.SEIZED, made, is_stopped=stopped),
    )


def seized_at(table: xarray.Dataset, model: str, obstacle: str) -> dict[float, Share]:
    """Return how often a model seizes on an obstacle at each speed [m/s], the slowest first."""
    ends = column(table, "outcome", model=model, terrain=obstacle)
    return _by_speed(table, ends == Outcome.SEIZED, ends)


def _by_speed(
    table: xarray.Dataset,
    happened: np.ndarray[tuple[int, int]],
    ends: np.ndarray[tuple[int, int]],
) -> dict[float, Share]:
    speeds = table["speed"].transpose("sample", "repeat").values
    levels = {speed: speeds == speed for speed in np.unique(speeds).tolist()}
    made, stopped = _has_result(ends), _is_stopped(ends)
    return {
        speed: share_of(happened & own, made & own, is_stopped=stopped)
        for speed, own in levels.items()
    }


def cleared_beside(table: xarray.Dataset, model: str, belt: str, obstacle: str) -> Share:
    """Return how often a model clears an obstacle of the runs in which a belt does so.

    Parameters
    ----------
    table : xarray.Dataset
        With both models, over the same draws.
    model, belt : str
        Their names.
    obstacle : str
        Its label.
    """
    ends, of_belt = (
        column(table, "outcome", model=name, terrain=obstacle) for name in (model, belt)
    )
    both = _has_result(ends) & (of_belt == Outcome.CLEARED)
    return share_of(ends == Outcome.CLEARED, both, is_stopped=_is_stopped(ends))


def is_certain(table: xarray.Dataset, verdict: Verdict) -> bool:
    """Whether a verdict on a part of the runs needs no more of them.

    One on "seizes" does not, once so many runs have seized while the belt cleared that it is this
    word whatever the others come to: so it is wrong no more often than that of all runs. "Belt
    fails, too" stays, once a quarter of the samples is made and none of them seized while the belt
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
    ends, of_belt = (
        column(table, "outcome", model=model, terrain=verdict.obstacle) for model in (OWN, BELT)
    )
    if verdict.word == "belt fails, too":
        is_quarter = (ends != "").sum() >= _QUARTER * ends.size
        fails = min(
            int((_has_result(each) & (each != Outcome.CLEARED)).sum()) for each in (ends, of_belt)
        )
        return bool(is_quarter and verdict.instead == 0 and fails > (1.0 - CLEARS) * ends.size)
    alone = (ends == Outcome.SEIZED) & (of_belt == Outcome.CLEARED)
    return verdict.word == "seizes" and surely(table, alone) > SEIZES


def surely(table: xarray.Dataset, happened: np.ndarray[tuple[int, int]]) -> float:
    """[-] Return the lower bound of a rate if it happens in no run that was not made yet.

    At all speeds together or at one of them, whichever is higher; with one repeat each.
    """
    speeds = table["speed"].transpose("sample", "repeat").values
    among = [np.ones_like(happened), *(speeds == speed for speed in np.unique(speeds))]
    return max(wilson(int((happened & own).sum()), int(own.sum())).low for own in among)


def _is_stopped(ends: np.ndarray[tuple[int, int]]) -> bool:
    return bool((ends == "").any())


def _has_result(ends: np.ndarray[tuple[int, int]]) -> np.ndarray[tuple[int, int]]:
    return np.isin(ends, RESULTS)


def _verdict(table: xarray.Dataset, obstacle: str) -> Verdict:
    cleared, seized = shares(table, OWN, obstacle)
    belt_cleared, belt_seized = shares(table, BELT, obstacle)
    own = {"model": OWN, "terrain": obstacle}
    jammed = column(table, "outcome", **own) == Outcome.SEIZED
    belt_ends = column(table, "outcome", model=BELT, terrain=obstacle)
    where, carrier, there = _where(table, own, jammed)
    instead = jammed & (belt_ends == Outcome.CLEARED)
    ends = column(table, "outcome", **own)
    alone = share_of(instead, _has_result(ends), is_stopped=_is_stopped(ends))
    at, alone_at = seized_at(table, OWN, obstacle), _by_speed(table, instead, ends)
    return Verdict(
        obstacle=obstacle,
        word=verdict_word(
            cleared, [seized, *at.values()], belt_cleared, [alone, *alone_at.values()]
        ),
        cleared=cleared,
        seized=seized,
        belt_cleared=belt_cleared,
        belt_seized=belt_seized,
        outcome=_commonest(ends),
        belt_outcome=_commonest(belt_ends),
        where=where,
        carrier=carrier,
        there=there,
        instead=int(instead.sum()),
        seized_alone=alone,
        freed=_freed(table, own, jammed),
        friction=_friction(table, own, jammed),
        seized_at=at,
    )


def _commonest(ends: np.ndarray[tuple[int, int]]) -> str:
    made = ends[ends != ""].tolist()
    return str(Counter(made).most_common(1)[0][0]) if made else ""


def _where(
    table: xarray.Dataset, own: dict[str, str], jammed: np.ndarray[tuple[int, int]]
) -> tuple[str, str, tuple[int, int]]:
    if not jammed.any():
        return "", "", (0, 0)
    carriers = column(table, "stop_carrier", **own)[jammed].tolist()
    bodies = column(table, "stop_bodies", **own)[jammed].tolist()
    (carrier, pair), count = Counter(zip(carriers, bodies, strict=True)).most_common(1)[0]
    return str(pair), str(carrier), (count, len(bodies))


def _freed(
    table: xarray.Dataset, own: dict[str, str], jammed: np.ndarray[tuple[int, int]]
) -> tuple[Freed, ...]:
    found = []
    for trial in _TRIED:
        name = short_name(trial)
        if f"tried_{name}" not in table:  # a quick audit tries less
            continue
        made = column(table, f"tried_{name}", **own) & jammed
        if made.any():
            freed = column(table, f"freed_by_{name}", **own) & made
            found.append(Freed(trial=trial, freed=int(freed.sum()), made=int(made.sum())))
    return tuple(found)


def _friction(
    table: xarray.Dataset, own: dict[str, str], jammed: np.ndarray[tuple[int, int]]
) -> tuple[float, float]:
    if "unknown_friction" not in table or not jammed.any():
        return math.nan, math.nan
    drawn = column(table, "unknown_friction", **own)[jammed]
    return float(drawn.min()), float(drawn.max())
