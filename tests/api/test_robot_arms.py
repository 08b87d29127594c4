"""Adding and removing arms changes the mass, and a field that keeps them says so."""

import dataclasses
import math
import warnings
from typing import Any

import pytest

import crawler2d as c2d

ARMS = c2d.Flippers(
    length=0.34, root_radius=0.064, tip_radius=0.037, mass=0.775, ends="both", torque_limit=30.0
)
BARE = c2d.robots.engineer(flippers=None)


def masses(robot: c2d.Robot) -> list[float]:
    return [robot.mass, *robot.center_of_mass, robot.moment_of_inertia]


@pytest.mark.parametrize("ends", ["front", "rear", "both"])
def test_arms_that_come_off_leave_the_robot_that_they_were_put_on(ends: Any) -> None:
    arms = dataclasses.replace(ARMS, ends=ends)
    armed = BARE.with_flippers(arms)
    assert armed.flippers == arms
    bare = armed.without_flippers()
    assert bare.flippers is None
    assert masses(bare) == pytest.approx(masses(BARE), rel=1e-13, abs=1e-15)


@pytest.mark.parametrize("ends", ["front", "rear", "both"])
def test_arms_count_as_uniform_rods_at_angle_0(ends: Any) -> None:
    """Moments summed over many small pieces of chassis and rods: the sum errs by 1 / pieces^2."""
    armed = BARE.with_flippers(dataclasses.replace(ARMS, ends=ends))
    pieces, (x, y) = 2000, BARE.center_of_mass
    rods = [
        side * (0.5 * BARE.outline.axle_distance + ARMS.length * (n + 0.5) / pieces)
        for side in {"front": (1,), "rear": (-1,), "both": (1, -1)}[ends]
        for n in range(pieces)
    ]
    piece = 2.0 * ARMS.mass / pieces
    mass = BARE.mass + piece * len(rods)
    center = (BARE.mass * x + piece * sum(rods)) / mass, BARE.mass * y / mass
    inertia = BARE.moment_of_inertia
    inertia += BARE.mass * ((x - center[0]) ** 2 + (y - center[1]) ** 2)
    inertia += sum(piece * ((rod - center[0]) ** 2 + center[1] ** 2) for rod in rods)
    assert masses(armed) == pytest.approx([mass, *center, inertia], rel=1e-6)


def test_arms_take_the_place_of_those_that_were_there() -> None:
    longer = dataclasses.replace(ARMS, length=0.4)
    expected = masses(BARE.with_flippers(longer))
    swapped = BARE.with_flippers(ARMS).with_flippers(longer)
    assert swapped.flippers == longer
    assert masses(swapped) == pytest.approx(expected, rel=1e-13, abs=1e-15)


def test_no_preset_but_the_engineer_weighs_more_bare_than_its_arms_leave() -> None:
    """The Engineer without arms is the robot of the studies, with the mass of the whole robot."""
    for name in c2d.robots.__all__:
        make = getattr(c2d.robots, name)
        bare, taken = make(flippers=None), make().without_flippers()
        if name == "engineer":
            assert bare.mass == make().mass > taken.mass
        else:
            assert masses(taken) == pytest.approx(masses(bare), rel=1e-12, abs=1e-15)


def test_a_robot_without_arms_is_without_arms() -> None:
    assert BARE.without_flippers() is BARE


@pytest.mark.parametrize(
    ("fields", "path"),
    [
        ({"mass": 6.0}, "robot.flippers.mass"),
        ({"mass": math.nan}, "robot.flippers.mass"),
        ({"mass": "heavy"}, "robot.flippers.mass"),
        ({"length": None}, "robot.flippers.length"),
        ({"ends": "left"}, "robot.flippers.ends"),
    ],
)
def test_arms_that_cannot_be_taken_off_are_refused(fields: dict[str, Any], path: str) -> None:
    with pytest.raises(c2d.ScenarioError) as caught:
        dataclasses.replace(BARE, flippers=dataclasses.replace(ARMS, **fields)).without_flippers()
    assert caught.value.path == path


def test_flippers_set_to_none_say_that_their_mass_stays() -> None:
    scenario = c2d.Scenario(c2d.robots.engineer(), c2d.terrains.flat())
    with pytest.warns(c2d.ScenarioWarning, match=r"leaves their mass .*without_flippers"):
        variant = scenario.replace({"robot.flippers": None})
    assert variant.robot.mass == scenario.robot.mass
    with pytest.warns(c2d.ScenarioWarning):
        scenario.replace({"robot": dataclasses.replace(scenario.robot, flippers=None)})
    with pytest.warns(c2d.ScenarioWarning):
        c2d.sweep(scenario, {"robot.flippers": [None]}, repeats=1, progress=False)


def test_other_ways_of_taking_flippers_off_say_nothing() -> None:
    robot = c2d.robots.engineer()
    scenario = c2d.Scenario(robot, c2d.terrains.flat())
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        scenario.replace({"robot": robot.without_flippers()})
        scenario.replace({"robot": BARE})
        scenario.replace({"robot.flippers": None, "robot.mass": 19.65})
        scenario.replace({"robot.flippers": ARMS})
        bare = c2d.Scenario(BARE, c2d.terrains.flat())
        bare.replace({"robot.flippers": None, "drive.speed": 0.2})


def test_robots_with_and_without_arms_are_swept_under_their_labels() -> None:
    robot = c2d.robots.absolem()
    scenario = c2d.Scenario(
        robot, c2d.terrains.step(0.2), drive=c2d.Drive(gait=c2d.Climb()), duration=8.0
    )
    robots = {"with arms": robot, "without": robot.without_flippers()}
    table = c2d.sweep(scenario, {"robot": robots}, repeats=2, progress=False)
    assert table.sizes == {"robot": 2, "repeat": 2}
    assert table.robot.values.tolist() == ["with arms", "without"]
    assert set(table.outcome.sel(robot="with arms").values) == {"cleared"}
    assert "cleared" not in table.outcome.sel(robot="without").values
    written = c2d.Scenario.from_json(table.scenario.sel(robot="without", repeat=0).item())
    assert written.robot == robots["without"]
