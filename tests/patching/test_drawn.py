"""Random robots as files: the wheels that they get are read again unchanged."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import crawler2d as c2d
from crawler2d.patching.patch import patch_file
from tests.reading.carts import quietly
from tests.writing.drawn import drawn

SUFFIX = {"sdf": "sdf", "urdf": "urdf", "mjcf": "xml"}


def other_wheels(track: Any, rng: np.random.Generator) -> Any:
    """More or fewer wheels, or one placed wheel less."""
    if isinstance(track, c2d.HybridWheels):
        places = list(track.placements)
        places.pop(int(rng.integers(1, len(places) - 1)))
        return replace(track, placements=tuple(places))
    return replace(track, count=int(track.count + rng.choice([-1, 1, 2])) if track.count > 2 else 3)


def check(number: int, name: str, folder: Path) -> bool:
    """Change a robot's wheels in its file; False if the drawn robot has no such wheels."""
    rng = np.random.default_rng([26, number])
    path = folder / f"robot.{SUFFIX[name]}"
    getattr(drawn(number, wheels_only=True), f"to_{name}")(path, friction=0.6)
    reading = quietly(path, mesh="hull")
    track: Any = reading.robot.track
    if isinstance(track, c2d.LineOfWheels) and not track.as_track and track.count == 2:
        return False  # a chassis without its own wheels, or with only its end wheels
    robot = replace(reading.robot, track=other_wheels(track, rng))
    arms = robot.flippers
    if arms is not None and arms.track is None:
        robot = replace(robot, flippers=replace(arms, track=track))
    try:
        robot.wheels()
    except c2d.ScenarioError:
        return False
    try:
        patch = patch_file(reading, robot)  # which reads it again, and compares
    except c2d.ScenarioError as error:
        # Wheels that weigh a quarter of the robot move its centre of mass where they are uneven.
        assert error.path == "the changed file, read again: center_of_mass"  # noqa: PT017
        return False
    assert patch.diff
    return True


@pytest.mark.parametrize("many", [4, pytest.param(40, marks=pytest.mark.soak)])
@pytest.mark.parametrize("name", SUFFIX)
def test_any_wheels_that_a_file_gets_are_read_again(name: str, many: int, tmp_path: Path) -> None:
    made = sum(check(number, name, tmp_path) for number in range(many))
    assert made > many // 2
