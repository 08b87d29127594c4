"""The layouts for the paper's rows, and the settings of motors and friction."""

import warnings

import pytest

import crawler2d as c2d
from research import paper
from research.paper.design import PRESET, PUBLIC, READINGS, SETTINGS, STRONG, layouts
from research.paper.performance import ROWS
from research.paper.table_2 import COLUMNS, FIELDS

ROBOT = c2d.robots.engineer()


def test_every_layout_makes_a_valid_robot_in_every_setting() -> None:
    field = c2d.terrains.random_stepfield()
    with warnings.catch_warnings():
        warnings.simplefilter("error")  # no radius of an arm is overridden
        for layout in layouts().values():
            for setting in SETTINGS:
                c2d.Scenario(setting.on(layout.on(ROBOT)), field).validate()


def test_the_layouts_are_those_that_the_paper_names() -> None:
    known = layouts()
    chosen = {reading.row: known[reading.layout].track for reading in READINGS}
    small = chosen[paper.CWA_ROUND]
    assert small == c2d.CircumferentialWheels(16, wheel_radius=0.02)
    assert chosen[paper.LWA_ROUND] == c2d.LineOfWheels(3)
    # The small wheels were replaced one for one.
    gears = chosen[paper.CWA_GEAR]
    assert isinstance(gears, c2d.CircumferentialWheels)
    assert (gears.count, gears.wheel_radius) == (16, 0.02)
    assert chosen[paper.GEAR_MODEL] == c2d.LineOfWheels(3, wheel=c2d.GearWheel())
    assert chosen[paper.LWA_GEAR] == chosen[paper.GEAR_MODEL]
    assert all(reading.reason for reading in READINGS)


def test_every_row_and_column_of_the_paper_has_a_layout() -> None:
    assert set(ROWS) == {row.model for row in paper.TABLE_3}
    assert {paper.CWA_ROUND, paper.LWA_ROUND, paper.GEAR_MODEL} <= set(COLUMNS.values())
    assert list(FIELDS) == [row.obstacle for row in paper.TABLE_2]


def test_wheels_by_hand_and_touching_wheels_have_others_on_the_arms() -> None:
    for name in ("line of 4, touching", "hybrid", "hybrid gears"):
        robot = layouts()[name].on(ROBOT)
        assert robot.flippers is not None
        assert isinstance(robot.flippers.track, c2d.LineOfWheels)
    bare = layouts()["hybrid"].on(c2d.robots.engineer(flippers=None))
    assert bare.flippers is None


def test_the_preset_is_left_as_it_is() -> None:
    for layout in layouts().values():
        assert PRESET.on(layout.on(ROBOT)) == layout.on(ROBOT)
    assert PRESET.friction == c2d.terrains.random_stepfield().friction
    assert STRONG.on(ROBOT).drivetrain.max_torque == 10.0 * ROBOT.drivetrain.max_torque


def test_every_wheel_of_the_public_simulation_has_100_newton_metres() -> None:
    robot = PUBLIC.on(layouts()["line of 3"].on(ROBOT))
    wheels = robot.wheels()["side"].tolist().count("left")
    assert wheels == 6  # three on the chassis, three on the flipper
    assert robot.drivetrain.torque_sharing == "wheel"
    assert robot.drivetrain.max_torque / wheels == pytest.approx(100.0)
    belt = PUBLIC.on(layouts()["belt"].on(ROBOT)).drivetrain
    assert (belt.torque_sharing, belt.max_torque) == ("track", 100.0)
