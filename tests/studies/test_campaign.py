"""Studies repeat each cell until its rate is known, and report this."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import crawler2d as c2d
from crawler2d.studies.campaign import Tally
from crawler2d.studies.obstacles import _limits
from crawler2d.sweeps.store import stored_rows
from tests.pictures.reading import lay_out
from tests.shared import ROBOT
from tests.sweeps.small import interrupt_after

BASE = c2d.Scenario(ROBOT, c2d.terrains.step(0.05), solver=c2d.Solver(accuracy=1e-5))
MODELS = {"belt": c2d.BeltTrack(), "3 gears": c2d.LineOfWheels(3, wheel=c2d.GearWheel())}
HEIGHTS = [0.04, 0.086]  # here the rate of the gears is known after 22 runs, and at 88 mm after 244


TEN = c2d.Until(width=0.01, min_runs=10, max_runs=10)


def found_of(**how: Any) -> Any:
    given = {"models": MODELS, "heights": HEIGHTS, "progress": False, **how}
    return c2d.studies.max_obstacle(BASE, **given)


@pytest.fixture(scope="module")
def store(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("campaign") / "a.sqlite"


@pytest.fixture(scope="module")
def stored(store: Path) -> Any:
    return found_of(store=store)


def test_a_cell_is_simulated_until_its_rate_is_known_and_no_longer(stored: Any) -> None:
    found = stored
    counts = found["count"].to_numpy()
    assert counts[0, 0] == 10  # ten of ten are certain enough
    assert (counts <= 250).all()
    assert counts.max() > 10
    made = (found["outcome"] != "").sum("repeat").to_numpy()
    assert made.tolist() == counts.tolist()
    until = c2d.Until(threshold=0.5)
    successes = (found["outcome"] == "cleared").sum("repeat").to_numpy()
    for k, n in zip(successes.flat, counts.flat, strict=True):
        assert until.is_done(int(k), int(n))
    assert found.attrs["settings"] == 4
    assert found.attrs["runs"] == counts.sum()


def test_the_runs_are_those_of_a_sweep_with_the_same_seed() -> None:
    found = found_of(seed=4, until=TEN)
    over = {"robot.track": MODELS, "terrain.height": HEIGHTS}
    table = c2d.sweep(BASE, over, repeats=10, seed=4, progress=False)
    first = found.isel(repeat=slice(0, 10))
    assert first["final_x"].values.tolist() == table["final_x"].values.tolist()
    assert first["drawn_approach"].values.tolist() == table["drawn_approach"].values.tolist()


def test_the_given_stopping_rule_is_used() -> None:
    fixed = found_of(until=c2d.Until(width=0.01, min_runs=7, max_runs=7))
    assert (fixed["count"] == 7).all()
    assert fixed.sizes["repeat"] == 7
    assert "min_runs=7" in fixed.attrs["until"]


def test_unknowns_give_a_rate_for_every_sample() -> None:
    unknown = {"terrain.friction": c2d.uniform(0.3, 1.0)}
    found = found_of(unknown=unknown, samples=4, until=c2d.Until(threshold=0.5, max_runs=20))
    assert found["rate"].dims == ("model", "height", "sample")
    assert found["highest"].dims == ("model", "sample")
    assert found["unknown_friction"].sel(model="belt", height=0.04).shape == (4,)
    assert "terrain.friction" in found.attrs["unknown"]


def test_a_store_keeps_the_runs_of_a_study(store: Path, stored: Any) -> None:
    first = stored
    assert len(list(stored_rows(store))) == first.attrs["runs"]
    calls: list[tuple[int, int]] = []
    again = found_of(store=store, progress=lambda done, total: calls.append((done, total)))
    assert again.drop_vars("wall_time").identical(first.drop_vars("wall_time"))
    assert len(list(stored_rows(store))) == first.attrs["runs"]
    assert calls[-1] == (first.attrs["runs"],) * 2


def test_invalid_arguments_are_refused_by_name() -> None:
    cases: list[tuple[dict[str, Any], str]] = [
        ({"repeats": 5}, "repeats"),
        ({"until": 5}, "until"),
        ({"models": {"a": 4}}, "models['a']"),
        ({"heights": []}, "heights"),
        ({"heights": [-1.0]}, "cell[model=belt, height=-1].terrain.height"),
        ({"vary": {"terrain.height": c2d.uniform(0, 1)}}, "vary['terrain.height']"),
        ({"samples": 0, "unknown": {"gravity": c2d.uniform(9, 10)}}, "samples"),
        ({"seed": -1}, "seed"),
    ]
    for how, path in cases:
        with pytest.raises(c2d.ScenarioError) as caught:
            found_of(**how)
        assert caught.value.path == path
    with pytest.raises(c2d.ScenarioError, match="terrain must be a terrain with a height"):
        c2d.studies.max_obstacle(BASE.replace({"terrain": c2d.terrains.flat()}))


def test_ctrl_c_is_reported_and_the_store_can_be_continued(tmp_path: Path) -> None:
    store = tmp_path / "a.sqlite"

    with pytest.raises(c2d.BatchInterrupted, match=r"a\.sqlite keeps them"):
        found_of(store=store, until=TEN, progress=interrupt_after(5), threads=1)
    kept = len(list(stored_rows(store)))
    assert kept > 5
    again = found_of(store=store, until=TEN)
    assert again.identical(found_of(store=store, until=TEN))


def test_the_highest_obstacle_its_gaps_and_its_limit_are_those_of_the_rates() -> None:
    found = found_of(heights=[0.04, 0.088, 0.2], until=TEN)
    rates = found["rate"].sel(model="belt").to_numpy()
    heights = found["height"].to_numpy()
    assert found["highest"].sel(model="belt").item() == heights[rates >= 0.5].max()
    assert found["certain"].sel(model="belt").item() <= found["highest"].sel(model="belt").item()
    assert (found["gaps"] == 0).all()
    above = found["outcome"].sel(model="belt", height=0.2).to_numpy()
    assert found["limit"].sel(model="belt").item() in set(above)
    none = found_of(heights=[0.3, 0.4], until=TEN)
    assert np.isnan(none["highest"]).all()
    assert (none["gaps"] == 0).all()


def test_a_height_is_certain_where_only_the_width_of_the_interval_was_asked_for() -> None:
    belt = {"belt": c2d.BeltTrack()}
    found = found_of(models=belt, heights=[0.03, 0.2], until=c2d.Until(width=0.3))
    assert found["rate"].values.tolist() == [[1.0, 0.0]]
    assert found["certain"].item() == 0.03
    assert found["side"].values.tolist() == [[1, -1]]


def test_slopes_and_gaps_are_climbed_up_to_their_limit() -> None:
    slope = BASE.replace({"terrain": c2d.terrains.ramp(0.3)})
    steep = c2d.studies.max_slope(slope, angles=[0.3, 0.6, 1.2], progress=False)
    assert steep["highest"].values.tolist() == [0.6]
    gap = BASE.replace({"terrain": c2d.terrains.gap(0.1)})
    wide = c2d.studies.max_gap(gap, widths=[0.1, 0.36], progress=False)
    assert wide["highest"].values.tolist() == [0.1]
    assert list(steep["model"].values) == [ROBOT.track.description]


def test_points_are_drawn_where_they_were_tried_and_intervals_beside_each_other() -> None:
    from matplotlib import pyplot as plt  # noqa: PLC0415

    found = found_of(until=c2d.Until(threshold=0.5, max_runs=10))
    ax = found.plot()
    lay_out(ax)
    tried = (1e3 * np.array(HEIGHTS)).tolist()
    assert [list(line.get_xdata()) for line in ax.get_lines()] == [tried] * len(MODELS)
    assert {*tried} <= {*ax.get_xticks(), *ax.get_xticks(minor=True)}
    places = []
    for bars in ax.collections:
        ends = np.array(bars.get_segments())
        assert ends[:, :, 0].tolist() == [[x, x] for x in tried]
        places.append(bars.get_transform().transform(ends[0])[0, 0])
    # They are some points apart on paper, centred on the value.
    (middle, _), gap = ax.transData.transform((tried[0], 0.0)), 3.5 * ax.figure.dpi / 72.0
    assert places == pytest.approx([middle - 0.5 * gap, middle + 0.5 * gap])
    assert ax.get_legend().get_window_extent().y1 < ax.get_window_extent().y0
    plt.close("all")


def test_rates_over_many_pairs_of_numbers_are_a_map_with_uncertain_cells_hatched() -> None:
    from matplotlib import pyplot as plt  # noqa: PLC0415

    heights, frictions = np.linspace(0.04, 0.16, 7), [0.3, 0.9]
    over = {"terrain.height": heights, "terrain.friction": frictions}
    found = c2d.rate(c2d.sweep(BASE, over, repeats=4, progress=False))
    found["rate"][0, 0], found["low"][0, 0], found["high"][0, 0] = 0.4, 0.1, 0.8
    ax = found.plot()
    cells, hatched = ax.collections
    assert (ax.get_ylabel(), ax.get_xlabel()) == ("height [mm]", "friction")
    drawn: Any = cells.get_array()
    np.testing.assert_array_equal(drawn.reshape(7, 2), found["rate"])
    is_open = (found["low"] < 0.5) & (found["high"] > 0.5)
    assert is_open[0, 0]
    assert len(hatched.get_paths()) == is_open.sum()
    # Of fewer lines each can be told from the others.
    assert len(found.isel(height=slice(0, 6)).plot().get_lines()) == 6
    plt.close("all")


def test_rates_are_drawn_in_the_order_of_their_values_however_these_were_listed() -> None:
    from matplotlib import pyplot as plt  # noqa: PLC0415

    over = {"terrain.height": np.linspace(0.04, 0.16, 7), "terrain.friction": [0.3, 0.9]}
    listed = c2d.rate(c2d.sweep(BASE, over, repeats=1, progress=False))
    found = listed.isel(height=[3, 0, 6, 1, 5, 2, 4], friction=[1, 0])
    cells: list[Any] = [each.plot().collections[0] for each in (listed, found)]
    for one, other in zip(*(each.get_coordinates().T for each in cells), strict=True):
        np.testing.assert_array_equal(one, other)
    np.testing.assert_array_equal(*(each.get_array() for each in cells))
    (line,) = found.isel(friction=0, drop=True).plot().get_lines()
    assert np.all(np.diff(line.get_xdata()) > 0.0)
    plt.close("all")


def test_values_in_a_legend_have_the_unit_that_they_have_at_an_axis() -> None:
    from matplotlib import pyplot as plt  # noqa: PLC0415

    over = {"terrain.height": [0.04, 0.16], "start.approach": [0.1, 0.2]}
    found = c2d.rate(c2d.sweep(BASE, over, repeats=1, progress=False))

    def told(part: Any) -> tuple[str, list[str]]:
        ax = part.plot()
        legend = ax.get_legend()
        assert legend is not None
        return ax.get_xlabel(), [text.get_text() for text in legend.get_texts()]

    assert told(found) == ("approach [mm]", ["height 40 mm", "height 160 mm"])
    other = found.transpose("approach", "height")
    assert told(other) == ("height [mm]", ["approach 100 mm", "approach 200 mm"])
    frictions = c2d.rate(
        c2d.sweep(BASE, {"terrain.friction": [0.5, 1.0], **over}, repeats=1, progress=False)
    )
    assert told(frictions.isel(height=0))[1] == ["friction 0.5", "friction 1"]
    plt.close("all")


def test_rates_draw_themselves_into_the_axes_they_are_given() -> None:
    from matplotlib import pyplot as plt  # noqa: PLC0415

    found = found_of(until=c2d.Until(threshold=0.5, max_runs=10))
    _, ax = plt.subplots()
    assert found.plot(ax) is ax
    assert len(ax.get_lines()) == 2
    assert ax.get_xlabel() == "height [mm]"
    assert "approach" in ax.get_title(loc="left")
    table = c2d.sweep(BASE, {"terrain.height": HEIGHTS}, repeats=3, progress=False)
    own = c2d.rate(table).plot()
    assert own.get_ylim() == (-0.03, 1.03)
    with pytest.raises(c2d.ScenarioError, match="must have a dimension of numbers"):
        c2d.rate(table.isel(height=0, drop=True)).plot()
    plt.close("all")


def test_labels_with_dollars_are_no_formulas_in_a_figure() -> None:
    from matplotlib import pyplot as plt  # noqa: PLC0415

    dear, dearer = models = {"for 5 $^$": c2d.BeltTrack(), "for 6 $_$": c2d.LineOfWheels(4)}
    how: Any = {"models": models, "progress": False}
    once = c2d.Until(min_runs=1, max_runs=1, confidence=0.995)
    highest = c2d.studies.max_obstacle(BASE, heights=[0.05], until=once, **how)
    crossed = c2d.studies.success_rate(BASE, terrains={dear: BASE.terrain}, until=once, **how)
    ridden = c2d.studies.ride(BASE, repeats=1, **how)
    for found in (highest, crossed, ridden):
        ax = found.plot()
        lay_out(ax)
        legend = ax.get_legend()
        keys = legend.get_texts() if legend is not None else []
        names = {text.get_text() for text in (*ax.get_yticklabels(), *ax.texts, *keys)}
        assert {dear, dearer} <= names
        if found is highest:
            assert "sequential intervals, 99.5 %" in ax.get_title(loc="left")
    plt.close("all")


def test_an_obstacle_without_a_result_is_the_limit_of_those_before_it() -> None:
    def tally(outcome: str, error: object = None) -> Tally:
        row: Any = SimpleNamespace(outcome=outcome, error=error)
        nowhere: Any = None
        return Tally(nowhere, c2d.Until(), rows=[row] * 5)

    diverged = tally("diverged", c2d.errors.SimulationDiverged("the state became non-finite"))
    found = _limits([tally("cleared"), diverged], [0.1, 0.2])
    assert (found.highest, found.limit) == (0.1, "diverged")
    assert _limits([tally("cleared")] * 2, [0.1, 0.2]).limit == "none up to here"
