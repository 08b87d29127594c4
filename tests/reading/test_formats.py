"""One robot in three formats gives the same robot; each format is read by its own rules."""

import itertools
import math
import pickle
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import crawler2d as c2d
from crawler2d.reading.assembly import _axis_name
from tests.kept import refusing
from tests.reading.carts import (
    FILES,
    SAID,
    SIDES,
    WHEELS,
    XACRO,
    collision,
    link,
    pair,
    quietly,
    read,
    urdf,
    wheel,
)

SDF = quietly(FILES / "cart.sdf")


def test_one_robot_as_sdf_and_urdf_is_the_same_scenario() -> None:
    other = quietly(FILES / "cart.urdf")
    step = c2d.terrains.step(0.05)
    assert c2d.Scenario(SDF.robot, step) == c2d.Scenario(other.robot, step)
    assert other.friction == SDF.friction == 0.75


def test_one_robot_as_xacro_is_the_same_scenario() -> None:
    pytest.importorskip("xacrodoc")
    other = quietly(FILES / "cart.xacro", trusted=True)
    assert other.robot == SDF.robot
    assert other.friction == SDF.friction


def test_one_robot_as_mjcf_is_the_same_scenario() -> None:
    pytest.importorskip("mujoco")
    other = quietly(FILES / "cart.xml", engine="gz")
    assert c2d.Scenario(SDF.robot, c2d.terrains.flat()) == c2d.Scenario(
        other.robot, c2d.terrains.flat()
    )
    assert other.friction == SDF.friction


def test_mujoco_takes_the_larger_friction_for_its_own_format() -> None:
    pytest.importorskip("mujoco")
    assert quietly(FILES / "cart.xml").friction == 1.0
    assert quietly(FILES / "cart.xml", ground_friction=0.3).friction == 0.75


def test_a_geom_of_higher_priority_has_its_own_friction(tmp_path: Path) -> None:
    pytest.importorskip("mujoco")
    text = (
        (FILES / "cart.xml")
        .read_text()
        .replace('<geom friction="0.75"', '<geom friction="0.75" priority="1"')
    )
    assert read(tmp_path, text, "cart.xml").friction == 0.75


@pytest.mark.parametrize(
    ("attributes", "wanted"),
    [
        ('friction="1.75" condim="1"', 1.75),
        ('friction="1.75" condim="1" priority="1"', 0.0),
        ('friction="1.75" priority="-1"', 1.0),
        ('friction="0.75" priority="-1"', 1.0),
    ],
)
def test_friction_is_that_of_a_contact_in_mujoco(
    tmp_path: Path, attributes: str, wanted: float
) -> None:
    """The larger number of dimensions of two geoms counts, or everything of the prior one."""
    mujoco = pytest.importorskip("mujoco")
    on_ground = f"""<mujoco><worldbody><geom type="plane" size="1 1 1"/><body pos="0 0 0.09">
      <freejoint/><geom size="0.1" {attributes}/></body></worldbody></mujoco>"""
    model = mujoco.MjModel.from_xml_string(on_ground)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    has_friction = data.contact.dim[0] > 1
    assert (data.contact.friction[0][0] if has_friction else 0.0) == wanted
    text = (FILES / "cart.xml").read_text().replace('friction="0.75"', attributes)
    assert read(tmp_path, text, "cart.xml").friction == wanted


def test_mjcf_names_the_line_of_an_error(tmp_path: Path) -> None:
    pytest.importorskip("mujoco")
    text = (FILES / "cart.xml").read_text().replace('zaxis="0 1 0"', 'zaxle="0 1 0"')
    with refusing(SAID, r"cart\.xml:6 must be a model that"):
        read(tmp_path, text, "cart.xml")


def test_mjcf_that_includes_other_files_is_refused(tmp_path: Path) -> None:
    text = '<mujoco><include file="robot.xml"/></mujoco>'
    with refusing(SAID, "must contain the robot itself"):
        read(tmp_path, text, "scene.xml")


@pytest.mark.parametrize(("file", "value"), [(' file="robot.xml"', "robot.xml"), ("", "")])
def test_an_include_of_mjcf_is_refused_with_its_file_and_its_line(
    file: str, value: str, tmp_path: Path
) -> None:
    path = tmp_path / "cart.xml"
    path.write_text(f"<mujoco>\n<include{file}/></mujoco>", encoding="utf-8")
    with pytest.raises(c2d.ScenarioError) as caught:
        quietly(path)
    assert (caught.value.path, caught.value.value) == ("cart.xml:2: mujoco/include", value)
    assert caught.value.rule.startswith("must contain the robot itself")


def test_a_mjcf_robot_that_does_not_float_is_refused(tmp_path: Path) -> None:
    pytest.importorskip("mujoco")
    text = (FILES / "cart.xml").read_text().replace("<freejoint/>", "")
    with refusing(SAID, "must have one body with a free joint"):
        read(tmp_path, text, "cart.xml")


def test_surfaces_that_mujoco_moves_are_drums(tmp_path: Path) -> None:
    mujoco = pytest.importorskip("mujoco")
    if not hasattr(mujoco.MjSpec().worldbody.add_geom(), "surfacevel"):
        pytest.skip("this MuJoCo moves no surfaces")
    drums = "".join(
        f'<geom type="cylinder" zaxis="0 1 0" pos="{x} {y} 0" size="0.1 0.02" surfacevel="1 0 0"/>'
        for x in (-0.3, 0.3)
        for y in (-0.2, 0.2)
    )
    crate = '<body name="crate" pos="2 0 0"><freejoint/><geom size="0.1"/></body>'
    for others in ("", crate):  # of floating bodies, that with moved surfaces is the robot
        hull = f'<body name="hull"><freejoint/>{drums}</body>'
        text = f"<mujoco><worldbody>{others}{hull}</worldbody></mujoco>"
        reading = read(tmp_path, text, "belt.xml")
        assert reading.robot.track == c2d.BeltTrack()
        assert reading.robot.outline.axle_distance == 0.6


def test_links_that_something_outside_the_file_moves_are_named(tmp_path: Path) -> None:
    drum = '<collision><origin xyz="{x} 0 0" rpy="1.5707963267948966 0 0"/><geometry>'
    drum += '<cylinder radius="0.1" length="0.1"/></geometry></collision>'
    both = "".join(drum.format(x=x) for x in (-0.25, 0.25))
    tracks = "".join(
        link(f"{side}_track", 'type="fixed">', f"0 {sign * 0.2} 0").replace(
            "</link>", f"{both}</link>"
        )
        for side, sign in SIDES
    )
    reading = read(tmp_path, urdf(tracks), tracks=["left_track", "right_track"])
    assert reading.robot.track == c2d.BeltTrack()
    with refusing(SAID, "tracks must be links of the model"):
        read(tmp_path, urdf(tracks), tracks=["middle_track"])


@pytest.mark.parametrize("tracks", [5, None, "hull", object()])
def test_tracks_are_a_collection_of_names(tracks: object) -> None:
    with refusing(SAID, "tracks must be a collection of names of links"):
        quietly(FILES / "cart.urdf", tracks=tracks)


@pytest.mark.parametrize("ground", ["x", None, [1.0], True, -1.0, math.nan, 1e9])
def test_an_invalid_friction_of_the_ground_is_refused(ground: Any) -> None:
    with refusing(SAID, r"^ground(_friction)? must be "):
        SDF.friction_on(ground)


@pytest.mark.parametrize("forward", [5, ["+x"], "x"])
def test_forward_is_one_of_four_directions(forward: object) -> None:
    with refusing(SAID, r"^forward must be one of .*\+x.*, or None, got"):
        quietly(FILES / "cart.urdf", forward=forward)


def sdf(version: str, axis: str) -> str:
    """A cart whose wheel links are rolled by 90 degrees: their z axis points to the right."""
    wheels = "".join(
        f"""<link name="{side}{end}"><pose>{x} {y} 0 1.5707963267948966 0 0</pose>
        <inertial><mass>1</mass></inertial><collision name="c"><geometry><cylinder>
        <radius>0.1</radius><length>0.1</length></cylinder></geometry></collision></link>
        <joint name="{side}{end}j" type="revolute"><parent>hull</parent><child>{side}{end}</child>
        {axis}</joint>"""
        for side, y in (("l", 0.2), ("r", -0.2))
        for end, x in (("f", 0.2), ("b", -0.2))
    )
    return f'<sdf version="{version}"><model name="m"><link name="hull"/>{wheels}</model></sdf>'


@pytest.mark.parametrize(
    ("version", "axis"),
    [
        ("1.4", "<axis><xyz>0 1 0</xyz></axis>"),  # in the frame of the model
        ("1.5", "<axis><xyz>0 0 1</xyz></axis>"),  # in that of the joint
        ("1.6", "<axis><xyz>0 1 0</xyz><use_parent_model_frame>1</use_parent_model_frame></axis>"),
        ("1.6", "<axis><xyz>0 0 1</xyz><use_parent_model_frame>0</use_parent_model_frame></axis>"),
        ("1.7", '<axis><xyz expressed_in="__model__">0 1 0</xyz></axis>'),
        ("1.11", "<axis><xyz>0 0 1</xyz></axis>"),
        ("1.12", "<axis><xyz>0 0 1</xyz></axis>"),
    ],
)
def test_the_frame_of_an_axis_depends_on_the_sdf_version(
    tmp_path: Path, version: str, axis: str
) -> None:
    assert read(tmp_path, sdf(version, axis), "m.sdf").robot.track == c2d.LineOfWheels(2)


@pytest.mark.parametrize("version", ["1.3", "1.13", "2.0", "", "1.6.1"])
def test_other_versions_of_sdf_are_refused(tmp_path: Path, version: str) -> None:
    with refusing(SAID, r"@version must be of version 1.4 to 1.12"):
        read(tmp_path, sdf(version, ""), "m.sdf")


def test_a_frame_of_a_pose_that_has_no_meaning_gets_a_warning(tmp_path: Path) -> None:
    text = (FILES / "cart.sdf").read_text()
    for frame, count in (("left_rear", 1), ("", 0)):
        other = text.replace("<pose>", f'<pose frame="{frame}">', 1)
        assert other != text
        found = [each for each in read(tmp_path, other, "c.sdf").warnings if "pose@frame" in each]
        assert len(found) == count
        assert all(each.endswith(f"from SDF 1.7 on relative_to has, got {frame}") for each in found)


def test_a_joint_of_a_world_gets_a_warning(tmp_path: Path) -> None:
    model = (FILES / "cart.sdf").read_text().partition("<model")[2].rpartition("</model>")[0]
    joint = "<joint name='j' type='fixed'><parent>world</parent><child>cart</child></joint>"
    text = f'<sdf version="1.12"><world name="w">{joint}<model{model}</model></world></sdf>'
    found = read(tmp_path, text, "w.sdf").warnings
    assert [each for each in found if each.endswith("are not joined to others, got world to cart")]


def test_of_several_models_in_a_world_one_must_be_named(tmp_path: Path) -> None:
    model = (FILES / "cart.sdf").read_text().partition("<model")[2].rpartition("</model>")[0]
    worlds = "".join(f"<model{model.replace('cart', name)}</model>" for name in ("one", "two"))
    text = f'<sdf version="1.9"><world name="w">{worlds}</world></sdf>'
    with refusing(SAID, "must have one model that is not static"):
        read(tmp_path, text, "w.sdf")
    assert read(tmp_path, text, "w.sdf", model="two").robot.name == "two"
    with refusing(SAID, "model must be one of one, two"):
        read(tmp_path, text, "w.sdf", model="three")


def test_xacro_takes_arguments(tmp_path: Path) -> None:
    pytest.importorskip("xacrodoc")
    start = '<robot xmlns:xacro="http://www.ros.org/wiki/xacro" name="cart">'
    start += '<xacro:arg name="mass" default="8"/>'
    text = urdf(WHEELS, mass="$(arg mass)").replace('<robot name="cart">', start)
    assert read(tmp_path, text, "cart.xacro").robot.mass == 12.0
    given = read(tmp_path, text, "cart.xacro", arguments={"mass": "18"})
    assert given.robot.mass == 22.0
    assert "cart.xacro (expanded):" in given.sources["robot.mass"]
    assert "18" in given.text


def test_arguments_that_no_file_has_get_a_warning(tmp_path: Path) -> None:
    """All settings of a file are often passed together, but then as they are in it."""
    pytest.importorskip("xacrodoc")
    (tmp_path / "sizes.yaml").write_text("load: 3\nwide: 2\n", encoding="utf-8")
    text = f'{XACRO}<xacro:arg name="mass" default="8"/>{urdf(WHEELS).partition(">")[2]}'
    text = text.replace("<link", '<xacro:if value="$(eval heavy)"/><link', 1)
    given = {
        "mas": "18",
        "Mass": "2",
        "mass": "9",
        "load": "1",
        "wide": "2.0",
        "radius": "0.2",
        "heavy": "0",
    }
    found = read(tmp_path, text, "cart.xacro", arguments=given).warnings
    close = "it must be an argument of the model (did you mean mass?)"
    assert [each for each in found if "no effect" in each] == [
        f"arguments[mas] has no effect: {close}, got mas=18",
        f"arguments[Mass] has no effect: {close}, got Mass=2",
        "arguments[load] has no effect: it must be an argument of the model, got load=1",
        "arguments[radius] has no effect: it must be an argument of the model, got radius=0.2",
    ]


def test_arguments_that_a_format_does_not_have_get_a_warning(tmp_path: Path) -> None:
    found = read(tmp_path, urdf(WHEELS), model="cart", arguments={"mass": "9"}).warnings
    assert [each.partition(":")[0] for each in found] == [
        "arguments has no effect",
        "model has no effect",
    ]


def test_xacro_that_needs_packages_says_which(tmp_path: Path) -> None:
    pytest.importorskip("xacrodoc")
    parts = '<xacro:include filename="$(find cart_parts)/wheels.xacro"/>'
    text = urdf(parts).replace("<robot", '<robot xmlns:xacro="http://www.ros.org/wiki/xacro"')
    with refusing(SAID, r"must have its packages.*got cart_parts"):
        read(tmp_path, text, "cart.xacro", missing="refuse")
    folder = tmp_path / "parts"
    folder.mkdir()
    (folder / "wheels.xacro").write_text(f"<robot>{WHEELS}</robot>")
    found = read(tmp_path, text, "cart.xacro", trusted=True, packages={"cart_parts": folder})
    assert found.robot.track == c2d.LineOfWheels(2)


def test_macros_in_a_file_that_is_not_called_xacro_are_refused(tmp_path: Path) -> None:
    with refusing(SAID, "must be expanded"):
        read(tmp_path, urdf('<xacro:wheel name="w"/>'))


def test_wheels_that_stand_unevenly_are_placed_one_by_one(tmp_path: Path) -> None:
    reading = read(tmp_path, urdf(WHEELS, pair("mid", 0.05, z=-0.01, radius="0.05")))
    assert isinstance(reading.robot.track, c2d.HybridWheels)
    assert reading.robot.track.placements == (
        (-0.2, 0.0, 0.08),
        (0.05, -0.01, 0.05),
        (0.2, 0.0, 0.08),
    )


def test_a_double_wheel_is_one_in_side_view(tmp_path: Path) -> None:
    reading = read(tmp_path, urdf(WHEELS, pair("front_outer", 0.2, y=0.25)))
    assert reading.robot.track == c2d.LineOfWheels(2)
    assert len(reading.wheels) == 6


def test_forward_is_the_side_of_the_links_called_front(tmp_path: Path) -> None:
    turned = urdf(pair("front", -0.2) + pair("rear", 0.2, radius="0.07"))
    reading = read(tmp_path, turned)
    assert reading.robot.outline.front_radius == 0.08
    assert any("on the other side than its name says" in warning for warning in reading.warnings)


def test_forward_is_x_where_names_do_not_decide(tmp_path: Path) -> None:
    reading = read(tmp_path, urdf(pair("a", 0.2) + pair("b", -0.2)))
    assert reading.notes[0] == "no link is called front or rear: +x is forward"


@pytest.mark.parametrize(
    ("direction", "name"),
    [
        ((-0.8, 0.6, 0.0), "-x"),
        ((0.8, -0.6, 0.0), "+x"),
        ((0.1, -0.9, 0.3), "-y"),
        ((0, 0, 1), "+z"),
    ],
)
def test_a_slanting_direction_is_called_after_its_nearest_axis(
    direction: tuple[float, float, float], name: str
) -> None:
    assert _axis_name(np.array(direction)) == name


def across_x(name: str) -> str:
    """A wheel on either side, with its axle along x."""
    turned = {"axis": "1 0 0", "origin": '<origin rpy="0 1.5707963267948966 0"/>'}
    y = 0.2 if name == "a" else -0.2
    return "".join(wheel(f"{name}{x}", f"{x} {y} 0", **turned) for x in (-0.15, 0.15))


def test_forward_must_be_given_where_nothing_decides(tmp_path: Path) -> None:
    text = urdf(across_x("a"), across_x("b"))
    with refusing(SAID, r'forward is ambiguous, .* pass forward="\+y" or "-y"'):
        read(tmp_path, text)
    assert read(tmp_path, text, forward="-y").notes[0] == "forward was given: -y is forward"
    with refusing(SAID, "forward must be normal to the axes of the wheels"):
        read(tmp_path, text, forward="+x")


def test_a_mesh_is_read_as_its_hull_where_its_file_is_there(tmp_path: Path) -> None:
    corners = [(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (0, 1)]
    (tmp_path / "hull.obj").write_text("\n".join(f"v {x} {y} {z}" for x, y, z in corners))
    shape = collision('<mesh filename="hull.obj" scale="0.1 0.1 0.05"/>')
    reading = read(tmp_path, urdf(WHEELS, shapes=shape), mesh="hull")
    assert reading.robot.belly == ((-0.1, 0.0), (0.1, 0.0), (0.1, 0.05), (-0.1, 0.05))


def test_a_mesh_stands_on_the_side_of_its_corners_and_not_of_its_frame(tmp_path: Path) -> None:
    rim = [(math.cos(a / 32 * math.tau), math.sin(a / 32 * math.tau)) for a in range(32)]
    for side, middle in (("left", 0.15), ("right", -0.15)):
        corners = [(0.08 * x, middle + y, 0.08 * z) for x, z in rim for y in (-0.02, 0.02)]
        (tmp_path / f"{side}.obj").write_text("\n".join(f"v {x} {y} {z}" for x, y, z in corners))
    wheels = [
        wheel(f"{side}_{end}", f"{x} 0 0", geometry=f'<mesh filename="{side}.obj"/>', origin="")
        for end, x in (("front", 0.2), ("rear", -0.2))
        for side in ("left", "right")
    ]
    reading = read(tmp_path, urdf(*wheels), mesh="hull")
    assert reading.robot.gauge == pytest.approx(0.3)


def test_a_round_mesh_is_a_wheel(tmp_path: Path) -> None:
    rim = [(math.cos(a / 32 * math.tau), math.sin(a / 32 * math.tau)) for a in range(33)]
    loop = "facet normal 0 0 0\nouter loop\n{}endloop\nendfacet\n"
    facets = "".join(
        loop.format(f"vertex {x} {y} {-z}\nvertex {x} {y} {z}\nvertex {u} {v} {z}\n")
        for (x, y), (u, v) in itertools.pairwise(rim)
        for z in (-0.5, 0.5)
    )
    (tmp_path / "wheel.stl").write_text(f"solid wheel\n{facets}endsolid")
    mesh = '<mesh filename="wheel.stl" scale="0.08 0.08 0.05"/>'
    wheels = pair("front", 0.2, geometry=mesh) + pair("rear", -0.2, geometry=mesh)
    reading = read(tmp_path, urdf(wheels), mesh="hull")
    assert reading.robot.outline.front_radius == pytest.approx(0.08, rel=1e-6)  # float32 corners


@pytest.mark.parametrize(("off", "line"), [(3.3e-5, True), (2e-4, False)])
def test_wheels_rounded_to_four_decimals_stand_in_a_line(
    tmp_path: Path, off: float, line: bool
) -> None:
    places = {"front": 0.31, "middle": 0.31 / 3.0 + off, "next": -0.31 / 3.0, "rear": -0.31}
    reading = read(tmp_path, urdf("".join(pair(name, x) for name, x in places.items())))
    assert isinstance(reading.robot.track, c2d.LineOfWheels) is line
    assert any("evenly spaced within 0.033 mm" in note for note in reading.notes) is line


def test_numbers_of_numpy_are_options_as_others_are() -> None:
    path = c2d.samples.path(c2d.samples.names()[0])
    numbers: Any = {"scale": np.array(1.0), "tolerance": np.float64(0.001), "trusted": np.False_}
    usual = c2d.read_robot(path, scale=1.0, tolerance=0.001)
    assert c2d.read_robot(path, **numbers).how == usual.how


def test_a_reading_survives_a_pickle() -> None:
    again = pickle.loads(pickle.dumps(SDF))
    assert again.robot == SDF.robot
    assert dict(again.sources) == dict(SDF.sources)


def test_a_reading_has_a_description() -> None:
    assert SDF.description.startswith("cart: 3 round wheels in a line; flippers: 2 round wheels")
    assert "left front flipper: x 0.5000 m" in repr(SDF)
    assert "robot.mass" in SDF._repr_html_()


def test_a_mesh_in_mjcf_is_read_as_its_hull(tmp_path: Path) -> None:
    pytest.importorskip("mujoco")
    corners = " ".join(f"{x} {y} {z}" for x in (-0.2, 0.2) for y in (-0.1, 0.1) for z in (0, 0.1))
    mesh = f'<asset><mesh name="hull" vertex="{corners}"/></asset>'
    text = (FILES / "cart.xml").read_text().replace("<worldbody>", f"{mesh}<worldbody>")
    box = '<geom type="box" pos="0 0 0.0625" size="0.25 0.125 0.0625"/>'
    text = text.replace(box, '<geom type="mesh" mesh="hull"/>')
    with refusing(SAID, r"cart\.xml:13: geom.* must not be a mesh"):
        read(tmp_path, text, "cart.xml", mesh="refuse")
    belly = read(tmp_path, text, "cart.xml").robot.belly
    assert belly == ((-0.2, 0.0), (0.2, 0.0), (0.2, 0.1), (-0.2, 0.1))


def test_the_torque_of_a_robot_acts_at_its_rear_end(tmp_path: Path) -> None:
    reading = read(tmp_path, urdf(pair("front", 0.2, radius="0.12") + pair("rear", -0.2)))
    outline, motors = reading.robot.outline, reading.robot.drivetrain
    force = 5.0 / 0.12 + 5.0 / 0.08  # [N] of one side
    assert motors.max_torque / outline.rear_radius == pytest.approx(force)


def test_no_wheel_moves_more_than_its_mass_with_the_track(tmp_path: Path) -> None:
    """Two wheels of 1 kg state the inertia of hoops of 2 kg, two that of hoops of 0.5 kg."""
    front = pair("front", 0.2).replace('iyy="0.003"', f'iyy="{2.0 * 0.08**2}"')
    rear = pair("rear", -0.2).replace('iyy="0.003"', f'iyy="{0.5 * 0.08**2}"')
    reading = read(tmp_path, urdf(front + rear))
    assert reading.robot.track_mass == pytest.approx(2 * 1.0 + 2 * 0.5, rel=1e-12)
    assert reading.sources["robot.track_mass"].startswith("estimate: the mass of the wheels")
    assert "robot.track_mass is limited to hoops" in reading.warnings[0]


@pytest.mark.parametrize(("pairs", "listed", "more"), [(6, 12, []), (7, 12, [2]), (8, 12, [4])])
def test_a_reading_lists_twelve_wheels_and_counts_the_others(
    tmp_path: Path, pairs: int, listed: int, more: list[int]
) -> None:
    places = (0.2 * k for k in range(pairs))
    path = tmp_path / "cart.urdf"
    path.write_text(urdf(*(pair(f"w{k}", x) for k, x in enumerate(places))), encoding="utf-8")
    text = str(quietly(path, forward="+x"))
    assert text.count(" chassis: x ") == listed
    assert [int(each) for each in re.findall(r"and (\d+) more: see \.wheels\n", text)] == more


def test_the_frame_of_a_chassis_is_halfway_between_its_end_axles(tmp_path: Path) -> None:
    path = tmp_path / "cart.urdf"
    path.write_text(urdf(pair("front", 0.4, z=0.06), pair("rear", -0.2, z=0.06)), encoding="utf-8")
    frame = quietly(path).frame
    assert frame.place == pytest.approx([0.1, 0.0, 0.06])
    assert frame.turn == pytest.approx(np.eye(3))
