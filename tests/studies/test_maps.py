"""A map of a rate: a coarse grid, finer along one half; untried cells are not claimed."""

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import crawler2d as c2d
from crawler2d.studies.campaign import Tally, counting, is_cleared
from crawler2d.studies.maps import Grid
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

    def judge(tallies: Any) -> tuple[float, int, bool]:
        rate, low, high = tallies[0].interval
        kind = 1 * (low > 0.5) + 2 * (high < 0.5)
        return rate, kind, kind > 0

    grid = Grid((1, size, size), simulate, judge)
    for level in range(levels + 1):
        grid.refine(2 ** (levels - level), whole=level == 0)
    return grid


ABOVE, BELOW, BETWEEN = Interval(1.0, 0.8, 1.0), Interval(0.0, 0.0, 0.2), Interval(0.5, 0.3, 0.7)


def test_a_boundary_is_followed_and_the_rest_is_left_out() -> None:
    grid = grid_of(lambda y, x: ABOVE if x + 0.3 * math.sin(6.0 * y) > 0.5 else BELOW, 4)
    at = np.linspace(0.0, 1.0, 33)
    truth = np.where(at[None, :] + 0.3 * np.sin(6.0 * at[:, None]) > 0.5, 1.0, 2.0)
    assert (grid.kinds[0] == truth).all()
    assert grid.tried.mean() < 0.35
    # Both sides of the boundary were simulated wherever it passes between two cells.
    changes = truth[:, 1:] != truth[:, :-1]
    assert grid.tried[0, :, 1:][changes].all()
    assert grid.tried[0, :, :-1][changes].all()


def test_uncertain_cells_are_refined_with_their_neighbours() -> None:
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
    until = c2d.Until(threshold=0.5, min_runs=2, max_runs=2)
    found = map_of(unknown=unknown, samples=4, refine=1, until=until).squeeze("model")
    assert found["rate"].dims == ("angle", "friction", "sample")
    tried = found["count"].to_numpy().max(axis=-1) > 0
    assert tried[::2, ::2].all()
    straddles = (found["band_low"] <= 0.5) & (found["band_high"] >= 0.5)
    assert (found["unsure"].to_numpy() == straddles.to_numpy())[tried].all()
    # A cell that was not simulated is as certain as the least certain cell next to it.
    unsure = np.pad(found["unsure"].to_numpy() & tried, 1)
    rows, columns = tried.shape
    steps = [(j, i) for j in range(3) for i in range(3)]
    beside = np.any([unsure[j : j + rows, i : i + columns] for j, i in steps], axis=0)
    assert (found["unsure"].to_numpy() == beside)[~tried].all()
    median = found["band_median"].to_numpy()
    tied = median == 0.5
    assert ((found["ending"].to_numpy() == "cleared") == (median > 0.5))[tried & ~tied].all()
    assert found["unsure"].any()
    assert found["unknown_friction"].notnull().to_numpy()[tried].all()


def colors_of(ax: Any) -> dict[str, Any]:
    """Colours, hatching and opacity by their labels in the legend."""
    legend = ax.get_legend()
    texts = (text.get_text() for text in legend.get_texts())
    return dict(zip(texts, legend.get_patches(), strict=True))


def test_where_all_slip_the_map_has_another_colour_than_where_all_clear() -> None:
    from matplotlib import pyplot as plt  # noqa: PLC0415

    found = map_of(outcome="seized", refine=0).squeeze("model")
    assert (found["rate"] == 0.0).all()  # no run seizes: it slips, or clears
    ends = found["outcome"].isel(repeat=0).transpose("angle", "friction").to_numpy()
    expected = np.where(ends == "cleared", "cleared", "otherwise")
    assert set(expected.ravel()) == {"cleared", "otherwise"}
    assert found["ending"].values.tolist() == expected.tolist()
    ax = found.plot()
    own = colors_of(ax)
    assert list(own) == ["most runs fail otherwise", "most runs clear"]
    slips, clears = (each.get_facecolor() for each in own.values())
    assert slips != clears
    (mesh,) = (each for each in ax.collections if each.get_array().count())
    wanted = [clears if end == "cleared" else slips for end in expected.ravel()]
    assert np.allclose(mesh.to_rgba(mesh.get_array().ravel()), wanted)
    assert "intervals of a rate up to 0." in ax.get_title(loc="left")
    plt.close("all")


def test_uncertain_cells_are_hatched_and_in_the_legend() -> None:
    from matplotlib import pyplot as plt  # noqa: PLC0415

    few = c2d.Until(threshold=0.5, min_runs=3, max_runs=3)  # three that agree prove nothing
    found = map_of(refine=0, until=few).squeeze("model")
    assert found["unsure"].all()
    ax = found.plot()
    (mesh,) = (each for each in ax.collections if each.get_array().count())
    assert mesh.get_hatch() == "////"
    marks = [patch.get_hatch() for text, patch in colors_of(ax).items() if "uncertain" in text]
    assert marks == ["////"]
    plt.close("all")


def test_a_cell_is_simulated_until_it_is_known_whether_most_clear_or_fail_otherwise() -> None:
    """Of ten runs none seizes; five clear and five slip."""
    rows: Any = [SimpleNamespace(outcome=end, error=None) for end in ["cleared", "slipping"] * 5]
    world: Any = None
    until = c2d.Until(threshold=0.5)
    seized, others = counting("seized"), [is_cleared, counting("slipping")]
    assert Tally(world, until, seized, rows=rows).runs_needed == 0
    assert Tally(world, until, seized, others, rows=rows).runs_needed == 5
    assert Tally(world, until, seized, others, rows=rows[::2] * 2).runs_needed == 0


def test_a_map_draws_one_model_with_its_unit_and_its_populations() -> None:
    from matplotlib import pyplot as plt  # noqa: PLC0415

    models = {"as it is": {}, "weak": {"robot.drivetrain.max_torque": 3.0}}
    found = map_of(models=models, refine=1, until=c2d.Until(threshold=0.5, max_runs=10))
    error = refused(found.plot)
    assert error.path == "plot"
    assert "found.sel(model=...)" in error.rule
    _, ax = plt.subplots()
    assert found.sel(model="weak").plot(ax) is ax
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("friction", "angle [deg]")
    assert ax.get_ylim()[1] > math.degrees(0.6)
    assert ax.get_title(loc="left").splitlines()[:2] == [
        "weak",
        "how most runs end, over track phase",
    ]
    assert any("not simulated" in text.get_text() for text in ax.get_legend().get_texts())
    assert found.isel(model=[0]).plot().get_title(loc="left").startswith("as it is")
    assert refused(found.isel(model=0, angle=0).plot).path == "plot"
    plt.close("all")


def test_the_figure_of_a_part_of_a_map_with_one_value_of_a_field_is_refused() -> None:
    found = map_of(refine=0, until=c2d.Until(threshold=0.5, max_runs=10))
    for part in ({"angle": [0]}, {"friction": [0]}, {"angle": [0], "friction": [0]}):
        error = refused(found.isel(part).plot)
        assert error.path == "plot"
        assert error.rule == "must have both fields of the map, with two values of each or more"


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
def test_invalid_arguments_are_refused_by_name(given: Any, path: str) -> None:
    how = {"x": FRICTION, "y": ANGLE, **given}
    assert refused(lambda: c2d.studies.seizure_map(SLOPE, **how)).path == path
