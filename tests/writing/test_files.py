"""Contents of model files, and refusals of fields that files cannot represent."""

import dataclasses
import json
import re
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import pytest

import crawler2d as c2d
from crawler2d.parameters.fields import to_dict
from tests.fuzz.drawn_robots import Draw, drawn_robot
from tests.shared import refused, with_flippers

WHEELS = c2d.robots.engineer(flippers=None, track=c2d.LineOfWheels(4))
BELT = c2d.robots.engineer(flippers=None)
FORMATS = ("sdf", "urdf", "mjcf")
GEARS = c2d.LineOfWheels(3, wheel=c2d.GearWheel())
TAPERED = c2d.LineOfWheels(3, wheel=c2d.GearWheel(tip_thickness=0.006, base_thickness=0.012))


def write(robot: c2d.Robot, name: str, *given: Any, **how: Any) -> str:
    text: str = getattr(robot, f"to_{name}")(*given, **how)
    return text


def robot_in(text: str) -> Any:
    found = re.search(r"The robot: (\{.*\})", text)
    assert found is not None
    return json.loads(found[1])


@pytest.mark.parametrize("name", FORMATS)
def test_the_robot_itself_is_in_a_comment(name: str) -> None:
    text = write(WHEELS, name)
    assert robot_in(text) == to_dict(WHEELS)
    assert f"Written by crawler2d {c2d.__version__}." in text


@pytest.mark.parametrize("name", FORMATS)
def test_any_name_may_stand_in_the_comment(name: str) -> None:
    odd = dataclasses.replace(WHEELS, name='a--b---> <c> & \u00e4 \U0001f916 "quoted" -')
    text = write(odd, name)
    comment = text[text.index("<!--") + 4 : text.index("-->")]
    assert "--" not in comment
    assert comment.isascii()
    assert robot_in(text)["name"] == odd.name
    root = ElementTree.fromstring(text.encode())
    named = root if name == "urdf" else root.find("model") if name == "sdf" else root
    assert named is not None
    assert named.get("model" if name == "mjcf" else "name") == odd.name


@pytest.mark.parametrize("name", FORMATS)
def test_a_name_that_xml_cannot_hold_is_refused(name: str) -> None:
    odd = dataclasses.replace(WHEELS, name="a\x07b")
    error = refused(lambda: write(odd, name))
    assert (error.path, error.value) == ("robot.name", "a\x07b")


@pytest.mark.parametrize("name", ["a::b", "__a__", "world"])
def test_a_name_that_sdf_reserves_is_refused_there_alone(name: str) -> None:
    odd = dataclasses.replace(WHEELS, name=name)
    assert refused(odd.to_sdf).path == "robot.name"
    assert f'name="{name}"' in odd.to_urdf()
    for other in ("a__b", "world_", "worlds"):
        assert f'name="{other}"' in dataclasses.replace(WHEELS, name=other).to_sdf()


def test_a_reserved_name_does_not_stand_in_the_middle_of_its_rule() -> None:
    odd = dataclasses.replace(WHEELS, name="a::b")
    assert str(refused(odd.to_sdf)) == (
        "robot.name must not be a name that SDF reserves (world, with :: in it, or between"
        " pairs of _), got a::b"
    )


@pytest.mark.parametrize("name", FORMATS)
def test_the_text_is_also_written_to_a_path(name: str, tmp_path: Path) -> None:
    path = tmp_path / "robot"
    text = write(WHEELS, name, path)
    assert path.read_text("utf-8") == text == write(WHEELS, name, str(path))


@pytest.mark.parametrize("name", FORMATS)
@pytest.mark.parametrize(
    ("track", "word"),
    [
        (c2d.SegmentalTrack(), "chain is a closed loop"),
        (c2d.SegmentalTrack(mechanism="sprocket"), "chain is a closed loop"),
        (c2d.GrouserBeltTrack(), "grousers that travel"),
        (c2d.ClosedTrack(GEARS), "grousers that travel"),
        (c2d.ForceTrack(), "motor that pushes"),
        (c2d.ForceTrack(support="wheels"), "motor that pushes"),
    ],
)
def test_a_track_that_no_file_holds_is_refused(name: str, track: Any, word: str) -> None:
    error = refused(lambda: write(WHEELS.with_track(track), name))
    assert (error.path, error.value) == ("robot.track.kind", track.kind)
    assert word in error.rule


def test_urdf_refuses_belts() -> None:
    error = refused(BELT.to_urdf)
    assert (error.path, error.value) == ("robot.track.kind", "belt")
    assert "no surface that moves" in error.rule
    error = refused(with_flippers(c2d.LineOfWheels(3), c2d.BeltTrack()).to_urdf)
    assert error.path == "robot.flippers.track.kind"


@pytest.mark.parametrize("name", ["sdf", "urdf"])
def test_grousers_that_taper_are_refused_where_there_are_no_hulls(name: str) -> None:
    error = refused(lambda: write(WHEELS.with_track(TAPERED), name))
    assert (error.path, error.value) == ("robot.track.wheel.base_thickness", 0.012)
    error = refused(lambda: write(with_flippers(c2d.LineOfWheels(3), TAPERED), name))
    assert error.path == "robot.flippers.track.wheel.base_thickness"
    assert WHEELS.with_track(TAPERED).to_mjcf().count("<mesh ") == 6 * _grousers(TAPERED)


def _grousers(track: Any) -> int:
    text = WHEELS.with_track(track).to_mjcf()
    return len(re.findall(r'<mesh name="left_wheel_0_', text))


@pytest.mark.filterwarnings("ignore::crawler2d.ScenarioWarning")
@pytest.mark.parametrize("name", FORMATS)
def test_masses_that_leave_no_chassis_are_refused(name: str) -> None:
    far = c2d.HybridWheels(((-0.9, 0.0, 0.064), (0.9, 0.0, 0.064)))
    error = refused(lambda: write(WHEELS.with_track(far), name))
    assert error.path == "robot.moment_of_inertia"


@pytest.mark.parametrize("name", FORMATS)
def test_flippers_of_more_wheel_than_rod_are_refused(name: str) -> None:
    built = with_flippers(c2d.LineOfWheels(3)).flippers
    assert built is not None
    short = dataclasses.replace(built, length=0.06, mass=2.0)
    robot = dataclasses.replace(WHEELS, flippers=short)
    assert refused(lambda: write(robot, name)).path == "robot.flippers.length"


@pytest.mark.parametrize("name", FORMATS)
@pytest.mark.parametrize(
    ("given", "path"),
    [
        ({"friction": -0.1}, "friction"),
        ({"friction": float("nan")}, "friction"),
        ({"friction": "0.5"}, "friction"),
        ({"track_width": 0.0}, "track_width"),
        ({"track_width": WHEELS.gauge}, "track_width"),
        ({"chassis_width": 0.0}, "chassis_width"),
        ({"chassis_width": float("inf")}, "chassis_width"),
    ],
)
def test_invalid_arguments_of_writers_are_refused(
    name: str, given: dict[str, Any], path: str
) -> None:
    assert refused(lambda: write(WHEELS, name, **given)).path == path


def test_a_broken_robot_is_refused_by_the_rule_it_breaks() -> None:
    assert refused(dataclasses.replace(WHEELS, mass=-1.0).to_sdf).path == "robot.mass"


def test_a_belt_is_moved_by_the_plugins_of_gazebo() -> None:
    root = ElementTree.fromstring(with_flippers(c2d.BeltTrack()).to_sdf().encode())
    moved = [
        plugin.findtext("link")
        for plugin in root.iter("plugin")
        if plugin.get("name") == "gz::sim::systems::TrackController"
    ]
    links = [link.get("name") for link in root.iter("link") if link.get("name")]
    assert len(moved) == 6
    assert set(moved) == set(links) - {"chassis"}


def test_wheels_of_one_radius_share_a_drive() -> None:
    text = with_flippers(c2d.LineOfWheels(2), ends="front").to_sdf()
    radii = re.findall("<wheel_radius>(.*)</wheel_radius>", text)
    assert [float(radius) for radius in radii] == pytest.approx([0.064, 0.037])
    assert len(re.findall("<left_joint>", text)) == len(re.findall("<right_joint>", text)) == 4


def test_wheels_have_the_numbers_that_they_have_in_diagnoses() -> None:
    robot = with_flippers(c2d.LineOfWheels(3), c2d.LineOfWheels(2))
    table = robot.wheels()
    for side, carrier, body in zip(table["side"], table["carrier"], table["body"], strict=True):
        end = "" if carrier == "chassis" else f"{carrier.split()[0]}_"
        name = f"{end}{side}_{'flipper_' if end else ''}wheel_{body}"
        assert f'name="{name}"' in robot.to_sdf()


def test_widths_are_estimated_from_the_gauge() -> None:
    text = WHEELS.to_sdf()
    wide = 0.25 * WHEELS.gauge
    assert f"<length>{wide!r}</length>" in text
    assert f"<length>{0.1!r}</length>" in WHEELS.to_sdf(track_width=0.1)


def attempt(number: int) -> int:
    """Write a valid robot in all formats; count those that can represent it."""
    robot, count = drawn_robot(Draw(number)), 0
    for name in FORMATS:
        try:
            text = write(robot, name)
        except c2d.ScenarioError:
            continue
        ElementTree.fromstring(text.encode())
        assert "nan" not in text
        assert "inf" not in text.partition("-->")[2].replace("inertia", "")
        count += 1
    return count


@pytest.mark.filterwarnings("ignore::crawler2d.ScenarioWarning")
def test_any_legal_robot_is_written_or_refused_by_a_rule() -> None:
    assert sum(attempt(number) for number in range(20)) > 3


@pytest.mark.soak
@pytest.mark.filterwarnings("ignore::crawler2d.ScenarioWarning")
def test_very_many_legal_robots_are_written_or_refused_by_a_rule() -> None:
    assert sum(attempt(number) for number in range(1000, 3000)) > 400


@pytest.mark.parametrize("name", FORMATS)
def test_a_console_does_not_show_the_whole_file(name: str, tmp_path: Path) -> None:
    text = write(WHEELS, name, tmp_path / "model.xml")
    assert len(repr(text)) < 80
    assert str(len(text)) in repr(text)
    assert (tmp_path / "model.xml").read_text(encoding="utf-8") == text
