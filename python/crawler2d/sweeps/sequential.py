"""Confidence intervals of a rate that stay valid when checked repeatedly, and a stopping rule."""

from __future__ import annotations

import math
from dataclasses import dataclass
from math import exp, lgamma, log, log1p

from crawler2d.common.arrays import real_number, whole_number
from crawler2d.common.keywords import TakesKeywords, takes_keywords
from crawler2d.errors import ScenarioError
from crawler2d.sweeps.statistics import Interval, read_counts, read_level

__all__ = ["Until", "sequential"]

# Prior for a rate p, as a beta distribution: 1/2 + 5 p successes and 1/2 + 5 (1 - p) failures. The
# 5 runs like p narrow intervals of 50 to 300 runs, the two halves those of rates near 0 and 1. Any
# two positive numbers are valid.
_LIKE_P = 5.0
_EITHER = 0.5
_PRIOR = _LIKE_P + 2.0 * _EITHER
_LGAMMA_PRIOR = lgamma(_PRIOR)

# Largest number of runs of a cell, as in a sweep.
_MOST = 10**6


@takes_keywords
def sequential(successes: int, count: int, confidence: float = 0.95) -> Interval:
    r"""Estimate a rate with a confidence sequence, which may be checked after every run.

    For any rate, the probability that the interval misses it after *any* number of runs is at most
    1 - `confidence`. So you may check after every run, and stop as soon as the interval is narrow
    enough. An interval for a number of runs fixed in advance, such as `wilson`, is narrower, but
    does not allow that.

    Parameters
    ----------
    successes : int
        Number of successful runs.
    count : int
        Number of all runs so far.
    confidence : float
        Confidence level, between 0 and 1.

    Returns
    -------
    Interval
        Rate, lower and upper bound; without runs the rate is NaN and the interval 0 to 1. It
        depends only on these numbers, not on earlier checks.

    Raises
    ------
    ScenarioError
        If `successes` and `count` are not whole numbers with ``0 <= successes <= count``, or
        `confidence` is not between 0 and 1.

    Notes
    -----
    For each rate p, a bettor predicts every run: after k successes in n runs, a success with
    probability (k + 1/2 + 5 p) / (n + 6). If p is true, the product M of the predicted
    probabilities of the actual outcomes, each divided by its true probability, is a martingale of
    mean 1. By Ville's inequality it ever reaches 1 / (1 - confidence) with a probability of at most
    1 - confidence. The interval contains all p for which M is smaller. In closed form, with a = 1/2
    + 5 p, b = 1/2 + 5 (1 - p) and the beta function B,

    .. math:: M = B(a + k, b + n - k) / (B(a, b) p^k (1 - p)^{n - k})

    Its logarithm is convex in p, because log(a + i) - log(p) is, and so is log(b + i) - log(1 - p),
    for every i >= 0; and at k / n it is at most 0, because no mixture of rates makes outcomes more
    likely than k / n does. So the set is an interval that contains k / n.

    References
    ----------
    Ville, J. (1939). Etude critique de la notion de collectif. Gauthier-Villars.

    Robbins, H. (1970). Statistical methods related to the law of the iterated logarithm.
    Annals of Mathematical Statistics 41, 1397-1409.

    Howard, S. R., Ramdas, A., McAuliffe, J., Sekhon, J. (2021). Time-uniform, nonparametric,
    nonasymptotic confidence sequences. Annals of Statistics 49, 1055-1080.

    Examples
    --------
    >>> rate, low, high = sequential(20, 20)
    >>> round(low, 3), high
    (0.74, 1.0)
    """
    successes, count = read_counts(successes, count)
    confidence = read_level(confidence)
    if count == 0:
        return Interval(math.nan, 0.0, 1.0)
    failures = count - successes
    limit = -log1p(-confidence)
    low = 0.0 if successes == 0 else _low(successes, failures, limit)
    high = 1.0 if failures == 0 else 1.0 - _low(failures, successes, limit)
    return Interval(successes / count, low, high)


@dataclass(frozen=True, slots=True, kw_only=True)
class Until(TakesKeywords):
    """Stopping rule: simulate a cell until its rate, or its side of a threshold, is known.

    Uses the interval of `sequential`, so it may be checked after any number of runs.

    Parameters
    ----------
    width : float
        Stop when the interval is at most this wide; above 0, up to 1. The default needs at most 245
        runs.
    threshold : float, optional
        Also stop when the interval lies entirely above or below this rate, between 0 and 1.
    min_runs, max_runs : int
        Smallest number of runs, 0 or more; largest number, at least `min_runs` and 1.
    confidence : float
        Confidence level of the interval, between 0 and 1.

    Raises
    ------
    ScenarioError
        If a field breaks its rule.

    Examples
    --------
    >>> until = Until(threshold=0.5)
    >>> until.is_done(10, 15), until.is_done(14, 15)
    (False, True)
    >>> until.side(10, 15), until.side(14, 15)
    (0, 1)
    """

    width: float = 0.2
    threshold: float | None = None
    min_runs: int = 10
    max_runs: int = 250
    confidence: float = 0.95

    def __post_init__(self) -> None:
        """Check the fields."""
        for name in ("width", "threshold", "confidence"):
            value = getattr(self, name)
            if value is None and name == "threshold":
                continue
            number = real_number(value, f"until.{name}")
            object.__setattr__(self, name, number)
            if not 0.0 < number < 1.0 and not (name == "width" and number == 1.0):
                rule = "> 0 and at most 1" if name == "width" else "between 0 and 1"
                raise ScenarioError(f"until.{name}", number, f"must be {rule}")
        for name in ("min_runs", "max_runs"):
            lowest = 0 if name == "min_runs" else max(self.min_runs, 1)
            count = whole_number(getattr(self, name), f"until.{name}", lowest, _MOST)
            object.__setattr__(self, name, count)

    @takes_keywords
    def is_done(self, successes: int, count: int) -> bool:
        """Whether the rule is met, or `max_runs` is reached.

        Parameters
        ----------
        successes, count : int
            Number of successful runs, and of all runs so far.

        Raises
        ------
        ScenarioError
            If not ``0 <= successes <= count``.
        """
        interval = sequential(successes, count, self.confidence)
        if count < max(self.min_runs, 1) or count >= self.max_runs:  # nothing is known without runs
            return count >= self.max_runs
        return interval.high - interval.low <= self.width or interval.side(self.threshold) != 0

    @takes_keywords
    def side(self, successes: int, count: int) -> int:
        """Return the side of the threshold on which the rate lies, if certain.

        Parameters
        ----------
        successes, count : int
            Number of successful runs, and of all runs so far.

        Returns
        -------
        int
            -1 below the threshold, 1 above it, 0 if uncertain or without a threshold.

        Raises
        ------
        ScenarioError
            If not ``0 <= successes <= count``.
        """
        return sequential(successes, count, self.confidence).side(self.threshold)


def _low(k: int, m: int, limit: float) -> float:
    """Find the rate below k / (k + m), for k > 0 successes and m failures, with log M = `limit`."""
    n = k + m
    start = (k + _EITHER) / (n + 1)
    # Initial guess from a normal distribution, in log(p / (1 - p)).
    spread = math.sqrt((2.0 * limit + log1p(n / _PRIOR)) / (n * start * (1.0 - start)))
    center = log(start / (1.0 - start))
    left = center - 1.1 * spread
    excess = _log_martingale(left, k, m) - limit
    while excess < 0.0:
        left -= spread
        excess = _log_martingale(left, k, m) - limit
    # Log M is convex in log(p / (1 - p)), too: the secant through two points left of the root gives
    # a point between them and the root, and converges superlinearly. The result is never beyond the
    # root by more than rounding.
    previous, left_of = left - 0.1 * spread, left
    previous_excess = _log_martingale(previous, k, m) - limit
    while excess > 0.0 and previous_excess > excess:
        step = excess * (left_of - previous) / (previous_excess - excess)
        previous, previous_excess = left_of, excess
        left_of += step
        if step < 1e-10:
            break
        excess = _log_martingale(left_of, k, m) - limit
    return 1.0 / (1.0 + exp(-left_of))


def _log_martingale(logit: float, k: int, m: int) -> float:
    """Compute log M for a rate given as log(p / (1 - p)), with k successes and m failures."""
    odds_against = exp(-logit)
    n = k + m
    a = _EITHER + _LIKE_P / (1.0 + odds_against)
    b = _PRIOR - a
    mixture = lgamma(a + k) - lgamma(a) + lgamma(b + m) - lgamma(b) - lgamma(n + _PRIOR)
    return mixture + _LGAMMA_PRIOR + n * log1p(odds_against) + m * logit
