"""Collision meshes: refused, left out, or read as the hull of their corners."""

from __future__ import annotations

import re
from dataclasses import dataclass, field, replace
from pathlib import PurePath
from typing import Literal

import numpy as np

from crawler2d.errors import ScenarioError
from crawler2d.models.poses import Array
from crawler2d.models.tree import Shape
from crawler2d.reading.elements import Element
from crawler2d.reading.files import LARGEST_TOGETHER, Files
from crawler2d.reading.telling import Doubt

__all__ = ["MeshRule", "Meshes"]

MeshRule = Literal["refuse", "hull", "leave_out"]

_REMEDY = ', or be left out: mesh="leave_out"'
_MOST_CORNERS = 300_000  # of all meshes of a model, each corner of a mesh once
_FARTHEST = 1e6  # [m] as for any number of a model file
_HEADER, _FACET = 84, 50  # [bytes] of a binary STL


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
    corners : int
        Of all meshes that were read.
    """

    rule: MeshRule
    files: Files
    doubts: list[Doubt] = field(default_factory=list)
    corners: int = 0

    def hull(self, shape: Shape, element: Element, name: str, scale: list[float]) -> Shape | None:
        """Return the shape with the corners of its mesh, or None if it is left out."""
        if self.rule == "leave_out":
            self.doubts.append((element.at, name, "is left out: a mesh"))
            return None
        if self.rule == "refuse":
            rule = 'must be no mesh: mesh="hull" takes its hull, mesh="leave_out" leaves it out'
            element.refuse(name, rule)
        with np.errstate(over="ignore", invalid="ignore"):  # of what is refused below
            points = self._points(element, name) * np.array(scale)
        if not len(points):
            element.refuse(name, f"must be a mesh with corners{_REMEDY}")
        if not (np.abs(points) <= _FARTHEST).all():
            rule = f"must have corners that are finite and at most {_FARTHEST:g} m away{_REMEDY}"
            element.refuse(name, rule)
        return replace(shape, kind="hull", points=shape.pose.at(points))

    def _points(self, element: Element, name: str) -> Array:
        """[m] Return the corners of a mesh in its own frame."""
        kind = PurePath(name).suffix.lower()
        if kind not in _CORNERS:
            element.refuse(name, f"must be an .stl or .obj mesh{_REMEDY}")
        data = self.files.read(name, at=element.at, most=LARGEST_TOGETHER, remedy=_REMEDY)
        try:
            points = _CORNERS[kind](data)
        except ValueError:
            element.refuse(name, f"must be a mesh whose corners are numbers{_REMEDY}")
        points = np.unique(points, axis=0)  # facets share corners: a side view needs each once
        self.count(len(points), element.at)
        return points

    def count(self, corners: int, at: str) -> None:
        """Refuse meshes that have too many corners, all together."""
        self.corners += corners
        if self.corners > _MOST_CORNERS:
            rule = f"must, with the other meshes, have at most {_MOST_CORNERS} corners{_REMEDY}"
            raise ScenarioError(at, self.corners, rule)


def _of_stl(data: bytes) -> Array:
    """Return the corners of an STL, binary or text."""
    count = int.from_bytes(data[80:_HEADER], "little")
    if len(data) == _HEADER + _FACET * count:
        facets = np.frombuffer(data, dtype=np.uint8, offset=_HEADER).reshape(count, _FACET)
        corners = facets[:, 12:48].copy().view("<f4").reshape(-1, 3)  # after the normal
        return corners.astype(np.float64)
    return _rows(data, rb"[ \t]*vertex")


def _of_obj(data: bytes) -> Array:
    """Return the corners of an OBJ."""
    return _rows(data, rb"v")


def _rows(data: bytes, start: bytes) -> Array:
    """Return the three numbers after the start of a line, of all such lines.

    No part of the pattern crosses lines or matches what the next one does, so that its time grows
    with the size of the file and no faster.
    """
    rows = re.finditer(rb"^%s[ \t]+(\S+)[ \t]+(\S+)[ \t]+(\S+)" % start, data, re.MULTILINE)
    numbers = (float(word) for row in rows for word in row.groups())
    return np.fromiter(numbers, dtype=np.float64).reshape(-1, 3)


_CORNERS = {".stl": _of_stl, ".obj": _of_obj}
