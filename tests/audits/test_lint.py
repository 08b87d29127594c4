"""Every rule of lint reports its mistake, and nothing for the same robot without it."""

import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

import crawler2d as c2d
from crawler2d.audits import lint as module
from crawler2d.audits.lint import SEVERITIES, Finding
from tests.audits.seizing import SAID
from tests.kept import check_said
from tests.reading.carts import FILES, TENSOR, WHEEL_TENSOR, WHEELS, link, pair, quietly, read, urdf

ROBOT = c2d.robots.engineer(flippers=None, track=c2d.LineOfWheels(4))
BLOCK = '<transmission name="t"><joint name="{name}_joint"/></transmission>'
NAMES = [f"{side}_{end}" for side in ("left", "right") for end in ("front", "rear")]
MOTORS = "".join(BLOCK.format(name=name) for name in NAMES)


def lint(*given: Any, **options: Any) -> tuple[Finding, ...]:
    """Lint a robot or a file; every finding must be among the stored ones, word for word."""
    found = module.lint(*given, **options)
    told = [f"{each.severity}, {each.rule}: {each.message} [{each.where}]" for each in found]
    check_said(SAID, told)
    return found


def of_rule(found: tuple[Finding, ...], rule: str) -> list[Finding]:
    return [each for each in found if each.rule == rule]


def of_text(folder: Path, text: str, rule: str, **how: Any) -> list[Finding]:
    reading = read(folder, text, **how)
    return of_rule(lint(reading.robot, reading), rule)


def of_robot(robot: c2d.Robot, rule: str) -> list[Finding]:
    return of_rule(lint(robot), rule)


def test_a_good_robot_has_no_findings() -> None:
    assert lint(ROBOT) == ()


def test_a_good_file_has_no_findings(tmp_path: Path) -> None:
    reading = read(tmp_path, urdf(WHEELS, MOTORS))
    assert lint(reading.robot, reading) == ()


def test_errors_stand_before_warnings_and_notes(tmp_path: Path) -> None:
    tensor = '<inertia ixx="0.5" ixy="0" ixz="0" iyy="0.5" iyz="0" izz="2"/>'
    text = urdf(WHEELS, pair("middle", 0.0, limit="", radius="0.125"))
    reading = read(tmp_path, text.replace(TENSOR, tensor))
    order = [SEVERITIES.index(each.severity) for each in lint(reading.robot, reading)]
    assert order == sorted(order)
    assert len(set(order)) == 3


def test_a_robot_ten_times_too_large_is_an_error_with_its_scale() -> None:
    outline = replace(ROBOT.outline, axle_distance=3.65, front_radius=0.64, rear_radius=0.64)
    (found,) = of_robot(replace(ROBOT, outline=outline), "size")
    assert found.severity == "error"
    assert found.message.endswith("if it is ten times too large, pass scale=0.1")
    assert of_robot(ROBOT, "size") == []


def test_a_robot_too_small_is_an_error_without_a_scale() -> None:
    outline = replace(ROBOT.outline, axle_distance=0.03, front_radius=0.01, rear_radius=0.01)
    (found,) = of_robot(replace(ROBOT, outline=outline), "size")
    assert "ten times" not in found.message


@pytest.mark.parametrize("mass", [0.02, 9000.0])
def test_a_mass_that_does_not_fit_the_size_is_found(mass: float) -> None:
    assert len(of_robot(replace(ROBOT, mass=mass), "mass")) == 1
    assert of_robot(ROBOT, "mass") == []


def test_a_mass_farther_out_than_any_part_is_found() -> None:
    (found,) = of_robot(replace(ROBOT, moment_of_inertia=12.0), "inertia")
    assert found.severity == "error"


def test_large_wheels_at_the_tips_of_arms_are_far_out_too() -> None:
    arms = c2d.Flippers(
        length=0.2, root_radius=0.064, tip_radius=0.037, mass=0.775, ends="both", torque_limit=30.0
    )
    robot = c2d.robots.engineer(flippers=arms, track=c2d.LineOfWheels(4, wheel_radius=0.12))
    heavy = replace(robot, moment_of_inertia=robot.mass * 0.5**2)
    assert of_robot(heavy, "inertia") == []
    (found,) = of_robot(heavy.with_track(c2d.BeltTrack()), "inertia")  # whose tips are smaller
    assert "no part is farther than 0.488 m" in found.message


def test_torque_beyond_the_grip_of_any_floor_is_found() -> None:
    drivetrain = replace(ROBOT.drivetrain, max_torque=300.0)
    (found,) = of_robot(replace(ROBOT, drivetrain=drivetrain), "effort")
    assert "as good as no limit" in found.message
    assert of_robot(ROBOT, "effort") == []


def test_wheels_that_replace_no_track_are_found() -> None:
    bare = ROBOT.with_track(c2d.LineOfWheels(2, as_track=False))
    (found,) = of_robot(bare, "no track")
    assert "237 mm are bare" in found.message
    assert of_robot(ROBOT, "no track") == []


def test_a_flipper_with_one_wheel_is_found() -> None:
    arms = c2d.robots.engineer().flippers
    assert arms is not None
    for placements, count in ((((0.17, 0.0, 0.037),), 1), (((-0.17, 0, 0.06), (0.17, 0, 0.03)), 0)):
        one = replace(arms, track=c2d.HybridWheels(placements))
        robot = replace(c2d.robots.engineer(track=c2d.LineOfWheels(4)), flippers=one)
        assert len(of_robot(robot, "no track")) == count


def sized(length: float, **changed: Any) -> c2d.Robot:
    """A robot of this length, a third of which is its height, and half of which is its width."""
    radius = length / 6.0
    outline = replace(
        ROBOT.outline,
        axle_distance=4.0 * radius,
        front_radius=radius,
        rear_radius=radius,
        grouser_height=0.1 * radius,
    )
    mass = 500.0 * length**3 / 6.0
    usual = {"gauge": 0.5 * length - radius, "mass": mass, "belly": None}
    inertia = mass * length**2 / 12.0
    inside = replace(ROBOT, outline=outline, moment_of_inertia=inertia, center_of_mass=(0.0, 0.0))
    return replace(inside.with_track(c2d.BeltTrack()), **{**usual, **changed})


@pytest.mark.parametrize("off", [-1e-3, 1e-3])
@pytest.mark.parametrize(
    ("rule", "is_most", "robot"),
    [
        ("size", True, lambda off: sized(3.0 + off)),
        ("size", False, lambda off: sized(0.1 + off)),
        ("mass", True, lambda off: sized(1.0, mass=8000.0 / 6.0 + off)),
        ("mass", False, lambda off: sized(1.0, mass=30.0 / 6.0 + off)),
        (
            "inertia",
            True,
            lambda off: sized(1.0, mass=90.0, moment_of_inertia=90.0 * (0.25 + 1.0 / 36.0) + off),
        ),
        (
            "inertia",  # whose belly is the tallest part
            True,
            lambda off: sized(
                1.0,
                mass=90.0,
                moment_of_inertia=90.0 * (0.25 + 0.16) + off,
                belly=((-0.1, 0.0), (0.1, 0.0), (0.0, -0.4)),
            ),
        ),
        (
            "effort",
            True,
            lambda off: sized(
                1.0,
                mass=90.0,
                drivetrain=replace(
                    ROBOT.drivetrain,
                    max_torque=(5.0 * 90.0 * 9.81 + off) * 0.9 / 6.0 / 2.0,
                ),
            ),
        ),
    ],
)
def test_a_rule_of_a_robot_begins_where_its_text_says(
    rule: str, is_most: bool, robot: Any, off: float
) -> None:
    assert bool(of_robot(robot(off), rule)) is ((off > 0.0) is is_most)


@pytest.mark.parametrize(
    ("length", "is_told"), [(3.1, True), (0.09, False), (29.0, True), (31.0, False)]
)
def test_a_scale_is_advised_where_a_tenth_of_the_length_is_usual(
    length: float, is_told: bool
) -> None:
    (found,) = of_robot(sized(length), "size")
    assert found.message.endswith("pass scale=0.1") is is_told


def test_undriven_wheels_are_found() -> None:
    free = ROBOT.with_track(c2d.ForceTrack(support="wheels"))
    assert of_robot(free, "not driven")[0].severity == "error"
    assert of_robot(ROBOT.with_track(c2d.ForceTrack()), "not driven") == []


def test_a_file_without_motors_is_found(tmp_path: Path) -> None:
    (found,) = of_text(tmp_path, urdf(WHEELS), "not driven")
    assert (found.severity, found.message.split(" (")[0]) == (
        "note",
        "the file names no motor for 4 of 4 wheels",
    )
    assert found.where.startswith("cart.urdf:")


@pytest.mark.parametrize(("engine", "severity"), [("gz", "warning"), ("mujoco", "error")])
def test_friction_above_two_counts_as_the_engine_combines_it(
    tmp_path: Path, engine: str, severity: str
) -> None:
    text = (FILES / "cart.sdf").read_text(encoding="utf-8")
    sticky = text.replace("<mu>0.75</mu><mu2>0.75</mu2>", "<mu>150</mu><mu2>150</mu2>")
    found = of_text(tmp_path, sticky, "friction", name="cart.sdf", engine=engine)
    assert [each.severity for each in found] == [severity]
    assert of_text(tmp_path, text, "friction", name="cart.sdf", engine=engine) == []


@pytest.mark.parametrize("parts", ["hull", "left_front"])
def test_friction_is_that_of_wheels_also_in_a_file_of_one_line(tmp_path: Path, parts: str) -> None:
    shape = '<collision><geometry><box size="0.3 0.1 0.05"/></geometry></collision>'
    sticky = f'<gazebo reference="{parts}"><mu1>5</mu1><mu2>5</mu2></gazebo>'
    text = urdf(WHEELS, sticky, shapes=shape).replace("\n", " ")
    found = of_text(tmp_path, text, "friction")
    assert bool(found) is (parts != "hull")


def test_a_missing_effort_limit_is_found(tmp_path: Path) -> None:
    free = pair("front", 0.2, limit="") + pair("rear", -0.2, limit="")
    (found,) = of_text(tmp_path, urdf(free, MOTORS), "effort")
    assert found.message.startswith("4 of 4 wheels have no effort limit")
    assert of_text(tmp_path, urdf(WHEELS, MOTORS), "effort") == []


def test_an_effort_limit_of_0_is_none_but_in_gz(tmp_path: Path) -> None:
    zero = '<limit effort="0" velocity="10"/>'
    text = urdf(pair("front", 0.2, limit=zero), pair("rear", -0.2, limit=zero), MOTORS)
    (found,) = of_text(tmp_path, text, "effort", engine="gz")
    assert found.message.startswith("4 of 4 wheels have an effort limit of 0: their motors turn no")
    (found,) = of_text(tmp_path, text, "effort", engine="mujoco")
    assert found.message.startswith("4 of 4 wheels have no effort limit")


def test_a_speed_limit_of_0_is_found_where_the_engine_keeps_to_it(tmp_path: Path) -> None:
    zero = '<limit effort="5" velocity="0"/>'
    text = urdf(pair("front", 0.2, limit=zero), pair("rear", -0.2, limit=zero), MOTORS)
    for engine, name in (("gz", "gz-sim"), ("isaac", "Isaac Sim")):
        (found,) = of_text(tmp_path, text, "speed", engine=engine)
        told = f"4 of 4 wheels have a speed limit of 0: they do not turn in {name}; here they drive"
        assert found.message == f"{told} at 1 m/s, an estimate"
    assert of_text(tmp_path, text, "speed", engine="mujoco") == []
    some = urdf(pair("front", 0.2, limit=zero), pair("rear", -0.2), MOTORS)
    (found,) = of_text(tmp_path, some, "speed")
    assert found.message.startswith("2 of 4 wheels")
    assert found.message.endswith("here they drive at 0.8 m/s, as the others do")


def test_a_chassis_without_mass_is_found(tmp_path: Path) -> None:
    text = urdf(WHEELS, MOTORS)
    hull = f'<inertial><mass value="8"/>{TENSOR}</inertial>'
    assert hull in text
    bare = text.replace(hull, "")
    (found,) = of_text(tmp_path, bare, "massless")
    assert found.message.startswith("the chassis has no mass (hull): is an <inertial> missing?")
    battery = link("battery", 'type="fixed">')  # lies in it
    assert of_text(tmp_path, bare.replace("</robot>", f"{battery}</robot>"), "massless") == []


def test_a_wheel_that_rolls_freely_needs_no_limit_of_effort(tmp_path: Path) -> None:
    rear = "".join(BLOCK.format(name=name) for name in NAMES[1::2])
    text = urdf(pair("front", 0.2, limit=""), pair("rear", -0.2), rear)
    assert of_text(tmp_path, text, "effort") == []


def test_sides_that_differ_within_the_tolerance_are_found(tmp_path: Path) -> None:
    skew = WHEELS.replace('xyz="0.2 0.15 0.0"', 'xyz="0.2005 0.15 0.0"')
    (found,) = of_text(tmp_path, urdf(skew), "sides")
    assert "by up to 0.5 mm" in found.message
    assert of_text(tmp_path, urdf(WHEELS), "sides") == []


def test_wheels_out_of_balance_are_found(tmp_path: Path) -> None:
    text = urdf(WHEELS)
    for off, count in (("0 0.02 0", 0), ("0.007 0 0", 0), ("0 0 0.01", 4)):  # y is the axle
        swung = text.replace('<mass value="1"/>', f'<origin xyz="{off}"/><mass value="1"/>')
        found = of_text(tmp_path, swung, "balance")
        assert len(found) == bool(count)
    assert found[0].message.startswith("left_front, right_front")
    assert "off their axles by up to 10 mm" in found[0].message


def test_an_inertia_that_breaks_the_triangle_inequality_is_found(tmp_path: Path) -> None:
    tensor = '<inertia ixx="0.001" ixy="0" ixz="0" iyy="0.005" iyz="0" izz="0.001"/>'
    text = urdf(WHEELS.replace(WHEEL_TENSOR, tensor))
    (found,) = of_text(tmp_path, text, "inertia")
    assert "exceeds the sum of the others" in found.message
    assert of_text(tmp_path, urdf(WHEELS), "inertia") == []


def test_an_inertia_larger_than_its_body_is_found(tmp_path: Path) -> None:
    tensor = '<inertia ixx="0.02" ixy="0" ixz="0" iyy="0.03" iyz="0" izz="0.02"/>'
    text = urdf(WHEELS.replace(WHEEL_TENSOR, tensor))
    (found,) = of_text(tmp_path, text, "inertia")
    assert found.severity == "error"
    assert "larger than the body" in found.message


def test_an_impossible_inertia_of_a_light_link_is_a_note(tmp_path: Path) -> None:
    light = '<mass value="0.0001"/>'
    text = urdf(WHEELS, pair("middle", 0.0)).replace('<mass value="1"/>', light)
    found = of_text(tmp_path, text, "inertia")
    assert [each.severity for each in found] == ["note"]


@pytest.mark.parametrize(
    ("moments", "rule", "count"),
    [
        ((0.001, 0.00303, 0.002), "inertia", 0),  # the largest is 1 % above the sum of the others
        ((0.001, 0.00304, 0.002), "inertia", 1),
        ((0.00356, 0.007, 0.00356), "inertia", 0),  # 84 mm, of a radius and width of 84 mm
        ((0.00356, 0.008, 0.00456), "inertia", 1),
        ((0.002, 0.002, 0.002000001), "placeholder", 1),
        ((0.002, 0.002, 0.002000003), "placeholder", 0),
    ],
)
def test_inertias_of_wheels_are_found_from_these_on(
    tmp_path: Path, moments: tuple[float, float, float], rule: str, count: int
) -> None:
    names = ("ixx", "iyy", "izz")
    given = " ".join(f'{name}="{each}"' for name, each in zip(names, moments, strict=True))
    text = urdf(WHEELS.replace(WHEEL_TENSOR, f'<inertia ixy="0" ixz="0" iyz="0" {given}/>'))
    assert len(of_text(tmp_path, text, rule)) == count


def test_wheels_without_mass_are_found(tmp_path: Path) -> None:
    text = urdf(re.sub(r"<inertial>.*?</inertial>", "", WHEELS, flags=re.DOTALL))
    (found,) = of_text(tmp_path, text, "massless")
    assert found.severity == "error"
    assert "4 wheels have no mass" in found.message
    assert of_text(tmp_path, urdf(WHEELS), "massless") == []


def test_the_mass_of_a_wheel_may_be_that_of_a_link_fixed_to_it(tmp_path: Path) -> None:
    wheels = re.sub(r"<inertial>.*?</inertial>", "", WHEELS, flags=re.DOTALL)
    names = [f"{side}_{end}" for side in ("left", "right") for end in ("front", "rear")]
    hubs = "".join(link(f"{each}_hub", 'type="fixed">', parent=each) for each in names)
    assert of_text(tmp_path, urdf(wheels, hubs), "massless") == []


def test_placeholder_inertias_are_found(tmp_path: Path) -> None:
    tensor = '<inertia ixx="0.002" ixy="0" ixz="0" iyy="0.002" iyz="0" izz="0.002"/>'
    text = urdf(WHEELS.replace(WHEEL_TENSOR, tensor))
    (found,) = of_text(tmp_path, text, "placeholder")
    assert found.severity == "warning"
    assert of_text(tmp_path, urdf(WHEELS), "placeholder") == []


def test_three_equal_moments_of_a_ball_are_no_placeholder(tmp_path: Path) -> None:
    tensor = '<inertia ixx="0.002" ixy="0" ixz="0" iyy="0.002" iyz="0" izz="0.002"/>'
    ball = '<sphere radius="0.08"/>'
    wheels = pair("front", 0.2, geometry=ball) + pair("rear", -0.2, geometry=ball)
    text = urdf(wheels.replace(WHEEL_TENSOR, tensor))
    assert of_text(tmp_path, text, "placeholder") == []


ROVER = c2d.samples.path("rover.sdf")


def of_rover(folder: Path, rule: str, *changes: tuple[str, str]) -> list[Finding]:
    """Findings of a rule in the sample with a drive plugin, after changes of its text."""
    text = ROVER.read_text(encoding="utf-8")
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    return of_text(folder, text, rule, name="rover.sdf")


def turned(*names: str) -> Iterator[tuple[str, str]]:
    """Changes that turn the axes of these wheels round."""
    for name in names:
        joint = f"<child>{name}</child>\n      <axis><xyz>0 0 "
        yield f"{joint}1</xyz>", f"{joint}-1</xyz>"


def in_plugin(*pairs: tuple[str, str]) -> Iterator[tuple[str, str]]:
    """Changes that put the wheels of each pair in place of each other."""
    for first, second in pairs:
        for side, name, other in (("left", first, second), ("right", second, first)):
            end = f"_joint</{side}_joint>"
            yield f"<{side}_joint>{name}{end}", f"<{side}_joint>{other}{end}"


EACH = range(1, 6)
"""The wheels of a side of the sample."""


def test_wheels_of_one_side_that_turn_against_each_other_are_found(tmp_path: Path) -> None:
    assert of_rover(tmp_path, "opposed") == []
    (found,) = of_rover(tmp_path, "opposed", *turned("left_wheel_2"))
    assert (found.severity, found.where) == ("error", "rover.sdf:35")
    assert found.message.startswith("left_wheel_2: opposite in axis to left_wheel_1, left")
    every = (f"{side}_wheel_{n}" for n in EACH for side in ("left", "right"))
    assert of_rover(tmp_path, "opposed", *turned(*every)) == []  # the robot drives backwards


def test_sides_that_one_command_turns_against_each_other_are_found(tmp_path: Path) -> None:
    mirrored = turned(*(f"right_wheel_{n}" for n in EACH))
    (found,) = of_rover(tmp_path, "opposed", *mirrored)
    assert found.severity == "error"
    assert "turns the robot on the spot" in found.message


def test_wheels_that_a_plugin_has_on_the_other_side_are_found(tmp_path: Path) -> None:
    swapped = in_plugin(("left_wheel_2", "right_wheel_2"))
    (found,) = of_rover(tmp_path, "opposed", *swapped)
    assert (found.severity, found.where) == ("error", "rover.sdf:105, 110")
    assert found.message.startswith("right_wheel_2, left_wheel_2: the plugin has them among")


def test_a_plugin_that_has_left_for_right_is_found_but_not_in_old_drives(tmp_path: Path) -> None:
    swapped = [*in_plugin(*((f"left_wheel_{n}", f"right_wheel_{n}") for n in EACH))]
    (found,) = of_rover(tmp_path, "opposed", *swapped)
    assert found.severity == "warning"
    assert "asked to turn left, the robot turns right" in found.message
    old = [(f"{side}_joint>", f"{side}Joint>") for side in ("left", "right")]
    assert of_rover(tmp_path, "opposed", *swapped, *old) == []


def test_axes_without_a_plugin_may_point_either_way(tmp_path: Path) -> None:
    wheels = WHEELS.replace('<axis xyz="0 1 0"/>', '<axis xyz="0 -1 0"/>', 1)
    assert of_text(tmp_path, urdf(wheels, MOTORS), "opposed") == []


@pytest.mark.parametrize(
    ("setting", "count"),
    [
        ("<wheel_radius>0.3", 1),
        ("<wheel_radius>0.106", 1),
        ("<wheel_radius>0.104", 0),
        ("<wheel_radius>0.096", 0),
        ("<wheel_radius>0.094", 1),
        ("<wheel_radius>0", 0),
        ("<wheel_radius>large", 0),
    ],
)
def test_a_plugin_with_another_radius_than_its_wheels_is_found(
    tmp_path: Path, setting: str, count: int
) -> None:
    assert len(of_rover(tmp_path, "wheel radius", ("<wheel_radius>0.1", setting))) == count


@pytest.mark.parametrize(
    ("name", "size", "said"),
    [
        ("wheel_radius", "0.3", "0.3 m, but theirs is 0.1 m: asked to drive at 0.5 m/s, it turns"
         " them for 0.167 m/s"),
        ("wheelDiameter", "0.1", "0.1 m, but theirs is 0.2 m: asked to drive at 0.25 m/s, it turns"
         " them for 0.5 m/s"),
    ],
)  # fmt: skip
def test_lint_says_how_fast_a_drive_with_another_radius_is(
    tmp_path: Path, name: str, size: str, said: str
) -> None:
    sized = f"<{name}>{size}</{name}><max_linear_velocity>0.5</max_linear_velocity>"
    (found,) = of_rover(tmp_path, "wheel radius", ("<wheel_radius>0.1</wheel_radius>", sized))
    assert (found.severity, found.where) == ("warning", "rover.sdf:115")
    assert said in found.message


@pytest.mark.parametrize(("radius", "count"), [("0.05", 0), ("0.042", 0), ("0.035", 1)])
def test_gear_wheels_may_have_any_radius_from_root_to_tip(
    tmp_path: Path, radius: str, count: int
) -> None:
    gears = c2d.LineOfWheels(4, wheel_radius=0.05, wheel=c2d.GearWheel(grouser_count=12))
    path = tmp_path / "gears.sdf"
    c2d.robots.engineer(flippers=None, track=gears).to_sdf(path)
    text = path.read_text(encoding="utf-8")
    own = "<wheel_radius>0.05</wheel_radius>"
    assert own in text
    reading = read(tmp_path, text.replace(own, f"<wheel_radius>{radius}</wheel_radius>"), path.name)
    found = [each for each in module.lint(reading.robot, reading) if each.rule == "wheel radius"]
    assert len(found) == count


def test_every_pair_of_wheels_may_have_its_own_diameter(tmp_path: Path) -> None:
    sizes = "".join(f"<wheel_diameter>{size}</wheel_diameter>" for size in (0.2, 0.2, 0.4, 0.2))
    change = "<wheel_radius>0.1</wheel_radius>"
    (found,) = of_rover(tmp_path, "wheel radius", (change, f"{sizes}<wheel_diameter>0.2"
                        "</wheel_diameter>"))  # fmt: skip
    assert found.message.startswith("left_wheel_3, right_wheel_3: wheel_diameter of the plugin")
    assert of_rover(tmp_path, "wheel radius", (change, sizes)) == []  # of whom is each?


def test_the_torque_of_a_drive_of_gazebo_classic_is_a_limit(tmp_path: Path) -> None:
    joints = "".join(
        f"<{side}_joint>{side}_{end}_joint</{side}_joint>"
        for side in ("left", "right")
        for end in ("front", "rear")
    )
    plugin = '<gazebo><plugin name="drive" filename="libgazebo_ros_diff_drive.so">'
    plugin += f"{joints}<max_wheel_torque>3</max_wheel_torque></plugin></gazebo>"
    text = urdf(pair("front", 0.2, limit=""), pair("rear", -0.2, limit=""), plugin)
    assert of_text(tmp_path, text, "effort", engine="classic") == []
    (found,) = of_text(tmp_path, text, "effort", engine="gz")
    assert found.message.startswith("4 of 4 wheels have no effort limit")


def test_a_limit_that_other_wheels_have_is_no_estimate(tmp_path: Path) -> None:
    text = (FILES / "cart.urdf").read_text(encoding="utf-8")
    tips = text.replace('effort="5" velocity="20"', 'effort="0" velocity="20"')
    (found,) = of_text(tmp_path, tips, "effort")
    assert "here they have 15 N m per track, those of the others" in found.message


OVERLAPPING = (WHEELS, pair("middle", 0.1))


def test_overlapping_wheels_are_found(tmp_path: Path) -> None:
    (found,) = of_text(tmp_path, urdf(*OVERLAPPING, pair("other", 0.0)), "overlap")
    assert found.severity == "note"
    assert "switch self-collision off" in found.message
    assert of_text(tmp_path, urdf(WHEELS, pair("middle", 0.0)), "overlap") == []


@pytest.mark.parametrize(("value", "severity"), [("1", "error"), ("0", "note")])
def test_wheels_that_overlap_in_sdf_collide_if_the_file_says_so(
    tmp_path: Path, value: str, severity: str
) -> None:
    text = (FILES / "cart.sdf").read_text(encoding="utf-8")
    large = text.replace("<radius>0.125</radius>", "<radius>0.15</radius>")
    collide = large.replace(
        '<link name="left_middle">',
        f'<link name="left_middle"><self_collide>{value}</self_collide>',
    )
    (found,) = of_text(tmp_path, collide, "overlap", name="cart.sdf")
    assert found.severity == severity
    assert of_text(tmp_path, text, "overlap", name="cart.sdf") == []


@pytest.mark.parametrize(("filtered", "severity"), [("", "error"), (' contype="2"', "note")])
def test_wheels_that_overlap_in_mjcf_collide_unless_filtered(
    tmp_path: Path, filtered: str, severity: str
) -> None:
    pytest.importorskip("mujoco")
    text = (FILES / "cart.xml").read_text(encoding="utf-8")
    large = text.replace('size="0.125 0.03125"', f'size="0.15 0.03125"{filtered}')
    found = of_text(tmp_path, large, "overlap", name="cart.xml")
    assert [each.severity for each in found] == [severity]


def test_warnings_of_the_reader_are_findings(tmp_path: Path) -> None:
    wide = pair("front", 2.0) + pair("rear", -2.0)
    reading = read(tmp_path, urdf(wide, mass="4000"))
    found = of_rule(lint(reading.robot, reading), "other")
    assert "is the file in metres?" in found[0].message


def test_warnings_of_the_simulator_are_findings() -> None:
    (found,) = lint(ROBOT, warnings=["robot.x is usually less"])
    assert (found.rule, found.severity) == ("other", "warning")


def test_a_rule_about_the_robot_names_the_lines_of_the_file(tmp_path: Path) -> None:
    reading = read(tmp_path, urdf(pair("front", 2.0), pair("rear", -2.0), mass="4000"))
    (found,) = of_rule(lint(reading.robot, reading), "size")
    assert found.where == reading.sources["robot.outline.axle_distance"]


def test_lint_finds_the_mistakes_of_the_public_files() -> None:
    robots = FILES.parent.parent / "robots"
    marv = quietly(robots / "marv.sdf")
    rules = {(each.rule, each.severity) for each in lint(marv.robot, marv)}
    assert {("no track", "error"), ("overlap", "error"), ("friction", "warning")} <= rules
    engineer = quietly(robots / "eng.urdf", mesh="leave_out")
    rules = {(each.rule, each.severity) for each in lint(engineer.robot, engineer)}
    assert {("size", "error"), ("mass", "warning"), ("placeholder", "warning")} <= rules
