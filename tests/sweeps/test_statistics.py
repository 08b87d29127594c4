"""Intervals: published values, an independent implementation if installed, and limits."""

import math
from statistics import NormalDist
from typing import Any

import numpy as np
import pytest

from crawler2d import newcombe, wilson
from crawler2d.sweeps.statistics import bootstrap_mean, clustered, mcnemar, newcombe_paired
from tests.kept import refusing
from tests.sweeps.small import SAID

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

# Newcombe (1998), Improved confidence intervals for the difference ... paired data, table III,
# method 10.
PUBLISHED_PAIRS = [
    (36, 12, 2, 0, 0.0569, 0.3404),
    (20, 12, 2, 16, 0.0562, 0.3292),
    (18, 12, 2, 18, 0.0562, 0.3290),
    (36, 14, 0, 0, 0.1528, 0.4167),
    (35, 14, 0, 1, 0.1461, 0.4175),
    (18, 14, 0, 18, 0.1441, 0.3963),
    (2, 97, 1, 0, 0.8721, 0.9854),
    (1, 97, 1, 1, 0.8737, 0.9850),  # printed 0.8736; method 8, the same here, has 0.8737
    (0, 29, 1, 0, 0.6666, 0.9882),
    (2, 98, 0, 0, 0.9178, 0.9945),
    (1, 98, 0, 1, 0.9171, 0.9916),
    (0, 30, 0, 0, 0.8395, 1.0),
    (54, 0, 0, 0, -0.0664, 0.0664),
    (53, 0, 0, 1, -0.0729, 0.0729),
    (30, 0, 0, 24, -0.0358, 0.0358),
    (29, 0, 0, 25, -0.0354, 0.0354),
    (28, 0, 0, 26, -0.0352, 0.0352),
    (27, 0, 0, 27, -0.0351, 0.0351),
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
    z = NormalDist().inv_cdf(0.5 + confidence / 2.0)
    rate, low, high = wilson(7, 20, confidence)
    for bound in (low, high):
        assert abs(rate - bound) == pytest.approx(z * math.sqrt(bound * (1 - bound) / 20))


@pytest.mark.parametrize("confidence", [math.nextafter(0.0, 1.0), math.nextafter(1.0, 0.0)])
def test_every_confidence_between_0_and_1_has_an_interval(confidence: float) -> None:
    rate, low, high = wilson(1, 2, confidence)
    assert 0.0 <= low <= rate <= high <= 1.0
    z = 8.29 if confidence > 0.5 else 0.0  # of a tail of 2^-54, as tables have it
    assert high - low == pytest.approx(z / math.sqrt(2.0 + z**2), abs=1e-3)


def test_wilson_ends_exactly_at_0_and_1() -> None:
    assert wilson(0, 20).low == 0.0
    assert wilson(20, 20).high == 1.0


def test_wilson_of_no_runs_is_from_0_to_1() -> None:
    rate, low, high = wilson(0, 0)
    assert math.isnan(rate)
    assert (low, high) == (0.0, 1.0)


def test_newcombe_changes_sign_with_its_samples() -> None:
    there, back = newcombe(9, 20, 4, 15), newcombe(4, 15, 9, 20)
    assert (there.rate, there.low, there.high) == pytest.approx((-back.rate, -back.high, -back.low))


@pytest.mark.parametrize(("successes", "count"), [(-1, 5), (6, 5), (0, -1)])
def test_impossible_counts_are_refused(successes: int, count: int) -> None:
    name, value = ("count", count) if count < 0 else ("successes", successes)
    message = f"^{name} must be a whole number from 0 to .*, got {value}$"
    with refusing(SAID, message):
        wilson(successes, count)


def test_an_empty_sample_has_no_difference() -> None:
    for sizes, name in (((0, 2), "n"), ((2, 0), "m"), ((-1, 2), "n")):
        message = f"^{name} must be a whole number from 1 to .*, got {min(sizes)}$"
        with refusing(SAID, message):
            newcombe(0, sizes[0], 0, sizes[1])


@pytest.mark.parametrize(("both", "first", "second", "neither", "low", "high"), PUBLISHED_PAIRS)
def test_newcombe_paired_is_as_published(
    both: int, first: int, second: int, neither: int, low: float, high: float
) -> None:
    difference = newcombe_paired(both, first, second, neither)
    assert difference.rate == (first - second) / (both + first + second + neither)
    assert (difference.low, difference.high) == pytest.approx((low, high), abs=5e-5)


def test_newcombe_paired_holds_the_difference_and_stays_within_its_range() -> None:
    n = 12
    for both in range(n + 1):
        for first in range(n + 1 - both):
            for second in range(n + 1 - both - first):
                rate, low, high = newcombe_paired(both, first, second, n - both - first - second)
                assert -1.0 - 1e-12 <= low <= rate <= high <= 1.0 + 1e-12
                assert low < high  # even where no pair differs


def test_newcombe_paired_changes_sign_with_its_order() -> None:
    there, back = newcombe_paired(5, 9, 4, 2), newcombe_paired(5, 4, 9, 2)
    assert (there.rate, there.low, there.high) == pytest.approx((-back.rate, -back.high, -back.low))


def test_pairs_that_agree_narrow_the_interval_and_those_that_do_not_widen_it() -> None:
    independent = newcombe(10, 20, 10, 20)
    alike, opposed = newcombe_paired(9, 1, 1, 9), newcombe_paired(1, 9, 9, 1)
    assert alike.high < 0.7 * independent.high
    assert opposed.high > 1.2 * independent.high


@pytest.mark.parametrize(
    "shares",
    [(0.5, 0.2, 0.1, 0.2), (0.3, 0.1, 0.1, 0.5), (0.75, 0.15, 0.02, 0.08), (0.1, 0.5, 0.3, 0.1)],
)
def test_newcombe_paired_covers_the_true_difference_as_often_as_it_claims(
    shares: tuple[float, ...],
) -> None:
    tables, counts = np.unique(
        np.random.default_rng(0).multinomial(20, shares, size=20_000), axis=0, return_counts=True
    )
    covered = 0
    for table, count in zip(tables.tolist(), counts.tolist(), strict=True):
        _, low, high = newcombe_paired(*table)
        covered += count * (low <= shares[1] - shares[2] <= high)
    # With 20 pairs few tables are likely: the coverage jumps, a little above its claim.
    assert 0.935 < covered / 20_000 < 0.985


def drawn_clusters(count: int, size: int, rate: float, alike: float) -> np.ndarray:
    """Successes of 2,000 audits, shape (2000, count): the chances of clusters are beta."""
    rng = np.random.default_rng([count, size, round(10 * rate), round(10 * alike)])
    chances = np.full((2000, count), rate)
    if alike > 0.0:
        scale = 1.0 / alike - 1.0
        chances = rng.beta(rate * scale, (1.0 - rate) * scale, chances.shape)
    return rng.binomial(size, chances)


@pytest.mark.parametrize(("count", "size"), [(80, 2), (40, 2), (20, 5)])
@pytest.mark.parametrize("rate", [0.1, 0.5, 0.9])
@pytest.mark.parametrize("alike", [0.0, 0.3, 0.8])
def test_the_interval_of_an_audit_covers_the_rate_and_is_nearly_as_narrow_as_the_ideal(
    count: int, size: int, rate: float, alike: float
) -> None:
    audits = drawn_clusters(count, size, rate, alike)
    found = [clustered(audit, np.full(count, size)) for audit in audits]
    covered = np.mean([low <= rate <= high for _, low, high in found])
    assert covered >= 0.93
    # The ideal knows the correlation, and so the equivalent number of independent runs.
    worth = count * size / (1.0 + (size - 1.0) * alike)
    shares = audits.sum(axis=1) / (count * size)
    z = NormalDist().inv_cdf(0.975)
    half = z * np.sqrt(shares * (1.0 - shares) / worth + z**2 / (4.0 * worth**2))
    ideal = 2.0 * half / (1.0 + z**2 / worth)
    assert np.mean([high - low for _, low, high in found]) <= 1.3 * ideal.mean()


def test_intervals_of_unequal_clusters_cover_the_rate() -> None:
    """For example if the belt clears only some of the repeats."""
    rng = np.random.default_rng(0)
    covered = 0
    for _ in range(2000):
        sizes = rng.integers(0, 4, 60)
        found = clustered(rng.binomial(sizes, rng.beta(0.3, 2.7, 60)), sizes)
        covered += found.low <= 0.1 <= found.high
    assert covered >= 0.93 * 2000


def test_clusters_of_one_run_have_wilsons_interval() -> None:
    for hits in (0, 1, 7, 20):
        ones = [1] * hits + [0] * (20 - hits)
        assert clustered(ones, [1] * 20, 0.9) == wilson(hits, 20, 0.9)


def test_where_all_runs_agree_each_cluster_counts_once() -> None:
    assert clustered([0] * 12, [5] * 12) == wilson(0, 12)
    assert clustered([5] * 12, [5] * 12) == wilson(12, 12)
    assert clustered([5, 0, 5], [5, 0, 5]) == wilson(2, 2)  # a cluster without runs adds nothing
    assert clustered([7], [10])[1:] == pytest.approx(
        [0.7 + side for side in scored(0.7, 1.0)], abs=1e-12
    )
    assert clustered([], [])[1:] == clustered([0], [0])[1:] == (0.0, 1.0)


def scored(rate: float, count: float) -> tuple[float, float]:
    """The roots of the score equation about a rate."""
    z = NormalDist().inv_cdf(0.975)
    roots = np.roots([1.0 + z**2 / count, -(2.0 * rate + z**2 / count), rate**2])
    return roots.min() - rate, roots.max() - rate


def test_the_correlation_within_clusters_is_that_of_an_analysis_of_variance() -> None:
    """Snedecor and Cochran's moments by hand: 4 clusters of 1 to 4 runs."""
    hits, runs = np.array([1, 2, 0, 1]), np.array([1, 2, 3, 4])
    each = [[1.0] * h + [0.0] * (n - h) for h, n in zip(hits, runs, strict=True)]
    mean = np.concatenate(each).mean()
    between = sum(n * (np.mean(x) - mean) ** 2 for n, x in zip(runs, each, strict=True)) / 3
    within = sum(((np.array(x) - np.mean(x)) ** 2).sum() for x in each) / 6
    size = (10 - 30 / 10) / 3
    found = (between - within) / (between + (size - 1) * within)
    alike = (2 * found + 1) / 3  # two clusters hold a failure, three a success
    worth = 10 / (1 + (30 / 10 - 1) * alike)
    low, high = scored(0.4, worth)
    assert clustered(hits, runs)[1:] == pytest.approx((0.4 + low, 0.4 + high))


@pytest.mark.parametrize(("hits", "runs"), [([3], [2]), ([-1], [2]), ([1, 1], [2])])
def test_clusters_out_of_range_are_refused(hits: list[int], runs: list[int]) -> None:
    with refusing(SAID, "successes must be from 0 to counts"):
        clustered(hits, runs)


def test_newcombe_paired_of_a_million_pairs_does_not_overflow() -> None:
    pairs = np.array([500_000, 100_000, 100_000, 300_000])
    difference = newcombe_paired(*pairs.tolist())
    assert difference.high == pytest.approx(1.96 * math.sqrt(0.2 / 1e6), rel=1e-3)
    assert newcombe_paired(*pairs) == difference


def test_no_pairs_are_refused() -> None:
    with refusing(SAID, "^neither must be at least 1 if there are no other pairs, got 0$"):
        newcombe_paired(0, 0, 0, 0)


# Two-sided binomial tails, by hand.
@pytest.mark.parametrize(
    ("first", "second", "p"),
    [(0, 0, 1.0), (3, 3, 1.0), (0, 1, 1.0), (0, 5, 2 / 32), (1, 7, 18 / 256), (2, 12, 212 / 16384)],
)
def test_mcnemar_is_the_exact_binomial_test(first: int, second: int, p: float) -> None:
    assert mcnemar(first, second) == pytest.approx(p, rel=1e-12)
    assert mcnemar(second, first) == mcnemar(first, second)


def test_mcnemar_of_many_pairs_is_the_normal_test() -> None:
    z = (1000 - 1) / math.sqrt(200_000)  # with continuity correction
    assert mcnemar(99_500, 100_500) == pytest.approx(2 * NormalDist().cdf(-z), rel=1e-3)


def test_mcnemar_refuses_a_negative_number() -> None:
    with refusing(SAID, r"^first must be a whole number .*, got -1$"):
        mcnemar(-1, 3)
    with refusing(SAID, r"^second must be a whole number .*, got -1$"):
        mcnemar(3, -1)


@pytest.mark.parametrize("odd", ["4", 1.5, None, True, [1], 10**400])
def test_invalid_numbers_of_runs_are_refused_by_name(odd: Any) -> None:
    calls: list[tuple[Any, tuple[Any, ...], str]] = [
        (wilson, (odd, 5), "successes"),
        (wilson, (1, odd), "count"),
        (newcombe, (1, 2, odd, 3), "b"),
    ]
    for of, given, name in calls:
        with refusing(SAID, rf"^{name} must be a whole number"):
            of(*given)
    with refusing(SAID, r"^confidence must be"):
        wilson(1, 2, odd)


def test_a_bootstrap_is_the_normal_interval_of_many_values() -> None:
    values = np.random.default_rng(1).normal(3.0, 2.0, 400)
    mean, low, high = bootstrap_mean(values)
    error = values.std() / 20.0
    assert mean == pytest.approx(values.mean())
    # 2000 resamples tell the bounds to about a tenth of the standard error.
    assert (low, high) == pytest.approx(
        (mean - 1.96 * error, mean + 1.96 * error), abs=0.15 * error
    )
    assert bootstrap_mean(values, 0.95) == (mean, low, high)
    narrow = bootstrap_mean(values, confidence=0.5)
    assert high - low == pytest.approx((narrow.high - narrow.low) * 1.96 / 0.674, rel=0.1)


def test_a_bootstrap_covers_the_true_mean_nearly_as_often_as_it_claims() -> None:
    samples = np.random.default_rng(2).normal(0.0, 1.0, (80, 20))
    covered = np.mean([low <= 0.0 <= high for _, low, high in map(bootstrap_mean, samples)])
    assert covered > 0.84  # 0.93 expected for 20 values, three standard errors of 0.03


def test_too_few_values_have_no_interval() -> None:
    assert bootstrap_mean([2.5]) == (2.5, -math.inf, math.inf)
    mean, low, high = bootstrap_mean([])
    assert math.isnan(mean)
    assert (low, high) == (-math.inf, math.inf)


def test_equal_values_have_an_interval_of_no_width() -> None:
    assert bootstrap_mean([0.25] * 4) == (0.25, 0.25, 0.25)


@pytest.mark.parametrize("confidence", [0.0, 1.0, 95.0, math.nan])
def test_every_interval_refuses_an_impossible_confidence(confidence: float) -> None:
    message = f"^confidence must be between 0 and 1, got {confidence}$"
    with refusing(SAID, message):
        wilson(1, 2, confidence)
    with refusing(SAID, message):
        newcombe_paired(1, 2, 3, 4, confidence)
    with refusing(SAID, message):
        bootstrap_mean([1.0, 2.0], confidence)


@pytest.mark.parametrize("name", ["both", "first", "second", "neither"])
def test_each_kind_of_pair_is_refused_by_its_name(name: str) -> None:
    pairs = {"both": 1, "first": 2, "second": 3, "neither": 4, name: -1}
    with refusing(SAID, f"^{name} must be a whole number from 0 to .*, got -1$"):
        newcombe_paired(**pairs)
