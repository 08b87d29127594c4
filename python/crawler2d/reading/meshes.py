"""Collision meshes: refused, left out, or read as the hull of their corners."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Literal

import numpy as np

from crawler2d.models.poses import Array
from crawler2d.models.tree import Shape
from crawler2d.reading.elements import Element

__all__ = ["MeshRule", "Meshes"]

MeshRule = Literal["refuse", "hull", "leave_out"]

_REMEDY = ', or be left out: mesh="leave_out"'
_LARGEST = 50_000_000  # [bytes] of one mesh, and of all that a model names together
_HEADER, _FACET = 84, 50  # [bytes] of a binary STL
_SCHEME = re.compile(r"(package|model|file)://(.*)", re.DOTALL)


@dataclass(slots=True, kw_only=True)
class Meshes:
    """What is done with the meshes of one model.

    Parameters
    ----------
    rule : {"refuse", "hull", "leave_out"}
        As in `read_robot`.
    folder : Path
        Where relative names begin.
    packages : mapping of str to path
        Folders of the packages and models that names begin with.
    left_out : list of (str, Element)
        The shapes that were left out.
    """

    rule: MeshRule
    folder: Path
    packages: Mapping[str, Path]
    left_out: list[tuple[str, Element]] = field(default_factory=list)
    size: int = 0

    def hull(self, shape: Shape, element: Element, name: str, scale: list[float]) -> Shape | None:
        """Return the shape with the corners of its mesh, or None if it is left out."""
        if self.rule == "leave_out":
            self.left_out.append((shape.name, element))
            return None
        if self.rule == "refuse":
            rule = 'must be no mesh: mesh="hull" takes its hull, mesh="leave_out" leaves it out'
            element.refuse(name, rule)
        points = self._points(element, name) * np.array(scale)
        if not len(points):
            element.refuse(name, "must be a mesh with corners")
        return replace(shape, kind="hull", points=shape.pose.at(points))

    def _points(self, element: Element, name: str) -> Array:
        """[m] Return the corners of a mesh in its own frame."""
        path = self._path(element, name)
        try:
            self.size += path.stat().st_size
            if self.size > _LARGEST:
                element.refuse(name, f"must be meshes of at most {_LARGEST} bytes together")
            data = path.read_bytes()
        except (OSError, ValueError):  # a name with a null byte is a ValueError
            element.refuse(
                name,
                'must be a mesh that is there and can be read, or be left out: mesh="leave_out"',
            )
        if path.suffix.lower() == ".stl":
            points = _of_stl(data)
        elif path.suffix.lower() == ".obj":
            points = _of_obj(data)
        else:
            element.refuse(name, f"must be an .stl or .obj mesh{_REMEDY}")
        # Corners are shared by facets: a side view needs each once.
        finite = np.isfinite(points).all(axis=1)
        return np.unique(points[finite], axis=0)

    def _path(self, element: Element, name: str) -> Path:
        scheme = _SCHEME.fullmatch(name)
        if scheme is None:
            return self.folder / name
        kind, rest = scheme.groups()
        if kind == "file":
            return Path(rest)
        package, _, inside = rest.partition("/")
        if package not in self.packages:
            rule = f'must be in a package whose folder is given: packages={{"{package}": ...}}'
            element.refuse(name, rule)
        return Path(self.packages[package]) / inside


def _of_stl(data: bytes) -> Array:
    """Return the corners of an STL, binary or text."""
    count = int.from_bytes(data[80:_HEADER], "little")
    if len(data) == _HEADER + _FACET * count:
        facets = np.frombuffer(data, dtype=np.uint8, offset=_HEADER).reshape(count, _FACET)
        corners = facets[:, 12:48].copy().view("<f4").reshape(-1, 3)  # after the normal
        return corners.astype(np.float64)
    return _rows(data, rb"^\s*vertex\s+(\S+)\s+(\S+)\s+(\S+)")


def _of_obj(data: bytes) -> Array:
    """Return the corners of an OBJ."""
    return _rows(data, rb"^v\s+(\S+)\s+(\S+)\s+(\S+)")


def _rows(data: bytes, pattern: bytes) -> Array:
    """Return the numbers of all lines of a pattern; those that are none become nan."""

    def number(word: bytes) -> float:
        try:
            return float(word)
        except ValueError:
            return np.nan

    found = re.findall(pattern, data, re.MULTILINE)
    rows = [[number(word) for word in row] for row in found]
    return np.array(rows, dtype=np.float64).reshape(-1, 3)
