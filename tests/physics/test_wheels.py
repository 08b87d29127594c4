"""The wheels of a track model: positions, initial angles and masses."""

import dataclasses
import math
from typing import Any

import numpy as np
import pytest

import crawler2d as c2d
from crawler2d import _core
from crawler2d.parameters.scenario import Scenario
from tests.shared import GEAR, PLACEMENTS, ROBOT, refusal, with_flippers

OUTLINE = ROBOT.outline
TAPERED = dataclasses.replace(
    ROBOT, outline=dataclasses.replace(OUTLINE, front_radius=0.05, rear_radius=0.08)
)
# Points of a root arc in the outlines of `_core.geometry`.
ARC_POINTS = 12


def gears(robot: c2d.Robot) -> list[Any]:
    """[m] Outlines of the gear wheels."""
    bodies = _core.geometry(Scenario(robot, c2d.terrains.flat()).to_json())["bodies"]
    kinds, outlines = bodies["kind"], bodies["outline"]
    return [o for kind, o in zip(kinds, outlines, strict=True) if kind == c2d.BodyKind.WHEEL]


def of_one_side(robot: c2d.Robot) -> dict[str, np.ndarray[Any, Any]]:
    """The wheels of the left side; those of the right are alike."""
    wheels = robot.wheels()
    return {name: column[wheels["side"] == "left"] for name, column in wheels.items()}


def centers(robot: c2d.Robot) -> np.ndarray[Any, Any]:
    wheels = of_one_side(robot)
    return np.column_stack([wheels["x"], wheels["y"]])


# Positions


def depth_inside(robot: c2d.Robot, point: np.ndarray[Any, Any]) -> float:
    """[m] Distance of a point from the outline: the least over all candidate normals."""
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
    """[m] Position of a wheel at a fraction of the path: rear arc, top, front arc, lower run."""
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
        assert of_one_side(wheels)["radius"].tolist() == [radius] * count
        assert [depth_inside(robot, p) for p in places] == pytest.approx([radius] * count)


@pytest.mark.parametrize(("robot", "least"), [(ROBOT, 14), (TAPERED, 20)], ids=["even", "tapered"])
def test_tight_wheels_touch_their_neighbours_and_nobody_else(robot: c2d.Robot, least: int) -> None:
    for count in range(least, 41):
        wheels = ring(robot, count)
        places, radii = centers(wheels), of_one_side(wheels)["radius"]
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
    assert robot.wheels()["body"].tolist() == [*range(24), *range(24)]
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
        f"must be larger: to touch each other, so few wheels would need a radius above {largest} m,"
        " half the outline's (give wheel_radius to space them instead)"
    )
    Scenario(ring(robot, count, largest), c2d.terrains.flat()).validate()


@pytest.mark.parametrize("radius", [0.05, 0.0500001, 0.064, 1.0])
def test_circumferential_wheels_are_smaller_than_the_smaller_end(radius: float) -> None:
    error = refusal(TAPERED.with_track(c2d.CircumferentialWheels(12, wheel_radius=radius)))
    assert error.path == "robot.track.wheel_radius"
    assert error.rule == "must be less than the smaller radius of the outline, 0.05 m"


def test_a_line_of_wheels_tapers_with_the_outline() -> None:
    wheels = of_one_side(TAPERED.with_track(c2d.LineOfWheels(4)))
    assert wheels["radius"] == pytest.approx([0.08, 0.07, 0.06, 0.05])
    assert wheels["x"] == pytest.approx(OUTLINE.axle_distance * np.array([-3, -1, 1, 3]) / 6)
    assert wheels["y"].tolist() == [0.0] * 4
    assert set(TAPERED.with_track(c2d.LineOfWheels(4, wheel_radius=0.03)).wheels()["radius"]) == {
        0.03
    }


def test_hybrid_wheels_sit_where_they_are_placed() -> None:
    wheels = of_one_side(ROBOT.with_track(c2d.HybridWheels(PLACEMENTS)))
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
        x, y = gear[ARC_POINTS : ARC_POINTS + 2].mean(axis=0)  # tip of the first grouser
        beyond = (math.atan2(y, x) - fraction * theta * n) / theta
        assert beyond == pytest.approx(round(beyond), abs=1e-9)


@pytest.mark.parametrize(
    ("radius", "height", "count"),
    [(0.064, 0.012, 7), (0.05, 0.012, 8), (0.03, 0.0075, 8), (0.1, 0.012, 12)],
)
def test_a_gear_takes_its_grousers_from_the_robot(radius: float, height: float, count: int) -> None:
    track = c2d.LineOfWheels(2, wheel_radius=radius, wheel=c2d.GearWheel())
    outline = gears(ROBOT.with_track(track))[0]
    distance = np.hypot(*outline.T)
    assert len(outline) == count * (ARC_POINTS + 2)
    assert distance.max() == pytest.approx(radius, rel=1e-12)
    assert distance.min() == pytest.approx(radius - height, rel=1e-12)


# Masses


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
    for index, a in enumerate(gears(robot)):
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


@pytest.mark.parametrize("name", MODELS)
def test_both_sides_are_listed_and_are_alike(name: str) -> None:
    wheels = ROBOT.with_track(MODELS[name]).wheels()
    half = len(wheels) // 2
    assert wheels["side"].tolist() == ["left"] * half + ["right"] * half
    assert set(wheels["carrier"]) == {"chassis"}
    for column in set(wheels) - {"side"}:
        assert wheels[column][:half].tolist() == wheels[column][half:].tolist()
    # The circulating mass of both sides together.
    circulating = (wheels["moment_of_inertia"] / wheels["radius"] ** 2).sum()
    assert circulating == pytest.approx(ROBOT.track_mass)


@pytest.mark.parametrize("ends", ["front", "rear", "both"])
@pytest.mark.parametrize("arms", [None, c2d.LineOfWheels(4, wheel=GEAR)], ids=["own", "gears"])
@pytest.mark.parametrize("track", [c2d.LineOfWheels(5), c2d.BeltTrack()], ids=["line", "belt"])
def test_the_wheels_of_flippers_are_listed(ends: str, arms: Any, track: Any) -> None:
    robot = with_flippers(track, arms, ends)
    flippers, wheels = robot.flippers, robot.wheels()
    assert flippers is not None
    there = [end for end in ("front", "rear") if ends in (end, "both")]
    on_arms = arms if arms is not None else track
    count = getattr(on_arms, "count", 0)
    of_chassis = getattr(track, "count", 0)
    carriers = ["chassis"] * of_chassis + [f"{e} flipper" for e in there for _ in range(count)]
    assert wheels["carrier"].tolist() == 2 * carriers
    bodies = {part for part, kind in bodies_of(robot).items() if kind == WHEEL}
    assert bodies <= set(wheels["body"].tolist())
    for end in there if count else []:
        of_arm = wheels["carrier"] == f"{end} flipper"
        assert of_arm.sum() == 2 * count
        sign = 1.0 if end == "front" else -1.0
        pivot = np.array([0.5 * sign * OUTLINE.axle_distance, 0.0])
        along = np.array([sign * math.cos(flippers.angle), math.sin(flippers.angle)])
        places = np.column_stack([wheels["x"], wheels["y"]])[of_arm] - pivot
        ways = np.sort(places @ along)[::2]
        assert ways == pytest.approx(np.linspace(0.0, flippers.length, count), abs=1e-12)
        assert places @ [along[1], -along[0]] == pytest.approx(0.0, abs=1e-12)
        at_root = wheels["radius"][of_arm][np.argmin(places @ along)]
        assert at_root == pytest.approx(flippers.root_radius)
        # A tenth of both arms at this end.
        circulating = (wheels["moment_of_inertia"] / wheels["radius"] ** 2)[of_arm].sum()
        assert circulating == pytest.approx(0.1 * 2.0 * flippers.mass)


WHEEL = 0


def bodies_of(robot: c2d.Robot) -> dict[int, int]:
    """Kinds of the bodies that touch the ground while arms swing down and up."""
    run = c2d.simulate(
        robot, c2d.terrains.flat(), drive=c2d.Drive(speed=0.0, gait=c2d.Hold(-0.5)), duration=1.5
    )
    contacts = run.contacts
    return dict(zip(contacts["body"].tolist(), contacts["body_kind"].tolist(), strict=True))


@pytest.mark.parametrize(
    "track",
    [c2d.BeltTrack(), c2d.ForceTrack(), c2d.SegmentalTrack(mechanism="sprocket")],
    ids=["belt", "skids", "chain"],
)
def test_a_model_without_wheels_lists_none(track: Any) -> None:
    wheels = ROBOT.with_track(track).wheels()
    assert len(wheels) == 0
    names = "side carrier body x y radius area mass moment_of_inertia"
    assert list(wheels) == names.split()


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
        assert len(robot.wheels()) == 4
    huge = c2d.Robot.simple(1e3, axle_distance=100.0, radius=50.0, track=c2d.LineOfWheels(2))
    assert huge.wheels()["x"].tolist() == [-50.0, 50.0, -50.0, 50.0]
