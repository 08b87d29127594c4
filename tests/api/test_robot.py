"""Values that the rules of a robot refuse."""

import dataclasses
import math
from collections.abc import Sequence

import pytest

import crawler2d as c2d
from tests.shared import ROBOT, refusal


def star(points: int, rounds: int) -> list[tuple[float, float]]:
    """Corners on a circle, counter-clockwise, in a number of rounds."""
    angles = [math.tau * rounds * i / points for i in range(points)]
    return [(0.1 * math.cos(angle), 0.1 * math.sin(angle)) for angle in angles]


@pytest.mark.parametrize(
    "belly", [star(5, 2), star(7, 2), star(7, 3), star(64, 31), star(5, 2)[::-1]]
)
def test_a_star_is_no_convex_belly(belly: Sequence[tuple[float, float]]) -> None:
    error = refusal(dataclasses.replace(ROBOT, belly=tuple(belly)))
    assert error.path.startswith("robot.belly")
    assert "convex counter-clockwise polygon" in error.rule


@pytest.mark.parametrize("points", [3, 4, 5, 6, 64])
def test_a_convex_belly_may_begin_at_any_corner(points: int) -> None:
    corners = star(points, 1)
    for first in range(points):
        belly = (*corners[first:], *corners[:first])
        c2d.Scenario(dataclasses.replace(ROBOT, belly=belly), c2d.terrains.flat()).validate()
