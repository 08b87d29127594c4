"""Intervals: published values, an independent implementation where it is there, and the limits."""

import math

import pytest

from crawler2d import newcombe, wilson

# Newcombe (1998), Two-sided confidence intervals for the single proportion, table I, method 3.
PUBLISHED_RATES = [
    (81, 263, 0.2553, 0.3662),
    (15, 148, 0.0624, 0.1605),
    (0, 20, 0.0, 0.1611),
    (1, 29, 0.0061, 0.1718),
]

# Newcombe (1998), Interval estimation for the difference ..., table II, method 10.
PUBLISHED_DIFFERENCES = [
    (56, 70, 48, 80, 0.0524, 0.3339),
    (9, 10, 3, 10, 0.1705, 0.8090),
    (6, 7, 2, 7, 0.0582, 0.8062),
    (5, 56, 0, 29, -0.0381, 0.1926),
    (0, 10, 0, 20, -0.1611, 0.2775),
    (0, 10, 0, 10, -0.2775, 0.2775),
    (10, 10, 0, 20, 0.6791, 1.0),
    (10, 10, 0, 10, 0.6075, 1.0),
]


@pytest.mark.parametrize(("successes", "count", "low", "high"), PUBLISHED_RATES)
def test_wilson_is_as_published(successes: int, count: int, low: float, high: float) -> None:
    rate = wilson(successes, count)
    assert rate.rate == successes / count
    assert (rate.low, rate.high) == pytest.approx((low, high), abs=5e-5)


@pytest.mark.parametrize(("a", "n", "b", "m", "low", "high"), PUBLISHED_DIFFERENCES)
def test_newcombe_is_as_published(a: int, n: int, b: int, m: int, low: float, high: float) -> None:
    difference = newcombe(a, n, b, m)
    assert difference.rate == pytest.approx(a / n - b / m)
    assert (difference.low, difference.high) == pytest.approx((low, high), abs=5e-5)


@pytest.mark.parametrize("confidence", [0.5, 0.9, 0.95, 0.999])
def test_wilson_bounds_solve_the_score_equation(confidence: float) -> None:
    from statistics import NormalDist  # noqa: PLC0415

    z = NormalDist().inv_cdf(0.5 + confidence / 2.0)
    rate, low, high = wilson(7, 20, confidence)
    for bound in (low, high):
        assert abs(rate - bound) == pytest.approx(z * math.sqrt(bound * (1 - bound) / 20))


def test_wilson_ends_exactly_at_0_and_1() -> None:
    assert wilson(0, 20).low == 0.0
    assert wilson(20, 20).high == 1.0


def test_wilson_of_no_runs_knows_nothing() -> None:
    rate, low, high = wilson(0, 0)
    assert math.isnan(rate)
    assert (low, high) == (0.0, 1.0)


def test_newcombe_changes_sign_with_its_samples() -> None:
    there, back = newcombe(9, 20, 4, 15), newcombe(4, 15, 9, 20)
    assert (there.rate, there.low, there.high) == pytest.approx((-back.rate, -back.high, -back.low))


@pytest.mark.parametrize(("successes", "count"), [(-1, 5), (6, 5), (0, -1)])
def test_impossible_counts_are_refused(successes: int, count: int) -> None:
    with pytest.raises(ValueError, match="successes must be from 0"):
        wilson(successes, count)


@pytest.mark.parametrize("confidence", [0.0, 1.0, 95.0, math.nan])
def test_impossible_confidence_is_refused(confidence: float) -> None:
    with pytest.raises(ValueError, match="confidence"):
        wilson(1, 2, confidence)


def test_an_empty_sample_has_no_difference() -> None:
    with pytest.raises(ValueError, match="at least 1"):
        newcombe(0, 0, 1, 2)
