"""Draw a certificate: regions of one or two fields, coloured by their status."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from crawler2d.common.extras import extra
from crawler2d.drawings.canvas import axes_or_new
from crawler2d.drawings.palette import BLACK, GRAY, GREEN, PALE, RED
from crawler2d.pictures.rates import legend_below

if TYPE_CHECKING:
    from collections.abc import Sequence

    import numpy as np
    from matplotlib.axes import Axes
    from numpy.typing import NDArray

__all__ = ["plot_regions"]

_LOOKS: dict[str, tuple[dict[str, Any], str]] = {
    "certified": ({"facecolor": GREEN, "hatch": None}, "no jam: certified"),
    "as a belt": ({"facecolor": PALE, "hatch": "\\\\"}, "a belt can jam, too"),
    "jams": ({"facecolor": RED, "hatch": "...."}, "it can jam"),
    "undecided": ({"facecolor": "white", "hatch": None}, "undecided"),
}
"""Style of regions with each status, and its name in the legend."""


def plot_regions(
    regions: Sequence[tuple[str, NDArray[np.float64], NDArray[np.float64]]],
    ranges: NDArray[np.float64],
    labels: Sequence[str],
    ax: Axes | None,
) -> Axes:
    """Draw regions of one status between their smallest and largest values of one or two fields."""
    ax = axes_or_new(ax, (8.0, 6.0))
    patches = extra("matplotlib.patches", "plot")
    handles: dict[str, Any] = {}
    for status, low, high in regions:
        style, text = _LOOKS[status]
        bottom, top = (low[1], high[1]) if len(low) == 2 else (0.0, 1.0)
        look = {**style, "edgecolor": BLACK if style["hatch"] else GRAY, "linewidth": 0.2}
        size = high[0] - low[0], top - bottom
        ax.add_patch(patches.Rectangle((low[0], bottom), *size, **look))
        handles.setdefault(text, patches.Patch(label=text, **look))
    ax.set(xlim=ranges[0], xlabel=labels[0])
    if len(labels) == 2:
        ax.set(ylim=ranges[1], ylabel=labels[1])
    else:
        ax.set(ylim=(0.0, 1.0), yticks=())
    legend_below(ax, handles=list(handles.values()))
    return ax
