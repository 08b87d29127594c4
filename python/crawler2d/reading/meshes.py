"""Read meshes as hulls of their corners, by trimesh in a child process.

The child reads only the given bytes. References to other files (materials, textures, buffers) are
never followed: trimesh gets no resolver, and the process cannot open files.
"""

from __future__ import annotations

import base64
import io
import sys
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from pathlib import PurePath
from typing import Any, Literal
from xml.parsers import expat

import numpy as np

from crawler2d.common.extras import extra
from crawler2d.errors import ScenarioError
from crawler2d.model_tree import Array, Shape, Unread
from crawler2d.reading.files import LARGEST_TOGETHER, Files, reason_of
from crawler2d.reading.log import ReadingWarning
from crawler2d.reading.parsing import Element, ask_child, no_more_files, serve

__all__ = ["MOST_CORNERS", "MeshRule", "Meshes"]

MeshRule = Literal["refuse", "hull", "leave_out"]

MOST_CORNERS = 300_000
"""Limit of all meshes of a model, counting each corner of a mesh once."""

_KINDS = ("dae", "glb", "gltf", "obj", "stl")
_FARTHEST = 1e6  # [m] as for any number of a model file

# Optional imports of trimesh and pycollada that corners do not need: pictures, and scipy, which
# takes longest. lxml would bypass the parser below, which refuses document types.
_UNUSED = ("PIL", "lxml", "scipy")


@dataclass(slots=True, kw_only=True)
class Meshes:
    """The meshes of one model, and the rule for them.

    Parameters
    ----------
    rule : {"refuse", "hull", "leave_out"}
        As in `read_robot`.
    files : Files
        The files of the model.
    warnings : list of ReadingWarning
        Gets warnings about shapes left out.
    """

    rule: MeshRule
    files: Files
    warnings: list[ReadingWarning] = field(default_factory=list)
    _corners: dict[str, Array | str] = field(default_factory=dict)  # or why there are none

    def read(self, elements: dict[str, Element]) -> None:
        """Read all meshes at once, as the limits of the child process apply to all together.

        Parameters
        ----------
        elements : dict of str to Element
            The first element that names a mesh, by the mesh's name.

        Raises
        ------
        ImportError
            If there is a mesh, and trimesh is missing.
        """
        if self.rule != "hull":
            return
        names, meshes = [], []
        for name, element in elements.items():
            kind = PurePath(name).suffix[1:].lower()
            if kind not in _KINDS:
                self._corners[name] = f"must be a mesh of a known kind: {', '.join(_KINDS)}"
                continue
            try:
                data = self.files.read(name, at=element.at, most=LARGEST_TOGETHER)
            except ScenarioError as error:
                self._corners[name] = reason_of(error)
            else:
                names.append(name)
                meshes.append({"kind": kind, "data": base64.b64encode(data).decode()})
        if not names:
            return
        question = {"meshes": meshes, "most": MOST_CORNERS}
        try:
            answer = ask_child(__name__, question, file="all meshes together", files=self.files)
        except ScenarioError as error:
            self._corners |= dict.fromkeys(names, f"{error.path} {error.rule}")
            return
        for name, each in zip(names, answer["meshes"], strict=True):
            points = np.frombuffer(base64.b64decode(each.get("points", "")), dtype=np.float64)
            self._corners[name] = each.get("reason") or points.reshape(-1, 3)

    def hull(self, shape: Shape, element: Element, name: str, scale: list[float]) -> Shape | Unread:
        """Return the shape with the corners of its mesh, or leave it out."""
        if (part := element.only("submesh/name")) is not None:
            return self.missing(element, name, f"only a part of it, {part.text}, is meant")
        corners = self._corners.get(name, "")
        if isinstance(corners, str):
            return self.missing(element, name, corners)
        with np.errstate(over="ignore", invalid="ignore"):  # of what is left out below
            points = corners * np.array(scale)
        if not len(points):
            return self.leave_out(element, name, "must be a mesh with corners")
        if not (np.abs(points) <= _FARTHEST).all():
            reason = f"must have corners that are finite and at most {_FARTHEST:g} m away"
            return self.leave_out(element, name, reason)
        return replace(shape, kind="hull", points=shape.pose.at(points))

    def missing(self, element: Element, name: str, reason: str) -> Unread:
        """Leave out a mesh without corners, with the reason, or refuse it by the rule."""
        if self.rule == "refuse":
            rule = 'must not be a mesh; pass mesh="hull" for its hull, or mesh="leave_out"'
            element.refuse(name, rule)
        return self.leave_out(element, name, reason if self.rule == "hull" else "a mesh")

    def leave_out(self, element: Element, name: str, reason: str) -> Unread:
        """Leave out a collision shape, with a warning."""
        self.warnings.append((element.at, name, f"is left out: {reason}"))
        return Unread(name=name, reason=reason, at=element.where)


def prepare() -> Callable[[dict[str, Any]], dict[str, Any]]:
    """Import trimesh, and pycollada by which it reads COLLADA."""
    for name in _UNUSED:
        sys.modules[name] = None  # type: ignore[assignment]
    extra("collada", "models")
    trimesh = extra("trimesh", "models")
    return lambda question: {"meshes": _read_meshes(trimesh, **question)}


def _read_meshes(trimesh: Any, meshes: list[dict[str, str]], most: int) -> list[dict[str, str]]:
    """Return the corners of each mesh, or the reason why there are none."""
    answers, left = [], most
    for mesh in meshes:
        try:
            with no_more_files():
                points = _corners_of(trimesh, base64.b64decode(mesh["data"]), mesh["kind"])
        except Exception as error:  # any error of trimesh means an invalid mesh
            said = " ".join(f"{type(error).__name__} {error}".split())[:150]
            answers.append({"reason": f"must be a mesh that trimesh reads ({said})"})
            continue
        left -= len(points)
        if left < 0:
            rule = f"must, with the other meshes, have at most {most} corners"
            answers.append({"reason": rule})
        else:
            answers.append({"points": base64.b64encode(points.tobytes()).decode()})
    return answers


def _corners_of(trimesh: Any, data: bytes, kind: str) -> Array:
    """Return the corners of a mesh in its own frame, each once: facets share them."""
    unit = _unit(data) if kind == "dae" else 1.0
    scene = trimesh.load_scene(io.BytesIO(data), file_type=kind, process=False, skip_materials=True)
    parts = [np.zeros((0, 3))]
    for node in scene.graph.nodes_geometry:
        place, name = scene.graph[node]
        vertices = np.asarray(scene.geometry[name].vertices, dtype=np.float64).reshape(-1, 3)
        parts.append(vertices @ place[:3, :3].T + place[:3, 3])
    return np.ascontiguousarray(np.unique(np.concatenate(parts), axis=0)) * unit


def _unit(data: bytes) -> float:
    """[m] Return the unit of a COLLADA file; document types and entities are refused.

    Gazebo and RViz apply the unit and ignore the up axis.
    """
    units = []

    def start(tag: str, attributes: dict[str, str]) -> None:
        if tag.rpartition(":")[2] == "unit":
            units.append(float(attributes.get("meter", "1")))

    def doctype(*_: object) -> None:
        raise ValueError("it has a document type")

    parser = expat.ParserCreate()
    parser.StartElementHandler = start
    parser.StartDoctypeDeclHandler = doctype
    parser.Parse(data, True)
    unit = units[0] if units else 1.0
    if not unit > 0.0:
        raise ValueError(f"its unit is {unit:g} m")
    return unit


if __name__ == "__main__":
    serve(prepare)
