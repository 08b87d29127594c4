"""A round wheel with equal, evenly spaced grousers is a gear wheel; others are refused by name."""

import math
import re
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import crawler2d as c2d
from crawler2d import _core
from crawler2d.reading.tracks import fit_phases
from tests.reading.carts import ACROSS, ROUND, WHEELS, collision, pair, read, refused, urdf

ROOT, TIP, COUNT = 0.07, 0.08, 6
THICK = 0.01
ANGLE = 2.0 * math.pi / COUNT


def bar(turn: float, inner: float = 0.04, tip: float = TIP, thick: float = THICK) -> str:
    """A box that reaches from a distance to a circle round the axle, up at a turn of 0."""
    outer = math.sqrt(tip**2 - 0.25 * thick**2)  # its corners are on that circle
    middle, height = 0.5 * (inner + outer), outer - inner
    # A rotation about y turns z forwards, which is clockwise in side view.
    x, z = middle * math.sin(-turn), middle * math.cos(turn)
    return collision(
        f'<box size="{thick} 0.05 {height}"/>', f'<origin xyz="{x} 0 {z}" rpy="0 {-turn} 0"/>'
    )


def gear(
    name: str, x: float, turn: float = 0.0, turns: Iterable[float] | None = None, **how: Any
) -> str:
    """Two wheels with grousers; the first points up at a turn of 0 [rad], and on to the rear."""
    if turns is None:
        turns = [turn + k * ANGLE for k in range(COUNT)]
    bars = "".join(bar(each, **how) for each in turns)
    wheels = pair(name, x, radius=str(ROOT))
    end = f"<collision>{ACROSS}<geometry>{ROUND.format(radius=ROOT)}</geometry></collision>"
    assert end in wheels
    return wheels.replace(end, end + bars)


def wheel_of(folder: Path, *parts: str, **how: Any) -> c2d.GearWheel:
    track = read(folder, urdf(*parts), **how).robot.track
    assert isinstance(track, c2d.LineOfWheels)
    assert isinstance(track.wheel, c2d.GearWheel)
    return track.wheel


def test_boxes_evenly_round_a_wheel_are_its_grousers(tmp_path: Path) -> None:
    robot = read(tmp_path, urdf(gear("front", 0.2), gear("rear", -0.2))).robot
    assert robot.outline.front_radius == pytest.approx(TIP)
    assert isinstance(robot.track, c2d.LineOfWheels)
    wheel = robot.track.wheel
    assert isinstance(wheel, c2d.GearWheel)
    assert wheel.grouser_count == COUNT
    assert wheel.grouser_height == pytest.approx(TIP - ROOT)
    assert wheel.tip_thickness == pytest.approx(THICK)
    assert wheel.base_thickness is None


def test_how_deep_a_box_reaches_into_its_wheel_makes_no_difference(tmp_path: Path) -> None:
    found = [
        wheel_of(tmp_path, gear("front", 0.2, inner=inner), gear("rear", -0.2, inner=inner))
        for inner in (0.02, 0.069)
    ]
    assert found[0].tip_thickness == pytest.approx(found[1].tip_thickness)
    assert found[0].grouser_height == pytest.approx(found[1].grouser_height)


@pytest.mark.parametrize("share", [0.0, 1.0 / 3.0, 0.5, 0.9])
def test_each_wheel_starts_a_share_of_the_spacing_ahead_of_the_one_behind(
    share: float, tmp_path: Path
) -> None:
    """Six grousers: one that points up stands as one that points 30 degrees above forward."""
    parts = [
        gear(name, x, turn=(number * share - 0.5) * ANGLE)
        for number, (name, x) in enumerate((("rear", -0.2), ("mid", 0.0), ("front", 0.2)), 1)
    ]
    found = wheel_of(tmp_path, *parts).phase_fraction
    assert found == pytest.approx(share)


def test_wheels_start_in_a_simulation_as_they_stand_in_the_file(tmp_path: Path) -> None:
    turns = [(0.4 * number - 0.5) * ANGLE for number in (1, 2)]
    parts = [gear("rear", -0.2, turn=turns[0]), gear("front", 0.2, turn=turns[1])]
    robot = read(tmp_path, urdf(*parts)).robot
    outlines = _core.geometry(robot._at_rest())["bodies"]["outline"]
    for turn, outline in zip(turns, outlines, strict=False):
        up = 0.5 * math.pi + turn  # the direction of its first bar in side view
        away = np.array(outline) - TIP * np.array([math.cos(up), math.sin(up)])
        # The middle of a tip lies between two corners, and a little within the circle.
        assert np.sort(np.hypot(*away.T))[:2] == pytest.approx(0.5 * THICK, abs=1e-4)


def test_wheels_that_all_start_turned_by_more_are_noted(tmp_path: Path) -> None:
    turn = -0.5 * ANGLE + math.radians(7.0)
    reading = read(
        tmp_path, urdf(*(gear(n, x, turn=turn) for n, x in (("a", 0.2), ("b", -0.2), ("c", 0.0))))
    )
    assert isinstance(reading.robot.track, c2d.LineOfWheels)
    assert reading.robot.track.wheel.phase_fraction == pytest.approx(0.0, abs=1e-9)  # type: ignore[union-attr]
    assert any("all start turned by 7 degrees" in note for note in reading.notes)
    assert not any("phase_fraction" in warning for warning in reading.warnings)


def test_a_turn_within_rounding_is_no_phase(tmp_path: Path) -> None:
    """A fraction of 0.0004 would fit within the rounding of files."""
    turn = -0.5 * ANGLE + 0.0009
    three = (gear(name, x, turn=turn) for name, x in (("a", 0.2), ("b", -0.2), ("c", 0.0)))
    reading = read(tmp_path, urdf(*three))
    found = reading.robot.track.wheel.phase_fraction  # type: ignore[union-attr]
    assert found == pytest.approx(0.0, abs=1e-9)
    assert not any("turned by" in note for note in reading.notes)


def test_angles_of_two_wheels_that_a_file_rounds_are_no_turn_of_both(tmp_path: Path) -> None:
    """Half a milliradian in either direction would be a turn of 1.5, enough for a note."""
    turns = [-0.5 * ANGLE + off for off in (0.0005, -0.0005)]
    reading = read(
        tmp_path, urdf(gear("rear", -0.2, turn=turns[0]), gear("front", 0.2, turn=turns[1]))
    )
    assert not any("turned by" in note for note in reading.notes)
    assert not any("phase_fraction" in warning for warning in reading.warnings)


def test_a_warning_about_phases_names_the_wheels_and_the_turn_that_all_have(tmp_path: Path) -> None:
    """One of six is off by 0.1 rad; turn and fraction of all are the least-squares fit."""
    turn, places = -0.5 * ANGLE + math.radians(7.0), np.linspace(-0.2, 0.2, 6)
    turns = turn + np.array([0.0, 0.0, 0.1, 0.0, 0.0, 0.0])
    parts = [
        gear(f"w{number}", x, turn=each)
        for number, (x, each) in enumerate(zip(places.tolist(), turns.tolist(), strict=True), 1)
    ]
    reading = read(tmp_path, urdf(*parts))
    (note,) = (note for note in reading.notes if "all start turned by" in note)
    (warning,) = (warning for warning in reading.warnings if "phase_fraction" in warning)
    slope, level = np.polyfit(np.arange(1, 7), turns - turn, 1)
    most = np.abs(turns - turn - level - slope * np.arange(1, 7)).max()
    assert f"left_w1 to left_w6: all start turned by {7 + math.degrees(level):.3g} degrees" in note
    degrees = f"{math.degrees(most):.3g} degrees"
    off = f"left_w1 to left_w6 start up to {degrees} off, in addition to a turn"
    assert off in warning


def test_wheels_that_start_turned_without_a_rule_get_a_warning(tmp_path: Path) -> None:
    turns = (("a", 0.2, 0.0), ("b", 0.0667, 0.3), ("c", -0.0667, 0.1), ("d", -0.2, 0.35))
    reading = read(tmp_path, urdf(*(gear(name, x, turn=turn) for name, x, turn in turns)))
    assert any("robot.track.wheel.phase_fraction" in warning for warning in reading.warnings)


def test_a_wheel_with_grousers_turned_against_that_of_the_other_side_gets_a_warning(
    tmp_path: Path,
) -> None:
    text = urdf(gear("front", 0.2), gear("rear", -0.2))
    start = text.index('<link name="right_front">')
    end = text.index("</link>", start)
    other = gear("front", 0.2, turn=0.2)
    first = other.index('<link name="right_front">')
    turned = other[first : other.index("</link>", first)]
    reading = read(tmp_path, text[:start] + turned + text[end:])
    assert any("start up to 11.5 degrees off" in warning for warning in reading.warnings)


def grousers_of(folder: Path, *corners: tuple[float, float]) -> c2d.GearWheel:
    """A wheel with grousers of a mesh that has these corners [m] on both sides of its middle."""
    lines = [f"v {s * x} {y} {z}" for x, z in corners for s in (-1, 1) for y in (-0.02, 0.02)]
    (folder / "grouser.obj").write_text("\n".join(lines))
    turned = "".join(
        collision('<mesh filename="grouser.obj"/>', f'<origin rpy="0 {k * ANGLE} 0"/>')
        for k in range(COUNT)
    )
    parts = "".join(gear(name, x, turns=()) for name, x in (("front", 0.2), ("rear", -0.2)))
    end = f"<geometry>{ROUND.format(radius=ROOT)}</geometry></collision>"
    return wheel_of(folder, parts.replace(end, end + turned), mesh="hull")


def test_hulls_that_taper_are_grousers_with_their_thickness_at_the_root(tmp_path: Path) -> None:
    """Corners 12 mm apart at 65 mm and 8 mm apart at 80 mm: on the root circle, 10.7 mm."""
    wheel = grousers_of(tmp_path, (0.004, 0.08), (0.006, 0.065))
    assert wheel.tip_thickness == pytest.approx(0.008)
    height = math.sqrt(ROOT**2 - 0.0053**2)  # the flank, to a hundredth of a millimetre
    at_root = 0.008 + 0.004 * (0.08 - height) / 0.015
    assert wheel.base_thickness == pytest.approx(at_root, abs=1e-5)
    assert wheel.grouser_height == pytest.approx(math.hypot(0.08, 0.004) - ROOT)


@pytest.mark.parametrize(("more", "is_parallel"), [(2e-8, True), (2e-6, False)])
def test_flanks_that_differ_by_less_than_rounding_are_parallel(
    more: float, is_parallel: bool, tmp_path: Path
) -> None:
    wheel = grousers_of(tmp_path, (0.005, 0.08), (0.005 + more, 0.065))
    assert (wheel.base_thickness is None) is is_parallel


def test_the_lines_of_a_gear_wheel_are_those_of_its_grousers_too(tmp_path: Path) -> None:
    text = urdf(gear("front", 0.2), gear("rear", -0.2)).replace("<collision>", "\n<collision>")
    reading = read(tmp_path, text)
    # 4 wheels of a cylinder and six boxes
    assert "28 lines" in reading.sources["robot.track"]


def test_grousers_with_another_friction_than_their_wheel_are_refused(tmp_path: Path) -> None:
    pytest.importorskip("mujoco")
    robot = c2d.robots.engineer(track=c2d.LineOfWheels(3, wheel=c2d.GearWheel(grouser_count=6)))
    text = robot.without_flippers().to_mjcf(friction=0.6)
    assert read(tmp_path, text, "gears.xml").friction == 0.6
    first = re.search(
        r'<geom [^>]*type="box"[^>]*friction="0.6', text[text.index("left_wheel_0") :]
    )
    assert first is not None
    slick = text.replace(first[0], first[0].replace('friction="0.6', 'friction="0.3'), 1)
    refused(tmp_path, slick, "must be that of all wheels, 0.6", "gears.xml")


def test_mixed_round_and_gear_wheels_are_refused(tmp_path: Path) -> None:
    text = urdf(gear("front", 0.2), pair("rear", -0.2))
    refused(tmp_path, text, "must have grousers, as other wheels of its track")


@pytest.mark.parametrize("how", [{"thick": 0.008}, {"tip": 0.082}])
def test_gear_wheels_that_differ_are_refused(how: dict[str, Any], tmp_path: Path) -> None:
    text = urdf(gear("front", 0.2), gear("rear", -0.2, **how))
    refused(tmp_path, text, "must have the grousers of the other wheels of its track, 6 of 1")


def test_gear_wheels_with_other_numbers_of_grousers_are_refused(tmp_path: Path) -> None:
    turns = np.arange(8) * math.pi / 4.0
    text = urdf(gear("front", 0.2), gear("rear", -0.2, turns=turns))
    refused(tmp_path, text, "must have the grousers of the other wheels")


@pytest.mark.parametrize(
    ("turns", "how"),
    [
        ([0.0, ANGLE, 2.0 * ANGLE, 3.0 * ANGLE, 4.0 * ANGLE], {}),  # one is missing
        ([0.1, *(k * ANGLE for k in range(1, 6))], {}),  # one is displaced
        ([0.0, math.pi], {}),  # too few
        (None, {"tip": 0.069}),  # within the wheel
        (None, {"inner": 0.073}),  # beside it
    ],
)
def test_an_irregular_gear_wheel_is_no_wheel(
    turns: list[float] | None, how: dict[str, Any], tmp_path: Path
) -> None:
    text = urdf(gear("front", 0.2, turns=turns, **how), gear("rear", -0.2, turns=turns, **how))
    refused(tmp_path, text, "must have wheels .round collision shapes")
    beside = read(tmp_path, urdf(WHEELS, gear("mid", 0.0, turns=turns, **how)))
    assert any("left_mid" in note and "touch nothing" in note for note in beside.notes)


def test_grousers_of_other_sizes_are_no_gear_wheel(tmp_path: Path) -> None:
    mixed = "".join(gear(name, x) for name, x in (("front", 0.2), ("rear", -0.2)))
    first = re.escape(f'<box size="{THICK} 0.05')
    mixed = re.sub(rf"({ROUND.format(radius=ROOT)}.*?){first}", r'\1<box size="0.009 0.05', mixed)
    refused(tmp_path, urdf(mixed), "must have wheels")


def test_a_robot_on_gear_wheels_that_was_read_climbs_what_round_ones_do_not(
    tmp_path: Path,
) -> None:
    text = urdf(*(gear(name, x) for name, x in (("front", 0.2), ("rear", -0.2))), mass="8")
    robot = read(tmp_path, text).robot
    ground = c2d.terrains.step(0.05, friction=0.3)
    outcomes = [
        str(c2d.simulate(each, ground).outcome)
        for each in (robot, robot.with_track(c2d.LineOfWheels(2)))
    ]
    assert outcomes[0] == "cleared"
    assert outcomes[1] != "cleared"


@pytest.mark.parametrize(
    ("own", "step", "offset"),
    [
        ([0.25, 0.5, 0.75, 0.0], 0.25, 0.0),
        ([0.2504, 0.5004, 0.7504, 0.0004], 0.25, 0.0004),  # a frame with a slight tilt
        ([0.2504, 0.4996, 0.7504, 0.9996], 0.25, 0.0),  # the rounding of files is not a tilt
        ([0.2504, 0.5004, 0.7504, 0.0001], 0.25, 0.0),  # of which it explains only a part
        ([0.3, 0.73], 0.43, -0.13),  # any two have an offset and a step
        ([0.2502, 0.5], 0.25, 0.0),
        ([0.999999999999, 0.999999999999], 0.0, 0.0),
        ([0.1, 0.1, 0.1], 0.0, 0.1),
    ],
)
def test_phases_have_a_step_and_an_offset_if_that_explains_them(
    own: list[float], step: float, offset: float
) -> None:
    found = fit_phases(np.array(own), [list(range(len(own)))], 1e-3)
    assert (found.step, found.offset) == pytest.approx((step, offset), abs=2e-4)
    assert (found.offset == 0.0) is (offset == 0.0)
    assert found.residual <= 1e-3
    assert found.order == list(range(len(own)))


def test_phases_in_another_order_are_found_if_the_first_does_not_suffice() -> None:
    own = np.array([0.3, 0.9, 0.6, 0.2])
    found = fit_phases(own, [[0, 1, 2, 3], [0, 2, 1, 3]], 1e-6)
    assert found.order == [0, 2, 1, 3]
    assert found.step == pytest.approx(0.3)
    none = fit_phases(own, [[0, 1, 2, 3]], 1e-6)
    assert none.residual > 0.01
