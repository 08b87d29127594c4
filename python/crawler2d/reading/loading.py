"""Load a model file into a tree: options, xacro, unit of length, format, inertias."""

from __future__ import annotations

import os
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from pathlib import Path
from typing import Any, get_args

import numpy as np

from crawler2d.common.arrays import read_bool, real_number
from crawler2d.errors import ScenarioError
from crawler2d.model_tree import Link, Tree
from crawler2d.reading.engines import ENGINES
from crawler2d.reading.files import Files
from crawler2d.reading.log import ReadingWarning, add_warnings, list_names
from crawler2d.reading.meshes import Meshes, MeshRule
from crawler2d.reading.mjcf import read_mjcf
from crawler2d.reading.parsing import parse_xml
from crawler2d.reading.sdf import read_sdf
from crawler2d.reading.urdf import read_urdf
from crawler2d.reading.wheels import farthest, subtrees
from crawler2d.reading.xacro import expand_xacro
from crawler2d.writing.document import Document, Span

__all__ = ["TOLERANCE", "ReadOptions", "load_model", "size_of"]

_LENGTHS = {
    "origin": ("xyz",),
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
"""Lengths by tag: attributes in URDF, elements in SDF."""

_INERTIA = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
_SLIDE = ("lower", "upper", "velocity")

TOLERANCE = 0.001
"""[m] Default tolerance between the sides: public models are symmetric to their last digit, CAD
exports to 0.1 mm."""

_LISTED = 5  # names of links, at most
_LIGHT = 0.01  # [-] Links below this fraction of the robot's mass are light.
_MATTERS = 0.01  # [-] Effect of wrong moments of inertia on the robot's that gets a warning.
_MOST_SHAPES = 3000  # collisions; the public models have at most 67


@dataclass(frozen=True, slots=True, kw_only=True)
class ReadOptions:
    """The keywords of `read_robot`.

    Parameters
    ----------
    engine : str or None
        The engine whose rules for friction and motors apply.
    forward : str or None
        Forward direction of the model.
    model : str or None
        Name of the model in a world.
    mesh, missing : str
        What to do with meshes, and with missing files and macros.
    tracks : collection of str
        Links with surfaces that move by means outside the file.
    ground_friction : float or None
        [-] Coefficient of the ground's own surface.
    tolerance : float
        [m] Largest difference between the two sides in side view.
    scale : float or None
        [-] Factor of every length in the file.
    trusted : bool
        Whether xacro may evaluate any expression.
    packages : mapping of str to path
        Folders of packages.
    arguments : mapping of str to str
        Values for the arguments of a xacro file.

    Raises
    ------
    ScenarioError
        If an option breaks a rule.
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
        """Check the rules that do not need the file."""
        for name, value, allowed in (
            ("engine", self.engine, (None, *ENGINES)),
            ("mesh", self.mesh, get_args(MeshRule)),
            ("missing", self.missing, ("refuse", "leave_out")),
        ):
            if not (value is None or isinstance(value, str)) or value not in allowed:
                rule = f"must be one of {', '.join(str(each) for each in allowed)}"
                raise ScenarioError(name, value, rule)
        object.__setattr__(self, "trusted", read_bool(self.trusted, "trusted"))
        if not (self.model is None or isinstance(self.model, str)):
            raise ScenarioError("model", self.model, "must be the name of a model")
        _check_pairs(self.packages, "packages", "folders by their names", (str, os.PathLike))
        _check_pairs(self.arguments, "arguments", "texts or numbers by name", (str, int, float))
        for path, least, most in (
            ("tolerance", 0.0, 0.1),
            ("scale", 1e-4, 1e4),
            ("ground_friction", 0.0, 1e3),
        ):
            value = getattr(self, path)
            if value is not None or path == "tolerance":
                number = real_number(value, path)
                if not least <= number <= most:
                    raise ScenarioError(path, number, f"must be between {least:g} and {most:g}")
                object.__setattr__(self, path, number)

    @property
    def given(self) -> dict[str, Any]:
        """Options that differ from their defaults, as keywords of `read_robot`."""
        usual = ReadOptions()
        values = {each.name: getattr(self, each.name) for each in fields(self)}
        values["packages"] = {name: str(folder) for name, folder in self.packages.items()}
        return {name: value for name, value in values.items() if value != getattr(usual, name)}

    @property
    def leaves_out_missing(self) -> bool:
        """Whether missing files and macros are left out."""
        return self.missing == "leave_out"


@dataclass(slots=True)
class LoadedModel:
    """A tree with the text to which its lines refer.

    Parameters
    ----------
    tree : Tree
        The model.
    text : str
        The file, or its expansion.
    warnings : list of ReadingWarning
        Parts left out or replaced, with their lines.
    """

    tree: Tree
    text: str
    warnings: list[ReadingWarning]


def size_of(tree: Tree) -> float:
    """[m] Return the largest distance of a shape or centre of mass from the middle of all shapes.

    There must be a shape.
    """
    shapes = [shape for link in tree.links for shape in link.shapes]
    middle = np.mean([shape.pose.place for shape in shapes], axis=0)
    centers = [float(np.linalg.norm(link.center - middle)) for link in tree.links]
    return max(*(farthest(shape, middle) for shape in shapes), *centers)


def load_model(data: bytes, path: Path, options: ReadOptions) -> LoadedModel:
    """Read the tree of a model.

    Parameters
    ----------
    data : bytes
        Content of the file.
    path : Path
        Its path: its name appears in lines, and names in it are relative to its folder.
    options : ReadOptions
        The keywords of `read_robot`.

    Raises
    ------
    ScenarioError
        If it breaks a rule of its format, or needs missing files; its notes list what was left out
        before.
    """
    name, files = path.name, Files(path, options.packages)
    warnings: list[ReadingWarning] = []
    if path.suffix == ".xacro":
        data, warnings = expand_xacro(
            files,
            data,
            name,
            trusted=options.trusted,
            arguments=options.arguments,
            leave_out=options.leaves_out_missing,
        )
        name = f"{name} (expanded)"
    elif options.arguments:
        reason = "has no effect: the file is no xacro, which is named *.xacro"
        warnings.append(("arguments", ", ".join(options.arguments), reason))
    with add_warnings(warnings):
        root = parse_xml(data, name)
        if options.scale not in (None, 1.0):
            if root.tag not in ("sdf", "robot"):
                rule = "must be 1 for MJCF, which states its units in <compiler>"
                raise ScenarioError("scale", options.scale, rule)
            data = _scale_lengths(data, options.scale, name)
            root = parse_xml(data, name)
        shapes = [element for element in root.within() if element.tag in ("collision", "geom")]
        if len(shapes) > _MOST_SHAPES:
            rule = f"must have at most {_MOST_SHAPES} collision shapes"
            shapes[_MOST_SHAPES].refuse(len(shapes), rule)
        text = data.decode("utf-8", errors="replace")
        meshes = Meshes(rule=options.mesh, files=files, warnings=warnings)
        if root.tag == "sdf":
            tree = read_sdf(root, options.model, meshes)
        elif root.tag == "robot":
            is_bullet = options.engine == "bullet"
            if options.model is not None:
                warnings.append(("model", options.model, "has no effect: a URDF has one robot"))
            leave_out = options.leaves_out_missing
            tree = read_urdf(root, meshes, leave_out=leave_out, is_bullet=is_bullet)
        elif root.tag == "mujoco":
            tree = read_mjcf(root, text, options.model, meshes)
        else:
            root.refuse(root.tag, "must be <sdf>, <robot> or <mujoco>")
        tree = _limit_inertias(tree, warnings)
    return LoadedModel(tree, text, warnings + files.warnings)


def _check_pairs(pairs: object, path: str, what: str, kinds: tuple[type, ...]) -> None:
    if not isinstance(pairs, Mapping):
        raise ScenarioError(path, pairs, f"must be {what}")
    for name, value in pairs.items():
        if not isinstance(name, str) or not isinstance(value, kinds):
            raise ScenarioError(f"{path}[{name!r}]", value, f"must be {what}")


def _scale_lengths(data: bytes, scale: float, file: str) -> bytes:
    """Multiply the lengths in an SDF or URDF text, keeping its lines.

    Positions, sizes and limits of slides are multiplied by the scale, moments of inertia by its
    square. Masses, torques and settings of plugins and sensors do not change.
    """
    try:
        document = Document(data.decode("utf-8"))
    except UnicodeDecodeError:
        raise ScenarioError(file, "another encoding", "must be UTF-8, to be scaled") from None
    for span in document.root.within():
        names, is_exact = _LENGTHS.get(span.tag, ()), False
        factors: tuple[float, ...] = (scale,) * 3
        if span.tag == "pose" and not span.children:  # of a joint's limits and plugins, too
            document.multiply(span, factors)
        elif span.tag == "inertia":
            names, factors, is_exact = _INERTIA, (scale**2,), True
        elif span.tag == "limit" and _is_of_slide(span):
            names = _SLIDE
        elif span.tag == "mesh" and "scale" not in span.attributes and not span.only("scale"):
            _add_scale(document, span, scale)
        for name in names:
            document.multiply(span, factors, name, is_exact=is_exact)
            for inner in span.all(name):
                document.multiply(inner, factors, is_exact=is_exact)
    return document.text.encode()


def _is_of_slide(limit: Span) -> bool:
    joint = limit.parent
    while joint is not None and joint.tag != "joint":
        joint = joint.parent
    return joint is not None and joint.attributes.get("type") == "prismatic"


def _add_scale(document: Document, mesh: Span, scale: float) -> None:
    text = f"{scale:.12g} {scale:.12g} {scale:.12g}"
    if mesh.children:  # SDF
        document.append(mesh, f"<scale>{text}</scale>", is_inline=True)
    else:
        document.set_attribute(mesh, "scale", text)


def _limit_inertias(tree: Tree, warnings: list[ReadingWarning]) -> Tree:
    """Limit moments of inertia to those possible for a link's mass inside the robot.

    Larger ones get one warning, with the line of the worst. For a light link that is not a wheel,
    the moment is scaled down to that of its mass at the outermost point of the robot, as such
    figures come from placeholders that engines accept. Heavy links and parts that turn without
    limit keep the file's figures, and so do all if the effect on the robot is negligible.
    """
    if not any(link.shapes for link in tree.links):
        return tree
    size = size_of(tree)
    whole = sum(link.mass for link in tree.links)
    hanging = subtrees(tree)
    turning = {n for child, j in tree.joints.items() if j.is_unlimited for n in hanging[child]}
    links = []
    excessive: dict[bool, list[tuple[float, float, Link]]] = {True: [], False: []}
    for link in tree.links:
        largest = float(np.linalg.eigvalsh(link.inertia)[-1])
        most = link.mass * size**2
        is_light = link.mass < _LIGHT * whole
        scale = 1.0
        if largest > most * (1.0 + 1e-6) and not (is_light and link.name in turning):
            excessive[is_light].append((largest, most, link))
            scale = most / largest if is_light else 1.0
        links.append(replace(link, inertia=scale * link.inertia))
    is_same = _largest_moment(tree.links) <= (1.0 + _MATTERS) * _largest_moment(links)
    for is_light, rows in excessive.items():
        if not rows or (is_light and is_same):
            continue
        largest, most, worst = max(rows, key=lambda row: row[0])
        others = [link.name for _, _, link in rows if link is not worst]
        reason = (
            f"is {f'taken as {most:.3g} kg m^2' if is_light else 'kept'}, but {worst.mass:.3g} kg"
            f" have at most {most:.3g} kg m^2 within {size:.3g} m, the reach of the robot"
            f"{f'; likewise those of {list_names(others, _LISTED)}' if others else ''}"
        )
        warnings.append((f"{worst.mass_at}: link[{worst.name}]/inertia", largest, reason))
    return tree if is_same else replace(tree, links=tuple(links))


def _largest_moment(links: Sequence[Link]) -> float:
    """[kg m^2] Return the largest principal moment of inertia of all links together."""
    mass = np.array([link.mass for link in links])
    away = np.array([link.center for link in links])
    away -= mass @ away / mass.sum() if mass.sum() > 0.0 else 0.0
    swung = (mass * (away**2).sum(axis=1)).sum() * np.eye(3) - (mass * away.T) @ away
    return float(np.linalg.eigvalsh(swung + sum(link.inertia for link in links))[-1])
