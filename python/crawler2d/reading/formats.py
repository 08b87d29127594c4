"""From a file to a neutral tree: which format it has, and how much it may hold."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

from crawler2d.errors import ScenarioError
from crawler2d.models.tree import Tree
from crawler2d.reading.files import Files
from crawler2d.reading.how import How
from crawler2d.reading.meshes import Meshes
from crawler2d.reading.mjcf import read_mjcf
from crawler2d.reading.parsing import parsed
from crawler2d.reading.plausible import bounded
from crawler2d.reading.scaling import scaled
from crawler2d.reading.sdf import read_sdf
from crawler2d.reading.telling import Doubt, noted
from crawler2d.reading.urdf import read_urdf
from crawler2d.reading.xacro import expanded

__all__ = ["Found", "tree_of"]

_MOST_SHAPES = 3000  # collisions; the public models have at most 67


@dataclass(slots=True)
class Found:
    """A tree with the text that its lines are those of, and what the reader did without.

    Parameters
    ----------
    tree : Tree
        The model.
    text : str
        The file, or what it expands to.
    doubts : list of Doubt
        What was left out or replaced, with its line.
    """

    tree: Tree
    text: str
    doubts: list[Doubt] = field(default_factory=list)


def tree_of(data: bytes, path: Path, how: How) -> Found:
    """Read what a file holds.

    Parameters
    ----------
    data : bytes
        What it holds, or would hold.
    path : Path
        Where it is: its name is that of the lines, and names in it are relative to its folder.
    how : How
        The keywords of `read_robot`.

    Raises
    ------
    ScenarioError
        If it breaks a rule of its format, or needs what is not there; what was left out before is
        in its notes.
    """
    name, files = path.name, Files(path, how.packages)
    doubts: list[Doubt] = []
    if path.suffix == ".xacro":
        data, doubts = expanded(
            files,
            data,
            parsed(data, name),  # entities are refused before anything else reads the file
            trusted=how.trusted,
            arguments=how.arguments,
            leave_out=how.leaves_out_missing,
        )
        name = f"{name} (expanded)"
    with noted(doubts):
        root = parsed(data, name)
        if how.scale not in (None, 1.0):
            if root.tag not in ("sdf", "robot"):
                rule = "must be 1 for MJCF: <compiler> and its defaults say what its lengths are"
                raise ScenarioError("scale", how.scale, rule)
            data = scaled(data, how.scale, name)
            root = parsed(data, name)
        shapes = [element for element in root.within() if element.tag in ("collision", "geom")]
        if len(shapes) > _MOST_SHAPES:
            rule = f"must have at most {_MOST_SHAPES} collision shapes"
            shapes[_MOST_SHAPES].refuse(len(shapes), rule)
        text = data.decode("utf-8", errors="replace")
        meshes = Meshes(rule=how.mesh, files=files, doubts=doubts)
        if root.tag == "sdf":
            tree = read_sdf(root, how.model, meshes, doubts)
        elif root.tag == "robot":
            tree = read_urdf(
                root,
                meshes,
                doubts,
                leave_out=how.leaves_out_missing,
                is_bullet=how.engine == "bullet",
            )
        elif root.tag == "mujoco":
            tree = read_mjcf(root, text, how.model, meshes)
        else:
            root.refuse(root.tag, "must be <sdf>, <robot> or <mujoco>")
        tree = bounded(tree, doubts)
    return Found(tree, text, doubts + files.doubts)
