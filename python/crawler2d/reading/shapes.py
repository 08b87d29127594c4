"""Collision shapes as SDF and URDF write them, and meshes as the hulls of their corners."""

from __future__ import annotations

import base64
import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field, replace
from pathlib import PurePath
from typing import Literal

import numpy as np

from crawler2d.errors import ScenarioError
from crawler2d.model_tree import Array, Friction, Pose, Shape, Unread
from crawler2d.reading.child import answered
from crawler2d.reading.elements import Element
from crawler2d.reading.files import LARGEST_TOGETHER, Files, why
from crawler2d.reading.log import Doubt

__all__ = [
    "MOST_CORNERS",
    "MeshRule",
    "Meshes",
    "collisions",
    "ellipsoid",
    "inertia",
    "shape_of",
    "solid",
]

MeshRule = Literal["refuse", "hull", "leave_out"]

MOST_CORNERS = 300_000
"""Of all meshes of a model, each corner of a mesh once."""

_KINDS = ("dae", "glb", "gltf", "obj", "stl")
_FARTHEST = 1e6  # [m] as for any number of a model file


@dataclass(slots=True, kw_only=True)
class Meshes:
    """What is done with the meshes of one model.

    Parameters
    ----------
    rule : {"refuse", "hull", "leave_out"}
        As in `read_robot`.
    files : Files
        The files of the model.
    doubts : list of Doubt
        Where shapes that are left out are noted.
    """

    rule: MeshRule
    files: Files
    doubts: list[Doubt] = field(default_factory=list)
    _found: dict[str, Array | str] = field(default_factory=dict)

    def find(self, named: dict[str, Element]) -> None:
        """Read meshes, all at once: the child process has its limits for all of them.

        Parameters
        ----------
        named : dict of str to Element
            By the name of a mesh the first element that names it.

        Raises
        ------
        ImportError
            If a mesh is there, and trimesh is missing.
        """
        if self.rule != "hull":
            return
        data: dict[str, bytes] = {}
        for name, element in named.items():
            if PurePath(name).suffix[1:].lower() not in _KINDS:
                self._found[name] = f"must be a mesh of a kind that is known: {', '.join(_KINDS)}"
                continue
            try:
                data[name] = self.files.read(name, at=element.at, most=LARGEST_TOGETHER)
            except ScenarioError as error:
                self._found[name] = why(error)
        if data:
            self._found |= zip(data, self._asked(data), strict=True)

    def _asked(self, data: dict[str, bytes]) -> list[Array | str]:
        """Return the corners of meshes in their own frames, or why there are none."""
        meshes = [
            {
                "kind": PurePath(name).suffix[1:].lower(),
                "data": base64.b64encode(each).decode(),
            }
            for name, each in data.items()
        ]
        question = {"meshes": meshes, "most": MOST_CORNERS}
        try:
            answer = answered(
                "crawler2d.reading.mesh_child",
                question,
                file="all meshes together",
                folder=self.files.folder,
            )
        except ScenarioError as error:
            return [f"{error.path} {error.rule}"] * len(data)
        return [
            each.get("reason")
            or np.frombuffer(base64.b64decode(each["points"]), dtype=np.float64).reshape(-1, 3)
            for each in answer["meshes"]
        ]

    def hull(self, shape: Shape, element: Element, name: str, scale: list[float]) -> Shape | Unread:
        """Return the shape with the corners of its mesh, or what was left out and why."""
        if (part := element.only("submesh/name")) is not None:
            return self.missing(element, name, f"only a part of it, {part.text}, is meant")
        found = self._found.get(name, "")
        if isinstance(found, str):
            return self.missing(element, name, found)
        with np.errstate(over="ignore", invalid="ignore"):  # of what is left out below
            points = found * np.array(scale)
        if not len(points):
            return self.left_out(element, name, "must be a mesh with corners")
        if not (np.abs(points) <= _FARTHEST).all():
            reason = f"must have corners that are finite and at most {_FARTHEST:g} m away"
            return self.left_out(element, name, reason)
        return replace(shape, kind="hull", points=shape.pose.at(points))

    def missing(self, element: Element, name: str, reason: str) -> Unread:
        """Leave a mesh out for a reason, or by rule; refuse it by rule."""
        if self.rule == "refuse":
            rule = 'must be no mesh: mesh="hull" takes its hull, mesh="leave_out" leaves it out'
            element.refuse(name, rule)
        return self.left_out(element, name, reason if self.rule == "hull" else "a mesh")

    def left_out(self, element: Element, what: str, reason: str) -> Unread:
        """Note that a collision shape is left out."""
        self.doubts.append((element.at, what, f"is left out: {reason}"))
        return Unread(name=what, reason=reason, at=element.where)


_AXES = (("ixx", 0, 0), ("ixy", 0, 1), ("ixz", 0, 2), ("iyy", 1, 1), ("iyz", 1, 2), ("izz", 2, 2))

# The sizes of each shape, with how many numbers each has.
_SIZES = {
    "box": (("size", 3),),
    "capsule": (("radius", 1), ("length", 1)),
    "cone": (("radius", 1), ("length", 1)),
    "cylinder": (("radius", 1), ("length", 1)),
    "ellipsoid": (("radii", 3),),
    "sphere": (("radius", 1),),
}
_CIRCLE = np.linspace(0.0, 2.0 * math.pi, 64, endpoint=False)  # its chords fall short by 0.12 %

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
) -> Shape | Unread | None:
    """Read the geometry of a collision; None if it is empty, what is left out is unread."""
    geometry = collision.needed("geometry")
    kinds = [child for child in geometry.children if child.tag != "empty"]
    if not kinds:
        return None
    if len(kinds) > 1:
        kinds[1].refuse(kinds[1].tag, "must be the only shape of its collision")
    (element,) = kinds
    kind = element.tag
    shape = Shape(
        name=name,
        kind=kind,
        pose=pose,
        friction=friction,
        at=collision.where,
        pose_at=pose_at.where,
        size_at=(element.only("radius") or element).where,
    )
    if kind == "mesh":
        scale = [1.0, 1.0, 1.0]
        if element.only("scale") is not None or "scale" in element.attributes:
            scale = numbers(element, "scale", 3)
        return meshes.hull(shape, element, mesh_name(element), scale)
    return _sized(shape, element, numbers, meshes)


def _sized(shape: Shape, element: Element, numbers: Numbers, meshes: Meshes) -> Shape | Unread:
    """Return a shape with its sizes."""
    kind = shape.kind
    if kind not in _SIZES:
        return meshes.left_out(element, kind, "no shape that a side view knows")
    sizes = [size for word, count in _SIZES[kind] for size in numbers(element, word, count)]
    if min(sizes) < 0.0:
        element.refuse(min(sizes), "must have sizes >= 0 m")
    if kind == "capsule" and sizes[1] == 0.0:
        kind = "sphere"
    elif 0.0 in sizes:
        return meshes.left_out(element, kind, "a size of 0, with which it touches nothing")
    if kind == "box":
        return replace(shape, size=np.array(sizes))
    if kind in ("cone", "ellipsoid"):
        points = _cone(*sizes) if kind == "cone" else ellipsoid(sizes)
        return replace(shape, kind="hull", points=shape.pose.at(points))
    radius, length = sizes[0], sizes[1] if kind != "sphere" else 0.0
    return replace(shape, kind=kind, radius=radius, length=length)


def collisions(
    found: Iterable[Shape | Unread | None],
) -> tuple[tuple[Shape, ...], tuple[Unread, ...]]:
    """Return the shapes of a link, and those that were left out."""
    every = list(found)
    shapes = tuple(each for each in every if isinstance(each, Shape))
    return shapes, tuple(each for each in every if isinstance(each, Unread))


def ellipsoid(radii: list[float]) -> Array:
    """[m] Return points on an ellipsoid about the origin, whose hull stands for it."""
    turns, heights = np.meshgrid(_CIRCLE, np.linspace(0.0, math.pi, 33))
    ball = [np.sin(heights) * np.cos(turns), np.sin(heights) * np.sin(turns), np.cos(heights)]
    points: Array = np.stack(ball, axis=-1).reshape(-1, 3) * radii
    return points


def _cone(radius: float, length: float) -> Array:
    """[m] Return corners of a cone, with half of its length on either side of the origin."""
    rim = [radius * np.cos(_CIRCLE), radius * np.sin(_CIRCLE), np.full_like(_CIRCLE, -0.5 * length)]
    return np.concatenate([np.stack(rim, axis=1), [[0.0, 0.0, 0.5 * length]]])


def inertia(element: Element, value: Callable[[str], float], doubts: list[Doubt]) -> Array:
    """Read a tensor of inertia [kg m^2] by the names of its six components.

    One with a negative moment is doubted and taken as 0, that of a point: a guess at its size would
    be worse, and what a link has of its own counts little beside where it is.
    """
    tensor = np.zeros((3, 3))
    for name, row, column in _AXES:
        tensor[row, column] = tensor[column, row] = value(name)
    least = float(tensor.diagonal().min())
    if least < 0.0:
        doubts.append((element.at, least, "is taken as 0 kg m^2: no body has a negative moment"))
        return np.zeros((3, 3))
    return tensor


def solid(shapes: Sequence[Shape], density: float) -> tuple[float, Array, Array]:
    """Return mass [kg], centre [m] and inertia [kg m^2] about it, of shapes that are filled."""
    parts = [_filled(shape, density) for shape in shapes]
    masses = np.array([own for own, _ in parts])
    places = np.array([shape.pose.place for shape in shapes])
    center = masses @ places / masses.sum()
    tensor = np.zeros((3, 3))
    for shape, (own, moments), away in zip(shapes, parts, places - center, strict=True):
        tensor += shape.pose.turn @ np.diag(moments) @ shape.pose.turn.T
        tensor += own * (away @ away * np.eye(3) - np.outer(away, away))
    return float(masses.sum()), center, tensor


def _filled(shape: Shape, density: float) -> tuple[float, list[float]]:
    """Return mass [kg] and principal moments [kg m^2] of a shape in its own frame."""
    if shape.kind == "box":
        mass = density * float(np.prod(shape.size))
        squares = shape.size**2
        return mass, [mass * (sum(squares) - own) / 12.0 for own in squares]
    radius, length = shape.radius, shape.length
    straight = density * math.pi * radius**2 * length
    ends = 0.0 if shape.kind == "cylinder" else density * 4.0 / 3.0 * math.pi * radius**3
    across = straight * (radius**2 / 4.0 + length**2 / 12.0)
    across += ends * (0.4 * radius**2 + length**2 / 4.0 + 0.375 * length * radius)
    along = straight * radius**2 / 2.0 + ends * 0.4 * radius**2
    return straight + ends, [across, across, along]
