"""Vibration and odometry of models: metrics of their runs, and closed forms."""

import math
from typing import Any

import numpy as np
import pytest

import crawler2d as c2d
from crawler2d.sweeps.axes import COLUMNS
from tests.shared import PLACEMENTS, ROBOT

FLAT = c2d.Scenario(ROBOT, c2d.terrains.flat())
STEP = c2d.Scenario(ROBOT, c2d.terrains.step(0.075))
BELT, ROUND = c2d.BeltTrack(), c2d.LineOfWheels(4)
GEARS = c2d.LineOfWheels(4, wheel=c2d.GearWheel())
HOW: dict[str, Any] = {"repeats": 2, "progress": False}


def test_a_ride_is_that_of_the_scenario_as_it_is() -> None:
    found = c2d.studies.ride(FLAT, models={"gears": GEARS}, vary={}, **HOW).squeeze("model")
    run = c2d.simulate(FLAT.replace({"robot.track": GEARS}), record="summary")
    told = run.metrics
    assert found["vibration"].item() == told["vertical_acceleration"]
    assert found["rocking"].item() == told["angular_velocity"]
    assert found["swing"].item() == told["max_angle"] - told["min_angle"]
    assert found["speed"].item() == told["path_length"] / told["time"]
    assert found["ended"].item() == run.outcome
    assert found["vibration_low"].item() == found["vibration_high"].item()


def test_gear_wheels_shake_where_belts_and_round_wheels_do_not() -> None:
    models = {"belt": BELT, "round": ROUND, "gears": GEARS}
    found = c2d.studies.ride(FLAT, models=models, **HOW)
    belt, wheels, gears = found["vibration"].values
    assert max(belt, wheels) < 0.02  # only the start shakes them
    assert gears > 1.0
    assert found["swing"].sel(model="gears") > 10 * found["swing"].sel(model="belt")


def test_outcomes_are_listed_by_model_and_sample() -> None:
    models = {"belt": BELT, "4 round": c2d.LineOfWheels(4, wheel_radius=0.0608)}
    found = c2d.studies.ride(STEP, models=models, **HOW)
    assert found["ended"].values.tolist() == ["cleared", "seized"]
    unknown = {"terrain.friction": c2d.uniform(0.1, 1.0)}
    quantile_band = c2d.studies.ride(STEP, unknown=unknown, samples=3, **HOW)
    assert quantile_band["ended"].dims == quantile_band["vibration"].dims == ("model", "sample")
    assert quantile_band["vibration_band_low"] <= quantile_band["vibration_band_high"]


def test_round_wheels_roll_on_their_radius() -> None:
    found = c2d.studies.odometry(FLAT, models={"round": ROUND, "belt": BELT}, **HOW)
    assert found["rolling_radius"].sel(model="round").item() == pytest.approx(0.064, rel=1e-6)
    assert math.isnan(found["rolling_radius"].sel(model="belt").item())  # it has no wheels
    assert (np.abs(found["odometry_error"]) < 1e-6).all()
    assert (np.abs(found["slip"]) < 1e-6).all()


def test_gear_wheels_roll_on_less_than_the_radius_of_their_tips() -> None:
    found = c2d.studies.odometry(FLAT, models={"gears": GEARS}, **HOW).squeeze("model")
    (tip,) = set(ROBOT.with_track(GEARS).wheels()["radius"].tolist())
    radius, error = found["rolling_radius"].item(), found["odometry_error"].item()
    assert tip - ROBOT.outline.grouser_height < radius < tip
    assert radius == pytest.approx(tip / (1.0 + error), rel=1e-3)  # medians of few repeats
    assert found["slip"].item() == pytest.approx(error / (1.0 + error), rel=1e-3)


def test_the_part_of_the_error_that_is_sliding_goes_away_with_friction() -> None:
    """A belt that is told to be fast at once slides until friction has brought it there: while it
    runs v t the robot makes a t^2 / 2, so it falls behind by v^2 / (2 mu g) in all."""
    speed, friction = 1.0, 0.2
    fields = {
        "robot.drivetrain.max_acceleration": 1e6,
        "robot.drivetrain.max_torque": 1e4,  # so that the belt reaches its speed at once
        "drive.speed": speed,
        "terrain.friction": friction,
        "terrain.length": 5.0,
    }
    base = FLAT.replace(fields)
    found = c2d.studies.odometry(base, vary={}, **HOW).squeeze("model")
    behind = (found["track_distance"] - found["path_length"]).isel(repeat=0)
    for change, factor in (("unchanged", 1.0), ("friction x 2", 2.0)):
        expected = speed**2 / (2.0 * factor * friction * 9.81)
        assert behind.sel(change=change).item() == pytest.approx(expected, rel=1e-3)
    before, after = found["odometry_error_with"].values
    assert before == found["odometry_error"].item()
    assert after == pytest.approx(0.5 * before, rel=0.1)  # the distances are not quite equal


@pytest.mark.parametrize("is_lane", [False, True])
def test_the_friction_of_every_segment_is_doubled(is_lane: bool) -> None:
    def ground(*frictions: float) -> Any:
        points = [(-2.0, 0.0), (0.1, 0.0), (4.0, 0.0)]
        one = c2d.terrains.from_points(points, goal=0.5, segment_friction=frictions)
        return c2d.terrains.lanes(one, one) if is_lane else one

    base = FLAT.replace({"terrain": ground(0.004, 0.008)})
    found = c2d.studies.odometry(base, vary={}, **HOW).squeeze("model").isel(repeat=0)
    doubled = c2d.simulate(base.replace({"terrain": ground(0.008, 0.016)}))
    distance = found["track_distance"].sel(change="friction x 2").item()
    assert distance == doubled.metrics["track_distance"]


@pytest.mark.parametrize("part", ["friction", "segment_friction[*]", "segment_friction[0]"])
def test_the_friction_that_is_drawn_is_doubled(part: str) -> None:
    points = [(-2.0, 0.0), (0.1, 0.0), (4.0, 0.0)]
    ground = c2d.terrains.from_points(points, goal=0.5, segment_friction=[0.9, 0.004])
    drawn = {f"terrain.{part}": c2d.uniform(0.004, 0.004)}
    base = FLAT.replace({"terrain": ground})
    for given in ({"vary": drawn}, {"vary": {}, "unknown": drawn, "samples": 1}):
        found = c2d.studies.odometry(base, **given, **HOW).squeeze("model").isel(repeat=0)
        doubled = c2d.simulate(base.replace({"terrain.segment_friction": [0.008, 0.008]}))
        distance = found["track_distance"].sel(change="friction x 2").item()
        assert distance == doubled.metrics["track_distance"]


def test_wheels_of_several_radii_have_no_single_rolling_radius() -> None:
    mixed = c2d.HybridWheels(PLACEMENTS)
    found = c2d.studies.odometry(FLAT, models={"mixed": mixed}, **HOW)
    assert math.isnan(found["rolling_radius"].item())
    assert np.isfinite(found["odometry_error"].item())


def test_a_robot_that_does_not_move_has_no_odometry() -> None:
    found = c2d.studies.odometry(FLAT.replace({"drive.speed": 0.0, "duration": 1.0}), **HOW)
    assert math.isnan(found["odometry_error"].item())


def test_no_figure_has_the_name_of_a_column_of_the_runs() -> None:
    metrics = set(c2d.simulate(FLAT, duration=0.1, record="summary").metrics)
    for found in (c2d.studies.ride(FLAT, **HOW), c2d.studies.odometry(FLAT, **HOW)):
        runs = {"identity", "outcome", "error", *metrics}
        assert all(found[name].dims == found["outcome"].dims for name in runs)
        figures = {str(name)[:-5] for name in found if str(name).endswith("_each")}
        assert figures.isdisjoint({*COLUMNS, *metrics})


def test_the_figure_is_of_the_measure_that_is_asked_for() -> None:
    from matplotlib import pyplot as plt  # noqa: PLC0415

    found = c2d.studies.ride(STEP, models={"belt": BELT}, **HOW)
    assert found.plot().get_xlabel() == "vertical acceleration, root mean square [m/s^2]"
    ax = found.plot(of="swing")
    assert ax.get_xlabel() == "swing of the chassis angle [deg]"
    assert [text.get_text() for text in ax.texts] == ["cleared"]
    error = c2d.studies.odometry(FLAT, models={"gears": GEARS}, **HOW).plot()
    assert [line.get_label() for line in error.get_lines()][:2] == ["unchanged", "friction x 2"]
    plt.close("all")


def test_invalid_arguments_are_refused_by_name() -> None:
    for how, path in (({"until": 3}, "until"), ({"repeats": 1.5}, "repeats"), ({"k": 1}, "k")):
        for study in (c2d.studies.ride, c2d.studies.odometry):
            with pytest.raises(c2d.ScenarioError) as caught:
                study(FLAT, **{**HOW, **how})
            assert caught.value.path == path
