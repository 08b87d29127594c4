"""Runs side by side in a page: their data and layout."""

from __future__ import annotations

from typing import TYPE_CHECKING

from crawler2d.drawings.svg import escape
from crawler2d.pictures.page import as_json, read_part, scene_script
from crawler2d.pictures.page.recording import recording

if TYPE_CHECKING:
    from collections.abc import Sequence

    from crawler2d.results.record import Record

__all__ = ["INTERVAL", "pair_data", "pair_figure", "pair_parts", "pair_script", "pair_style"]

INTERVAL = 0.04
"""[s] Time between samples: 25 pictures a second, a quarter of the usual."""

_MOST = 300
"""Number of samples of a run in the page; those of slow and long runs are farther apart."""

_LOOKS = {"seized": "bad", "cleared": "good"}


def pair_style() -> str:
    """Return the style of runs side by side."""
    return read_part("replay.css") + read_part("pair.css")


def pair_script(script: str) -> str:
    """Return the script of a page with runs side by side, which ends with its own."""
    return scene_script(read_part("pair.js"), script)


def pair_parts() -> dict[str, str]:
    """Return the controls and the legend of runs side by side, for the placeholders of a page."""
    return {"pair_controls": read_part("pair.html"), "pair_keys": read_part("pair_keys.html")}


def pair_figure(name: str, run: Record) -> str:
    """Write the element for the picture of a run, with its name and outcome."""
    if run.error is not None:
        return f"<p><b>{escape(name)}</b> no result: {escape(str(run.error))}</p>"
    end = run.ending.replace("_", " ")
    look = _LOOKS.get(str(run.outcome), "quiet")
    return (
        f'<figure><figcaption><b>{escape(name)}</b> <strong class="{look}">{end}</strong>'
        f'</figcaption><canvas tabindex="0" role="img" aria-label="{escape(name)}, side view:'
        f' {end}" aria-describedby="keys"></canvas></figure>'
    )


def pair_data(runs: Sequence[Record], name: str) -> str:
    """Write the data of runs as inert text with this id."""
    shown = [recording(run, most=_MOST) for run in runs if run.error is None]
    return f'<script type="application/json" id="{name}">{as_json(shown)}</script>'
