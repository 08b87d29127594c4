"""Reads masses, wheels and limits of public robot models, to check presets."""

from __future__ import annotations

import ast
import contextlib
import operator
import re
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
from numpy.typing import NDArray

FOLDER = Path(__file__).parent
Array = NDArray[np.float64]

_XACRO = "{http://www.ros.org/wiki/xacro}"
_OPERATORS: dict[type[ast.operator], Callable[[float, float], float]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
}


@dataclass(frozen=True)
class Round:
    """A cylinder of a link's collision shape, its middle in the frame of the model."""

    place: Array
    radius: float


@dataclass(frozen=True)
class Link:
    """A link of a model, everything in the frame of the model: x forward, y left, z up.

    `inertia` is its moment of inertia about the lateral axis through its centre of mass.
    """

    name: str
    mass: float
    center: Array
    inertia: float
    rounds: tuple[Round, ...] = ()


@dataclass(frozen=True)
class Masses:
    """Several links as one: mass, centre of mass (x, z), moment of inertia about it."""

    mass: float
    x: float
    z: float
    inertia: float


def together(links: list[Link]) -> Masses:
    """Sum masses, first and second moments in the side view."""
    mass = sum(link.mass for link in links)
    x, z = (sum(link.mass * link.center[axis] for link in links) / mass for axis in (0, 2))
    inertia = sum(
        link.inertia + link.mass * ((link.center[0] - x) ** 2 + (link.center[2] - z) ** 2)
        for link in links
    )
    return Masses(mass, float(x), float(z), float(inertia))


def lines(file: str) -> list[str]:
    """Return the lines of a file, the first as number 1."""
    # A stray carriage return within a line does not end it.
    return ["", *(FOLDER / file).read_bytes().decode().split("\n")]


def read_sdf(file: str, model: str | None = None) -> list[Link]:
    """Read the links of a model, each placed in the frame of the model."""
    root = ElementTree.parse(FOLDER / file).getroot()
    found = root.find("model") if model is None else root.find(f".//model[@name='{model}']")
    assert found is not None
    return [_link(link) for link in found.findall("link")]


@dataclass(frozen=True)
class Wheel:
    """A wheel of a xacro model, in the frame of its parent link."""

    name: str
    parent: str
    place: Array
    radius: float


def read_xacro(file: str) -> tuple[dict[str, float], list[Wheel]]:
    """Read masses of all links by name, and the wheels, of a file of macro calls."""
    root = ElementTree.parse(FOLDER / file).getroot()
    known = xacro_properties(root)
    masses, wheels = {}, []
    for link in root.iter(_XACRO + "link_macro"):
        masses[link.attrib["name_link"]] = evaluated(link.attrib["mass"], known)
    for wheel in root.iter(_XACRO + "wheel"):
        name = wheel.attrib["name_link"]
        masses[name] = evaluated(wheel.attrib["mass"], known)
        place = np.array([evaluated(wheel.attrib[axis], known) for axis in "xyz"])
        # The macro scales the radius, but not the position.
        radius = evaluated(wheel.attrib["radius"], known) * known["scale"]
        wheels.append(Wheel(name, wheel.attrib["parent"], place, radius))
    for plain in root.findall("link"):
        mass = plain.find("inertial/mass")
        assert mass is not None
        masses[plain.attrib["name"]] = float(mass.attrib["value"])
    return masses, wheels


def xacro_properties(root: ElementTree.Element) -> dict[str, float]:
    """Evaluate the numeric properties in order."""
    known: dict[str, float] = {}
    for entry in root.iter(_XACRO + "property"):
        with contextlib.suppress(ValueError, KeyError, SyntaxError):
            known[entry.attrib["name"]] = evaluated(entry.attrib["value"], known)
    return known


def evaluated(text: str, known: dict[str, float]) -> float:
    """Evaluate a number or ``${...}`` with products, sums and known names."""
    inner = re.fullmatch(r"\$\{(.*)\}", text)
    if inner is None:
        return float(text)

    def value(node: ast.expr) -> float:
        if isinstance(node, ast.BinOp):
            return _OPERATORS[type(node.op)](value(node.left), value(node.right))
        if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
            return -value(node.operand)
        if isinstance(node, ast.Name):
            return known[node.id]
        assert isinstance(node, ast.Constant)
        return float(node.value)  # type: ignore[arg-type]

    return value(ast.parse(inner[1], mode="eval").body)


def _link(element: ElementTree.Element) -> Link:
    turn, place = _pose(element)
    inertial = element.find("inertial")
    assert inertial is not None
    own_turn, own_place = _pose(inertial)
    tensor = np.empty((3, 3))
    for row, column in np.ndindex(3, 3):
        name = "i" + "".join("xyz"[axis] for axis in sorted((row, column)))
        tensor[row, column] = _number(inertial, f"inertia/{name}")
    whole = turn @ own_turn
    rounds = []
    for collision in element.findall("collision"):
        if (cylinder := collision.find("geometry/cylinder")) is not None:
            _, middle = _pose(collision)
            rounds.append(Round(place + turn @ middle, _number(cylinder, "radius")))
    return Link(
        name=element.attrib["name"],
        mass=_number(inertial, "mass"),
        center=place + turn @ own_place,
        inertia=float((whole @ tensor @ whole.T)[1, 1]),
        rounds=tuple(rounds),
    )


def _number(element: ElementTree.Element, path: str) -> float:
    text = element.findtext(path)
    assert text is not None, path
    return float(text)


def _pose(element: ElementTree.Element) -> tuple[Array, Array]:
    """Rotation and place: roll about x, then pitch about y, then yaw about z, all fixed axes."""
    pose = element.find("pose")
    if pose is None:
        return np.eye(3), np.zeros(3)
    assert not pose.attrib, "a pose in another frame"
    x, y, z, roll, pitch, yaw = (float(word) for word in (pose.text or "").split())
    return rotation(roll, pitch, yaw), np.array([x, y, z])


def rotation(roll: float, pitch: float, yaw: float) -> Array:
    """Roll about x, then pitch about y, then yaw about z, all fixed axes."""
    (cr, sr), (cp, sp), (cy, sy) = ((np.cos(a), np.sin(a)) for a in (roll, pitch, yaw))
    about_x = np.array([[1, 0, 0], [0, cr, -sr], [0, sr, cr]])
    about_y = np.array([[cp, 0, sp], [0, 1, 0], [-sp, 0, cp]])
    about_z = np.array([[cy, -sy, 0], [sy, cy, 0], [0, 0, 1]])
    turned: Array = about_z @ about_y @ about_x
    return turned
