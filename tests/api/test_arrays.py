"""Arrays of points: all real arrays give the same bits, anything else an error."""

from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

import crawler2d as c2d
from tests.shared import POINTS, ROBOT

EXACT = np.array([[-3.0, 0.0], [0.0, 0.0], [0.0, 0.5], [3.0, 0.5]])


def read_only() -> np.ndarray[Any, Any]:
    array = EXACT.copy()
    array.flags.writeable = False
    return array


class Subclass(np.ndarray[Any, Any]):
    """Any subclass."""


SAME = {
    "list": EXACT.tolist(),
    "tuple": tuple(map(tuple, EXACT.tolist())),
    "list of arrays": list(EXACT),
    "float32": EXACT.astype(np.float32),
    "float16": EXACT.astype(np.float16),
    "longdouble": EXACT.astype(np.longdouble),
    "big-endian": EXACT.astype(">f8"),
    "Fortran order": np.asfortranarray(EXACT),
    "strided": np.repeat(EXACT, 2, axis=0)[::2],
    "reversed twice": EXACT[::-1].copy()[::-1],
    "transposed": EXACT.T.copy().T,
    "read-only": read_only(),
    "subclass": EXACT.view(Subclass),
    "data frame": pd.DataFrame(EXACT),
}


@pytest.mark.parametrize("name", SAME)
def test_every_real_array_gives_the_same_terrain(name: str) -> None:
    terrain = c2d.terrains.from_points(SAME[name], goal=0.0)
    assert terrain == c2d.terrains.from_points(EXACT, goal=0.0)
    assert all(type(x) is float for point in terrain.points for x in point)


def test_whole_numbers_are_points() -> None:
    whole = np.array([[-3, 0], [0, 0], [0, 1], [3, 1]])
    expected = c2d.terrains.from_points(whole.astype(float), goal=0.0)
    for dtype in (np.int64, np.int32, np.uint8):
        shifted = (whole + 3).astype(dtype)
        reference = c2d.terrains.from_points((whole + 3).astype(float), goal=0.0)
        assert c2d.terrains.from_points(shifted, goal=0.0) == reference
    assert c2d.terrains.from_points(whole.tolist(), goal=0.0) == expected


def test_a_memory_map_gives_the_same_terrain(tmp_path: Path) -> None:
    np.save(tmp_path / "points.npy", EXACT)
    mapped = np.load(tmp_path / "points.npy", mmap_mode="r")
    terrain = c2d.terrains.from_points(mapped, goal=0.0)
    assert terrain == c2d.terrains.from_points(EXACT, goal=0.0)


def test_a_later_change_of_the_array_does_not_reach_the_terrain() -> None:
    array = EXACT.copy()
    terrain = c2d.terrains.from_points(array, goal=0.0)
    array[:] = 7.0
    assert terrain == c2d.terrains.from_points(EXACT, goal=0.0)


REFUSED: dict[str, Any] = {
    "bool": np.ones((4, 2), dtype=bool),
    "complex": EXACT.astype(complex),
    "object": EXACT.astype(object),
    "text": EXACT.astype(str),
    "dates": np.zeros((4, 2), dtype="datetime64[s]"),
    "structured": np.zeros(4, dtype=[("x", float), ("y", float)]),
    "masked": np.ma.masked_array(EXACT, mask=EXACT > 1.0),
    "masked without a mask": np.ma.masked_array(EXACT),
    "integers beyond float64": np.full((4, 2), 2**53 + 1),
    "unsigned beyond float64": np.full((4, 2), 2**64 - 1, dtype=np.uint64),
    "numbers beyond float64": [[10**400, 0], [1, 0]],
    "no dimension": np.array(1.0),
    "one dimension": np.array([1.0, 2.0]),
    "three columns": np.zeros((4, 3)),
    "two rows": np.zeros((2, 4)),
    "three dimensions": np.zeros((4, 2, 1)),
    "a number": 5.0,
    "a dict": {"x": 1},
    "a set": {1.0, 2.0},
    "a generator": (p for p in POINTS),
    "a text": "points",
    "an object": object(),
}


@pytest.mark.parametrize("name", REFUSED)
def test_anything_but_a_real_array_is_refused_at_once(name: str) -> None:
    with pytest.raises(c2d.ScenarioError) as caught:
        c2d.terrains.from_points(REFUSED[name], goal=0.0)
    assert caught.value.path == "terrain.points"
    assert len(str(caught.value)) < 300


@pytest.mark.skipif(np.longdouble(0) + 2**-60 + 1 == 1, reason="long double is double here")
def test_digits_that_float64_lacks_are_refused() -> None:
    array = EXACT.astype(np.longdouble)
    array[0, 0] += np.longdouble(2) ** -60
    with pytest.raises(c2d.ScenarioError, match="fit in float64"):
        c2d.terrains.from_points(array, goal=0.0)


def test_a_ragged_list_names_its_first_bad_row() -> None:
    with pytest.raises(c2d.ScenarioError) as caught:
        c2d.terrains.from_points([[0, 0], [1, 0], [2], [3, 0, 0]], goal=0.0)
    assert caught.value.path == "terrain.points[2]"


@pytest.mark.parametrize(
    ("points", "path"),
    [
        (None, "terrain.points"),
        ([], "terrain.points"),
        ([[0.0, 0.0]], "terrain.points"),
        ([[0.0, 0.0], [0.0, 0.0]], "terrain.points"),
        ([[0.0, 0.0], [1.0, np.nan], [2.0, 0.0]], "terrain.points[1][1]"),
        ([[0.0, 0.0], [1.0, 0.0], [np.inf, 0.0]], "terrain.points[2][0]"),
        ([[-3.0, 0.0], [1.0, 0.0], [0.5, 0.2], [2.0, 0.2]], "terrain.points[2]"),
    ],
)
def test_points_that_make_no_ground_are_refused_by_row(points: Any, path: str) -> None:
    with pytest.raises(c2d.ScenarioError) as caught:
        c2d.Scenario(ROBOT, c2d.terrains.from_points(points, goal=0.0)).validate()
    assert caught.value.path == path


def test_points_may_run_from_right_to_left() -> None:
    there = c2d.simulate(ROBOT, c2d.terrains.from_points(EXACT / 10 * 9, goal=0.0), duration=1.0)
    back = c2d.simulate(
        ROBOT, c2d.terrains.from_points(EXACT[::-1] / 10 * 9, goal=0.0), duration=1.0
    )
    assert np.array_equal(there.position, back.position)


@pytest.mark.parametrize("center", [np.array([0.01, 0.02]), [0.01, 0.02], (0.01, np.float64(0.02))])
def test_a_point_may_be_any_array(center: Any) -> None:
    assert c2d.robots.engineer(flippers=None, center_of_mass=center).center_of_mass == (0.01, 0.02)


@pytest.mark.parametrize("center", [0.0, [0.0], [0.0, 1.0, 2.0], "ab", [True, False], [[0.0, 1.0]]])
def test_an_invalid_point_is_refused(center: Any) -> None:
    with pytest.raises(c2d.ScenarioError) as caught:
        c2d.robots.engineer(flippers=None, center_of_mass=center)
    assert caught.value.path == "robot.center_of_mass"
