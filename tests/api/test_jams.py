"""All jams of a layout, and the chart of where it can jam."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from matplotlib.collections import LineCollection

import crawler2d as c2d
from crawler2d import studies
from crawler2d.runs.jams import Jam
from tests.shared import with_flippers

ENGINEER = c2d.robots.engineer(flippers=None)
WHEELS = ENGINEER.with_track(c2d.LineOfWheels(4, wheel_radius=0.0608))
STEP = c2d.terrains.step(0.075)


def caught(found: tuple[Jam, ...]) -> list[Jam]:
    return [jam for jam in found if jam.stable and not jam.belt_holds]


def test_the_stop_of_a_run_is_a_jam_with_the_loads_of_its_diagnosis() -> None:
    run = c2d.simulate(WHEELS.without_rotors(), STEP)
    assert run.diagnosis is not None
    (jam,) = caught(c2d.jams(WHEELS.without_rotors(), STEP))
    assert jam.position == pytest.approx(run.position[-1], abs=1e-5)
    assert jam.chassis_angle == pytest.approx(run.chassis_angle[-1], abs=1e-5)
    assert jam.between == (1, 2)
    loads = {contact.body: contact.normal_force for contact in jam.contacts}
    assert (round(loads[1]), round(loads[2])) == (112, 40)  # as in its sentence
    assert "112 N" in str(run.diagnosis)
    assert "40 N" in str(run.diagnosis)
    assert jam.depth == pytest.approx(0.021, abs=5e-4)
    assert "21 mm of ground between wheels 1 and 2" in str(jam)


def test_stability_does_not_depend_on_the_place_of_the_ground() -> None:
    robot = WHEELS.with_track(c2d.LineOfWheels(3, wheel_radius=0.05)).without_rotors()
    robot = replace(robot, center_of_mass=(0.0, 0.02))
    draw = np.random.default_rng(0)
    ends = np.cumsum(draw.uniform(0.03, 0.15, 8))
    x = np.array([-3.0, 0.0, *ends, ends[-1] + 0.05, ends[-1] + 4.0])
    y = np.array([0.0, 0.0, *draw.uniform(0.0, 0.1, 8), 0.0, 0.0])
    found = []
    for shift in (0.0, 0.1, 0.13, 0.29, 0.37, 0.5):
        points = np.column_stack([x + shift, y])
        ground = c2d.terrains.from_points(points, goal=ends[-1] + 3.0 + shift, friction=0.7)
        jams = c2d.jams(robot, ground)
        found.append([(round(jam.position[0] - shift, 5), jam.stable) for jam in jams])
    assert len(found[0]) == 10
    assert all(each == found[0] for each in found), found


def test_friction_is_taken_from_the_call() -> None:
    high = c2d.terrains.step(0.1)
    assert caught(c2d.jams(WHEELS, high, friction=1.1))
    assert not caught(c2d.jams(WHEELS, high, friction=1.3))
    with pytest.raises(c2d.ScenarioError, match=r"terrain.friction must be > 0"):
        c2d.jams(WHEELS, STEP, friction=0.0)


def test_other_fields_of_the_scenario_are_taken_from_the_call() -> None:
    bar, back = c2d.terrains.barrier(0.1, 0.2), c2d.Drive(speed=-0.4)
    found = c2d.jams(WHEELS, bar, drive=back)
    assert caught(found)
    assert found == c2d.jams(c2d.Scenario(WHEELS, bar, drive=back))
    assert found != c2d.jams(WHEELS, bar)


def test_a_belt_is_held_where_it_slips_before_a_wall() -> None:
    low = c2d.jams(WHEELS, c2d.terrains.step(0.1), friction=0.4)
    assert any(jam.belt_holds for jam in low)
    belt = c2d.jams(ENGINEER, c2d.terrains.step(0.1), friction=0.4)
    assert any(jam.stable and jam.between is None for jam in belt)


def test_a_belt_runs_round_wheels_on_flippers_too() -> None:
    arms = c2d.LineOfWheels(2, wheel_radius=0.06)
    robot = with_flippers(c2d.BeltTrack(), arms, ends="front")
    held = caught(c2d.jams(robot, c2d.terrains.knife_edge(0.05), friction=0.6))
    assert [(jam.between, jam.belt_holds) for jam in held] == [((1, 2), False)]
    base = c2d.Scenario(robot, c2d.terrains.knife_edge(0.05))
    chart = studies.jam_chart(base, values=[0.05])
    assert chart["belt_high"].max() < chart["high"].max()


@pytest.mark.parametrize(
    "track",
    [
        c2d.LineOfWheels(3, wheel=c2d.GearWheel()),
        c2d.GrouserBeltTrack(),
        c2d.SegmentalTrack(),
        c2d.ForceTrack(),
    ],
)
def test_other_tracks_are_refused_by_name(track: Any) -> None:
    with pytest.raises(c2d.ScenarioError, match=r"robot\.track must"):
        c2d.jams(ENGINEER.with_track(track), STEP)


def test_wrong_arguments_are_named() -> None:
    with pytest.raises(c2d.ScenarioError, match="terrain must be given"):
        c2d.jams(WHEELS)
    with pytest.raises(TypeError, match="frction"):
        c2d.jams(WHEELS, STEP, frction=0.5)
    base = c2d.Scenario(WHEELS, STEP)
    with pytest.raises(c2d.ScenarioError, match="values must be one number or more"):
        studies.jam_chart(base, values=[0.1, 0.1])
    with pytest.raises(c2d.ScenarioError, match="values must be given"):
        studies.jam_chart(base, x="terrain.edge_radius")
    with pytest.raises(c2d.ScenarioError, match="most_friction must"):
        studies.jam_chart(base, values=[0.1], most_friction=0.0)


def test_the_chart_has_each_jam_at_its_frictions_and_draws_itself() -> None:
    base = c2d.Scenario(WHEELS, STEP)
    models: dict[str, Any] = {"wheels": {}, "belt": c2d.BeltTrack()}
    chart = studies.jam_chart(base, models=models, values=[0.05, 0.075, 0.1])
    assert chart["low"].dims == ("model", "height", "jam")
    for height in (0.05, 0.075, 0.1):
        found = caught(c2d.jams(WHEELS, c2d.terrains.step(height), friction=0.7))
        (jam,) = (jam for jam in found if jam.between == (1, 2))
        own = chart.sel(model="wheels", height=height)
        same = abs(own["position"] - jam.position[0]) < 1e-7
        assert same.sum() == 1
        at = same.to_numpy().tolist().index(True)
        assert own["low"][at] <= 0.7 <= own["high"][at]
        assert (int(own["rear"][at]), int(own["front"][at])) == (1, 2)
    belt = chart.sel(model="belt")
    assert belt["rear"].max() == -1
    ax = chart.sel(model="wheels").plot()
    legend = ax.get_legend()
    assert legend is not None
    labels = [text.get_text() for text in legend.get_texts()]
    assert "between wheels 1 and 2" in labels
    with pytest.raises(c2d.ScenarioError, match="model"):
        chart.plot()


def test_a_chart_over_a_field_that_is_called_as_one_of_its_figures_has_its_whole_path() -> None:
    base = c2d.Scenario(WHEELS, c2d.terrains.ramp(0.3))
    models: dict[int, Any] = {4: {}, 5: c2d.LineOfWheels(5)}
    chart = studies.jam_chart(base, models=models, x="terrain.angle", values=[0.3, 0.4])
    assert chart["low"].dims == ("model", "terrain_angle", "jam")
    assert chart["model"].values.tolist() == [4, 5]
    assert chart.sel(model=4).plot().get_xlabel().startswith("angle")


def test_a_chart_of_one_height_has_a_line_for_each_way_to_jam() -> None:
    chart = studies.jam_chart(c2d.Scenario(WHEELS, STEP), values=[0.1])
    ax = chart.plot()
    lines = [each for each in ax.collections if isinstance(each, LineCollection)]
    legend = ax.get_legend()
    assert legend is not None
    assert len(lines) == len(legend.get_texts()) > 2
    drawn = [piece[:, 1].tolist() for each in lines for piece in each.get_segments()]
    assert max(high for _, high in drawn) == chart["high"].max()
    left, right = ax.get_xlim()
    assert left < 100.0 < right
    part = studies.jam_chart(c2d.Scenario(WHEELS, STEP), values=[0.05, 0.1]).sel(height=0.1).plot()
    assert part.get_xlim() == (left, right)


def test_a_jam_is_as_stable_from_the_other_side() -> None:
    center, y = -0.028990373280418303, 0.02925526974438475
    wheels = (
        (-0.14664876062346033, -0.019300167459467738, 0.04553320202455023),
        (-0.07496518035974212, -0.009734779148554345, 0.020302882621384438),
        (0.12021449155323499, -0.019955941886126337, 0.03919373903204299),
    )
    height, end, friction = 0.09598035740925721, 0.20155079961909686, 0.789920881293209
    corners = [(-3.0, 0.0), (0.0, 0.0), (0.0, height), (end, height), (end, 0.0), (3.0, 0.0)]
    found = []
    for sign in (1, -1):
        placed = c2d.HybridWheels(tuple((sign * x, y, r) for x, y, r in wheels[::sign]))
        robot = c2d.robots.engineer(flippers=None).without_rotors().with_track(placed)
        robot = replace(robot, center_of_mass=(sign * center, y), belly=None)
        points = [(sign * x, y) for x, y in corners[::sign]]
        ground = c2d.terrains.from_points(points, goal=0.0, friction=friction)
        jams = c2d.jams(robot, ground, drive=c2d.Drive(speed=0.3 * sign))
        found.append({round(sign * jam.position[0], 6): jam.stable for jam in jams})
    assert len(found[0]) > 1
    assert found[0] == found[1]
