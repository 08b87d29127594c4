"""The paper's Table 2 and ours as a figure."""

from __future__ import annotations

from typing import TYPE_CHECKING

from crawler2d.common.extras import extra
from crawler2d.drawings.scene import BLACK, BLUE, GREEN, ORANGE
from crawler2d.sweeps.statistics import wilson
from research.paper.agreement import PAPER_RUNS

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.figure import Figure

    from research.paper.fields import Beside

__all__ = ["plot_table_2"]

_COLORS, _MARKERS = (BLUE, ORANGE, GREEN), ("o", "s", "^")


def plot_table_2(rows: Sequence[Beside]) -> Figure:
    """Draw the rates of the paper and ours with Wilson's intervals, one panel per field.

    Parameters
    ----------
    rows : sequence of Beside
        Up to three settings.

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
    fields = list(dict.fromkeys(row.obstacle for row in rows))
    settings = list(dict.fromkeys(row.setting for row in rows))
    models = list(dict.fromkeys(row.model for row in rows))
    figure: Figure = figures.Figure(figsize=(4.4 * len(fields), 4.4), layout="constrained")
    axes = figure.subplots(1, len(fields), sharey=True, squeeze=False)
    for ax, field in zip(axes.flat, fields, strict=True):
        for place, model in enumerate(models):
            own = [row for row in rows if (row.obstacle, row.model) == (field, model)]
            theirs = (round(PAPER_RUNS * own[0].paper), PAPER_RUNS)
            points = [("the paper", *theirs, BLACK, "D")]
            points += [
                (row.setting, row.cleared, row.count, *_style(settings.index(row.setting)))
                for row in own
            ]
            for step, (label, cleared, count, color, marker) in enumerate(points):
                rate, low, high = wilson(cleared, count)
                x = place + 0.16 * (step - 1.5)
                ax.vlines(x, 100 * low, 100 * high, color=color, linewidth=1.6)
                told = label if place == 0 else None
                ax.plot(x, 100 * rate, marker=marker, color=color, linestyle="", label=told)
        ax.set_xticks(range(len(models)), [model.replace(", ", ",\n") for model in models])
        ax.tick_params(axis="x", labelsize="small", rotation=20)
        ax.set(ylim=(-4.0, 104.0), xlim=(-0.5, len(models) - 0.5))
        ax.set_title(field, loc="left", fontsize="medium")
        ax.grid(alpha=0.25, axis="y")
    axes[0, 0].set_ylabel("cleared [%]")
    handles, labels = axes[0, 0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside upper center", ncols=len(labels))
    return figure


def _style(index: int) -> tuple[str, str]:
    return _COLORS[index % len(_COLORS)], _MARKERS[index % len(_MARKERS)]
