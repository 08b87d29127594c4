"""A file with other wheels is read as the other robot, and nothing else in it changes."""

import re
import shutil
import subprocess
import warnings
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any
from xml.etree import ElementTree

import pytest

import crawler2d as c2d
from crawler2d.patching.patch import _check, _join_ends, _left, _summary, add_label, patch_file
from crawler2d.writing.document import Document, spans_of
from tests.kept import refusing
from tests.reading.carts import (
    FILES,
    LIMIT,
    ROBOTS,
    WHEELS,
    link,
    pair,
    quietly,
    read,
    urdf,
    wheel,
)

SAID = Path(__file__).with_name("said.txt")
CARTS = ("cart.sdf", "cart.urdf", "cart.xml")


def on_chassis(reading: c2d.Reading, count: int, radius: float | None = None) -> c2d.Robot:
    """The robot of a file with a number of wheels on its chassis; those of its flippers stay."""
    robot = reading.robot
    return robot.with_track(c2d.LineOfWheels(count, wheel_radius=radius))


def with_own_flippers(reading: c2d.Reading) -> c2d.Robot:
    """The robot of a file, whose flippers have their own track."""
    robot = reading.robot
    assert robot.flippers is not None
    return replace(robot, flippers=replace(robot.flippers, track=c2d.LineOfWheels(3)))


def reread(reading: c2d.Reading, text: str, folder: Path) -> c2d.Reading:
    path = folder / reading.path.name
    path.write_text(text, encoding="utf-8")
    return quietly(path)


@pytest.mark.parametrize("count", [2, 4, 7])
@pytest.mark.parametrize("name", CARTS)
def test_a_line_of_another_number_of_wheels_reads_back(
    name: str, count: int, tmp_path: Path
) -> None:
    reading = quietly(FILES / name)
    robot = on_chassis(reading, count)
    again = reread(reading, patch_file(reading, robot).text, tmp_path).robot
    assert again.track == c2d.LineOfWheels(count)
    assert again.mass == pytest.approx(robot.mass, rel=1e-6)
    assert again.center_of_mass == pytest.approx(robot.center_of_mass, abs=1e-6)
    # The motors of a side share its torque, and all wheels turn: none is new without a motor.
    torque = reading.robot.drivetrain.max_torque
    assert again.drivetrain.max_torque == pytest.approx(torque, rel=1e-6)
    assert again.drivetrain.max_speed == pytest.approx(robot.drivetrain.max_speed, rel=1e-6)
    assert again.track_mass == pytest.approx(robot.track_mass, rel=1e-6)


ROTORS = {
    "class": ("<default>", '<default><joint armature="0.01"/>'),
    "joint": ("<joint name=", '<joint armature="0.01" name='),
    "motor": ("<velocity ", '<velocity armature="0.01" '),
}


@pytest.mark.parametrize("where", ROTORS)
def test_more_and_larger_wheels_keep_the_rotor_of_their_side(where: str, tmp_path: Path) -> None:
    pytest.importorskip("mujoco")
    old, new = ROTORS[where]
    path = tmp_path / "rotor.xml"
    path.write_text(
        (FILES / "cart.xml").read_text().replace(old, new, 1 if where == "class" else -1)
    )
    reading = quietly(path)
    for radius in (None, 0.1):
        again = reread(reading, patch_file(reading, on_chassis(reading, 5, radius)).text, tmp_path)
        was, found = (
            (each.drivetrain, each.outline.rear_radius) for each in (reading.robot, again.robot)
        )
        assert was[0].controller is not None
        assert found[0].controller is not None
        for before, after in (
            (was[0].rotor_inertia, found[0].rotor_inertia),
            (was[0].controller.gain, found[0].controller.gain),
        ):
            assert before > 0.0
            assert after / found[1] ** 2 == pytest.approx(before / was[1] ** 2, rel=1e-6)


def mjcf(folder: Path, motor: str, default: str = "") -> c2d.Reading:
    """The cart with other motors on the wheels of its chassis."""
    text = (FILES / "cart.xml").read_text().replace("<default>", f"<default>{default}", 1)
    of_wheels = r'<velocity (joint="\w+_(?:rear|middle|front)_joint").*?/>'
    path = folder / "motors.xml"
    path.write_text(re.sub(of_wheels, motor, text), encoding="utf-8")
    return quietly(path)


SERVO = 'biastype="affine" gainprm="20" biasprm="0 0 -10" ctrlrange="-3 3" forcerange="-5 5"'


@pytest.mark.parametrize(
    "motor",
    [
        r'<motor \1 gear="20" ctrlrange="-1 1" forcerange="-100 100"/>',
        r'<motor \1 gear="20" ctrlrange="-1 1" forcerange="-0.5 0.5"/>',
        r'<motor \1 gear="20" ctrlrange="-1 1" armature="0.001"/>',
        r'<general \1 gear="20" ctrlrange="-1 1"/>',
        rf"<general \1 {SERVO}/>",
    ],
)
def test_motors_of_mjcf_keep_what_they_do_together(tmp_path: Path, motor: str) -> None:
    pytest.importorskip("mujoco")
    reading = mjcf(tmp_path, motor)
    was = reading.robot.drivetrain
    # On the chassis, and 15 on the flippers, where a wheel half as large counts twice.
    assert was.max_torque in (60.0 + 15.0, 30.0 + 15.0, 15.0 + 15.0)
    for radius in (None, 0.1):
        text = patch_file(reading, on_chassis(reading, 5, radius)).text
        found = reread(reading, text, tmp_path).robot
        size = found.outline.rear_radius / reading.robot.outline.rear_radius
        own = found.drivetrain
        assert own.max_torque == pytest.approx(was.max_torque * size)
        assert own.rotor_inertia == pytest.approx(was.rotor_inertia * size**2)
        assert own.max_speed == pytest.approx(was.max_speed)
        gains = [0.0 if each.controller is None else each.controller.gain for each in (was, own)]
        assert gains[1] == pytest.approx(gains[0] * size**2)


@pytest.mark.parametrize(
    ("default", "motor"),
    [
        ('<motor gear="20" ctrlrange="-1 1"/>', r"<motor \1/>"),
        (f"<general {SERVO}/>", r"<general \1/>"),
    ],
)
def test_motors_of_a_class_are_refused_where_their_text_does_not_hold_their_limits(
    tmp_path: Path, default: str, motor: str
) -> None:
    pytest.importorskip("mujoco")
    reading = mjcf(tmp_path, motor, default)
    with refusing(SAID, r"max_torque must be .*, that of all wheels"):
        patch_file(reading, on_chassis(reading, 5))


@pytest.mark.parametrize("count", [2, 4, 5])
def test_motors_of_some_wheels_keep_what_they_do_together(tmp_path: Path, count: int) -> None:
    """The middle ones roll freely: copied or removed wheels may have a motor or not."""
    pytest.importorskip("mujoco")
    text = (FILES / "cart.xml").read_text()
    path = tmp_path / "some.xml"
    path.write_text(re.sub(r'<velocity joint="\w+_middle_joint".*?/>', "", text))
    reading = quietly(path)
    found = reread(reading, patch_file(reading, on_chassis(reading, count)).text, tmp_path).robot
    assert found.drivetrain.max_torque == pytest.approx(10.0 + 15.0)
    assert found.drivetrain.controller is not None
    assert found.drivetrain.controller.gain == pytest.approx(20.0 + 50.0)


@pytest.mark.parametrize("name", ["urdf", "sdf", "mjcf"])
def test_motors_that_share_evenly_still_do_with_other_wheels_on_one_carrier(
    name: str, tmp_path: Path
) -> None:
    """As simulated for the other robot: each wheel has an equal part of the total torque."""
    if name == "mjcf":
        pytest.importorskip("mujoco")
    robot = c2d.robots.engineer(track=c2d.LineOfWheels(3))
    motors = replace(robot.drivetrain, rotor_inertia=0.02, controller=c2d.PI(gain=20.0))
    path = tmp_path / f"robot.{'xml' if name == 'mjcf' else name}"
    getattr(replace(robot, drivetrain=motors), f"to_{name}")(path)
    reading = quietly(path)
    arms = reading.robot.flippers
    assert arms is not None
    for count, of_arms in ((5, 3), (3, 2)):
        other = replace(
            reading.robot,
            track=c2d.LineOfWheels(count),
            flippers=replace(arms, track=c2d.LineOfWheels(of_arms)),
        )
        again = reread(reading, patch_file(reading, other).text, tmp_path)
        joints = [again.tree.joints[each] for each in again.wheels["name"].tolist()]
        forces = [joint.effort for joint in joints] / again.wheels["radius"]
        assert len(forces) == 2 * (count + of_arms)
        assert forces == pytest.approx([forces[0]] * len(forces))
        was, found = reading.robot.drivetrain, again.robot.drivetrain
        assert found.max_torque == pytest.approx(was.max_torque)
        assert found.rotor_inertia == pytest.approx(was.rotor_inertia)
        assert found.torque_sharing == "wheel"
        assert not [each for each in again.warnings if "rotor" in each]


@pytest.mark.parametrize("name", CARTS)
def test_larger_wheels_keep_speed_and_force(name: str, tmp_path: Path) -> None:
    reading = quietly(FILES / name)
    track = c2d.LineOfWheels(5, wheel_radius=0.1)
    robot = replace(reading.robot, track=track)
    again = reread(reading, patch_file(reading, robot).text, tmp_path).robot
    assert again.outline.front_radius == pytest.approx(0.1)
    assert len(again.wheels()) == len(robot.wheels())
    assert again.drivetrain.max_speed == pytest.approx(reading.robot.drivetrain.max_speed)
    force, was = (
        each.drivetrain.max_torque / each.outline.rear_radius for each in (again, reading.robot)
    )
    assert force == pytest.approx(was)


@pytest.mark.parametrize("name", CARTS)
def test_gear_wheels_read_back(name: str, tmp_path: Path) -> None:
    reading = quietly(FILES / name)
    gear = c2d.GearWheel(grouser_count=12, grouser_height=0.02, tip_thickness=0.008)
    arms = reading.robot.flippers
    assert arms is not None
    arms = replace(arms, track=c2d.LineOfWheels(2))  # those of the flippers stay round
    robot = replace(reading.robot, track=c2d.LineOfWheels(4, wheel=gear), flippers=arms)
    again = reread(reading, patch_file(reading, robot).text, tmp_path).robot
    assert isinstance(again.track, c2d.LineOfWheels)
    assert again.track.count == 4
    found = again.track.wheel
    assert isinstance(found, c2d.GearWheel)
    assert found.grouser_count == 12
    # Files have boxes to eight digits.
    assert found.grouser_height == pytest.approx(0.02, abs=1e-6)
    assert found.tip_thickness == pytest.approx(0.008, abs=1e-6)
    assert found.phase_fraction == pytest.approx(gear.phase_fraction, abs=1e-4)
    assert again.mass == pytest.approx(robot.mass, rel=1e-6)


@pytest.mark.parametrize("name", CARTS)
def test_wheels_of_flippers_change_where_they_hang(name: str, tmp_path: Path) -> None:
    reading = quietly(FILES / name)
    again = reread(reading, patch_file(reading, with_own_flippers(reading)).text, tmp_path).robot
    assert again.track == reading.robot.track
    assert again.flippers is not None
    assert again.flippers.track == c2d.LineOfWheels(3)


def without_wheels(text: str) -> str:
    """The content of a file without chassis wheels, motors of wheels and spaces."""
    root = ElementTree.fromstring(text)
    for motor in root.iter():
        if re.search(r"flipper_(root|tip)", motor.get("name", "") + motor.get("joint", "")):
            for of_motor in motor.iter():
                for name in {"effort", "forcerange", "kv"}.intersection(of_motor.keys()):
                    of_motor.set(name, "")
                if of_motor.tag == "effort":
                    of_motor.text = ""
    for parent in list(root.iter()):
        for child in list(parent):
            named = child.get("name", "") + child.get("joint", "") + child.get("reference", "")
            if re.search(r"(left|right)_(rear|middle|front)", named):
                parent.remove(child)
    return re.sub(r"\s", "", ElementTree.tostring(root, encoding="unicode"))


@pytest.mark.parametrize("name", CARTS)
def test_only_wheels_are_changed(name: str) -> None:
    reading = quietly(FILES / name)
    text = patch_file(reading, on_chassis(reading, 4)).text
    assert text.count("left_flipper_tip") == reading.text.count("left_flipper_tip") > 0
    assert without_wheels(text) == without_wheels(reading.text)


def test_a_diff_names_the_file_and_applies_to_it() -> None:
    reading = quietly(FILES / "cart.urdf")
    patch = patch_file(reading, on_chassis(reading, 4))
    assert patch.diff.startswith("--- cart.urdf\n+++ cart.urdf (other wheels)\n@@")
    removed = [line[1:] for line in patch.diff.splitlines()[2:] if line.startswith("-")]
    added = [line[1:] for line in patch.diff.splitlines()[2:] if line.startswith("+")]
    kept = set(patch.text.splitlines())
    assert removed
    assert set(added) <= kept
    assert set(removed) <= set(reading.text.splitlines())


@pytest.mark.parametrize("name", ["absolem.sdf", "marv.sdf"])
def test_a_diff_of_a_long_file_has_the_lines_of_changed_wheels_alone(name: str) -> None:
    reading = quietly(ROBOTS / name)
    arms = reading.robot.flippers
    assert arms is not None
    assert isinstance(arms.track, c2d.LineOfWheels)
    longer = replace(
        reading.robot, flippers=replace(arms, track=c2d.LineOfWheels(arms.track.count + 1))
    )
    patch = patch_file(reading, longer)
    gone = [line[1:].strip() for line in patch.diff.splitlines()[2:] if line.startswith("-")]
    assert gone
    assert all(re.match(r"<(pose|mass|i[xyz]{2}|radius|effort|velocity)>", line) for line in gone)


def test_a_diff_applies_to_its_file(tmp_path: Path) -> None:
    patch = shutil.which("patch")
    if patch is None:
        pytest.skip("needs patch")
    for name in CARTS:
        reading = quietly(FILES / name)
        for count in (2, 7):
            found = patch_file(reading, on_chassis(reading, count), "a label")
            path = tmp_path / name
            path.write_text(reading.text, encoding="utf-8")
            subprocess.run([patch, "-s", path], input=found.diff, text=True, timeout=60, check=True)
            assert path.read_text(encoding="utf-8") == found.text


def test_the_motor_of_a_wheel_is_copied_with_it(tmp_path: Path) -> None:
    """A transmission, a plugin with a list of joints, and ros2_control."""
    names = ("left_front", "right_front", "left_rear", "right_rear")
    drives = "".join(
        f"""
<transmission name="t_{name}"><joint name="{name}_joint"/><actuator name="m_{name}"/></transmission>
<gazebo reference="{name}"><mu1>0.75</mu1><mu2>0.75</mu2></gazebo>"""
        for name in names
    )
    listed = "".join(f"<joint_name>{name}_joint</joint_name>" for name in names)
    plugin = f'<gazebo><plugin name="diff_drive" filename="d.so">{listed}</plugin></gazebo>'
    path = tmp_path / "cart.urdf"
    path.write_text(urdf(WHEELS, drives, plugin), encoding="utf-8")
    reading = quietly(path)
    root = ElementTree.fromstring(patch_file(reading, on_chassis(reading, 3)).text)
    joints = [each.get("name") for each in root.findall("joint")]
    assert len(joints) == len(set(joints)) == 6
    assert sorted(each.text or "" for each in root.iter("joint_name")) == sorted(map(str, joints))
    transmissions = root.findall("transmission")
    assert len({each.get("name") for each in transmissions}) == 6
    assert len({each.find("actuator").get("name") for each in transmissions}) == 6  # type: ignore[union-attr]
    assert {each.find("joint").get("name") for each in transmissions} == set(joints)  # type: ignore[union-attr]
    links = {each.get("name") for each in root.findall("link")} - {"hull"}
    assert {each.get("reference") for each in root.findall("gazebo")} - {None} == links


def test_a_plugin_gets_the_radius_of_larger_wheels(tmp_path: Path) -> None:
    plugin = """<gazebo><plugin name="diff_drive" filename="d.so">
<left_joint>left_front_joint</left_joint><wheel_radius>0.08</wheel_radius>
<wheel_separation>0.3</wheel_separation></plugin></gazebo>"""
    path = tmp_path / "cart.urdf"
    path.write_text(urdf(WHEELS, plugin), encoding="utf-8")
    reading = quietly(path)
    text = patch_file(reading, on_chassis(reading, 2, radius=0.1)).text
    assert "<wheel_radius>0.1</wheel_radius>" in text
    assert "<wheel_separation>0.3</wheel_separation>" in text


def test_double_wheels_are_copied_side_by_side(tmp_path: Path) -> None:
    path = tmp_path / "cart.urdf"
    path.write_text(urdf(WHEELS, pair("twin", 0.2, y=0.25), pair("back", -0.2, y=0.25)))
    reading = quietly(path)
    again = reread(reading, patch_file(reading, on_chassis(reading, 3)).text, tmp_path)
    assert again.robot.track == c2d.LineOfWheels(3)
    assert len(again.wheels) == 12


def test_public_models_change_their_wheels() -> None:
    for name in ("absolem.sdf", "marv.sdf"):
        reading = quietly(ROBOTS / name)
        arms = reading.robot.flippers
        assert arms is not None
        assert isinstance(arms.track, c2d.LineOfWheels)
        more = replace(arms, track=c2d.LineOfWheels(arms.track.count + 1))
        patch = patch_file(reading, replace(reading.robot, flippers=more))
        assert patch.text.count("<link name=") == reading.text.count("<link name=") + 4


def test_wheels_that_cannot_be_changed_are_refused_by_name(tmp_path: Path) -> None:
    reading = quietly(FILES / "cart.urdf")
    with refusing(SAID, "must have wheels that differ from the file's"):
        patch_file(reading, reading.robot)
    belted = replace(reading.robot.drivetrain, torque_sharing="track")
    with refusing(SAID, "tracks of the chassis must be wheels"):
        patch_file(reading, replace(reading.robot, drivetrain=belted, track=c2d.BeltTrack()))
    with refusing(SAID, r"robot\.flippers must be where the file has them"):
        patch_file(reading, replace(reading.robot, flippers=None))
    heavier = replace(on_chassis(reading, 4), mass=reading.robot.mass + 1.0)
    with refusing(SAID, "the changed file, read again: mass"):
        patch_file(reading, heavier)
    foreign = tmp_path / "cart.urdf"
    foreign.write_bytes(
        b"<?xml version='1.0' encoding='latin-1'?><!-- \xe9 -->" + urdf(WHEELS).encode()
    )
    with refusing(SAID, "must be UTF-8"):
        patch_file(quietly(foreign), on_chassis(reading, 4))


def test_a_chassis_whose_wheels_all_hang_on_flippers_gets_none_in_its_file(tmp_path: Path) -> None:
    """The chassis stands on the wheels at the pivots of both pairs."""
    arms = "".join(
        link(f"{side}_{end}", f'type="revolute"><axis xyz="0 1 0"/>{LIMIT}', f"{x} {y} 0")
        + wheel(f"{side}_{end}_root", "0 0 0", parent=f"{side}_{end}")
        + wheel(f"{side}_{end}_tip", f"{x} 0 0", parent=f"{side}_{end}", radius="0.05")
        for end, x in (("front", 0.2), ("rear", -0.2))
        for side, y in (("left", 0.25), ("right", -0.25))
    )
    reading = read(tmp_path, urdf(arms))
    with refusing(SAID) as caught:
        patch_file(reading, on_chassis(reading, 3))
    assert (caught.value.path, caught.value.value) == ("wheels of the chassis", "none")
    assert caught.value.rule == "must have wheels of its own in the file, to be changed there"


def test_a_patch_warns_of_nothing() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        reading = c2d.read_robot(FILES / "cart.sdf")
        patch_file(reading, on_chassis(reading, 4))


def test_a_count_of_wheels_in_a_plugin_is_named_when_wheels_are_added() -> None:
    text = "<model>\n<plugin>\n<num_wheel_pairs>4</num_wheel_pairs></plugin>\n</model>"
    root = spans_of(text.encode())
    named: Any = {"joint": SimpleNamespace(name="j"), "links": ("l",), "is_none": False}
    added: Any = SimpleNamespace(action="added", **named)
    changed: Any = SimpleNamespace(action="changed", **named)
    left = _left([added, added], root, text)
    assert left == ("num_wheel_pairs in line 3 is still 4",)
    assert "by hand (there are 2 wheels more): num_wheel" in _summary([added, added], [], left)
    assert _left([changed], root, text) == ()
    assert "by hand" not in _summary([changed], [], ())


def test_lengths_have_no_digits_of_rounding_and_inertias_every_bit() -> None:
    for is_exact, expected in ((False, "0.3"), (True, "0.30000000000000004")):
        document = Document('<radius v="0.1"/>')
        document.multiply(document.root, [3.0], "v", is_exact=is_exact)
        assert document.text == f'<radius v="{expected}"/>'


@pytest.mark.parametrize("label", ["a--b", "on a---b", "-----", "--"])
def test_a_label_with_any_number_of_hyphens_leaves_the_file_well_formed(label: str) -> None:
    assert ElementTree.fromstring(add_label("<robot/>", label)).tag == "robot"


@pytest.mark.parametrize("name", CARTS)
def test_a_file_that_begins_with_a_mark_of_its_byte_order_gets_a_label(
    name: str, tmp_path: Path
) -> None:
    path = tmp_path / name
    path.write_bytes(b"\xef\xbb\xbf" + (FILES / name).read_bytes())
    reading = quietly(path)
    text = patch_file(reading, on_chassis(reading, 4), "four wheels").text
    assert text.startswith("\ufeff<")
    assert text.count("<!-- four wheels -->") == text.count("\ufeff") == 1
    assert reread(reading, text, tmp_path).robot.track == c2d.LineOfWheels(4)


@pytest.mark.parametrize("name", ["cart.xacro", "cart.urdf.xacro"])
def test_an_expanded_xacro_is_read_again_as_a_urdf(name: str, tmp_path: Path) -> None:
    pytest.importorskip("xacrodoc")
    shutil.copy(FILES / "cart.xacro", tmp_path / name)
    reading = quietly(tmp_path / name)
    robot = on_chassis(reading, 4)
    patch = patch_file(reading, robot)
    path = tmp_path / "changed.urdf"
    path.write_text(patch.text, encoding="utf-8")
    assert quietly(path).robot.track == robot.track
    broken = reading.text.replace('<mass value="16"', '<mass value="-16"')
    with refusing(SAID, "^the changed file, read again: cart.urdf:"):
        _check(reading, robot, broken)


def test_equal_lines_at_the_end_of_a_change_stay_in_their_order() -> None:
    lines = ["-a", "-1", "-2", "-3", "+b", "+1", "+2", "+3", " c"]
    _join_ends(lines, 0)
    assert lines == ["-a", "+b", " 1", " 2", " 3", " c"]
    whole = [" c", "-1", "+0", "+1"]
    _join_ends(whole, 1)
    assert whole == [" c", "+0", " 1"]
