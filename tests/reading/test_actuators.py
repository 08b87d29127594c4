"""Effects of commanded speeds, and of damping, friction and armature of joints, in engines."""

import re
from pathlib import Path
from typing import get_args

import pytest

import crawler2d as c2d
from crawler2d.reading.engines import ENGINES, Engine
from tests.kept import check_said
from tests.reading.carts import FILES, SAID, SIDES, pair, quietly, read, urdf


def mjcf(joint: str, changed: str = "") -> str:
    """The cart, whose joints have these attributes by default, and its left front wheel others.

    Of five wheels a side, two of them on a flipper, four are as large as the rear end. The one at
    the tip is half as large: its torque counts twice, its rotor and its gain four times.
    """
    text = (FILES / "cart.xml").read_text()
    text = text.replace("<default>", f"<default><joint {joint}/>", 1)
    return text.replace(
        '<joint name="left_front_joint"', f'<joint name="left_front_joint" {changed}'
    )


def stated(*parts: str, dynamics: str = "") -> str:
    """The cart as a URDF, whose wheels have limits, damping and friction."""
    limit = f'<limit effort="5" velocity="10"/>{dynamics}'
    return urdf(*(pair(end, x, limit=limit) for end, x in (("front", 0.2), ("rear", -0.2))), *parts)


def test_every_engine_has_its_laws() -> None:
    assert set(get_args(Engine)) == ENGINES.keys()


@pytest.mark.parametrize("engine", ENGINES)
def test_every_engine_says_what_moves_belts_and_what_its_motors_do(engine: str) -> None:
    laws = ENGINES[engine]
    motors, belts = (laws.description(is_belt=is_belt) for is_belt in (False, True))
    assert motors == f"motors in {laws.name}: {laws.command} ({laws.basis})"
    if laws.surface:
        assert belts == f"belts in {laws.name}: {laws.surface}"
    else:
        assert belts == f"{laws.name} moves no surface of a belt"
    check_said(SAID, [motors, belts])


def test_the_armature_of_one_side_is_the_rotor_inertia(tmp_path: Path) -> None:
    pytest.importorskip("mujoco")
    reading = read(tmp_path, mjcf('armature="0.01"'), "cart.xml")
    assert reading.robot.drivetrain.rotor_inertia == pytest.approx(8.0 * 0.01, rel=1e-12)
    assert reading.sources["robot.drivetrain.rotor_inertia"].startswith("cart.xml:")
    (warning,) = [each for each in reading.warnings if "rotor" in each or "armature" in each]
    assert "got 0.05 to 0.2 kg m^2" in warning  # if all were like the tip's, or like the others


def test_rotors_in_proportion_to_their_wheels_are_alike(tmp_path: Path) -> None:
    pytest.importorskip("mujoco")
    text = mjcf('armature="0.01"')
    for side, _ in SIDES:
        joint = f'<joint name="{side}_flipper_tip_joint"'
        text = text.replace(joint, f'{joint} armature="0.0025"')
    reading = read(tmp_path, text, "cart.xml")
    assert reading.robot.drivetrain.rotor_inertia == pytest.approx(5.0 * 0.01, rel=1e-12)
    assert not [
        warning for warning in reading.warnings if "rotor" in warning or "armature" in warning
    ]


def test_the_armature_of_an_actuator_counts_by_the_square_of_its_gear(tmp_path: Path) -> None:
    pytest.importorskip("mujoco")
    text = mjcf('armature="0.01"').replace("<velocity ", '<velocity gear="3" armature="0.002" ')
    rotor = read(tmp_path, text, "cart.xml").robot.drivetrain.rotor_inertia
    assert rotor == pytest.approx(8.0 * (0.01 + 0.002 * 9.0), rel=1e-12)


def test_rotors_that_differ_have_their_mean_and_a_warning(tmp_path: Path) -> None:
    pytest.importorskip("mujoco")
    reading = read(tmp_path, mjcf('armature="0.01"', 'armature="0.07"'), "cart.xml")
    assert reading.robot.drivetrain.torque_sharing == "wheel"
    assert reading.robot.drivetrain.rotor_inertia == pytest.approx((0.14 + 0.08) / 2.0)
    assert any("got 0.05 to 0.35 kg m^2" in warning for warning in reading.warnings)


@pytest.mark.parametrize("engine", ["gz", "classic", "bullet"])
def test_an_engine_without_rotors_has_none(engine: str, tmp_path: Path) -> None:
    pytest.importorskip("mujoco")
    reading = read(tmp_path, mjcf('armature="0.01"'), "cart.xml", engine=engine)
    assert reading.robot.drivetrain.rotor_inertia == 0.0
    assert "none in" in reading.sources["robot.drivetrain.rotor_inertia"]
    assert any(
        "armature[" in warning and "has no effect in" in warning for warning in reading.warnings
    )


def test_formats_without_armature_say_that_there_is_none(tmp_path: Path) -> None:
    reading = read(tmp_path, stated())
    assert reading.robot.drivetrain.rotor_inertia == 0.0
    assert reading.sources["robot.drivetrain.rotor_inertia"].endswith(": none")


@pytest.mark.parametrize(
    ("engine", "ignored"),
    [
        ("gz", set()),
        ("classic", {"velocity", "friction"}),
        ("bullet", {"effort", "velocity", "friction"}),
        ("mujoco", {"velocity"}),
        ("isaac", {"damping", "friction"}),
    ],
)
def test_figures_of_a_urdf_that_an_engine_ignores_get_a_warning(
    engine: str, ignored: set[str], tmp_path: Path
) -> None:
    text = stated(dynamics='<dynamics damping="0.001" friction="0.002"/>')
    reading = read(tmp_path, text, engine=engine)
    found = [warning for warning in reading.warnings if "has no effect" in warning]
    assert {warning.split(": ")[1].split("[")[0] for warning in found} == ignored
    assert all(warning.startswith("cart.urdf:") for warning in found)


def test_speeds_of_commands_are_limits_in_mujoco(tmp_path: Path) -> None:
    pytest.importorskip("mujoco")
    reading = read(tmp_path, mjcf(""), "cart.xml")
    assert reading.robot.drivetrain.max_speed == pytest.approx(10.0 * 0.125)
    assert not [warning for warning in reading.warnings if "has no effect" in warning]


def test_losses_of_joints_get_a_warning(tmp_path: Path) -> None:
    """Two wheels a side at 10 rad/s: 0.4 and 0.02 N m each, of 5."""
    large = read(tmp_path, stated(dynamics='<dynamics damping="0.03" friction="0.4"/>'))
    assert any("1.4 of 10 N m" in warning and "gz-sim" in warning for warning in large.warnings)
    small = read(tmp_path, stated(dynamics='<dynamics damping="0.03"/>'))
    assert any("0.6 of 10 N m" in note for note in small.notes)
    assert not [warning for warning in small.warnings if " N m" in warning]


def test_the_first_dynamics_element_of_a_urdf_counts(tmp_path: Path) -> None:
    twice = '<dynamics friction="0.1"/><dynamics friction="2"/>'
    assert any("0.2 of 10 N m" in note for note in read(tmp_path, stated(dynamics=twice)).notes)


def test_dynamics_of_sdf_are_read(tmp_path: Path) -> None:
    text = (FILES / "cart.sdf").read_text()
    assert "</limit>" in text
    text = text.replace("</limit>", "</limit><dynamics><friction>0.05</friction></dynamics>")
    # Five wheels a side, of 5 N m each, of which that at the tip counts twice.
    assert any("0.3 of 30 N m" in note for note in read(tmp_path, text, "cart.sdf").notes)


@pytest.mark.parametrize("name", ["acceleration", "linear_acceleration"])
def test_accelerations_are_those_of_a_differential_drive(tmp_path: Path, name: str) -> None:
    limits = f"<max_{name}>0.2</max_{name}><min_{name}>-0.5</min_{name}>"
    limits += "<max_angular_acceleration>0.1</max_angular_acceleration>"
    plugin = f'<gazebo><plugin name="gz::sim::systems::DiffDrive" filename="x">{limits}</plugin>'
    reading = read(tmp_path, stated(f"{plugin}</gazebo>"))
    found = reading.robot.drivetrain
    assert (found.max_acceleration, found.max_deceleration) == (0.2, 0.5)
    assert reading.sources["robot.drivetrain.max_acceleration"].startswith("cart.urdf:")
    usual = read(tmp_path, stated())
    assert usual.robot.drivetrain.max_acceleration == 1.0
    assert "estimate" in usual.sources["robot.drivetrain.max_deceleration"]


@pytest.mark.parametrize("name", ["max_wheel_acceleration", "wheelAcceleration"])
@pytest.mark.parametrize(
    ("rate", "wanted"), [("0.2", (0.2, 0.2)), ("0", (1.0, 4.0)), ("-1e7", (1.0, 4.0))]
)
def test_the_acceleration_of_wheels_is_that_of_a_drive_of_gazebo_classic(
    tmp_path: Path, name: str, rate: str, wanted: tuple[float, float]
) -> None:
    plugin = '<plugin name="drive" filename="libgazebo_ros_diff_drive.so">'
    plugin = f"<gazebo>{plugin}<{name}>{rate}</{name}></plugin></gazebo>"
    found = read(tmp_path, stated(plugin)).robot.drivetrain
    assert (found.max_acceleration, found.max_deceleration) == wanted


@pytest.mark.parametrize(
    ("limits", "wanted"),
    [
        ({"min": "-4", "max": "4"}, 0.32),
        ({"min": "-3", "max": "4"}, 0.24),
        ({"max": "20"}, 0.8),  # faster than the joint
        ({"max": "0"}, 0.8),
        ({"max": "fast"}, 0.8),
        ({"initial_value": "1"}, 0.8),
    ],
)
def test_the_slowest_command_of_ros2_control_sets_the_speed(
    tmp_path: Path, limits: dict[str, str], wanted: float
) -> None:
    """One of four wheels of 80 mm, whose joints have 10 rad/s."""
    params = "".join(f'<param name="{name}">{each}</param>' for name, each in limits.items())
    control = '<ros2_control name="c" type="system"><joint name="left_rear_joint">{}</joint>'
    velocity = f'<command_interface name="velocity">\n{params}</command_interface>'
    effort = '<command_interface name="effort"><param name="max">1</param></command_interface>'
    text = stated(control.format(velocity + effort) + "</ros2_control>")
    reading = read(tmp_path, text)
    assert reading.robot.drivetrain.max_speed == pytest.approx(wanted)
    line = 1 + text[: text.index("<param")].count("\n")
    is_command = reading.sources["robot.drivetrain.max_speed"] == f"cart.urdf:{line}"
    assert is_command is (wanted < 0.8)


def each_with(effort: str, of_tips: str, folder: Path) -> c2d.Reading:
    """The cart with these torques of its wheels, and of those at the tips of its flippers."""
    text = (FILES / "cart.urdf").read_text().replace('effort="5" velocity="10"', effort)
    return read(folder, text.replace('effort="5" velocity="20"', of_tips))


def test_wheels_on_flippers_add_their_torque(tmp_path: Path) -> None:
    """Each wheel is simulated with the force that the file gives it."""
    reading = each_with('effort="5" velocity="10"', 'effort="2.5" velocity="20"', tmp_path)
    assert reading.robot.drivetrain.max_torque == pytest.approx(5.0 * 5.0, rel=1e-12)
    assert reading.robot.drivetrain.torque_sharing == "wheel"
    assert not [note for note in reading.notes if "force" in note]
    assert "of 10 lines" in reading.sources["robot.drivetrain.max_torque"]


@pytest.mark.parametrize("name", ["cart.sdf", "cart.urdf", "cart.xml"])
def test_a_note_says_where_equal_torques_give_unequal_forces(name: str, tmp_path: Path) -> None:
    if name == "cart.xml":
        pytest.importorskip("mujoco")
    reading = read(tmp_path, (FILES / name).read_text(), name)
    assert reading.robot.drivetrain.max_torque == pytest.approx(4.0 * 5.0 + 2.0 * 5.0)
    assert reading.robot.drivetrain.torque_sharing == "wheel"
    assert any("0.6 to 1.2 times the force" in note for note in reading.notes)


def test_motors_of_flippers_that_are_weaker_make_one_motor(tmp_path: Path) -> None:
    reading = each_with('effort="5" velocity="10"', 'effort="1" velocity="20"', tmp_path)
    assert reading.robot.drivetrain.max_torque == pytest.approx(4.0 * 5.0 + 2.0 * 1.0)
    assert reading.robot.drivetrain.torque_sharing == "track"


def test_wheels_on_flippers_without_limit_leave_that_of_the_others(tmp_path: Path) -> None:
    reading = each_with('effort="5" velocity="10"', 'effort="0" velocity="20"', tmp_path)
    assert reading.robot.drivetrain.max_torque == pytest.approx(3.0 * 5.0)
    assert reading.robot.drivetrain.torque_sharing == "track"


@pytest.mark.parametrize(("of_tips", "wanted"), [(20.0, 1.25), (16.0, 1.0), (40.0, 1.25)])
def test_the_slowest_wheel_sets_the_speed_also_where_it_is_on_a_flipper(
    tmp_path: Path, of_tips: float, wanted: float
) -> None:
    """Wheels of 125 mm turn at 10 rad/s, those at the tips are half as large."""
    reading = each_with('effort="5" velocity="10"', f'effort="5" velocity="{of_tips:g}"', tmp_path)
    assert reading.robot.drivetrain.max_speed == pytest.approx(wanted, rel=1e-12)
    notes = [note for note in reading.notes if "limit the speed of all tracks to 1 m/s" in note]
    assert len(notes) == (wanted < 1.25)


def test_a_differential_drive_of_gazebo_classic_limits_the_torque(tmp_path: Path) -> None:
    joints = "".join(
        f"<{side}_joint>{side}_{end}_joint</{side}_joint>"
        for side, _ in SIDES
        for end in ("front", "rear")
    )
    plugin = f'<gazebo><plugin name="diff_drive" filename="x">{joints}'
    plugin += "<max_wheel_torque>3</max_wheel_torque></plugin></gazebo>"
    classic = read(tmp_path, stated(plugin), engine="classic").robot.drivetrain
    assert classic.max_torque == pytest.approx(2.0 * 3.0)
    assert read(tmp_path, stated(plugin)).robot.drivetrain.max_torque == pytest.approx(2.0 * 5.0)


def test_a_skid_steer_drive_of_gazebo_classic_names_four_motors(tmp_path: Path) -> None:
    joints = "".join(
        f"<{side}{end.title()}Joint>{side}_{end}_joint</{side}{end.title()}Joint>"
        for side, _ in SIDES
        for end in ("front", "rear")
    )
    plugin = '<gazebo><plugin name="drive" filename="libgazebo_ros_skid_steer_drive.so">'
    plugin += f"{joints}<torque>3</torque></plugin></gazebo>"
    found = read(tmp_path, stated(plugin), engine="classic")
    assert len(found.tree.driven) == 4
    assert found.robot.drivetrain.max_torque == pytest.approx(2.0 * 3.0)


def test_a_note_says_what_a_commanded_speed_does(tmp_path: Path) -> None:
    for engine, words in (
        ("gz", "within one step"),
        ("mujoco", "kv times the error"),
        ("isaac", "not tested"),
    ):
        notes = read(tmp_path, stated(), engine=engine).notes
        assert [words in note for note in notes if note.startswith("motors in")] == [True]


def test_bullet_multiplies_two_coefficients(tmp_path: Path) -> None:
    assert read(tmp_path, stated(), engine="bullet").friction == 0.25
    assert read(tmp_path, stated(), engine="bullet", ground_friction=1.0).friction == 0.5
    assert read(tmp_path, stated(), engine="classic").friction == 1.0


@pytest.mark.parametrize(
    ("engine", "friction", "source"),
    [
        ("gz", 0.6, "0.75 along the track, min with 0.6 of the ground"),
        ("classic", 0.6, "0.75 along the track, min with 0.6 of the ground"),
        ("bullet", 0.3, "0.5, the engine's default, along the track, product with 0.6 of the"),
        ("mujoco", 0.75, "0.75 along the track, max with 0.6 of the ground"),
        ("isaac", 0.675, "0.75 along the track, mean with 0.6 of the ground"),
    ],
)
def test_the_source_of_friction_names_how_an_engine_combines_it(
    engine: str, friction: float, source: str
) -> None:
    found = quietly(FILES / "cart.urdf", engine=engine, ground_friction=0.6)
    assert found.friction == pytest.approx(friction)
    assert found.sources["friction"].startswith(source)


def test_bullet_reads_its_own_friction_of_a_urdf_only(tmp_path: Path) -> None:
    wheels = [f"{side}_{end}" for side, _ in SIDES for end in ("front", "rear")]
    gazebo = "".join(f'<gazebo reference="{each}"><mu1>0.7</mu1></gazebo>' for each in wheels)
    own = '<contact><lateral_friction value="0.8"/></contact></link><joint name="{}_joint"'
    both = stated(gazebo)
    for each in wheels:
        both = re.sub(rf'</link>\s*<joint name="{each}_joint"', own.format(each), both)
    assert both.count("lateral_friction") == 4
    for text, gz, bullet in ((stated(gazebo), 0.7, 0.5), (both, 0.7, 0.8)):
        for engine, expected in (("gz", gz), ("bullet", bullet)):
            found = read(tmp_path, text, engine=engine, ground_friction=1.0).friction
            assert found == pytest.approx(expected, rel=1e-12)


def test_the_servos_of_mujoco_are_a_controller(tmp_path: Path) -> None:
    """Five wheels a side with kv = 10, of which that at the tip counts four times."""
    pytest.importorskip("mujoco")
    reading = read(tmp_path, mjcf(""), "cart.xml")
    assert reading.robot.drivetrain.controller == c2d.PI(gain=80.0)
    assert reading.sources["robot.drivetrain.controller"].startswith("cart.xml:")
    assert not [warning for warning in reading.warnings if "soft" in warning]
    geared = read(tmp_path, mjcf("").replace("<velocity ", '<velocity gear="2" '), "cart.xml")
    assert geared.robot.drivetrain.controller == c2d.PI(gain=320.0)


def test_a_servo_that_never_gives_its_torque_gets_a_warning(tmp_path: Path) -> None:
    """0.3 N m s/rad at 10 rad/s are 3 of 5 N m; those of the tips have 6 at 20 rad/s."""
    pytest.importorskip("mujoco")
    reading = read(tmp_path, mjcf("").replace('kv="10"', 'kv="0.3"'), "cart.xml")
    (soft,) = [warning for warning in reading.warnings if "soft" in warning]
    assert soft.startswith("cart.xml:75: gain[left_rear_joint] is too soft")
    assert "24 of 30 N m" in soft


@pytest.mark.parametrize("engine", ["gz", "classic", "bullet", "isaac"])
def test_other_engines_hold_the_commanded_speed(engine: str, tmp_path: Path) -> None:
    pytest.importorskip("mujoco")
    reading = read(tmp_path, mjcf(""), "cart.xml", engine=engine)
    assert reading.robot.drivetrain.controller is None
    assert reading.sources["robot.drivetrain.controller"].endswith(": none")


def test_wheels_without_servos_of_speed_have_no_controller(tmp_path: Path) -> None:
    pytest.importorskip("mujoco")
    text = mjcf("").replace(
        '<velocity joint="left_front_joint" kv="10"', '<motor joint="left_front_joint"'
    )
    assert read(tmp_path, text, "cart.xml").robot.drivetrain.controller is None


def driven(actuator: str) -> str:
    """The cart, whose wheels and flippers have these actuators."""
    return re.sub(r'<velocity (joint="[^"]*").*?/>', actuator, mjcf(""))


@pytest.mark.parametrize(("force", "wanted"), [("100", 20.0), ("0.25", 5.0)])
def test_a_motor_of_mujoco_has_the_smaller_of_two_limits(
    tmp_path: Path, force: str, wanted: float
) -> None:
    """Its control, and its force; wheels have a gear of 20, and those of a side count six times."""
    pytest.importorskip("mujoco")
    limits = f'ctrlrange="-1 1" forcerange="-{force} {force}"'
    reading = read(tmp_path, driven(rf'<motor \1 gear="20" {limits}/>'), "cart.xml")
    assert reading.robot.drivetrain.max_torque == pytest.approx(6.0 * wanted)


@pytest.mark.parametrize(("limits", "line"), [("-20 20", 45), ("-40 40", 81)])
def test_a_torque_has_the_line_of_the_smaller_of_two_limits(
    tmp_path: Path, limits: str, line: int
) -> None:
    """That of the joint, in line 45, or that of its servo, 30 N m in line 81."""
    pytest.importorskip("mujoco")
    joint = '<joint name="left_flipper_joint"'
    text = (FILES / "cart.xml").read_text()
    text = text.replace(joint, f'{joint} actuatorfrcrange="{limits}"')
    found = read(tmp_path, text, "cart.xml").sources["robot.flippers.torque_limit"]
    assert found == f"cart.xml:{line}, 84"


@pytest.mark.parametrize(
    ("settings", "wanted"),
    [
        ('gainprm="10" biasprm="0 0 -2" ctrlrange="-1 1"', 5.0),
        ('gear="2" gainprm="10" biasprm="0 0 -2" ctrlrange="-1 1"', 2.5),
        ('dyntype="integrator" gainprm="6" biasprm="0 -2 0" ctrlrange="-1 1"', 3.0),
    ],
)
def test_a_servo_of_mujoco_holds_its_control_by_both_gains(
    tmp_path: Path, settings: str, wanted: float
) -> None:
    """The speed [rad/s] at which a free wheel takes no torque, or that of its integrator."""
    pytest.importorskip("mujoco")
    text = driven(rf'<general \1 biastype="affine" {settings} forcerange="-5 5"/>')
    reading = read(tmp_path, text, "cart.xml")
    assert reading.robot.drivetrain.max_speed == pytest.approx(wanted * 0.0625)  # of the tips


@pytest.mark.parametrize("is_first", [True, False])
def test_two_actuators_of_a_joint_add_up(tmp_path: Path, *, is_first: bool) -> None:
    """A servo with 5 N m and a motor with 2 on each wheel of the chassis, in either order."""
    pytest.importorskip("mujoco")
    motors = "".join(
        f'<motor joint="{side}_{end}_joint" ctrlrange="-2 2"/>'
        for side, _ in SIDES
        for end in ("front", "middle", "rear")
    )
    text = mjcf("")
    if is_first:
        text = text.replace("<actuator>", f"<actuator>{motors}")
    else:
        text = text.replace("</actuator>", f"{motors}</actuator>")
    reading = read(tmp_path, text, "cart.xml")
    found = reading.robot.drivetrain
    assert found.max_torque == pytest.approx(3.0 * (5.0 + 2.0) + 3.0 * 5.0)
    assert found.controller == c2d.PI(gain=80.0)
    assert found.max_speed == pytest.approx(1.25)
    assert sum("several actuators" in warning for warning in reading.warnings) == 6


def test_actuators_of_tendons_are_those_of_no_joint(tmp_path: Path) -> None:
    pytest.importorskip("mujoco")
    tendon = '<tendon><fixed name="left_rear_joint"><joint joint="left_front_joint" coef="1"/>'
    motor = '</fixed></tendon><actuator><motor tendon="left_rear_joint" ctrlrange="-2 2"/>'
    reading = read(tmp_path, mjcf("").replace("<actuator>", tendon + motor), "cart.xml")
    assert reading.robot.drivetrain.max_torque == pytest.approx(30.0)
    assert not [warning for warning in reading.warnings if "has several" in warning]
