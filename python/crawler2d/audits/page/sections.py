"""Sections of the page of an audit: results and tables of figures."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from crawler2d import _core
from crawler2d.audits import words
from crawler2d.audits.candidates import left_wheels
from crawler2d.audits.page.drawings import draw_pockets, draw_robot
from crawler2d.audits.record import command_of, names_of
from crawler2d.common.bodies import BELLY_HEIGHTS
from crawler2d.drawings.svg import escape
from crawler2d.parameters.fields import read_path
from crawler2d.variation.distributions import Ranges

if TYPE_CHECKING:
    from crawler2d.audits.lint import Finding
    from crawler2d.audits.record import AuditRecord
    from crawler2d.audits.repairs import Repair
    from crawler2d.parameters.robot import Robot

__all__ = [
    "answer_section",
    "best_repair",
    "change",
    "command",
    "field_name",
    "fold",
    "lint_section",
    "method_section",
    "repair_section",
    "robot_section",
    "verdict_section",
]

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
"""Fields listed for a robot without a file."""

_NAMES = {
    "robot.center_of_mass": "centre of mass",
    "robot.center_of_mass[0]": "centre of mass, x",
    "robot.center_of_mass[1]": "centre of mass, y",
    BELLY_HEIGHTS: "belly, height",
}

_LONG = re.compile(r"\d+\.\d{4,}")
"""Numbers with too many digits to read."""

_JAMS = (
    "the last columns are about the runs that seized: between which wheels most of them jammed, and"
    " how many of all; how often the robot seizes at each speed, the slowest first; the range of"
    " floor friction; and how many of these runs a change frees: a belt round the wheels in this"
    " pose, or the same belt set clear of the ground, twice the torque, twice the friction"
)


def answer_section(audit: AuditRecord) -> str:
    """Describe in a sentence or two where the robot seizes, and what prevents it."""
    every, repair = audit.verdicts, best_repair(audit)
    certain = [each for each in every if each.result == "seizes"]
    seized = certain or [each for each in every if each.jam_wheels]
    if not seized:
        unsure = sum(each.result == "not certain" for each in every)
        but = f"; {unsure} of them need more runs to be certain" if unsure else ""
        return (
            f'<strong class="good">It seized in no run over {len(every)} obstacles</strong>{but}.'
        )
    worst = max(seized, key=lambda each: each.seized.rate)
    claim = f"It seizes on {len(seized)} of {len(every)} obstacles where a belt clears"
    if not certain:
        runs = f"in runs over {len(seized)} of {len(every)} obstacles"
        claim = f"By the rule it seizes nowhere, but {runs}"
    wheels = " and ".join(worst.jam_wheels.split("-"))
    text = (
        f'<strong class="{"bad" if certain else "warning"}">{claim}</strong>'
        f"{', most often on' if len(seized) > 1 else ':'} {escape(worst.obstacle)}"
        f" ({words.percent(worst.seized.rate)} of the runs), between wheels {wheels} of the"
        f" {worst.carrier}."
    )
    if repair is None:
        return text
    if repair.confirmed:
        what = escape(change(audit, repair))
        return f"{text} What prevents that, confirmed in new runs: <strong>{what}</strong>."
    return f"{text} No repair was confirmed."


def best_repair(audit: AuditRecord) -> Repair | None:
    """Choose the repair to show: wheels, which a file can hold, before belts."""
    return min(
        audit.repairs, key=lambda each: (not each.confirmed, each.kind == "belt"), default=None
    )


def change(audit: AuditRecord, repair: Repair) -> str:
    """Describe a repair, without the reason for the kind of belt."""
    return repair.description.removesuffix(f" ({audit.belt.reason})")


def verdict_section(audit: AuditRecord, replays: Mapping[str, int]) -> str:
    """Write the verdicts, each with its jam, what frees it, and a link to its replay."""
    jams = any(each.jam_wheels for each in audit.verdicts)
    head = (*words.VERDICT_HEAD, *(words.JAM_HEAD[1:] if jams else ()))
    rows = []
    for each in audit.verdicts:
        name, *cells = (escape(cell) for cell in words.verdict_row(each))
        if each.obstacle in replays:
            name = f'<a href="#replay-{replays[each.obstacle]}">{name}</a>'
        cells[-1] = f'<strong class="{_class(each.result)}">{cells[-1]}</strong>'
        if jams:
            jam = words.jam_row(each)[1:] if each.jam_wheels else ("",) * len(words.JAM_HEAD[1:])
            cells += map(escape, jam)
        rows.append((name, *cells))
    notes = [each for each in words.conclusion(audit) if each != words.reservation(audit)]
    notes += map(
        _sentence, (words.wheel_names(audit), words.missing_results(audit), _JAMS if jams else "")
    )
    below = "".join(f"<p>{escape(note)}</p>" for note in notes if note)
    table = _grid(head, rows, label="verdicts", look="wide")
    return table + fold("explanation of the results and columns", below)


def _class(word: str) -> str:
    return {"seizes": "bad", "does not seize": "good"}.get(word, "quiet")


def lint_section(audit: AuditRecord) -> str:
    """List the findings of lint: errors, and the rest folded."""
    if not audit.lint:
        return "<p>Nothing found.</p>"
    errors = [each for each in audit.lint if each.severity == "error"]
    others = [each for each in audit.lint if each.severity != "error"]
    counts = Counter(each.severity for each in others)
    head = ", ".join(f"{count} {kind}{'s' * (count > 1)}" for kind, count in counts.items())
    return _findings(errors) + (fold(head, _findings(others)) if others else "")


def _findings(found: Sequence[Finding]) -> str:
    rows = "".join(
        f'<li><strong class="{escape(each.severity)}">{escape(each.severity)}</strong>'
        f" <b>{escape(each.rule)}</b>: {escape(each.message)}"
        f"{f' <code>{escape(each.where)}</code>' if each.where else ''}</li>"
        for each in found
    )
    return f'<ul class="lint">{rows}</ul>' if rows else ""


def repair_section(audit: AuditRecord, diffs: Mapping[str, str]) -> str:
    """Write the result, robot and diff of each repair."""
    found = audit.repaired
    if found is None:
        none = "No" if audit.seizes else "Nothing seizes, so no"
        return f"<p>{none} repairs were searched for.</p>"
    head = (
        "repair",
        "in new runs",
        "clears at worst, of what the belt clears where it seized",
        "seizes at worst",
        "on",
        "wheels a side",
        "simulated speed",
    )
    rows = []
    for each in found.repairs:
        cleared, seized, where = words.worst_rates(each)
        kind = "good" if each.confirmed else "quiet"
        rows.append(
            (
                escape(each.description),
                f'<strong class="{kind}">{words.confirmation(each)}</strong>',
                words.rate(cleared) if cleared.runs else escape(words.comparison(each)),
                words.rate(seized),
                escape(where),
                str(each.wheels or "belt"),
                f"{each.speed:.2g} times",
            )
        )
    text = f"<p>{escape(_sentence(words.search_sentence(found, audit)))}</p>"
    drawn = "".join(_picture(each, diffs.get(each.description)) for each in found.repairs)
    return (
        f'{text}{_grid(head, rows, label="repairs", look="many")}<div class="repairs">{drawn}</div>'
    )


def _picture(repair: Repair, diff: str | None) -> str:
    picture = draw_robot(
        repair.robot, f"the robot: {repair.description}", width=560.0, height=200.0
    )
    change = ""
    if diff is not None:
        change = fold("what changes in the file", f'<pre tabindex="0">{escape(diff)}</pre>')
    caption = f"<figcaption>{escape(repair.description)}</figcaption>"
    return f'<figure class="robot">{picture}{caption}{change}</figure>'


def robot_section(audit: AuditRecord) -> str:
    """Draw the robot over the shapes of its file, with folded figures."""
    read = audit.reading
    shapes = () if read is None else read.silhouettes
    drawn = (
        '<span class="swatch belly"></span> belly; + centre of mass. Wheels have the numbers that'
        " verdicts and replays name, those of the left side."
    )
    if read is not None:
        drawn = (
            '<span class="swatch collision"></span> collision shapes of the file, all joints at'
            f' zero; <span class="swatch"></span> the robot that was read from them; {drawn}'
        )
    picture = draw_robot(audit.robot, "side view of the robot", shapes)
    parts = [
        f'<figure class="robot">{picture}<figcaption>{drawn}</figcaption></figure>',
        _wheel_table(audit),
        fold("pockets and slots between wheels", draw_pockets(audit.robot, audit.pockets)),
        _figure_table(audit),
        _range_table(audit.unknown, "uncertain, varied over the samples"),
    ]
    if read is not None and read.notes:
        notes = "".join(f"<li>{escape(note)}</li>" for note in read.notes)
        parts.append(fold("decisions made while reading the file", f"<ul>{notes}</ul>"))
    return f"<p>{escape(words.robot_sentence(audit))}</p>{''.join(parts)}"


def _wheel_table(audit: AuditRecord) -> str:
    """List the wheels of the left side by number, with their names and lines in the file."""
    read = audit.reading
    names = names_of(audit.robot, read)
    lines: dict[str, int] = {}
    if read is not None:
        lines = dict(zip(read.wheels["name"].tolist(), read.wheels["line"].tolist(), strict=True))
    rows = []
    for body, carrier, x, y, radius in left_wheels(audit.robot):
        name = names.get(body, "")
        where = f"{read.tree.file}:{lines[name]}" if read is not None and name else ""
        place = f"({1e3 * x:.1f}, {1e3 * y:.1f})"
        rows.append((str(body), carrier, place, f"{1e3 * radius:.1f}", name, where))
    head = ("number", "carrier", "x, y [mm]", "radius [mm]", "in the file", "line")
    return _table(head, rows, "wheels of the left side")


def _figure_table(audit: AuditRecord) -> str:
    """Write every figure with its source; for a robot without a file, the main figures."""
    read, robot = audit.reading, audit.robot
    if read is None:
        paths = [f"robot.{path}" for path in _STATED if _has(robot, path)]
        rows = [(field_name(path), _value(robot, path)) for path in paths]
        return _table(("figure", "value"), rows, "figures of the robot")
    sourced = [
        (
            escape(field_name(path)),
            escape(f"{read.friction:.4g}" if path == "friction" else _value(robot, path)),
            _source(source),
        )
        for path, source in read.sources.items()
    ]
    label = "figures with their sources"
    return fold(label, _grid(("figure", "value", "source"), sourced, label=label))


def _has(robot: Robot, path: str) -> bool:
    node: Any = robot
    for step in path.split("."):
        node = getattr(node, step)
        if node is None:
            return False
    return True


def _source(source: str) -> str:
    if source.startswith("estimate"):
        return f'<strong class="estimate">estimate</strong>{escape(source[len("estimate") :])}'
    return escape(source)


def _value(robot: Robot, path: str) -> str:
    """Write a figure with its unit."""
    value: Any = read_path(robot, path.removeprefix("robot."))
    after = words.unit_after(path)
    if value is None:
        return "none"
    if hasattr(value, "description"):
        return str(value.description)
    if isinstance(value, tuple) and value and isinstance(value[0], tuple):
        spans = (words.span([point[axis] for point in value], ".3f") for axis in (0, 1))
        x, y = spans
        return f"{len(value)} corners, x {x}{after}, y {y}{after}"
    if isinstance(value, tuple):
        return f"({', '.join(f'{each:.4g}' for each in value)}){after}"
    return f"{value:.4g}{after}" if isinstance(value, float) else f"{value}{after}"


def _range_table(ranges: Mapping[str, Any], label: str) -> str:
    """Write ranges and their sources."""
    sources = ranges.sources if isinstance(ranges, Ranges) else {}
    rows = [
        (field_name(path), words.range_of(path, each), sources.get(path, ""))
        for path, each in ranges.items()
    ]
    return _table(("field", "range", "source of the range"), rows, label)


def method_section(audit: AuditRecord) -> str:
    """Write the method of the audit, and its variation."""
    measures = [
        (name, _LONG.sub(lambda found: f"{float(found[0]):.4g}", str(each)))
        for name, each in audit.obstacles.items()
    ]
    return (
        _table(("what", "how"), list(_method(audit)), "how it was made")
        + _range_table(audit.vary, "what differed from run to run")
        + _table(("obstacle", "measures [m], [rad]"), measures, "obstacles")
    )


def _method(audit: AuditRecord) -> Iterator[tuple[str, str]]:
    yield "runs behind the verdicts", f"{words.run_count(audit.table)}: {words.population(audit)}"
    if audit.repaired is not None:
        fresh = words.run_count(audit.repaired.table)
        yield "runs that confirm repairs", f"{fresh}, with draws that no run before had"
    yield "belt for comparison", audit.belt.reason
    yield "drive", str(audit.drive)
    yield "seed of the draws", str(audit.call.seed)
    if audit.reading is not None:
        yield "file", f"{audit.reading.tree.file}, {audit.reading.tree.format}"
        yield "rules of friction and motors", f"those of {audit.reading.engine}"
    build = _core.build_info()
    yield "crawler2d", ", ".join(f"{name} {value}" for name, value in build.items())


def command(audit: AuditRecord) -> str:
    """Write the command or call that repeats the audit."""
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


def field_name(path: str) -> str:
    """Name the field of a path in words."""
    if path in _NAMES:
        return _NAMES[path]
    return path.removeprefix("robot.").replace(".", ": ").replace("_", " ")


def fold(head: str, inside: str) -> str:
    """Fold content below a line of text."""
    return f"<details><summary>{escape(head)}</summary>{inside}</details>"


def _table(head: Sequence[str], rows: Sequence[Sequence[str]], label: str) -> str:
    """Fold a table below its name; cells are text."""
    cells = [[escape(cell) for cell in row] for row in rows]
    return fold(label, _grid(head, cells, label=label) if rows else "<p>None.</p>")


def _grid(head: Sequence[str], rows: Iterable[Sequence[str]], *, label: str, look: str = "") -> str:
    """Write a table whose first column names its rows; wide ones scroll.

    Titles are text, cells HTML; `label` describes it, `look` is a CSS class.
    """
    titles = "".join(f'<th scope="col">{escape(title)}</th>' for title in head)
    body = "".join(
        f'<tr><th scope="row">{first}</th>{"".join(f"<td>{cell}</td>" for cell in others)}</tr>'
        for first, *others in rows
    )
    return (
        f'<div class="scroll {look}" role="group" aria-label="{escape(label)}" tabindex="0">'
        f"<table><thead><tr>{titles}</tr></thead><tbody>{body}</tbody></table></div>"
    )


def _sentence(text: str) -> str:
    return f"{text[0].upper()}{text[1:]}." if text else ""
