"""Intervals and tests agree with SciPy's for many random and extreme inputs."""

import math
import random

import numpy as np
import pytest
from scipy import stats  # type: ignore[import-untyped]

from crawler2d import newcombe, newcombe_paired, wilson
from crawler2d.sweeps.statistics import bootstrap_mean, mcnemar
from tests.shared import SOAK

DRAWN = random.Random(0)
CASES = 20_000 if SOAK else 150
CONFIDENCES = (0.5, 0.8, 0.9, 0.95, 0.99, 0.9999)
# Of sums of a dozen floats of the order of 1.
EXACT = 1e-12


def sizes(most: float = 1e6) -> list[int]:
    """Numbers of runs from 1 on, small and large ones equally often."""
    return [1, 2, 3, *(round(most ** DRAWN.random()) for _ in range(CASES))]


def scipys(successes: int, count: int, confidence: float) -> tuple[float, float, float]:
    """Rate and Wilson's bounds, from SciPy."""
    test = stats.binomtest(successes, count)
    bounds = test.proportion_ci(confidence, method="wilson")
    return test.statistic, bounds.low, bounds.high


def test_wilson_is_scipys() -> None:
    for n in sizes():
        confidence = DRAWN.choice(CONFIDENCES)
        for successes in {0, 1, n // 2, n - 1, n, DRAWN.randint(0, n)}:
            expected = scipys(successes, n, confidence)
            assert wilson(successes, n, confidence) == pytest.approx(expected, rel=EXACT, abs=EXACT)


def test_mcnemar_is_scipys_binomial_test_of_the_pairs_that_differ() -> None:
    for n in sizes(1e4):
        for first in {0, 1, n // 2, n - n // 2, n, DRAWN.randint(0, n)}:
            expected = stats.binomtest(first, n, 0.5).pvalue
            # Logarithms of factorials of ten thousand are of the order of 1e5, with 16 digits.
            assert mcnemar(first, n - first) == pytest.approx(expected, rel=1e-10, abs=1e-300)
    assert mcnemar(0, 0) == 1.0


def test_newcombe_adds_the_squares_of_scipys_intervals() -> None:
    for n in sizes():
        m, confidence = DRAWN.choice((n, 1, DRAWN.randint(1, 100))), DRAWN.choice(CONFIDENCES)
        for a, b in ((0, 0), (n, m), (0, m), (n, 0), (DRAWN.randint(0, n), DRAWN.randint(0, m))):
            p, low, high = scipys(a, n, confidence)
            q, other_low, other_high = scipys(b, m, confidence)
            below = math.sqrt((p - low) ** 2 + (other_high - q) ** 2)
            above = math.sqrt((high - p) ** 2 + (q - other_low) ** 2)
            expected = (p - q, p - q - below, p - q + above)
            assert newcombe(a, n, b, m, confidence) == pytest.approx(expected, rel=EXACT, abs=EXACT)


def pairs() -> list[tuple[int, int, int, int]]:
    """Numbers of pairs, some of the four 0."""
    drawn = [tuple(DRAWN.choice((0, 0, 1, DRAWN.randint(1, 60))) for _ in "four") for _ in sizes()]
    ends = [(1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0), (0, 0, 0, 1), (3, 0, 0, 4), (0, 3, 4, 0)]
    return [(a, b, c, d) for a, b, c, d in [*drawn, *ends] if a + b + c + d]


def test_newcombe_of_pairs_takes_their_correlation_off_scipys_intervals() -> None:
    for both, first, second, neither in pairs():
        numbers = (both, first, second, neither)
        ours, theirs = (np.repeat(row, numbers) for row in ([1.0, 1, 0, 0], [1.0, 0, 1, 0]))
        n, confidence = ours.size, DRAWN.choice(CONFIDENCES)
        p, low, high = scipys(int(ours.sum()), n, confidence)
        q, other_low, other_high = scipys(int(theirs.sum()), n, confidence)
        phi = 0.0
        if np.ptp(ours) and np.ptp(theirs):
            phi = stats.pearsonr(ours, theirs).statistic
            excess = both * neither - first * second
            if excess > 0:  # with continuity correction
                phi *= max(excess - n / 2, 0.0) / excess
        a, b, c, d = p - low, other_high - q, high - p, q - other_low
        below = math.sqrt(max(a**2 - 2.0 * phi * a * b + b**2, 0.0))
        above = math.sqrt(max(c**2 - 2.0 * phi * c * d + d**2, 0.0))
        expected = (p - q, p - q - below, p - q + above)
        # The root of a difference that is nearly 0 has half of the digits.
        found = newcombe_paired(*numbers, confidence)
        assert found == pytest.approx(expected, rel=1e-7, abs=1e-7)


@pytest.mark.parametrize("count", [2, 3, 5, 20, 100])
@pytest.mark.parametrize("confidence", [0.5, 0.95, 0.999])
def test_a_bootstrap_is_scipys_of_the_same_resamples(count: int, confidence: float) -> None:
    values = np.random.default_rng(count).lognormal(0.0, 1.0, count) - 1.0
    theirs = stats.bootstrap(
        (values,),
        np.mean,
        n_resamples=2000,
        confidence_level=confidence,
        method="percentile",
        rng=np.random.default_rng(0),
    ).confidence_interval
    expected = (values.mean(), theirs.low, theirs.high)
    assert bootstrap_mean(values, confidence) == pytest.approx(expected, rel=EXACT, abs=EXACT)
