"""Dimensions as in a technical drawing: thin arrows with lengths in metres beside them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from numpy.typing import NDArray

__all__ = ["height", "radius", "span"]

_COLOR = "#555555"
_TEXT: Any = {"color": _COLOR, "fontsize": "x-small", "zorder": 3}
_THIN: Any = {"color": _COLOR, "linewidth": 0.4, "zorder": 1.8}
_ARROW = {"color": _COLOR, "linewidth": 0.7, "shrinkA": 0.0, "shrinkB": 0.0, "mutation_scale": 7}
# [point] From a line to its label.
_CLEAR = 3.0


def _point(place: NDArray[np.float64]) -> tuple[float, float]:
    return float(place[0]), float(place[1])


def span(
    ax: Axes,
    ends: tuple[NDArray[np.float64], NDArray[np.float64]],
    beside: NDArray[np.float64],
    text: str = "",
) -> None:
    """Draw the distance of two points as an arrow beside them, with its label.

    Parameters
    ----------
    ax : Axes
        Where to draw.
    ends : tuple of 2 ndarrays
        [m] The points.
    beside : ndarray
        [m] Where the arrow starts, in place of the first point.
    text : str
        What it is, before its length.
    """
    shift = beside - ends[0]
    for point in ends:
        # A little beyond the arrow.
        ax.plot(*np.column_stack([point, point + 1.1 * shift]), **_THIN)
    arrow = {**_ARROW, "arrowstyle": "<|-|>"}
    ax.annotate("", _point(ends[0] + shift), _point(ends[1] + shift), arrowprops=arrow)
    way = ends[1] - ends[0]
    turn = float(np.degrees(np.arctan2(way[1], way[0])))
    # Read from below or from the right, on the side that is turned away.
    upright = (turn + 89.0) % 180.0 - 89.0
    up = np.array([-np.sin(np.radians(upright)), np.cos(np.radians(upright))])
    side = 1.0 if shift @ up > 0.0 else -1.0
    ax.annotate(
        f"{text} {np.hypot(*way):.3g} m".strip(),
        _point(0.5 * (ends[0] + ends[1]) + shift),
        xytext=_point(_CLEAR * side * up),
        textcoords="offset points",
        rotation=upright,
        rotation_mode="anchor",
        ha="center",
        va="bottom" if side > 0.0 else "top",
        **_TEXT,
    )


def radius(ax: Axes, center: NDArray[np.float64], length: float, foot: NDArray[np.float64]) -> None:
    """Draw the radius [m] of a circle as an arrow towards a point outside, where its label is."""
    way = foot - center
    rim = center + length * way / np.hypot(*way)
    ax.plot(*np.column_stack([rim, foot]), **_THIN)
    ax.annotate("", _point(rim), _point(center), arrowprops={**_ARROW, "arrowstyle": "-|>"})
    side = 1.0 if way[0] > 0.0 else -1.0
    ax.annotate(
        f"radius {length:.3g} m",
        _point(foot),
        xytext=(_CLEAR * side, 0.0),
        textcoords="offset points",
        ha="left" if side > 0.0 else "right",
        va="center",
        **_TEXT,
    )


def height(ax: Axes, x: float, levels: tuple[float, float]) -> None:
    """Draw a rise or a fall from one level [m] to another at a place [m], its label in the air."""
    start, end = levels
    ax.annotate("", (x, start), (x, end), arrowprops={**_ARROW, "arrowstyle": "<|-|>"})
    rises = end > start
    ax.annotate(
        f"{abs(end - start):.3g} m",
        (x, end if rises else 0.5 * (start + end)),
        xytext=(0.0, _CLEAR) if rises else (_CLEAR, 0.0),
        textcoords="offset points",
        ha="center" if rises else "left",
        va="bottom" if rises else "center",
        **_TEXT,
    )
