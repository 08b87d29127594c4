"""Confidence intervals of rates and differences, also for few runs and rates of 0 and 1."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from crawler2d.common.arrays import real_number, whole_number
from crawler2d.common.keywords import takes_keywords
from crawler2d.errors import ScenarioError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

__all__ = [
    "Interval",
    "bootstrap_mean",
    "clustered",
    "mcnemar",
    "newcombe",
    "newcombe_paired",
    "read_counts",
    "read_level",
    "wilson",
]

# Bootstrap resamples; with this many, bounds vary by about 2 % of the interval's width.
_RESAMPLES = 2000
_LOG_2 = math.log(2.0)
_MOST = 10**9
"""Largest number of runs, far above any real one."""


class Interval(NamedTuple):
    """An estimate with its confidence interval."""

    rate: float
    low: float
    high: float

    def side(self, threshold: float | None) -> int:
        """Return -1 or 1 if it lies entirely below or above a threshold, else 0."""
        if threshold is None:
            return 0
        return (self.low > threshold) - (self.high < threshold)


@takes_keywords
def wilson(successes: int, count: int, confidence: float = 0.95) -> Interval:
    """Estimate a rate with Wilson's score interval.

    Parameters
    ----------
    successes : int
        Number of successful runs.
    count : int
        Number of all runs.
    confidence : float
        Confidence level, between 0 and 1.

    Returns
    -------
    Interval
        Rate, lower and upper bound; without runs the rate is NaN and the interval 0 to 1.

    Raises
    ------
    ScenarioError
        If `successes` and `count` are not whole numbers with ``0 <= successes <= count``, or
        `confidence` is not between 0 and 1.

    References
    ----------
    Wilson, E. B. (1927). Probable inference, the law of succession, and statistical inference.
    Journal of the American Statistical Association 22, 209-212.

    Examples
    --------
    >>> rate, low, high = wilson(20, 20)
    >>> round(low, 3), high
    (0.839, 1.0)
    """
    successes, count = read_counts(successes, count)
    z = _normal_quantile(confidence)
    if count == 0:
        return Interval(math.nan, 0.0, 1.0)
    return _score(successes / count, count, z)


def clustered(successes: ArrayLike, counts: ArrayLike, confidence: float = 0.95) -> Interval:
    r"""Estimate a rate from clusters of correlated runs, such as those of one robot on one floor.

    The interval is Wilson's for the effective number of independent runs: the number of runs
    divided by Kish's design effect. For clusters of one run each it is exactly Wilson's interval.
    If all runs agree, the correlation is unknown, and each cluster counts once.

    Parameters
    ----------
    successes, counts : array_like, shape (clusters,)
        Number of successful runs and of all runs, for each cluster. Clusters without runs are
        ignored.
    confidence : float
        Confidence level, between 0 and 1.

    Returns
    -------
    Interval
        Rate of all runs, lower and upper bound; without runs the rate is NaN and the interval 0 to
        1.

    Raises
    ------
    ScenarioError
        If the two differ in shape or violate ``0 <= successes <= counts``, or `confidence` is not
        between 0 and 1.

    Notes
    -----
    Of k clusters with :math:`m_i` runs, N in all, and a correlation :math:`\rho` of the runs within
    a cluster, the variance of the rate is that of N / D independent runs, with
    :math:`D = 1 + (\sum m_i^2 / N - 1) \rho`. It is estimated by an analysis of variance, limited
    to 0 to 1. With few clusters, especially few with the rarer outcome, the estimate is often too
    small; so it is averaged over these e clusters and one more in which all runs agree: :math:`(e
    \hat\rho + 1) / (e + 1)`.

    The ideal is Wilson's interval for N / D with the true :math:`\rho`, which is unknown. In
    simulated audits of 80 samples with 2 repeats, rates of 0.1, 0.5 and 0.9 and correlations of 0,
    0.3 and 0.8, this interval contains the rate in 94 % or more, and is at most 1.05 times as wide
    as the ideal; with 20 samples of 5 repeats in 94 % or more, at most 1.3 times as wide. With 20
    samples of 20 repeats it is up to 1.5 times as wide if the repeats are independent, which so few
    clusters cannot show.

    References
    ----------
    Kish, L. (1965). Survey Sampling. Wiley.

    Donner, A., Klar, N. (1993). Confidence interval construction for effect measures arising from
    cluster randomization trials. Journal of Clinical Epidemiology 46, 123-131.

    Korn, E. L., Graubard, B. I. (1998). Confidence intervals for proportions with small expected
    number of positive counts estimated from survey data. Survey Methodology 24, 193-201.

    Examples
    --------
    If ten of twenty robots seize in every run, four runs of each give no more certainty than one;
    independent runs would:

    >>> rate, low, high = clustered([4] * 10 + [0] * 10, [4] * 20)
    >>> round(low, 3), round(high, 3), round(wilson(10, 20).low, 3)
    (0.299, 0.701, 0.299)
    >>> rate, low, high = clustered([2] * 20, [4] * 20)
    >>> round(low, 3), round(high, 3)
    (0.386, 0.614)
    """
    z = _normal_quantile(confidence)
    hits, runs = (np.asarray(each, dtype=np.float64).ravel() for each in (successes, counts))
    if hits.shape != runs.shape or not ((hits >= 0.0) & (hits <= runs)).all():
        raise ScenarioError("successes", hits, f"must be from 0 to counts = {runs}")
    hits, runs = hits[runs > 0.0], runs[runs > 0.0]
    total = float(runs.sum())
    if total == 0.0:
        return Interval(math.nan, 0.0, 1.0)
    effect = 1.0 + (float((runs**2).sum()) / total - 1.0) * _cluster_correlation(hits, runs)
    return _score(float(hits.sum()) / total, total / effect, z)


@takes_keywords
def newcombe(a: int, n: int, b: int, m: int, confidence: float = 0.95) -> Interval:
    """Estimate the difference between two independent rates, a / n - b / m.

    Newcombe's hybrid score interval, his method 10.

    Parameters
    ----------
    a, b : int
        Successes of the two samples.
    n, m : int
        Sizes of the two samples, at least 1.
    confidence : float
        Confidence level, between 0 and 1.

    Returns
    -------
    Interval
        Difference, lower and upper bound.

    Raises
    ------
    ScenarioError
        If a sample is empty, or an argument is not a number or out of range.

    References
    ----------
    Newcombe, R. G. (1998). Interval estimation for the difference between independent proportions:
    comparison of eleven methods. Statistics in Medicine 17, 873-890.

    Examples
    --------
    >>> difference, low, high = newcombe(56, 70, 48, 80)
    >>> round(low, 4), round(high, 4)
    (0.0524, 0.3339)
    """
    n, m = (whole_number(each, name, 1, _MOST) for each, name in ((n, "n"), (m, "m")))
    a, b = whole_number(a, "a", 0, n), whole_number(b, "b", 0, m)
    first, second = wilson(a, n, confidence), wilson(b, m, confidence)
    difference = first.rate - second.rate
    below = math.hypot(first.rate - first.low, second.high - second.rate)
    above = math.hypot(first.high - first.rate, second.rate - second.low)
    return Interval(difference, difference - below, difference + above)


@takes_keywords
def newcombe_paired(
    both: int, first: int, second: int, neither: int, confidence: float = 0.95
) -> Interval:
    """Estimate the difference between two rates from paired data, first minus second.

    Newcombe's square-and-add interval of the two score intervals, with a continuity-corrected
    correlation, his method 10.

    Parameters
    ----------
    both, neither : int
        Pairs in which both succeeded, and in which neither did.
    first, second : int
        Pairs in which only the first succeeded, and only the second.
    confidence : float
        Confidence level, between 0 and 1.

    Returns
    -------
    Interval
        Difference, lower and upper bound.

    Raises
    ------
    ScenarioError
        If there are no pairs, or an argument is not a number or out of range.

    References
    ----------
    Newcombe, R. G. (1998). Improved confidence intervals for the difference between binomial
    proportions based on paired data. Statistics in Medicine 17, 2635-2650.

    Examples
    --------
    >>> difference, low, high = newcombe_paired(20, 12, 2, 16)
    >>> difference, round(low, 4), round(high, 4)
    (0.2, 0.0562, 0.3292)
    """
    pairs = {"both": both, "first": first, "second": second, "neither": neither}
    both, first, second, neither = (whole_number(n, name, 0, _MOST) for name, n in pairs.items())
    n = both + first + second + neither
    if n == 0:
        raise ScenarioError("neither", neither, "must be at least 1 if there are no other pairs")
    p = wilson(both + first, n, confidence)
    q = wilson(both + second, n, confidence)
    excess = float(both * neither - first * second)
    if excess > 0.0:
        excess = max(excess - 0.5 * n, 0.0)
    spread = math.sqrt(p.rate * (1.0 - p.rate) * q.rate * (1.0 - q.rate))
    phi = excess / (n**2 * spread) if spread > 0.0 else 0.0
    difference = (first - second) / n
    below = _root(p.rate - p.low, q.high - q.rate, phi)
    above = _root(p.high - p.rate, q.rate - q.low, phi)
    return Interval(difference, difference - below, difference + above)


@takes_keywords
def mcnemar(first: int, second: int) -> float:
    """Test whether two rates from paired data are equal: McNemar's test, exact and two-sided.

    Parameters
    ----------
    first, second : int
        Pairs in which only the first succeeded, and only the second.

    Returns
    -------
    float
        The p-value: the probability of counts at least this unequal if the rates are equal.

    Raises
    ------
    ScenarioError
        If they are not whole numbers >= 0.

    Examples
    --------
    >>> mcnemar(0, 5)
    0.0625
    """
    first, second = whole_number(first, "first", 0, _MOST), whole_number(second, "second", 0, _MOST)
    n = first + second
    # Logarithms, because the binomial coefficients of many pairs overflow.
    tail = sum(
        math.exp(math.lgamma(n + 1) - math.lgamma(k + 1) - math.lgamma(n - k + 1) - n * _LOG_2)
        for k in range(min(first, second) + 1)
    )
    return min(1.0, 2.0 * tail)


@takes_keywords
def bootstrap_mean(values: ArrayLike, confidence: float = 0.95) -> Interval:
    """Estimate a mean with a bootstrap percentile interval.

    The resamples have a fixed seed: equal values give equal bounds.

    Parameters
    ----------
    values : array_like, shape (n,)
        Independent values. With fewer than about 20, the interval is somewhat too narrow.
    confidence : float
        Confidence level, between 0 and 1.

    Returns
    -------
    Interval
        Mean, lower and upper bound. With one value the bounds are infinite, as its spread is
        unknown; without values the mean is NaN, too.

    Raises
    ------
    ScenarioError
        If `confidence` is not between 0 and 1.

    Examples
    --------
    >>> mean, low, high = bootstrap_mean([1.0, 2.0, 3.0, 4.0])
    >>> mean, low > 1.0, high < 4.0
    (2.5, True, True)
    """
    tail = 0.5 * (1.0 - read_level(confidence))
    sample = np.asarray(values, dtype=np.float64)
    n = sample.size
    if n < 2:
        mean = float(sample[0]) if n else math.nan
        return Interval(mean, -math.inf, math.inf)
    rng = np.random.default_rng(0)
    means = [sample[rng.integers(n, size=n)].mean() for _ in range(_RESAMPLES)]
    low, high = np.quantile(means, [tail, 1.0 - tail])
    return Interval(float(sample.mean()), float(low), float(high))


def _score(rate: float, count: float, z: float) -> Interval:
    """Compute Wilson's interval of a rate in `count` runs."""
    center = rate + z**2 / (2.0 * count)
    spread = z * math.sqrt(rate * (1.0 - rate) / count + z**2 / (4.0 * count**2))
    scale = 1.0 + z**2 / count
    # At rates of 0 and 1 the bound is exactly the rate, without rounding.
    low = 0.0 if rate == 0.0 else (center - spread) / scale
    high = 1.0 if rate == 1.0 else (center + spread) / scale
    return Interval(rate, low, high)


def _cluster_correlation(hits: NDArray[np.float64], runs: NDArray[np.float64]) -> float:
    """[-] Estimate the correlation of the runs within a cluster; see `clustered`."""
    k, total = runs.size, float(runs.sum())
    rarer = min(np.count_nonzero(hits > 0.0), np.count_nonzero(hits < runs))
    if k in (1, total) or rarer == 0:
        return 1.0
    rates, rate = hits / runs, float(hits.sum()) / total
    between = float((runs * (rates - rate) ** 2).sum()) / (k - 1)
    within = float((runs * rates * (1.0 - rates)).sum()) / (total - k)
    size = (total - float((runs**2).sum()) / total) / (k - 1)
    correlation = max(between - within, 0.0) / (between + (size - 1.0) * within)
    return float((rarer * correlation + 1.0) / (rarer + 1.0))


def _root(a: float, b: float, phi: float) -> float:
    # sqrt(a^2 - 2 phi a b + b^2), written so that rounding cannot make the radicand negative.
    return math.sqrt((a - b) ** 2 + 2.0 * (1.0 - phi) * a * b)


def _normal_quantile(confidence: float) -> float:
    from statistics import NormalDist  # noqa: PLC0415 - slow to import

    # Use the lower tail: the upper one rounds to 1 for confidences just below 1.
    return -NormalDist().inv_cdf(0.5 * (1.0 - read_level(confidence)))


def read_counts(successes: int, count: int) -> tuple[int, int]:
    """Check numbers of successful runs and of all runs."""
    count = whole_number(count, "count", 0, _MOST)
    return whole_number(successes, "successes", 0, count), count


def read_level(confidence: float, name: str = "confidence") -> float:
    """Check a confidence level; `name` is the argument's."""
    level = real_number(confidence, name)
    if not 0.0 < level < 1.0:
        raise ScenarioError(name, confidence, "must be between 0 and 1")
    return level
