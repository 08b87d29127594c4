"""The tree that is read equals the one written, for every model that a format can represent."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import crawler2d as c2d
from crawler2d.model_tree import Joint, Link, Shape, Tree
from crawler2d.reading.loading import ReadOptions, load_model
from crawler2d.writing.formats import MJCF, SDF, URDF
from tests.writing.test_checkers import BELTED, WHEELED
from tests.writing.test_engines import TAPERED
from tests.writing.test_round_trip import written
from tests.writing.test_shapes import tree_of

FORMS = {"sdf": SDF, "urdf": URDF, "mjcf": MJCF}
CASES = [
    *(("sdf", each) for each in [*WHEELED.values(), *BELTED.values()]),
    *(("urdf", each) for each in WHEELED.values()),
    *(("mjcf", WHEELED[name]) for name in ("line and flippers", "gears", "drawn 0")),
    *(("mjcf", BELTED[name]) for name in ("belt and flippers", "closed")),
    *(("mjcf", each) for each in TAPERED.values()),
]


def read_again(robot: c2d.Robot, name: str, folder: Path) -> Tree:
    path = written(robot, name, folder, friction=1.0)
    return load_model(path.read_bytes(), path, ReadOptions(mesh="hull")).tree


def close(got: Any, expected: Any, accuracy: float = 1e-9) -> bool:
    return bool(np.allclose(got, expected, rtol=accuracy, atol=accuracy))


def same_shape(got: Shape, expected: Shape) -> None:
    assert got.kind == expected.kind
    if expected.kind == "hull":  # MuJoCo stores corners as float32, in its own order
        away = np.linalg.norm(got.points[:, None] - expected.points[None], axis=2)
        assert away.min(axis=0).max() < 1e-6
        assert away.min(axis=1).max() < 1e-6
    else:
        assert close(got.pose.place, expected.pose.place)
        assert close(got.pose.turn, expected.pose.turn)
        assert close((got.radius, got.length), (expected.radius, expected.length))
        assert close(got.size, expected.size)
    assert got.friction is not None
    assert (got.friction.first, got.friction.second) == (1.0, 1.0)


def same_link(got: Link, expected: Link) -> None:
    assert close(got.pose.place, expected.pose.place)
    assert close(got.pose.turn, expected.pose.turn)
    assert close(got.mass, expected.mass)
    assert close(got.center, expected.center)
    assert close(got.inertia, expected.inertia)
    assert len(got.shapes) == len(expected.shapes)
    for pair in zip(got.shapes, expected.shapes, strict=True):
        same_shape(*pair)


def same_joint(got: Joint, expected: Joint) -> None:
    assert got.kind == expected.kind
    assert got.parent == expected.parent
    if expected.kind == "fixed":
        return
    assert got.name == expected.name
    assert close(got.place, expected.place)
    assert close(got.axis, expected.axis)
    assert close((got.lower, got.upper), (expected.lower, expected.upper))
    assert got.effort == pytest.approx(expected.effort)
    assert got.velocity == pytest.approx(expected.velocity)


@pytest.mark.parametrize(("name", "robot"), CASES)
def test_a_written_model_reads_back_the_same(name: str, robot: c2d.Robot, tmp_path: Path) -> None:
    if name == "mjcf":
        pytest.importorskip("mujoco")
    expected, got = tree_of(robot, FORMS[name]), read_again(robot, name, tmp_path)
    assert set(got.by_name) == set(expected.by_name)
    for link in expected.links:
        same_link(got.by_name[link.name], link)
    assert set(got.joints) == set(expected.joints)
    for child, joint in expected.joints.items():
        same_joint(got.joints[child], joint)


def test_mjcf_keeps_the_speed_of_a_surface(tmp_path: Path) -> None:
    pytest.importorskip("mujoco")
    robot = BELTED["belt"]
    shapes = read_again(robot, "mjcf", tmp_path).by_name["left_track"].shapes
    drums = [shape.surface_speed for shape in shapes if shape.kind == "cylinder"]
    assert drums == pytest.approx([robot.drivetrain.max_speed] * 2)
    assert all(shape.surface_speed > 0.0 for shape in shapes)
