"""Numbers of a file that change with its wheels, their factors, and what cannot be changed."""

import re
from collections import defaultdict
from dataclasses import replace
from pathlib import Path
from xml.etree import ElementTree

import pytest

import crawler2d as c2d
from crawler2d.patching.patch import _check, patch_file
from tests.kept import refusing
from tests.patching.test_patch import SAID, on_chassis
from tests.reading.carts import ACROSS, FILES, ROUND, WHEELS, link, pair, quietly, urdf

CART = {
    name: (FILES / f"cart.{name}").read_text(encoding="utf-8") for name in ("urdf", "sdf", "xml")
}


def read(folder: Path, text: str, suffix: str) -> c2d.Reading:
    path = folder / f"cart.{suffix}"
    path.write_text(text, encoding="utf-8")
    return quietly(path)


def paths(text: str) -> list[tuple[str, str, str]]:
    """Every attribute and text of a file, in its order: element, path and value."""
    found = list[tuple[str, str]]()

    def walk(element: ElementTree.Element, path: str) -> None:
        path = f"{path}/{element.tag}"
        found.extend((f"{path}@{name}", value) for name, value in element.attrib.items())
        found.append((path, (element.text or "").strip()))
        found.append((f"{path}~", (element.tail or "").strip()))
        for child in element:
            walk(child, path)

    walk(ElementTree.fromstring(text), "")
    return [(path.rpartition("/")[2], path, value) for path, value in found]


def factors(old: str, new: str) -> dict[str, set[tuple[float, ...]]]:
    """Factors of the numbers of a file, for each element or attribute that differs."""
    changed: dict[str, set[tuple[float, ...]]] = defaultdict(set)
    before, after = paths(old), paths(new)
    assert [each[1] for each in before] == [each[1] for each in after]
    for (name, _, was), (_, _, now) in zip(before, after, strict=True):
        if was != now:
            numbers = [[float(word) for word in value.split()] for value in (was, now)]
            pairs = zip(*numbers, strict=True)
            changed[name].add(tuple(round(b / a, 9) if a else b for a, b in pairs))
    return dict(changed)


def resized(reading: c2d.Reading, radius: float) -> str:
    return patch_file(reading, on_chassis(reading, 3, radius)).text


SIZE, SQUARE = 0.8, 0.64  # of a radius of 0.1 m in place of 0.125 m
"""Mass stays; at the same force and speed torques are in proportion, angular speeds the inverse."""


SMALLER: dict[str, dict[str, set[tuple[float, ...]]]] = {
    "urdf": {
        "cylinder@radius": {(SIZE,)},
        "limit@effort": {(SIZE,)},
        "limit@velocity": {(1.0 / SIZE,)},
        **{f"inertia@{name}": {(SQUARE,)} for name in ("ixx", "iyy", "izz")},
        **{f"inertia@{name}": {(0.0,)} for name in ("ixy", "ixz", "iyz")},
    },
    "sdf": {
        "radius": {(SIZE,)},
        "effort": {(SIZE,)},
        "velocity": {(1.0 / SIZE,)},
        **{name: {(SQUARE,)} for name in ("ixx", "iyy", "izz")},
    },
    "xml": {
        "geom@size": {(SIZE, 1.0)},
        "inertial@diaginertia": {(SQUARE,) * 3},
        "velocity@kv": {(SQUARE,)},
        "velocity@forcerange": {(SIZE,) * 2},
        "velocity@ctrlrange": {(1.0 / SIZE,) * 2},
    },
}


@pytest.mark.parametrize("suffix", CART)
def test_smaller_wheels_scale_with_their_radius(suffix: str, tmp_path: Path) -> None:
    reading = read(tmp_path, CART[suffix], suffix)
    assert factors(reading.text, resized(reading, 0.1)) == SMALLER[suffix]


SHARE = 0.75
"""[kg] Of each of three wheels on a side that become four; those of the flippers stay."""

TORQUE = 5.0 * 6.0 / 7.0
"""[N m] Of each wheel of a side: that at the tip of a flipper counts twice, and one is new."""


@pytest.mark.parametrize("suffix", CART)
def test_wheels_and_their_copies_share_mass_and_torque(suffix: str, tmp_path: Path) -> None:
    reading = read(tmp_path, CART[suffix], suffix)
    text = patch_file(reading, on_chassis(reading, 4)).text
    count = {"urdf": "limit@effort", "sdf": "effort", "xml": "velocity@forcerange"}[suffix]
    mass = {"urdf": "mass@value", "sdf": "mass", "xml": "inertial@mass"}[suffix]
    found = defaultdict[str, list[str]](list)
    for name, _, value in paths(text):
        found[name].append(value)
    assert found[mass].count(str(SHARE)) == 8
    limits = [float(each.split()[-1]) for each in found[count]]
    assert sum(abs(each - TORQUE) < 1e-6 for each in limits) == 8 + 4


def names(text: str) -> set[str]:
    return set(re.findall(r'name="(\w+_added\w*)"', text))


def test_copies_of_one_wheel_have_names_of_their_own(tmp_path: Path) -> None:
    reading = read(tmp_path, urdf(WHEELS), "urdf")
    found = names(patch_file(reading, on_chassis(reading, 5)).text)
    assert {name for name in found if name.startswith("left_front") and "joint" not in name} == {
        "left_front_added"
    }
    assert {name for name in found if name.startswith("left_rear") and "joint" not in name} == {
        "left_rear_added",
        "left_rear_added_2",
    }


def test_a_wheel_without_an_origin_gets_one(tmp_path: Path) -> None:
    held = "".join(
        f"""<link name="{side}_holder"/><joint name="{side}_arm" type="fixed"><parent link="hull"/>
        <child link="{side}_holder"/><origin xyz="0.02 {y} 0"/></joint>"""
        for side, y in (("left", 0.15), ("right", -0.15))
    )
    middle = pair("middle", 0.0)
    for side in ("left", "right"):
        middle = re.sub(
            rf'<parent link="hull"/>(<child link="{side}_middle"/>)\s*<origin [^>]*/>',
            rf'<parent link="{side}_holder"/>\1',
            middle,
        )
    assert middle.count("<origin xyz") == 0
    reading = read(tmp_path, urdf(WHEELS, held, middle), "urdf")
    text = patch_file(reading, on_chassis(reading, 3)).text
    assert text.count('<origin xyz="-0.02 0 0"/>') == 2
    assert factors(reading.text, text.replace('<origin xyz="-0.02 0 0"/>', "")) == {}
    assert patch_file(reading, on_chassis(reading, 3)).summary.startswith("wheels: 2 changed; ")


DRIVERS = ("wheel_radius", "wheelRadius", "wheel_diameter", "wheelDiameter")


@pytest.mark.parametrize("setting", DRIVERS)
def test_each_name_of_a_size_in_a_plugin_is_known(setting: str, tmp_path: Path) -> None:
    plugin = f"""<gazebo><plugin name="d" filename="d.so"><left_joint>left_front_joint</left_joint>
<{setting}>0.08</{setting}></plugin></gazebo>"""
    reading = read(tmp_path, urdf(WHEELS, plugin), "urdf")
    text = patch_file(reading, on_chassis(reading, 2, 0.1)).text
    assert f"<{setting}>0.1</{setting}>" in text


UNLIKE = {
    "some that stay": ((-0.2, 0.0, 0.08), (0.0, 0.0, 0.06), (0.2, 0.0, 0.08)),
    "one that is new": ((-0.2, 0.0, 0.08), (0.0, 0.0, 0.08), (0.1, -0.02, 0.06), (0.2, 0.0, 0.08)),
    "two new sizes": ((-0.2, 0.0, 0.07), (0.0, 0.0, 0.06), (0.2, 0.0, 0.07)),
}


@pytest.mark.parametrize("placements", UNLIKE.values(), ids=UNLIKE)
def test_a_size_in_a_plugin_stays_where_its_wheels_become_unlike(
    placements: tuple[tuple[float, float, float], ...], tmp_path: Path
) -> None:
    joints = "".join(
        f"<joint>{side}_{name}_joint</joint>"
        for side in ("left", "right")
        for name in ("rear", "middle", "front")
    )
    plugin = f"""<gazebo><plugin name="d" filename="d.so">{joints}
<wheel_radius>0.08</wheel_radius></plugin></gazebo>"""
    reading = read(tmp_path, urdf(WHEELS, pair("middle", 0.0), plugin, mass="80"), "urdf")
    assert reading.robot.track == c2d.LineOfWheels(3)
    patch = patch_file(reading, reading.robot.with_track(c2d.HybridWheels(placements)))
    assert "<wheel_radius>0.08</wheel_radius>" in patch.text
    line = 1 + reading.text[: reading.text.index("<wheel_radius>")].count("\n")
    left = f"wheel_radius in line {line} is still 0.08, for wheels of several sizes"
    assert patch.left == (left,)
    hint = " (there are 2 wheels more)" if len(placements) == 4 else ""
    assert patch.summary.endswith(f"; to be set by hand{hint}: {left}")


@pytest.mark.parametrize("setting", ["num_wheel_pairs", "wheel_torque", "max_wheel_torque"])
def test_each_setting_that_counts_wheels_is_listed_for_manual_change(
    setting: str, tmp_path: Path
) -> None:
    blank = 200 * "\n"  # a line is found from the lengths of all before it
    plugin = f"""{blank}<gazebo><plugin name="d" filename="d.so">
<{setting}>4</{setting}></plugin></gazebo>"""
    reading = read(tmp_path, urdf(WHEELS, plugin), "urdf")
    patch = patch_file(reading, on_chassis(reading, 3))
    line = 1 + reading.text[: reading.text.index(f"<{setting}>")].count("\n")
    assert patch.left == (f"{setting} in line {line} is still 4",)
    assert patch.summary.endswith(f"(there are 2 wheels more): {setting} in line {line} is still 4")
    fewer = replace(reading.robot, track=c2d.LineOfWheels(2, wheel_radius=0.1))
    assert patch_file(reading, fewer).left == ()


@pytest.mark.parametrize("count", [2, 4])
@pytest.mark.parametrize("names", ["{0}, left_rear_joint", "[{0}]", "'left_rear_joint' '{0}'"])
def test_a_plugin_list_of_added_or_removed_wheels_is_listed_for_manual_change(
    names: str, count: int, tmp_path: Path
) -> None:
    """As that of libgazebo_ros_joint_state_publisher."""
    listed, blank = names.format("left_middle_joint"), "\n  "
    plugin = f"""<gazebo><plugin name="p" filename="p.so"><rate>left_middle_joints</rate>
<jointName>{listed.replace(" ", blank)}</jointName><one>left_middle_joint</one></plugin></gazebo>"""
    reading = read(tmp_path, urdf(WHEELS, pair("middle", 0.0), plugin), "urdf")
    patch = patch_file(reading, on_chassis(reading, count))
    line = 1 + reading.text[: reading.text.index("<jointName>")].count("\n")
    left = (
        f"jointName in line {line} is still {listed}, a list with wheels that are added or removed"
    )
    assert patch.left == (left,)
    assert patch_file(reading, on_chassis(reading, 3, 0.1)).left == ()


def test_a_summary_counts_wheels_and_lines(tmp_path: Path) -> None:
    reading = read(tmp_path, CART["urdf"], "urdf")
    patch = patch_file(reading, on_chassis(reading, 2))
    lines = [line for line in patch.diff.splitlines()[2:] if line[0] in "+-"]
    new, gone = (sum(line[0] == mark for line in lines) for mark in "+-")
    assert patch.summary == f"wheels: 2 removed, 8 changed; lines: {new} new, {gone} gone"


KEY = '<keyframe><key name="home" qpos="{qpos}"/></keyframe></mujoco>'


def with_key(folder: Path) -> c2d.Reading:
    """The cart with a keyframe, whose numbers count all joints."""
    qpos = " ".join(["0"] * 19)
    return read(folder, CART["xml"].replace("</mujoco>", KEY.format(qpos=qpos)), "xml")


def test_an_error_of_the_new_file_is_not_one_of_the_old(tmp_path: Path) -> None:
    pytest.importorskip("mujoco")
    reading = with_key(tmp_path)
    with refusing(SAID, "keyframe 'home': invalid qpos size") as caught:
        patch_file(reading, on_chassis(reading, 2))
    assert caught.value.path == "the changed file, read again: cart.xml"


def test_a_keyframe_is_listed_for_manual_change_where_wheels_are_added(tmp_path: Path) -> None:
    """MuJoCo reads it unchanged: all joints after the new one would get the numbers of others."""
    pytest.importorskip("mujoco")
    reading = with_key(tmp_path)
    line = 1 + reading.text[: reading.text.index("<key ")].count("\n")
    left = f"key in line {line} still has numbers for the joints of before"
    assert patch_file(reading, on_chassis(reading, 4)).left == (left,)
    assert patch_file(reading, on_chassis(reading, 3, 0.1)).left == ()


def test_the_new_file_is_compared_with_the_robot(tmp_path: Path) -> None:
    reading = read(tmp_path, CART["urdf"], "urdf")
    count = len(reading.robot.wheels())
    for robot, rule in (
        (on_chassis(reading, 4), f"wheels must have {count + 2}, got {count} wheels"),
        (on_chassis(reading, 3, 0.1), r"radius of wheel \d must be 0\.1 m, got 0\.125"),
        (replace(reading.robot, mass=24.1), r"mass must be 24\.1 kg, got 24"),
        (
            replace(reading.robot, center_of_mass=(0.02, reading.robot.center_of_mass[1])),
            "center_of_mass must not move by more than 1% of the axle distance",
        ),
    ):
        with refusing(SAID, f"^the changed file, read again: {rule}"):
            _check(reading, robot, reading.text)
    _check(reading, reading.robot, reading.text)


def moved(text: str, suffix: str, tmp_path: Path) -> tuple[str, str]:
    """A file whose middle wheels are not in the middle, before and after they are moved there."""
    reading = read(tmp_path, text, suffix)
    return reading.text, patch_file(reading, on_chassis(reading, 3)).text


FRAMES = {
    # What the pose of the left middle wheel is in the file, and must become: it moves by -0.02.
    "model": ("<pose>0.02 0.25 0 0 0 0</pose>", "<pose>0 0.25 0 0 0 0</pose>"),
    "link": (
        '<pose relative_to="hull">0.02 0.25 0 0 0 0</pose>',
        '<pose relative_to="hull">0 0.25 0 0 0 0</pose>',
    ),
    "turned": (
        '<pose relative_to="mast">0 0.25 0.02 0 -1.5707963267948966 0</pose>',
        '<pose relative_to="mast">0 0.25 0 0 -1.5707963267948966 0</pose>',
    ),
}
MAST = """<link name="mast"><pose>0 0 0 0 1.5707963267948966 0</pose><inertial><mass>0.1</mass>
</inertial></link><joint name="mast_joint" type="fixed"><parent>hull</parent><child>mast</child>
</joint></model>"""


def off_middle(text: str, pose: str) -> str:
    """The SDF with its middle wheels ahead of the middle, the left one placed by this element."""
    text = text.replace("</model>", MAST)
    text = text.replace("<pose>0.0 0.25 0 0 0 0</pose>", pose)
    return text.replace("<pose>0.0 -0.25 0 0 0 0</pose>", "<pose>0.02 -0.25 0 0 0 0</pose>")


@pytest.mark.parametrize("frame", FRAMES)
def test_a_wheel_moves_in_the_frame_in_which_it_is_placed(frame: str, tmp_path: Path) -> None:
    old, new = FRAMES[frame]
    before, after = moved(off_middle(CART["sdf"], old), "sdf", tmp_path)
    right = ("<pose>0.02 -0.25 0 0 0 0</pose>", "<pose>0 -0.25 0 0 0 0</pose>")
    assert after == before.replace(old, new).replace(*right)


@pytest.mark.parametrize(
    ("was", "now"),
    [("", "<pose>0.02 0 0 0 0 0</pose>"), ("<pose></pose>", "<pose>0.02 0 0 0 0 0</pose>")],
    ids=["none", "empty"],
)
def test_a_wheel_without_a_pose_gets_one(was: str, now: str, tmp_path: Path) -> None:
    text = re.sub(r"<pose>0.25 (-?0.25 0 0 0 0)</pose>", r"<pose>0.29 \1</pose>", CART["sdf"])
    for y in ("0.25", "-0.25"):
        at = text.index(f"<pose>0.0 {y} 0 0 0 0</pose>")
        text = text[:at] + text[at:].replace(f"<pose>0.0 {y} 0 0 0 0</pose>", was, 1)
        text = text[:at] + text[at:].replace('"true">0 0 0 90', f'"true">0 {y} 0 90', 1)
    text = text.replace("<pose>0.25 0.375", "<pose>0.29 0.375")
    text = text.replace("<pose>0.25 -0.375", "<pose>0.29 -0.375")
    before, after = moved(text, "sdf", tmp_path)
    assert after.count(now) == 2
    left = after.replace(now, was)
    assert re.sub(r"\s", "", left) == re.sub(r"\s", "", before)


def test_a_joint_that_is_placed_in_another_frame_moves_with_its_wheel(tmp_path: Path) -> None:
    text = off_middle(CART["sdf"], FRAMES["model"][0]).replace(
        '<joint name="left_middle_joint" type="continuous">',
        '<joint name="left_middle_joint" type="continuous">'
        '<pose relative_to="hull">0.02 0.25 0 0 0 0</pose>',
    )
    _, after = moved(text, "sdf", tmp_path)
    assert '<pose relative_to="hull">0 0.25 0 0 0 0</pose>' in after


def test_a_wheel_placed_in_a_frame_that_is_no_link_is_refused(tmp_path: Path) -> None:
    text = off_middle(CART["sdf"], '<pose relative_to="side">0.02 0 0 0 0 0</pose>')
    text = text.replace(
        "</model>", '<frame name="side"><pose>0 0.25 0 0 0 0</pose></frame></model>'
    )
    with refusing(SAID) as caught:
        moved(text, "sdf", tmp_path)
    assert caught.value.path == "link[left_middle]"
    assert caught.value.rule == "must be placed in the frame of a link or of the model"
    assert caught.value.value == "side"


def test_wheels_of_a_nested_model_are_refused(tmp_path: Path) -> None:
    """Their names in the file differ from those of the model that was read."""
    outer = '<sdf version="1.9"><model name="outer"><link name="top"/><joint name="j" type="fixed">'
    outer += "<parent>top</parent><child>cart</child></joint>"
    inner = CART["sdf"].partition('<sdf version="1.9">')[2].replace("</sdf>", "</model></sdf>")
    reading = read(tmp_path, outer + inner, "sdf")
    assert len(reading.wheels) == 10
    for track in (c2d.LineOfWheels(4), c2d.LineOfWheels(2), c2d.LineOfWheels(3, wheel_radius=0.1)):
        with refusing(SAID, "must be in the model itself") as caught:
            patch_file(reading, reading.robot.with_track(track))
        assert caught.value.value == "a nested model"


@pytest.mark.parametrize("none", ["-1", "inf"])
def test_a_limit_that_is_none_stays_none(none: str, tmp_path: Path) -> None:
    text = CART["sdf"].replace("<velocity>10</velocity>", f"<velocity>{none}</velocity>")
    reading = read(tmp_path, text, "sdf")
    found = factors(reading.text.replace(none, "9"), resized(reading, 0.1).replace(none, "9"))
    assert "velocity" not in found
    assert found["effort"] == {(SIZE,)}


def without_a_mass(folder: Path) -> c2d.Reading:
    """A cart with a wheel of the usual mass of SDF, 1 kg, like the others."""
    text = re.sub(
        r'(<link name="left_middle">\s*<pose>[^<]*</pose>\s*<inertial>)<mass>1</mass>',
        r"\1",
        CART["sdf"],
    )
    assert text != CART["sdf"]
    return read(folder, text, "sdf")


def test_wheels_that_keep_their_mass_need_not_state_it(tmp_path: Path) -> None:
    assert "<radius>0.1</radius>" in resized(without_a_mass(tmp_path), 0.1)


def test_wheels_without_a_mass_cannot_share_it(tmp_path: Path) -> None:
    reading = without_a_mass(tmp_path)
    with refusing(SAID) as caught:
        patch_file(reading, on_chassis(reading, 4))
    assert caught.value.path == "link[left_middle]"
    assert caught.value.rule == "must state its mass, for wheels to share it"


GEAR_COUNT = 12
GEAR = c2d.GearWheel(grouser_count=GEAR_COUNT, grouser_height=0.02, tip_thickness=0.008)


def with_gears(reading: c2d.Reading, gear: c2d.GearWheel) -> c2d.Robot:
    return reading.robot.with_track(c2d.LineOfWheels(4, wheel=gear))


def test_gear_wheels_replace_round_ones_alone(tmp_path: Path) -> None:
    reading = read(tmp_path, urdf(WHEELS), "urdf")
    gears = patch_file(reading, with_gears(reading, GEAR)).text
    again = read(tmp_path, gears, "urdf")
    with refusing(SAID, "chassis must be round in the file, got gear"):
        patch_file(again, with_gears(again, replace(GEAR, grouser_count=10)))


def test_gear_wheels_of_a_file_do_not_stay_where_round_ones_are_asked_for(tmp_path: Path) -> None:
    reading = read(tmp_path, urdf(WHEELS), "urdf")
    again = read(tmp_path, patch_file(reading, with_gears(reading, GEAR)).text, "urdf")
    for count in (4, 5):
        with refusing(SAID, "chassis must be round in the file, got gear"):
            patch_file(again, on_chassis(again, count))


def test_grousers_are_as_wide_as_the_tread_and_on_it(tmp_path: Path) -> None:
    tread = ROUND.format(radius="0.08")
    hub = tread.replace("0.08", "0.03").replace("0.05", "0.2")
    place = '<origin xyz="0 0.01 0" rpy="1.5707963267948966 0 0"/>'
    shapes = f"{tread}</geometry></collision><collision>{ACROSS}<geometry>{hub}"
    wheels = pair("front", 0.2, origin=place, geometry=shapes)
    wheels += pair("rear", -0.2, origin=place, geometry=shapes)
    reading = read(tmp_path, urdf(wheels), "urdf")
    root = ElementTree.fromstring(patch_file(reading, with_gears(reading, GEAR)).text)
    boxes = [each for each in root.iter("collision") if each.find("geometry/box") is not None]
    assert len(boxes) == 8 * GEAR_COUNT
    for each in boxes:
        size, at = each.find("geometry/box"), each.find("origin")
        assert size is not None
        assert at is not None
        assert float(size.attrib["size"].split()[1]) == pytest.approx(0.05)
        assert float(at.attrib["xyz"].split()[1]) == pytest.approx(0.01)


def test_copies_of_a_part_on_a_wheel_have_joints_of_their_own(tmp_path: Path) -> None:
    hubs = "".join(
        link(f"{side}_{end}_hub", 'type="fixed">', parent=f"{side}_{end}")
        for side in ("left", "right")
        for end in ("front", "rear")
    )
    reading = read(tmp_path, urdf(WHEELS, hubs), "urdf")
    root = ElementTree.fromstring(patch_file(reading, on_chassis(reading, 3)).text)
    for tag in ("link", "joint"):
        found = [each.get("name") for each in root.iter(tag)]
        assert len(found) == len(set(found)) == (13 if tag == "link" else 12)
    assert {"left_rear_hub_joint", "left_rear_hub_joint_added"} <= set(found)


def test_wheels_that_are_spheres_change_their_radius(tmp_path: Path) -> None:
    ball = '<sphere radius="0.08"/>'
    wheels = pair("front", 0.2, geometry=ball) + pair("rear", -0.2, geometry=ball)
    reading = read(tmp_path, urdf(wheels), "urdf")
    text = patch_file(reading, on_chassis(reading, 2, 0.1)).text
    assert text.count('<sphere radius="0.1"/>') == 4


def test_grousers_that_taper_are_no_boxes(tmp_path: Path) -> None:
    reading = read(tmp_path, urdf(WHEELS), "urdf")
    with refusing(SAID) as caught:
        patch_file(reading, with_gears(reading, replace(GEAR, base_thickness=0.012)))
    assert caught.value.path == "robot.track.wheel.base_thickness"
    assert caught.value.rule == "must be as thick as the tip: grousers are added as boxes"


def test_tracks_that_are_no_wheels_are_refused_of_the_file_or_the_robot(tmp_path: Path) -> None:
    reading = read(tmp_path, CART["urdf"], "urdf")
    belted = replace(
        reading.robot,
        track=c2d.BeltTrack(),
        drivetrain=replace(reading.robot.drivetrain, torque_sharing="track"),
    )
    rule = "must be wheels, to be replaced by others, got belt: those of the"
    with refusing(SAID, f"^tracks of the chassis {rule} robot are not"):
        patch_file(reading, belted)
    with refusing(SAID, f"^tracks of the chassis {rule} file are not"):
        patch_file(replace(reading, robot=belted), reading.robot)
