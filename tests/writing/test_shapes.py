"""Gear wheels, belts and bellies of a file have the same outlines as in side view."""

import dataclasses
import json
from typing import Any

import numpy as np
import pytest

import crawler2d as c2d
from crawler2d import _core
from crawler2d.drawings.scene import Scene
from crawler2d.model_tree import Shape, Tree
from crawler2d.writing.carriers import Format, across_of
from crawler2d.writing.formats import MJCF, SDF
from crawler2d.writing.model import model_of
from tests.shared import GEAR
from tests.writing.drawn import drawn

TAPERED = c2d.GearWheel(grouser_count=7, base_thickness=0.02, tip_thickness=0.004)


def tree_of(robot: c2d.Robot, target: Format = SDF) -> Tree:
    text = robot._at_rest()
    plain = json.loads(text)["robot"]
    return model_of(plain, text, across_of(plain["gauge"], None, None), friction=1.0, target=target)


def depth_in(shape: Shape, points: np.ndarray) -> np.ndarray:
    """[m] Depth of points of the side view in a shape; negative outside."""
    if shape.kind == "cylinder":
        off = points - shape.pose.place[[0, 2]]
        return np.asarray(shape.radius - np.hypot(*off.T))
    if shape.kind == "box":
        off = (points - shape.pose.place[[0, 2]]) @ shape.pose.turn[np.ix_([0, 2], [0, 2])]
        return np.asarray((0.5 * shape.size[[0, 2]] - np.abs(off)).min(axis=1))
    flat = shape.points[: len(shape.points) // 2][:, [0, 2]]
    edges = np.roll(flat, -1, axis=0) - flat
    normals = np.stack([-edges[:, 1], edges[:, 0]], axis=1) / np.hypot(*edges.T)[:, None]
    depths = np.einsum("pec,ec->pe", points[:, None, :] - flat[None], normals)
    return np.asarray(depths.min(axis=1))


def deepest(shapes: tuple[Shape, ...], points: np.ndarray) -> np.ndarray:
    return np.asarray(np.max([depth_in(shape, points) for shape in shapes], axis=0))


def dense(polygon: np.ndarray) -> np.ndarray:
    """Points along a polygon, including its corners."""
    shares = np.linspace(0.0, 1.0, 20, endpoint=False)[:, None]
    ends = zip(polygon, np.roll(polygon, -1, axis=0), strict=True)
    return np.concatenate([a + shares * (b - a) for a, b in ends])


@pytest.mark.parametrize("wheel", [c2d.GearWheel(), c2d.GearWheel(grouser_count=5), TAPERED, GEAR])
def test_a_gear_wheel_has_its_exact_outline(wheel: c2d.GearWheel) -> None:
    robot = c2d.robots.engineer(flippers=None, track=c2d.LineOfWheels(3, wheel=wheel))
    tree = tree_of(robot, MJCF)
    bodies = _core.geometry(robot._at_rest())["bodies"]
    wheels = robot.wheels()
    for number in range(3):
        link = tree.by_name[f"left_wheel_{number}"]
        outline = np.array(bodies["outline"][number])
        center = np.array([wheels["x"][number], wheels["y"][number]])
        # Chords of the arcs are a little inside the root circle, by at most 0.3 % of its radius.
        inside = deepest(link.shapes, center + dense(outline))
        assert wheel.grouser_count in (None, len(link.shapes) - 1)
        assert inside.min() > -1e-9
        assert inside.max() < 3e-3 * wheels["radius"][number]
        assert deepest(link.shapes, center + 1.01 * dense(outline)).max() < 0.0


@pytest.mark.parametrize("number", range(10))
def test_a_belt_has_its_exact_outline(number: int) -> None:
    of: Any = [c2d.BeltTrack(), c2d.ClosedTrack(c2d.CircumferentialWheels(18))][number % 2]
    robot = drawn(number).without_flippers().with_track(of)
    tree = tree_of(robot)
    (carrier,) = _core.geometry(robot._at_rest())["carriers"]
    envelope = np.array(carrier["envelope"])
    inside = deepest(tree.by_name["left_track"].shapes, dense(envelope))
    assert inside.min() > -1e-9
    assert inside.max() < 1e-3 * robot.outline.rear_radius  # chords of arcs
    middle = envelope.mean(axis=0)
    beyond = middle + 1.01 * (dense(envelope) - middle)
    assert deepest(tree.by_name["left_track"].shapes, beyond).max() < 0.0


@pytest.mark.parametrize("number", range(20))
def test_boxes_stay_within_the_belly(number: int) -> None:
    robot = drawn(number)
    if robot.belly is None:
        return
    corners = np.array(robot.belly)
    middle = corners.mean(axis=0)
    shapes = tree_of(robot).links[0].shapes
    beyond = middle + 1.001 * (dense(corners) - middle)
    assert deepest(shapes, beyond).max() < 1e-9
    assert deepest(shapes, middle[None]).max() > 0.0


@pytest.mark.parametrize("number", range(20))
def test_every_link_has_a_possible_inertia(number: int) -> None:
    for link in tree_of(drawn(number)).links:
        small, middle, large = np.linalg.eigvalsh(link.inertia)
        assert link.mass > 0.0
        assert small > 0.0
        assert small + middle > large * (1.0 + 1e-9)


def test_wheels_are_hoops_only_where_uniform_ones_leave_no_chassis() -> None:
    wheels = c2d.LineOfWheels(4)
    light = c2d.Robot.simple(10.0, axle_distance=0.4, radius=0.08, track=wheels)
    rows = light.wheels()
    assert tree_of(light).by_name["left_wheel_0"].mass == pytest.approx(rows["mass"][0])
    heavy = dataclasses.replace(light, track_mass=6.0)
    hoop = heavy.wheels()["moment_of_inertia"][0] / 0.08**2
    assert tree_of(heavy).by_name["left_wheel_0"].mass == pytest.approx(hoop)


def test_gear_wheels_of_a_raised_flipper_are_turned_as_the_core_turns_them() -> None:
    robot = c2d.robots.engineer(track=c2d.LineOfWheels(3, wheel=c2d.GearWheel(grouser_count=5)))
    text = robot._at_rest()
    scene = Scene.of_robot(text)
    tree = tree_of(robot)
    for number in range(3):
        outline = dense(scene.outline(3 + number, 0)[:-1])
        shapes = tree.by_name[f"front_left_flipper_wheel_{3 + number}"].shapes
        inside = deepest(shapes, outline)
        assert inside.min() > -1e-9
        assert inside.max() < 1e-3


def test_grousers_below_rounding_are_left_out() -> None:
    wheel = c2d.GearWheel(grouser_count=12, grouser_height=1e-13, tip_thickness=0.004)
    robot = c2d.robots.engineer(flippers=None, track=c2d.LineOfWheels(3, wheel=wheel))
    (shape,) = tree_of(robot).by_name["left_wheel_0"].shapes
    assert shape.kind == "cylinder"
    assert shape.radius == pytest.approx(0.064)


def test_a_belt_round_three_discs_is_written_with_a_drum_on_each() -> None:
    robot = c2d.robots.engineer(flippers=None)
    discs = [*robot.outline.discs, (0.28, 0.08, 0.04)]
    raised = dataclasses.replace(
        robot,
        outline=c2d.TrackOutline(
            discs=discs,
            grouser_height=robot.outline.grouser_height,
            grouser_pitch=robot.outline.grouser_pitch,
            grouser_thickness=robot.outline.grouser_thickness,
        ),
    )
    (track,) = (link for link in tree_of(raised).links if link.name == "left_track")
    drums = [shape for shape in track.shapes if shape.kind == "cylinder"]
    found = [(*track.pose.then(drum.pose).place[[0, 2]], drum.radius) for drum in drums]
    assert np.allclose(sorted(found), sorted(discs))
