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
