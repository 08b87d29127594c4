"""From the bytes of a model file to its tree: options, xacro, unit of length, format, inertias."""

from __future__ import annotations

import os
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from pathlib import Path
from typing import Any, get_args

import numpy as np

from crawler2d.common.arrays import real_number
from crawler2d.errors import ScenarioError
from crawler2d.model_tree import Link, Tree
from crawler2d.reading.elements import parsed
from crawler2d.reading.engines import ENGINES
from crawler2d.reading.files import Files
from crawler2d.reading.log import Doubt, named, noted
from crawler2d.reading.meshes import Meshes, MeshRule
from crawler2d.reading.mjcf import read_mjcf
from crawler2d.reading.sdf import read_sdf
from crawler2d.reading.urdf import read_urdf
from crawler2d.reading.wheels import (
    below,
    farthest,
)
from crawler2d.reading.xacro import expanded
from crawler2d.writing.document import Document, Span

__all__ = ["TOLERANCE", "How", "size_of", "tree_of"]

_SIZES = {
    "box": ("size",),
    "capsule": ("radius", "length"),
    "cone": ("radius", "length"),
    "cylinder": ("radius", "length"),
    "ellipsoid": ("radii",),
    "heightmap": ("size", "pos"),
    "mesh": ("scale",),
    "plane": ("size",),
    "polyline": ("point", "height"),
    "sphere": ("radius",),
}
"""What has lengths in a shape, as attributes in URDF, as elements in SDF."""


_INERTIA = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")


_SLIDE = ("lower", "upper", "velocity")


def scaled(data: bytes, scale: float, file: str) -> bytes:
    """Multiply the lengths of an SDF or URDF text.

    Places, sizes and limits of slides by the scale, moments of inertia by its square. Masses,
    torques and settings of plugins and sensors stay what they are.

    Parameters
    ----------
    data : bytes
        The text, which has been parsed.
    scale : float
        [-] Such as 0.001 for a file in millimetres.
    file : str
        Its name, for errors.

    Raises
    ------
    ScenarioError
        If the text is not in UTF-8.
    """
    try:
        document = Document(data.decode("utf-8"))
    except UnicodeDecodeError:
        raise ScenarioError(file, "another encoding", "must be UTF-8, to be scaled") from None
    for span in document.root.within():
        _scale(document, span, scale)
    return document.text.encode()


def _scale(document: Document, span: Span, scale: float) -> None:
    by = (scale,) * 3
    if span.tag == "pose" and not span.children:  # of a joint's limits and plugins, too
        document.multiply(span, by)
    elif span.tag == "origin":
        document.multiply(span, by, "xyz")
    elif span.tag in _SIZES:
        if span.tag == "mesh" and "scale" not in span.attributes and not span.only("scale"):
            _add_scale(document, span, scale)
        for name in _SIZES[span.tag]:
            document.multiply(span, by, name)
            for inner in span.all(name):
                document.multiply(inner, by)
    elif span.tag == "inertia":
        for name in _INERTIA:
            document.multiply(span, (scale**2,), name, is_exact=True)
            document.multiply(span.only(name), (scale**2,), is_exact=True)
    elif span.tag == "limit" and _is_of_slide(span):
        for name in _SLIDE:
            document.multiply(span, (scale,), name)
            document.multiply(span.only(name), (scale,))


def _add_scale(document: Document, mesh: Span, scale: float) -> None:
    text = f"{scale:.12g} {scale:.12g} {scale:.12g}"
    if mesh.children:  # SDF
        document.append(mesh, f"<scale>{text}</scale>", is_inline=True)
    else:
        document.set_attribute(mesh, "scale", text)


def _is_of_slide(limit: Span) -> bool:
    joint = limit.parent
    while joint is not None and joint.tag != "joint":
        joint = joint.parent
    return joint is not None and joint.attributes.get("type") == "prismatic"


TOLERANCE = 0.001
"""[m] By which sides may differ: public models are symmetric to their last digit, CAD exports to
0.1 mm."""


@dataclass(frozen=True, slots=True, kw_only=True)
class How:
    """The keywords of `read_robot`.

    Parameters
    ----------
    engine : str or None
        By whose rules the friction of two surfaces is combined, and motors drive.
    forward : str or None
        Direction of the model that is forward.
    model : str or None
        Name of the model in a world.
    mesh, missing : str
        What to do with meshes, and with what is not there.
    tracks : collection of str
        Links whose surface something outside the file moves.
    ground_friction : float or None
        [-] Coefficient of the ground's own surface.
    tolerance : float
        [m] By how much the two sides may differ in side view.
    scale : float or None
        [-] By which every length of the file is multiplied.
    trusted : bool
        Whether xacro may evaluate expressions of any kind.
    packages : mapping of str to path
        Folders of packages.
    arguments : mapping of str to str
        Values for the arguments of a xacro file.

    Raises
    ------
    ScenarioError
        If one breaks its rule.
    """

    engine: str | None = None
    forward: str | None = None
    model: str | None = None
    mesh: MeshRule = "hull"
    missing: str = "leave_out"
    tracks: Collection[str] = ()
    ground_friction: float | None = None
    tolerance: float = TOLERANCE
    scale: float | None = None
    trusted: bool = False
    packages: Mapping[str, str | os.PathLike[str]] = field(default_factory=dict)
    arguments: Mapping[str, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        """Check what does not need the file."""
        for name, value, allowed in (
            ("engine", self.engine, (None, *ENGINES)),
            ("mesh", self.mesh, get_args(MeshRule)),
            ("missing", self.missing, ("refuse", "leave_out")),
        ):
            if not (value is None or isinstance(value, str)) or value not in allowed:
                rule = f"must be one of {', '.join(str(each) for each in allowed)}"
                raise ScenarioError(name, value, rule)
        _check_pairs(self.packages, "packages", "folders by their names", (str, os.PathLike))
        _check_pairs(self.arguments, "arguments", "texts or numbers by name", (str, int, float))
        _check_between(self.tolerance, "tolerance", 0.0, 0.1)
        if self.scale is not None:
            _check_between(self.scale, "scale", 1e-4, 1e4)
        if self.ground_friction is not None:
            _check_between(self.ground_friction, "ground_friction", 0.0, 1e3)

    @property
    def given(self) -> dict[str, Any]:
        """What differs from the defaults, as `read_robot` takes it; folders as text."""
        usual = How()
        values = {each.name: getattr(self, each.name) for each in fields(self)}
        values["packages"] = {name: str(folder) for name, folder in self.packages.items()}
        return {name: value for name, value in values.items() if value != getattr(usual, name)}

    @property
    def leaves_out_missing(self) -> bool:
        """Whether what is not there is left out."""
        return self.missing == "leave_out"


def _check_pairs(pairs: object, path: str, what: str, kinds: tuple[type, ...]) -> None:
    if not isinstance(pairs, Mapping):
        raise ScenarioError(path, pairs, f"must be {what}")
    for name, value in pairs.items():
        if not isinstance(name, str) or not isinstance(value, kinds):
            raise ScenarioError(f"{path}[{name!r}]", value, f"must be {what}")


def _check_between(value: float, path: str, least: float, most: float) -> None:
    number = real_number(value, path)
    if not least <= number <= most:
        raise ScenarioError(path, number, f"must be between {least:g} and {most:g}")


_LISTED = 5  # names of links


_LIGHT = 0.01  # [-] Share of the robot's mass below which a link is light.


_MATTERS = 0.01  # [-] Share of the robot's moment of inertia from which a false one is doubted.


def bounded(tree: Tree, doubts: list[Doubt]) -> Tree:
    """Return the tree with no moment of inertia that its mass cannot have inside of the robot.

    One that is larger is doubted, and scaled down to that of the mass on the outermost point of the
    robot if the link is light and no wheel: files have such where somebody took a figure that an
    engine does not stumble over. Heavy links, and what turns without limit, keep what their file
    states. As long as all of them together make no difference to the robot, they stay as they are.

    Parameters
    ----------
    tree : Tree
        The model.
    doubts : list of Doubt
        Where they are noted, the worst with its line.
    """
    if not any(link.shapes for link in tree.links):
        return tree
    size = size_of(tree)
    whole = sum(link.mass for link in tree.links)
    hanging = below(tree)
    turning = {n for child, j in tree.joints.items() if j.is_unlimited for n in hanging[child]}
    links = []
    false: dict[bool, list[tuple[float, float, Link]]] = {True: [], False: []}
    for link in tree.links:
        largest = float(np.linalg.eigvalsh(link.inertia)[-1])
        most = link.mass * size**2
        scale = 1.0
        if largest > most * (1.0 + 1e-6):
            is_light = link.mass < _LIGHT * whole
            if not is_light or link.name not in turning:
                false[is_light].append((largest, most, link))
                scale = most / largest if is_light else 1.0
        links.append(replace(link, inertia=scale * link.inertia))
    is_same = _largest_moment(tree.links) <= (1.0 + _MATTERS) * _largest_moment(links)
    for is_light, found in false.items():
        if not found or (is_light and is_same):
            continue
        largest, most, worst = max(found, key=lambda each: each[0])
        others = [link.name for _, _, link in found if link is not worst]
        reason = (
            f"is {f'taken as {most:.3g} kg m^2' if is_light else 'kept'}, but {worst.mass:.3g} kg"
            f" have at most {most:.3g} kg m^2 within {size:.3g} m, the reach of the robot"
            f"{f'; likewise those of {named(others, _LISTED)}' if others else ''}"
        )
        doubts.append((f"{worst.mass_at}: link[{worst.name}]/inertia", largest, reason))
    return tree if is_same else replace(tree, links=tuple(links))


def _largest_moment(links: Sequence[Link]) -> float:
    """[kg m^2] Return the largest moment of inertia of all links together."""
    mass = np.array([link.mass for link in links])
    away = np.array([link.center for link in links])
    away -= mass @ away / mass.sum() if mass.sum() > 0.0 else 0.0
    swung = (mass * (away**2).sum(axis=1)).sum() * np.eye(3) - (mass * away.T) @ away
    return float(np.linalg.eigvalsh(swung + sum(link.inertia for link in links))[-1])


def size_of(tree: Tree) -> float:
    """[m] Return how far any shape or centre of mass is from the middle of all shapes.

    There must be a shape.
    """
    shapes = [shape for link in tree.links for shape in link.shapes]
    middle = np.mean([shape.pose.place for shape in shapes], axis=0)
    centers = [float(np.linalg.norm(link.center - middle)) for link in tree.links]
    return max(*(farthest(shape, middle) for shape in shapes), *centers)


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
