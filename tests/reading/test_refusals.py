"""Models that a side view cannot represent, or that are not robots, are refused with their line."""

import re
from pathlib import Path
from typing import Any

import pytest

import crawler2d as c2d
from tests.kept import refusing
from tests.reading.carts import (
    ACROSS,
    FILES,
    LIMIT,
    SAID,
    SIDES,
    WHEELS,
    collision,
    left_out,
    link,
    pair,
    quietly,
    read,
    refused,
    tracked,
    urdf,
    wheel,
)


def on_links(kind: str) -> str:
    """Front wheels on their own link, which moves on the hull."""
    arms = "".join(link(f"{side}_arm", kind, f"0.2 {sign * 0.1} 0") for side, sign in SIDES)
    wheels = "".join(
        wheel(f"{side}_front", f"0 {sign * 0.05} 0", parent=f"{side}_arm") for side, sign in SIDES
    )
    return urdf(arms, wheels, pair("rear", -0.2))


def test_a_wheel_without_a_partner_is_refused(tmp_path: Path) -> None:
    refused(
        tmp_path, urdf(WHEELS, wheel("left_mid", "0 0.15 0")), "must have a partner on the right"
    )


def test_sides_that_differ_by_2_mm_are_refused(tmp_path: Path) -> None:
    text = urdf(wheel("l", "0.2 0.15 0"), wheel("r", "0.202 -0.15 0"), pair("rear", -0.2))
    refused(tmp_path, text, "must have a partner on the right, in side view within 1 mm")
    assert read(tmp_path, text, tolerance=0.003).robot.outline.axle_distance == pytest.approx(0.401)


def test_a_wheel_in_the_middle_is_refused(tmp_path: Path) -> None:
    refused(
        tmp_path, urdf(WHEELS, wheel("tail", "0 0 0")), "must stand on the left or on the right"
    )


def test_wheels_on_slides_are_refused_as_suspension(tmp_path: Path) -> None:
    kind = 'type="prismatic"><axis xyz="0 0 1"/>' + LIMIT
    refused(tmp_path, on_links(kind), "a side view has no suspension")


@pytest.mark.parametrize(
    ("joint", "kind", "rule"),
    [
        ('type="slide" axis="0 0 1"', "slide", "carry no wheels: a side view has no suspension"),
        ('type="ball"', "ball", "be fixed or turn about an axis, to carry wheels"),
        ('axis="0 0 1"', "hinge", "carry no wheels: a side view has no steering"),
        ('axis="0 0 1" stiffness="0.1"', "hinge", "carry no wheels: a side view has no suspension"),
    ],
)
def test_wheels_on_joints_of_mjcf_that_a_side_view_lacks_are_refused_by_kind(
    tmp_path: Path, joint: str, kind: str, rule: str
) -> None:
    own = ' axis="0 1 0" range="-3.2 3.2"/>'
    text = (FILES / "cart.xml").read_text(encoding="utf-8")
    line = 1 + text[: text.index(own)].count("\n")
    path = tmp_path / "cart.xml"
    path.write_text(text.replace(own, f" {joint}/>"), encoding="utf-8")
    with pytest.raises(c2d.ScenarioError) as caught:
        quietly(path)
    assert caught.value.path == f"cart.xml:{line}: joint[left_flipper_joint]"
    assert (caught.value.value, caught.value.rule) == (kind, f"must {rule}")


def test_wheels_on_a_steered_joint_are_refused(tmp_path: Path) -> None:
    kind = 'type="revolute"><axis xyz="0 0 1"/>' + LIMIT
    refused(tmp_path, on_links(kind), "a side view has no steering")


def test_wheels_on_a_rocker_are_refused(tmp_path: Path) -> None:
    kind = 'type="revolute"><axis xyz="0 1 0"/>' + LIMIT
    arms = "".join(link(f"{side}_arm", kind, f"0 {sign * 0.1} 0") for side, sign in SIDES)
    wheels = "".join(
        wheel(f"{side}_{x}", f"{x} {sign * 0.05} 0", parent=f"{side}_arm")
        for side, sign in SIDES
        for x in (-0.2, 0.2)
    )
    refused(tmp_path, urdf(arms, wheels), "a side view has no rocker")


def test_wheels_on_a_floating_joint_are_refused(tmp_path: Path) -> None:
    refused(tmp_path, on_links('type="floating">'), "must be fixed or turn about an axis")


def test_a_toed_wheel_is_refused(tmp_path: Path) -> None:
    text = urdf(WHEELS, pair("mid", 0.0, rpy="0 0 0.2"))
    refused(tmp_path, text, "must turn about the axis of the other wheels")


def test_a_sprung_flipper_is_refused_as_suspension(tmp_path: Path) -> None:
    text = (Path(__file__).parent / "files" / "cart.sdf").read_text()
    spring = "<dynamics><spring_stiffness>50</spring_stiffness></dynamics>"
    text = text.replace("<velocity>1</velocity></limit>", f"<velocity>1</velocity></limit>{spring}")
    refused(tmp_path, text, "must have no spring", "cart.sdf")


def test_friction_that_differs_from_wheel_to_wheel_is_refused(tmp_path: Path) -> None:
    slick = '<gazebo reference="left_front"><mu1>0.2</mu1><mu2>0.2</mu2></gazebo>'
    refused(tmp_path, urdf(WHEELS, slick), "must be that of all wheels")


def test_blocks_of_gazebo_for_one_link_add_up_and_the_later_counts(tmp_path: Path) -> None:
    blocks = "".join(
        f'<gazebo reference="{side}_{end}">{mu}</gazebo>'
        for side, _ in SIDES
        for end in ("front", "rear")
        for mu in ("<mu1>0.5</mu1><mu2>0.2</mu2>", "<mu1>0.3</mu1>", "<kp>1e6</kp>")
    )
    links = read(tmp_path, urdf(WHEELS, blocks)).tree.links
    found = [shape.friction for link in links for shape in link.shapes]
    assert {(each.first, each.second) for each in found if each} == {(0.3, 0.2)}


def in_collision(mu: str) -> str:
    """The friction of an extension as SDF has it."""
    ode = f"<ode><mu>{mu}</mu><mu2>{mu}</mu2></ode>"
    return f"<collision><surface><friction>{ode}</friction></surface></collision>"


@pytest.mark.parametrize(
    ("blocks", "friction"),
    [
        ((in_collision("0.4"),), 0.4),
        (("<mu1>0.6</mu1><mu2>0.6</mu2>", in_collision("0.4")), 0.4),
        (("<mu1>0.6</mu1><mu2>0.6</mu2>", "<collision><surface/></collision>"), 1.0),
        ((in_collision("0.4"), "<mu1>0.6</mu1><mu2>0.6</mu2>"), 0.6),
    ],
)
def test_friction_in_the_collision_of_an_extension_counts(
    tmp_path: Path, blocks: tuple[str, ...], friction: float
) -> None:
    text = "".join(
        f'<gazebo reference="{side}_{end}">{block}</gazebo>'
        for side, _ in SIDES
        for end in ("front", "rear")
        for block in blocks
    )
    assert read(tmp_path, urdf(WHEELS, text)).friction == friction


def test_friction_of_a_link_that_is_not_there_gets_a_warning(tmp_path: Path) -> None:
    slick = '<gazebo reference="left_fornt">{}</gazebo>'
    for block, count in (("<mu1>0.2</mu1>", 1), (in_collision("0.2"), 1), ("<kp>1e6</kp>", 0)):
        warnings = read(tmp_path, urdf(WHEELS, slick.format(block))).warnings
        found = [each for each in warnings if "no link has this name, got left_fornt" in each]
        assert len(found) == count


def test_friction_above_that_of_the_ground_is_the_grounds_in_gazebo(tmp_path: Path) -> None:
    rough = '<gazebo reference="left_front"><mu1>2</mu1><mu2>3</mu2></gazebo>'
    assert read(tmp_path, urdf(WHEELS, rough)).friction == 1.0


def test_friction_without_limit_is_refused_where_the_larger_holds(tmp_path: Path) -> None:
    names = [f"{side}_{end}" for side, _ in SIDES for end in ("front", "rear")]
    rough = "".join(
        f'<gazebo reference="{n}"><mu1>1e30</mu1><mu2>1e30</mu2></gazebo>' for n in names
    )
    refused(tmp_path, urdf(WHEELS, rough), "must have a limit", engine="mujoco")


def test_a_mesh_that_is_not_there_is_left_out_or_refused_on_request(tmp_path: Path) -> None:
    text = urdf(WHEELS, shapes=collision('<mesh filename="a.stl"/>'))
    refused(
        tmp_path,
        text,
        'must not be a mesh, got a.stl; pass mesh="hull" for its hull',
        mesh="refuse",
    )
    left_out(tmp_path, text, rf"left out: there is no file {tmp_path}/a.stl, got a.stl")
    left_out(tmp_path, text, "left out: a mesh, got a.stl", mesh="leave_out")
    assert read(tmp_path, text).robot.belly is None


def test_a_mesh_of_an_unknown_kind_or_package_is_left_out(tmp_path: Path) -> None:
    (tmp_path / "a.blend").write_text("")
    for name, reason in (
        ("a.blend", "must be a mesh of a known kind"),
        ("package://p/a.stl", "packages="),
    ):
        left_out(tmp_path, urdf(WHEELS, shapes=collision(f'<mesh filename="{name}"/>')), reason)


def test_a_model_without_anything_that_turns_is_refused(tmp_path: Path) -> None:
    refused(tmp_path, urdf(), "must have wheels .round collision shapes")


def test_wheels_with_upright_or_slanted_axles_are_refused(tmp_path: Path) -> None:
    for axis, turn, rule in (
        ("0 0 1", "0", "must have wheels .round collision shapes on horizontal joints"),
        ("0 3 1", "-1.2490457723982544", "must have wheels with horizontal axes"),
    ):
        across = f'<origin rpy="{turn} 0 0"/>'
        text = urdf(*(pair(end, x, axis=axis, origin=across) for end, x in (("a", 1), ("b", 0))))
        refused(tmp_path, text, rule)


@pytest.mark.parametrize(
    ("how", "reason"),
    [
        ({"type": "floating"}, "left_front is on a joint that is no hinge: floating"),
        (
            {"type": "revolute", "limit": LIMIT},
            "left_front turns by at most 367 degrees",
        ),
        ({"axis": "0 0 1"}, "left_front turns about an axis that is not level"),
        (
            {"origin": '<origin rpy="1.3 0 0"/>'},
            "left_front is tilted by 15.5 degrees against the axis on which it turns",
        ),
        (
            {"origin": ACROSS.replace("rpy", 'xyz="0.003 0 0" rpy')},
            "left_front has its centre 3 mm off the axis on which it turns",
        ),
    ],
)
def test_a_robot_without_wheels_says_why_a_round_shape_is_none(
    how: dict[str, Any], reason: str, tmp_path: Path
) -> None:
    path = tmp_path / "cart.urdf"
    path.write_text(urdf(pair("front", 0.2, **how), pair("rear", -0.2, **how)), encoding="utf-8")
    with refusing(SAID, "must have wheels") as caught:
        quietly(path)
    assert caught.value.value == "4 round shapes, none of them a wheel"
    assert caught.value.rule.endswith(f"tracks= names; {reason}")


def test_a_single_pair_of_wheels_is_refused(tmp_path: Path) -> None:
    refused(tmp_path, urdf(pair("only", 0.0)), "must have two wheels or drums on each side")


def flippers(x: float = 0.2, tip: str = "0.2 0 0", radius: str = "0.05", shape: str = "") -> str:
    kind = 'type="revolute"><axis xyz="0 1 0"/>' + LIMIT
    arms = "".join(
        link(f"{side}_arm{x}", kind, f"{x} {sign * 0.25} 0").replace("</link>", f"{shape}</link>")
        for side, sign in SIDES
    )
    tips = "".join(
        wheel(f"{side}_tip{x}", tip, parent=f"{side}_arm{x}", radius=radius) for side, _ in SIDES
    )
    return arms + tips


def test_a_flipper_with_a_wheel_at_its_tip_alone_keeps_it_there(tmp_path: Path) -> None:
    reading = read(tmp_path, urdf(WHEELS, flippers()))
    robot = reading.robot
    assert any("no wheel of theirs is at the pivot" in warning for warning in reading.warnings)
    assert robot.flippers is not None
    assert (robot.flippers.length, robot.flippers.torque_limit) == (0.2, 9.0)
    assert isinstance(robot.flippers.track, c2d.HybridWheels)
    assert robot.flippers.track.placements[0] == pytest.approx((0.1, 0.0, 0.05))


def test_a_flipper_that_pivots_off_the_end_axle_is_refused(tmp_path: Path) -> None:
    refused(tmp_path, urdf(WHEELS, flippers(x=0.1)), "must pivot within 5% of the axle distance")


def test_flippers_that_differ_from_end_to_end_are_refused(tmp_path: Path) -> None:
    text = urdf(WHEELS, flippers(), flippers(x=-0.2, tip="-0.25 0 0"))
    refused(tmp_path, text, "must be the same at both ends")


def test_a_bar_on_a_flipper_that_reaches_out_of_its_wheels_is_refused(tmp_path: Path) -> None:
    bar = collision('<box size="0.2 0.02 0.02"/>', '<origin xyz="0.1 0 0"/>')
    refused(tmp_path, urdf(WHEELS, flippers(shape=bar)), "must lie within the envelope")


def test_a_plate_within_the_envelope_of_a_flipper_is_left_out_with_a_warning(
    tmp_path: Path,
) -> None:
    plate = collision('<box size="0.04 0.02 0.08"/>', '<origin xyz="0.1 0 0"/>')
    arms = flippers(shape=plate)
    for side, _ in SIDES:
        arms += wheel(f"{side}_root", "0 0 0", parent=f"{side}_arm0.2", radius="0.05")
    reading = read(tmp_path, urdf(WHEELS, arms))
    assert "within the envelope of its flipper's wheels" in reading.warnings[0]
    assert "collision[" in reading.warnings[0]


def test_a_skid_that_rubs_on_level_ground_gets_a_warning(tmp_path: Path) -> None:
    skid = collision('<box size="0.1 0.1 0.16"/>')
    assert "rubs on level ground" in read(tmp_path, urdf(WHEELS, shapes=skid)).warnings[0]


@pytest.mark.parametrize(
    "shape", ['<box size="0.1 0.1 0.1"/>', '<cylinder radius="0.05" length="0.04"/>']
)
def test_a_lidar_that_turns_touches_nothing(tmp_path: Path, shape: str) -> None:
    """Nor is a lidar that is round about its axis a wheel, as its axle is upright."""
    lidar = link("lidar", 'type="continuous"><axis xyz="0 0 1"/>', "0.1 0 0.2").replace(
        "</link>", collision(shape) + "</link>"
    )
    reading = read(tmp_path, urdf(WHEELS, lidar))
    assert reading.robot.belly is None
    assert len(reading.wheels) == 4
    assert any(note.startswith("lidar: move by themselves") for note in reading.notes)


@pytest.mark.parametrize(
    ("argument", "value"),
    [
        *(("engine", "ode"), ("mesh", "keep"), ("missing", None), ("forward", "x")),
        *(("tolerance", -1.0), ("trusted", 1), ("model", ["cart"])),
    ],
)
def test_an_argument_with_an_unknown_value_is_refused(
    tmp_path: Path, argument: str, value: object
) -> None:
    with refusing(SAID) as caught:
        read(tmp_path, urdf(WHEELS), **{argument: value})  # type: ignore[arg-type]
    assert caught.value.path == argument


@pytest.mark.parametrize("argument", ["packages", "arguments"])
@pytest.mark.parametrize("value", [["a"], "", 7, {"a": object()}, {7: "a"}, {"a": ["b"]}])
def test_packages_and_arguments_that_are_no_pairs_are_refused(
    tmp_path: Path, argument: str, value: object
) -> None:
    with refusing(SAID, r" by (their )?name") as caught:
        read(tmp_path, urdf(WHEELS), **{argument: value})  # type: ignore[arg-type]
    assert caught.value.path.startswith(argument)


def test_a_flipper_without_a_partner_is_refused(tmp_path: Path) -> None:
    text = urdf(WHEELS, flippers().replace("0.2 -0.25 0", "0.19 -0.25 0"))
    refused(tmp_path, text, "must have a partner on the other side")


def test_flippers_that_differ_in_mass_have_the_mean(tmp_path: Path) -> None:
    text = urdf(WHEELS, flippers()).replace('<mass value="0.5"/>', '<mass value="0.8"/>', 1)
    found = read(tmp_path, text)
    assert found.robot.flippers is not None
    assert found.robot.flippers.mass == pytest.approx(1.65)  # arms of 0.8 and 0.5, tips of 1 kg
    assert "differ in mass left and right" in found.warnings[0]


def test_two_pairs_of_flippers_at_one_end_are_refused(tmp_path: Path) -> None:
    text = urdf(WHEELS, flippers(), flippers(x=0.201))
    refused(tmp_path, text, "must be the only flippers at its end")


def test_a_flipper_on_a_flipper_is_refused(tmp_path: Path) -> None:
    kind = 'type="revolute"><axis xyz="0 1 0"/>' + LIMIT
    hands = "".join(
        link(f"{side}_hand", kind, "0.2 0 0", parent=f"{side}_arm0.2") for side, _ in SIDES
    )
    tips = "".join(wheel(f"{side}_end", "0.1 0 0", parent=f"{side}_hand") for side, _ in SIDES)
    refused(tmp_path, urdf(WHEELS, flippers(), hands, tips), "on another moving part")


def test_flippers_at_one_end_without_wheels_on_the_chassis_are_refused(tmp_path: Path) -> None:
    refused(tmp_path, urdf(flippers()), "must have wheels on the chassis, or flippers at both ends")


def test_unevenly_spaced_wheels_on_flippers_at_both_ends_are_refused(tmp_path: Path) -> None:
    text = urdf(WHEELS, flippers(), flippers(x=-0.2, tip="-0.2 0 0"))
    refused(tmp_path, text, "must be the same at both ends and have evenly spaced wheels")


def test_one_joint_may_turn_both_flippers_and_each_has_half_its_torque(tmp_path: Path) -> None:
    kind = 'type="revolute"><axis xyz="0 1 0"/>' + LIMIT
    both = link("arms", kind, "0.2 0 0") + "".join(
        wheel(f"{side}_tip", f"0.2 {sign * 0.25} 0", parent="arms") for side, sign in SIDES
    )
    arms = read(tmp_path, urdf(WHEELS, both)).robot.flippers
    assert arms is not None
    assert (arms.torque_limit, arms.mass) == (4.5, 1.25)


def test_wheels_beside_moved_drums_are_refused(tmp_path: Path) -> None:
    drum = collision('<cylinder radius="0.1" length="0.1"/>', '<origin rpy="1.57079632679 0 0"/>')
    belts = "".join(
        link(f"{side}_belt", 'type="fixed">', f"0 {sign * 0.3} 0").replace(
            "</link>", f"{drum}</link>"
        )
        for side, sign in SIDES
    )
    text = urdf(WHEELS, belts)
    refused(tmp_path, text, "must be wheels, or drums of a", tracks=["left_belt", "right_belt"])


def test_an_auto_inertia_without_a_shape_is_refused(tmp_path: Path) -> None:
    part = """<link name="b"><inertial auto="true"/></link>
      <joint name="w" type="fixed"><parent>hull</parent><child>b</child></joint>"""
    text = tracked(((-0.4, 0.0, 0.1), (0.4, 0.0, 0.1))).replace("</model>", f"{part}</model>")
    refused(tmp_path, text, "must state mass and inertia", "tank.sdf")


def test_a_body_with_two_joints_is_refused(tmp_path: Path) -> None:
    pytest.importorskip("mujoco")
    text = (Path(__file__).parent / "files" / "cart.xml").read_text()
    joint = '<joint name="left_rear_joint" axis="0 1 0"/>'
    text = text.replace(joint, joint + '<joint name="toe" axis="0 0 1"/>')
    refused(tmp_path, text, "must have at most one joint", "cart.xml")


def test_a_robot_without_mass_is_refused(tmp_path: Path) -> None:
    text = re.sub(r'<mass value="[^"]*"', '<mass value="0"', urdf(WHEELS))
    refused(tmp_path, text, "must have links with a mass > 0 kg")


XACRO = '<robot xmlns:xacro="http://www.ros.org/wiki/xacro" name="cart">'


@pytest.mark.parametrize(
    ("text", "line", "rule"),
    [
        ("\n<xacro:wheel/>", 2, "unknown macro name: xacro:wheel"),
        ('\n\n<link name="a${mass + 1}"/>', 3, "must be xacro that expands"),
        ('\n<link name="$(find parts)"/>', 2, r"got parts: packages={name: folder} gives"),
    ],
)
def test_xacro_that_does_not_expand_is_refused_with_its_line(
    tmp_path: Path, text: str, line: int, rule: str
) -> None:
    pytest.importorskip("xacrodoc")
    how: Any = {"trusted": True, "missing": "refuse"}
    refused(tmp_path, f"{XACRO}{text}</robot>", rule, "cart.xacro", **how)
    with refusing(SAID, rf"^cart\.xacro:{line} "):
        read(tmp_path, f"{XACRO}{text}</robot>", "cart.xacro", **how)


def test_xacro_of_macros_only_is_refused(tmp_path: Path) -> None:
    pytest.importorskip("xacrodoc")
    text = f'{XACRO}<xacro:macro name="wheel" params=""><link name="w"/></xacro:macro></robot>'
    with refusing(SAID, "is read through the file that calls them"):
        read(tmp_path, text, "cart.xacro", trusted=True)


def test_joints_of_missing_links_are_left_out_or_refused_on_request(tmp_path: Path) -> None:
    mount = '<joint name="mount" type="fixed"><parent link="hull"/><child link="lidar"/></joint>'
    refused(
        tmp_path, urdf(WHEELS, mount), 'missing="leave_out" leaves out joints', missing="refuse"
    )
    reading = read(tmp_path, urdf(WHEELS, mount))
    assert "mount" in reading.warnings[0]


def test_a_misspelt_parent_is_named_with_the_nearest_link(tmp_path: Path) -> None:
    text = urdf(WHEELS).replace('<parent link="hull"/>', '<parent link="hul"/>', 1)
    refused(tmp_path, text, r"got hul \(did you mean hull\?\); missing=", missing="refuse")
