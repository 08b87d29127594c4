"""From a run to one self-contained HTML page, by itself or in a notebook."""

from __future__ import annotations

import base64
import hashlib
import html
import json
import math
from importlib.resources import files
from string import Template
from typing import TYPE_CHECKING, Any

from crawler2d import _core
from crawler2d.common.units import METRICS
from crawler2d.drawings.svg import escape, table
from crawler2d.pictures.page.recording import recording
from crawler2d.pictures.scenes import ghosts

if TYPE_CHECKING:
    from crawler2d.results.record import Record

__all__ = [
    "FRAME_HEIGHT",
    "as_json",
    "embed",
    "fill_page",
    "main_figures",
    "read_part",
    "replay_page",
    "scene_script",
]

_HERE = "crawler2d.pictures.page"

# Scripts that draw a run from the side; each uses only those before it.
_SCENE = (
    "data.js",
    "camera.js",
    "marks.js",
    "carrier.js",
    "robot.js",
    "lane.js",
    "scene.js",
    "pointer.js",
    "player.js",
)

# [px] Fits header, picture, controls and time strip; the metrics below need scrolling.
FRAME_HEIGHT = 820

# Escaped as \u sequences, these mean the same in JSON and nothing in HTML.
_MARKUP = str.maketrans({"<": "\\u003c", ">": "\\u003e", "&": "\\u0026"})


# metric, label, factor from the metric's unit, unit shown, decimals
_FIGURES = (
    ("time", "simulated time", 1.0, "s", 2),
    ("time_to_clear", "cleared after", 1.0, "s", 2),
    ("distance", "distance", 1.0, "m", 3),
    ("track_distance", "track travel", 1.0, "m", 3),
    ("max_angle", "largest angle, nose up", math.degrees(1.0), "°", 1),
    ("min_angle", "largest angle, nose down", -math.degrees(1.0), "°", 1),
    ("drive_work", "motor work", 1.0, "J", 1),
    ("stopped_time", "time in stops", 1.0, "s", 2),
    ("intrusion_depth", "intrusion depth at the end", 1e3, "mm", 1),
    ("intrusion_force", "intrusion force at the end", 1.0, "N", 0),
)
# Shown only if not zero.
_RARE = {"time_to_clear", "stopped_time", "intrusion_depth", "intrusion_force", "min_angle"}


def read_part(name: str, package: str = _HERE) -> str:
    """Read a file of a package."""
    return (files(package) / name).read_text(encoding="utf-8")


def scene_script(*parts: str) -> str:
    """Join the scripts that draw a run from the side and those of a page into one."""
    return '"use strict";\n(() => {\n' + "\n".join([*map(read_part, _SCENE), *parts]) + "})();\n"


def fill_page(
    file: str,
    style: str,
    script: str = "",
    package: str = _HERE,
    /,
    script_sources: str = "",
    **values: object,
) -> str:
    """Fill the body of a page, below the head that all pages have.

    Parameters
    ----------
    file : str
        The body, in `package`.
    style : str
        Additional style of the page.
    script : str
        Script of the page; "" allows none.
    package : str
        Package of the body.
    script_sources : str
        Script sources that its security policy allows in addition.
    **values : object
        Values of its placeholders, as HTML; `title` is that of the head.
    """
    style = read_part("page.css") + style
    # One pass, so that a robot's name stays text even if it looks like a placeholder.
    return Template(read_part("head.html") + read_part(file, package)).substitute(
        values,
        version=escape(str(_core.build_info()["version"])),
        style=style,
        script=script,
        style_hashes=_policy(style),
        script_hashes=_policy(script) if script else "'none'",
        script_sources=script_sources,
    )


def _policy(text: str) -> str:
    """Return the hash of a script or style for the security policy of a page."""
    digest = hashlib.sha256(text.encode()).digest()
    return f"'sha256-{base64.b64encode(digest).decode('ascii')}'"


def as_json(data: Any) -> str:
    """Write data as JSON without characters that have a meaning in HTML."""
    return json.dumps(data, allow_nan=False, separators=(",", ":")).translate(_MARKUP)


def main_figures(run: Record) -> list[tuple[str, str]]:
    """Return the main metrics: label, and value with unit."""
    chosen = []
    for name, label, scale, unit, digits in _FIGURES:
        value = run.metrics.get(name, 0.0)
        shown = f"{scale * value:z.{digits}f}"
        if name in _RARE and (not math.isfinite(value) or float(shown) == 0.0):
            continue
        chosen.append((label, f"{shown}{'' if unit == '°' else ' '}{unit}"))
    return chosen


def _all_figures(run: Record) -> list[tuple[str, str]]:
    """List every metric by its own name, in its own unit; a time that never comes is infinite."""
    return [
        (name, "never" if value == math.inf else f"{value:.6g} {METRICS.get(name, '')}")
        for name, value in run.metrics.items()
    ]


def replay_page(run: Record, time: float | None = None) -> str:
    """Write the page of a run; see `Run.to_html`."""
    data = recording(run, time)
    outcome = "" if run.outcome is None else str(run.outcome).replace("_", "-")
    mechanism = ""
    if run.mechanism is not None:
        meaning = f"how the ground inside is held: {run.mechanism.meaning}"
        name = escape(str(run.mechanism))
        mechanism = f'<li class="mechanism"{_tooltip(meaning)}>{name}</li>'
    return fill_page(
        "page.html",
        read_part("replay.css"),
        scene_script(read_part("strip.js"), read_part("replay.js")),
        title=escape(run.title),
        subject=escape(run.subject),
        ending=escape(run.ending.replace("_", " ")),
        outcome_class=escape(outcome),
        outcome_meaning="" if run.outcome is None else _tooltip(run.outcome.meaning),
        mechanism=mechanism,
        trials=_trials(run),
        sentence=f'<p class="sentence">{escape(run.reason)}</p>' if run.reason else "",
        thinned=_thinned(data["every"], data["samples"]),
        figures=_listed(main_figures(run)),
        all_figures=_listed(_all_figures(run)),
        simulated_by=escape(str(run.build["version"])),
        identity=run.scenario.identity[:16],
        data=as_json(data),
    )


def _thinned(every: int, samples: int) -> str:
    if every == 1:
        return ""
    text = f"Long run: 1 in {every} samples shown, {samples} in all."
    return f'<p class="thinned">{text}</p>'


def _tooltip(meaning: str) -> str:
    return f' title="{escape(meaning)}"'


def _trials(run: Record) -> str:
    """List the trials as buttons that show where the robot ended."""
    tried = ghosts(run)
    if not tried:
        return ""
    buttons = "".join(
        f'<button type="button" class="trial{" freed" * each.freed}" data-trial="{number}"'
        f' aria-pressed="false"{_tooltip(each.meaning)}>{escape(each.result)}</button>'
        for number, each in enumerate(tried)
    )
    head = "tried at the stop; press one to see where the robot ended:"
    return f'<section class="trials" aria-label="trials"><p>{head}</p>{buttons}</section>'


def _listed(rows: list[tuple[str, str]]) -> str:
    return "".join(
        f"<div><dt>{escape(name)}</dt><dd>{escape(value)}</dd></div>" for name, value in rows
    )


def embed(run: Record) -> str:
    """Show a run in a notebook: the page in a frame, or else its metrics; never raises.

    Returns
    -------
    str
        HTML.
    """
    try:
        page = replay_page(run)
    except Exception:  # the display of a run must never fail
        return _summary(run)
    # Only scripts are allowed: the page can reach neither the notebook nor the network.
    return (
        f'<iframe srcdoc="{html.escape(page)}" sandbox="allow-scripts" '
        f'title="{escape(run.title)}" '
        f'style="width: 100%; height: {FRAME_HEIGHT}px; border: 0"></iframe>'
    )


def _summary(run: Record) -> str:
    try:
        why = run.reason
    except Exception:
        why = ""
    note = f"<p>{escape(why)}</p>" if why else ""
    return f"<div><p><strong>{escape(run.title)}</strong></p>{note}{table(_all_figures(run))}</div>"
