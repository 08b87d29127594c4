"""Gear wheels that are written and read again are the same, as far as corners are kept."""

import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

import crawler2d as c2d
from tests.reading.carts import quietly
from tests.writing.drawn import drawn_on_gears
from tests.writing.test_round_trip import SUFFIX, differences

BOXES, HULLS = 1e-9, 2e-7
"""[m] What is lost on the way: nothing but rounding of boxes, half a digit of the float32 in which
MuJoCo keeps the corners of hulls, which lie up to 1 m from the middle of the robot, and a little
for their turning."""

SMALLEST = 0.008
"""[m] The smallest radius that is drawn: a corner that is so much off turns it by that share."""

FIELDS = "grouser_count", "grouser_height", "tip_thickness", "base_thickness"


def read_again(robot: c2d.Robot, name: str, folder: Path) -> c2d.Reading:
    path = folder / f"robot.{SUFFIX[name]}"
    getattr(robot, f"to_{name}")(path, friction=0.6)
    return quietly(path, mesh="hull")


def other_wheels(robot: c2d.Robot, reading: c2d.Reading, accuracy: float) -> Iterator[str]:
    """The fields of gear wheels, and by which share of their spacing the next one is ahead."""
    again = reading.robot
    yield from _other_wheel(again.track, robot.track, accuracy)
    arms, others = again.flippers, robot.flippers
    if arms is not None and others is not None:
        # A raised flipper has turned its wheels by the radius of the sprocket. That of small wheels
        # in a line is not in the file.
        is_stated = again.outline.rear_radius == pytest.approx(robot.outline.rear_radius)
        yield from _other_wheel(arms.track, others.track, accuracy, is_phased=is_stated)
    yield from (doubt for doubt in reading.doubts if "phase_fraction" in doubt)


def _other_wheel(
    track: Any, written: Any, accuracy: float, *, is_phased: bool = True
) -> Iterator[str]:
    got, expected = track.wheel, written.wheel
    for field in FIELDS:
        if getattr(got, field) != pytest.approx(getattr(expected, field), abs=accuracy):
            yield f"{field}: {got} for {expected}"
    ahead = (got.phase_fraction - expected.phase_fraction + 0.5) % 1.0 - 0.5
    angle = 2.0 * math.pi / expected.grouser_count
    if is_phased and abs(ahead) > accuracy / SMALLEST / angle:
        yield f"phase_fraction: {got} for {expected}"


def check(numbers: range, name: str, folder: Path, *, is_tapered: bool = False) -> None:
    found, accuracy = [], HULLS if is_tapered else BOXES
    for number in numbers:
        robot = drawn_on_gears(number, is_tapered=is_tapered)
        reading = read_again(robot, name, folder)
        # Speed and force go with radii, of which hulls keep 2.5e-5: HULLS by SMALLEST.
        wrong = [*differences(robot, reading, name, 2.5e-5 if is_tapered else 1e-9)]
        wrong += other_wheels(robot, reading, accuracy)
        found += [f"{number}: {each}" for each in wrong]
    assert found == []


@pytest.mark.parametrize("name", ["sdf", "urdf"])
def test_gear_wheels_are_read_as_they_were_written(name: str, tmp_path: Path) -> None:
    check(range(30), name, tmp_path)


@pytest.mark.parametrize("is_tapered", [False, True])
def test_gear_wheels_are_read_from_mjcf(is_tapered: bool, tmp_path: Path) -> None:
    pytest.importorskip("mujoco")
    check(range(10), "mjcf", tmp_path, is_tapered=is_tapered)


@pytest.mark.soak
@pytest.mark.parametrize("name", ["sdf", "urdf", "mjcf", "mjcf, tapered"])
def test_five_hundred_robots_on_gear_wheels_are_read(name: str, tmp_path: Path) -> None:
    if "mjcf" in name:
        pytest.importorskip("mujoco")
    name, _, tapered = name.partition(", ")
    check(range(1000, 1500), name, tmp_path, is_tapered=bool(tapered))
