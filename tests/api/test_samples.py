"""The sample models are one robot in three formats, which seizes as intended."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

import crawler2d as c2d
from crawler2d.audits.subject import standard_obstacles
from crawler2d.audits.text import lint_only
from crawler2d.parameters.fields import to_dict
from crawler2d.patching.patch import patch_file
from tests.shared import refused

NAMES = c2d.samples.names()


def leaves(plain: Any, path: str = "robot") -> dict[str, Any]:
    if isinstance(plain, dict):
        parts = [(f"{path}.{name}", each) for name, each in plain.items()]
    elif isinstance(plain, list):
        parts = [(f"{path}[{number}]", each) for number, each in enumerate(plain)]
    else:
        return {path: plain}
    return {name: leaf for part, each in parts for name, leaf in leaves(each, part).items()}


def read(name: str) -> c2d.Reading:
    if name.endswith(".xml"):
        pytest.importorskip("mujoco")
    return c2d.read_robot(c2d.samples.path(name))


def test_the_samples_are_of_every_format() -> None:
    assert {Path(name).suffix for name in NAMES} == {".sdf", ".urdf", ".xml"}
    assert all(c2d.samples.path(name).is_file() for name in NAMES)
    folder = c2d.samples.path().parent
    assert {path.name for path in folder.iterdir() if path.suffix != ".py"} - {
        "__pycache__"
    } == set(NAMES)


@pytest.mark.parametrize("name", NAMES[1:])
def test_each_format_has_the_same_robot(name: str) -> None:
    first, other = read(NAMES[0]), read(name)
    # MuJoCo's servos correct a speed by a gain, while those of other simulators hold it.
    held = replace(other.robot.drivetrain, controller=None)
    robots = (first.robot, replace(other.robot, drivetrain=held))
    expected, found = (leaves(to_dict(each)) for each in robots)
    assert set(found) == set(expected)
    for path, value in expected.items():
        if isinstance(value, float):
            assert found[path] == pytest.approx(value, rel=1e-6, abs=1e-9), path
        else:
            assert found[path] == value, path
    assert other.friction == first.friction
    assert other.sources.estimates == first.sources.estimates


@pytest.mark.parametrize("name", NAMES)
def test_a_sample_is_a_plausible_robot(name: str) -> None:
    read(name)
    found = lint_only(c2d.samples.path(name))
    assert {each.severity for each in found.lint} <= {"note"}
    assert 10.0 < found.robot.mass < 20.0
    outline = found.robot.outline
    assert 0.45 < outline.axle_distance + 2.0 * outline.front_radius < 0.6
    assert found.reading is not None
    assert not found.reading.warnings
    assert len(c2d.samples.path(name).read_text("utf-8").splitlines()) <= 150


def test_an_unknown_sample_is_refused_with_the_nearest() -> None:
    error = refused(lambda: c2d.samples.path("rover.srdf"))
    assert (error.path, error.value) == ("name", "rover.srdf")
    assert "rover.urdf" in error.rule
    assert "did you mean rover.sdf?" in error.rule


CHANGED = {
    "one more": c2d.LineOfWheels(6),
    "gears": c2d.LineOfWheels(
        5,
        wheel=c2d.GearWheel(
            grouser_count=12, grouser_height=0.01, tip_thickness=0.01, base_thickness=0.01
        ),
    ),
}


@pytest.mark.parametrize("track", CHANGED.values(), ids=CHANGED)
@pytest.mark.parametrize("name", NAMES)
def test_the_wheels_of_a_sample_can_be_changed_in_its_file(
    name: str, track: c2d.LineOfWheels, tmp_path: Path
) -> None:
    reading = read(name)
    changed = tmp_path / name
    changed.write_text(patch_file(reading, reading.robot.with_track(track)).text, encoding="utf-8")
    again = c2d.read_robot(changed).robot
    assert isinstance(again.track, c2d.LineOfWheels)
    assert again.track.count == track.count
    assert type(again.track.wheel) is type(track.wheel)
    assert again.mass == pytest.approx(reading.robot.mass, rel=1e-6)


def test_the_sample_seizes_on_a_step_that_a_belt_climbs() -> None:
    rover = c2d.samples.path()
    obstacles = standard_obstacles(c2d.read_robot(rover).robot, 0.9)
    step = {"step 50 mm": obstacles["step 50 mm"]}
    floors = {"terrain.friction": c2d.uniform(0.5, 0.9)}
    few: Any = {"samples": 48, "repair": False, "threads": 2, "progress": False}
    found = c2d.audit(rover, step, unknown=floors, **few)
    (verdict,) = found.verdicts
    assert verdict.result == "seizes"
    assert verdict.belt_cleared.rate > 0.9
    assert verdict.seized_alone_count == verdict.jam_counts[1]
