"""Colours of all figures and styles of their lines, which colour-blind readers can distinguish.

Most are from Okabe and Ito's palette (M. Okabe and K. Ito, Color Universal Design, 2008,
https://jfly.uni-koeln.de/color/); `tests/pictures/test_palette.py` measures how far apart they are
for people who lack one type of cone. Lines also differ in dashes and markers, for prints without
colour. The style sheet of pages, `pictures/page/page.css`, has its own shades of them.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

__all__ = [
    "BLACK",
    "BLUE",
    "GRAY",
    "GREEN",
    "GROUND",
    "LINES",
    "ORANGE",
    "PALE",
    "PURPLE",
    "RED",
    "SKY",
    "VIOLET",
    "look_of",
]

ORANGE, SKY, GREEN = "#E69F00", "#56B4E9", "#009E73"
BLUE, RED, PURPLE = "#0072B2", "#D55E00", "#CC79A7"

BLACK = "#222222"
"""Theirs is pure, and harder than what is drawn with it."""
VIOLET = "#A3327B"
"""PURPLE, dark enough for a thin line on an area filled with PURPLE."""
GRAY, GROUND = "#AAAAAA", "#D9D2C5"
PALE = "#CCCCCC"
"""A grey for areas, lighter than all colours: colour-blind readers see GREEN and PURPLE as grey."""

LINES = (BLUE, ORANGE, GREEN, RED, SKY, PURPLE, BLACK)
"""Colours of the lines in one figure, in order; the eighth has the first colour again, dashed."""

_DASHES = ("-", "--", "-.", ":")
_MARKERS = "osD^vPX*<>"


def look_of(index: int, colors: Sequence[str] = LINES) -> dict[str, Any]:
    """Return colour, dashes and marker of a line by its index in a figure.

    Examples
    --------
    >>> look_of(0)
    {'color': '#0072B2', 'linestyle': '-', 'marker': 'o'}
    >>> look_of(7)
    {'color': '#0072B2', 'linestyle': '--', 'marker': '*'}
    """
    lap, place = divmod(index, len(colors))
    return {
        "color": colors[place],
        "linestyle": _DASHES[(place + lap) % len(_DASHES)],
        "marker": _MARKERS[index % len(_MARKERS)],
    }
