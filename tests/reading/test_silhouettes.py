"""Collision shapes in side view, in the frame of the chassis."""

from pathlib import Path

import numpy as np
import pytest

import crawler2d as c2d
from tests.reading.carts import ROBOTS, WHEELS, collision, quietly, read, urdf


def outlines(reading: c2d.Reading, link: str) -> list[np.ndarray[tuple[int, int]]]:
    return [each.outline for each in reading.silhouettes if each.link == link]


def test_a_wheel_is_a_circle_round_its_axle(tmp_path: Path) -> None:
    reading = read(tmp_path, urdf(WHEELS))
    (front,) = outlines(reading, "left_front")
    radii = np.hypot(*(front - (0.2, 0.0)).T)
    assert radii == pytest.approx(0.08, abs=1e-6)
    assert len(front) == 64
    where = {each.link: str(each.at) for each in reading.silhouettes}
    assert where["left_front"].startswith("cart.urdf:")


def test_shapes_are_in_the_frame_of_the_chassis(tmp_path: Path) -> None:
    """It is midway between the end axles, wherever the origin of the model is."""
    moved = WHEELS.replace('xyz="0.2 ', 'xyz="0.5 ').replace('xyz="-0.2 ', 'xyz="0.1 ')
    box = collision('<box size="0.2 0.1 0.04"/>', '<origin xyz="0.3 0 0.05"/>')
    reading = read(tmp_path, urdf(moved, shapes=box))
    (corners,) = outlines(reading, "hull")
    assert sorted(map(tuple, corners.round(6).tolist())) == [
        (-0.1, 0.03),
        (-0.1, 0.07),
        (0.1, 0.03),
        (0.1, 0.07),
    ]


def test_backwards_is_mirrored(tmp_path: Path) -> None:
    box = collision('<box size="0.1 0.1 0.1"/>', '<origin xyz="0.1 0 0.1"/>')
    ahead, back = (
        outlines(read(tmp_path, urdf(WHEELS, shapes=box), forward=each), "hull")[0]
        for each in ("+x", "-x")
    )
    assert ahead.mean(axis=0) == pytest.approx((0.1, 0.1))
    assert back.mean(axis=0) == pytest.approx((-0.1, 0.1))


def test_an_unread_mesh_has_no_silhouette(tmp_path: Path) -> None:
    mesh = collision('<mesh filename="nowhere.stl"/>')
    reading = read(tmp_path, urdf(WHEELS, shapes=mesh), mesh="leave_out")
    assert outlines(reading, "hull") == []


def test_wheels_lie_on_those_of_the_robot() -> None:
    """Of a public model with flippers, all joints at zero."""
    reading = quietly(ROBOTS / "absolem.sdf")
    table = reading.robot.wheels()
    middles = np.array([each.outline.mean(axis=0) for each in reading.silhouettes])
    for x, y in zip(table["x"], table["y"], strict=True):
        assert np.hypot(*(middles - (x, y)).T).min() < 1e-3  # the file rounds its places
