"""Track models: which wheels can be, where they sit, what they weigh, and what is refused."""

import dataclasses
import math
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
import pytest

import crawler2d as c2d
from conftest import GEAR, PLACEMENTS, POINTS, ROBOT
from crawler2d import _core
from crawler2d.scenario import Scenario

OUTLINE = ROBOT.outline
TAPERED = dataclasses.replace(
    ROBOT, outline=dataclasses.replace(OUTLINE, front_radius=0.05, rear_radius=0.08)
)
# Points of a root arc in the outlines of `_core.geometry`.
ARC_POINTS = 12


def refusal(robot: c2d.Robot, **fields: Any) -> c2d.ScenarioError:
    with pytest.raises(c2d.ScenarioError) as caught:
        Scenario(robot, c2d.terrains.flat(), **fields).validate()
    return caught.value


def gears(robot: c2d.Robot) -> list[dict[str, Any]]:
    gears: list[dict[str, Any]] = _core.geometry(Scenario(robot, c2d.terrains.flat()).to_json())[
        "gears"
    ]
    return gears


def centers(robot: c2d.Robot) -> np.ndarray[Any, Any]:
    wheels = robot.wheels()
    return np.column_stack([wheels["x"], wheels["y"]])


# Counts and sizes


COUNTED: dict[str, tuple[Callable[[Any], Any], str, int]] = {
    "line": (c2d.LineOfWheels, "count", 2),
    "circumferential": (c2d.CircumferentialWheels, "count", 3),
    "grousers": (
        lambda count: c2d.LineOfWheels(3, wheel=c2d.GearWheel(grouser_count=count)),
        "wheel.grouser_count",
        3,
    ),
    "free wheels": (
        lambda count: c2d.ForceTrack(support="wheels", wheel_count=count),
        "wheel_count",
        2,
    ),
}


@pytest.mark.parametrize("count", [-1, 0, 1, 2.5, 12.0, "12", True, 10_000, 2**70, math.nan])
@pytest.mark.parametrize("name", COUNTED)
def test_an_impossible_count_is_refused(name: str, count: Any) -> None:
    model, path, least = COUNTED[name]
    error = refusal(ROBOT.with_track(model(count)))
    assert error.path == f"robot.track.{path}"
    assert error.rule == f"must be an integer from {least} to 200"


@pytest.mark.parametrize(("count", "works"), [(2, False), (3, True), (200, True), (201, False)])
def test_a_gear_has_3_to_200_grousers(count: int, works: bool) -> None:
    wheel = c2d.GearWheel(grouser_count=count, tip_thickness=0.001)
    robot = ROBOT.with_track(c2d.LineOfWheels(2, wheel=wheel))
    if works:
        run = c2d.simulate(robot, c2d.terrains.flat(), duration=0.2)
        assert run.metrics["distance"] > 0.0
    else:
        assert refusal(robot).path == "robot.track.wheel.grouser_count"


@pytest.mark.parametrize("count", [np.int64(12), np.uint8(12), np.array(12)])
def test_a_count_may_be_a_numpy_integer(count: Any) -> None:
    wheel = c2d.GearWheel(grouser_count=count)
    assert wheel == c2d.GearWheel(grouser_count=12)
    assert type(wheel.grouser_count) is int


@pytest.mark.parametrize("radius", [0, 1e-9, 1e6, -0.01, math.nan, math.inf, "0.01", True])
@pytest.mark.parametrize(
    ("model", "path"),
    [
        (lambda radius: c2d.LineOfWheels(3, wheel_radius=radius), "wheel_radius"),
        (lambda radius: c2d.CircumferentialWheels(24, wheel_radius=radius), "wheel_radius"),
    ],
    ids=["line", "circumferential"],
)
def test_an_impossible_radius_is_refused(model: Any, path: str, radius: Any) -> None:
    error = refusal(ROBOT.with_track(model(radius)))
    assert error.path == f"robot.track.{path}"
    assert error.rule in ("must be >= 0.001 m and <= 100 m", "must be a number")


@pytest.mark.parametrize(
    ("wheel", "field", "reason"),
    [
        ({"grouser_height": 0.064}, "grouser_height", "no root circle is left"),
        ({"grouser_height": 0.07}, "grouser_height", "no root circle is left"),
        ({"grouser_count": 12, "tip_thickness": 0.03}, "tip_thickness", "they would overlap"),
        ({"grouser_count": 200}, "tip_thickness", "they would overlap"),
        ({"grouser_count": 12, "base_thickness": 0.03}, "base_thickness", "they would overlap"),
        ({"base_thickness": 0.004}, "base_thickness", "must not be below the thickness of the tip"),
    ],
)
def test_a_gear_that_cannot_be_is_refused_with_the_reason(
    wheel: dict[str, Any], field: str, reason: str
) -> None:
    error = refusal(ROBOT.with_track(c2d.LineOfWheels(3, wheel=c2d.GearWheel(**wheel))))
    assert error.path == f"robot.track.wheel.{field}"
    assert reason in error.rule


def test_the_wheel_that_is_too_small_for_its_grousers_is_named() -> None:
    wheel = c2d.GearWheel(grouser_height=0.04)
    error = refusal(ROBOT.with_track(c2d.HybridWheels(PLACEMENTS, wheel=wheel)))
    assert error.path == "robot.track.wheel.grouser_height"
    assert "wheel 1" in error.rule


@pytest.mark.parametrize("field", ["grouser_height", "grouser_thickness"])
def test_a_robot_without_grousers_gives_a_gear_none(field: str) -> None:
    outline = dataclasses.replace(OUTLINE, **{field: 0.0})
    smooth = dataclasses.replace(ROBOT, outline=outline)
    error = refusal(smooth.with_track(c2d.LineOfWheels(3, wheel=c2d.GearWheel())))
    assert error.path.startswith("robot.track.wheel.")
    assert error.rule.startswith("must be given")
    Scenario(smooth.with_track(c2d.LineOfWheels(3, wheel=GEAR)), c2d.terrains.flat()).validate()


@pytest.mark.parametrize(
    ("radius", "height", "count"),
    [(0.064, 0.012, 7), (0.05, 0.012, 8), (0.03, 0.0075, 8), (0.1, 0.012, 12)],
)
def test_a_gear_takes_its_grousers_from_the_robot(radius: float, height: float, count: int) -> None:
    track = c2d.LineOfWheels(2, wheel_radius=radius, wheel=c2d.GearWheel())
    outline = gears(ROBOT.with_track(track))[0]["outline"]
    distance = np.hypot(*outline.T)
    assert len(outline) == count * (ARC_POINTS + 2)
    assert distance.max() == pytest.approx(radius, rel=1e-12)
    assert distance.min() == pytest.approx(radius - height, rel=1e-12)


@pytest.mark.parametrize(("radius", "works"), [(0.0019, False), (0.002, True)])
def test_a_wheel_that_turns_too_far_in_a_step_is_refused(radius: float, works: bool) -> None:
    robot = ROBOT.with_track(c2d.CircumferentialWheels(24, wheel_radius=radius))
    if works:
        Scenario(robot, c2d.terrains.flat()).validate()
        return
    error = refusal(robot)
    assert error.path == "solver.time_step"
    assert "0.7 rad" in error.rule
    solver = c2d.Solver(time_step=5e-4)
    Scenario(robot, c2d.terrains.flat(), solver=solver).validate()


# Keywords and combinations


@pytest.mark.parametrize(
    ("make", "keyword"),
    [
        (c2d.GearWheel, "grouser_cuont"),
        (c2d.RoundWheel, "radius"),
        (partial(c2d.LineOfWheels, 3), "wheel_raduis"),
        (partial(c2d.CircumferentialWheels, 24), "Wheel"),
        (c2d.HybridWheels, "placement"),
        (c2d.BeltTrack, "count"),
        (c2d.ForceTrack, "suport"),
        (partial(c2d.terrains.barrier, 0.05), "thicknes"),
        (partial(c2d.terrains.knife_edge, 0.05), "edge_raduis"),
        (c2d.terrains.stairs, "rises"),
        (partial(c2d.terrains.from_points, POINTS, goal=0.0), "frictoin"),
    ],
)
def test_a_misspelt_keyword_is_a_type_error_that_names_it(make: Any, keyword: str) -> None:
    with pytest.raises(TypeError, match=rf"'{keyword}'"):
        make(**{keyword: 1})


@pytest.mark.parametrize(
    "track",
    [c2d.BeltTrack(), c2d.ForceTrack(), c2d.ForceTrack(support="wheels")],
    ids=["belt", "skids", "free wheels"],
)
def test_a_model_without_driven_wheels_has_one_motor(track: Any) -> None:
    scenario = Scenario(ROBOT.with_track(track), c2d.terrains.flat())
    with pytest.raises(c2d.ScenarioError, match="without driven wheels") as caught:
        scenario.replace({"robot.drivetrain.torque_sharing": "wheel"}).validate()
    assert caught.value.path == "robot.drivetrain.torque_sharing"


@pytest.mark.parametrize("wheel", [c2d.RoundWheel(), c2d.GearWheel()], ids=["round", "gear"])
@pytest.mark.parametrize(
    "model",
    [
        lambda wheel: c2d.LineOfWheels(3, wheel=wheel),
        lambda wheel: c2d.CircumferentialWheels(14, wheel=wheel),
        lambda wheel: c2d.HybridWheels(PLACEMENTS, wheel=wheel),
    ],
    ids=["line", "circumferential", "hybrid"],
)
def test_every_driven_wheel_may_have_a_motor_of_its_own(model: Any, wheel: Any) -> None:
    scenario = Scenario(ROBOT.with_track(model(wheel)), c2d.terrains.flat(), duration=0.3)
    run = c2d.simulate(scenario.replace({"robot.drivetrain.torque_sharing": "wheel"}))
    count = len(run.scenario.robot.wheels())
    assert run.drive_speeds.shape[1] == run.drive_positions.shape[1] == count
    assert run.metrics["distance"] > 0.0


# Hybrid wheels: placements as arrays


EXACT: Any = np.array(PLACEMENTS)


@pytest.mark.parametrize(
    "placements",
    [
        EXACT.tolist(),
        tuple(map(tuple, PLACEMENTS)),
        list(EXACT),
        EXACT.astype(np.float32),
        EXACT.astype(np.float16),
        EXACT.astype(">f8"),
        EXACT.astype(np.longdouble),
        np.asfortranarray(EXACT),
        np.repeat(EXACT, 2, axis=0)[::2],
        EXACT.T.copy().T,
    ],
    ids=["lists", "tuples", "arrays", "f4", "f2", ">f8", "longdouble", "Fortran", "strided", "T"],
)
def test_every_real_array_of_placements_gives_the_same_bits(placements: Any) -> None:
    track = c2d.HybridWheels(placements)
    assert track == c2d.HybridWheels(EXACT)
    assert all(type(x) is float for placement in track.placements for x in placement)
    scenario = Scenario(ROBOT.with_track(track), c2d.terrains.flat())
    same = scenario.replace({"robot.track": c2d.HybridWheels(EXACT)})
    assert scenario.identity == same.identity


@pytest.mark.parametrize("dtype", [np.int64, np.uint8, np.int16])
def test_whole_numbers_are_placements(dtype: Any) -> None:
    whole: Any = np.array([[0, 0, 1], [3, 0, 1]])
    assert c2d.HybridWheels(whole.astype(dtype)) == c2d.HybridWheels(whole.astype(float))


@pytest.mark.parametrize(
    ("placements", "path"),
    [
        ([[0.0, 0.0, 0.1], [0.1, 0.0]], "robot.track.placements[1]"),
        ([[0.0, 0.0, 0.1], 0.1], "robot.track.placements[1]"),
        (np.zeros((3, 2)), "robot.track.placements"),
        (np.zeros((3, 4)), "robot.track.placements"),
        (np.zeros(3), "robot.track.placements"),
        (np.zeros((1, 1, 3)), "robot.track.placements"),
        (np.ones((2, 3), dtype=bool), "robot.track.placements"),
        (np.ones((2, 3), dtype=complex), "robot.track.placements"),
        (np.ma.masked_array(EXACT), "robot.track.placements"),
        ([["0", "0", "1"]], "robot.track.placements"),
        ("placements", "robot.track.placements"),
        (0.1, "robot.track.placements"),
        (object(), "robot.track.placements"),
    ],
)
def test_what_are_no_placements_is_refused_at_once(placements: Any, path: str) -> None:
    with pytest.raises(c2d.ScenarioError) as caught:
        c2d.HybridWheels(placements)
    assert caught.value.path == path
    assert caught.value.rule.startswith("must")


@pytest.mark.parametrize(
    ("placements", "path", "rule"),
    [
        ([], "placements", "must place at least one wheel"),
        (None, "placements", "must be a list of [x, y, radius]"),
        (np.zeros((201, 3)), "placements", "must have at most 200 rows"),
        ([[0, 0, 0.1], [0, math.nan, 0.1]], "placements[1][1]", "must be >= -100 m and <= 100 m"),
        ([[-math.inf, 0, 0.1]], "placements[0][0]", "must be >= -100 m and <= 100 m"),
        ([[0, 0, 0.0]], "placements[0][2]", "must be >= 0.001 m and <= 100 m"),
        ([[0, 0, 1e-9]], "placements[0][2]", "must be >= 0.001 m and <= 100 m"),
        ([[0, 0, 1e6]], "placements[0][2]", "must be >= 0.001 m and <= 100 m"),
    ],
)
def test_placements_that_make_no_wheels_are_refused(placements: Any, path: str, rule: str) -> None:
    error = refusal(ROBOT.with_track(c2d.HybridWheels(placements)))
    assert (error.path, error.rule) == (f"robot.track.{path}", rule)


# Where the wheels sit


def depth_inside(robot: c2d.Robot, point: np.ndarray[Any, Any]) -> float:
    """[m] From a point to the outline: the least over the normals where that least can be."""
    o = robot.outline
    ends = np.array([[-0.5 * o.axle_distance, 0.0], [0.5 * o.axle_distance, 0.0]])
    radii = np.array([o.rear_radius, o.front_radius])
    lean = math.acos((o.rear_radius - o.front_radius) / o.axle_distance)
    normals = [np.array([math.cos(angle), math.sin(angle)]) for angle in (lean, -lean)]
    for end in ends:
        away = point - end
        if np.linalg.norm(away) > 0.0:
            normals += [away / np.linalg.norm(away), -away / np.linalg.norm(away)]
    return min(float((ends @ n + radii).max() - point @ n) for n in normals)


def ring(robot: c2d.Robot, count: int, radius: float | None = None) -> c2d.Robot:
    return robot.with_track(c2d.CircumferentialWheels(count, wheel_radius=radius))


def on_path_of_centers(robot: c2d.Robot, radius: float, share: float) -> tuple[float, float]:
    """[m] Where wheels can sit, a share of the way round: rear arc, top, front arc, lower run."""
    o = robot.outline
    half, rear, front = 0.5 * o.axle_distance, o.rear_radius - radius, o.front_radius - radius
    lean = math.acos((rear - front) / o.axle_distance)
    run = o.axle_distance * math.sin(lean)
    rear_arc, front_arc = rear * (2.0 * math.pi - 2.0 * lean), front * 2.0 * lean
    rear_top = np.array([rear * math.cos(lean) - half, rear * math.sin(lean)])
    front_top = np.array([front * math.cos(lean) + half, front * math.sin(lean)])
    down = np.array([1.0, -1.0])
    way = share * (rear_arc + front_arc + 2.0 * run)
    if way < rear_arc:
        angle = -lean - way / rear
        return rear * math.cos(angle) - half, rear * math.sin(angle)
    way -= rear_arc
    if way < run:
        return tuple(rear_top + (front_top - rear_top) * way / run)
    way -= run
    if way < front_arc:
        angle = lean - way / front
        return front * math.cos(angle) + half, front * math.sin(angle)
    return tuple(down * (front_top + (rear_top - front_top) * (way - front_arc) / run))


# Rounding of a bisection of a length of 1 m and of the walk round it.
EXACTLY = 1e-12


@pytest.mark.parametrize("robot", [ROBOT, TAPERED], ids=["even", "tapered"])
@pytest.mark.parametrize("radius", [0.012, 0.03, 0.045])
def test_spaced_wheels_sit_at_equal_ways_round_the_outline(robot: c2d.Robot, radius: float) -> None:
    for count in range(3, 41):
        wheels = ring(robot, count, radius)
        places = centers(wheels)
        expected = [on_path_of_centers(robot, radius, i / count) for i in range(count)]
        assert places == pytest.approx(np.array(expected), abs=EXACTLY), count
        assert wheels.wheels()["radius"].tolist() == [radius] * count
        assert [depth_inside(robot, p) for p in places] == pytest.approx([radius] * count)


@pytest.mark.parametrize(("robot", "least"), [(ROBOT, 14), (TAPERED, 20)], ids=["even", "tapered"])
def test_tight_wheels_touch_their_neighbours_and_nobody_else(robot: c2d.Robot, least: int) -> None:
    for count in range(least, 41):
        wheels = ring(robot, count)
        places, radii = centers(wheels), wheels.wheels()["radius"]
        assert np.ptp(radii) == 0.0
        assert len(places) == count
        apart = np.linalg.norm(places[:, None] - places, axis=2)
        steps = (np.arange(count)[:, None] - np.arange(count)) % count
        neighbours = (steps == 1) | (steps == count - 1)
        assert apart[neighbours] == pytest.approx(2.0 * radii[0], abs=EXACTLY), count
        assert apart[(steps != 0) & ~neighbours].min() > 2.0 * radii[0] - EXACTLY, count
        assert [depth_inside(robot, p) for p in places] == pytest.approx(radii)
        x, y = places[[*range(count), 0]].T
        turns = np.diff(np.unwrap(np.arctan2(y, x)))
        assert np.all(turns < 0.0)  # clockwise
        assert turns.sum() == pytest.approx(-2.0 * math.pi)  # once


def test_circumferential_wheels_are_counted_along_belt_travel_from_the_lower_rear() -> None:
    robot = ROBOT.with_track(c2d.CircumferentialWheels(24))
    (x, y), radius = centers(robot).T, robot.wheels()["radius"][0]
    assert (x[0], y[0]) == pytest.approx((-0.5 * OUTLINE.axle_distance, radius - 0.064), abs=1e-12)
    assert x[1] < x[0]
    turns = np.unwrap(np.arctan2(y, x))
    assert np.all(np.diff(turns) < 0.0)  # clockwise
    assert x[-1] > x[0]
    assert y[-1] == pytest.approx(y[0])
    assert robot.wheels()["body"].tolist() == list(range(24))
    assert robot.wheels()["body"].dtype == np.int64


def test_on_a_tapered_outline_the_first_wheel_sits_where_the_lower_run_ends() -> None:
    robot = TAPERED.with_track(c2d.CircumferentialWheels(24))
    o, radius = TAPERED.outline, robot.wheels()["radius"][0]
    lean = math.acos((o.rear_radius - o.front_radius) / o.axle_distance)
    way = o.rear_radius - radius
    expected = (-0.5 * o.axle_distance + way * math.cos(lean), -way * math.sin(lean))
    assert tuple(centers(robot)[0]) == pytest.approx(expected, abs=1e-12)


@pytest.mark.parametrize(
    ("robot", "count", "largest"),
    [*((ROBOT, count, 0.032) for count in (3, 4, 12, 13)), (TAPERED, 19, 0.025)],
)
def test_tight_wheels_larger_than_half_the_outline_are_refused(
    robot: c2d.Robot, count: int, largest: float
) -> None:
    error = refusal(ring(robot, count))
    assert error.path == "robot.track.count"
    assert error.rule == (
        f"must be larger: so few wheels would have to exceed {largest} m, half the outline's"
        " radius, to touch; give wheel_radius for spaced ones"
    )
    Scenario(ring(robot, count, largest), c2d.terrains.flat()).validate()


@pytest.mark.parametrize("radius", [0.05, 0.0500001, 0.064, 1.0])
def test_circumferential_wheels_are_smaller_than_the_smaller_end(radius: float) -> None:
    error = refusal(TAPERED.with_track(c2d.CircumferentialWheels(12, wheel_radius=radius)))
    assert error.path == "robot.track.wheel_radius"
    assert error.rule == "must be below the smaller radius of the outline, 0.05 m"


def test_a_line_of_wheels_tapers_with_the_outline() -> None:
    wheels = TAPERED.with_track(c2d.LineOfWheels(4)).wheels()
    assert wheels["radius"] == pytest.approx([0.08, 0.07, 0.06, 0.05])
    assert wheels["x"] == pytest.approx(OUTLINE.axle_distance * np.array([-3, -1, 1, 3]) / 6)
    assert wheels["y"].tolist() == [0.0] * 4
    assert set(TAPERED.with_track(c2d.LineOfWheels(4, wheel_radius=0.03)).wheels()["radius"]) == {
        0.03
    }


def test_hybrid_wheels_sit_where_they_are_placed() -> None:
    wheels = ROBOT.with_track(c2d.HybridWheels(PLACEMENTS)).wheels()
    assert np.column_stack([wheels["x"], wheels["y"], wheels["radius"]]).tolist() == PLACEMENTS


@pytest.mark.parametrize("fraction", [0.0, 1.0 / 3.0, 0.5, 1.0])
@pytest.mark.parametrize(
    "model",
    [
        lambda wheel: c2d.LineOfWheels(4, wheel=wheel),
        lambda wheel: c2d.CircumferentialWheels(14, wheel=wheel),
        lambda wheel: c2d.HybridWheels(PLACEMENTS, wheel=wheel),
    ],
    ids=["line", "circumferential", "hybrid"],
)
def test_wheel_n_starts_ahead_by_its_share_of_n_grousers(model: Any, fraction: float) -> None:
    wheel = c2d.GearWheel(grouser_count=9, phase_fraction=fraction)
    theta = 2.0 * math.pi / 9
    for n, gear in enumerate(gears(ROBOT.with_track(model(wheel))), start=1):
        x, y = gear["outline"][ARC_POINTS : ARC_POINTS + 2].mean(axis=0)  # tip of the first grouser
        beyond = (math.atan2(y, x) - fraction * theta * n) / theta
        assert beyond == pytest.approx(round(beyond), abs=1e-9)


# What the wheels weigh


MODELS: dict[str, Any] = {
    "line": c2d.LineOfWheels(5),
    "circumferential": c2d.CircumferentialWheels(24),
    "hybrid": c2d.HybridWheels(PLACEMENTS),
    "free wheels": c2d.ForceTrack(support="wheels", wheel_count=4),
    "line of gears": c2d.LineOfWheels(3, wheel=c2d.GearWheel()),
    "circumferential gears": c2d.CircumferentialWheels(24, wheel=GEAR),
    "hybrid gears": c2d.HybridWheels(PLACEMENTS, wheel=c2d.GearWheel()),
}


@pytest.mark.parametrize("name", MODELS)
def test_the_wheels_together_turn_like_the_track(name: str) -> None:
    wheels = ROBOT.with_track(MODELS[name]).wheels()
    at_surface = wheels["moment_of_inertia"] / wheels["radius"] ** 2
    assert at_surface == pytest.approx(ROBOT.track_mass / len(wheels))


@pytest.mark.parametrize("name", ["line", "circumferential", "hybrid", "free wheels"])
def test_a_round_wheel_is_a_uniform_disc(name: str) -> None:
    wheels = ROBOT.with_track(MODELS[name]).wheels()
    radius = wheels["radius"]
    assert wheels["area"] == pytest.approx(math.pi * radius**2)
    assert 0.5 * wheels["mass"] * radius**2 == pytest.approx(wheels["moment_of_inertia"])


@pytest.mark.parametrize("name", ["line of gears", "circumferential gears", "hybrid gears"])
def test_a_gear_is_as_large_and_heavy_as_its_outline(name: str) -> None:
    robot = ROBOT.with_track(MODELS[name])
    wheels = robot.wheels()
    for index, gear in enumerate(gears(robot)):
        a = gear["outline"]
        b = np.roll(a, -1, axis=0)
        cross = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
        area = 0.5 * cross.sum()
        polar = (cross * ((a * a).sum(1) + (a * b).sum(1) + (b * b).sum(1))).sum() / 12.0
        # The polygon cuts each root arc short by 11 segments of a circle.
        (root, radius), arcs = np.sort(np.hypot(*a[:2].T)), len(a) // (ARC_POINTS + 2)
        arc = 2.0 * math.asin(0.5 * np.linalg.norm(a[1] - a[0]) / root)
        missing = arcs * (ARC_POINTS - 1) * 0.5 * root**2 * (arc - math.sin(arc))
        assert radius == pytest.approx(root)
        assert wheels["area"][index] == pytest.approx(area + missing, rel=1e-9)
        mass = wheels["moment_of_inertia"][index] * area / polar
        assert wheels["mass"][index] == pytest.approx(mass, rel=1e-3)


@pytest.mark.parametrize("track", [c2d.BeltTrack(), c2d.ForceTrack()], ids=["belt", "skids"])
def test_a_model_without_wheels_lists_none(track: Any) -> None:
    wheels = ROBOT.with_track(track).wheels()
    assert len(wheels) == 0
    assert list(wheels) == ["body", "x", "y", "radius", "area", "mass", "moment_of_inertia"]


def test_a_robot_that_breaks_a_rule_has_no_wheels() -> None:
    with pytest.raises(c2d.ScenarioError) as caught:
        ROBOT.with_track(c2d.LineOfWheels(1)).wheels()
    assert caught.value.path == "robot.track.count"


def test_the_wheels_of_a_slow_a_fast_or_a_huge_robot_are_listed() -> None:
    for speed in (0.01, 1.39, 50.0):
        robot = dataclasses.replace(
            ROBOT.with_track(c2d.LineOfWheels(2, wheel_radius=0.001)),
            drivetrain=dataclasses.replace(ROBOT.drivetrain, max_speed=speed),
        )
        assert len(robot.wheels()) == 2
    huge = c2d.Robot.simple(1e3, axle_distance=100.0, radius=50.0, track=c2d.LineOfWheels(2))
    assert huge.wheels()["x"].tolist() == [-50.0, 50.0]
