"""Rates of models on terrains, and how the others fail."""

import math
from typing import Any

import numpy as np
import pytest

import crawler2d as c2d
from crawler2d.studies.obstacles import _Limits, _limits_text
from tests.shared import ROBOT

BASE = c2d.Scenario(ROBOT, c2d.terrains.flat())
GROUNDS = {
    "low": c2d.terrains.step(0.04),
    "wall": c2d.terrains.step(0.3),
    "edge": c2d.terrains.step(0.11),
    "field": c2d.terrains.random_stepfield(0, rise=0.005),
}
MODELS = {"belt": c2d.BeltTrack(), "line of 3": c2d.LineOfWheels(3)}


def found_of(**how: Any) -> Any:
    given = {"terrains": GROUNDS, "models": MODELS, "progress": False, **how}
    given.setdefault("until", c2d.Until(width=0.5, min_runs=5, max_runs=20))
    return c2d.studies.success_rate(BASE, **given)


@pytest.fixture(scope="module")
def found() -> Any:
    return found_of()


def test_every_run_of_a_cell_ended_somehow(found: Any) -> None:
    ended = [name for name in found.data_vars if name.startswith("ended_")]
    assert (sum(found[name] for name in ended) == found["count"]).all()
    rates = found["ended_cleared"] / found["count"]
    assert np.allclose(rates, found["rate"])
    assert (found["rate"].sel(terrain="wall") == 0.0).all()
    assert found["rate"].sel(terrain="low", model="belt").item() == 1.0
    assert found.attrs["settings"] == 8
    stopped = np.isin(found["outcome"], [each for each in c2d.Outcome if each.is_stop])
    assert stopped.any()
    assert (np.isfinite(found["stop_x"]) == stopped).all()


def test_every_run_over_a_field_has_a_field_of_its_own() -> None:
    found = found_of(models=None)
    seeds = found["drawn_terrain_seed"].sel(terrain="field").to_numpy().ravel()
    seeds = seeds[np.isfinite(seeds)]
    assert len(set(seeds)) == seeds.size > 1
    assert np.isnan(found["drawn_terrain_seed"].sel(terrain="low")).all()
    assert "terrain.seed" in found.attrs["vary"]


def test_nothing_given_to_vary_is_the_same_as_none() -> None:
    field: Any = {"field": GROUNDS["field"]}
    few = c2d.Until(min_runs=2, max_runs=2)
    crossed = c2d.studies.success_rate(BASE, terrains=field, vary=None, until=few, progress=False)
    assert "terrain.seed" in crossed.attrs["vary"]
    how: Any = {"first": 2, "confirm": 2, "progress": False}
    lines = [c2d.LineOfWheels(4), c2d.LineOfWheels(5)]
    searched = c2d.studies.search(BASE, lines, terrains=field, vary=None, **how)
    assert "terrain.seed" in searched.attrs["vary"]


def test_the_scenarios_own_ground_is_taken_if_none_is_given() -> None:
    found = found_of(terrains=None)
    assert found["terrain"].values.tolist() == ["flat"]
    assert (found["rate"] == 1.0).all()
    assert "terrain.seed" not in found.attrs["vary"]  # no field was drawn


def test_anything_but_a_terrain_is_refused_by_name() -> None:
    for terrains, path in (({}, "terrains"), ([1], "terrains"), ({"a": 1}, "terrains['a']")):
        with pytest.raises(c2d.ScenarioError) as caught:
            found_of(terrains=terrains)
        assert caught.value.path == path


def test_the_figure_has_a_bar_for_every_cell_and_says_its_rate(found: Any) -> None:
    from matplotlib import pyplot as plt  # noqa: PLC0415

    _, ax = plt.subplots()
    assert found.plot(ax) is ax
    written = [text.get_text() for text in ax.texts]
    assert set(GROUNDS) <= set(written)
    assert sum("runs" in text for text in written) == 8
    part = found.sel(model="belt").plot()
    assert len(part.get_yticklabels()) == 4
    unknown = found_of(unknown={"terrain.friction": c2d.uniform(0.4, 1.0)}, samples=3)
    assert "5 to 95 %" in unknown.plot().get_title(loc="left")
    plt.close("all")


@pytest.mark.parametrize(
    ("limits", "text"),
    [
        ([(0.06, 0.06, 0, "none up to here")], "height up to 0.06 m, the greatest tried"),
        (
            [(0.05, math.nan, 1, "hung_up")],
            "height up to 0.05 m, but not every lower one, then mostly",
        ),
        ([(math.nan, math.nan, 0, "seized")], "no height that was tried, then mostly seized"),
        (
            [(0.05, 0.05, 0, "seized"), (0.07, 0.07, 0, "seized")],
            "height up to 0.05 to 0.07 m, then",
        ),
        (
            [(0.05, 0.05, 0, "seized"), (math.nan, math.nan, 0, "seized"), (0.07, 0.07, 0, "")],
            "height up to 0.05 to 0.07 m, but none in 1 of 3 samples, then mostly seized",
        ),
    ],
)
def test_the_summary_says_what_is_cleared_and_how_the_next_fails(
    limits: list[Any], text: str
) -> None:
    assert _limits_text([_Limits(*each) for each in limits], "height", "m").startswith(text)
