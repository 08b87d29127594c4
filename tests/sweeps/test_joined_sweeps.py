"""Sweeps joined by xarray: equal runs have equal rows, and others are missing."""

from typing import Any

import pytest
import xarray as xr

import crawler2d as c2d
from crawler2d.parameters.scenario import Scenario
from crawler2d.sweeps.rates import rate
from crawler2d.sweeps.sweep import sweep
from tests.shared import ROBOT

BASE = Scenario(ROBOT, c2d.terrains.step(0.03), duration=4.0)
LOW, MIDDLE, HIGH = 0.02, 0.03, 0.2
OUTER: dict[str, Any] = {"join": "outer", "compat": "no_conflicts"}


def over(*heights: float, repeats: int = 2, **options: Any) -> xr.Dataset:
    """Sweep over heights without a progress bar."""
    return sweep(BASE, {"terrain.height": heights}, repeats=repeats, progress=False, **options)


@pytest.fixture(scope="module")
def whole() -> xr.Dataset:
    return over(LOW, MIDDLE, HIGH, repeats=3)


def assert_same_runs(joined: xr.Dataset, whole: xr.Dataset) -> None:
    """Missing runs change the types of integers and booleans, but not their values."""
    xr.testing.assert_equal(joined, whole)
    xr.testing.assert_identical(rate(joined), rate(whole))
    assert joined.attrs == whole.attrs


def test_equal_sweeps_are_equal_in_everything() -> None:
    xr.testing.assert_identical(over(LOW), over(LOW))


def test_more_cells_merge(whole: xr.Dataset) -> None:
    parts = [over(LOW, repeats=3), over(MIDDLE, HIGH, repeats=3)]
    assert_same_runs(xr.merge(parts, **OUTER), whole)
    combined = xr.combine_by_coords(parts)
    assert isinstance(combined, xr.Dataset)
    assert_same_runs(combined, whole)
    assert_same_runs(xr.concat(parts, "height"), whole)
    assert_same_runs(parts[0].combine_first(parts[1]), whole)


def test_cells_that_overlap_merge(whole: xr.Dataset) -> None:
    parts = [over(LOW, MIDDLE, repeats=3), over(MIDDLE, HIGH, repeats=3)]
    assert_same_runs(xr.merge(parts, **OUTER), whole)
    assert_same_runs(parts[0].combine_first(parts[1]), whole)


def test_more_repeats_merge(whole: xr.Dataset) -> None:
    few = over(LOW, MIDDLE, HIGH)
    assert_same_runs(xr.merge([few, whole], **OUTER), whole)
    assert_same_runs(few.combine_first(whole), whole)


def test_cells_of_unequal_repeats_are_counted_by_the_runs_that_were_made(
    whole: xr.Dataset,
) -> None:
    parts = [over(LOW, repeats=1), over(MIDDLE, HIGH, repeats=3)]
    merged, stacked = xr.merge(parts, **OUTER), xr.concat(parts, "height", join="outer")
    for joined in (merged, stacked, parts[0].combine_first(parts[1])):
        found = rate(joined)
        assert found["count"].values.tolist() == [1, 3, 3]
        assert found["rate"].values.tolist() == [1.0, 1.0, 0.0]
        assert found["distinct"].values.tolist() == [1, *rate(whole)["distinct"].values[1:]]
        assert rate(joined, dim=["height", "repeat"])["count"].item() == 7


def test_seeds_are_distinct_in_the_joined_table() -> None:
    seeds = [over(LOW, HIGH), over(LOW, HIGH, seed=2**63)]
    joined = xr.concat(seeds, "repeat")
    assert joined["seed"].isel(height=0).values.tolist() == [0, 0, 2**63, 2**63]
    assert rate(joined)["count"].values.tolist() == [4, 4]
    assert "seed" not in joined.attrs
    assert joined["identity"].isel(height=0).to_series().is_unique


def test_sweeps_of_two_seeds_do_not_merge() -> None:
    with pytest.raises(xr.MergeError, match="conflicting values"):
        xr.merge([over(LOW), over(LOW, seed=1)], **OUTER)


def test_a_column_that_only_one_of_two_sweeps_has_is_kept() -> None:
    plain, tried = over(LOW), over(LOW, trials="auto", wall_time=True)
    merged = xr.merge([plain, tried], **OUTER)
    xr.testing.assert_equal(merged, tried)
