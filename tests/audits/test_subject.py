"""What an audit takes from a robot and its file: obstacles, ranges, names of wheels, the drive."""

import math
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

import crawler2d as c2d
from crawler2d.audits import words
from crawler2d.audits.record import bodies_per_side, names_of
from crawler2d.audits.runs import raise_flippers, scenario_of
from crawler2d.audits.subject import standard_obstacles, unknown_of_file
from tests.audits.seizing import SEIZING
from tests.reading.carts import FILES, WHEELS, quietly, read, urdf

# Standard obstacles


def test_standard_obstacles_grow_with_the_robot() -> None:
    small = standard_obstacles(SEIZING, 0.8)
    outline = SEIZING.outline
    large = replace(
        SEIZING, outline=replace(outline, axle_distance=3.65, front_radius=0.64, rear_radius=0.64)
    )
    for a, b in zip(small.values(), standard_obstacles(large, 0.8).values(), strict=True):
        for name in ("height", "rise", "width", "thickness", "post", "edge_radius"):
            if hasattr(a, name):
                assert getattr(b, name) == pytest.approx(10.0 * getattr(a, name))
        assert getattr(a, "friction") == getattr(b, "friction") == 0.8  # noqa: B009


def test_a_raised_idler_makes_no_small_obstacles() -> None:
    discs = ((-0.3, 0.0, 0.1), (0.25, 0.0, 0.1), (0.4, 0.1, 0.04))
    outline = replace(SEIZING.outline, discs=discs)
    robot = replace(SEIZING, outline=outline).with_track(c2d.BeltTrack())
    found = standard_obstacles(robot, 0.8)
    assert list(found)[:2] == ["step 100 mm", "step 160 mm"]  # 0.5 and 0.8 of 0.1 + 0.1 m


def test_with_flippers_there_is_a_higher_step() -> None:
    assert (
        len(standard_obstacles(c2d.robots.absolem(), 0.8))
        == len(standard_obstacles(SEIZING, 0.8)) + 1
    )


def test_a_closed_track_clears_them() -> None:
    """The highest are close to the limit of a rigid belt, which is not strong without flippers."""
    robot = c2d.robots.absolem()
    ends = []
    for ground in standard_obstacles(robot, 0.9).values():
        scenario = scenario_of(robot, ground, None, None)
        ends.append(str(c2d.simulate(scenario, record="summary").outcome))
    assert ends == ["cleared"] * len(ends)


# Unknowns


def test_stated_figures_of_a_file_have_narrow_ranges(tmp_path: Path) -> None:
    reading = read(tmp_path, urdf(WHEELS))
    found = unknown_of_file(reading, {0.5: 0.5, 1.0: 1.0})
    assert found["robot.drivetrain.max_torque"] == c2d.scaled(0.9, 1.1)
    assert found["terrain.friction"] == c2d.uniform(0.5, 1.0)
    assert "cart.urdf" in found.sources["robot.drivetrain.max_torque"]


def test_estimated_figures_of_a_file_have_wide_ranges(tmp_path: Path) -> None:
    reading = read(tmp_path, urdf(WHEELS.replace('<limit effort="5" velocity="10"/>', "")))
    found = unknown_of_file(reading, None)
    assert found["robot.drivetrain.max_torque"] == c2d.scaled(0.5, 2.0)
    assert found.sources["robot.drivetrain.max_torque"].startswith("estimate")


def test_a_floor_that_is_given_is_known(tmp_path: Path) -> None:
    reading = read(tmp_path, urdf(WHEELS), ground_friction=0.7)
    assert unknown_of_file(reading, None)["terrain.friction"] == c2d.scaled(0.9, 1.1)


# Names of wheels


def test_wheels_have_the_names_of_the_file() -> None:
    absolem = quietly(FILES.parent.parent / "robots" / "absolem.sdf")
    names = names_of(absolem.robot, absolem)
    assert (names[0], names[7]) == ("left_track_wheel8", "left_track_wheel1")
    assert (names[8], names[9]) == ("front_left_flipper_wheel1", "front_left_flipper_wheel2")
    places = dict(zip(absolem.wheels["name"], absolem.wheels["x"], strict=True))
    bodies = absolem.robot.wheels()
    for body, x, side in zip(bodies["body"], bodies["x"], bodies["side"], strict=True):
        if side == "left":
            assert x == pytest.approx(places[names[int(body)]], abs=0.002)


@pytest.mark.parametrize("flippers", ["wheels", "belts"])
def test_wheels_on_the_right_have_the_names_of_the_file_where_each_track_has_its_ground(
    flippers: str,
) -> None:
    absolem = quietly(FILES.parent.parent / "robots" / "absolem.sdf")
    robot = absolem.robot
    if flippers == "belts":
        assert robot.flippers is not None
        robot = replace(robot, flippers=replace(robot.flippers, track=c2d.BeltTrack()))
    step = c2d.terrains.step(0.02)
    lanes = c2d.terrains.lanes(c2d.terrains.flat(), step)
    run = c2d.simulate(robot, lanes, duration=0.01)
    right = run.bodies["body"][run.bodies["lane"] == c2d.Lane.RIGHT].tolist()
    first = right[0]
    assert bodies_per_side(robot) == first
    names = names_of(robot, absolem)
    assert names[first] == "right_track_wheel8"
    assert names.keys() <= {*range(first), *right}
    audit: Any = SimpleNamespace(
        robot=robot, reading=absolem, verdicts=[SimpleNamespace(jam_wheels=f"1-{first + 1}")]
    )
    assert words.wheel_names(audit) == (
        "in the file, on the left, wheel 1 is left_track_wheel7;"
        f" on the right, wheel {first + 1} is right_track_wheel7"
    )


# Driving


def test_flippers_are_raised_before_the_obstacle() -> None:
    robot = c2d.robots.engineer()
    scenario = scenario_of(robot, c2d.terrains.step(0.1), None, None)
    assert scenario.robot.flippers is not None
    assert scenario.robot.flippers.angle == c2d.Climb().reach_angle
    held = c2d.Drive(gait=c2d.Hold(0.1))
    assert raise_flippers(robot, held) == robot


def test_the_speed_goes_with_the_size_and_the_limit() -> None:
    scenario = scenario_of(SEIZING, c2d.terrains.step(0.05), None, None)
    assert scenario.drive.speed == pytest.approx(0.2 * math.sqrt(9.81 * 0.365), abs=1e-3)
    slow = replace(SEIZING, drivetrain=replace(SEIZING.drivetrain, max_speed=0.1))
    assert scenario_of(slow, c2d.terrains.step(0.05), None, None).drive.speed == 0.1
