"""A run in a notebook: its page in a frame, or else its metrics."""

from __future__ import annotations

import html
from typing import TYPE_CHECKING

from crawler2d.common.markup import escaped, table
from crawler2d.pictures.page.replay import replay_page
from crawler2d.pictures.page.words import all_figures, sentence

if TYPE_CHECKING:
    from crawler2d.results.record import Record

__all__ = ["embedded"]

# [px] Fits header, picture, controls and time strip; the metrics below need scrolling.
_FRAME_HEIGHT = 820


def embedded(run: Record) -> str:
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
        f'title="{escaped(run.title)}" '
        f'style="width: 100%; height: {_FRAME_HEIGHT}px; border: 0"></iframe>'
    )


def _summary(run: Record) -> str:
    try:
        why = sentence(run)
    except Exception:
        why = ""
    note = f"<p>{escaped(why)}</p>" if why else ""
    return f"<div><p><strong>{escaped(run.title)}</strong></p>{note}{table(all_figures(run))}</div>"
