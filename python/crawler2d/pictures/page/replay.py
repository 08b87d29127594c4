"""From a run to one self-contained HTML page: no network, no other file."""

from __future__ import annotations

import base64
import hashlib
import html
import json
from importlib.resources import files
from string import Template
from typing import TYPE_CHECKING

from crawler2d import _core
from crawler2d.common.markup import escaped
from crawler2d.pictures.ghosts import ghosts
from crawler2d.pictures.page.recording import recording
from crawler2d.pictures.page.words import all_figures, figures, heading, sentence, verdict

if TYPE_CHECKING:
    from crawler2d.results.findings import Mechanism
    from crawler2d.results.record import Record

__all__ = ["replay_page"]

# Joined into one script; each part uses only those before it.
_SCRIPTS = (
    "data.js",
    "camera.js",
    "marks.js",
    "carrier.js",
    "robot.js",
    "lane.js",
    "scene.js",
    "strip.js",
    "pointer.js",
    "replay.js",
)

# Escaped as \u sequences, these mean the same in JSON and nothing in HTML.
_MARKUP = str.maketrans({"<": "\\u003c", ">": "\\u003e", "&": "\\u0026"})


def replay_page(run: Record, time: float | None = None) -> str:
    """Write the page of a run; see `Run.to_html`."""
    data = recording(run, time)
    style = _read("replay.css")
    script = '"use strict";\n(() => {\n' + "\n".join(map(_read, _SCRIPTS)) + "})();\n"
    title = heading(run)
    subject, _, ending = title.rpartition(": ")
    outcome = verdict(run)
    mechanism = [] if run.mechanism is None else [run.mechanism]
    why = sentence(run)
    # One pass, so that a robot's name stays text even if it looks like a placeholder.
    return Template(_read("page.html")).substitute(
        title=escaped(title),
        subject=escaped(subject),
        ending=escaped(ending.replace("_", " ")),
        outcome_class=html.escape(outcome.replace(" ", "-")),
        outcome_meaning="" if run.outcome is None else _tooltip(run.outcome.meaning),
        mechanism="".join(_mechanism(each) for each in mechanism),
        trials=_trials(run),
        sentence=f'<p class="sentence">{escaped(why)}</p>' if why else "",
        thinned=_thinned(data["every"], data["samples"]),
        figures=_listed(figures(run)),
        all_figures=_listed(all_figures(run)),
        version=escaped(str(_core.build_info()["version"])),
        identity=run.scenario.identity[:16],
        style=style,
        style_hash=_hash(style),
        script=script,
        script_hash=_hash(script),
        data=json.dumps(data, allow_nan=False, separators=(",", ":")).translate(_MARKUP),
    )


def _read(name: str) -> str:
    return (files("crawler2d.pictures.page") / name).read_text(encoding="utf-8")


def _hash(text: str) -> str:
    """Name the one script, or style, that the page's security policy allows."""
    return base64.b64encode(hashlib.sha256(text.encode()).digest()).decode("ascii")


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
