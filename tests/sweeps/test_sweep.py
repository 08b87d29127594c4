"""Sweeps: every combination, the same draws in every cell, and a table that replays."""

import itertools
import json
from typing import Any

import numpy as np
import pytest
import xarray as xr

import crawler2d as c2d
from crawler2d.common.units import METRICS
from crawler2d.parameters.scenario import Scenario
from crawler2d.sweeps.sweep import sweep
from crawler2d.variation.distributions import scaled, uniform, uniform_int
from tests.shared import ROBOT
from tests.sweeps.small import BASE, BRIEF, MODELS, quiet, refusal


@pytest.fixture(scope="module")
def table() -> xr.Dataset:
    """Two heights, two models, three repeats."""
    return quiet(BASE, {"terrain.height": [0.03, 0.1], "robot.track": MODELS}, repeats=3)


def test_the_table_has_a_dimension_a_path_and_one_of_repeats(table: xr.Dataset) -> None:
    assert dict(table["outcome"].sizes) == {"height": 2, "track": 2, "repeat": 3}
    assert table["height"].values.tolist() == [0.03, 0.1]
    assert table["track"].values.tolist() == ["belt", "line of 3"]
    assert table["repeat"].values.tolist() == [0, 1, 2]
    assert (table["outcome"].sel(height=0.03, track="belt") == "cleared").all()


def test_the_table_has_units_paths_and_provenance(table: xr.Dataset) -> None:
    assert table["height"].attrs == {
        "path": "terrain.height",
        "units": "m",
        "long_name": "height",
    }
    assert table["track"].attrs == {"path": "robot.track", "long_name": "track"}
    assert table["drawn_speed"].attrs["units"] == "m/s"
    assert {name: table[name].attrs["units"] for name in METRICS} == METRICS
    assert all("long_name" in variable.attrs for variable in table.variables.values())
    assert Scenario.from_json(table.attrs["scenario"]) == BASE
    assert (table["seed"] == 0).all()
    assert "drive.speed: Scaled(low=0.98, high=1.02)" in table.attrs["vary"]
    assert table.attrs["unknown"] == ""
    assert table.attrs["build_version"] == c2d.__version__


def test_a_swept_run_replays_alone(table: xr.Dataset) -> None:
    for height, model, repeat in itertools.product(
        *(table[d].values for d in table["outcome"].dims)
    ):
        row = table.sel(height=height, track=model, repeat=repeat)
        rebuilt = Scenario.from_json(row["scenario"].item())
        assert rebuilt.identity == row["identity"].item()
        assert (rebuilt.robot.track, rebuilt.terrain) == (
            MODELS[model],
            c2d.terrains.step(height, friction=row["drawn_friction"].item()),
        )
        run = c2d.simulate(rebuilt, record="summary")
        assert run.outcome == row["outcome"].item()
        assert run.metrics == {name: row[name].item() for name in run.metrics}


def test_the_same_repeat_draws_the_same_numbers_in_every_cell(table: xr.Dataset) -> None:
    for name in ("approach", "track_phase", "speed", "friction"):
        drawn = table[f"drawn_{name}"]
        assert (drawn == drawn.isel(height=0, track=0)).all()
        assert len(set(drawn.isel(height=0, track=0).values.tolist())) == 3


def test_a_scaled_draw_varies_about_the_cells_own_value() -> None:
    found = quiet(BRIEF, {"drive.speed": [0.1, 0.3]})
    factors = found["drawn_speed"] / found["speed"]
    assert factors.sel(speed=0.1).values == pytest.approx(factors.sel(speed=0.3).values)
    assert (abs(factors - 1.0) <= 0.02).all()


def test_adding_a_varied_path_leaves_the_other_draws_alone() -> None:
    vary = {"start.approach": uniform(0.05, 0.15)}
    alone = quiet(BRIEF, {"terrain.height": [0.03]}, vary=vary)
    more = {"robot.mass": scaled(0.9, 1.1), **vary, "gravity": uniform(9.0, 10.0)}
    among = quiet(BRIEF, {"terrain.height": [0.03]}, vary=more)
    assert alone["drawn_approach"].equals(among["drawn_approach"])
    assert set(among.data_vars) - set(alone.data_vars) == {"drawn_mass", "drawn_gravity"}


def test_more_repeats_and_more_cells_leave_the_draws_alone() -> None:
    few = quiet(BRIEF, {"terrain.height": [0.03]}, repeats=2)
    more = quiet(BRIEF, {"terrain.height": [0.02, 0.03]}, repeats=4)
    again = more.sel(height=[0.03]).isel(repeat=slice(2))
    assert (few["identity"] == again["identity"]).all()


def test_another_seed_draws_other_numbers() -> None:
    seeds: list[Any] = [0, 1, 2**64 - 1, np.int64(0)]
    drawn = [quiet(BRIEF, {"duration": [0.0]}, seed=s)["drawn_approach"].values for s in seeds]
    assert drawn[0].tolist() == drawn[3].tolist()
    assert len({values.tobytes() for values in drawn}) == 3


def test_nothing_varied_repeats_the_same_run() -> None:
    found = quiet(BASE, {"terrain.height": [0.03, 0.05]}, repeats=3, vary={})
    assert c2d.rate(found)["distinct"].values.tolist() == [1, 1]
    assert len(set(found["identity"].values.ravel().tolist())) == 2
    assert not [name for name in found if str(name).startswith("drawn_")]
    assert found.attrs["vary"] == ""


def test_distinct_poses_are_counted_in_each_cell(table: xr.Dataset) -> None:
    distinct = c2d.rate(table)["distinct"]
    assert distinct.max() > 1
    for cell in itertools.product((0, 1), (0, 1)):
        at = table.isel(dict(zip(("height", "track"), cell, strict=True)))
        poses = {
            (round(x / 1e-3), round(y / 1e-3), round(a / np.radians(0.1)))
            for x, y, a in zip(
                at["final_x"].values, at["final_y"].values, at["final_angle"].values, strict=True
            )
        }
        assert distinct.values[cell] == len(poses)


def test_stops_have_their_mechanism_and_others_none(table: xr.Dataset) -> None:
    assert set(table["mechanism"].values.ravel().tolist()) <= {"", *c2d.Mechanism}
    cleared = table["outcome"] == "cleared"
    assert (table["mechanism"].where(cleared, "") == "").all()
    for name in ("symptom", "stop_bodies", "stop_carrier", "belly_side", "then_closed_track"):
        assert (table[name].where(cleared, "") == "").all(), name
    for name in ("jammed", "transient", "tried_closed_track", "freed_by_closed_track"):
        assert not table[name].where(cleared, False).any(), name
    assert table["stop_x"].where(cleared).isnull().all()
    assert "tried_torque_x2" not in table


def test_a_trial_that_was_asked_for_has_its_columns() -> None:
    seizing = BASE.replace({"terrain.height": 0.10, "duration": 8.0})
    models = {"line of 4": c2d.LineOfWheels(4), "skids": c2d.ForceTrack()}
    over = {"robot.track": models, "terrain.height": [0.02, 0.10]}
    found = quiet(seizing, over, trials=("friction x 2", "torque x 2"))
    stopped = found["outcome"].isin([str(o) for o in c2d.Outcome if o.is_stop])
    assert 0 < stopped.sum() < stopped.size
    for name in ("torque_x2", "friction_x2"):
        assert (found[f"tried_{name}"] == stopped).all()
        assert not (found[f"freed_by_{name}"] & ~stopped).any()
        assert ((found[f"then_{name}"] != "") == stopped).all()
    at_edge = found.sel(track="line of 4", height=0.10)
    assert at_edge["outcome"].values.tolist() == ["seized"] * 2
    assert at_edge["mechanism"].values.tolist() == ["straddled"] * 2
    assert at_edge["jammed"].values.all()
    assert at_edge["freed_by_closed_track"].values.all()
    assert at_edge["stop_bodies"].values.tolist() == ["1-2"] * 2
    assert at_edge["stop_carrier"].values.tolist() == ["chassis"] * 2
    assert at_edge["stop_side"].values.tolist() == ["both"] * 2
    assert at_edge["stop_edge"].values.tolist() == [1] * 2
    assert found["stop_x"].attrs["units"] == "m"
    # Trials change nothing else.
    plain = quiet(seizing, over)
    extra = [name for name in found if str(name).endswith(("torque_x2", "friction_x2"))]
    assert len(extra) == 6
    xr.testing.assert_identical(found.drop_vars(extra), plain)


def test_a_trial_that_was_asked_for_has_its_columns_though_nothing_stopped() -> None:
    found = quiet(BASE, {"terrain.height": [0.01]}, trials=("no belly",))
    assert found["freed_by_no_belly"].values.tolist() == [[False, False]]
    assert found["then_no_belly"].values.tolist() == [["", ""]]


def test_the_number_of_threads_does_not_change_the_table() -> None:
    tables = [quiet(BASE, {"robot.track": MODELS}, threads=threads) for threads in (1, 2, 3)]
    for other in tables[1:]:
        xr.testing.assert_identical(tables[0], other)


def test_computing_times_are_a_column_where_they_are_asked_for() -> None:
    found = quiet(BRIEF, {"terrain.height": [0.02, -0.1]}, wall_time=True, on_error="record")
    assert (found["wall_time"].sel(height=0.02) > 0.0).all()
    assert found["wall_time"].sel(height=-0.1).isnull().all()
    assert found["wall_time"].attrs["units"] == "s"
    without = quiet(BRIEF, {"terrain.height": [0.02, -0.1]}, on_error="record")
    xr.testing.assert_identical(found.drop_vars("wall_time"), without)


def test_a_sweep_over_nothing_repeats_the_one_scenario() -> None:
    found = quiet(BASE, {}, repeats=3)
    assert found["outcome"].dims == ("repeat",)
    axis = quiet(BASE, {"terrain.height": [0.03]}, repeats=3).isel(height=0, drop=True)
    xr.testing.assert_identical(found, axis)
    assert c2d.rate(found)["rate"].item() == 1.0
    vary = {"drive.speed": scaled(4.0, 4.0)}
    assert refusal(BASE, {}, vary=vary).path == "cell[repeat=0].drive.speed"


@pytest.mark.filterwarnings("ignore::crawler2d.ScenarioWarning")
def test_the_largest_friction_is_swept_with_its_own_draws() -> None:
    slippery = BRIEF.replace({"terrain.friction": 100.0})
    found = quiet(slippery, {"drive.speed": [0.4, 1.39]}, repeats=40)["drawn_friction"]
    assert found.max() == 100.0
    kept = (found == 100.0).mean("repeat")
    assert (abs(kept - 0.5) < 0.3).all()  # four standard errors of 40
    assert (found.min("repeat") < 98.5).all()
    speed = quiet(BRIEF, {"drive.speed": [0.4, 1.39]}, repeats=40)["drawn_speed"]
    assert speed.max("repeat").values.tolist() == [pytest.approx(0.408, rel=2e-3), 1.39]


def test_whole_numbers_are_drawn() -> None:
    field = Scenario(ROBOT, c2d.terrains.random_stepfield(0), duration=0.0)
    vary = {"terrain.seed": uniform_int(1, 1000), "drive.speed": scaled(0.9, 1.1)}
    found = quiet(field, {}, vary=vary, repeats=10)
    seeds = [json.loads(text)["terrain"]["seed"] for text in found["scenario"].values]
    assert found["drawn_terrain_seed"].values.tolist() == seeds
    assert len(set(seeds)) > 5
    assert "terrain.seed: UniformInt(low=1, high=1000)" in found.attrs["vary"]


@pytest.mark.parametrize("distribution", [uniform(1.0, 9.0), scaled(1.0, 2.0)])
def test_a_whole_number_is_not_drawn_between_two(distribution: Any) -> None:
    field = Scenario(ROBOT, c2d.terrains.random_stepfield(0), duration=0.0)
    error = refusal(field, {}, vary={"terrain.seed": distribution})
    assert error.path == "cell.terrain.seed"
    assert "uniform_int(low, high)" in error.rule
    wheels = BRIEF.replace({"robot.track": c2d.SegmentalTrack(shoe_count=None)})
    error = refusal(wheels, {}, vary={"robot.track.shoe_count": distribution})
    assert "uniform_int(low, high)" in error.rule


def test_an_element_is_drawn() -> None:
    found = quiet(BRIEF, {}, vary={"robot.center_of_mass[0]": uniform(-0.01, 0.01)}, repeats=4)
    texts = found["scenario"].values
    drawn = [Scenario.from_json(text).robot.center_of_mass[0] for text in texts]
    assert found["drawn_center_of_mass_0"].values.tolist() == drawn
    assert found["drawn_center_of_mass_0"].attrs["units"] == "m"
    over = {"robot.center_of_mass[0]": [0.0]}
    vary = {"robot.center_of_mass[0]": uniform(0.0, 0.1)}
    assert refusal(BRIEF, over, vary=vary).path == "vary['robot.center_of_mass[0]']"


def test_progress_is_shown_unless_refused(capsys: pytest.CaptureFixture[str]) -> None:
    sweep(BRIEF, {"terrain.height": [0.02, 0.03]}, repeats=2)
    assert "4 of 4 runs" in capsys.readouterr().err
    quiet(BRIEF, {"terrain.height": [0.02, 0.03]})
    assert capsys.readouterr().err == ""


def test_defaults_are_twenty_runs_a_cell_and_twenty_samples_of_unknowns() -> None:
    totals: list[int] = []

    def stop(_done: int, total: int) -> None:
        totals.append(total)
        raise KeyboardInterrupt

    several: list[Any] = [{}, {"unknown": {"robot.mass": scaled(0.9, 1.1)}}]
    for options in several:
        with pytest.raises((KeyboardInterrupt, c2d.BatchInterrupted)):
            sweep(BRIEF, {}, progress=stop, **options)
    assert (totals[0], totals[-1]) == (20, 400)
