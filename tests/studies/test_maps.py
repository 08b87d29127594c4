"""A map of a rate: a coarse grid, finer along one half; what was not tried is not claimed."""

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import crawler2d as c2d
from crawler2d.studies.refined import Grid
from crawler2d.sweeps.statistics import Interval
from tests.shared import ROBOT, refused

SLOPE = c2d.Scenario(ROBOT, c2d.terrains.ramp(0.4))
FRICTION = ("terrain.friction", [0.3, 0.5, 0.7])
ANGLE = ("terrain.angle", [0.2, 0.4, 0.6])
PHASE: Any = {"vary": {"start.track_phase": c2d.uniform(0.0, 0.048)}, "progress": False}
NEAR = 0.02
"""The ramp is so short that the run-up carries a robot over that lacks 2 % of the friction."""


def map_of(**how: Any) -> Any:
    given = {"outcome": "cleared", **PHASE, **how}
    return c2d.studies.seizure_map(SLOPE, FRICTION, ANGLE, **given)


def grid_of(truth: Any, levels: int) -> Grid:
    """Refine a grid of 3 by 3 whose cells have the interval that a function of y and x gives."""
    size = 2 * 2**levels + 1

    def simulate(places: Any) -> Any:
        return [
            [SimpleNamespace(interval=truth(j / (size - 1), i / (size - 1)))] for _, j, i in places
        ]

    grid = Grid((1, size, size), simulate)
    for level in range(levels + 1):
        grid.refine(2 ** (levels - level), whole=level == 0)
    return grid


ABOVE, BELOW, BETWEEN = Interval(1.0, 0.8, 1.0), Interval(0.0, 0.0, 0.2), Interval(0.5, 0.3, 0.7)


def test_a_boundary_is_followed_and_the_rest_is_left_out() -> None:
    grid = grid_of(lambda y, x: ABOVE if x + 0.3 * math.sin(6.0 * y) > 0.5 else BELOW, 4)
    at = np.linspace(0.0, 1.0, 33)
    truth = np.where(at[None, :] + 0.3 * np.sin(6.0 * at[:, None]) > 0.5, 1.0, -1.0)
    assert (grid.sides[0] == truth).all()
    assert grid.tried.mean() < 0.35
    # Both sides of the boundary have been simulated wherever it passes between two cells.
    changes = truth[:, 1:] != truth[:, :-1]
    assert grid.tried[0, :, 1:][changes].all()
    assert grid.tried[0, :, :-1][changes].all()


def test_what_is_not_certain_is_made_finer_all_round() -> None:
    grid = grid_of(lambda y, x: BETWEEN if (y, x) == (0.5, 0.5) else BELOW, 1)
    expected = np.zeros((5, 5), bool)
    expected[::2, ::2] = True
    expected[1:4, 1:4] = True
    assert (grid.tried[0] == expected).all()
    assert np.isfinite(grid.rates).all()


def test_where_all_lie_on_one_side_nothing_more_is_simulated() -> None:
    grid = grid_of(lambda _y, _x: ABOVE, 3)
    assert grid.tried.sum() == 9
    assert (grid.rates == 1.0).all()


def test_the_boundary_of_a_belt_on_a_slope_is_where_friction_equals_its_tangent() -> None:
    found = map_of(refine=2).squeeze("model")
    assert found["rate"].dims == ("angle", "friction")
    assert found.sizes["friction"] == found.sizes["angle"] == 9
    tried = found["count"].to_numpy() > 0
    assert found.attrs["settings"] == tried.sum() < 81
    reserve = (found["friction"] - np.tan(found["angle"])).transpose("angle", "friction").to_numpy()
    shown = np.where(tried, found["rate"].to_numpy(), found["around"].to_numpy())
    clear = np.abs(reserve) > NEAR
    assert ((shown >= 0.5) == (reserve > 0.0))[clear].all()
    assert np.isnan(found["rate"].to_numpy()[~tried]).all()
    assert np.isnan(found["around"].to_numpy()[tried]).all()
    assert not found["unsure"].to_numpy()[~tried].any()


def test_with_unknowns_the_median_decides_and_the_band_says_where_it_is_not_sure() -> None:
    unknown = {"terrain.friction": c2d.shifted(-0.15, 0.15)}
    until = c2d.Until(threshold=0.5, least=2, most=2)
    found = map_of(unknown=unknown, samples=4, refine=1, until=until).squeeze("model")
    assert found["rate"].dims == ("angle", "friction", "sample")
    tried = found["count"].to_numpy().max(axis=-1) > 0
    assert tried[::2, ::2].all()
    straddles = (found["band_low"] <= 0.5) & (found["band_high"] >= 0.5)
    assert found["unsure"].equals(straddles & tried)
    assert found["unsure"].any()
    assert found["unknown_friction"].notnull().to_numpy()[tried].all()


def test_a_map_draws_one_model_with_its_unit_and_its_populations() -> None:
    from matplotlib import pyplot as plt  # noqa: PLC0415

    models = {"as it is": {}, "weak": {"robot.drivetrain.max_torque": 3.0}}
    found = map_of(models=models, refine=1, until=c2d.Until(threshold=0.5, most=10))
    error = refused(found.plot)
    assert error.path == "plot"
    assert "found.sel(model=...)" in error.rule
    _, ax = plt.subplots()
    assert found.sel(model="weak").plot(ax) is ax
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("friction", "angle [deg]")
    assert ax.get_ylim()[1] > math.degrees(0.6)
    assert ax.get_title(loc="left").splitlines()[:2] == ["weak", "rates over track phase"]
    assert any("not simulated" in text.get_text() for text in ax.get_legend().get_texts())
    labels = [each.get_ylabel() for each in ax.figure.axes]
    assert "rate of cleared" in labels
    assert found.isel(model=[0]).plot().get_title(loc="left").startswith("as it is")
    assert refused(found.isel(model=0, angle=0).plot).path == "plot"
    plt.close("all")


@pytest.mark.parametrize(
    ("given", "path"),
    [
        ({"x": ("robot.name", [1.0, 2.0])}, "x[0]"),
        ({"x": ("robot.track", [1.0, 2.0])}, "x[0]"),
        ({"x": "terrain.friction"}, "x"),
        ({"x": ("terrain.friction", 0.5)}, "x[1]"),
        ({"x": ("terrain.friction", [0.5])}, "x[1]"),
        ({"x": ("terrain.friction", [0.5, 0.4])}, "x[1]"),
        ({"x": ("terrain.friction", [0.5, "a"])}, "x[1][1]"),
        ({"y": FRICTION}, "y"),
        ({"outcome": "won"}, "outcome"),
        ({"refine": -1}, "refine"),
        ({"repeats": 3}, "repeats"),
    ],
)
def test_what_is_wrong_is_refused_by_name(given: Any, path: str) -> None:
    how = {"x": FRICTION, "y": ANGLE, **given}
    assert refused(lambda: c2d.studies.seizure_map(SLOPE, **how)).path == path
