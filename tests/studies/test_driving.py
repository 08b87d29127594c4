"""Speed, acceleration and braking distance of a belt in closed form, and their limits."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import crawler2d as c2d
from crawler2d.studies.driving import FRICTION, TORQUE, UNCHANGED, limiting_changes
from crawler2d.sweeps.axes import COLUMNS
from crawler2d.sweeps.store import stored_rows
from tests.shared import ROBOT

STUDIES = c2d.studies
G, V, SLOPE = 9.81, 1.39, 0.2
DRIVETRAIN = "robot.drivetrain."
PHASE = {"start.track_phase": c2d.uniform(0.0, 0.048)}
HOW: dict[str, Any] = {"repeats": 2, "vary": PHASE, "progress": False}

FLAT = c2d.Scenario(ROBOT, c2d.terrains.flat(friction=0.5))
AT_ONCE = FLAT.replace({f"{DRIVETRAIN}max_acceleration": 1e4, f"{DRIVETRAIN}max_deceleration": 1e4})
UPHILL = AT_ONCE.replace({"terrain": c2d.terrains.ramp(SLOPE, friction=0.5)})
WEAK = {f"{DRIVETRAIN}max_torque": 1.0, "terrain.friction": 0.9}
PUSH = 2.0 * 1.0 / (0.064 - 0.012)  # [N] of both sprockets at the belt radius
INERTIA = 21.2 + 2.4  # [kg] the track moves with the robot, and round its outline besides
EXACT = 1e-4  # solver and softness of the contacts: at most 3e-6 was observed


def test_a_belt_with_ample_force_reaches_the_commanded_speed() -> None:
    found = STUDIES.max_speed(FLAT, **HOW)
    assert found["speed"].item() == pytest.approx(V, rel=EXACT)
    assert found["limit"].item() == "command"
    with_change = found["speed_with"].squeeze("model").to_series()
    assert with_change["command x 2"] == pytest.approx(2.0 * V, rel=EXACT)
    assert with_change["torque x 2"] == pytest.approx(V, rel=EXACT)
    assert (found["ended"] == "timed_out").all()
    slow = STUDIES.max_speed(FLAT, speed=0.3, **HOW)
    assert slow["speed"].item() == pytest.approx(0.3, rel=EXACT)


def test_inputs_of_the_drivetrain_come_back_as_limits_by_the_command() -> None:
    found = STUDIES.acceleration(FLAT, **HOW)
    assert found["acceleration"].item() == pytest.approx(0.2, rel=EXACT)
    assert found["limit"].item() == "command"
    assert "an input" in found["limit"].attrs["command"]
    assert "max_acceleration" in found["limit"].attrs["command"]
    braking = STUDIES.braking_distance(FLAT, **HOW)
    assert braking["braking_distance"].item() == pytest.approx(V**2 / (2 * 4.0), rel=EXACT)
    assert braking["speed"].item() == pytest.approx(V, rel=EXACT)
    assert braking["limit"].item() == "command"
    assert "max_deceleration" in braking["limit"].attrs["command"]


CASES = {
    "friction": (AT_ONCE, {}, 0.5 * G, 0.5 * G),
    "torque": (AT_ONCE, WEAK, PUSH / INERTIA, PUSH / INERTIA),
    "friction on a slope": (
        UPHILL,
        {},
        G * (0.5 * math.cos(SLOPE) - math.sin(SLOPE)),
        G * (0.5 * math.cos(SLOPE) + math.sin(SLOPE)),
    ),
    "torque on a slope": (
        UPHILL,
        {f"{DRIVETRAIN}max_torque": 2.0, "terrain.friction": 0.9},
        (2.0 * PUSH - 21.2 * G * math.sin(SLOPE)) / INERTIA,
        (2.0 * PUSH + 21.2 * G * math.sin(SLOPE)) / INERTIA,
    ),
}


@pytest.mark.parametrize("case", CASES)
def test_the_first_limit_reached_limits_acceleration_and_braking(case: str) -> None:
    base, fields, gain, loss = CASES[case]
    faster = STUDIES.acceleration(base.replace(fields), **HOW)
    assert faster["acceleration"].item() == pytest.approx(gain, rel=EXACT)
    assert faster["limit"].item() == case.partition(" ")[0]
    stop = STUDIES.braking_distance(base.replace(fields), **HOW)
    assert stop["braking_distance"].item() == pytest.approx(V**2 / (2.0 * loss), rel=EXACT)
    assert stop["limit"].item() == case.partition(" ")[0]


@pytest.mark.parametrize(
    ("before", "torque", "friction", "expected"),
    [
        ((1.0, 1.0), (1.015, 1.015), (1.03, 1.03), "friction"),  # a share of 0.02 is needed
        ((0.9, 1.1), (1.0, 1.3), (1.2, 1.3), "friction"),  # and more than the spread of repeats
        ((0.0, 0.0), (0.005, 0.005), (0.2, 0.2), "friction"),  # and a value at all
        ((1.0, 1.0), (1.5, 1.5), (2.0, 2.0), "torque and friction"),
        ((1.0, 1.0), (0.5, 0.5), (1.0, 1.0), "none of these"),  # this worsens it
        ((1.0, math.nan), (1.0, 1.0), (math.nan, math.nan), "torque"),
    ],
)
def test_a_limit_improves_the_median_by_more_than_chance(
    before: Any, torque: Any, friction: Any, expected: str
) -> None:
    values = np.array([before, torque, friction])[None, :, None, :]
    changes = (UNCHANGED, TORQUE, FRICTION)
    assert limiting_changes(values, changes, fraction=0.02, least=0.01).tolist() == [[expected]]
    assert limiting_changes(-values, changes, fraction=0.02, least=0.01, falls=True).tolist() == [
        [expected]
    ]


def test_where_two_limits_meet_neither_alone_is_one() -> None:
    both = AT_ONCE.replace({f"{DRIVETRAIN}max_acceleration": 0.5 * G})
    assert STUDIES.acceleration(both, **HOW)["limit"].item() == "none of these"


def test_a_robot_that_slides_down_has_no_figure_and_names_its_limit() -> None:
    ice = UPHILL.replace({"terrain.friction": 0.15})  # less than the tangent, twice is more
    for study, name in (
        (STUDIES.max_speed, "speed"),
        (STUDIES.acceleration, "acceleration"),
        (STUDIES.braking_distance, "braking_distance"),
    ):
        found = study(ice, **HOW)
        assert math.isnan(found[name].item())
        assert found["limit"].item() == "friction"
        ended = found["ended"].squeeze("model").to_series()
        assert ended["unchanged"] == "not settled"
        assert ended["friction x 2"] == "timed_out"


def test_a_robot_that_falls_over_has_no_figure() -> None:
    tall = AT_ONCE.replace({"robot.center_of_mass": (0.0, 0.4), "terrain.friction": 0.9})
    found = STUDIES.acceleration(tall, **HOW)
    assert math.isnan(found["acceleration"].item())
    assert found["ended"].sel(change="unchanged").item() == "tipped_over"


def test_unknowns_are_doubled_as_drawn() -> None:
    unknown = {
        "terrain.friction": c2d.uniform(0.3, 0.5),
        f"{DRIVETRAIN}max_torque": c2d.scaled(0.9, 1.1),
    }
    vary = PHASE | {"terrain.friction": c2d.scaled(0.99, 1.01)}
    found = STUDIES.acceleration(
        AT_ONCE, unknown=unknown, samples=3, **{**HOW, "vary": vary}
    ).squeeze("model")
    friction = found["unknown_friction"].isel(part=0)
    unchanged, twice = (friction.sel(change=name) for name in ("unchanged", "friction x 2"))
    assert twice.values.tolist() == (2.0 * unchanged).values.tolist()
    drawn = found["drawn_friction"].isel(part=0)
    again = (2.0 * drawn.sel(change="unchanged")).values.tolist()
    assert drawn.sel(change="friction x 2").values.tolist() == again
    # Of two repeats with equal chances, the median is their mean.
    expected = G * drawn.sel(change="unchanged").mean("repeat")
    assert found["acceleration"].values == pytest.approx(expected.values, rel=EXACT)
    assert found["limit"].values.tolist() == ["friction"] * 3
    low, high = found["acceleration_band_low"].item(), found["acceleration_band_high"].item()
    assert found["acceleration"].min() <= low < high <= found["acceleration"].max()
    assert "terrain.friction" in found.attrs["unknown"]


def test_the_figures_are_those_of_the_runs_in_the_table() -> None:
    found = STUDIES.max_speed(FLAT, **HOW).squeeze("model")
    ways, times = found["path_length"], found["time"]
    first, last = ({"part": name} for name in ("run-up", "two windows"))
    speed = (ways.sel(last) - ways.sel(first)) / (times.sel(last) - times.sel(first))
    assert np.allclose(speed, found["speed_with_each"], rtol=1e-12)
    assert found["speed_low"].item() == found["speed_each"].min().item()
    assert found.attrs["runs"] == 4 * 3 * 2
    assert found.attrs["repeats"] == 2
    alone = c2d.simulate(
        c2d.Scenario.from_json(found["scenario"].values[0, 2, 1]), record="summary"
    )
    assert alone.metrics["path_length"] == ways.values[0, 2, 1]


def test_no_figure_has_the_name_of_a_column_of_the_runs() -> None:
    run = c2d.simulate(FLAT, duration=0.1, record="summary")
    columns = {*COLUMNS, *run.metrics}
    for study in (STUDIES.max_speed, STUDIES.acceleration, STUDIES.braking_distance):
        found = study(FLAT, **HOW)
        names = {str(name) for name in found if "part" not in found[name].dims}
        assert columns.isdisjoint(names)


def test_the_commanded_speed_is_not_varied() -> None:
    given = c2d.variability.of_start() | c2d.variability.of_contact()
    for vary in (None, given):
        found = STUDIES.max_speed(FLAT, **{**HOW, "vary": vary})
        assert "drive.speed" not in found.attrs["vary"]
        assert "start.approach" in found.attrs["vary"]
        assert found["speed_high"].item() == pytest.approx(V, rel=EXACT)


def test_a_store_keeps_the_runs(tmp_path: Path) -> None:
    store = tmp_path / "a.sqlite"
    first = STUDIES.braking_distance(FLAT, store=store, **HOW)
    kept = len(list(stored_rows(store)))
    assert kept == first.attrs["runs"]
    again = STUDIES.braking_distance(FLAT, store=store, **HOW)
    assert again.drop_vars("wall_time").identical(first.drop_vars("wall_time"))
    STUDIES.max_speed(FLAT, store=store, **HOW)  # its runs are the first ones of the other
    extra = len(list(stored_rows(store))) - kept
    assert extra == 3 * 2  # those at twice the speed


def test_invalid_arguments_are_refused_by_name() -> None:
    cases: list[tuple[dict[str, Any], str]] = [
        ({"speed": 0.0}, "speed"),
        ({"speed": 2.0}, "drive.speed"),
        ({"repeats": 0}, "repeats"),
        ({"until": c2d.Until()}, "until"),
        ({"models": {"a": {"drive.speed": 0.2}}}, "models['a']"),
        ({"vary": {"drive.speed": c2d.uniform(0.1, 0.2)}}, "vary['drive.speed']"),
        (
            {"unknown": {f"{DRIVETRAIN}max_speed": c2d.uniform(0.4, 1.4)}},
            f"unknown['{DRIVETRAIN}max_speed']",
        ),
    ]
    for how, path in cases:
        with pytest.raises(c2d.ScenarioError) as caught:
            STUDIES.max_speed(FLAT, **{**HOW, **how})
        assert caught.value.path == path
    with pytest.raises(c2d.ScenarioError, match="level ground or a ramp"):
        STUDIES.max_speed(FLAT.replace({"terrain": c2d.terrains.step(0.05)}), **HOW)


def test_the_figure_shows_every_model_with_its_limit() -> None:
    from matplotlib import pyplot as plt  # noqa: PLC0415

    models = {"as built": {}, "on ice": {"terrain.friction": 0.01}}
    found = STUDIES.acceleration(FLAT, models=models, **HOW)
    ax = found.plot()
    assert [label.get_text() for label in ax.get_yticklabels()] == list(models)
    assert ax.get_xlabel() == "mean acceleration from rest [m/s^2]"
    assert "track phase" in ax.get_title(loc="left")
    written = [text.get_text() for text in ax.texts]
    assert written == ["limit: command", "limit: friction"]
    shown = [line.get_label() for line in ax.get_lines()]
    assert shown == ["unchanged", "command x 2", "torque x 2", "friction x 2"]
    _, own = plt.subplots()
    assert found.sel(model="on ice").plot(own) is own
    alone = found.sel(change="unchanged").plot()
    assert [line.get_label() for line in alone.get_lines()] == ["unchanged"]
    with pytest.raises(c2d.ScenarioError, match="acceleration, acceleration_with, speed"):
        found.plot(of="height")
    plt.close("all")
