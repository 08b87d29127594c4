"""Oddities in parts that carry the robot are refused or give warnings; others are accepted."""

import re
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from crawler2d.reading.loading import ReadOptions, load_model
from crawler2d.reading.surfaces import refuse_unread
from tests.kept import refusing
from tests.reading.carts import (
    FILES,
    SAID,
    SIDES,
    TENSOR,
    WHEELS,
    collision,
    left_out,
    link,
    pair,
    read,
    refused,
    tracked,
    urdf,
)
from tests.robots.tree_keys import keys

LIMIT = '<limit lower="-1" upper="1" effort="9" velocity="1"/>'


def sensor(joint: str, shape: str = "", name: str = "lidar") -> str:
    """A link on top of the hull, which nothing drives on."""
    return link(name, joint, "0 0 0.3").replace("</link>", f"{shape}</link>")


def warnings_of(folder: Path, text: str, name: str = "cart.urdf", **how: Any) -> list[str]:
    """Read a cart, which must equal the one without the oddity, and return its warnings."""
    reading = read(folder, text, name, **how)
    assert reading.robot.outline.axle_distance == 0.4
    for warning in reading.warnings:
        assert re.match(re.escape(name) + r":\d+", warning), warning
    return list(reading.warnings)


@pytest.mark.parametrize(
    "shape",
    [
        '<sphere radius="0"/>',
        '<box size="0.1 0 0.1"/>',
        '<cylinder radius="0.1" length="0"/>',
        '<plane normal="0 0 1"/>',
        "<heightmap/>",
        "<bloc/>",
    ],
)
def test_a_shape_that_touches_nothing_is_left_out_of_a_sensor(tmp_path: Path, shape: str) -> None:
    text = urdf(WHEELS, sensor('type="fixed">', collision(shape)))
    (warning,) = warnings_of(tmp_path, text)
    assert "/geometry/" in warning
    assert "is left out: " in warning


@pytest.mark.parametrize("shape", ['<sphere radius="0"/>', "<bloc/>", '<mesh filename="w.stl"/>'])
def test_a_wheel_without_a_shape_is_refused_although_there_are_others(
    tmp_path: Path, shape: str
) -> None:
    text = urdf(WHEELS, pair("middle", 0.0, geometry=shape))
    refused(
        tmp_path, text, "as it may be a wheel or a track .*; so must right_middle: provide its mesh"
    )


def test_a_spinning_part_above_the_wheels_needs_no_shape(tmp_path: Path) -> None:
    mesh = collision('<mesh filename="dish.stl"/>')
    text = urdf(WHEELS, sensor('type="continuous"><axis xyz="0 1 0"/>', mesh))
    (warning,) = warnings_of(tmp_path, text)
    assert f"is left out: there is no file {tmp_path}/dish.stl" in warning


def test_a_model_whose_only_shapes_were_left_out_is_refused(tmp_path: Path) -> None:
    mesh = collision('<mesh filename="package://tank/track.stl"/>')
    tracks = "".join(
        link(f"{side}_track", 'type="fixed">').replace("</link>", f"{mesh}</link>")
        for side, _ in SIDES
    )
    rule = r"link\[left_track\] must have a collision shape .*; so must right_track: .*with tracks="
    refused(tmp_path, urdf(tracks), rule)
    refused(tmp_path, urdf(tracks), rule, tracks=["left_track", "right_track"])


def test_the_error_names_wheels_that_are_not_round_not_a_camera(tmp_path: Path) -> None:
    square = '<box size="0.1 0.1 0.1"/>'
    wheels = pair("front", 0.2, geometry=square) + pair("rear", -0.2, geometry=square)
    camera = sensor('type="fixed">', collision('<mesh filename="camera.stl"/>'), "camera")
    refused(tmp_path, urdf(wheels, camera), "must have wheels .round")


def test_a_moved_track_without_a_shape_is_refused_beside_wheels(tmp_path: Path) -> None:
    mesh = collision('<mesh filename="t.stl"/>')
    track = link("belt", 'type="fixed">').replace("</link>", f"{mesh}</link>")
    refused(tmp_path, urdf(WHEELS, track), r"link\[belt\] must have a collision", tracks=["belt"])


def test_a_capsule_of_length_0_is_a_sphere(tmp_path: Path) -> None:
    ball = pair("front", 0.2, geometry='<capsule radius="0.08" length="0"/>') + pair("rear", -0.2)
    assert warnings_of(tmp_path, urdf(ball)) == []


def test_an_ellipsoid_is_a_wheel_if_it_is_round_about_its_axle(tmp_path: Path) -> None:
    text = (FILES / "cart.sdf").read_text()
    found = re.search(r"<cylinder>\s*<radius>0.125</radius>\s*<length>[^<]*</length>", text)
    assert found
    ball = "<ellipsoid><radii>0.125 0.125 0.03</radii></ellipsoid>"
    changed = re.sub(re.escape(found[0]) + r"\s*</cylinder>", ball, text)
    outline = read(tmp_path, changed, "cart.sdf").robot.outline
    assert outline.front_radius == pytest.approx(0.125, rel=1e-9)


def test_a_cone_belongs_to_the_belly(tmp_path: Path) -> None:
    cone = collision('<cone radius="0.1" length="0.2"/>')
    belly = read(tmp_path, urdf(WHEELS, shapes=cone)).robot.belly
    assert belly is not None
    assert np.allclose(sorted(belly), [(-0.1, -0.1), (0.0, 0.1), (0.1, -0.1)], atol=1e-6)


@pytest.mark.parametrize(
    ("joint", "reason"),
    [
        ('type="revolute"><axis xyz="0 0 0"/>' + LIMIT, "must have an axis with a direction"),
        ('type="revolute"><axis xyz="0 0 1"/>', "must have a limit"),
        (
            'type="revolute"><axis xyz="0 0 1"/><limit lower="1" upper="-1" effort="1"/>',
            "must have a lower limit of at most the upper",
        ),
    ],
)
def test_a_joint_that_carries_nothing_is_fixed_if_it_is_wrong(
    tmp_path: Path, joint: str, reason: str
) -> None:
    (warning,) = warnings_of(tmp_path, urdf(WHEELS, sensor(joint)))
    assert f"is taken as fixed, as nothing on its joint collides: {reason}" in warning
    box = collision('<box size="0.1 0.1 0.1"/>')
    refused(tmp_path, urdf(WHEELS, sensor(joint, box)), reason)


@pytest.mark.parametrize(
    "joint",
    [
        'type="fixed"><axis xyz="0 0 0"/>',
        'type="revolute"><axis xyz="0 0 0"/><limit lower="0" upper="0" effort="1" velocity="1"/>',
        'type="revolute"><axis xyz="0 0 0"/><limit effort="1" velocity="1"/>',  # from 0 to 0
        'type="floating">',
        'type="planar">',
        'type="screw">',
    ],
)
def test_a_joint_that_needs_no_axis_has_none(tmp_path: Path, joint: str) -> None:
    box = collision('<box size="0.1 0.1 0.1"/>')
    assert warnings_of(tmp_path, urdf(WHEELS, sensor(joint, box))) == []


def test_two_joints_of_one_name_get_a_warning(tmp_path: Path) -> None:
    text = urdf(WHEELS).replace('name="left_front_joint"', 'name="left_rear_joint"')
    assert any(
        "is also the name of another joint" in warning for warning in warnings_of(tmp_path, text)
    )


def test_a_negative_moment_of_inertia_is_that_of_a_point(tmp_path: Path) -> None:
    text = urdf(WHEELS)
    wrong = text.replace(TENSOR, TENSOR.replace("0.1", "-0.1"))
    (warning,) = warnings_of(tmp_path, wrong)
    assert "is taken as 0 kg m^2: no body has a negative moment, got -0.1" in warning
    less = read(tmp_path, text).robot.moment_of_inertia - 0.2
    assert read(tmp_path, wrong).robot.moment_of_inertia == pytest.approx(less)


def test_an_inertia_that_no_body_in_the_robot_has_is_limited(tmp_path: Path) -> None:
    gps = sensor('type="fixed">').replace('<mass value="0.5"/>', '<mass value="0.01"/>')
    tensor = '<inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/>'
    gps = re.sub(r"<inertia .*?/>", tensor, gps)
    (warning,) = warnings_of(tmp_path, urdf(WHEELS, gps))
    assert re.search(r"is taken as \S+ kg m\^2, but 0.01 kg have at most", warning)
    usual = read(tmp_path, urdf(WHEELS)).robot.moment_of_inertia
    assert usual < read(tmp_path, urdf(WHEELS, gps)).robot.moment_of_inertia < usual + 0.01


def test_a_heavy_link_keeps_an_inertia_that_it_cannot_have(tmp_path: Path) -> None:
    tensor = '<inertia ixx="9" ixy="0" ixz="0" iyy="9" iyz="0" izz="9"/>'
    text = urdf(WHEELS)
    (warning,) = warnings_of(tmp_path, text.replace(TENSOR, tensor))
    assert "link[hull]/inertia is kept, but 8 kg have at most" in warning
    usual = read(tmp_path, text).robot.moment_of_inertia
    found = read(tmp_path, text.replace(TENSOR, tensor)).robot.moment_of_inertia
    assert found == pytest.approx(usual + 8.8)


def test_a_false_inertia_that_makes_no_difference_stays_as_it_is(tmp_path: Path) -> None:
    """Like flippers of 1e-5 kg with 1e-3 kg m2 in public models."""
    tiny = sensor('type="fixed">').replace('<mass value="0.5"/>', '<mass value="1e-5"/>')
    tensor = '<inertia ixx="1e-3" ixy="0" ixz="0" iyy="1e-3" iyz="0" izz="1e-3"/>'
    assert warnings_of(tmp_path, urdf(WHEELS, re.sub(r"<inertia .*?/>", tensor, tiny))) == []


def test_the_first_of_several_inertials_and_origins_holds(tmp_path: Path) -> None:
    twice = '<inertial><mass value="70"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/>'
    text = urdf(WHEELS, shapes=f"{twice}</inertial>")
    (warning,) = warnings_of(tmp_path, text)
    assert "link[hull]/inertial is left out: the first one counts" in warning
    assert read(tmp_path, text).robot.mass == 12.0
    moved = urdf(WHEELS, sensor('type="fixed"><origin xyz="0 0 1"/>'))
    assert any("origin is left out" in each for each in warnings_of(tmp_path, moved))


def test_a_negative_mass_is_refused(tmp_path: Path) -> None:
    refused(tmp_path, urdf(WHEELS, mass="-8"), "must have a mass >= 0 kg")


def test_of_several_trees_that_with_the_wheels_is_read(tmp_path: Path) -> None:
    many = "".join(f'<link name="stray{number}"/>' for number in range(9))
    first = urdf(WHEELS).replace('<link name="hull">', f'{many}<link name="hull">', 1)
    told = warnings_of(tmp_path, first)
    assert len(told) == 9
    assert "link[stray0] is left out: it is not joined to hull" in told[0]
    pair_of = link("b", 'type="fixed">', parent="a").replace("<link", '<link name="a"/><link', 1)
    (warning,) = warnings_of(tmp_path, urdf(WHEELS, pair_of))
    assert "link[a] is left out with 1 that hang on it: it is not joined to hull" in warning


@pytest.mark.parametrize("kind", ["fixed", "floating"])
def test_a_robot_held_to_the_world_is_read_as_free(tmp_path: Path, kind: str) -> None:
    held = f'<joint name="w" type="{kind}"><parent link="world"/><child link="hull"/></joint>'
    text = urdf(WHEELS, '<link name="world"/>', held)
    told = warnings_of(tmp_path, text)
    assert [("fixes the robot to the world" in each) for each in told] == [True] * (kind == "fixed")
    assert read(tmp_path, text).tree.links[0].name == "hull"


DRUMS = ((-0.4, 0.0, 0.1), (0.4, 0.0, 0.1))


def in_model(part: str) -> str:
    return tracked(DRUMS).replace("</model>", f"{part}</model>")


@pytest.mark.parametrize(
    ("part", "reason"),
    [
        ("<include><uri>model://arm</uri></include>", "it is in another file"),
        (
            '<include><uri>model://arm</uri><name>a</name></include><joint name="j" type="fixed">'
            "<parent>hull</parent><child>a::base</child></joint>",
            "it joins a link in another file",
        ),
        (
            '<joint name="w" type="fixed"><parent>world</parent><child>hull</child></joint>',
            "it fixes the robot to the world",
        ),
        (
            '<joint name="g" type="gearbox"><parent>left</parent><child>right</child></joint>',
            "it couples joints",
        ),
    ],
)
def test_parts_outside_of_an_sdf_model_are_left_out(tmp_path: Path, part: str, reason: str) -> None:
    left_out(tmp_path, in_model(part), f"({reason}|it is in another file)", "tank.sdf")
    reading = read(tmp_path, in_model(part), "tank.sdf")
    assert any(reason in warning for warning in reading.warnings)
    assert reading.robot.outline.axle_distance == pytest.approx(0.8)


def test_a_nested_model_is_part_of_the_robot(tmp_path: Path) -> None:
    """Its frame is relative to that of the model, and it has its own names."""
    mast = """<model name="mast"><pose>0 0 0.5 0 0 0</pose>
      <link name="hull"><inertial><mass>2</mass><inertia><ixx>0.1</ixx><iyy>0.1</iyy><izz>0.1</izz>
      </inertia></inertial></link>
      <link name="top"><pose relative_to="hull">0.1 0 0.2 0 0 0</pose>
      <inertial><mass>1</mass></inertial></link>
      <joint name="leftj" type="fixed"><parent>hull</parent><child>top</child></joint></model>
      <joint name="m" type="fixed"><parent>hull</parent><child>mast::hull</child></joint>"""
    plain = read(tmp_path, tracked(DRUMS), "tank.sdf")
    reading = read(tmp_path, in_model(mast), "tank.sdf")
    assert reading.robot.mass == pytest.approx(plain.robot.mass + 3.0)
    links = reading.tree.by_name
    assert links["mast::hull"].pose.place == pytest.approx([0.0, 0.0, 0.5])
    assert links["mast::top"].pose.place == pytest.approx([0.1, 0.0, 0.7])


MAST = """<model name="mast" {how}><pose relative_to="hull">0.1 0 0.5 0 0 {yaw}</pose>
  <link name="foot"><inertial><mass>1</mass></inertial></link>
  <link name="top"><pose>0.3 0 0.2 0 0 0</pose><inertial><mass>1</mass></inertial></link>
  <joint name="up" type="fixed"><parent>{parent}</parent><child>{child}</child></joint></model>
  <joint name="m" type="fixed"><parent>hull</parent><child>mast{end}</child></joint>"""


def mast(how: str = "", *, yaw: float = 0.0, end: str = "", is_on_top: bool = False) -> str:
    """A model of two links on the hull, held by its foot or its top."""
    held, other = ("top", "foot") if is_on_top else ("foot", "top")
    return MAST.format(how=how, yaw=yaw, parent=held, child=other, end=end)


def test_a_placement_frame_is_where_its_model_is_placed(tmp_path: Path) -> None:
    links = read(tmp_path, in_model(mast('placement_frame="top"')), "tank.sdf").tree.by_name
    assert links["mast::top"].pose.place == pytest.approx([0.1, 0.0, 0.5])
    assert links["mast::foot"].pose.place == pytest.approx([-0.2, 0.0, 0.3])
    turned = in_model(mast('placement_frame="top"', yaw=np.pi / 2.0))
    links = read(tmp_path, turned, "tank.sdf").tree.by_name
    assert links["mast::top"].pose.place == pytest.approx([0.1, 0.0, 0.5])
    assert links["mast::foot"].pose.place == pytest.approx([0.1, -0.3, 0.3])


def test_a_placement_frame_may_be_that_of_a_model_inside(tmp_path: Path) -> None:
    """Both models are placed by their own frames, and the inner one by the outer's link."""
    inner = """<model name="lamp" placement_frame="bulb">
      <pose relative_to="top">0 0 0.1 0 0 0</pose>
      <link name="bulb"><pose>0 0 0.7 0 0 0</pose><inertial><mass>1</mass></inertial></link></model>
      <joint name="l" type="fixed"><parent>top</parent><child>lamp</child></joint></model>"""
    outer = mast('placement_frame="lamp"').replace("</model>", inner, 1)
    links = read(tmp_path, in_model(outer), "tank.sdf").tree.by_name
    assert links["mast::lamp::bulb"].pose.place == pytest.approx([0.1, 0.0, 0.5 + 0.7])
    assert links["mast::top"].pose.place == pytest.approx([0.1, 0.0, 0.5 + 0.6])


def test_models_in_models_that_are_all_placed_by_the_innermost_link_take_no_time(
    tmp_path: Path,
) -> None:
    """Each is placed at the origin of the next, and its link is placed only once."""
    count = 30
    names = [f"m{number}" for number in range(count)]
    inner = '<link name="z"><pose>0 0 1 0 0 0</pose><inertial><mass>1</mass></inertial></link>'
    for depth, name in reversed(list(enumerate(names))):
        link = "::".join([*names[depth + 1 :], "z"])
        inner = f'<model name="{name}" placement_frame="{link}">{inner}</model>'
    end = "::".join([*names, "z"])
    fixed = f'<joint name="f" type="fixed"><parent>hull</parent><child>{end}</child></joint>'
    begin = time.monotonic()
    links = read(tmp_path, in_model(inner + fixed), "tank.sdf").tree.by_name
    assert time.monotonic() - begin < 5.0
    assert links[end].pose.place == pytest.approx([0.0, 0.0, 0.0])


def test_a_placement_frame_that_is_missing_is_refused(tmp_path: Path) -> None:
    refused(tmp_path, in_model(mast('placement_frame="tip"')), "must name a link", "tank.sdf")


@pytest.mark.parametrize("end", ["", "::foot", "::__model__"])
def test_the_name_of_a_model_is_that_of_its_frame(tmp_path: Path, end: str) -> None:
    part = """<link name="b"><pose relative_to="mast">0 0 0.25 0 0 0</pose><inertial><mass>1</mass>
      </inertial></link><joint name="w" type="fixed"><parent>roof</parent><child>b</child></joint>
      <frame name="roof" attached_to="mast"/>"""
    tree = read(tmp_path, in_model(mast(end=end) + part), "tank.sdf").tree
    assert tree.by_name["b"].pose.place == pytest.approx([0.1, 0.0, 0.75])
    assert tree.joints["b"].parent == "mast::foot"
    assert tree.joints["mast::foot"].parent == "hull"


def test_a_model_is_held_by_its_canonical_link(tmp_path: Path) -> None:
    text = in_model(mast('canonical_link="top"', is_on_top=True))
    joints = read(tmp_path, text, "tank.sdf").tree.joints
    assert (joints["mast::top"].parent, joints["mast::foot"].parent) == ("hull", "mast::top")


def test_a_frame_may_be_attached_to_a_joint(tmp_path: Path) -> None:
    """It moves with the child of the joint."""
    part = """<link name="a"><pose>0 0 1 0 0 0</pose><inertial><mass>1</mass></inertial></link>
      <joint name="up" type="fixed"><pose>0 0 0.5 0 0 0</pose><parent>hull</parent><child>a</child>
      </joint><frame name="tip" attached_to="up"/><link name="b"><pose relative_to="tip"/><inertial>
      <mass>1</mass></inertial></link>
      <joint name="w" type="fixed"><parent>tip</parent><child>b</child></joint>"""
    tree = read(tmp_path, in_model(part), "tank.sdf").tree
    assert tree.joints["b"].parent == "a"
    assert tree.by_name["b"].pose.place == pytest.approx([0.0, 0.0, 1.5])


@pytest.mark.parametrize("end", ["roof", "__model__", "hull"])
def test_a_joint_may_join_frames(tmp_path: Path, end: str) -> None:
    part = f"""<frame name="roof" attached_to="under"><pose>0 0 1 0 0 0</pose></frame>
      <frame name="under" attached_to="hull"/><link name="b"><pose relative_to="roof">0 0 0.5 0 0 0
      </pose><inertial><mass>1</mass></inertial></link><joint name="w" type="fixed">
      <parent>{end}</parent><child>b</child></joint>"""
    tree = read(tmp_path, in_model(part), "tank.sdf").tree
    assert tree.joints["b"].parent == "hull"
    assert tree.by_name["b"].pose.place == pytest.approx([0.0, 0.0, 1.5])


def by_slices(radius: float, length: float, density: float) -> tuple[float, float, float]:
    """Mass, and moments across and along, of a capsule cut into thin discs."""
    ends = 0.5 * length + radius
    z, step = np.linspace(-ends, ends, 200_001, retstep=True)
    beyond = np.maximum(np.abs(z) - 0.5 * length, 0.0)
    squares = np.maximum(radius**2 - beyond**2, 0.0)
    own = density * np.pi * squares * step
    across = (own * (squares / 4.0 + z**2)).sum()
    return float(own.sum()), float(across), float((own * squares / 2.0).sum())


@pytest.mark.parametrize(
    ("shape", "wanted"),
    [
        ("<box><size>0.2 0.1 0.3</size></box>", (3.0, 0.025, 0.0125)),
        ("<sphere><radius>0.1</radius></sphere>", by_slices(0.1, 0.0, 500.0)),
        (
            "<capsule><radius>0.1</radius><length>0.3</length></capsule>",
            by_slices(0.1, 0.3, 500.0),
        ),
    ],
)
def test_auto_mass_and_inertia_are_computed(
    tmp_path: Path, shape: str, wanted: tuple[float, float, float]
) -> None:
    part = f"""<link name="b"><pose>0 0 0.5 0 0 0</pose><inertial auto="true"><density>500</density>
      </inertial><collision name="c"><geometry>{shape}</geometry></collision></link>
      <joint name="w" type="fixed"><parent>hull</parent><child>b</child></joint>"""
    link = read(tmp_path, in_model(part), "tank.sdf").tree.by_name["b"]
    found = (link.mass, link.inertia[0, 0], link.inertia[2, 2])
    assert found == pytest.approx(wanted, rel=1e-6)
    assert link.center == pytest.approx([0.0, 0.0, 0.5])


CUBE = """<collision name="{name}"><pose>{x} 0 0.5 0 0 0</pose>{more}<geometry><box>
  <size>0.1 0.1 0.1</size></box></geometry></collision>"""


def auto(inertial: str, *cubes: str) -> str:
    """A vehicle with a link whose mass is to be computed."""
    return in_model(f"""<link name="b"><inertial auto="true">{inertial}</inertial>{"".join(cubes)}
      </link><joint name="w" type="fixed"><parent>hull</parent><child>b</child></joint>""")


def test_a_collision_has_its_own_density(tmp_path: Path) -> None:
    """A litre of 3 kg and one of 1 kg: the density of the link is that of the other."""
    heavy = CUBE.format(name="h", x=0.2, more="<density>3000</density>")
    text = auto("<density>1000</density>", heavy, CUBE.format(name="l", x=-0.2, more=""))
    found = read(tmp_path, text, "tank.sdf").tree.by_name["b"]
    assert found.mass == pytest.approx(4.0)
    assert found.center == pytest.approx([0.1, 0.0, 0.5])
    assert found.inertia[0, 0] == pytest.approx(4.0 * 0.01 / 6.0)
    assert found.inertia[1, 1] == pytest.approx(4.0 * 0.01 / 6.0 + 3.0 * 0.01 + 1.0 * 0.09)
    refused(
        tmp_path, text.replace("3000", "0"), "must have a density > 0 kg/m\\^3, got 0", "tank.sdf"
    )


def test_a_stated_mass_is_that_of_all_collisions(tmp_path: Path) -> None:
    text = auto("<mass>6</mass>", CUBE.format(name="c", x=0.2, more=""))
    found = read(tmp_path, text, "tank.sdf").tree.by_name["b"]
    assert found.mass == pytest.approx(6.0)
    assert found.inertia == pytest.approx(6.0 * 0.01 / 6.0 * np.eye(3))
    refused(tmp_path, text.replace(">6<", ">-6<"), "must have a mass >= 0 kg", "tank.sdf")


def test_links_without_collisions_have_a_mass(tmp_path: Path) -> None:
    masked = "<surface><contact><collide_bitmask>0x00</collide_bitmask></contact></surface>"
    text = auto("", CUBE.format(name="c", x=0.2, more=masked))
    assert read(tmp_path, text, "tank.sdf").tree.by_name["b"].mass == pytest.approx(1.0)


def test_of_several_models_the_one_that_can_drive_is_read(tmp_path: Path) -> None:
    cart = (FILES / "cart.sdf").read_text().partition("<model")[2].rpartition("</model>")[0]
    door = """<model name="door"><link name="frame"/><link name="leaf"/>
      <joint name="h" type="revolute"><parent>frame</parent><child>leaf</child><axis>
      <limit><lower>0</lower><upper>1.5</upper></limit></axis></joint></model>"""
    crate = '<model name="crate"><link name="box"/></model>'
    world = '<sdf version="1.9"><world name="w">{}</world></sdf>'
    text = world.format(f"{crate}{door}<model{cart}</model>")
    assert read(tmp_path, text, "w.sdf").robot.name == "cart"
    refused(tmp_path, world.format(crate + door), "one of several with wheels .* door", "w.sdf")
    two = f"<model{cart}</model><model{cart.replace('cart', 'other', 1)}</model>{crate}"
    refused(tmp_path, world.format(two), "got cart, other: model= names it; ", "w.sdf")


def test_of_several_bodies_the_one_that_can_drive_is_read(tmp_path: Path) -> None:
    pytest.importorskip("mujoco")
    crate = '<body name="crate"><freejoint/><geom size="0.1"/></body>'
    text = (FILES / "cart.xml").read_text().replace("</worldbody>", f"{crate}</worldbody>")
    assert (
        read(tmp_path, text, "cart.xml").robot
        == read(tmp_path, text, "cart.xml", model="hull").robot
    )


def test_an_older_sdf_is_refused_with_a_way_to_convert_it(tmp_path: Path) -> None:
    for version in ('version="1.3"', ""):
        text = tracked(DRUMS).replace('version="1.7"', version)
        refused(tmp_path, text, '"gz sdf -p FILE" rewrites a file', "tank.sdf")


def test_a_body_with_two_joints_that_carries_nothing_is_fixed(tmp_path: Path) -> None:
    pytest.importorskip("mujoco")
    text = (FILES / "cart.xml").read_text()
    shape = '<geom size="0.05" contype="{0}" conaffinity="{0}"/>'
    head = f'<body name="head"><joint axis="0 0 1"/><joint axis="0 1 0"/>{shape}</body>'
    for collides in (0, 1):
        with_head = text.replace("<freejoint/>", f"<freejoint/>{head.format(collides)}", 1)
        if collides:
            refused(tmp_path, with_head, "must have at most one joint", "cart.xml")
        else:
            warned = read(tmp_path, with_head, "cart.xml").warnings
            assert any("body[head] is taken as fixed" in warning for warning in warned)


def test_an_ellipsoid_of_mujoco_is_a_hull(tmp_path: Path) -> None:
    pytest.importorskip("mujoco")
    box = '<geom type="box" pos="0 0 0.0625" size="0.25 0.125 0.0625"/>'
    text = (FILES / "cart.xml").read_text()
    assert box in text
    ball = '<geom type="ellipsoid" size="0.2 0.1 0.05"/>'
    belly = read(tmp_path, text.replace(box, ball), "cart.xml").robot.belly
    assert belly is not None
    assert np.ptp(np.array(belly), axis=0) == pytest.approx([0.4, 0.1], rel=1e-3)


def test_a_mesh_of_mjcf_that_is_only_seen_need_not_be_there(tmp_path: Path) -> None:
    pytest.importorskip("mujoco")
    text = (FILES / "cart.xml").read_text()
    assets = """<asset><mesh name="m" file="m.stl"/><texture name="t" type="2d" file="t.png"/>
      <material name="paint" texture="t"/></asset><worldbody>"""
    seen = '<geom type="mesh" mesh="m" contype="0" conaffinity="0" material="paint" mass="0"/>'
    text = text.replace("<worldbody>", assets).replace("<freejoint/>", f"<freejoint/>{seen}", 1)
    reading = read(tmp_path, text, "cart.xml")
    assert not any("m.stl" in warning for warning in reading.warnings)
    touching = text.replace('contype="0" conaffinity="0"', "")
    (warning,) = [d for d in read(tmp_path, touching, "cart.xml").warnings if "m.stl" in d]
    assert f"is left out: there is no file {tmp_path}/m.stl" in warning
    box = '<body><geom type="box" size="0.1 0.1 0.1" mass="1"/>{}</body>'
    heavy = text.replace(seen, box.format(seen.replace(' mass="0"', "")))
    told = read(tmp_path, heavy, "cart.xml").warnings
    assert any("has no mass here, but its volume counts" in warning for warning in told)


def test_a_mesh_that_alone_gives_a_body_its_mass_is_named_if_it_is_missing(tmp_path: Path) -> None:
    """MuJoCo would complain about too small a mass of a body that has a shape in the file."""
    pytest.importorskip("mujoco")
    wheel = """<inertial pos="0 0 0" mass="1" diaginertia="0.004 0.0078125 0.004"/>
        <geom class="tread" size="0.125 0.03125"/>"""
    text = (FILES / "cart.xml").read_text()
    assert wheel in text
    text = text.replace(wheel, '<geom type="mesh" mesh="m"/>', 1)
    mesh = '<asset><mesh name="m" file="m.stl"/></asset><worldbody>'
    with refusing(SAID, "must be a regular file") as caught:
        read(tmp_path, text.replace("<worldbody>", mesh), "cart.xml")
    assert (caught.value.path, caught.value.value) == ("cart.xml:8: meshes[m]", "m.stl")


@pytest.mark.parametrize("name", ["tractor", "marv_model", "sekirei2020", "marv"])
def test_parts_that_cannot_carry_the_robot_do_not_stop_the_reader(name: str) -> None:
    pytest.importorskip("xacrodoc")
    key = keys()[name]
    how = ReadOptions(packages=key.packages, arguments=key.arguments)
    refuse_unread(load_model(key.file.read_bytes(), key.file, how).tree)


def test_the_public_tank_of_meshes_is_refused_with_what_it_lacks() -> None:
    pytest.importorskip("xacrodoc")
    key = keys()["tank"]
    data = key.file.read_bytes()
    missing = b'<xacro:include filename="controller.xacro"/>'
    assert missing in data
    tree = load_model(data.replace(missing, b""), key.file, ReadOptions(packages=key.packages)).tree
    with refusing(SAID, r"there is no file .*wheel\.stl.* provide its mesh"):
        refuse_unread(tree)
