"""Which numbers of an MJCF change with its wheels, where they are in classes and in motors."""

import re
from dataclasses import replace
from pathlib import Path

import pytest

import crawler2d as c2d
from crawler2d.patching.patch import patch_file
from tests.kept import refusing
from tests.patching.test_edits import (
    CART,
    GEAR,
    SIZE,
    SQUARE,
    factors,
    read,
    resized,
    with_gears,
)
from tests.patching.test_patch import SAID, on_chassis


def mjcf(folder: Path, *changes: tuple[str, str]) -> c2d.Reading:
    """The cart with replaced texts, each of which must occur."""
    text = CART["xml"]
    for pattern, new in changes:
        text, count = re.subn(pattern, new, text)
        assert count
    return read(folder, text, "xml")


def test_torques_of_mjcf_are_limited_in_three_places(tmp_path: Path) -> None:
    of_wheels = r"<velocity (joint=\"\w+_(?:rear|middle|front)_joint\") [^/]*/>"
    motors = mjcf(tmp_path, (of_wheels, r'<motor \1 gear="5 0 0 0 0 0" ctrlrange="-1 1"/>'))
    found = factors(motors.text, resized(motors, 0.1))
    assert found["motor@gear"] == {(SIZE, 0.0, 0.0, 0.0, 0.0, 0.0)}
    assert "motor@ctrlrange" not in found
    joints = mjcf(
        tmp_path,
        (of_wheels, r'<velocity \1 kv="10" ctrlrange="-10 10"/>'),
        (r'(_(?:rear|middle|front)_joint") axis', r'\1 actuatorfrcrange="-5 5" axis'),
    )
    found = factors(joints.text, resized(joints, 0.1))
    assert found["joint@actuatorfrcrange"] == {(SIZE, SIZE)}
    assert found["velocity@kv"] == {(SQUARE,)}


def test_a_general_servo_of_speed_by_position_scales_its_limits_and_keeps_its_gear(
    tmp_path: Path,
) -> None:
    """It integrates its control: MuJoCo's intvelocity, written out."""
    servo = 'dyntype="integrator" biastype="affine" gainprm="40" biasprm="0 -40 -1" gear="1"'
    limits = 'forcerange="-5 5" ctrlrange="-10 10" actrange="-1000 1000"'
    reading = mjcf(tmp_path, (OF_WHEELS, rf"<general \1 {servo} {limits}/>"))
    found = factors(reading.text, resized(reading, 0.1))
    assert found["general@forcerange"] == {(SIZE, SIZE)}
    assert found["general@ctrlrange"] == {(1.0 / SIZE, 1.0 / SIZE)}
    assert "general@gear" not in found


SERVO = '<velocity kv="10" forcerange="-5 5" ctrlrange="-10 10"/>'
OF_CLASS = ("<default>", f'<default><default class="m">{SERVO}</default>')
OF_WHEELS = r"<velocity (joint=\"\w+_(?:rear|middle|front)_joint\") [^/]*/>"


@pytest.mark.parametrize("gear", ["", ' gear="2"', ' gear="2 0 0 0 0 0"'])
def test_a_servo_gets_the_changed_limits_that_it_has_of_its_class(
    gear: str, tmp_path: Path
) -> None:
    """Those of the class stay, as others have them, too; a servo's own values are multiplied."""
    reading = mjcf(
        tmp_path,
        OF_CLASS,
        (OF_WHEELS, rf'<velocity \1 class="m"{gear}/>'),
        ('(left_rear_joint" class="m")', r'\1 kv="10"'),
    )
    text = resized(reading, 0.1)
    assert SERVO in text
    limits = 'forcerange="-4 4" ctrlrange="-12.5 12.5"'
    assert text.count(f'class="m"{gear} {limits} kv="6.4"/>') == 5
    assert text.count(f'class="m" kv="6.4"{gear} {limits}/>') == 1


@pytest.mark.parametrize(
    "changes",
    [
        [("<default>", '<default><joint armature="0.01"/>')],
        [OF_CLASS, (OF_WHEELS, r'<velocity \1 class="m"/>')],
    ],
    ids=["rotor", "servo"],
)
def test_class_attributes_stay_in_the_class_while_a_wheel_only_moves(
    changes: list[tuple[str, str]], tmp_path: Path
) -> None:
    reading = mjcf(
        tmp_path,
        *changes,
        (r'_middle" pos="0.0 ', '_middle" pos="0.02 '),
    )
    text = patch_file(reading, on_chassis(reading, 3)).text
    assert text == reading.text.replace('_middle" pos="0.02 ', '_middle" pos="0 ')


def test_a_full_tensor_of_mjcf_scales_as_a_whole(tmp_path: Path) -> None:
    reading = mjcf(
        tmp_path,
        ('diaginertia="0.004 0.0078125 0.004"', 'fullinertia="0.004 0.0078 0.004 1e-5 1e-5 1e-5"'),
    )
    assert factors(reading.text, resized(reading, 0.1))["inertial@fullinertia"] == {(SQUARE,) * 6}


SIZED = ('<geom type="cylinder" zaxis', '<geom type="cylinder" size="0.125 0.03125" zaxis')
MESH = 'type="mesh" mesh="lump"'
UNSIZED = ('<geom class="tread" size="0.125 0.03125"/>', '<geom class="tread"/>')
MIDDLES = r'(<body name="(?:left|right)_middle"[^>]*>\s*<joint [^>]*>\s*)'


def test_a_wheel_whose_size_is_of_a_class_gets_its_own(tmp_path: Path) -> None:
    reading = mjcf(tmp_path, SIZED, UNSIZED)
    text = resized(reading, 0.1)
    assert text.count('<geom class="tread" size="0.1 0.03125"/>') == 6
    assert text.count('<geom class="tread"/>') == 2  # of the flippers


@pytest.mark.parametrize(
    "part", ['type="box" size="0.01 0.01 0.01"', 'type="ellipsoid" size="0.01 0.01 0.01"', MESH]
)
def test_parts_of_a_wheel_that_are_not_round_stay(part: str, tmp_path: Path) -> None:
    geom = f'<geom {part} contype="0" conaffinity="0" mass="0"/>'
    corners = "0 0 0  0.01 0 0  0 0.01 0  0 0 0.01"
    asset = f'<asset><mesh name="lump" vertex="{corners}"/></asset><worldbody>'
    reading = mjcf(tmp_path, ("<worldbody>", asset), (UNSIZED[0], UNSIZED[0] + geom))
    assert resized(reading, 0.1).count(geom) == reading.text.count(geom) == 8


def test_two_shapes_whose_size_is_of_a_class_are_refused(tmp_path: Path) -> None:
    reading = mjcf(tmp_path, SIZED, (UNSIZED[0], 2 * UNSIZED[1]))
    with refusing(SAID, r"^body\[left_rear\] must state the sizes of its"):
        resized(reading, 0.1)


def test_a_mass_by_density_becomes_one_that_is_stated(tmp_path: Path) -> None:
    without = (MIDDLES + r"<inertial [^>]*>", r"\1")
    heavy = (UNSIZED[0], UNSIZED[0].replace("size", 'mass="1" size'))
    reading = mjcf(tmp_path, without, heavy)
    text = patch_file(reading, on_chassis(reading, 4)).text
    middle = r'<body name="left_middle"[^>]*>\s*<joint [^>]*>\s*<geom class="tread" mass="0\.75"'
    assert re.search(middle, text)
    two = mjcf(tmp_path, without, (heavy[0], 2 * heavy[1].replace('"1"', '"0.5"')))
    with refusing(SAID, r"^body\[left_middle\] must state its mass, for"):
        patch_file(two, on_chassis(two, 4))


def test_a_mass_by_density_stays_unstated_while_a_wheel_only_moves(tmp_path: Path) -> None:
    without = (MIDDLES + r"<inertial [^>]*>", r"\1")
    reading = mjcf(tmp_path, without, (r'_middle" pos="0.0 ', '_middle" pos="0.02 '))
    text = patch_file(reading, on_chassis(reading, 3)).text
    assert text == reading.text.replace('_middle" pos="0.02 ', '_middle" pos="0 ')


def test_wheels_of_mjcf_that_are_not_found_or_moved_are_named(tmp_path: Path) -> None:
    body = r'<body name="(left|right)_middle" pos="0.0 (\S+) 0">((?:.|\n)*?)</body>'
    in_frame = r'<frame pos="0.02 \2 0"><body name="\1_middle">\3</body></frame>'
    framed = mjcf(tmp_path, (body, in_frame))
    with refusing(SAID, "must be in another body itself"):
        patch_file(framed, on_chassis(framed, 3))
    nameless = mjcf(tmp_path, ('<body name="left_middle" ', "<body "))
    with refusing(SAID, r"must have a name, to be found in the text, got no"):
        patch_file(nameless, on_chassis(nameless, 4))


def test_grousers_of_mjcf_meet_the_ground_as_the_wheel_did(tmp_path: Path) -> None:
    pytest.importorskip("mujoco")
    of_contact = (
        'friction="1 0.005 0.0001" condim="4" priority="2" contype="1" conaffinity="1"'
        ' solref="0.03 1"'
    )
    reading = mjcf(tmp_path, (UNSIZED[0], UNSIZED[0].replace("size", f"{of_contact} size")))
    text = patch_file(reading, with_gears(reading, replace(GEAR, grouser_count=3))).text
    boxes = re.findall(r'<geom type="box" pos="[^"]*" quat=.*?/>', text)
    assert len(boxes) == 8 * 3
    for box in boxes:
        assert box.endswith(f'mass="0" class="tread" {of_contact}/>')
