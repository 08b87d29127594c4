"""benches/peers: its scenes are our scenarios peer_*.json, and its geometry judges rightly."""

import math
from pathlib import Path
from typing import Any, cast

import numpy as np
import pytest

from benches.adapters.own import Crawler2D
from benches.adapters.planar import SCENES, Motion, Scene, load_scene
from benches.peers.accuracy import deepest_overlap, joint_gap
from crawler2d import _core
from crawler2d.parameters.scenario import Scenario

SCENARIOS = Path(__file__).parents[1] / "scenarios"
# Both are written with all digits; the rest is rounding of their generators.
RELATIVE, ABSOLUTE = 1e-9, 1e-12
# [m] Corners: grouser heights and thicknesses in the scenarios are rounded to this.
CORNER = 1e-9

every_scene = pytest.mark.parametrize("name", SCENES)


def pair(name: str) -> tuple[Scene, Scenario]:
    text = (SCENARIOS / f"peer_{name.replace('-', '_')}.json").read_text(encoding="utf-8")
    return load_scene(name), Scenario.from_json(text)


def near(value: Any) -> Any:
    return pytest.approx(value, rel=RELATIVE, abs=ABSOLUTE)


def by_place(points: Any) -> np.ndarray[Any, Any]:
    """Sort points, shape (n, 2), by x and y, with equal ones adjacent despite rounding."""
    points = np.asarray(points, float)
    return np.asarray(points[np.lexsort(np.round(points, 9).T)])


def left_wheels(scenario: Scenario) -> dict[str, np.ndarray[Any, Any]]:
    """The wheels of one side; those of a scene combine both sides."""
    wheels = scenario.robot.wheels()
    return {name: column[wheels["side"] == "left"] for name, column in wheels.items()}


def wheel_order(scene: Scene, scenario: Scenario) -> list[int]:
    """The scenario's wheel at each of the scene's joints."""
    wheels = left_wheels(scenario)
    centers = np.column_stack([wheels["x"], wheels["y"]])
    return [int(np.hypot(*(centers - joint.pa).T).argmin()) for joint in scene.joints]


@every_scene
def test_mass_and_inertia_are_the_same(name: str) -> None:
    scene, scenario = pair(name)
    robot, (chassis, *wheels) = scenario.robot, scene.bodies
    mass = sum(body.mass for body in scene.bodies)
    offsets = np.array([(body.x - chassis.x, body.y - chassis.y) for body in wheels])
    masses = np.array([body.mass for body in wheels])
    assert mass == near(robot.mass)
    center = masses @ offsets / mass
    assert center == near(np.array(robot.center_of_mass))
    inertia = sum(body.inertia for body in scene.bodies) + masses @ (offsets**2).sum(1)
    assert inertia - mass * center @ center == near(robot.moment_of_inertia)
    assert [body.inertia for body in wheels] == near(
        2.0 * left_wheels(scenario)["moment_of_inertia"]
    )


@every_scene
def test_wheels_sit_at_the_same_places(name: str) -> None:
    scene, scenario = pair(name)
    wheels, order = left_wheels(scenario), wheel_order(scene, scenario)
    assert sorted(order) == list(range(len(wheels["x"])))
    assert [joint.pa for joint in scene.joints] == [
        near((float(wheels["x"][i]), float(wheels["y"][i]))) for i in order
    ]
    assert all(joint.pb == (0.0, 0.0) for joint in scene.joints)
    for joint in scene.joints:
        chassis, wheel = scene.bodies[joint.a], scene.bodies[joint.b]
        assert (wheel.x - chassis.x, wheel.y - chassis.y) == near(joint.pa)
        assert wheel.angle == chassis.angle == 0.0


@every_scene
def test_motors_have_the_same_speed_and_limit(name: str) -> None:
    scene, scenario = pair(name)
    robot, outline = scenario.robot, scenario.robot.outline
    radii = left_wheels(scenario)["radius"]
    # Both sprockets act at the belt radius, and each wheel has its share of that force.
    force = 2.0 * robot.drivetrain.max_torque / (outline.rear_radius - outline.grouser_height)
    for joint, wheel in zip(scene.joints, wheel_order(scene, scenario), strict=True):
        assert -joint.speed * radii[wheel] == near(scenario.drive.speed)
        assert joint.torque == near(force / len(scene.joints) * radii[wheel])


@every_scene
def test_wheels_have_the_same_outline(name: str) -> None:
    scene, scenario = pair(name)
    wheel = scene.bodies[1]
    radius = left_wheels(scenario)["radius"][0]
    if not wheel.polygons:
        assert wheel.radius == near(radius)
        return
    outline = _core.geometry(scenario.to_json())["bodies"]["outline"][0]
    grouser = cast("Any", scenario.robot.track).wheel
    assert wheel.radius == near(radius - grouser.grouser_height)
    # The corners of the tips; the scene's bases lie within the root circle.
    tips = [
        corner for part in wheel.polygons for corner in part if math.hypot(*corner) > wheel.radius
    ]
    of_outline = outline[np.hypot(*outline.T) > radius - 1e-6]
    assert by_place(tips) == pytest.approx(by_place(of_outline), abs=CORNER)
    # Where the flanks meet the root circle.
    first = min(wheel.polygons, key=lambda part: abs(math.atan2(*part.mean(axis=0)[::-1])))
    assert 2.0 * root_half_thickness(first, wheel.radius) == pytest.approx(
        grouser.base_thickness, abs=CORNER
    )


def root_half_thickness(grouser: np.ndarray[Any, Any], radius: float) -> float:
    """[m] Half the thickness of a grouser along +x where its flank leaves the root circle."""
    upper = grouser[grouser[:, 1] > 0.0]
    (x0, y0), (x1, y1) = upper[upper[:, 0].argsort()]
    slope = (y1 - y0) / (x1 - x0)
    # |(x, y0 + slope (x - x0))| = radius
    offset = y0 - slope * x0
    half = slope * offset / (1.0 + slope**2)
    x = -half + math.sqrt(half**2 + (radius**2 - offset**2) / (1.0 + slope**2))
    return float(offset + slope * x)


@every_scene
def test_the_belly_is_the_chassis(name: str) -> None:
    scene, scenario = pair(name)
    (polygon,) = scene.bodies[0].polygons
    assert scenario.robot.belly is not None
    assert by_place(polygon) == near(by_place(scenario.robot.belly))


@every_scene
def test_the_ground_is_the_same(name: str) -> None:
    scene, scenario = pair(name)
    terrain = cast("Any", scenario.terrain)
    assert scene.profile() == pytest.approx(np.array(terrain.points), abs=1e-12)
    assert scene.friction == terrain.friction
    assert terrain.edge_radius == 0.0
    assert scenario.gravity == 9.81


@every_scene
def test_the_robot_starts_at_the_same_distance(name: str) -> None:
    scene, scenario = pair(name)
    chassis = scene.bodies[0]
    outline, first_edge = scenario.robot.outline, scene.profile()[1, 0]
    foremost = chassis.x + 0.5 * outline.axle_distance + outline.front_radius
    assert first_edge - foremost == near(scenario.start.approach)
    # The scene drops its robot from 2 mm.
    assert chassis.y - outline.front_radius == pytest.approx(0.002, abs=5e-4)


# The geometry that judges every engine


def held(scene: Scene, *poses: tuple[float, float, float]) -> Motion:
    """A motion of one sample: the first bodies in these poses, the rest at their start."""
    rest = [(body.x, body.y, body.angle) for body in scene.bodies[len(poses) :]]
    return Motion.of([0.0], [[*poses, *rest]])


def test_overlap_and_gap_are_those_of_the_poses() -> None:
    scene = load_scene("lwa5-round-step")
    above = (0.0, 0.102, 0.0)
    assert deepest_overlap(scene, held(scene, above)) == 0.0
    assert joint_gap(scene, held(scene, above)) < 1e-12
    sunk = held(scene, above, (-0.3, 0.099, 0.0))
    assert deepest_overlap(scene, sunk) == pytest.approx(0.001)
    assert joint_gap(scene, sunk) == pytest.approx(0.003)
    # Before the face of the step; and with the edge of the step in the belly.
    at_face = held(scene, above, (0.8 - 0.098, 0.13, 0.0))
    assert deepest_overlap(scene, at_face) == pytest.approx(0.002)
    on_edge = held(scene, (0.7, 0.196, 0.0))
    assert deepest_overlap(scene, on_edge) == pytest.approx(0.004)


def test_a_grouser_that_meets_an_edge_is_seen() -> None:
    scene = load_scene("lwa5-gear-step")
    above = (0.0, 0.102, 0.0)
    # A tip, 0.1 m from the centre, level with the edge of the step and 3 mm beyond its face.
    tip = held(scene, above, (0.8 - 0.097, 0.147, 0.0))
    assert deepest_overlap(scene, tip) == pytest.approx(0.003)
    # Between two grousers, down to the root circle.
    turned = held(scene, above, (0.8 - 0.086, 0.2, math.radians(15.0)))
    assert deepest_overlap(scene, turned) == 0.0


def test_a_robot_that_flies_off_has_not_cleared() -> None:
    scene = load_scene("lwa5-round-step")
    driven = [(0.0, 0.102, 0.0), (1.0, 0.252, 0.0), (1.2, 0.252, 0.0)]
    wheels = [(0.0, 0.0, 0.0)] * 5
    assert scene.cleared(Motion.of(range(3), [[pose, *wheels] for pose in driven]))
    assert not scene.cleared(Motion.of(range(2), [[pose, *wheels] for pose in driven[:2]]))
    for wrong in ((1.2, 1.0, 0.0), (100.0, 0.2, 0.0), (math.nan, 0.2, 0.0)):
        flown = [*driven, wrong]
        assert not scene.cleared(Motion.of(range(4), [[pose, *wheels] for pose in flown]))


@pytest.mark.parametrize("name", ["lwa5-gear-step", "cwa24-round-field"])
def test_overlaps_agree_with_those_of_crawler2d(name: str) -> None:
    scene, engine = load_scene(name), Crawler2D()
    motion = engine.record(scene, engine.defaults, 6.0, 1e-3)
    # A gap is followed along its normal of the middle of the step: a corner that closely turns
    # round an edge, 0.2 mm in half a step, is off by some 10 um.
    assert deepest_overlap(scene, motion) == pytest.approx(motion.penetration, abs=2e-5)
    assert joint_gap(scene, motion) < 1e-12
