"""Gravity and ground of a world in the file are not used, and the reading says so."""

from pathlib import Path

import pytest

import crawler2d as c2d
from crawler2d.audits.subject import subject_of, unknown_of_file
from tests.reading.carts import FILES, read

PLANE = "<plane><normal>0 0 1</normal></plane>"
BOX = "<box><size>1 1 1</size></box>"


def standing(name: str, geometry: str, friction: str, static: str = "<static>1</static>") -> str:
    """A model of one shape, which stands still."""
    surface = f"<surface><friction><ode>{friction}</ode></friction></surface>"
    shape = f"<collision name='c'><geometry>{geometry}</geometry>\n{surface}</collision>"
    return f"<model name='{name}'>{static}<link name='l'>{shape}</link></model>"


def in_world(folder: Path, *parts: str, **how: float) -> c2d.Reading:
    """The cart in a world of SDF with other parts, in lines 2 and 3 of the file."""
    text = (FILES / "cart.sdf").read_text(encoding="utf-8")
    model = text[text.index("<model") : text.index("</sdf>")]
    text = f'<sdf version="1.9"><world name="moon">\n{"".join(parts)}{model}</world></sdf>'
    return read(folder, text, "world.sdf", **how)


def in_mujoco(folder: Path, option: str, geoms: str = "") -> c2d.Reading:
    """The cart in MJCF with an option, and with other geoms in place of its ground."""
    text = (FILES / "cart.xml").read_text(encoding="utf-8")
    ground = '<geom type="plane" size="5 5 0.1"/>'
    assert ground in text
    text = text.replace("<worldbody>", f"{option}<worldbody>").replace(ground, geoms)
    return read(folder, text, "world.xml")


def of_ground(reading: c2d.Reading) -> list[str]:
    return [note for note in reading.notes if "the ground in the file" in note]


def of_gravity(reading: c2d.Reading) -> list[str]:
    return [warning for warning in reading.warnings if "gravity" in warning]


@pytest.mark.parametrize(
    ("vector", "count"),
    [
        ("0 0 -1.62", 1),
        ("0 0 -9.81", 0),
        ("0 0 -9.8", 0),
        ("0 0 -9.72", 0),
        ("0 0 -9.70", 1),
        ("1 0 -9.81", 1),
        ("0 0 9.81", 1),
        ("down", 0),
    ],
)
def test_gravity_of_a_world_gets_a_warning_where_it_is_another(
    tmp_path: Path, vector: str, count: int
) -> None:
    found = of_gravity(in_world(tmp_path, f"<gravity>{vector}</gravity>"))
    assert len(found) == count
    assert all(each.startswith("world.sdf:2: sdf/world[moon]/gravity") for each in found)
    assert all(each.endswith(f"got {vector.replace('.70', '.7')}") for each in found)


def test_gravity_of_mujoco_gets_a_warning_where_it_is_another(tmp_path: Path) -> None:
    pytest.importorskip("mujoco")
    (found,) = of_gravity(in_mujoco(tmp_path, '<option gravity="0 0 -1.62"/>'))
    assert "option@gravity is not used" in found
    assert of_gravity(in_mujoco(tmp_path, "<option/>")) == []


def test_a_note_has_the_friction_of_the_ground_in_a_world(tmp_path: Path) -> None:
    plane = standing("floor", PLANE, "<mu>0.15</mu><mu2>0.2</mu2>")
    (note,) = of_ground(in_world(tmp_path, plane))
    assert note.startswith("world.sdf:3: the ground in the file has a friction of 0.15 to 0.2")
    assert "here it has 1; ground_friction=" in note
    assert of_ground(in_world(tmp_path)) == []
    assert of_ground(in_world(tmp_path, standing("floor", PLANE, ""))) == []


def test_no_note_has_a_friction_that_is_used(tmp_path: Path) -> None:
    plane = standing("floor", PLANE, "<mu>0.15</mu>")
    assert of_ground(in_world(tmp_path, plane, ground_friction=0.15)) == []


def test_planes_are_the_ground_before_other_parts_that_stand(tmp_path: Path) -> None:
    wall, loose = standing("wall", BOX, "<mu>0.4</mu>"), standing("x", BOX, "<mu>0.5</mu>", "")
    broken = standing("broken", PLANE, "<mu>-1</mu>")
    plane = standing("floor", PLANE, "<mu>0.15</mu>")
    for parts, friction in (((wall, loose, broken), 0.4), ((wall, plane), 0.15)):
        (note,) = of_ground(in_world(tmp_path, *parts))
        assert f"a friction of {friction}," in note


def test_a_note_has_the_friction_of_the_ground_in_mujoco(tmp_path: Path) -> None:
    pytest.importorskip("mujoco")
    wall = '<geom type="box" size="1 1 1" pos="9 0 0" friction="0.4"/>'
    floor = '<geom type="plane" size="9 9 1" pos="0 0 -1" friction="0.15"/>'
    for geoms, friction in ((wall, 0.4), (wall + floor, 0.15)):
        (note,) = of_ground(in_mujoco(tmp_path, "", geoms))
        assert f"a friction of {friction}," in note
    assert of_ground(in_mujoco(tmp_path, "")) == []


def test_an_audit_says_whether_the_file_states_the_floor(tmp_path: Path) -> None:
    plane = standing("floor", PLANE, "<mu>0.15</mu>")
    for parts, told in (((plane,), "0.15 in the file"), ((), "which the file does not state")):
        subject = subject_of(in_world(tmp_path, *parts), {})
        assert subject.reading is not None
        found = unknown_of_file(subject.reading, subject.floors)
        source = found.sources["terrain.friction"]
        assert source.startswith(f"that of the floor, {told}, is taken as 0.5 to 1; gz combines")


def test_a_robot_of_urdf_that_gazebo_keeps_in_place_gets_a_warning(tmp_path: Path) -> None:
    text = (FILES / "cart.urdf").read_text(encoding="utf-8")
    for static, count in (("true", 1), ("false", 0)):
        block = f"<gazebo><static>{static}</static></gazebo></robot>"
        found = read(tmp_path, text.replace("</robot>", block)).warnings
        assert len([each for each in found if "it fixes the robot to the world" in each]) == count


def test_friction_of_pairs_and_overrides_of_mujoco_gets_a_warning(tmp_path: Path) -> None:
    pytest.importorskip("mujoco")
    option = '<option o_friction="0.1 0.1 0 0 0"><flag override="enable"/></option>'
    pair = '<contact><pair geom1="a" geom2="b" friction="0.1"/></contact>'
    geoms = '<geom name="a" size="1"/><geom name="b" size="1"/>'
    found = in_mujoco(tmp_path, f"{option}{pair}", geoms).warnings
    assert [each for each in found if "contact/pair is not used: here surfaces" in each]
    assert [each for each in found if "option/flag@override is not used: here surf" in each]


def test_what_a_flag_of_mujoco_disables_gets_a_warning(tmp_path: Path) -> None:
    pytest.importorskip("mujoco")
    flags = '<option><flag gravity="disable" actuation="enable" warmstart="disable"/></option>'
    (found,) = of_gravity(in_mujoco(tmp_path, flags))
    assert "option/flag@gravity is not used: here it is enabled, got disable" in found


@pytest.mark.parametrize(
    ("name", "before", "off", "on"),
    [
        ("cart.sdf", '<link name="hull">', "<gravity>0</gravity>", "<gravity>1</gravity>"),
        (
            "cart.urdf",
            '<robot name="cart">',
            "<gazebo><turnGravityOff>true</turnGravityOff></gazebo>",
            "<gazebo><turnGravityOff>false</turnGravityOff></gazebo>",
        ),
        (
            "cart.urdf",
            '<robot name="cart">',
            '<gazebo reference="hull"><gravity>false</gravity></gazebo>',
            '<gazebo reference="hull"><gravity>true</gravity></gazebo>',
        ),
        ("cart.xml", "<body", ' gravcomp="1"', ' gravcomp="0.0"'),
    ],
)
def test_a_link_without_gravity_gets_a_warning(
    tmp_path: Path, name: str, before: str, off: str, on: str
) -> None:
    if name == "cart.xml":
        pytest.importorskip("mujoco")
    text = (FILES / name).read_text(encoding="utf-8")
    assert before in text
    (found,) = of_gravity(read(tmp_path, text.replace(before, before + off, 1), name))
    assert found.endswith("is not used: here every link has its weight, got 1 without gravity")
    assert of_gravity(read(tmp_path, text.replace(before, before + on, 1), name)) == []


@pytest.mark.parametrize(
    ("name", "before", "block"),
    [
        ("cart.sdf", '<link name="hull">', "<kinematic>{}</kinematic>"),
        (
            "cart.urdf",
            '<robot name="cart">',
            '<gazebo reference="hull"><kinematic>{}</kinematic></gazebo>',
        ),
    ],
)
def test_a_link_that_no_force_moves_gets_a_warning(
    tmp_path: Path, name: str, before: str, block: str
) -> None:
    text = (FILES / name).read_text(encoding="utf-8")
    for value, count in (("true", 1), ("0", 0)):
        reading = read(tmp_path, text.replace(before, before + block.format(value), 1), name)
        found = [each for each in reading.warnings if "kinematic is not used" in each]
        assert len(found) == count
        assert all(each.endswith("got 1 that no force moves") for each in found)


@pytest.mark.parametrize(
    ("shape", "contact", "is_belly"),
    [
        ("", "", True),
        (' contype="2" conaffinity="2"', "", False),
        (' contype="2" conaffinity="1"', "", True),
        ("", '<exclude body1="world" body2="hull"/>', False),
        ("", '<exclude body1="hull" body2="left_rear"/>', True),
    ],
)
def test_a_geom_of_mujoco_that_passes_through_the_ground_is_no_belly(
    tmp_path: Path, shape: str, contact: str, is_belly: bool
) -> None:
    pytest.importorskip("mujoco")
    text = (FILES / "cart.xml").read_text(encoding="utf-8")
    box = '<geom type="box"'
    assert text.count(box) == 1
    text = text.replace(box, box + shape)
    text = text.replace("<actuator>", f"<contact>{contact}</contact><actuator>")
    assert (read(tmp_path, text, "cart.xml").robot.belly is not None) == is_belly


def test_bits_of_mujoco_count_only_beside_a_ground(tmp_path: Path) -> None:
    pytest.importorskip("mujoco")
    text = (FILES / "cart.xml").read_text(encoding="utf-8")
    alone = text.replace('<geom type="plane" size="5 5 0.1"/>', "")
    assert alone != text
    bits = '<geom friction="0.75" contype="4" conaffinity="8"/>'
    masked = alone.replace('<geom friction="0.75"/>', bits)
    assert read(tmp_path, masked, "cart.xml").robot == read(tmp_path, alone, "cart.xml").robot


def test_a_margin_of_geoms_of_mujoco_gets_a_warning_where_it_is_wide(tmp_path: Path) -> None:
    pytest.importorskip("mujoco")
    text = (FILES / "cart.xml").read_text(encoding="utf-8")
    for margin, count in (("0.02", 1), ("0.001", 0)):
        wide = text.replace('<geom friction="0.75"', f'<geom friction="0.75" margin="{margin}"')
        warnings = read(tmp_path, wide, "cart.xml").warnings
        found = [each for each in warnings if "they stand off the ground by as much" in each]
        assert len(found) == count
