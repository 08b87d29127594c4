"""The figure that compares chains: rate of success over the height of a step."""

from __future__ import annotations

from typing import TYPE_CHECKING

from crawler2d.common.extras import extra

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.figure import Figure

    from research.tables import Cell

__all__ = ["plot_chains"]

# Okabe and Ito's palette, which colour-blind readers can tell apart.
_COLORS = ("#222222", "#0072B2", "#CC79A7", "#E69F00", "#D55E00", "#009E73")
_MARKERS = ("o", "s", "P", "D", "^", "v")
_TRACKS = 4


def plot_chains(cells: Sequence[Cell]) -> Figure:
    """Draw the rates with their intervals: all tracks, and the wheels with the first track.

    Parameters
    ----------
    cells : sequence of Cell
        Heights ascending within a model; four tracks, then up to two models of wheels.

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
    figure: Figure = figures.Figure(figsize=(9.0, 3.8), layout="constrained")
    models = list(dict.fromkeys(cell.model for cell in cells))
    styles = dict(zip(models, zip(_COLORS, _MARKERS, strict=True), strict=False))
    panels = figure.subplots(1, 2, sharex=True, sharey=True)
    for ax, shown in zip(panels, (models[:_TRACKS], [models[0], *models[_TRACKS:]]), strict=True):
        for model in shown:
            own = [cell for cell in cells if cell.model == model]
            color, marker = styles[model]
            heights = [1e3 * cell.height for cell in own]
            lows, highs = [1e2 * cell.low for cell in own], [1e2 * cell.high for cell in own]
            ax.fill_between(heights, lows, highs, color=color, alpha=0.13, linewidth=0.0)
            ax.plot(
                heights,
                [1e2 * cell.rate for cell in own],
                color=color,
                marker=marker,
                markersize=4.5,
                linewidth=1.6,
                label=model,
            )
        ax.set(xlabel="height of the step [mm]", ylim=(-4.0, 104.0))
        ax.grid(alpha=0.25)
        ax.legend(fontsize="small", loc="upper right")
    panels[0].set_ylabel("cleared [%]")
    count = max(cell.count for cell in cells)
    figure.suptitle(f"Engineer without flippers: {count} runs per point, 95 % Wilson intervals")
    return figure
