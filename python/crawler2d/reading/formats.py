"""From a file to a neutral tree: which format it has, and how large it may be."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from crawler2d.errors import ScenarioError
from crawler2d.models.tree import Tree
from crawler2d.reading.elements import Element
from crawler2d.reading.meshes import Meshes, MeshRule
from crawler2d.reading.mjcf import read_mjcf
from crawler2d.reading.parsing import LARGEST_FILE, parsed
from crawler2d.reading.sdf import read_sdf
from crawler2d.reading.urdf import read_urdf
from crawler2d.reading.xacro import expanded

__all__ = ["Found", "tree_of"]

_MOST_SHAPES = 3000  # collisions; the public models have at most 67


@dataclass(slots=True)
class Found:
    """A tree with the text that its lines are those of, and what was left out on request.

    Parameters
    ----------
    tree : Tree
        The model.
    text : str
        The file, or what it expands to.
    left_out : list of (str, str)
        What, and what it was.
    """

    tree: Tree
    text: str
    left_out: list[tuple[str, str]] = field(default_factory=list)


def tree_of(
    path: Path,
    *,
    model: str | None,
    mesh: MeshRule,
    leave_out_missing: bool,
    trusted: bool,
    packages: Mapping[str, Path],
    arguments: Mapping[str, str],
) -> Found:
    """Read a file; the arguments are those of `read_robot`."""
    data = _bytes(path)
    name = path.name
    missing: list[tuple[str, str]] = []
    if path.suffix == ".xacro":
        data, includes = expanded(
            path,
            parsed(data, name),  # entities are refused before anything else reads the file
            trusted=trusted,
            packages=packages,
            arguments=arguments,
            leave_out=leave_out_missing,
        )
        name = f"{name} (expanded)"
        missing += [(include, "an include whose package is missing") for include in includes]
    root = parsed(data, name)
    shapes = [element for element in root.within() if element.tag in ("collision", "geom")]
    if len(shapes) > _MOST_SHAPES:
        rule = f"must have at most {_MOST_SHAPES} collision shapes"
        shapes[_MOST_SHAPES].refuse(len(shapes), rule)
    meshes = Meshes(rule=mesh, folder=path.resolve().parent, packages=packages)
    if root.tag == "sdf":
        tree = read_sdf(root, model, meshes)
    elif root.tag == "robot":
        joints: list[Element] | None = [] if leave_out_missing else None
        tree = read_urdf(root, meshes, left_out=joints)
        missing += [(joint.attribute("name"), "a joint of missing links") for joint in joints or ()]
    elif root.tag == "mujoco":
        tree = read_mjcf(root, path, model, meshes)
    else:
        root.refuse(root.tag, "must be <sdf>, <robot> or <mujoco>")
    missing += [(f"{shape} ({at.where})", "a mesh") for shape, at in meshes.left_out]
    return Found(tree, data.decode("utf-8", errors="replace"), missing)


def _bytes(path: Path) -> bytes:
    """Read a file, but never more than a model may have."""
    try:
        with path.open("rb") as file:
            data = file.read(LARGEST_FILE + 1)
    except (OSError, ValueError) as error:  # a name with a null byte is a ValueError
        reason = error.strerror if isinstance(error, OSError) else str(error)
        raise ScenarioError("path", str(path), f"must be a file ({reason})") from None
    return data
