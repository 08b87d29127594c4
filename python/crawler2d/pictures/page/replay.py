"""From a run to one self-contained HTML page: no network, no other file."""

from __future__ import annotations

import html
from string import Template
from typing import TYPE_CHECKING

from crawler2d import _core
from crawler2d.common.markup import escaped
from crawler2d.pictures.ghosts import ghosts
from crawler2d.pictures.page.parts import (
    as_json,
    page_template,
    policy,
    read_part,
    replay_style,
    scene_script,
)
from crawler2d.pictures.page.recording import recording
from crawler2d.pictures.page.words import all_figures, figures, sentence, verdict

if TYPE_CHECKING:
    from crawler2d.results.findings import Mechanism
    from crawler2d.results.record import Record

__all__ = ["replay_page"]


def replay_page(run: Record, time: float | None = None) -> str:
    """Write the page of a run; see `Run.to_html`."""
    style, script = replay_style(), scene_script(read_part("strip.js"), read_part("replay.js"))
    data = recording(run, time)
    title = run.title
    subject, _, ending = title.rpartition(": ")
    outcome = verdict(run)
    mechanism = [] if run.mechanism is None else [run.mechanism]
    why = sentence(run)
    values = {
        "title": escaped(title),
        "subject": escaped(subject),
        "ending": escaped(ending.replace("_", " ")),
        "outcome_class": html.escape(outcome.replace(" ", "-")),
        "outcome_meaning": "" if run.outcome is None else _tooltip(run.outcome.meaning),
        "mechanism": "".join(_mechanism(each) for each in mechanism),
        "trials": _trials(run),
        "sentence": f'<p class="sentence">{escaped(why)}</p>' if why else "",
        "thinned": _thinned(data["every"], data["samples"]),
        "figures": _listed(figures(run)),
        "all_figures": _listed(all_figures(run)),
        "version": escaped(str(_core.build_info()["version"])),
        "identity": run.scenario.identity[:16],
        "style": style,
        "script": script,
        "style_hashes": policy(style),
        "script_hashes": policy(script),
        "data": as_json(data),
    }
    # One pass, so that a robot's name stays text even if it looks like a placeholder.
    return Template(page_template("page.html")).substitute(values)


def _thinned(every: int, samples: int) -> str:
    if every == 1:
        return ""
    text = f"Long run: 1 in {every} samples shown, {samples} in all."
    return f'<p class="thinned">{text}</p>'


def _tooltip(meaning: str) -> str:
    return f' title="{escaped(meaning)}"'


def _mechanism(mechanism: Mechanism) -> str:
    meaning = f"how the ground inside is held: {mechanism.meaning}"
    return f'<li class="mechanism"{_tooltip(meaning)}>{escaped(str(mechanism))}</li>'


def _trials(run: Record) -> str:
    """List what was tried as buttons that show where the robot ended."""
    tried = ghosts(run)
    if not tried:
        return ""
    buttons = "".join(
        f'<button type="button" class="trial{" freed" * each.freed}" data-trial="{number}"'
        f' aria-pressed="false"{_tooltip(each.meaning)}>{escaped(each.said)}</button>'
        for number, each in enumerate(tried)
    )
    head = "tried at the stop; press one to see where the robot ended:"
    return f'<section class="trials" aria-label="trials"><p>{head}</p>{buttons}</section>'


def _listed(rows: list[tuple[str, str]]) -> str:
    return "".join(
        f"<div><dt>{escaped(name)}</dt><dd>{escaped(value)}</dd></div>" for name, value in rows
    )
