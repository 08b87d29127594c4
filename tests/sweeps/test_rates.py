"""Rates of outcomes: counted over a dimension, or of a plain list."""

import sys
from typing import Any

import numpy as np
import pytest
import xarray as xr

import crawler2d as c2d
from crawler2d.sweeps.rates import quantile_band, rate
from tests.kept import refusing
from tests.sweeps.small import SAID

TABLE = xr.Dataset(
    {
        "outcome": (
            ("height", "repeat"),
            [
                ["cleared", "cleared", "seized", "stalled"],
                ["tipped_over", "slipping", "diverged", "cleared"],
                ["refused", "refused", "refused", "refused"],
            ],
        )
    },
    coords={"height": ("height", [0.03, 0.1, 9.0], {"units": "m"})},
)


def test_every_cell_has_its_rate_and_wilsons_interval() -> None:
    found = rate(TABLE)
    assert found["count"].values.tolist() == [4, 3, 0]
    for cell, (successes, count) in zip(
        found.transpose("height").to_dataframe().itertuples(), [(2, 4), (1, 3), (0, 0)], strict=True
    ):
        expected = c2d.wilson(successes, count)
        assert (cell.rate, cell.low, cell.high) == pytest.approx(tuple(expected), nan_ok=True)
    assert found["height"].attrs == {"units": "m"}
    assert found.attrs == {
        "figure": "rates",
        "outcome": "cleared",
        "confidence_level": 0.95,
        "interval": "Wilson",
        "varied": "",
        "unknown": "",
    }
    spoken = {"rate": "rate of clearing", "low": "lower bound", "high": "upper bound"}
    for name, long_name in {**spoken, "count": "number of runs"}.items():
        assert found[name].attrs == {"units": "1", "long_name": long_name}


def test_rates_keep_the_scenario_and_the_build_of_their_runs() -> None:
    origin = {"scenario": "{}", "build_version": "0.1.0", "build_build_id": "ab"}
    found = rate(TABLE.assign_attrs(origin, reference="belt"))
    assert {name: found.attrs[name] for name in origin} == origin
    assert "reference" not in found.attrs


def test_any_outcome_can_be_counted() -> None:
    assert rate(TABLE, "seized")["rate"].values[:2].tolist() == [1 / 4, 0.0]
    assert rate(TABLE, c2d.Outcome.TIPPED_OVER)["rate"].sel(height=0.1) == pytest.approx(1 / 3)
    assert rate(TABLE, "cycling")["rate"].values[:2].tolist() == [0.0, 0.0]


def test_all_stops_can_be_counted_together() -> None:
    found = rate(TABLE, "stopped")
    assert found["rate"].values[:2].tolist() == [2 / 4, 1 / 3]
    assert found.attrs["outcome"] == "stopped"
    assert found["rate"].attrs["long_name"] == "rate of stopping"
    names = [outcome for outcome in c2d.Outcome if outcome.is_stop]
    assert rate(names, "stopped")["rate"].item() == 1.0
    assert rate([o for o in c2d.Outcome if not o.is_stop], "stopped")["rate"].item() == 0.0


def test_any_dimension_can_be_counted_over() -> None:
    found = rate(TABLE, dim="height")
    assert found.sizes == {"repeat": 4}
    assert found["count"].values.tolist() == [2, 2, 1, 2]


def test_several_dimensions_can_be_counted_over() -> None:
    found = rate(TABLE, dim=["height", "repeat"])
    assert found.sizes == {}
    assert found["count"].item() == 7
    assert found["rate"].item() == 3 / 7
    assert rate(TABLE, dim=("repeat", "height")).identical(found)
    assert rate(TABLE, dim=iter(["repeat"])).identical(rate(TABLE))
    assert rate(TABLE, dim=["repeat", "repeat"]).identical(rate(TABLE))
    alone = rate(TABLE, dim=[])
    assert alone["count"].equals(TABLE["outcome"].isin([str(o) for o in c2d.Outcome]).astype(int))
    pose = dict.fromkeys(("final_x", "final_y", "final_angle"), xr.zeros_like(alone["count"]))
    assert rate(TABLE.assign(pose), dim=[])["distinct"].equals(alone["count"])


def test_runs_that_share_a_draw_are_one_cluster_of_an_interval() -> None:
    ends = np.array([[["cleared"] * 10, ["seized"] * 10]] * 2)  # by height, sample and repeat
    table = xr.Dataset({"outcome": (("height", "sample", "repeat"), ends)})
    alone = rate(table)  # the repeats of a sample are independent
    assert (alone["low"].values[:, 0] == c2d.wilson(10, 10).low).all()
    both = rate(table, dim=["sample", "repeat"])
    assert both["count"].values.tolist() == [20, 20]
    for cell in (both.isel(height=0), rate(table, dim=["height", "sample", "repeat"])):
        assert (cell["low"].item(), cell["high"].item()) == pytest.approx(c2d.wilson(1, 2)[1:])
    # One draw in several cells counts as one run; runs without draws, such as a list, count.
    heights = rate(table, dim="height").isel(sample=0, repeat=0)
    assert (heights["low"].item(), heights["count"].item()) == (c2d.wilson(1, 1).low, 2)
    assert rate(["cleared"] * 9)["low"].item() == c2d.wilson(9, 9).low


@pytest.mark.parametrize("missing", [np.nan, None, "", "not made"])
def test_runs_that_were_never_made_are_not_counted(missing: Any) -> None:
    table = TABLE.astype(object)
    table["outcome"][0, 2:] = missing
    found = rate(table, "cleared")
    assert found["count"].values.tolist() == [2, 3, 0]
    assert found["rate"].values[:2].tolist() == [1.0, 1 / 3]
    assert rate(table, "stopped")["rate"].values[:2].tolist() == [0.0, 1 / 3]


POSES = {
    "final_x": [[0.0, 0.0004, 0.0006, 1.0], [0.0, 0.0, 0.0, 0.0], [np.nan] * 4],
    "final_y": [[0.0, 0.0, 0.0, 0.0], [0.0, 0.0016, 0.0, 0.0], [np.nan] * 4],
    "final_angle": [[0.0, 0.0, 0.0, 0.0], [0.0, 0.0, 5.0, np.radians(0.06)], [np.nan] * 4],
}


def test_distinct_poses_are_those_of_the_runs_that_are_counted() -> None:
    posed = TABLE.assign({name: (("height", "repeat"), rows) for name, rows in POSES.items()})
    found = rate(posed)["distinct"]
    # In the second cell the run with a different angle diverged; in the third all were refused.
    assert found.values.tolist() == [3, 3, 0]
    assert found.attrs == {"units": "1", "long_name": "number of distinct final poses"}
    assert rate(posed, dim=["repeat", "height"])["distinct"].item() == 5
    assert rate(posed, dim="height")["distinct"].values.tolist() == [1, 2, 1, 2]
    for name in POSES:
        assert "distinct" not in rate(posed.drop_vars(name))
    assert "distinct" not in rate(["cleared"])


@pytest.mark.parametrize(
    ("name", "step"),
    [("final_x", 1e-3), ("final_y", 1e-3), ("final_angle", np.radians(0.1))],
)
def test_poses_are_distinct_in_steps_of_1_mm_and_a_tenth_of_a_degree(
    name: str, step: float
) -> None:
    poses = {"final_x": 0.0, "final_y": 0.0, "final_angle": 0.0}
    # The last two lie on either side of the middle between two steps.
    for places, count in [([99.51, 100.49], 1), ([100.49, 100.51], 2), ([99.49, 99.51], 2)]:
        rows = {key: ("repeat", [0.0, 0.0]) for key in poses}
        rows[name] = ("repeat", [place * step for place in places])
        table = xr.Dataset({"outcome": ("repeat", ["cleared", "seized"]), **rows})
        assert rate(table)["distinct"].item() == count


@pytest.mark.parametrize("name", ["rate", "low", "high", "count"])
def test_a_dimension_called_as_a_result_is_refused_by_name(name: str) -> None:
    table = TABLE.rename(height=name)
    rule = f"table must have no other dimension or coordinate of that name, got {name}: rename it"
    with refusing(SAID, f"^{rule}$"):
        rate(table)
    assert rate(table, dim=name)["count"].dims == ("repeat",)


def test_a_list_of_outcomes_has_a_rate() -> None:
    outcomes = [c2d.Outcome.CLEARED, "seized", None, "cleared"]
    found = rate(outcomes)
    assert found["rate"].item() == pytest.approx(2 / 3)
    assert found["count"].item() == 3
    assert rate(iter(outcomes))["count"].item() == 3


def test_the_error_for_a_list_of_runs_names_table() -> None:
    robot = c2d.robots.engineer(flippers=None)
    runs: Any = c2d.simulate_many([c2d.Scenario(robot, c2d.terrains.flat(), duration=0.1)])
    with refusing(SAID, r"write rate\(table\(runs\), dim=\"run\"\)"):
        rate(runs)
    assert rate(c2d.table(runs), dim="run")["count"].item() == 1


def test_no_outcomes_have_no_rate() -> None:
    found = rate([])
    assert np.isnan(found["rate"].item())
    assert (found["low"].item(), found["high"].item(), found["count"].item()) == (0.0, 1.0, 0)


@pytest.mark.parametrize(
    ("arguments", "path", "hint"),
    [
        ((TABLE, "clear"), "outcome", "did you mean cleared?"),
        ((TABLE, "diverged"), "outcome", "detracked, tipped_over"),
        ((TABLE, None), "outcome", "detracked, tipped_over"),
        ((TABLE, "cleared", "repeats"), "dim", "did you mean repeat?"),
        ((TABLE, "cleared", ["repeat", "hight"]), "dim", "did you mean height?"),
        ((TABLE, "cleared", 3), "dim", "must be one of height, repeat"),
        ((xr.Dataset({"time": 1.0}),), "table", "must have a column outcome"),
        ((TABLE, "stoped"), "outcome", "did you mean stopped?"),
        ((["cleared", "siezed"],), "outcomes[1]", "did you mean seized?"),
        ((["cleared", "stopped"],), "outcomes[1]", "must be one of"),
    ],
)
def test_an_unknown_name_is_refused_with_the_nearest(
    arguments: tuple[Any, ...], path: str, hint: str
) -> None:
    with refusing(SAID) as caught:
        rate(*arguments)
    assert caught.value.path == path
    assert hint in caught.value.rule
    # A hint is the end of the rule, and so is the last of the names where there is none.
    assert caught.value.rule.endswith(
        ("?)", "timed_out, stopped", "timed_out", "repeat", "outcome")
    )


@pytest.mark.parametrize(
    ("columns", "value"), [((), "none"), (("time",), "time"), (("time", "energy"), "time, energy")]
)
def test_a_table_without_outcomes_is_refused_with_its_columns(
    columns: tuple[str, ...], value: str
) -> None:
    with pytest.raises(c2d.ScenarioError) as caught:
        rate(xr.Dataset(dict.fromkeys(columns, 1.0)))
    told = (caught.value.path, caught.value.value, caught.value.rule)
    assert told == ("table", value, "must have a column outcome")


def test_a_data_set_without_its_figure_attribute_has_no_figure() -> None:
    pytest.importorskip("matplotlib")
    bare = rate(TABLE).mean("height", keep_attrs=False)
    with refusing(SAID) as caught:
        bare.plot()
    assert (caught.value.path, caught.value.value) == ("plot", "none")
    assert caught.value.rule.startswith("must be of a data set with a figure: use plot.scatter")


def test_a_missing_xarray_names_its_extra(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "xarray", None)
    with pytest.raises(ImportError, match=r"pip install 'crawler2d\[analysis\]'$"):
        rate(["cleared"])


@pytest.mark.parametrize(
    ("varied", "where"),
    [("", "nothing varied"), ("robot.mass", r"what varied hardly moves the robot \(robot.mass\)")],
)
def test_many_runs_with_few_poses_get_a_warning_with_the_reason(varied: str, where: str) -> None:
    poses = {name: ("repeat", [0.0] * 20) for name in POSES}
    table = xr.Dataset({"outcome": ("repeat", ["cleared"] * 20), **poses}, attrs={"vary": varied})
    with pytest.warns(c2d.ScenarioWarning, match=f"in every cell: where {where}, rates say"):
        rate(table)


def test_a_cell_without_a_result_has_no_band_and_gives_no_warning(
    recwarn: pytest.WarningsRecorder,
) -> None:
    found = rate(TABLE.rename(height="sample").expand_dims(model=2))
    assert found["band_median"].item(0) == pytest.approx(5 / 12)
    nothing = rate(TABLE.rename(height="sample").isel(sample=[2]))
    assert nothing["band_median"].isnull().all()
    assert not recwarn.list


def test_a_band_says_what_its_bounds_are() -> None:
    rates = xr.DataArray(np.linspace(0.0, 1.0, 21), dims="sample")
    band = quantile_band(rates)
    assert {name: round(each.item(), 12) for name, each in band.items()} == {
        "band_low": 0.05,
        "band_median": 0.5,
        "band_high": 0.95,
    }
    assert {name: each.attrs for name, each in band.items()} == {
        "band_low": {"units": "1", "long_name": "5th percentile of the rates over the unknowns"},
        "band_median": {"units": "1", "long_name": "median of the rates over the unknowns"},
        "band_high": {"units": "1", "long_name": "95th percentile of the rates over the unknowns"},
    }
    assert not any("quantile" in each.coords for each in band.values())


@pytest.mark.parametrize(
    ("runs", "distinct", "is_warned"), [(10, 4, True), (10, 5, False), (9, 4, False)]
)
def test_four_distinct_poses_of_ten_runs_are_few(
    runs: int, distinct: int, is_warned: bool, recwarn: pytest.WarningsRecorder
) -> None:
    zeros = {name: ("repeat", [0.0] * runs) for name in POSES}
    zeros["final_x"] = ("repeat", [0.1 * (k % distinct) for k in range(runs)])
    table = xr.Dataset({"outcome": ("repeat", ["cleared"] * runs), **zeros})
    assert rate(table)["distinct"].item() == distinct
    assert [each.category for each in recwarn] == [c2d.ScenarioWarning] * is_warned
