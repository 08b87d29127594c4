"""Tables of an audit: figures of the robot with their sources, its wheels, how it was made."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from crawler2d import _core
from crawler2d.audits import words
from crawler2d.audits.call import command_of
from crawler2d.audits.names import names_of
from crawler2d.common.markup import escaped
from crawler2d.common.units import unit_of
from crawler2d.parameters.paths import read_path
from crawler2d.variation.ranges import Ranges

if TYPE_CHECKING:
    from crawler2d.audits.audited import Audited
    from crawler2d.parameters.robot import Robot

__all__ = ["command", "field_name", "figures", "folded", "grid", "made", "unknowns", "wheels"]

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
    "flippers.rotor_inertia",
    "belly",
    "gauge",
    "drivetrain.max_speed",
    "drivetrain.max_torque",
    "drivetrain.rotor_inertia",
)
"""Of a robot that was not read from a file, whose other fields are where it was made."""

_LONG = re.compile(r"\d+\.\d{4,}")
"""Numbers with more digits than are worth reading."""


def grid(head: Sequence[str], rows: Iterable[Sequence[str]], *, label: str, look: str = "") -> str:
    """Write a table whose first column names its rows; one that is too wide scrolls by itself.

    The titles are text and the cells HTML; `label` says what it is, `look` is a class for the style
    sheet.
    """
    titles = "".join(f'<th scope="col">{escaped(title)}</th>' for title in head)
    body = "".join(
        f'<tr><th scope="row">{first}</th>{"".join(f"<td>{cell}</td>" for cell in others)}</tr>'
        for first, *others in rows
    )
    return (
        f'<div class="scroll {look}" role="group" aria-label="{escaped(label)}" tabindex="0">'
        f"<table><thead><tr>{titles}</tr></thead><tbody>{body}</tbody></table></div>"
    )


def folded(head: str, inside: str) -> str:
    """Fold something away below a line of text."""
    return f"<details><summary>{escaped(head)}</summary>{inside}</details>"


def _table(head: Sequence[str], rows: Sequence[Sequence[str]], label: str) -> str:
    """Fold a table away below its name; cells are text."""
    cells = [[escaped(cell) for cell in row] for row in rows]
    return folded(label, grid(head, cells, label=label) if rows else "<p>None.</p>")


def figures(audit: Audited) -> str:
    """Write every figure with its source; of a robot without a file those that matter."""
    read, robot = audit.reading, audit.robot
    if read is None:
        paths = [f"robot.{path}" for path in _STATED if _has(robot, path)]
        rows = [(field_name(path), _value(robot, path)) for path in paths]
        return _table(("figure", "value"), rows, "figures of the robot")
    sourced = [
        (
            escaped(field_name(path)),
            escaped(f"{read.friction:.4g}" if path == "friction" else _value(robot, path)),
            _source(source),
        )
        for path, source in read.sources.items()
    ]
    label = "figures with their sources"
    return folded(label, grid(("figure", "value", "source"), sourced, label=label))


def unknowns(ranges: Mapping[str, Any], label: str) -> str:
    """Write over which ranges something was drawn, and where these come from."""
    sources = ranges.sources if isinstance(ranges, Ranges) else {}
    rows = [
        (field_name(path), words.range_of(path, each), sources.get(path, ""))
        for path, each in ranges.items()
    ]
    return _table(("field", "range", "source of the range"), rows, label)


def wheels(audit: Audited) -> str:
    """List the wheels of the left side by their numbers; of a file with its names and lines."""
    read, table = audit.reading, audit.robot.wheels()
    left = table["side"] == "left"
    names: dict[int, str] = {} if read is None else names_of(audit.robot, read)
    lines: dict[str, int] = {}
    if read is not None:
        lines = dict(zip(read.wheels["name"].tolist(), read.wheels["line"].tolist(), strict=True))
    rows = []
    columns = (table[key][left].tolist() for key in ("body", "carrier", "x", "y", "radius"))
    for body, carrier, x, y, radius in zip(*columns, strict=True):
        name = names.get(int(body), "")
        where = f"{read.tree.file}:{lines[name]}" if read is not None and name else ""
        place = f"({1e3 * x:.1f}, {1e3 * y:.1f})"
        rows.append((str(body), carrier, place, f"{1e3 * radius:.1f}", name, where))
    head = ("number", "carrier", "x, y [mm]", "radius [mm]", "in the file", "line")
    return _table(head, rows, "wheels of the left side")


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


def made(audit: Audited) -> str:
    """Write how the audit was made, and what differed from run to run."""
    measures = [
        (name, _LONG.sub(lambda found: f"{float(found[0]):.4g}", str(each)))
        for name, each in audit.obstacles.items()
    ]
    return (
        _table(("what", "how"), list(_made(audit)), "how it was made")
        + unknowns(audit.vary, "what differed from run to run")
        + _table(("obstacle", "measures [m], [rad]"), measures, "obstacles")
    )


def _made(audit: Audited) -> Iterator[tuple[str, str]]:
    yield "runs behind the verdicts", f"{words.made(audit.table)}: {words.population(audit)}"
    if audit.repaired is not None:
        fresh = words.made(audit.repaired.table)
        yield "runs that confirm repairs", f"{fresh}, with draws that nothing before has had"
    yield "belt beside it", audit.belt.reason
    yield "drive", str(audit.drive)
    yield "seed of the draws", str(audit.call.seed)
    if audit.reading is not None:
        yield "file", f"{audit.reading.tree.file}, {audit.reading.tree.format}"
        yield "rules of friction and motors", f"those of {audit.reading.engine}"
    build = _core.build_info()
    yield "crawler2d", ", ".join(f"{name} {value}" for name, value in build.items())


def command(audit: Audited) -> str:
    """Write the command that makes the audit again, or else the call."""
    call, read = audit.call, audit.reading
    command = None if read is None else command_of(call, str(read.path))
    if command is not None:
        return command
    arguments = ["robot" if read is None else repr(str(read.path))]
    arguments += [f"{name}=..." for name in call.own]
    arguments += [f"{name}={value!r}" for name, value in call.reading.items()]
    arguments += [
        f"{name}={getattr(call, name)}" for name in ("samples", "repeats", "seed", "repair")
    ]
    return f"crawler2d.audit({', '.join(arguments)}).to_html(path)"
