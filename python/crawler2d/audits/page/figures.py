"""The figures of an audited robot with their sources, its wheels, and what is not known of it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

from crawler2d.audits import words
from crawler2d.audits.names import names_of
from crawler2d.audits.page.grid import grid
from crawler2d.common.markup import escaped
from crawler2d.common.units import unit_of
from crawler2d.parameters.paths import read_path
from crawler2d.variation.ranges import Ranges

if TYPE_CHECKING:
    from crawler2d.audits.audited import Audited
    from crawler2d.parameters.robot import Robot

__all__ = ["field_name", "figures", "unknowns", "wheels"]

_STATED = (
    "mass",
    "center_of_mass",
    "moment_of_inertia",
    "track_mass",
    "outline.axle_distance",
    "outline.front_radius",
    "outline.rear_radius",
    "track",
    "flippers.length",
    "flippers.angle",
    "flippers.track",
    "belly",
    "gauge",
    "drivetrain.max_speed",
    "drivetrain.max_torque",
)
"""Of a robot that was not read from a file, whose other fields are where it was made."""


def figures(audit: Audited) -> str:
    """Write every figure with its source; of a robot without a file those that matter."""
    read, robot = audit.reading, audit.robot
    if read is None:
        paths = [f"robot.{path}" for path in _STATED if _has(robot, path)]
        rows = [(escaped(field_name(path)), escaped(_value(robot, path))) for path in paths]
        return grid(("figure", "value"), rows, label="figures of the robot")
    sourced = [
        (
            escaped(field_name(path)),
            escaped(f"{read.friction:.4g}" if path == "friction" else _value(robot, path)),
            _source(source),
        )
        for path, source in read.sources.items()
    ]
    return grid(("figure", "value", "source"), sourced, label="figures with their sources")


def unknowns(ranges: Mapping[str, Any], label: str) -> str:
    """Write over which ranges something was drawn, and where these come from."""
    if not ranges:
        return "<p>Nothing.</p>"
    sources = ranges.sources if isinstance(ranges, Ranges) else {}
    rows = [
        (
            escaped(field_name(path)),
            escaped(words.range_of(path, each)),
            escaped(sources.get(path, "")),
        )
        for path, each in ranges.items()
    ]
    return grid(("field", "range", "source of the range"), rows, label=label)


def wheels(audit: Audited) -> str:
    """List the wheels of the left side by their numbers; of a file with its names and lines."""
    read, table = audit.reading, audit.robot.wheels()
    left = table["side"] == "left"
    names: dict[int, str] = {} if read is None else names_of(audit.robot, read)
    lines: dict[str, int] = {}
    if read is not None:
        lines = dict(zip(read.wheels["name"].tolist(), read.wheels["line"].tolist(), strict=True))

    def rows() -> Iterator[tuple[str, ...]]:
        columns = (table[key][left].tolist() for key in ("body", "carrier", "x", "y", "radius"))
        for body, carrier, x, y, radius in zip(*columns, strict=True):
            name = names.get(int(body), "")
            where = f"{read.tree.file}:{lines[name]}" if read is not None and name else ""
            place = f"({1e3 * x:.1f}, {1e3 * y:.1f})"
            cells = (str(body), carrier, place, f"{1e3 * radius:.1f}", name, where)
            yield tuple(escaped(cell) for cell in cells)

    if not left.any():
        return "<p>None: it runs on belts or skids.</p>"
    head = ("number", "carrier", "x, y [mm]", "radius [mm]", "in the file", "line")
    return grid(head, rows(), label="wheels of the left side")


_NAMES = {
    "robot.center_of_mass": "centre of mass",
    "robot.center_of_mass[0]": "centre of mass, x",
    "robot.center_of_mass[1]": "centre of mass, y",
    "robot.belly[*][1]": "belly, height",
}


def field_name(path: str) -> str:
    """Say in words which field of a scenario a path is."""
    if path in _NAMES:
        return _NAMES[path]
    return path.removeprefix("robot.").replace(".", ": ").replace("_", " ")


def _has(robot: Robot, path: str) -> bool:
    node: Any = robot
    for step in path.split("."):
        node = getattr(node, step)
        if node is None:
            return False
    return True


def _source(source: str) -> str:
    if source.startswith("estimate"):
        return f'<strong class="estimate">estimate</strong>{escaped(source[len("estimate") :])}'
    return escaped(source)


def _value(robot: Robot, path: str) -> str:
    """Write a figure with its unit."""
    value: Any = read_path(robot, path.removeprefix("robot."))
    unit = unit_of(path)
    after = "" if unit in (None, "1") else f" {unit}"
    if value is None:
        return "none"
    if hasattr(value, "in_words"):
        return str(value.in_words)
    if isinstance(value, tuple) and value and isinstance(value[0], tuple):
        spans = (words.span([point[axis] for point in value], ".3f") for axis in (0, 1))
        x, y = spans
        return f"{len(value)} corners, x {x}{after}, y {y}{after}"
    if isinstance(value, tuple):
        return f"({', '.join(f'{each:.4g}' for each in value)}){after}"
    return f"{value:.4g}{after}" if isinstance(value, float) else f"{value}{after}"
