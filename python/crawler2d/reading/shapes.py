"""Collision shapes that SDF and URDF write in the same words."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from crawler2d.models.poses import Pose
from crawler2d.models.tree import Friction, Shape
from crawler2d.reading.elements import Element
from crawler2d.reading.meshes import Meshes

__all__ = ["inertia", "shape_of"]

_AXES = (("ixx", 0, 0), ("ixy", 0, 1), ("ixz", 0, 2), ("iyy", 1, 1), ("iyz", 1, 2), ("izz", 2, 2))

Numbers = Callable[[Element, str, int], list[float]]
"""Reads so many numbers of a name: SDF has them as elements, URDF as attributes."""


def shape_of(
    collision: Element,
    *,
    name: str,
    pose: Pose,
    pose_at: Element,
    friction: Friction | None,
    numbers: Numbers,
    mesh_name: Callable[[Element], str],
    meshes: Meshes,
) -> Shape | None:
    """Read the geometry of a collision; None if it is empty, or a mesh that is to be left out."""
    geometry = collision.needed("geometry")
    kinds = [child for child in geometry.children if child.tag != "empty"]
    if not kinds:
        return None
    if len(kinds) > 1:
        kinds[1].refuse(kinds[1].tag, "must be the only shape of its collision")
    (element,) = kinds
    shape = Shape(
        name=name,
        kind=element.tag,
        pose=pose,
        friction=friction,
        at=collision.where,
        pose_at=pose_at.where,
        size_at=element.where,
    )
    if element.tag == "box":
        return replace(shape, size=np.array(_positive(element, numbers(element, "size", 3))))
    if element.tag == "mesh":
        scale = [1.0, 1.0, 1.0]
        if element.only("scale") is not None or "scale" in element.attributes:
            scale = numbers(element, "scale", 3)
        return meshes.hull(shape, element, mesh_name(element), scale)
    if element.tag not in ("cylinder", "capsule", "sphere"):
        element.refuse(element.tag, "must be a box, cylinder, capsule, sphere or mesh")
    (radius,) = _positive(element, numbers(element, "radius", 1))
    length = 0.0
    if element.tag != "sphere":
        (length,) = _positive(element, numbers(element, "length", 1))
    inner = element.only("radius")
    size_at = element.where if inner is None else inner.where
    return replace(shape, radius=radius, length=length, size_at=size_at)


def _positive(element: Element, sizes: list[float]) -> list[float]:
    for size in sizes:
        if not size > 0.0:
            element.refuse(size, "must have sizes > 0 m")
    return sizes


def inertia(element: Element, value: Callable[[str], float]) -> np.ndarray[tuple[int, int]]:
    """Read a tensor of inertia [kg m^2] by the names of its six components."""
    tensor = np.zeros((3, 3))
    for name, row, column in _AXES:
        tensor[row, column] = tensor[column, row] = value(name)
    if min(tensor[i, i] for i in range(3)) < 0.0:
        element.refuse(float(tensor.diagonal().min()), "must have moments of inertia >= 0 kg m^2")
    return tensor
