"""The figure of the study of drives: the highest edge cleared over the rotor inertia."""

from __future__ import annotations

from typing import TYPE_CHECKING

from crawler2d.common.extras import extra
from crawler2d.drawings.scene import BLACK, BLUE, GREEN, ORANGE, PURPLE, RED, SKY

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.figure import Figure

    from research.drive import HighestEdge

__all__ = ["plot_drive"]

# One colour a kind of track.
_COLORS = (BLACK, BLUE, PURPLE, ORANGE, RED, GREEN, SKY)
_MARKERS = ("o", "s", "P", "D", "^", "v", "X", "*", "<", ">")


def plot_drive(found: Sequence[HighestEdge]) -> Figure:
    """Draw the heights that half of the runs clear, one row per obstacle, one column per speed.

    Parameters
    ----------
    found : sequence of HighestEdge
        The drives of each case in one order, which is that of the x axis.

    Returns
    -------
    Figure
        Not shown and not saved.

    Raises
    ------
    ImportError
        If matplotlib is missing; the message names the extra to install.
    """
    figures = extra("matplotlib.figure", "plot")
    obstacles = list(dict.fromkeys(row.obstacle for row in found))
    speeds = list(dict.fromkeys(row.speed for row in found))
    models = list(dict.fromkeys(row.model for row in found))
    drives = list(dict.fromkeys(row.drive for row in found))
    size = (3.2 * len(speeds) + 2.0, 3.0 * len(obstacles) + 0.6)
    figure: Figure = figures.Figure(figsize=size, layout="constrained")
    axes = figure.subplots(len(obstacles), len(speeds), sharex=True, sharey="row", squeeze=False)
    for line, obstacle in enumerate(obstacles):
        for column, speed in enumerate(speeds):
            ax = axes[line, column]
            for index, model in enumerate(models):
                case = (model, obstacle, speed)
                own = [row for row in found if (row.model, row.obstacle, row.speed) == case]
                # Moved apart, so that intervals do not hide each other.
                aside = 0.06 * (index - 0.5 * (len(models) - 1))
                ax.errorbar(
                    [drives.index(row.drive) + aside for row in own],
                    [1e3 * row.height for row in own],
                    [
                        [1e3 * (row.height - row.low) for row in own],
                        [1e3 * (row.high - row.height) for row in own],
                    ],
                    color=_COLORS[index % len(_COLORS)],
                    marker=_MARKERS[index % len(_MARKERS)],
                    linestyle="-" if index < len(_COLORS) else "--",
                    markersize=4.0,
                    linewidth=1.2,
                    elinewidth=0.7,
                    label=model,
                )
            ax.set_title(f"{obstacle}, {speed:g} m/s", fontsize="medium")
            ax.set_xticks(range(len(drives)), drives, fontsize="small")
            ax.grid(alpha=0.25)
        axes[line, 0].set_ylabel("cleared by half of the runs [mm]")
        tallest = max(row.high for row in found if row.obstacle == obstacle)
        axes[line, 0].set_ylim(0.0, 1e3 * 1.05 * tallest + 1.0)
    for ax in axes[-1]:
        ax.set_xlabel("rotor inertia of a track [kg m²]")
    handles, labels = axes[0, 0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside right center", fontsize="small")
    count = len(found[0].heights)
    figure.suptitle(
        f"Engineer without flippers, friction 0.5: median and interval of {count} draws"
    )
    return figure
