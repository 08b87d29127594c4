"""Patches of files with a bit of everything are, line by line, as in `kept`."""

import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest

import crawler2d as c2d
from crawler2d.patching.patch import patch_file
from tests.kept import check_kept
from tests.patching.test_edits import GEAR, with_gears
from tests.patching.test_patch import on_chassis, with_own_flippers
from tests.reading.carts import FILES, quietly

KEPT = Path(__file__).parent / "kept"
THREE = replace(GEAR, grouser_count=3)
ODD = Path(__file__).parents[1] / "reading" / "accounts"


NUMBER = re.compile(r"-?\d+\.\d+(?:e-?\d+)?")
"""Its last digits depend on the processor."""


def rounded(number: re.Match[str]) -> str:
    return f"{round(float(number[0]), 9) + 0.0:g}"


def moved(reading: c2d.Reading) -> c2d.Robot:
    """The robot of a file with other placed wheels: one moved, and two new ones."""
    track = reading.robot.track
    assert isinstance(track, c2d.HybridWheels)
    rear, _, front = track.placements
    places = (rear, (-0.12, -0.01, 0.09), (0.02, -0.006, 0.095), (0.13, -0.02, 0.08), front)
    return replace(reading.robot, track=replace(track, placements=places))


def fewer(reading: c2d.Reading) -> c2d.Robot:
    track = reading.robot.track
    assert isinstance(track, c2d.HybridWheels)
    placements = (track.placements[0], track.placements[2])
    return replace(reading.robot, track=replace(track, placements=placements))


CASES: dict[str, tuple[Path, Callable[[c2d.Reading], c2d.Robot]]] = {
    "odd-urdf-moved": (ODD / "odd.urdf", moved),
    "odd-urdf-fewer": (ODD / "odd.urdf", fewer),
    "odd-xml-flippers": (ODD / "odd.xml", with_own_flippers),
    "cart-xacro-two": (FILES / "cart.xacro", lambda reading: on_chassis(reading, 2)),
    **{
        f"cart-{suffix}-{name}": (FILES / f"cart.{suffix}", change)
        for suffix in ("sdf", "urdf", "xml")
        for name, change in (
            ("four-smaller", lambda reading: on_chassis(reading, 4, 0.1)),
            ("two", lambda reading: on_chassis(reading, 2)),
            ("gears", lambda reading: with_gears(reading, THREE)),
            ("flippers", with_own_flippers),
        )
    },
}


@pytest.mark.parametrize("name", CASES)
def test_a_patch_changes_the_lines_that_it_changed_before(name: str) -> None:
    path, change = CASES[name]
    for suffix, library in ((".xml", "mujoco"), (".xacro", "xacrodoc")):
        if path.suffix == suffix:
            pytest.importorskip(library)
    reading = quietly(path)
    patch = patch_file(reading, change(reading))
    text = NUMBER.sub(rounded, "\n".join([patch.summary, *patch.left, patch.diff]))
    check_kept(KEPT / f"{name}.diff", text)


@pytest.mark.parametrize("name", CASES)
def test_removed_and_added_parts_of_a_patch_share_no_last_line(name: str) -> None:
    """For example if only the part above it differs."""
    kept = (KEPT / f"{name}.diff").read_text(encoding="utf-8")
    for gone, new in re.findall(r"((?:^-.*\n)+)((?:^\+.*\n)+)", kept, re.MULTILINE):
        assert gone.splitlines()[-1][1:] != new.splitlines()[-1][1:]
