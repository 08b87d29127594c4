"""Terrains: their ground, its ends, and that a robot can drive on it."""

import math
from typing import Any

import numpy as np
import pytest

import crawler2d as c2d
from crawler2d import _core
from crawler2d.parameters.scenario import Scenario
from tests.shared import POINTS, ROBOT

HALF = 0.05 * math.tan(0.5)

TERRAINS: dict[str, tuple[Any, float, list[tuple[float, float]]]] = {
    "flat": (c2d.terrains.flat(length=1.5), 1.5, []),
    "step": (c2d.terrains.step(0.05), 0.0, [(0, 0), (0, 0.05)]),
    "ramp": (
        c2d.terrains.ramp(0.3, length=0.5),
        0.5,
        [(0, 0), (0.5, 0.5 * math.tan(0.3))],
    ),
    "barrier": (
        c2d.terrains.barrier(0.05, 0.03),
        0.03,
        [(0, 0), (0, 0.05), (0.03, 0.05), (0.03, 0)],
    ),
    "knife edge": (
        c2d.terrains.knife_edge(0.04),
        0.01,
        [(0, 0), (0, 0.04), (0.01, 0.04), (0.01, 0)],
    ),
    "ridge": (
        c2d.terrains.ridge(0.05, 1.0),
        2.0 * HALF,
        [(0, 0), (HALF, 0.05), (2.0 * HALF, 0)],
    ),
    "gap": (
        c2d.terrains.gap(0.1, depth=0.3),
        0.1,
        [(0, 0), (0, -0.3), (0.1, -0.3), (0.1, 0)],
    ),
    "stairs": (
        c2d.terrains.stairs(count=3, rise=0.04, run=0.2),
        0.4,
        [(0, 0), (0, 0.04), (0.2, 0.04), (0.2, 0.08), (0.4, 0.08), (0.4, 0.12)],
    ),
    "points": (
        c2d.terrains.from_points(POINTS, goal=0.25),
        0.25,
        [(0, 0), (0, 0.05)],
    ),
    "lanes": (
        c2d.terrains.lanes(c2d.terrains.barrier(0.05, 0.03), c2d.terrains.barrier(0.05, 0.03)),
        0.03,
        [(0, 0), (0, 0.05), (0.03, 0.05), (0.03, 0)],
    ),
}


def ground(terrain: Any, **fields: Any) -> dict[str, Any]:
    return _core.geometry(Scenario(ROBOT, terrain, **fields).to_json())


@pytest.mark.parametrize("name", TERRAINS)
def test_a_terrain_has_its_corners_and_its_goal(name: str) -> None:
    terrain, goal, corners = TERRAINS[name]
    made = ground(terrain)
    assert made["goal"] == pytest.approx(goal)
    expected = np.array(corners).reshape(-1, 2)
    assert made["lanes"][0][1][1:-1] == pytest.approx(expected, abs=1e-12)
    edges = np.column_stack([made["edges"]["x"], made["edges"]["y"]])
    assert edges == pytest.approx(expected, abs=1e-12)
    assert ground(terrain, goal=0.5)["goal"] == 0.5


@pytest.mark.parametrize("radius", [0.001, 0.05, 0.3])
def test_a_half_round_is_half_a_circle(radius: float) -> None:
    made = ground(c2d.terrains.half_round(radius))
    x, y = made["lanes"][0][1][1:-1].T
    assert made["goal"] == pytest.approx(2.0 * radius)
    assert np.hypot(x - radius, y) == pytest.approx(radius)
    assert (y.min(), y.max()) == pytest.approx((0.0, radius), abs=1e-12)
    assert np.all(np.diff(x) >= 0.0)
    # No facet turns further than a degree.
    assert len(x) > 180


@pytest.mark.parametrize("size", [0.02, 0.04, 0.06, 0.08])
def test_an_arc_may_take_up_all_of_a_slope(size: float) -> None:
    corners = [[-5.0, 0.0], [0.0, 0.0], [size, -size], [2.0 * size, 0.0], [5.0, 0.0]]
    largest = size * math.sqrt(2.0) / math.tan(0.125 * math.pi)
    made = ground(c2d.terrains.from_points(corners, goal=2.0 * size, edge_radius=largest))
    points = made["lanes"][0][1]
    assert points[:, 1].min() == -size
    assert len(made["edges"]["x"]) == 3


def test_an_edge_radius_below_a_nanometre_is_a_sharp_edge() -> None:
    sharp, rounded = (
        ground(c2d.terrains.barrier(0.05, 0.1, edge_radius=radius)) for radius in (0.0, 9e-10)
    )
    assert np.array_equal(sharp["lanes"][0][1], rounded["lanes"][0][1])
    assert not rounded["edges"]["radius"].any()


def test_a_knife_edge_is_a_thin_barrier() -> None:
    assert c2d.terrains.knife_edge(0.05) == c2d.terrains.barrier(0.05, 0.01)
    thinner = c2d.terrains.knife_edge(0.05, thickness=0.004, edge_radius=0.002, friction=0.5)
    assert thinner == c2d.terrains.barrier(0.05, 0.004, edge_radius=0.002, friction=0.5)


def test_a_rounded_terrain_keeps_its_height() -> None:
    for terrain in (
        c2d.terrains.barrier(0.05, 0.03, edge_radius=0.01),
        c2d.terrains.stairs(count=1, rise=0.05, edge_radius=0.01),
    ):
        made = ground(terrain)
        assert made["lanes"][0][1][:, 1].max() == pytest.approx(0.05)
        convex = made["edges"]["angle"] > 0.0
        assert set(made["edges"]["radius"][convex]) == {0.01}
        assert set(made["edges"]["radius"][~convex]) == {0.0}


def test_a_field_takes_a_barrier_hundreds_of_metres_longer_than_itself() -> None:
    terrain = c2d.terrains.stepfield_with_barrier(3, height=0.05, thickness=400.0, yaw=0.0)
    heights = terrain.height_at([-250.0, -199.0, 199.0, 250.0], lane="left", gauge=0.3)
    assert heights.tolist() == [0.0, 0.05, 0.05, 0.0]


@pytest.mark.parametrize(
    ("terrain", "path", "largest"),
    [
        (c2d.terrains.barrier(0.05, 0.01), "terrain", 0.005),
        (c2d.terrains.barrier(0.05, 0.2), "terrain", 0.05),
        (c2d.terrains.ridge(0.05, 0.5 * math.pi), "terrain", 0.05 * math.sqrt(2.0)),
        (c2d.terrains.gap(0.1, depth=0.02), "terrain", 0.02),
        (c2d.terrains.stairs(rise=0.03), "terrain", 0.03),
        (
            c2d.terrains.lanes(c2d.terrains.knife_edge(0.05), c2d.terrains.knife_edge(0.05)),
            "terrain.left",
            0.005,
        ),
    ],
    ids=["thin barrier", "low barrier", "ridge", "gap", "stairs", "lanes"],
)
def test_an_edge_radius_must_fit(terrain: Any, path: str, largest: float) -> None:
    scenario = Scenario(ROBOT, terrain)
    name = f"{path}.edge_radius"
    variant = scenario.replace({name: 1.001 * largest})
    with pytest.raises(c2d.ScenarioError, match="must fit the edge at") as caught:
        variant.validate()
    assert caught.value.path == name
    if path == "terrain":
        scenario.replace({name: 0.999 * largest}).validate()


@pytest.mark.parametrize("name", [*TERRAINS, "half round"])
@pytest.mark.parametrize("track", [c2d.BeltTrack(), c2d.LineOfWheels(3, wheel=c2d.GearWheel())])
def test_a_robot_drives_on_every_terrain(name: str, track: Any) -> None:
    terrain = TERRAINS[name][0] if name in TERRAINS else c2d.terrains.half_round(0.04)
    run = c2d.simulate(ROBOT.with_track(track), terrain, duration=2.5)
    assert np.isfinite(run.position).all()
    assert run.metrics["distance"] > 0.08
    assert run.metrics["max_penetration"] < 2e-3
