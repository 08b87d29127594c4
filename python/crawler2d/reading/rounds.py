"""What can carry a robot on: wheels on joints that turn, and links whose surface a plugin moves."""

from __future__ import annotations

import math

import numpy as np

from crawler2d.models.poses import Array
from crawler2d.models.tree import Shape, Tree

__all__ = [
    "PARALLEL",
    "below",
    "is_parallel",
    "plane_across",
    "radius_about",
]

PARALLEL = 0.05
"""[rad] Axes within this angle count as parallel: files have 3.1415 for pi, and toe-in."""

# A wheel sits on its axis, but for the rounding of files: a share of its radius.
_OFF_AXIS = 0.02
# The hull of a mesh counts as round if its silhouette nowhere falls short by more than this share.
_OUT_OF_ROUND = 0.05
_DIRECTIONS = np.linspace(0.0, 2.0 * math.pi, 64, endpoint=False)


def below(tree: Tree) -> dict[str, list[str]]:
    """Return the links that hang on each link, itself first."""
    found: dict[str, list[str]] = {link.name: [link.name] for link in tree.links}
    for link in reversed(tree.links):  # children before their parents
        joint = tree.joints.get(link.name)
        if joint is not None:
            found[joint.parent].extend(found[link.name])
    return found


def is_parallel(first: Array, second: Array) -> bool:
    """Whether two directions lie along one line."""
    return bool(np.linalg.norm(np.cross(first, second)) <= math.sin(PARALLEL))


def radius_about(shape: Shape, point: Array, axis: Array) -> float | None:
    """[m] Return the radius of a shape that is round about an axis; None if it is not."""
    if shape.kind == "hull":
        return _radius_of_hull(shape, point, axis)
    if shape.kind not in ("cylinder", "capsule", "sphere"):
        return None
    if shape.kind != "sphere" and not is_parallel(shape.axis, axis):
        return None
    offset = float(np.linalg.norm(np.cross(shape.pose.place - point, axis)))
    return shape.radius if offset <= _OFF_AXIS * shape.radius else None


def plane_across(axis: Array) -> Array:
    """Return two directions at right angles to an axis and to each other, shape (3, 2)."""
    seed = np.eye(3)[int(np.argmin(np.abs(axis)))]
    first = np.cross(axis, seed)
    first /= np.linalg.norm(first)
    return np.stack([first, np.cross(axis, first)], axis=1)


def _radius_of_hull(shape: Shape, point: Array, axis: Array) -> float | None:
    flat = (shape.points - point) @ plane_across(axis)
    reach = (flat @ np.stack([np.cos(_DIRECTIONS), np.sin(_DIRECTIONS)])).max(axis=0)
    largest = float(reach.max())
    return largest if reach.min() >= (1.0 - _OUT_OF_ROUND) * largest > 0.0 else None
