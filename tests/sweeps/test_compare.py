"""Models compared in pairs: counts, intervals, and the definition of a pair."""

from typing import Any

import numpy as np
import pytest
import xarray as xr

import crawler2d as c2d
from crawler2d.parameters.scenario import Scenario
from crawler2d.sweeps.rates import rates_of
from crawler2d.sweeps.statistics import bootstrap_mean, mcnemar, newcombe_paired
from crawler2d.sweeps.sweep import compare, sweep
from crawler2d.variation.distributions import uniform
from tests.kept import refusing
from tests.shared import ROBOT
from tests.sweeps.small import SAID

# At this friction some draws clear the step and some do not.
BASE = Scenario(ROBOT, c2d.terrains.step(0.05, friction=0.6), duration=6.0)
VARY = {"terrain.friction": uniform(0.45, 0.75), "start.approach": uniform(0.05, 0.15)}
MODELS = {"belt": c2d.BeltTrack(), "line of 3": c2d.LineOfWheels(3), "skids": c2d.ForceTrack()}
REPEATS = 12


def quiet(models: Any, **options: Any) -> xr.Dataset:
    """Compare without a progress bar."""
    return compare(BASE, models, **{"progress": False, **options})


@pytest.fixture(scope="module")
def found() -> xr.Dataset:
    return quiet(MODELS, repeats=REPEATS, vary=VARY)


def test_the_models_run_as_in_a_sweep(found: xr.Dataset) -> None:
    over = {"robot.track": MODELS}
    table = sweep(BASE, over, repeats=REPEATS, vary=VARY, progress=False).rename(track="model")
    for name in table.data_vars:
        assert found[name].equals(table[name]), name
    assert found.attrs["reference"] == "belt"
    assert found.attrs["scenario"] == BASE.to_json()


def test_some_pairs_differ(found: xr.Dataset) -> None:
    """Otherwise the tests below would be pointless."""
    assert 0.0 < found["rate"].sel(model="belt").item() < 1.0
    assert found["both"].sel(model="line of 3").item() > 2
    assert found["only_reference"].sel(model="skids").item() > 2


def test_a_pair_is_one_repeat_of_both_models(found: xr.Dataset) -> None:
    cleared = found["outcome"].to_numpy() == "cleared"
    for index, name in enumerate(MODELS):
        row = found.sel(model=name)
        assert row["both"].item() == (cleared[index] & cleared[0]).sum()
        assert row["only_model"].item() == (cleared[index] & ~cleared[0]).sum()
        assert row["only_reference"].item() == (~cleared[index] & cleared[0]).sum()
        assert row["neither"].item() == (~cleared[index] & ~cleared[0]).sum()


@pytest.mark.parametrize("part", [{}, {"model": "skids"}])
def test_the_figure_has_each_difference_with_its_interval(
    found: xr.Dataset, part: dict[str, str]
) -> None:
    shown = found.sel(part)
    ax: Any = shown.plot()
    names = np.atleast_1d(shown["model"].to_numpy()).tolist()
    assert [label.get_text() for label in ax.get_yticklabels()] == names
    (line,) = (each for each in ax.lines if each.get_marker() == "o")
    np.testing.assert_array_equal(line.get_xdata(), np.atleast_1d(shown["difference"]))
    (bars,) = ax.collections
    ends = np.array([each[:, 0] for each in bars.get_segments()])
    bounds = [np.atleast_1d(shown[f"difference_{end}"]) for end in ("low", "high")]
    np.testing.assert_array_equal(ends.T, bounds)
    lost = found["only_reference"].sel(model="skids").item()
    assert any(f"belt alone: {lost}" in text.get_text() for text in ax.texts)


def test_rates_and_differences_are_those_of_the_pairs(found: xr.Dataset) -> None:
    rates = rates_of(found)
    for name in list(MODELS)[1:]:
        row = found.sel(model=name)
        assert (row["rate"].item(), row["rate_low"].item(), row["rate_high"].item()) == tuple(
            rates.sel(model=name)[bound].item() for bound in ("rate", "low", "high")
        )
        pairs = [row[n].item() for n in ("both", "only_model", "only_reference", "neither")]
        expected = newcombe_paired(*pairs)
        assert row["difference"].item() == pytest.approx(expected.rate)
        reference = rates["rate"].sel(model="belt")
        assert row["difference"].item() == pytest.approx((row["rate"] - reference).item())
        assert row["difference_low"].item() == expected.low
        assert row["difference_high"].item() == expected.high
        assert row["p_value"].item() == mcnemar(pairs[1], pairs[2])


def test_costs_are_compared_where_both_cleared(found: xr.Dataset) -> None:
    line, belt = found.sel(model="line of 3"), found.sel(model="belt")
    both = ((line["outcome"] == "cleared") & (belt["outcome"] == "cleared")).to_numpy()
    for name in ("time_to_clear", "drive_work"):
        expected = bootstrap_mean((line[name] - belt[name]).to_numpy()[both])
        assert np.isfinite(expected.rate)
        bounds = [line[f"{name}_difference{end}"].item() for end in ("", "_low", "_high")]
        assert bounds == list(expected)
    assert found["time_to_clear_difference"].attrs["units"] == "s"
    assert found["drive_work_difference_low"].attrs["units"] == "J"


def test_models_that_never_cleared_together_have_no_cost_to_compare(found: xr.Dataset) -> None:
    skids = found.sel(model="skids")
    assert skids["both"].item() == 0
    assert np.isnan(skids["drive_work_difference"].item())
    assert np.isneginf(skids["drive_work_difference_low"].item())
    assert np.isposinf(skids["drive_work_difference_high"].item())


def test_the_reference_differs_from_itself_by_nothing(found: xr.Dataset) -> None:
    belt = found.sel(model="belt")
    for name in ("difference", "time_to_clear_difference", "drive_work_difference"):
        assert [belt[f"{name}{end}"].item() for end in ("", "_low", "_high")] == [0.0, 0.0, 0.0]
    assert belt["p_value"].item() == 1.0


def test_another_reference_turns_the_difference_round(found: xr.Dataset) -> None:
    turned = quiet(MODELS, repeats=REPEATS, vary=VARY, reference="line of 3")
    assert turned.attrs["reference"] == "line of 3"
    there, back = found.sel(model="line of 3"), turned.sel(model="belt")
    assert back["difference"].item() == -there["difference"].item()
    assert back["difference_low"].item() == pytest.approx(-there["difference_high"].item())
    assert back["only_model"].item() == there["only_reference"].item()


def test_models_in_a_sequence_are_labelled_in_short() -> None:
    pair = quiet([c2d.BeltTrack(), c2d.LineOfWheels(3)], repeats=1, vary={})
    assert pair["model"].values.tolist() == ["BeltTrack()", "LineOfWheels(3)"]
    assert pair["model"].attrs == {"path": "robot.track", "long_name": "track"}
    counts = {3: c2d.LineOfWheels(3), 5: c2d.LineOfWheels(5)}
    assert quiet(counts, repeats=1, reference=5).attrs["reference"] == 5


def test_fields_are_compared_as_models_are() -> None:
    heavy = {"robot.mass": 30.0, "robot.center_of_mass[0]": -0.05}
    fine = c2d.Solver(accuracy=1e-7)
    other = c2d.robots.absolem(flippers=None)
    models = {
        "as it is": {},
        "heavy": heavy,
        "fine": fine,
        "of 1 ms": {"solver.time_step": 1e-3},
        "other": other,
        "skids": c2d.ForceTrack(),
    }
    pair = quiet(models, repeats=2, vary=VARY)
    assert pair["model"].values.tolist() == list(models)
    assert pair["rate"].dims == ("model",)
    first = Scenario.from_json(pair["scenario"].values[0, 0])
    draws = {path: pair[f"drawn_{path.rpartition('.')[2]}"].values[0, 0] for path in VARY}
    assert first == BASE.replace(draws)
    replaced: dict[str, Any] = {
        "heavy": heavy,
        "fine": {"solver": fine},
        "of 1 ms": {"solver": c2d.Solver(time_step=1e-3)},
        "other": {"robot": other},
        "skids": {"robot.track": c2d.ForceTrack()},
    }
    for label, fields in replaced.items():
        text = pair["scenario"].sel(model=label).values[0]
        assert Scenario.from_json(text) == first.replace(fields)


def test_attributes_of_the_model_axis_name_the_replaced_fields() -> None:
    models = [{"robot.mass": 20.0}, {"robot.mass": 22.0, "gravity": 9.0}]
    pair = quiet(models, repeats=1, vary={})
    assert pair["model"].attrs["path"] == "robot.mass, gravity"
    assert pair["mass"].values.tolist() == [20.0, 22.0]
    assert "gravity" not in pair  # the first model does not change it


@pytest.mark.parametrize(
    ("models", "options", "path"),
    [
        ({"belt": c2d.BeltTrack()}, {}, "models"),
        ([], {}, "models"),
        (c2d.BeltTrack(), {}, "models"),
        ([c2d.BeltTrack()] * 2, {}, "models[1]"),
        (MODELS, {"reference": "line of 9"}, "reference"),
        (MODELS, {"reference": c2d.BeltTrack()}, "reference"),
        (MODELS, {"repeats": 0}, "repeats"),
        (MODELS, {"seed": -1}, "seed"),
        (MODELS, {"vary": {"robot.track": 3}}, "vary['robot.track']"),
        ({**MODELS, "wall": "brick"}, {}, "models['wall']"),
        ({"robot.mass": [20.0, 22.0], "robot.gauge": [0.2, 0.3]}, {}, "models['robot.mass']"),
        ({**MODELS, "all": BASE}, {}, "models['all']"),
        ({**MODELS, "heavy": {"robot.mas": 30.0}}, {}, "cell[model=heavy].robot.mas"),
        ({**MODELS, "heavy": {3: 30.0}}, {}, "cell[model=heavy].path"),
        (
            {"a": {}, "b": {"terrain.friction": 0.5}},
            {"vary": {"terrain.friction": uniform(0.4, 0.6)}},
            "vary['terrain.friction']",
        ),
        ({**MODELS, "one": c2d.LineOfWheels(1)}, {}, "cell[model=one].robot.track.count"),
    ],
)
def test_models_that_cannot_be_compared_are_refused_by_name(
    models: Any, options: dict[str, Any], path: str
) -> None:
    with refusing(SAID) as caught:
        quiet(models, **options)
    assert caught.value.path == path
    assert caught.value.rule.startswith("must")


def test_a_reference_that_is_none_of_the_models_is_refused_with_their_labels() -> None:
    rule = "^reference must be a label of the models, got tracks: belt, line of 3, skids$"
    with refusing(SAID, rule):
        quiet(MODELS, reference="tracks")
    for reference in (np.array(["belt", "skids"]), True, ["belt"]):
        with refusing(SAID, r"^reference must be a label"):
            quiet(MODELS, reference=reference)
