"""Intervals that are valid for any number of checks: exact, over all possible outcomes."""

import dataclasses
import itertools
import math
import pickle
from fractions import Fraction
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from crawler2d import ScenarioError, wilson
from crawler2d.sweeps import sequential as module
from crawler2d.sweeps.sequential import Until, sequential
from tests.shared import SOAK
from tests.sweeps import looks

PAGE = (Path(__file__).parents[2] / "docs/studies/stopping.md").read_text(encoding="utf-8")
# Rates above a half have the same values, by symmetry of successes and failures.
RATES = (0.001, 0.005, *looks.UP_TO_HALF)
CONFIDENCES = (0.01, 0.5, 0.9, 0.95, 0.999, 1.0 - 1e-12)


def martingale(rate: Fraction, runs: tuple[bool, ...]) -> Fraction:
    """The capital of a rate's bets after each bet, from 1: predicted over true probability."""
    product, successes = Fraction(1), 0
    for n, success in enumerate(runs):
        predicted = (successes + Fraction(1, 2) + 5 * rate) / (n + 6)
        product *= predicted / rate if success else (1 - predicted) / (1 - rate)
        successes += success
    return product


def runs_of(successes: int, count: int) -> tuple[bool, ...]:
    return (True,) * successes + (False,) * (count - successes)


# The proof, in exact numbers.


@pytest.mark.parametrize("rate", [Fraction(1, 50), Fraction(1, 3), Fraction(9, 10)])
def test_wealth_is_1_on_average_if_the_rate_is_true(rate: Fraction) -> None:
    for n in range(9):
        mean = Fraction(0)
        for runs in itertools.product((False, True), repeat=n):
            mean += rate ** sum(runs) * (1 - rate) ** (n - sum(runs)) * martingale(rate, runs)
        assert mean == 1


def test_the_wealth_depends_on_counts_and_not_on_the_order_of_runs() -> None:
    for n in range(7):
        for runs in itertools.product((False, True), repeat=n):
            sorted_runs = runs_of(sum(runs), n)
            assert martingale(Fraction(2, 7), runs) == martingale(Fraction(2, 7), sorted_runs)


@pytest.mark.parametrize("confidence", CONFIDENCES)
def test_bounds_are_where_the_wealth_reaches_its_threshold(confidence: float) -> None:
    enough = 1 / (1 - Fraction(confidence))
    for n in (1, 2, 3, 10, 41, 120):
        for k in {0, 1, n // 3, n // 2, n - 1, n}:
            _, low, high = sequential(k, n, confidence)
            for bound, outwards in ((Fraction(low), -1), (Fraction(high), 1)):
                if 0 < bound < 1:
                    # The search ends within 1e-10 in log(p / (1 - p)), bounds are floats.
                    apart = bound * (1 - bound) / 10**8 + Fraction(2**-52)
                    inside = martingale(bound - outwards * apart, runs_of(k, n))
                    beyond = martingale(bound + outwards * apart, runs_of(k, n))
                    assert inside < enough < beyond


def test_the_wealth_is_convex_in_the_rate_and_least_near_the_observed_one() -> None:
    for k, n in ((0, 5), (1, 12), (7, 20), (30, 30)):
        rates = [Fraction(i, 200) for i in range(1, 200)]
        logs = np.array([math.log(martingale(rate, runs_of(k, n))) for rate in rates])
        assert np.diff(logs, 2).min() > 0.0
        assert martingale(Fraction(k, n), runs_of(k, n)) <= 1


# Coverage, over all possible outcomes.


def test_intervals_ever_miss_a_rate_in_fewer_than_5_percent_up_to_500_runs() -> None:
    rates = RATES if SOAK else (*RATES[:2], *RATES[2::2])
    found = [looks.ever_missed(looks.sequentials(), rate) for rate in rates]
    assert max(found) < 0.035  # Ville's inequality allows 0.05, but for ever
    assert min(found[2:]) > 0.015


@pytest.mark.parametrize("estimate", [sequential, wilson])
def test_the_interval_of_failures_mirrors_that_of_successes(estimate: Any) -> None:
    for n in (1, 2, 9, 40, 200, 499):
        for k in range(n + 1):
            rate, low, high = estimate(k, n)
            assert estimate(n - k, n) == pytest.approx((1.0 - rate, 1.0 - high, 1.0 - low))


def test_rates_of_0_and_1_are_never_missed() -> None:
    for rate in (0.0, 1.0):
        assert looks.ever_missed(looks.sequentials(), rate) == 0.0


def test_a_confidence_of_50_percent_is_kept_too() -> None:
    half = looks.Looks.of(partial(sequential, confidence=0.5), most=200)
    found = [looks.ever_missed(half, rate) for rate in (0.02, 0.1, 0.3, 0.5)]
    assert 0.25 < min(found) < max(found) <= 0.5


@pytest.mark.parametrize(
    "until",
    [
        Until(),
        Until(width=0.3),
        Until(threshold=0.5),
        Until(threshold=0.5, min_runs=0),
        Until(threshold=0.95, min_runs=1),
        Until(threshold=0.1, width=0.05, max_runs=500),
    ],
)
def test_the_interval_of_a_cell_that_ends_holds_the_rate_in_95_percent(until: Until) -> None:
    ends = looks.sequentials().stops(until)
    for rate in {*RATES[::4], *(1.0 - rate for rate in RATES[::4]), until.threshold or 0.5}:
        assert looks.endings(rate, ends).sum() == pytest.approx(1.0)
        assert looks.missed_at_the_end(looks.sequentials(), rate, until) < 0.035


def test_wilson_at_repeated_looks_misses_a_rate_in_28_to_43_percent() -> None:
    found = [looks.ever_missed(looks.wilsons(), rate, looks.LEAST) for rate in looks.UP_TO_HALF[1:]]
    assert 0.28 < min(found) < max(found) < 0.43


def test_wilson_with_a_threshold_finds_the_wrong_side_of_a_rate_on_it_in_27_percent() -> None:
    until = Until(threshold=0.5)
    found = looks.missed_at_the_end(looks.wilsons(), 0.5, until)
    assert found == pytest.approx(0.275, abs=0.001)


def test_wilson_at_one_look_misses_as_rarely_as_it_claims() -> None:
    found = []
    for rate in looks.UP_TO_HALF[9:]:
        last = np.zeros((101, 101), dtype=bool)
        last[100] = looks.wilsons().misses(rate)[100, :101]
        found.append(looks.endings(rate, last).sum())
    assert np.mean(found) == pytest.approx(0.05, abs=0.005)


def test_the_exact_computation_agrees_with_all_ways_one_by_one() -> None:
    rate, n = 0.3, 11
    for each in (looks.sequentials(), looks.wilsons()):
        ends = each.misses(0.8)[: n + 1, : n + 1]
        expected = np.zeros(ends.shape)
        for runs in itertools.product((False, True), repeat=n):
            successes = np.cumsum((False, *runs))
            end = next((i for i in range(1, n + 1) if ends[i, successes[i]]), None)
            if end is not None:
                expected[end, successes[end]] += math.prod(rate if r else 1.0 - rate for r in runs)
        assert 0.1 < expected.sum() < 1.0
        assert looks.endings(rate, ends) == pytest.approx(expected, abs=1e-14)


# Properties of intervals.


def test_intervals_contain_the_observed_rate_and_stay_within_0_and_1() -> None:
    for confidence in CONFIDENCES:
        for n in range(1, 40):
            for k in range(n + 1):
                rate, low, high = sequential(k, n, confidence)
                assert rate == k / n
                assert 0.0 <= low <= rate <= high <= 1.0
                assert (low == 0.0) == (k == 0)
                assert (high == 1.0) == (k == n)


def test_failures_count_as_successes_do() -> None:
    each, n = looks.sequentials(), looks.MOST
    for count in range(n + 1):
        low, high = each.low[count, : count + 1], each.high[count, : count + 1]
        assert np.abs(low + high[::-1] - 1.0).max() < 1e-15


def test_a_success_moves_both_bounds_up_and_a_failure_down() -> None:
    each = looks.sequentials()
    for n in range(1, looks.MOST):
        for bound in (each.low, each.high):
            now, then = bound[n, : n + 1], bound[n + 1, : n + 2]
            assert (then[1:] >= now).all()
            assert (then[:-1] <= now).all()
            assert (np.diff(now) > 0.0).all()


def test_twice_as_many_runs_have_a_narrower_interval() -> None:
    widths = looks.sequentials().high - looks.sequentials().low
    for n in range(1, looks.MOST // 2 + 1):
        assert (widths[2 * n, : 2 * n + 1 : 2] < widths[n, : n + 1]).all()
        assert widths[n + 1, : n + 2].max() < widths[n, : n + 1].max()


def test_more_confidence_is_wider() -> None:
    for k, n in ((0, 9), (3, 9), (60, 100)):
        every = [sequential(k, n, confidence) for confidence in CONFIDENCES]
        for less, more in itertools.pairwise(every):
            assert less.high - less.low < more.high - more.low


def test_intervals_are_wider_than_wilsons_and_not_twice_as_wide() -> None:
    ours, theirs = looks.sequentials(), looks.wilsons()
    ratio = (ours.high - ours.low)[20:] / (theirs.high - theirs.low)[20:]
    seen = np.tri(looks.MOST + 1, dtype=bool)[20:]
    assert 1.2 < ratio[seen].min() < ratio[seen].max() < 2.0


@pytest.mark.parametrize("count", [10**4, 10**6, 10**8])
def test_an_interval_of_many_runs_is_computed(count: int) -> None:
    # Logarithms of the beta function are of the order of 1e9 for the most runs, with 16 digits.
    for k in (0, 1, 2, count // 1000, count // 2, count - 1, count):
        rate, low, high = sequential(k, count)
        error = math.sqrt(rate * (1.0 - rate) / count)
        spread = math.sqrt(2.0 * math.log(20.0) + math.log(count / 6.0))
        assert low <= rate <= high
        if 500 < k < count - 500:
            assert (rate - low, high - rate) == pytest.approx(2 * [spread * error], rel=0.1)
        else:
            assert high - low < 50.0 / count


def test_an_interval_takes_few_steps(monkeypatch: pytest.MonkeyPatch) -> None:
    compute, calls = module._log_martingale, [0]

    def counted(logit: float, k: int, m: int) -> float:
        calls[0] += 1
        return compute(logit, k, m)

    monkeypatch.setattr(module, "_log_martingale", counted)
    numbers = [*itertools.product(range(1, 60), repeat=2), (3, 10**5), (10**6, 10**6)]
    for k, m in numbers:
        sequential(k, k + m)
    # Two bounds; each takes three to start with. Half a microsecond a step.
    assert calls[0] / len(numbers) < 14.5


def test_the_interval_of_no_runs_is_from_0_to_1() -> None:
    rate, low, high = sequential(0, 0)
    assert math.isnan(rate)
    assert (low, high) == (0.0, 1.0)


def test_numpy_numbers_give_the_same() -> None:
    found = np.vectorize(sequential)(np.array([0, 3, 8]), np.array([5, 9, 8]))
    expected = zip(sequential(0, 5), sequential(3, 9), sequential(8, 8), strict=True)
    assert [each.tolist() for each in found] == [list(each) for each in expected]
    assert sequential(np.int64(3), np.int64(9), np.float64(0.95)) == sequential(3, 9)  # type: ignore[arg-type]


@pytest.mark.parametrize(("successes", "count"), [(-1, 5), (6, 5), (0, -1)])
def test_impossible_counts_are_refused(successes: int, count: int) -> None:
    name, value = ("count", count) if count < 0 else ("successes", successes)
    message = f"^{name} must be a whole number from 0 to .*, got {value}$"
    for refuse in (sequential, Until().is_done, Until().side):
        with pytest.raises(ScenarioError, match=message):
            refuse(successes, count)


@pytest.mark.parametrize("confidence", [0.0, 1.0, 95.0, math.nan])
def test_impossible_confidence_is_refused(confidence: float) -> None:
    for count in (0, 2):
        message = f"^confidence must be between 0 and 1, got {confidence}$"
        with pytest.raises(ScenarioError, match=message):
            sequential(0, count, confidence)


# When a cell ends.


def test_a_cell_ends_where_its_interval_says() -> None:
    for until in (
        Until(width=0.3, max_runs=60),
        Until(width=0.25, threshold=0.75, min_runs=0, confidence=0.8),
        Until(threshold=0.4, min_runs=70, max_runs=70),
    ):
        found = np.zeros((91, 91), dtype=bool)
        sides = np.zeros((91, 91), dtype=int)
        for n in range(91):
            for k in range(n + 1):
                found[n, k] = until.is_done(k, n)
                sides[n, k] = until.side(k, n)
        each = looks.Looks.of(partial(sequential, confidence=until.confidence), most=90)
        seen = np.tri(91, dtype=bool)
        assert (found == each.stops(until))[seen].all()
        if until.threshold is None:
            assert not sides.any()
        else:
            assert ((sides == 1) == (each.low > until.threshold))[seen].all()
            assert ((sides == -1) == (each.high < until.threshold))[seen].all()
            assert {-1, 0, 1} == set(sides[seen].tolist())


def test_min_runs_and_max_runs_take_precedence() -> None:
    until = Until(threshold=0.5, min_runs=12, max_runs=15)
    assert until.side(11, 11) == 1
    assert not until.is_done(11, 11)
    assert until.is_done(12, 12)
    assert not until.is_done(7, 14)
    assert until.is_done(8, 15)
    assert until.is_done(8, 16)
    assert until.side(8, 15) == 0


def test_an_interval_that_ends_at_the_threshold_is_not_beyond_it() -> None:
    _, low, high = sequential(14, 20)
    assert Until(threshold=low).side(14, 20) == 0
    assert Until(threshold=math.nextafter(low, 0.0)).side(14, 20) == 1
    assert Until(threshold=high).side(14, 20) == 0
    assert Until(threshold=math.nextafter(high, 1.0)).side(14, 20) == -1
    assert Until(width=high - low).is_done(14, 20)
    assert not Until(width=math.nextafter(high - low, 0.0)).is_done(14, 20)


def test_ten_equal_outcomes_decide_the_side_of_one_half() -> None:
    until = Until(threshold=0.5)
    assert [until.side(n, n) for n in (9, 10)] == [0, 1]
    assert [until.side(0, n) for n in (9, 10)] == [0, -1]
    assert until.is_done(10, 10)
    assert until.is_done(0, 10)


def test_every_rate_reaches_the_default_width_within_the_default_most() -> None:
    widths = looks.sequentials().high - looks.sequentials().low
    wide = [n for n in range(1, looks.MOST) if widths[n, : n + 1].max() > Until().width]
    assert max(wide) + 1 == 245 <= Until().max_runs
    assert "at most 245 runs" in PAGE


@pytest.mark.parametrize(
    ("field", "value", "rule"),
    [
        *(("width", value, "must be > 0 and at most 1") for value in (0.0, -0.1, 1.001, math.nan)),
        *(("width", value, "must be a number") for value in ("0.2", None, True)),
        *(("threshold", value, "must be between 0 and 1") for value in (0.0, 1, 50.0, math.nan)),
        ("threshold", "0.5", "must be a number"),
        *(("confidence", value, "must be between 0 and 1") for value in (0.0, 1.0, 95, math.nan)),
        ("confidence", None, "must be a number"),
        *(
            ("min_runs", value, "must be a whole number from 0 to 1000000")
            for value in (-1, 2.5, 10.0, True, None, 10**6 + 1)
        ),
        *(
            ("max_runs", value, "must be a whole number from 10 to 1000000")
            for value in (9, 0, "250", 10**6 + 1)
        ),
    ],
)
def test_an_invalid_stopping_rule_is_refused_at_once(field: str, value: Any, rule: str) -> None:
    with pytest.raises(ScenarioError) as caught:
        Until(**{field: value})
    assert (caught.value.path, caught.value.rule) == (f"until.{field}", rule)
    assert caught.value.value is value or caught.value.value == value or math.isnan(value)


def test_a_list_is_no_number() -> None:
    for field in ("width", "threshold", "min_runs", "max_runs", "confidence"):
        given: Any = {field: np.array([0.5, 0.5])}
        with pytest.raises(ScenarioError, match=f"^until.{field} must be a (whole )?number"):
            Until(**given)


def test_the_ends_of_every_rule_are_allowed() -> None:
    assert Until(width=1.0, min_runs=10**6, max_runs=10**6).is_done(0, 10**6)
    assert Until() == Until(width=0.2, threshold=None, min_runs=10, max_runs=250, confidence=0.95)


def test_at_least_one_run_is_made() -> None:
    with pytest.raises(ScenarioError, match=r"must be a whole number from 1 to 1000000, got 0$"):
        Until(min_runs=0, max_runs=0)
    assert not Until(min_runs=0, max_runs=1, width=0.9).is_done(0, 0)
    assert Until(min_runs=0, max_runs=1, width=0.9).is_done(1, 1)
    assert not Until(min_runs=0, width=1.0).is_done(0, 0)
    assert Until(min_runs=0, width=1.0).is_done(0, 1)


def test_a_rule_is_frozen_equal_to_its_copy_and_made_of_python_numbers() -> None:
    given: Any = (np.float32(0.25), np.float64(0.5), np.int32(5), np.uint64(80), np.array(0.9))
    names = [field.name for field in dataclasses.fields(Until)]
    until = Until(**dict(zip(names, given, strict=True)))
    expected = Until(width=0.25, threshold=0.5, min_runs=5, max_runs=80, confidence=0.9)
    assert until == expected == pickle.loads(pickle.dumps(until))
    assert hash(until) == hash(expected)
    assert repr(until) == repr(expected)
    with pytest.raises(dataclasses.FrozenInstanceError):
        until.width = 0.1  # type: ignore[misc]


# The page.


def test_the_page_has_the_figures_that_are_computed() -> None:
    for rows in (looks.wrong_rows(), looks.cost_rows()):
        assert "\n".join(looks.lines(rows)) in PAGE


def test_the_page_has_the_runs_that_wilson_takes_for_any_rate() -> None:
    widths = looks.wilsons().high - looks.wilsons().low
    wide = [n for n in range(1, looks.MOST) if widths[n, : n + 1].max() > 0.2]
    sentence = f"{max(wide) + 1} runs and Wilson's interval suffice for any rate"
    assert sentence in " ".join(PAGE.split())
    assert wilson(46, 93).high - wilson(46, 93).low <= 0.2
