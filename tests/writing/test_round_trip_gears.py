"""Gear wheels that are written and read again are the same, within the rounding of corners."""

import dataclasses
import json
import math
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import crawler2d as c2d
from crawler2d.writing.carriers import carriers_of
from crawler2d.writing.shapes import grousers_of
from tests.writing.drawn import drawn_on_gears
from tests.writing.test_round_trip import differences, frame_of, read_again

BOXES, HULLS = 1e-9, 2e-7
"""[m] What is lost on the way: nothing but rounding of boxes, half a digit of the float32 in which
MuJoCo keeps the corners of hulls, which lie up to 1 m from the middle of the robot, and a little
for their turning."""

SMALLEST = 0.008
"""[m] The smallest radius that is drawn: a corner that is so much off turns it by that share."""

UNTOLD = 1e-3
"""[rad] A reader tells of wheels that start turned by more."""

TURNED, OFF = r"all start turned by (\S+) degrees", r"start up to (\S+) degrees off"

FIELDS = "grouser_count", "grouser_height", "tip_thickness", "base_thickness"


def other_wheels(robot: c2d.Robot, reading: c2d.Reading, accuracy: float) -> Iterator[str]:
    """The fields of gear wheels, and the fraction of their spacing to the next one."""
    again = reading.robot
    yield from _other_wheel(again.track, robot.track, accuracy)
    arms, others = again.flippers, robot.flippers
    if arms is not None and others is not None:
        yield from _other_wheel(arms.track, others.track, accuracy, is_phased=is_stated(robot))
    yield from _told_of_chassis(robot, reading)
    if is_stated(robot):
        words = [*reading.warnings, *reading.notes]
        yield from (each for each in words if re.search(rf"flipper_wheel.*({TURNED}|{OFF})", each))
    else:
        yield from _told_of_flippers(robot, reading, accuracy)


def is_stated(robot: c2d.Robot) -> bool:
    """Whether the file states everything that turned the wheels.

    A raised flipper has turned its wheels by the radius of the sprocket, the rear end of the
    outline. Small wheels in a line have another.
    """
    flippers, track = robot.flippers, robot.track
    is_raised = flippers is not None and flippers.angle != 0.0
    return not is_raised or getattr(track, "wheel_radius", None) is None


def levelled(robot: c2d.Robot) -> c2d.Robot:
    assert robot.flippers is not None
    return dataclasses.replace(robot, flippers=dataclasses.replace(robot.flippers, angle=0.0))


def spacing(track: Any) -> float:
    """[rad] The angle between two grousers of its wheels."""
    return 2.0 * math.pi / float(track.wheel.grouser_count)


def _other_wheel(
    track: Any, written: Any, accuracy: float, *, is_phased: bool = True
) -> Iterator[str]:
    got, expected = track.wheel, written.wheel
    for field in FIELDS:
        if getattr(got, field) != pytest.approx(getattr(expected, field), abs=accuracy):
            yield f"{field}: {got} for {expected}"
    ahead = _wrapped(got.phase_fraction - expected.phase_fraction, 1.0)
    if is_phased and abs(ahead) > accuracy / SMALLEST / spacing(written):
        yield f"phase_fraction: {got} for {expected}"


def _told_of_chassis(robot: c2d.Robot, reading: c2d.Reading) -> Iterator[str]:
    """The notes about wheels of the chassis, except for the tilt of their frame."""
    _, (ahead, _) = frame_of(reading)
    turn = -math.atan2(ahead[1], ahead[0])
    words = [each for each in (*reading.warnings, *reading.notes) if "flipper_wheel" not in each]
    told = _degrees(words, TURNED)
    if abs(_wrapped(turn - told, spacing(robot.track))) > (
        0.005 * abs(told) + 1e-9 if told else UNTOLD
    ):
        yield f"wheels that all start turned by {math.degrees(turn)} degrees: {words}"
    yield from (each for each in words if re.search(OFF, each))


def _told_of_flippers(robot: c2d.Robot, reading: c2d.Reading, accuracy: float) -> Iterator[str]:
    """The notes about wheels of flippers, unless they start differently by that much."""
    assert robot.flippers is not None
    wheels, found = starts(robot), starts(reading.robot)
    for end in (end for end in ("front", "rear") if end in wheels):
        words = [*reading.warnings, *reading.notes]
        words = [each for each in words if f"{end}_left_flipper_wheel" in each]
        turn, off = (_degrees(words, rule) for rule in (TURNED, OFF))
        left = _wrapped(wheels[end] - found[end] - turn, spacing(robot.flippers.track))
        # Texts have three digits. Below UNTOLD, there is no note.
        rounding = 0.005 * (abs(turn) + off) + accuracy / SMALLEST
        most = off + rounding + (UNTOLD if not off else 0.0) + (UNTOLD if not turn else 0.0)
        if not off - rounding <= np.abs(left).max() <= most:
            yield f"{end} wheels start {np.degrees(left)} degrees off: {words}"


def _wrapped(turned: Any, angle: float) -> Any:
    """[rad] Wrap an angle to one spacing of grousers, after which a wheel looks the same."""
    return (turned + 0.5 * angle) % angle - 0.5 * angle


def _degrees(words: list[str], rule: str) -> float:
    """[rad] The angle in a sentence, 0 without one."""
    found = [match[1] for each in words if (match := re.search(rule, each))]
    assert len(found) <= 1
    return math.radians(float(found[0])) if found else 0.0


def starts(robot: c2d.Robot) -> dict[str, np.ndarray]:
    """[rad] Initial direction of a grouser of each wheel relative to the chassis, by end."""
    text = robot._at_rest()
    found = {}
    for carrier in carriers_of(json.loads(text)["robot"], text):
        corners = [grousers_of(wheel.outline)[1][0] for wheel in carrier.wheels]  # type: ignore[arg-type]
        found[carrier.end] = np.array([np.arctan2(*each.sum(axis=0)[::-1]) for each in corners])
    return found


def check(numbers: range, name: str, folder: Path, *, is_tapered: bool = False) -> None:
    found, accuracy = [], HULLS if is_tapered else BOXES
    for number in numbers:
        drawn = drawn_on_gears(number, is_tapered=is_tapered)
        for robot in (drawn,) if is_stated(drawn) else (drawn, levelled(drawn)):
            reading = read_again(robot, name, folder)
            # Speed and force go with radii, of which hulls keep 2.5e-5: HULLS by SMALLEST.
            wrong = [*differences(robot, reading, name, 2.5e-5 if is_tapered else 1e-9)]
            wrong += other_wheels(robot, reading, accuracy)
            found += [f"{number}: {each}" for each in wrong]
    assert found == []


@pytest.mark.parametrize("name", ["sdf", "urdf"])
def test_gear_wheels_are_read_as_they_were_written(name: str, tmp_path: Path) -> None:
    check(range(2), name, tmp_path)


@pytest.mark.parametrize("is_tapered", [False, True])
def test_gear_wheels_are_read_from_mjcf(is_tapered: bool, tmp_path: Path) -> None:
    pytest.importorskip("mujoco")
    check(range(2), "mjcf", tmp_path, is_tapered=is_tapered)


@pytest.mark.soak
@pytest.mark.parametrize("name", ["sdf", "urdf", "mjcf", "mjcf, tapered"])
def test_five_hundred_robots_on_gear_wheels_are_read(name: str, tmp_path: Path) -> None:
    if "mjcf" in name:
        pytest.importorskip("mujoco")
    name, _, tapered = name.partition(", ")
    check(range(1000, 1500), name, tmp_path, is_tapered=bool(tapered))
