"""From an audit to one self-contained HTML page: no network, no other file."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from string import Template
from typing import TYPE_CHECKING

from crawler2d import _core
from crawler2d.audits import words
from crawler2d.audits.page import found
from crawler2d.audits.page.figures import figures, unknowns, wheels
from crawler2d.audits.page.made import made
from crawler2d.audits.page.pocket_drawn import pockets_drawn
from crawler2d.audits.page.replayed import replayed
from crawler2d.audits.page.robot_drawn import robot_drawn
from crawler2d.common.markup import escaped
from crawler2d.pictures.page.parts import (
    as_json,
    page_template,
    policy,
    read_part,
    replay_script,
    replay_style,
)
from crawler2d.pictures.page.replay import replay_pieces

if TYPE_CHECKING:
    from crawler2d.audits.audited import Audited
    from crawler2d.audits.page.replayed import Replayed

__all__ = ["audit_page"]

_HERE = "crawler2d.audits.page"


def audit_page(
    audit: Audited, diffs: Mapping[str, str] | None = None, *, threads: int | None = None
) -> str:
    """Write the page of an audit; see `Audit.to_html`.

    Parameters
    ----------
    audit : Audited
        The audit.
    diffs : mapping of str to str, optional
        Changes of the audited file as text, by `Repair.what`.
    threads : int, optional
        For the runs that are replayed; see `simulate_many`.

    Returns
    -------
    str
        The page.
    """
    runs = replayed(audit, threads=threads)
    style = read_part("page.css") + read_part("audit.css", _HERE)
    script = read_part("audit.js", _HERE)
    read = audit.reading
    shapes = () if read is None else read.silhouettes
    # One pass, so that a name of the file stays text even if it looks like a placeholder.
    return Template(page_template("audit.html", _HERE)).substitute(
        title=escaped(f"{audit.robot.name}: audit"),
        subject=escaped(words.subject(audit)),
        badge=_badge(audit),
        conclusion=escaped(" ".join(_conclusion(audit))),
        sentence=escaped(words.robot_sentence(audit)),
        robot=robot_drawn(audit.robot, "side view of the robot", shapes),
        legend=_legend(audit),
        figures=figures(audit),
        wheels=wheels(audit),
        unknown=unknowns(audit.unknown, "what is not known"),
        notes="" if read is None else _listed(read.notes),
        lint=found.lint(audit),
        pockets=pockets_drawn(audit.robot, audit.pockets),
        population=escaped(words.population(audit)),
        belt=escaped(audit.belt.reason),
        verdicts=found.verdicts(audit, runs),
        replays=found.replays(runs),
        repairs=found.repairs(audit, diffs or {}),
        made=made(audit),
        version=escaped(str(_core.build_info()["version"])),
        style=style,
        script=script,
        style_hashes=policy(style, replay_style()),
        script_hashes=policy(script, replay_script()),
        data=_data(runs),
    )


def _conclusion(audit: Audited) -> list[str]:
    """Return the sentences of the conclusion, with the least changed repair that is confirmed."""
    sentences = words.conclusion(audit)
    confirmed = [each for each in audit.repairs if each.confirmed]
    if audit.repaired is not None:
        sentences.append(f"Repairs: {words.repairs_found(audit.repaired, audit.vary)}.")
    if confirmed:
        text = words.repair_sentence(confirmed[0])
        sentences.append(f"{text[0].upper()}{text[1:]}.")
    return sentences


def _badge(audit: Audited) -> str:
    if audit.seizes:
        return "<li>seizes where the belt clears</li>"
    is_sure = all(each.word != "not certain" for each in audit.verdicts)
    look = "cleared" if is_sure else "timed-out"
    return f'<li class="{look}">not found to seize where the belt clears</li>'


def _legend(audit: Audited) -> str:
    drawn = (
        '<span class="swatch belly"></span> belly; + centre of mass. Wheels have the numbers that'
        " verdicts and replays name, those of the left side."
    )
    if audit.reading is None:
        return drawn
    return (
        '<span class="swatch collision"></span> collision shapes of the file, all joints at zero;'
        f' <span class="swatch"></span> the robot that was read from them; {drawn}'
    )


def _listed(notes: Sequence[str]) -> str:
    items = "".join(f"<li>{escaped(note)}</li>" for note in notes)
    return f"<h3>Decided while reading</h3><ul>{items}</ul>" if notes else ""


def _data(runs: Sequence[Replayed]) -> str:
    """Write the replays as inert text: each without the style and script that all have."""
    parts: dict[str, object] = {}
    if runs:
        parts = {"replay-style": replay_style(), "replay-script": replay_script()}
    for number, each in enumerate(runs):
        parts[f"replay-{number}-model"] = replay_pieces(each.run)
        if each.belt is not None:
            parts[f"replay-{number}-belt"] = replay_pieces(each.belt)
    return "\n".join(
        f'<script type="application/json" id="{name}">{as_json(part)}</script>'
        for name, part in parts.items()
    )
