"""A robot that is written and read again is the same, as far as the file states it."""

import dataclasses
import math
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

import crawler2d as c2d
from crawler2d.common.bodies import end_discs
from tests.reading.carts import quietly
from tests.writing.drawn import drawn, drawn_on_discs

SUFFIX = {"sdf": "sdf", "urdf": "urdf", "mjcf": "xml"}
DIRECTIONS = np.linspace(0.0, 2.0 * math.pi, 360, endpoint=False)
NORMALS = np.stack([np.cos(DIRECTIONS), np.sin(DIRECTIONS)])


def written(robot: c2d.Robot, name: str, folder: Path, *, friction: float) -> Path:
    path = folder / f"robot.{SUFFIX[name]}"
    getattr(robot, f"to_{name}")(path, friction=friction)
    return path


def read_again(robot: c2d.Robot, name: str, folder: Path) -> c2d.Reading:
    return quietly(written(robot, name, folder, friction=0.6), mesh="hull")


def frame_of(reading: c2d.Reading) -> tuple[np.ndarray, np.ndarray]:
    """Origin and axes of the chassis frame of a reading, in the frame of the model.

    The end axles of a reading are those of its rearmost and foremost wheels; round more than two
    drums, x is that of the model.
    """
    own = (reading.wheels["carrier"] == "chassis") & (reading.wheels["side"] == "left")
    rows = sorted(zip(*(reading.wheels[n][own] for n in ("x", "y", "radius")), strict=True))
    if len(reading.robot.outline.discs) > 2:
        rear, front = (np.array(end[:2]) for end in end_discs(rows))
        return 0.5 * (rear + front), np.eye(2)
    rear, front = np.array(rows[0][:2]), np.array(rows[-1][:2])
    ahead = (front - rear) / np.hypot(*(front - rear))
    return 0.5 * (rear + front), np.array([ahead, [-ahead[1], ahead[0]]])


def discs_of(robot: c2d.Robot) -> dict[str, list[tuple[float, ...]]]:
    """Wheels by carrier, or the ends of belts, in the chassis frame."""
    wheels = robot.wheels()
    found: dict[str, list[tuple[float, ...]]] = {}
    left = wheels["side"] == "left"
    for carrier in ("chassis", "front flipper", "rear flipper"):
        own = left & (wheels["carrier"] == carrier)
        if own.any():
            columns = (wheels[name][own].tolist() for name in ("x", "y", "radius"))
            found[carrier] = sorted(zip(*columns, strict=True))
    flippers = robot.flippers
    if "chassis" not in found:
        found["chassis"] = sorted(robot.outline.discs)
    rear, front = robot.outline.ends
    for end, sign, axle in (("front", 1.0, front), ("rear", -1.0, rear)):
        carrier = f"{end} flipper"
        if flippers is not None and flippers.ends in (end, "both") and carrier not in found:
            reach = flippers.length
            x, y = reach * math.cos(flippers.angle), reach * math.sin(flippers.angle)
            root = (*axle[:2], flippers.root_radius)
            tip = (axle[0] + sign * x, axle[1] + y, flippers.tip_radius)
            found[carrier] = sorted([root, tip])
    return found


def tolerance_of(belly: np.ndarray, name: str) -> float:
    """[m] Largest cut of corners sharper than a right angle by boxes; readers round."""
    if name == "mjcf":
        return 1e-5
    edges = np.roll(belly, -1, axis=0) - belly
    back = -np.roll(edges, 1, axis=0)
    cosines = (edges * back).sum(axis=1) / np.hypot(*edges.T) / np.hypot(*back.T)
    sharpest = math.acos(min(1.0, cosines.max()))
    return 1e-5 + (1e-3 / math.tan(sharpest) if sharpest < 0.5 * math.pi - 1e-6 else 0.0)


def differences(
    robot: c2d.Robot, reading: c2d.Reading, name: str, accuracy: float = 1e-9
) -> Iterator[str]:
    """The values of the file that were not read as written."""
    again, (middle, axes) = reading.robot, frame_of(reading)
    force = robot.drivetrain.max_torque / (robot.outline.rear_radius - robot.outline.grouser_height)
    has_wheels = bool((robot.wheels()["carrier"] == "chassis").any())
    pairs: dict[str, tuple[object, object]] = {
        "name": (again.name, robot.name),
        "mass": (again.mass, robot.mass),
        "centre": (tuple(middle + again.center_of_mass @ axes), robot.center_of_mass),
        "inertia": (again.moment_of_inertia, robot.moment_of_inertia),
        "gauge": (again.gauge, robot.gauge),
        "friction": (reading.friction, 0.6),
        "speed": (again.drivetrain.max_speed, robot.drivetrain.max_speed),
    }
    if has_wheels:  # a belt has no motor and no moving mass in any format
        found = again.drivetrain.max_torque / again.outline.rear_radius
        pairs["force"] = (found, force)
        pairs["moving mass"] = (again.track_mass, robot.track_mass)
    if robot.flippers is None or again.flippers is None:
        pairs["flippers"] = (again.flippers, robot.flippers)
    else:
        for field in ("length", "mass", "angle", "rate_limit", "torque_limit", "ends"):
            pairs[field] = (getattr(again.flippers, field), getattr(robot.flippers, field))
    for field, (got, expected) in pairs.items():
        if got != expected and not np.allclose(got, expected, rtol=accuracy, atol=accuracy):  # type: ignore[arg-type]
            yield f"{field}: {got} for {expected}"
    yield from _other_discs(robot, reading, accuracy)
    if (again.belly is None) != (robot.belly is None):
        yield "belly"
    elif robot.belly is not None and again.belly is not None:
        belly = np.array(robot.belly)
        got = ((middle + np.array(again.belly) @ axes) @ NORMALS).max(axis=0)
        short = (belly @ NORMALS).max(axis=0) - got
        if short.min() < -1e-5 or short.max() > tolerance_of(belly, name):
            yield f"belly: {short.min()} to {short.max()} m short"


def _other_discs(robot: c2d.Robot, reading: c2d.Reading, accuracy: float) -> Iterator[str]:
    wheels = reading.wheels
    for carrier, expected in discs_of(robot).items():
        for side in ("left", "right"):
            own = (wheels["carrier"] == carrier) & (wheels["side"] == side)
            rows = zip(*(wheels[n][own].tolist() for n in ("x", "y", "radius")), strict=True)
            found = sorted(rows)
            if len(found) != len(expected) or not np.allclose(found, expected, atol=accuracy):
                yield f"{side} {carrier}: {found} for {expected}"


def _other_outline(robot: c2d.Robot, reading: c2d.Reading) -> Iterator[str]:
    """The discs of a belt, each in the frame of the model."""
    outline, (middle, axes) = reading.robot.outline, frame_of(reading)
    places = [(*(middle + np.array([x, y]) @ axes), radius) for x, y, radius in outline.discs]
    if not np.allclose(sorted(places), sorted(robot.outline.discs), atol=1e-9):
        yield f"outline: {places} for {robot.outline.discs}"


def check(numbers: range, name: str, folder: Path) -> None:
    found = []
    for number in numbers:
        robot = drawn(number, wheels_only=name == "urdf")
        reading = read_again(robot, name, folder)
        found += [f"{number}: {each}" for each in differences(robot, reading, name)]
    assert found == []


@pytest.mark.parametrize("name", ["sdf", "urdf"])
def test_a_drawn_robot_is_read_as_it_was_written(name: str, tmp_path: Path) -> None:
    check(range(8), name, tmp_path)


def test_a_drawn_robot_is_read_from_mjcf_as_it_was_written(tmp_path: Path) -> None:
    pytest.importorskip("mujoco")
    check(range(7), "mjcf", tmp_path)


def check_discs(numbers: range, name: str, folder: Path) -> None:
    found = []
    for number in numbers:
        robot = drawn_on_discs(number)
        reading = read_again(robot, name, folder)
        wrong = [*differences(robot, reading, name), *_other_outline(robot, reading)]
        found += [f"{number}: {each}" for each in wrong]
    assert found == []


def test_a_belt_round_three_to_five_discs_is_read_as_it_was_written(tmp_path: Path) -> None:
    check_discs(range(8), "sdf", tmp_path)


def test_a_belt_round_more_than_two_discs_is_read_from_mjcf(tmp_path: Path) -> None:
    pytest.importorskip("mujoco")
    check_discs(range(6), "mjcf", tmp_path)


@pytest.mark.soak
@pytest.mark.parametrize("name", ["sdf", "mjcf"])
def test_five_hundred_belts_round_three_to_five_discs_are_read(name: str, tmp_path: Path) -> None:
    if name == "mjcf":
        pytest.importorskip("mujoco")
    check_discs(range(1000, 1500), name, tmp_path)


@pytest.mark.soak
@pytest.mark.parametrize("name", ["sdf", "urdf", "mjcf"])
def test_five_hundred_drawn_robots_are_read_as_they_were_written(name: str, tmp_path: Path) -> None:
    if name == "mjcf":
        pytest.importorskip("mujoco")
    check(range(1000, 1500), name, tmp_path)


PRESETS = {
    "engineer": c2d.robots.engineer(track=c2d.LineOfWheels(3)),
    "engineer, belt": c2d.robots.engineer(),
    "absolem": c2d.robots.absolem(track="public"),
    "absolem, belt": c2d.robots.absolem(),
    "marv": c2d.robots.marv(track="public"),
    "gazebo": c2d.robots.gz_tracked_vehicle(),
}


@pytest.mark.parametrize("robot", PRESETS.values(), ids=PRESETS)
def test_presets_are_read_from_sdf_as_they_were_written(robot: c2d.Robot, tmp_path: Path) -> None:
    reading = read_again(robot, "sdf", tmp_path)
    assert list(differences(robot, reading, "sdf")) == []


def test_a_line_of_wheels_is_read_as_one(tmp_path: Path) -> None:
    robot = drawn(0).with_track(c2d.LineOfWheels(5)).without_flippers()
    assert read_again(robot, "urdf", tmp_path).robot.track == c2d.LineOfWheels(5)


def test_a_belt_is_read_as_one(tmp_path: Path) -> None:
    robot = drawn(0).with_track(c2d.BeltTrack()).without_flippers()
    again = read_again(robot, "sdf", tmp_path).robot
    assert again.track == c2d.BeltTrack()
    outline = robot.outline
    for field in ("axle_distance", "front_radius", "rear_radius"):
        assert getattr(again.outline, field) == pytest.approx(getattr(outline, field), rel=1e-12)


def test_the_comment_plays_no_part_in_reading(tmp_path: Path) -> None:
    robot = drawn(1)
    text = robot.to_sdf()
    bare = text[: text.index("<!--")] + text[text.index("-->") + 3 :]
    for name, each in (("with.sdf", text), ("without.sdf", bare)):
        (tmp_path / name).write_text(each)
    found = [quietly(tmp_path / name).robot for name in ("with.sdf", "without.sdf")]
    assert found[0] == found[1]


def test_a_robot_without_torque_has_no_torque_in_its_file() -> None:
    robot = drawn(2).with_track(c2d.LineOfWheels(3)).without_flippers()
    motors = dataclasses.replace(robot.drivetrain, max_torque=0.0)
    robot = dataclasses.replace(robot, drivetrain=motors)
    assert "<effort>0</effort>" in robot.to_sdf()
    assert "<velocity" not in robot.to_mjcf()


def test_the_belt_of_a_steep_flipper_is_read(tmp_path: Path) -> None:
    """Its large root reaches farther forward and farther back than its tip."""
    built = c2d.robots.absolem()
    assert built.flippers is not None
    steep = dataclasses.replace(built.flippers, angle=1.5)
    robot = dataclasses.replace(built, flippers=steep)
    assert list(differences(robot, read_again(robot, "sdf", tmp_path), "sdf")) == []
