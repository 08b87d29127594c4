"""Parts of the page of an audit: what it found, tables of figures, and drawings."""

from __future__ import annotations

import math
import re
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from crawler2d import _core
from crawler2d.audits import words
from crawler2d.audits.audited import command_of, names_of
from crawler2d.common.units import unit_of
from crawler2d.drawings.scene import Scene, extent_of
from crawler2d.drawings.svg import MARGIN, Sheet, draw_robot_on, escaped
from crawler2d.errors import ignore_doubts
from crawler2d.parameters.fields import read_path
from crawler2d.parameters.scenario import Scenario
from crawler2d.parameters.terrain import Flat
from crawler2d.variation.distributions import Ranges

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from crawler2d.audits.audited import Audited
    from crawler2d.audits.candidates import Pocket
    from crawler2d.audits.lint import Finding
    from crawler2d.audits.repairs import Repair
    from crawler2d.parameters.robot import Robot
    from crawler2d.reading.assembly import Silhouette

__all__ = [
    "answer_section",
    "best",
    "change",
    "command",
    "field_name",
    "figures",
    "folded",
    "grid",
    "lint_section",
    "made",
    "pockets_drawn",
    "repair_section",
    "robot_drawn",
    "unknowns",
    "verdict_section",
    "wheels",
]

_LARGEST, _SMALLEST = 13.0, 5.0  # [px] of numbers; smaller ones cannot be read and are left out
_LETTER = 0.7  # of the size: how wide a letter is
_TOGETHER = 1e-6  # [m] Wheels nearer than this are in one place.

_WIDTH = 230.0  # [px] of the widest
_ROUND = 0.04  # of the widest, round each
_CHORDS = 24
_DIGITS = 5  # [m] Pockets that are equal to a hundredth of a millimetre are drawn once.

_SCREEN = (
    "A screen of the geometry, not a verdict: whether ground stays in a pocket depends on the whole"
    " robot, and robots have seized in pockets that these figures call harmless. All are drawn to"
    " one scale, in the frame of the belt, front to the right."
)


def robot_drawn(
    robot: Robot,
    title: str,
    shapes: Sequence[Silhouette] = (),
    *,
    width: float = 760.0,
    height: float = 300.0,
) -> str:
    """Draw a robot in the frame of its chassis over collision shapes, as one SVG element.

    `title` is for those who cannot see it, `width` and `height` [px] are the most that it may have.
    """
    with ignore_doubts():  # showing an object must not warn
        scene = Scene.of_robot(Scenario(robot, Flat()).to_json())
    seen = [each.outline for each in shapes if len(each.outline) > 2]
    extent = extent_of(*scene.outlines(0), *seen, margin=MARGIN)
    sheet = Sheet(extent, width, height)
    for outline in _different(seen):
        sheet.line(outline, 'class="collision"')
    draw_robot_on(sheet, scene)
    _number(sheet, robot)
    return sheet.svg(title)


def _different(outlines: list[np.ndarray[tuple[int, int]]]) -> list[np.ndarray[tuple[int, int]]]:
    """Leave out what lies on what is there: the two sides of a robot are the same."""
    found = {tuple(each.round(6).ravel().tolist()): each for each in outlines}
    return list(found.values())


def _number(sheet: Sheet, robot: Robot) -> None:
    """Write the numbers of the wheels of the left side on them; several in one place together."""
    table = robot.wheels()
    left = table["side"] == "left"
    columns = (table[name][left].tolist() for name in ("x", "y", "radius", "body"))
    places: dict[tuple[float, float], tuple[float, list[int]]] = {}
    for x, y, radius, body in zip(*columns, strict=True):
        near = (each for each in places if math.dist(each, (x, y)) < _TOGETHER)
        place = next(near, (x, y))
        widest, bodies = places.get(place, (0.0, []))
        places[place] = max(widest, radius), [*bodies, int(body)]
    for place, (radius, bodies) in places.items():
        text = ", ".join(map(str, bodies))
        others = [math.dist(place, each) for each in places if each != place]
        room = sheet.scale * min([2.0 * radius, *others])
        size = min(_LARGEST, room / (_LETTER * len(text)))
        if size >= _SMALLEST:
            look = f'class="number" font-size="{size:.1f}" text-anchor="middle" dy="0.36em"'
            sheet.label(place, text, look)


def pockets_drawn(robot: Robot, pockets: Sequence[Pocket]) -> str:
    """Draw every pocket that differs from the others, with the wheels that it is between."""
    if not pockets:
        return "<p>None: there are no neighbouring wheels.</p>"
    table = robot.wheels()
    radii = dict(zip(table["body"].tolist(), table["radius"].tolist(), strict=True))
    alike: dict[tuple[float, ...], list[Pocket]] = {}
    for each in pockets:
        rear, front = (radii[body] for body in each.bodies)
        sizes = (each.width, each.gap, rear, front)
        alike.setdefault(tuple(round(size, _DIGITS) for size in sizes), []).append(each)
    span = max(rear + width + front for width, _, rear, front in alike)
    scale = _WIDTH / (span * (1.0 + 2.0 * _ROUND))
    top = 1.1 * max(max(rear, front) for _, _, rear, front in alike)
    figures = "".join(
        _figure(group, rear, front, scale, top) for (_, _, rear, front), group in alike.items()
    )
    return f'<p class="about">{_SCREEN}</p><div class="pockets">{figures}</div>'


def _figure(group: list[Pocket], rear: float, front: float, scale: float, top: float) -> str:
    pocket = group[0]
    margin = _ROUND * _WIDTH / scale
    left, right, bottom = -rear - margin, pocket.width + front + margin, -3.0 * margin
    sheet = Sheet((left, right, bottom, top), scale * (right - left), 1.01 * scale * (top - bottom))
    sheet.line(_open(pocket, rear, front), 'class="open"')
    sheet.circle((0.0, rear), rear, 'class="wheel"')
    sheet.circle((pocket.width, front), front, 'class="wheel"')
    sheet.line([(-rear, 0.0), (pocket.width + front, 0.0)], 'class="belt"', is_closed=False)
    _mark(sheet, pocket, rear, front, margin)
    places = ", ".join("-".join(map(str, each.bodies)) for each in group)
    carriers = " or ".join(dict.fromkeys(each.carrier for each in group))
    title = f"{'slot' if pocket.is_slot else 'pocket'} between wheels {places} of the {carriers}"
    return (
        f"<figure>{sheet.svg(title)}<figcaption><strong>{escaped(places)}</strong>"
        f" {escaped(carriers)}<br>{escaped(_measures(group))}</figcaption></figure>"
    )


def _measures(group: list[Pocket]) -> str:
    pocket = group[0]
    wide = f"{1e3 * pocket.width:.1f} mm wide"
    if pocket.is_slot:
        return f"slot, {wide}, {1e3 * pocket.gap:.1f} mm open: an edge gets through"
    held = words.held([each.friction for each in group])
    return f"pocket, {wide}, {1e3 * pocket.depth:.1f} mm deep; by its walls alone it holds {held}"


def _bottom(pocket: Pocket, rear: float, front: float) -> tuple[float, float]:
    """[m] Where the wheels are nearest, or cross: from where the belt leaves the rear wheel."""
    if not pocket.is_slot:
        return math.sqrt(max(rear**2 - (rear - pocket.depth) ** 2, 0.0)), pocket.depth
    apart = math.hypot(pocket.width, front - rear)
    part = (rear + 0.5 * pocket.gap) / apart
    return part * pocket.width, rear + part * (front - rear)


def _open(pocket: Pocket, rear: float, front: float) -> NDArray[np.float64]:
    """[m] The outline of what is open: along the rear wheel up, along the front wheel down."""
    x, y = _bottom(pocket, rear, front)
    up = _arc((0.0, rear), rear, math.atan2(x, rear - y))
    down = _arc((pocket.width, front), front, math.atan2(x - pocket.width, front - y))
    return np.vstack([up, down[::-1]])


def _arc(center: tuple[float, float], radius: float, to: float) -> NDArray[np.float64]:
    """[m] Points of a wheel from its lowest to an angle [rad] from there, above 0 to the front."""
    angles = np.linspace(0.0, to, _CHORDS)
    return np.asarray(center) + radius * np.column_stack([np.sin(angles), -np.cos(angles)])


def _mark(sheet: Sheet, pocket: Pocket, rear: float, front: float, margin: float) -> None:
    """Draw the width below the belt, and the depth above it."""
    level = -1.5 * margin
    sheet.line([(0.0, level), (pocket.width, level)], 'class="measure"', is_closed=False)
    for x in (0.0, pocket.width):
        sheet.line([(x, 0.0), (x, level - 0.5 * margin)], 'class="measure"', is_closed=False)
    if not pocket.is_slot:
        x, y = _bottom(pocket, rear, front)
        sheet.line([(x, 0.0), (x, y)], 'class="measure"', is_closed=False)


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


_JAMS = (
    "the last columns tell of the runs that seized: between which wheels most are jammed, and how"
    " many of all; how often it seizes at each speed, the slowest first; between which frictions of"
    " the floor they are; and how many a change frees:"
    " a belt closed round the wheels in this pose, or the same set clear of the ground, twice the"
    " torque, twice the friction"
)


def best(audit: Audited) -> Repair | None:
    """Return the repair to show: by wheels, which a file can be given, before belts."""
    return min(
        audit.repairs, key=lambda each: (not each.confirmed, each.kind == "belt"), default=None
    )


def change(audit: Audited, repair: Repair) -> str:
    """Say what a repair changes; why the belts are those that they are stands elsewhere."""
    return repair.what.removesuffix(f" ({audit.belt.reason})")


def answer_section(audit: Audited) -> str:
    """Say in a sentence or two where the robot seizes, and what ends that."""
    every, repair = audit.verdicts, best(audit)
    judged = [each for each in every if each.word == "seizes"]
    seized = judged or [each for each in every if each.where]
    if not seized:
        unsure = sum(each.word == "not certain" for each in every)
        but = f"; {unsure} of them take more runs to be certain of" if unsure else ""
        return (
            f'<strong class="good">It seized in no run over {len(every)} obstacles</strong>{but}.'
        )
    worst = max(seized, key=lambda each: each.seized.rate)
    said = f"It seizes on {len(seized)} of {len(every)} obstacles where a belt clears"
    if not judged:
        runs = f"in runs over {len(seized)} of {len(every)} obstacles"
        said = f"By the rule it seizes nowhere, but {runs}"
    wheels = " and ".join(worst.where.split("-"))
    text = (
        f'<strong class="{"bad" if judged else "warning"}">{said}</strong>'
        f"{', most often on' if len(seized) > 1 else ':'} {escaped(worst.obstacle)}"
        f" ({words.percent(worst.seized.rate)} of the runs), between wheels {wheels} of the"
        f" {worst.carrier}."
    )
    if repair is None:
        return text
    if repair.confirmed:
        what = escaped(change(audit, repair))
        return f"{text} What ends that, confirmed in fresh runs: <strong>{what}</strong>."
    return f"{text} No repair was confirmed."


def lint_section(audit: Audited) -> str:
    """List what lint found: errors, and the rest folded."""
    if not audit.lint:
        return "<p>Nothing found.</p>"
    errors = [each for each in audit.lint if each.severity == "error"]
    others = [each for each in audit.lint if each.severity != "error"]
    counts = Counter(each.severity for each in others)
    head = ", ".join(f"{count} {kind}{'s' * (count > 1)}" for kind, count in counts.items())
    return _findings(errors) + (folded(head, _findings(others)) if others else "")


def _findings(found: Sequence[Finding]) -> str:
    rows = "".join(
        f'<li><strong class="{escaped(each.severity)}">{escaped(each.severity)}</strong>'
        f" <b>{escaped(each.rule)}</b>: {escaped(each.what)}"
        f"{f' <code>{escaped(each.where)}</code>' if each.where else ''}</li>"
        for each in found
    )
    return f'<ul class="lint">{rows}</ul>' if rows else ""


def verdict_section(audit: Audited, replays: Mapping[str, int]) -> str:
    """Write the verdicts, each with where it jams, what frees it, and the way to its replay."""
    jams = any(each.where for each in audit.verdicts)
    head = (*words.VERDICT_HEAD, *(words.JAM_HEAD[1:] if jams else ()))
    rows = []
    for each in audit.verdicts:
        name, *cells = (escaped(cell) for cell in words.verdict(each))
        if each.obstacle in replays:
            name = f'<a href="#replay-{replays[each.obstacle]}">{name}</a>'
        cells[-1] = f'<strong class="{_class(each.word)}">{cells[-1]}</strong>'
        if jams:
            jam = words.jam(each)[1:] if each.where else ("",) * len(words.JAM_HEAD[1:])
            cells += map(escaped, jam)
        rows.append((name, *cells))
    notes = [each for each in words.conclusion(audit) if each != words.reservation(audit)]
    notes += map(_sentence, (words.calls(audit), words.lost(audit), _JAMS if jams else ""))
    below = "".join(f"<p>{escaped(note)}</p>" for note in notes if note)
    table = grid(head, rows, label="verdicts", look="wide")
    return table + folded("in words, and what the columns tell", below)


def repair_section(audit: Audited, diffs: Mapping[str, str]) -> str:
    """Write what came of each repair, the robot with it, and what of `diffs` it has, by `what`."""
    found = audit.repaired
    if found is None:
        asked = (
            "Nothing seizes, so none were searched for."
            if not audit.seizes
            else "None were searched for."
        )
        return f"<p>{asked}</p>"
    head = (
        "repair",
        "in fresh runs",
        "clears at least, of what the belt clears where it seized",
        "seizes at most",
        "most on",
        "wheels a side",
        "simulated speed",
    )
    rows = []
    for each in found.repairs:
        cleared, seized, where = words.worst(each)
        kind = "good" if each.confirmed else "quiet"
        rows.append(
            (
                escaped(each.what),
                f'<strong class="{kind}">{words.confirmed(each)}</strong>',
                words.share(cleared) if cleared.runs else escaped(words.beside(each)),
                words.share(seized),
                escaped(where),
                str(each.wheels or "belt"),
                f"{each.speed:.2g} times",
            )
        )
    text = f"<p>{escaped(_sentence(words.repairs_found(found, audit.vary)))}</p>"
    drawn = "".join(_picture(each, diffs.get(each.what)) for each in found.repairs)
    return (
        f'{text}{grid(head, rows, label="repairs", look="many")}<div class="repairs">{drawn}</div>'
    )


def _picture(repair: Repair, diff: str | None) -> str:
    picture = robot_drawn(repair.robot, f"the robot: {repair.what}", width=560.0, height=200.0)
    change = ""
    if diff is not None:
        change = folded("what changes in the file", f'<pre tabindex="0">{escaped(diff)}</pre>')
    return (
        f'<figure class="robot">{picture}<figcaption>{escaped(repair.what)}</figcaption>{change}'
        "</figure>"
    )


def _sentence(text: str) -> str:
    return f"{text[0].upper()}{text[1:]}." if text else ""


def _class(word: str) -> str:
    return {"seizes": "bad", "does not seize": "good"}.get(word, "quiet")
