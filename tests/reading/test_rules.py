"""Rules of model files that are rarely broken: each is refused by name, with its line."""

import math
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import crawler2d as c2d
from crawler2d.reading.files import LARGEST_MODEL
from crawler2d.reading.parsing import parse_xml
from crawler2d.reading.wheels import is_parallel
from tests.kept import refusing
from tests.reading.carts import (
    FILES,
    SAID,
    SIDES,
    WHEELS,
    XACRO,
    collision,
    pair,
    read,
    refused,
    urdf,
)

SDF = (FILES / "cart.sdf").read_text(encoding="utf-8")
MJCF = (FILES / "cart.xml").read_text(encoding="utf-8")


def changed(text: str, old: str, new: str) -> str:
    assert old in text
    return text.replace(old, new, 1)


POSE = "<pose>-0.25 0.25 0 0 0 0</pose>"
AXIS = "<axis><xyz>0 1 0</xyz><limit><effort>5</effort><velocity>10</velocity></limit></axis>"
HULL = """<inertial><mass>16</mass>
        <inertia><ixx>0.125</ixx><iyy>0.5</iyy><izz>0.5</izz></inertia></inertial>"""
MU = "<mu>0.75</mu>"
BROKEN_SDF = {
    "a frame that is not there": (
        POSE,
        '<pose relative_to="there">-0.25 0.25 0 0 0 0</pose>',
        "must name a link, joint or frame of the model, got there",
    ),
    "a quaternion of zeros": (
        POSE,
        '<pose rotation_format="quat_xyzw">-0.25 0.25 0 0 0 0 0</pose>',
        "must have a quaternion that is not 0",
    ),
    "a rotation of another kind": (
        POSE,
        '<pose rotation_format="axis_angle">-0.25 0.25 0 0 0 0</pose>',
        "must be euler_rpy or quat_xyzw, got axis_angle",
    ),
    "a mass below 0": ("<mass>1</mass>", "<mass>-1</mass>", "must have a mass >= 0 kg, got -1"),
    "a joint that turns about nothing": (AXIS, "", "must have an axis"),
    "a friction below 0": (MU, "<mu>-0.1</mu>", "must be >= 0, got -0.1"),
    "a mass of a shape whose volume is not known": (
        HULL,
        '<inertial auto="true"/><collision name="cone"><geometry><cone><radius>0.1</radius>'
        "<length>0.1</length></cone></geometry></collision>",
        "must state mass and inertia, or have boxes, cylinders, capsules or spheres, got auto",
    ),
    "a shape of two": (
        "<geometry><box>",
        "<geometry><sphere><radius>0.1</radius></sphere><box>",
        "must be the only shape of its collision, got box",
    ),
}


@pytest.mark.parametrize("what", BROKEN_SDF)
def test_invalid_sdf_is_refused(what: str, tmp_path: Path) -> None:
    old, new, rule = BROKEN_SDF[what]
    refused(tmp_path, changed(SDF, old, new), rule, "cart.sdf")


def test_a_quaternion_turns_a_link_as_angles_do(tmp_path: Path) -> None:
    turned = '<pose rotation_format="quat_xyzw">-0.25 0.25 0 0 0.8 0 0.6</pose>'
    assert (
        read(tmp_path, changed(SDF, POSE, turned), "cart.sdf").robot
        == read(tmp_path, SDF, "cart.sdf").robot
    )


@pytest.mark.parametrize(("norm", "is_read"), [(1.005e-6, True), (0.995e-6, False)])
def test_a_quaternion_is_0_below_a_millionth(norm: float, is_read: bool, tmp_path: Path) -> None:
    pose = f'<pose rotation_format="quat_xyzw">-0.25 0.25 0 0 0 0 {norm}</pose>'
    text = changed(SDF, POSE, pose)
    if is_read:
        read(tmp_path, text, "cart.sdf")
    else:
        refused(tmp_path, text, "must have a quaternion that is not 0", "cart.sdf")


def test_too_few_numbers_or_a_missing_attribute_are_refused(
    tmp_path: Path,
) -> None:
    refused(tmp_path, changed(SDF, POSE, "<pose>0 0 0</pose>"), "must be 6 numbers", "cart.sdf")
    text = changed(urdf(WHEELS), '<parent link="hull"/>', "<parent/>")
    refused(tmp_path, text, "must have an attribute link")


@pytest.mark.parametrize(
    ("text", "rule"),
    [
        (urdf(WHEELS, *(f'<link name="l{n}"/>' for n in range(1000))), "at most 1000 links"),
        (
            urdf(
                WHEELS,
                *(
                    f'<joint name="j{n}" type="fixed"><parent link="hull"/><child link="c{n}"/>'
                    "</joint>"
                    for n in range(1001)
                ),
            ),
            "at most 1000 joints",
        ),
        (urdf(WHEELS, f'<link name="{"l" * 201}"/>'), "at most 200 letters"),
        ('<robot name="none"/>', "must have a link"),
    ],
    ids=["links", "joints", "letters", "none"],
)
def test_a_model_has_a_link_and_no_more_than_any_robot(
    text: str, rule: str, tmp_path: Path
) -> None:
    refused(tmp_path, text, rule, missing="refuse")


def test_an_sdf_model_without_a_link_is_refused_at_its_line(tmp_path: Path) -> None:
    with refusing(SAID) as caught:
        read(tmp_path, '<sdf version="1.9">\n<model name="none"/></sdf>', "none.sdf")
    assert (caught.value.path, caught.value.rule) == ("none.sdf:2", "must have a link")


def test_a_file_that_is_too_large_is_not_parsed() -> None:
    with refusing(SAID, f"^large must have at most {LARGEST_MODEL} bytes"):
        parse_xml(b" " * (LARGEST_MODEL + 1), "large")


def latin(text: str) -> bytes:
    return b"<?xml version='1.0' encoding='latin-1'?><!-- \xe9 -->" + text.encode()


def test_scaled_or_expanded_files_must_be_utf_8(tmp_path: Path) -> None:
    path = tmp_path / "cart.urdf"
    path.write_bytes(latin(urdf(WHEELS)))
    with refusing(SAID, "must be UTF-8, to be scaled"):
        c2d.read_robot(path, scale=2.0)
    pytest.importorskip("xacrodoc")
    path = tmp_path / "cart.xacro"
    path.write_bytes(latin(f"{XACRO}</robot>"))
    with refusing(SAID, "must be UTF-8, which xacro reads"):
        c2d.read_robot(path)


def test_files_are_not_included_by_a_pattern(tmp_path: Path) -> None:
    pytest.importorskip("xacrodoc")
    text = f'{XACRO}<xacro:include filename="*.xacro"/></robot>'
    with refusing(SAID, r"\*\.xacro must include files by name, not by pattern"):
        read(tmp_path, text, "cart.xacro")


def test_a_model_that_mjcf_does_not_have_is_refused_with_those_that_it_has(tmp_path: Path) -> None:
    pytest.importorskip("mujoco")
    with refusing(SAID) as caught:
        read(tmp_path, MJCF, "cart.xml", model="tank")
    assert (caught.value.path, caught.value.value) == ("model", "tank")
    assert caught.value.rule == "must be one of hull"
    assert read(tmp_path, MJCF, "cart.xml", model="hull").robot.mass == 24.0


def test_four_hundred_wheels_are_no_robot(tmp_path: Path) -> None:
    many = "".join(pair(f"w{n}", 0.001 * n) for n in range(201))
    refused(tmp_path, urdf(many), "must have at most 400 wheels per carrier")


def test_a_drum_with_a_longitudinal_axis_is_refused(tmp_path: Path) -> None:
    drum = "".join(
        collision(
            '<cylinder radius="0.1" length="0.1"/>', f'<origin xyz="{x} 0 0" rpy="{angles}"/>'
        )
        for x, angles in ((-0.4, "1.5707963 0 0"), (0.0, "0 1.5707963 0"), (0.4, "1.5707963 0 0"))
    )
    belts = "".join(
        f"""<link name="{side}_belt">{drum}</link><joint name="{side}_j" type="fixed">
        <parent link="hull"/><child link="{side}_belt"/><origin xyz="0 {0.3 * sign} 0"/></joint>"""
        for side, sign in SIDES
    )
    told: dict[str, Any] = {"tracks": ["left_belt", "right_belt"]}
    refused(tmp_path, urdf(belts), "must have a lateral axis to be a drum of a track", **told)


def test_friction_of_a_reading_is_worked_out_for_another_ground() -> None:
    reading = c2d.read_robot(FILES / "cart.sdf")
    assert reading.friction_on(0.3) == 0.3
    assert reading.friction_on(2.0) == reading.friction


def test_a_reading_shows_its_wheels_notes_and_warnings() -> None:
    reading = c2d.read_robot(FILES / "cart.sdf")
    lines = repr(reading).splitlines()
    assert lines[0] == reading.description
    assert re.fullmatch(r"  left chassis: x -?0\.\d{4} m, y 0\.\d{4} m, radius 0\.1250 m", lines[1])


@pytest.mark.parametrize(("off", "along"), [(0.0, True), (0.0499, True), (0.0501, False)])
def test_axes_are_parallel_up_to_a_twentieth_of_a_radian(off: float, along: bool) -> None:
    left = np.array([0.0, 1.0, 0.0])
    for sign in (1.0, -1.0):
        other = sign * np.array([math.sin(off), math.cos(off), 0.0])
        assert is_parallel(left, other) is along
