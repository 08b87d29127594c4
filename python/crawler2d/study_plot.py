"""The picture of the study: success rate against step height, one panel a model."""

from __future__ import annotations

from typing import TYPE_CHECKING

from crawler2d._extras import extra

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.figure import Figure

    from crawler2d.experiments import Cell

__all__ = ["plot_rates"]

# Okabe and Ito's palette: told apart by colour-blind readers.
_COLORS = ("#0072B2", "#E69F00", "#D55E00", "#CC79A7", "#009E73", "#56B4E9")
_COLUMNS = 3


def plot_rates(cells: Sequence[Cell]) -> Figure:
    """Draw the rates with their intervals, each model on the grey lines of the others.

    Parameters
    ----------
    cells : sequence of Cell
        Of one study; heights ascending within a model.

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
    names = list(dict.fromkeys(cell.model for cell in cells))
    rows = -(-len(names) // _COLUMNS)
    figure: Figure = figures.Figure(
        figsize=(3.4 * _COLUMNS, 2.6 * rows + 0.8), layout="constrained"
    )
    axes = figure.subplots(rows, _COLUMNS, sharex=True, sharey=True, squeeze=False)
    for index, ax in enumerate(axes.flat):
        if index >= len(names):
            ax.set_visible(False)
            continue
        name, color = names[index], _COLORS[index % len(_COLORS)]
        for other in names:
            heights, rates, lows, highs = _curve(cells, other)
            if other != name:
                ax.plot(heights, rates, color="#BBBBBB", linewidth=0.8, zorder=1)
                continue
            ax.fill_between(heights, lows, highs, color=color, alpha=0.25, linewidth=0.0, zorder=2)
            ax.plot(heights, rates, color=color, marker="o", markersize=4, linewidth=1.8, zorder=3)
        ax.set_title(name, color="#222222", fontsize="medium", fontweight="bold")
        ax.set_ylim(-4.0, 104.0)
        ax.grid(alpha=0.25)
        if index % _COLUMNS == 0:
            ax.set_ylabel("cleared [%]")
        if index // _COLUMNS == rows - 1:
            ax.set_xlabel("step height [mm]")
    count = max(cell.count for cell in cells)
    figure.suptitle(
        f"Engineer over a step: success rate of {count} runs, 95 % Wilson interval\n"
        "(grey: the other models)",
        fontsize="medium",
    )
    return figure


def _curve(
    cells: Sequence[Cell], model: str
) -> tuple[list[float], list[float], list[float], list[float]]:
    """[mm] heights, and [%] rates, lower and upper bounds of one model."""
    own = [cell for cell in cells if cell.model == model]
    return (
        [1000.0 * cell.height for cell in own],
        [100.0 * cell.rate.rate for cell in own],
        [100.0 * cell.rate.low for cell in own],
        [100.0 * cell.rate.high for cell in own],
    )
