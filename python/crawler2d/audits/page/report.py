"""From an audit to one self-contained HTML page: no network, no other file."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from string import Template
from typing import TYPE_CHECKING

from crawler2d import _core
from crawler2d.audits import words
from crawler2d.audits.page import found
from crawler2d.audits.page.drawn import pockets_drawn, robot_drawn
from crawler2d.audits.page.figures import command, figures, folded, made, unknowns, wheels
from crawler2d.audits.page.replayed import replay, replayed
from crawler2d.common.markup import escaped
from crawler2d.pictures.page.parts import (
    as_json,
    page_template,
    policy,
    read_part,
    replay_style,
    scene_script,
)
from crawler2d.pictures.page.recording import recording

if TYPE_CHECKING:
    from crawler2d.audits.audited import Audited
    from crawler2d.audits.page.replayed import Replayed

__all__ = ["audit_page"]

_HERE = "crawler2d.audits.page"
_MOST = 300
"""Samples of a run in the page: those of slow and of long runs are farther apart."""


def audit_page(
    audit: Audited, diffs: Mapping[str, str] | None = None, *, threads: int | None = None
) -> str:
    """Write the page of an audit, with `diffs` by `Repair.what`; see `Audit.to_html`."""
    runs = replayed(audit, threads=threads)
    style = replay_style() + read_part("audit.css", _HERE)
    script = scene_script(read_part("audit.js", _HERE))
    # One pass, so that a name of the file stays text even if it looks like a placeholder.
    return Template(page_template("audit.html", _HERE)).substitute(
        title=escaped(f"{audit.robot.name}: audit"),
        name=escaped(audit.robot.name),
        subject=escaped(words.subject(audit).removeprefix(f"{audit.robot.name}: ")),
        reservation=escaped(words.reservation(audit)),
        answer=found.answer(audit),
        options=_options(runs),
        replays="".join(replay(audit, each, number) for number, each in enumerate(runs)),
        verdicts=found.verdicts(
            audit, {each.place.verdict.obstacle: number for number, each in enumerate(runs)}
        ),
        population=escaped(words.population(audit)),
        belt=escaped(audit.belt.reason),
        lint=found.lint(audit),
        repairs=found.repairs(audit, diffs or {}),
        robot=_robot(audit),
        command=escaped(command(audit)),
        made=made(audit),
        version=escaped(str(_core.build_info()["version"])),
        style=style,
        script=script,
        style_hashes=policy(style),
        script_hashes=policy(script),
        data="\n".join(_data(each, number) for number, each in enumerate(runs)),
    )


def _options(runs: Sequence[Replayed]) -> str:
    """List the obstacles that can be replayed."""
    return "".join(
        f'<option value="{number}">{escaped(place.verdict.obstacle)}:'
        f" {words.percent(place.verdict.seized.rate)} seized</option>"
        for number, (place, *_) in enumerate(runs)
    )


def _data(each: Replayed, number: int) -> str:
    """Write what is drawn of runs as inert text."""
    shown = [recording(run, most=_MOST) for run in each.runs if run.error is None]
    return f'<script type="application/json" id="runs-{number}">{as_json(shown)}</script>'


def _robot(audit: Audited) -> str:
    """Draw the robot over the shapes of its file; its figures are folded."""
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
    picture = robot_drawn(audit.robot, "side view of the robot", shapes)
    parts = [
        f'<figure class="robot">{picture}<figcaption>{drawn}</figcaption></figure>',
        wheels(audit),
        folded("pockets and slots between wheels", pockets_drawn(audit.robot, audit.pockets)),
        figures(audit),
        unknowns(audit.unknown, "not known, and drawn for every sample"),
    ]
    if read is not None and read.notes:
        notes = "".join(f"<li>{escaped(note)}</li>" for note in read.notes)
        parts.append(folded("decided while reading", f"<ul>{notes}</ul>"))
    return f"<p>{escaped(words.robot_sentence(audit))}</p>{''.join(parts)}"
