"""What joints of flippers and wheels state and a robot in side view does not have."""

import re
from pathlib import Path

import pytest

import crawler2d as c2d
from tests.reading.carts import FILES, quietly, read

CARTS = ("cart.sdf", "cart.urdf", "cart.xml")


def cart(name: str) -> str:
    """The text of a cart, whose parts of MJCF need MuJoCo."""
    if name.endswith(".xml"):
        pytest.importorskip("mujoco")
    return (FILES / name).read_text(encoding="utf-8")


def told_of(word: str, reading: c2d.Reading) -> list[str]:
    return [warning for warning in reading.warnings if word in warning]


def narrowed(name: str, lower: str = "-0.1", upper: str = "0.2") -> str:
    """A cart whose flippers have a range."""
    text = cart(name)
    assert text.count("-3.2") == 2
    return re.sub(r"(?<=[\">])-3\.2", lower, text).replace("3.2", upper)


@pytest.mark.parametrize(
    ("name", "lines"), [("cart.sdf", "90, 124"), ("cart.urdf", "82, 113"), ("cart.xml", "45, 59")]
)
def test_the_range_of_a_flipper_gets_a_warning(tmp_path: Path, name: str, lines: str) -> None:
    (told,) = told_of("range[", read(tmp_path, narrowed(name), name))
    assert told.startswith(f"{name}:{lines}: range[left_flipper_joint, right_flipper_joint] is not")
    assert told.endswith("got -0.1 to 0.2 rad")


def test_each_of_several_ranges_is_named(tmp_path: Path) -> None:
    """Those of flippers with opposite axes, say."""
    text = narrowed("cart.urdf").replace('lower="-0.1" upper="0.2"', 'lower="-0.2" upper="0.1"', 1)
    (told,) = told_of("range[", read(tmp_path, text))
    assert told.endswith("got -0.2 to 0.1 rad, -0.1 to 0.2 rad")


@pytest.mark.parametrize(("half", "is_told"), [("3.1412", False), ("3.13", True), ("inf", False)])
def test_a_range_of_a_full_turn_is_none_up_to_rounding(
    tmp_path: Path, half: str, *, is_told: bool
) -> None:
    reading = read(tmp_path, narrowed("cart.sdf", f"-{half}", half), "cart.sdf")
    assert bool(told_of("range[", reading)) is is_told


def test_a_locked_flipper_has_no_range_but_a_note(tmp_path: Path) -> None:
    reading = read(tmp_path, narrowed("cart.urdf", "0.1", "0.1"))
    assert not told_of("range[", reading)
    assert any("locked in the file" in note for note in reading.notes)


@pytest.mark.parametrize("suffix", ["sdf", "urdf", "xml"])
def test_flippers_that_are_written_have_no_range(tmp_path: Path, suffix: str) -> None:
    if suffix == "xml":
        pytest.importorskip("mujoco")
    robot = c2d.robots.engineer(track=c2d.LineOfWheels(5))
    write = {"sdf": robot.to_sdf, "urdf": robot.to_urdf, "xml": robot.to_mjcf}[suffix]
    path = tmp_path / f"engineer.{suffix}"
    path.write_text(write(), encoding="utf-8")
    assert not told_of("range", quietly(path))


@pytest.mark.parametrize(
    ("name", "old", "new"),
    [
        ("cart.sdf", "<velocity>10</velocity></limit>", "\\g<0>{}"),
        ("cart.xml", '(<joint name="[a-z]*_(rear|front|middle)_joint")', '\\1 stiffness="50"'),
    ],
)
def test_wheels_on_springs_get_a_warning(tmp_path: Path, name: str, old: str, new: str) -> None:
    spring = "<dynamics><spring_stiffness>50</spring_stiffness></dynamics>"
    text, count = re.subn(old, new.format(spring), cart(name))
    assert count > 4
    (told,) = told_of("stiffness[", read(tmp_path, text, name))
    assert re.match(name + r":\d+: stiffness\[left_rear_joint, left_middle_joint, left_fr", told)
    assert told.endswith("got 50 N m/rad")


@pytest.mark.parametrize("is_first", [True, False])
def test_wheels_whose_position_mujoco_controls_get_a_warning(
    tmp_path: Path, *, is_first: bool
) -> None:
    """Also if a servo of their speed is on the same joint; that of a flipper is as it should be."""
    text = cart("cart.xml")
    servo = '<velocity joint="left_rear_joint" kv="10" forcerange="-5 5" ctrlrange="-10 10"/>'
    position = '<position joint="left_rear_joint" kp="10"/>'
    assert servo in text
    text = text.replace(servo, position + servo if is_first else servo + position)
    of_flipper = '<velocity joint="left_flipper_joint" kv="100"'
    text = text.replace(of_flipper, '<position joint="left_flipper_joint" kp="100"')
    (told,) = told_of("position", read(tmp_path, text, "cart.xml"))
    assert told.endswith("which here are driven at a speed, got left_rear_joint")


def test_a_servo_that_integrates_its_control_holds_a_speed(tmp_path: Path) -> None:
    before, servo = cart("cart.xml"), r'<intvelocity \1 kp="10" actrange="-9 9"'
    text = re.sub(r'<velocity (joint="[^"]*") kv="10"', servo, before)
    assert text != before
    assert not told_of("position", read(tmp_path, text, "cart.xml"))


WHEELS = [
    f"{side}_{end}_joint"
    for side in ("left", "right")
    for end in ("rear", "middle", "front", "flipper_root", "flipper_tip")
]
MOST = "left_rear_joint, left_middle_joint, left_front_joint, right_rear_joint and 6 more"


def transmission(of_joint: str, of_actuator: str = "") -> str:
    """Transmissions of all wheels, with what joint and actuator take."""
    return "".join(
        f"""<transmission name="t"><joint name="{wheel}">{of_joint}</joint>
        <actuator name="a">{of_actuator}</actuator></transmission>"""
        for wheel in WHEELS
    )


def interface(kind: str) -> str:
    return f"<hardwareInterface>{kind}JointInterface</hardwareInterface>"


def ros2_control(*commands: str) -> str:
    inner = "".join(f'<command_interface name="{each}"/>' for each in commands)
    inner += '<state_interface name="position"/>'
    joints = "".join(f'<joint name="{wheel}">{inner}</joint>' for wheel in WHEELS)
    return f"""<ros2_control name="r" type="system">{joints}</ros2_control>"""


def plugin() -> str:
    """One that drives all wheels."""
    joints = "".join(f"<left_joint>{wheel}</left_joint>" for wheel in WHEELS)
    return f'<gazebo><plugin name="diff_drive" filename="d.so">{joints}</plugin></gazebo>'


@pytest.mark.parametrize(
    ("parts", "is_told"),
    [
        (transmission(interface("hardware_interface/Position")), True),
        (transmission("", interface("Position")), True),
        (transmission(interface("Velocity"), interface("Position")), False),
        (transmission(interface("PosVel")), False),
        (transmission(""), False),
        (transmission(interface("Position")) + transmission(interface("Effort")), False),
        (ros2_control("position"), True),
        (ros2_control("position", "velocity"), False),
        (ros2_control(), False),
        (ros2_control("position") + plugin(), False),
    ],
)
def test_wheels_whose_position_a_urdf_commands_get_a_warning(
    tmp_path: Path, parts: str, *, is_told: bool
) -> None:
    text = cart("cart.urdf").replace("</robot>", f"{parts}</robot>")
    told = told_of("position of their", read(tmp_path, text))
    assert [each.partition(", got ")[2] for each in told] == ([MOST] if is_told else [])


def one_changed(name: str, old: str, new: str) -> str:
    """A cart, a figure of whose left rear wheel is another one."""
    text = cart(name)
    start = text.index('joint="left_rear' if name.endswith(".xml") else '<joint name="left_rear')
    assert old in text[start:]
    return text[:start] + text[start:].replace(old, new, 1)


@pytest.mark.parametrize(
    ("name", "old", "new", "lines"),
    [
        ("cart.sdf", "<effort>5<", "<effort>50<", "21, 57"),
        ("cart.urdf", 'effort="5"', 'effort="50"', "17, 50"),
        ("cart.xml", "-5 5", "-50 50", "75, 78"),
    ],
)
def test_torques_that_differ_left_and_right_get_a_warning(
    tmp_path: Path, name: str, old: str, new: str, lines: str
) -> None:
    """Five wheels a side, of 5 N m each, of which that at the tip counts twice."""
    reading = read(tmp_path, one_changed(name, old, new), name)
    (told,) = told_of("side to side", reading)
    assert told.startswith(f"{name}:{lines}: effort[left_rear_joint, right_rear_joint] differs")
    assert told.endswith("the mean of their sums is used, got 75 N m left and 30 N m right")
    assert reading.robot.drivetrain.max_torque == pytest.approx(52.5)


@pytest.mark.parametrize(("effort", "is_told"), [("5.3", False), ("5.4", True)])
def test_torques_may_differ_by_a_hundredth(tmp_path: Path, effort: str, *, is_told: bool) -> None:
    """Of the 30 N m of a side."""
    text = one_changed("cart.urdf", 'effort="5"', f'effort="{effort}"')
    assert bool(told_of("side to side", read(tmp_path, text))) is is_told


def test_motors_of_one_side_alone_get_a_warning(tmp_path: Path) -> None:
    joints = "".join(f"<left_joint>{wheel}</left_joint>" for wheel in WHEELS[:5])
    drive = f'<gazebo><plugin name="diff_drive" filename="d.so">{joints}</plugin></gazebo>'
    text = cart("cart.urdf").replace("</robot>", f"{drive}</robot>")
    (told,) = told_of("side to side", read(tmp_path, text))
    assert told.endswith("got 30 N m left and 0 N m right")


def test_gains_that_differ_left_and_right_get_a_warning(tmp_path: Path) -> None:
    text = one_changed("cart.xml", 'kv="10"', 'kv="30"')
    reading = read(tmp_path, text, "cart.xml")
    (told,) = told_of("side to side", reading)
    assert told.startswith("cart.xml:75, 78: gain[left_rear_joint, right_rear_joint] differs")
    assert told.endswith("got 100 N m s/rad left and 80 N m s/rad right")
    assert reading.robot.drivetrain.controller == c2d.PI(gain=90.0)


@pytest.mark.parametrize(("velocity", "is_told"), [("9.95", False), ("8", True), ("20", False)])
def test_speeds_that_differ_left_and_right_get_a_warning(
    tmp_path: Path, velocity: str, *, is_told: bool
) -> None:
    """A wheel that could be faster than the others of its side makes no side faster."""
    text = one_changed("cart.urdf", 'velocity="10"', f'velocity="{velocity}"')
    told = told_of("side to side", read(tmp_path, text))
    of_slower = "cart.urdf:17: velocity differs from side to side: both have that of the slower one"
    assert told == ([f"{of_slower}, got 1 m/s left and 1.25 m/s right"] if is_told else [])


def test_a_side_without_a_limit_of_speed_has_none(tmp_path: Path) -> None:
    text = cart("cart.urdf")
    start = text.index('<link name="right_rear')
    text = text[:start] + re.sub(r' velocity="[12]0"', "", text[start:])
    told = told_of("side to side", read(tmp_path, text))
    assert [each.partition("got ")[2] for each in told] == ["1.25 m/s left and no limit right"]


def test_speeds_beyond_that_of_the_drive_do_not_matter(tmp_path: Path) -> None:
    drive = '<gazebo><plugin name="DiffDrive" filename="d"><max_velocity>0.5</max_velocity>'
    text = one_changed("cart.urdf", 'velocity="10"', 'velocity="8"')
    text = text.replace("</robot>", f"{drive}</plugin></gazebo></robot>")
    assert not told_of("side to side", read(tmp_path, text))


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ('effort="30"', 'effort="3"', "robot.flippers.torque_limit differs from flipper to flip"),
        ('velocity="1"', 'velocity="0.5"', "robot.flippers.rate_limit differs from flipper to fl"),
        ('effort="30"', 'effort="29.8"', ""),
    ],
)
def test_limits_that_differ_from_flipper_to_flipper_get_a_warning(
    tmp_path: Path, old: str, new: str, told: str
) -> None:
    text = cart("cart.urdf")
    assert text.count(old) == 2
    found = told_of("flipper to flipper", read(tmp_path, text.replace(old, new, 1)))
    assert [each.startswith(told) for each in found] == ([True] if told else [])
