"""Couplings of joints and tilts of a root that are not read give warnings."""

import re
from pathlib import Path

import pytest

import crawler2d as c2d
from tests.reading.carts import FILES, LIMIT, SIDES, link, pair, read, urdf

WHEELS = (pair("front", 0.2), pair("rear", -0.2))
FOLLOWING = pair("middle", 0.0, limit='<limit effort="5" velocity="10"/>{}')


def mimic(leader: str, more: str = "") -> str:
    return f'<mimic joint="{leader}"{more}/>'


def warned(reading: c2d.Reading, *words: str) -> list[str]:
    return [each for each in reading.warnings if all(word in each for word in words)]


def test_a_wheel_of_a_urdf_that_mimics_another_gets_a_warning_with_its_line(
    tmp_path: Path,
) -> None:
    text = urdf(*WHEELS, FOLLOWING.replace("{}", "\n" + mimic("left_rear_joint", ' offset="1"')))
    reading = read(tmp_path, text)
    first, _ = found = warned(reading, "moves by itself")
    lines = [n for n, line in enumerate(text.splitlines(), 1) if "<mimic" in line]
    for number, side, warning in zip(lines, ("left", "right"), found, strict=True):
        assert warning.startswith(f"cart.urdf:{number}: mimic[{side}_middle_joint] is left out")
    assert first.endswith("got left_rear_joint, times 1 plus 1 rad")
    assert not warned(read(tmp_path, text.replace("mimic", "copy")), "mimic")


def test_what_carries_no_wheel_may_mimic_without_a_word(tmp_path: Path) -> None:
    finger = link("finger", f'type="revolute"><axis xyz="0 0 1"/>{LIMIT}{mimic("thumb_joint")}')
    assert not warned(read(tmp_path, urdf(*WHEELS, finger)), "mimic")


def test_a_wheel_of_an_sdf_that_mimics_another_gets_a_warning(tmp_path: Path) -> None:
    text = (FILES / "cart.sdf").read_text()
    own = re.compile(r'(<joint name="left_middle_joint".*?<axis>)', re.DOTALL)
    follow = '<mimic joint="left_rear_joint"><multiplier>2</multiplier></mimic>'
    reading = read(tmp_path, own.sub(rf"\1{follow}", text), "cart.sdf")
    (warning,) = warned(reading, "mimic[left_middle_joint]")
    assert warning.endswith("got left_rear_joint, times 2 plus 0 rad")


def test_a_flipper_that_mimics_the_other_one_gets_a_warning(tmp_path: Path) -> None:
    text = (FILES / "cart.urdf").read_text()
    own = re.compile(r'(<joint name="left_flipper_joint".*?<axis[^>]*/>)', re.DOTALL)
    reading = read(tmp_path, own.sub(rf"\1{mimic('right_flipper_joint')}", text))
    assert len(warned(reading, "mimic[left_flipper_joint] is left out")) == 1


def joined(before: str) -> str:
    """The cart as MJCF with something before its actuators."""
    return (FILES / "cart.xml").read_text().replace("<actuator>", f"{before}\n<actuator>")


def test_equal_wheels_of_mjcf_get_a_warning(tmp_path: Path) -> None:
    pytest.importorskip("mujoco")
    pairs = '<joint joint1="left_middle_joint" joint2="left_rear_joint"{}/>'
    equal = f"<equality>{pairs}</equality>"
    found = warned(read(tmp_path, joined(equal.format("")), "cart.xml"), "equality[")
    assert found == warned(read(tmp_path, joined(equal.format("")), "cart.xml"), "moves by itself")
    assert found[0].endswith("got left_middle_joint, left_rear_joint")
    assert not warned(read(tmp_path, joined(equal.format(' active="false"')), "cart.xml"), "equal")


def test_wheels_of_mjcf_on_a_tendon_get_a_warning_in_plain_words(tmp_path: Path) -> None:
    pytest.importorskip("mujoco")
    ends = ("rear", "middle", "front")
    tendons = "".join(
        f'<fixed name="{side}_drive">'
        + "".join(f'<joint joint="{side}_{end}_joint" coef="1"/>' for end in ends)
        + "</fixed>"
        for side, _ in SIDES
    )
    text = joined(f"<tendon>{tendons}</tendon>")
    assert not warned(read(tmp_path, text, "cart.xml"), "tendon")  # nothing pulls them
    for side, _ in SIDES:
        text = re.sub(rf'<velocity joint="{side}_(middle|front)_joint".*?/>', "", text)
        text = text.replace(
            f'<velocity joint="{side}_rear_joint"', f'<velocity tendon="{side}_drive"'
        )
    reading = read(tmp_path, text, "cart.xml")
    first, second = warned(reading, "without the motor that pulls at it")
    line = next(n for n, each in enumerate(text.splitlines(), 1) if 'tendon="left' in each)
    assert first.startswith(f"cart.xml:{line}: tendon[left_drive] is left out")
    assert first.endswith("got left_rear_joint, left_middle_joint, left_front_joint")
    assert "tendon[right_drive]" in second


def test_a_joint_of_mjcf_that_an_equation_stops_gets_a_warning(tmp_path: Path) -> None:
    pytest.importorskip("mujoco")
    stopped = '<equality><joint joint1="left_middle_joint"/></equality>'
    (found,) = warned(read(tmp_path, joined(stopped), "cart.xml"), "equality[left_middle_joint]")
    assert found.endswith("got left_middle_joint")


@pytest.mark.parametrize(
    ("equation", "told"),
    [
        ('<weld body1="hull"/>', "fixes the robot to the world, but the robot has to drive, got h"),
        ('<weld site1="stake" site2="hook"/>', "fixes the robot to the world"),
        (
            '<connect body1="left_rear" body2="hull" anchor="0 0 0"/>',
            "here joints alone hold these bodies, got left_rear, hull",
        ),
        ('<weld body1="hull" active="false"/>', ""),
        ('<weld body1="crate"/>', ""),
    ],
)
def test_bodies_of_mjcf_that_an_equation_holds_get_a_warning(
    tmp_path: Path, equation: str, told: str
) -> None:
    pytest.importorskip("mujoco")
    text = joined(f"<equality>{equation}</equality>")
    text = text.replace("<freejoint/>", '<freejoint/><site name="hook"/>', 1)
    crate = '<site name="stake"/><body name="crate" pos="9 0 1"><freejoint/><geom size="1"/></body>'
    text = text.replace("<worldbody>", f"<worldbody>{crate}")
    found = warned(read(tmp_path, text, "cart.xml", model="hull"), "equality[")
    assert len(found) == bool(told)
    assert all(told in each for each in found)


@pytest.mark.parametrize(
    "figure", ['stiffness="9"', 'damping="1"', 'frictionloss="1"', 'range="-1 1"']
)
def test_a_passive_tendon_of_mjcf_gets_a_warning(tmp_path: Path, figure: str) -> None:
    pytest.importorskip("mujoco")
    joint = '<joint joint="left_rear_joint" coef="1"/>'
    text = joined(f'<tendon><fixed name="brake" {figure}>{joint}</fixed></tendon>')
    (found,) = warned(read(tmp_path, text, "cart.xml"), "tendon[brake] is left out")
    assert found.endswith("its spring, damper, friction or limit, got left_rear_joint")


def test_an_actuator_of_mjcf_that_pushes_a_body_gets_a_warning(tmp_path: Path) -> None:
    pytest.importorskip("mujoco")
    text = (FILES / "cart.xml").read_text()
    magnet = '<adhesion name="magnet" body="hull" ctrlrange="0 1" gain="50"/>'
    fan = '<motor name="fan" site="hook" gear="1 0 0 0 0 0"/>'
    text = text.replace("</actuator>", f"{magnet}{fan}</actuator>")
    text = text.replace("<freejoint/>", '<freejoint/><site name="hook"/>', 1)
    found = warned(read(tmp_path, text, "cart.xml"), "here motors turn joints, and push nothing")
    assert [each.rpartition(" ")[2] for each in found] == ["hull", "hook"]


@pytest.mark.parametrize(
    ("name", "place", "kept"),
    [
        ("cart.sdf", '<model name="cart"><pose>0 0 1 {0:.4f} 0 1.5</pose>', "model"),
        ("cart.xml", '<body name="hull" axisangle="1 0 0 {0:.4f}"', "body"),
        ("cart.xml", '<body name="hull" axisangle="0 1 0 -{0:.4f}"', "body"),
    ],
)
def test_a_root_that_leans_gets_a_warning(tmp_path: Path, name: str, place: str, kept: str) -> None:
    if name == "cart.xml":
        pytest.importorskip("mujoco")
    begin = '<model name="cart">' if kept == "model" else '<body name="hull"'
    text = (FILES / name).read_text()
    assert text.count(begin) == 1
    leaning, upright = (
        read(tmp_path, text.replace(begin, place.format(angle)), name) for angle in (0.5236, 0.0)
    )
    (warning,) = warned(leaning, "upright")
    assert f"is left out: the z axis of the {kept} is taken as upwards" in warning
    assert warning.endswith("got 30 degrees off upright")
    assert not warned(upright, "upright")
    assert leaning.robot == upright.robot


def test_servos_of_the_chassis_are_a_controller_beside_other_motors_on_flippers(
    tmp_path: Path,
) -> None:
    """Three wheels a side with kv = 10; those on flippers are given torques."""
    pytest.importorskip("mujoco")
    on_flippers = re.compile(r'<velocity (joint="[^"]*flipper_(?:root|tip)_joint") kv="10"')
    text = (FILES / "cart.xml").read_text()
    mixed = read(tmp_path, on_flippers.sub(r"<motor \1", text), "cart.xml")
    assert mixed.robot.drivetrain.controller == c2d.PI(gain=30.0)
    assert len(warned(mixed, "no servo of their speed", "left_flipper_tip_joint")) == 1
    assert "6 lines" in mixed.sources["robot.drivetrain.controller"]
    of_chassis = re.compile(r'<velocity (joint="left_rear_joint") kv="10"')
    some = read(tmp_path, of_chassis.sub(r"<motor \1", text), "cart.xml")
    assert some.robot.drivetrain.controller is None
