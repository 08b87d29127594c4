"""Asks trimesh for the corners of meshes; runs in a child process.

Only the bytes that it is handed are read. What they name besides, such as materials, textures or
buffers in other files, is not looked for: trimesh gets no resolver, and nothing can be opened.
"""

from __future__ import annotations

import base64
import io
import sys
from collections.abc import Callable
from typing import Any
from xml.parsers import expat

import numpy as np

from crawler2d.common.extras import extra
from crawler2d.model_tree import Array
from crawler2d.reading.child import no_more_files, serve

# What trimesh and pycollada take if it is there, but corners do not need: pictures, and scipy, the
# import of which takes longest. lxml is not the parser that refuses document types below.
_UNUSED = ("PIL", "lxml", "scipy")


def prepare() -> Callable[[dict[str, Any]], dict[str, Any]]:
    """Import trimesh, and pycollada by which it reads COLLADA."""
    for name in _UNUSED:
        sys.modules[name] = None  # type: ignore[assignment]
    extra("collada", "models")
    trimesh = extra("trimesh", "models")
    return lambda question: {"meshes": _described(trimesh, **question)}


def _described(trimesh: Any, meshes: list[dict[str, str]], most: int) -> list[dict[str, str]]:
    """Return the corners of each mesh, or the reason why there are none."""
    answers, left = [], most
    for each in meshes:
        try:
            with no_more_files():
                points = _corners(trimesh, base64.b64decode(each["data"]), each["kind"])
        except Exception as error:  # whatever trimesh stumbles over, it is no mesh of that format
            said = " ".join(f"{type(error).__name__} {error}".split())[:150]
            answers.append({"reason": f"must be a mesh that trimesh reads ({said})"})
            continue
        left -= len(points)
        if left < 0:
            rule = f"must, with the other meshes, have at most {most} corners"
            answers.append({"reason": rule})
            continue
        answers.append({"points": base64.b64encode(points.tobytes()).decode()})
    return answers


def _corners(trimesh: Any, data: bytes, kind: str) -> Array:
    """Return the corners of a mesh in its own frame, each once: facets share them."""
    unit = _unit(data) if kind == "dae" else 1.0
    scene = trimesh.load_scene(io.BytesIO(data), file_type=kind, process=False, skip_materials=True)
    found = [np.zeros((0, 3))]
    for node in scene.graph.nodes_geometry:
        place, name = scene.graph[node]
        vertices = np.asarray(scene.geometry[name].vertices, dtype=np.float64).reshape(-1, 3)
        found.append(vertices @ place[:3, :3].T + place[:3, 3])
    return np.ascontiguousarray(np.unique(np.concatenate(found), axis=0)) * unit


def _unit(data: bytes) -> float:
    """[m] Return the unit of a COLLADA file; document types and entities are refused.

    Gazebo and RViz apply the unit and take no notice of the axis that is up.
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
