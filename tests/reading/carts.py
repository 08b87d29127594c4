"""Robots for single tests as URDF and SDF text, and helpers that read or refuse them."""

from __future__ import annotations

import re
import warnings
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import pytest

import crawler2d as c2d
from tests.kept import check_said

FILES = Path(__file__).parent / "files"
ROBOTS = Path(__file__).parent.parent / "robots"
SAID = Path(__file__).with_name("said.txt")

XACRO = '<robot name="cart" xmlns:xacro="http://www.ros.org/wiki/xacro">'
HULL = '<link name="hull"><inertial><mass value="{mass}"/>{tensor}</inertial>{shapes}</link>'
TENSOR = '<inertia ixx="0.1" ixy="0" ixz="0" iyy="0.2" iyz="0" izz="0.2"/>'
WHEEL_TENSOR = '<inertia ixx="0.002" ixy="0" ixz="0" iyy="0.003" iyz="0" izz="0.002"/>'
ROUND = '<cylinder radius="{radius}" length="0.05"/>'
ACROSS = '<origin rpy="1.5707963267948966 0 0"/>'
LIMIT = '<limit lower="-3.2" upper="3.2" effort="9" velocity="1"/>'
SIDES = (("left", 1.0), ("right", -1.0))


def wheel(name: str, xyz: str, **changed: str) -> str:
    """A link on a joint of the hull, with any part replaced."""
    parts = {
        "parent": "hull",
        "radius": "0.08",
        "type": "continuous",
        "axis": "0 1 0",
        "limit": '<limit effort="5" velocity="10"/>',
        "mass": "1",
        "origin": ACROSS,
        "geometry": ROUND.format(radius=changed.get("radius", "0.08")),
        "rpy": "0 0 0",
        **changed,
    }
    return f"""
<link name="{name}">
  <inertial><mass value="{parts["mass"]}"/>{WHEEL_TENSOR}</inertial>
  <collision>{parts["origin"]}<geometry>{parts["geometry"]}</geometry></collision>
</link>
<joint name="{name}_joint" type="{parts["type"]}">
  <parent link="{parts["parent"]}"/><child link="{name}"/>
  <origin xyz="{xyz}" rpy="{parts["rpy"]}"/><axis xyz="{parts["axis"]}"/>{parts["limit"]}
</joint>"""


def pair(name: str, x: float, y: float = 0.15, z: float = 0.0, **changed: str) -> str:
    """Two wheels, left and right."""
    return "".join(
        wheel(f"{side}_{name}", f"{x} {sign * y} {z}", **changed) for side, sign in SIDES
    )


WHEELS = pair("front", 0.2) + pair("rear", -0.2)


def urdf(*parts: str, mass: str = "8", shapes: str = "") -> str:
    """A robot of a hull and these parts."""
    hull = HULL.format(mass=mass, tensor=TENSOR, shapes=shapes)
    return f'<robot name="cart">{hull}{"".join(parts)}</robot>'


def collision(geometry: str, origin: str = "") -> str:
    return f"<collision>{origin}<geometry>{geometry}</geometry></collision>"


def link(name: str, joint: str, xyz: str = "0 0 0", parent: str = "hull") -> str:
    """A link of 0.5 kg without shapes, and the rest of its joint."""
    return f"""
<link name="{name}"><inertial><mass value="0.5"/>{WHEEL_TENSOR}</inertial></link>
<joint name="{name}_joint" {joint}
  <parent link="{parent}"/><child link="{name}"/><origin xyz="{xyz}"/></joint>"""


def read(folder: Path, text: str, name: str = "cart.urdf", **how: Any) -> c2d.Reading:
    """Read a text as a file; its notes and warnings must be among the stored ones."""
    path = folder / name
    path.write_text(text, encoding="utf-8")
    reading = quietly(path, **how)
    check_said(SAID, [*reading.notes, *reading.warnings], folder)
    return reading


def quietly(path: Path, **how: Any) -> c2d.Reading:
    """Read a file; its warnings are in the reading."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", c2d.ScenarioWarning)
        return c2d.read_robot(path, **how)


TRACKED = """<sdf version="1.7"><model name="tank">
<link name="hull"><inertial><mass>20</mass></inertial></link>{links}{plugins}</model></sdf>"""


def tracked(drums: Iterable[tuple[float, float, float]], boxes: str = "") -> str:
    """A vehicle with drums of x, z and radius, and boxes, that Gazebo's controllers move."""
    shapes = "".join(
        f"""<collision name="d{n}"><pose>{x} 0 {z} 1.5707963267948966 0 0</pose><geometry><cylinder>
        <radius>{r}</radius><length>0.1</length></cylinder></geometry></collision>"""
        for n, (x, z, r) in enumerate(drums)
    )
    links = "".join(
        f"""<link name="{side}"><pose>0 {0.3 * sign} 0 0 0 0</pose>{shapes}{boxes}</link>
        <joint name="{side}j" type="fixed"><parent>hull</parent><child>{side}</child></joint>"""
        for side, sign in SIDES
    )
    plugins = "".join(
        f'<plugin name="TrackController" filename="x"><link>{side}</link></plugin>'
        for side, _ in SIDES
    )
    return TRACKED.format(links=links, plugins=plugins)


def refused(folder: Path, text: str, rule: str, name: str = "cart.urdf", **how: Any) -> None:
    """Read a text that must be refused with a rule, file and line."""
    with pytest.raises(c2d.ScenarioError, match=rule) as caught:
        read(folder, text, name, **how)
    assert re.match(re.escape(name) + r":\d+", caught.value.path), caught.value.path
    check_said(SAID, [str(caught.value)], folder)


def left_out(folder: Path, text: str, reason: str, name: str = "cart.urdf", **how: Any) -> None:
    """Read a text with a collision shape that must be left out, with file, line and reason."""
    reading = read(folder, text, name, **how)
    told = [warning for warning in reading.warnings if "is left out" in warning]
    assert told, reading.warnings
    for warning in told:
        assert re.search(reason, warning), warning
        assert re.match(re.escape(name) + r":\d+", warning), warning
