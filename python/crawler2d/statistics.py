"""Confidence intervals of rates and their differences, sound for few runs and rates of 0 and 1."""

from __future__ import annotations

import math
from typing import NamedTuple

__all__ = ["Interval", "newcombe", "wilson"]


class Interval(NamedTuple):
    """An estimate with its confidence interval."""

    rate: float
    low: float
    high: float


def wilson(successes: int, count: int, confidence: float = 0.95) -> Interval:
    """Estimate a rate with Wilson's score interval.

    Parameters
    ----------
    successes : int
        Runs that succeeded.
    count : int
        All runs.
    confidence : float
        Of the interval, between 0 and 1.

    Returns
    -------
    Interval
        Rate, lower and upper bound; of no runs the rate is nan and the interval 0 to 1.

    Raises
    ------
    ValueError
        If not ``0 <= successes <= count``, or `confidence` is not between 0 and 1.

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
    if not 0 <= successes <= count:
        raise ValueError(f"successes must be from 0 to count = {count}, got {successes}")
    z = _normal_quantile(confidence)
    if count == 0:
        return Interval(math.nan, 0.0, 1.0)
    rate = successes / count
    center = rate + z**2 / (2.0 * count)
    spread = z * math.sqrt(rate * (1.0 - rate) / count + z**2 / (4.0 * count**2))
    scale = 1.0 + z**2 / count
    # At the ends the bound is the rate itself; rounding would put it beside.
    low = 0.0 if successes == 0 else (center - spread) / scale
    high = 1.0 if successes == count else (center + spread) / scale
    return Interval(rate, low, high)


def newcombe(a: int, n: int, b: int, m: int, confidence: float = 0.95) -> Interval:
    """Estimate the difference of two independent rates, a / n - b / m.

    Newcombe's hybrid of the two score intervals, his method 10.

    Parameters
    ----------
    a, b : int
        Successes of the two samples.
    n, m : int
        Sizes of the two samples, at least 1.
    confidence : float
        Of the interval, between 0 and 1.

    Returns
    -------
    Interval
        Difference, lower and upper bound.

    Raises
    ------
    ValueError
        If a sample is empty, or an argument out of range.

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
    if n < 1 or m < 1:
        raise ValueError(f"n and m must be at least 1, got {n} and {m}")
    first, second = wilson(a, n, confidence), wilson(b, m, confidence)
    difference = first.rate - second.rate
    below = math.hypot(first.rate - first.low, second.high - second.rate)
    above = math.hypot(first.high - first.rate, second.rate - second.low)
    return Interval(difference, difference - below, difference + above)


def _normal_quantile(confidence: float) -> float:
    from statistics import NormalDist  # noqa: PLC0415 - slow to import

    if not 0.0 < confidence < 1.0:
        raise ValueError(f"confidence must be between 0 and 1, got {confidence}")
    return NormalDist().inv_cdf(0.5 + confidence / 2.0)
