"""Verdicts follow their written rule, on tables made for it."""

from typing import Any

import numpy as np
import pytest
import xarray as xr

import crawler2d as c2d
from crawler2d.audits.candidates import Candidate
from crawler2d.audits.repairs import LEVEL, assess
from crawler2d.audits.verdicts import (
    BELT,
    OWN,
    ObstacleRuns,
    Proportion,
    Verdict,
    proportion_of,
    result_of,
    verdict_of,
)
from crawler2d.audits.words import repair_sentence, worst_rates
from crawler2d.sweeps.statistics import wilson

SAMPLES, REPEATS = 40, 2


def table(own: list[str], belt: list[str], **columns: Any) -> xr.Dataset:
    """One obstacle, with the same ends in both repeats of each sample."""
    ends = np.array([[[[end] * REPEATS for end in ends]] for ends in (own, belt)])
    dims = ("model", "terrain", "sample", "repeat")
    usual: dict[str, Any] = {
        "stop_carrier": "chassis",
        "stop_bodies": "1-2",
        "tried_closed_track": True,
        "freed_by_closed_track": True,
        "tried_closed_track_clear_of_the_ground": False,
        "freed_by_closed_track_clear_of_the_ground": False,
        "tried_torque_x2": True,
        "freed_by_torque_x2": False,
        "tried_friction_x2": True,
        "freed_by_friction_x2": True,
    }
    filled = {name: (dims, np.full(ends.shape, value)) for name, value in usual.items()}
    speeds = (("sample", "repeat"), np.resize([0.04, 0.4], (SAMPLES, REPEATS)))
    coordinates: Any = {"model": [OWN, BELT], "terrain": ["step"], "speed": speeds}
    return xr.Dataset({"outcome": (dims, ends), **filled, **columns}, coordinates)


def ends(**counts: int) -> list[str]:
    found = [name for name, count in counts.items() for _ in range(count)]
    assert len(found) == SAMPLES
    return found


def verdict(own: list[str], belt: list[str]) -> Verdict:
    return verdict_of(table(own, belt), "step")


CLEARED = ["cleared"] * SAMPLES


@pytest.mark.parametrize(("clears", "less"), [(5, True), (28, False)])
def test_it_clears_less_than_the_belt_where_the_intervals_are_apart(
    clears: int, less: bool
) -> None:
    belt = ends(cleared=32, slipping=SAMPLES - 32)
    found = verdict(ends(cleared=clears, slipping=SAMPLES - clears), belt)
    assert found.result == "belt fails, too"
    assert found.clears_less is less


@pytest.mark.parametrize(
    ("seized", "word"),
    [(0, "does not seize"), (1, "not certain"), (4, "not certain"), (5, "seizes")],
)
def test_it_seizes_where_the_lower_bound_is_above_5_percent(seized: int, word: str) -> None:
    assert (wilson(seized, SAMPLES).low > 0.05) is (word == "seizes")
    assert (wilson(seized, SAMPLES).high < 0.10) is (word == "does not seize")
    assert verdict(ends(seized=seized, cleared=SAMPLES - seized), CLEARED).result == word


@pytest.mark.parametrize(("clears", "word"), [(38, "seizes"), (37, "belt fails, too")])
def test_a_belt_that_clears_in_95_percent_need_not_be_paired(clears: int, word: str) -> None:
    """The belt clears three or two of the five that seize."""
    belt = ends(hung_up=SAMPLES - clears, cleared=clears)
    assert verdict(ends(seized=5, hung_up=35), belt).result == word


@pytest.mark.parametrize(("of_belt", "word"), [(5, "seizes"), (4, "belt fails, too")])
def test_if_the_belt_often_fails_only_seized_runs_that_it_clears_count(
    of_belt: int, word: str
) -> None:
    """It seizes on twenty floors; the belt clears on some of these, and stops on all others."""
    assert (wilson(of_belt, SAMPLES).low > 0.05) is (word == "seizes")
    found = verdict(ends(seized=20, slipping=20), ends(cleared=of_belt, slipping=SAMPLES - of_belt))
    assert found.result == word
    assert found.seized_alone.rate == of_belt / SAMPLES


def test_a_repair_is_compared_with_the_belt() -> None:
    """It clears ten of the thirty floors that the belt clears."""
    pair = table(ends(cleared=10, slipping=30), ends(cleared=30, slipping=10))
    own, belt = (ObstacleRuns(pair, model, "step") for model in (OWN, BELT))
    both = own.proportion(own.cleared, among=belt.cleared)
    assert both.rate == pytest.approx(1 / 3)
    assert both.samples == 30


def test_where_the_model_clears_the_belt_may_fail() -> None:
    belt = ends(slipping=SAMPLES)
    assert verdict(CLEARED, belt).result == "does not seize"
    assert verdict(ends(hung_up=SAMPLES), belt).result == "belt fails, too"


def test_a_model_that_hangs_where_the_belt_clears_does_not_seize() -> None:
    found = verdict(ends(hung_up=SAMPLES), CLEARED)
    assert (found.result, found.outcome, found.belt_outcome) == (
        "does not seize",
        "hung_up",
        "cleared",
    )


def test_without_any_result_nothing_is_certain() -> None:
    found = verdict(ends(diverged=SAMPLES), CLEARED)
    assert found.result == "not certain"
    assert (found.seized.runs, found.seized.low, found.seized.high) == (0, 0.0, 1.0)


def test_a_verdict_pairs_seized_runs_with_those_of_the_belt() -> None:
    belt = ends(cleared=30, hung_up=10)
    assert verdict(ends(seized=20, cleared=20), belt).seized_alone_count == 20 * REPEATS
    assert verdict(ends(cleared=20, seized=20), belt).seized_alone_count == 10 * REPEATS


def test_a_verdict_has_the_commonest_jam_and_the_trials() -> None:
    found = verdict(ends(seized=20, cleared=20), CLEARED)
    assert (found.jam_wheels, found.carrier, found.jam_counts) == ("1-2", "chassis", (40, 40))
    freed = {each.trial: (each.freed, each.runs) for each in found.freed}
    assert freed == {
        "closed track": (40, 40),
        "torque x 2": (0, 40),
        "friction x 2": (40, 40),
    }


def test_a_verdict_has_the_frictions_of_seized_runs() -> None:
    dims = ("model", "terrain", "sample", "repeat")
    friction = np.broadcast_to(np.linspace(0.5, 1.0, SAMPLES)[:, None], (2, 1, SAMPLES, REPEATS))
    rows = table(ends(seized=10, cleared=30), CLEARED, unknown_friction=(dims, friction))
    low, high = verdict_of(rows, "step").friction
    assert low == 0.5
    assert high == pytest.approx(0.5 + 0.5 * 9 / 39)


def test_a_verdict_has_the_rate_at_each_speed() -> None:
    found = verdict(ends(seized=20, cleared=20), CLEARED)
    slow, fast = found.seized_at.values()
    assert list(found.seized_at) == [0.04, 0.4]
    assert (slow.runs, fast.runs, slow.rate, fast.rate) == (40, 40, 0.5, 0.5)


@pytest.mark.parametrize(("clears", "word"), [(40, "seizes"), (30, "belt fails, too")])
def test_a_model_that_seizes_at_one_of_the_speeds_seizes(clears: int, word: str) -> None:
    """At one speed 4 of 20 robots seize, of all 40 too few to tell; the belt clears, or fails."""
    own = ends(seized=4, slipping=36)
    rows = table(own, ends(slipping=SAMPLES - clears, cleared=clears))
    slow = np.repeat(np.arange(SAMPLES)[:, None] < 20, REPEATS, axis=1)
    rows = rows.assign_coords(speed=(("sample", "repeat"), np.where(slow, 0.04, 0.4)))
    found = verdict_of(rows, "step")
    assert found.seized.low < 0.05 < found.seized_at[0.04].low
    assert found.result == word


@pytest.mark.parametrize(("slow", "confirmed"), [(1, True), (2, False), (3, False)])
def test_a_repair_that_seizes_in_more_than_5_percent_of_the_runs_is_not_confirmed(
    slow: int, confirmed: bool
) -> None:
    """Of 13 slow runs some seize, of 26 fast ones none: by the lower bound less than 5 % of all."""
    speeds = np.array([0.04] * 13 + [0.4] * 26)[:, None]
    outcomes = np.full((2, 3, 39, 1), "cleared", dtype="<U7")
    outcomes[0, 1, :slow] = "seized"
    dims = ("model", "terrain", "sample", "repeat")
    ones = (dims, np.ones(outcomes.shape))
    fresh = xr.Dataset(
        {"outcome": (dims, outcomes), "time": ones, "wall_time": ones},
        {
            "model": ["five", OWN],
            "terrain": ["step", "gap", LEVEL],
            "speed": (("sample", "repeat"), speeds),
        },
    )
    robot = c2d.robots.engineer(flippers=None, track=c2d.LineOfWheels(5))
    five = Candidate(description="five", kind="wheels", robot=robot, change=1)
    repair = assess(fresh, five, ["step", "gap"], ["step"], OWN)
    assert repair.confirmed is confirmed
    assert repair.seized["gap"].low < 0.05
    assert repair.seized_at["gap"][0.04].rate == slow / 13
    assert worst_rates(repair)[2] == "gap at 0.04 m/s"
    assert ", on gap at 0.04 m/s" in repair_sentence(repair)


def test_without_a_seizure_a_verdict_has_no_place() -> None:
    found = verdict(CLEARED, CLEARED)
    assert (found.jam_wheels, found.carrier, found.jam_counts, found.freed) == ("", "", (0, 0), ())
    assert np.isnan(found.friction).all()


def test_repeats_of_a_sample_count_once() -> None:
    """Ten robots that always seize of twenty are no more certain for being run a hundred times."""
    made = np.ones((20, 100), dtype=bool)
    happened = np.arange(20)[:, None] < 10
    share = proportion_of(np.broadcast_to(happened, made.shape), made)
    assert (share.low, share.high) == wilson(10, 20)[1:]
    assert (share.runs, share.samples, share.rate) == (2000, 20, 0.5)
    assert (share.band_low, share.band_median, share.band_high) == (0.0, 0.5, 1.0)


def test_the_interval_covers_the_rate_when_samples_differ_in_part() -> None:
    """Robots seize with chances of their own: the interval holds the mean in 95 % or more."""
    rng = np.random.default_rng(0)
    inside = 0
    for _ in range(400):
        chances = rng.beta(0.3, 2.0, size=40)  # mean 0.3 / 2.3
        happened = rng.random((40, 2)) < chances[:, None]
        share = proportion_of(happened, np.ones((40, 2), dtype=bool))
        inside += share.low <= 0.3 / 2.3 <= share.high
    assert inside >= 0.95 * 400


def test_runs_without_a_result_are_not_counted() -> None:
    made = np.array([[True, False], [False, False], [True, True]])
    share = proportion_of(np.array([[True, True], [True, True], [False, False]]), made)
    assert (share.runs, share.samples) == (3, 2)
    assert share.rate == pytest.approx(1 / 3)


def test_the_rules_of_a_verdict_are_applied_in_order() -> None:
    def of(rate: float, low: float, high: float) -> Proportion:
        band = {"band_low": 0.0, "band_median": rate, "band_high": 1.0}
        return Proportion(rate=rate, low=low, high=high, runs=80, samples=40, **band)

    often, never = of(0.5, 0.3, 0.7), of(0.0, 0.0, 0.09)
    always = of(1.0, 0.9, 1.0)
    assert result_of(often, [often], always, [often]) == "seizes"
    assert result_of(often, [often], often, [often]) == "seizes"
    assert result_of(often, [often], often, [never]) == "belt fails, too"
    assert result_of(always, [never], often, [never]) == "does not seize"
    assert result_of(often, [of(0.06, 0.02, 0.2)], always, [never]) == "not certain"
