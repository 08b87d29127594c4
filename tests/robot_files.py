"""Reads public robot models: the masses, wheels and limits that presets are checked against."""

from __future__ import annotations

import ast
import operator
import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
from numpy.typing import NDArray

FOLDER = Path(__file__).parent / "robots"
Array = NDArray[np.float64]


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
    """Take the lines of a file, the first as number 1."""
    return ["", *(FOLDER / file).read_text().splitlines()]


def read_sdf(file: str, model: str | None = None) -> list[Link]:
    """Read the links of a model, each placed in the frame of the model."""
    root = ElementTree.parse(FOLDER / file).getroot()
    found = root.find("model") if model is None else root.find(f".//model[@name='{model}']")
    assert found is not None
    return [_link(link) for link in found.findall("link")]


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
