"""The colours of all figures, and the looks of their lines, which the colour-blind tell apart, too.

Most are of Okabe and Ito's palette (M. Okabe and K. Ito, Color Universal Design, 2008,
https://jfly.uni-koeln.de/color/); `tests/pictures/test_palette.py` measures how far apart they stay
for people who lack one kind of cone. Lines also differ in dashes and markers, for prints without
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
"""PURPLE, dark enough for a thin line on what is filled with it."""
GRAY, GROUND = "#AAAAAA", "#D9D2C5"
PALE = "#CCCCCC"
"""A grey for surfaces, lighter than all colours: to the colour-blind GREEN and PURPLE are grey."""

LINES = (BLUE, ORANGE, GREEN, RED, SKY, PURPLE, BLACK)
"""Of lines in one figure, by their place; the eighth has the first again, dashed."""

_DASHES = ("-", "--", "-.", ":")
_MARKERS = "osD^vPX*<>"


def look_of(index: int, colors: Sequence[str] = LINES) -> dict[str, Any]:
    """Return colour, dashes and marker of a line by its place in a figure.

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
