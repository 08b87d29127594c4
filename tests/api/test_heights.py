"""`height_at`: the height of any terrain at positions along x."""

import math
from typing import Any

import numpy as np
import pytest

import crawler2d as c2d
from crawler2d import _core
from tests.shared import POINTS, VARIANTS, refused

GROUNDS = {repr(each.terrain): each for each in VARIANTS.values()}
LANES: dict[int, Any] = {1: "left", 2: "right", 3: "middle"}


def fine(number: float) -> float:
    """[m] Tolerance of a height that is interpolated by other operations."""
    return 1e-12 * max(1.0, abs(number))


@pytest.mark.parametrize("name", GROUNDS)
def test_heights_are_those_of_the_ground_that_is_simulated(name: str) -> None:
    scenario = GROUNDS[name]
    robot, terrain = scenario.robot, scenario.terrain
    simulated = dict(_core.geometry(scenario.to_json())["lanes"])
    places = np.random.default_rng(1).uniform(-0.5, 2.0, 200)
    for lane, profile in simulated.items():
        found = terrain.height_at(places, lane=LANES.get(lane), gauge=robot.gauge)
        assert found == pytest.approx(np.interp(places, *profile.T), abs=fine(1.0))
    assert {0} <= set(simulated) or {1, 2, 3} == set(simulated)


@pytest.mark.parametrize(
    ("terrain", "tops"),
    [
        (c2d.terrains.step(0.1), {0.0: 0.1}),
        (c2d.terrains.gap(0.2, depth=0.3), {0.0: 0.0, 0.2: 0.0}),
        (c2d.terrains.barrier(0.05, 0.1), {0.0: 0.05, 0.1: 0.05}),
        (c2d.terrains.from_points(POINTS, goal=0.0), {0.0: 0.05}),
        (c2d.terrains.from_points(POINTS[::-1], goal=0.0), {0.0: 0.05}),
    ],
    ids=["step", "gap", "barrier", "points", "points from the right"],
)
def test_at_a_vertical_face_it_is_that_of_the_upper_end(
    terrain: Any, tops: dict[float, float]
) -> None:
    assert terrain.height_at(list(tops)).tolist() == list(tops.values())


def test_an_edge_is_as_round_as_it_is_simulated() -> None:
    rounded = c2d.terrains.step(0.1, edge_radius=0.05)
    # Facets lie below the true arc by up to 0.05 m x 0.0175^2 / 8.
    below = 0.05 - 0.05 * math.sqrt(1.0 - 0.5**2)
    assert rounded.height_at(0.025) == pytest.approx(0.1 - below, abs=2e-6)


def test_the_ends_of_the_ground_have_heights_and_nan_is_beyond_them() -> None:
    ground = c2d.terrains.from_points([(-2, 0.5), (0, 0), (3, 0.25)], goal=1.0)
    found = ground.height_at([-2.1, -2.0, 3.0, 3.1])
    assert np.isnan(found[[0, 3]]).all()
    assert found[1:3].tolist() == [0.5, 0.25]
    assert math.isnan(ground.height_at(math.nan))


def test_a_number_gives_a_float_and_an_array_its_shape() -> None:
    step = c2d.terrains.step(0.1)
    assert {type(step.height_at(x)) for x in (0.5, 1, np.float32(0.5))} == {float}
    assert step.height_at([[0.0, 1.0], [2.0, 3.0], [4.0, 5.0]]).shape == (3, 2)
    assert step.height_at([]).shape == (0,)


def test_lanes_that_differ_must_be_named() -> None:
    step, flat = c2d.terrains.step(0.1), c2d.terrains.flat()
    ground = c2d.terrains.lanes(flat, step)
    assert refused(lambda: ground.height_at(0.5)).path == "lane"
    heights = {lane: ground.height_at(0.5, lane=lane) for lane in LANES.values()}
    assert heights == {"left": 0.0, "right": 0.1, "middle": 0.1}
    alike = c2d.terrains.lanes(step, step, middle=flat)
    assert alike.height_at(0.5) == alike.height_at(0.5, lane="left") == 0.1
    assert alike.height_at(0.5, lane="middle") == 0.0
    assert step.height_at(0.5, lane="middle") == 0.1
    belly: Any = "belly"
    assert refused(lambda: ground.height_at(0.5, lane=belly)).path == "lane"


def test_a_turned_barrier_needs_the_distance_of_the_tracks() -> None:
    barrier = c2d.terrains.diagonal_barrier(0.3)
    assert refused(lambda: barrier.height_at(0.0, lane="left")).path == "gauge"
    field = c2d.terrains.stepfield_with_barrier(yaw=0.3)
    assert refused(lambda: field.height_at(0.0, lane="left")).path == "gauge"
    apart = 0.4 * math.tan(0.3)
    places = [-1e-9, 1e-9, apart - 1e-9, apart + 1e-9]
    left, right = (barrier.height_at(places, lane=LANES[k], gauge=0.4) for k in (1, 2))
    assert left[:2].tolist() == [0.0, 0.05]
    assert right[2:].tolist() == [0.0, 0.05]
    assert c2d.terrains.diagonal_barrier(0.0).height_at(0.0) == 0.05
    assert c2d.terrains.random_stepfield(barrier_yaw=0.3).height_at(-0.1, lane="left") == 0.0


@pytest.mark.parametrize(
    ("call", "path"),
    [
        (lambda: c2d.terrains.step(-0.1).height_at(0.0), "terrain.height"),
        (lambda: c2d.terrains.step(0.1).height_at("0.5"), "x"),
        (lambda: c2d.terrains.step(0.1).height_at([0.5, 1j]), "x"),
        (lambda: c2d.terrains.step(0.1).height_at(True), "x"),
        (lambda: c2d.terrains.step(0.1).height_at([[0.0], [0.0, 1.0]]), "x"),
        (
            lambda: c2d.terrains.from_points([(-1, 0), (1, 0), (0, 1)], goal=0.0).height_at(0.5),
            "terrain.points[2]",
        ),
    ],
    ids=["broken terrain", "text", "complex", "truth", "ragged", "overhang"],
)
def test_terrains_without_a_height_are_refused_by_path(call: Any, path: str) -> None:
    assert refused(call).path == path
