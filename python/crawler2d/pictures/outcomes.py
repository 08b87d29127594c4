"""How runs ended: what `Found.plot` draws of `studies.success`."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from crawler2d.common.extras import extra
from crawler2d.drawings.canvas import checked_axes
from crawler2d.drawings.palette import BLUE, GRAY, GREEN, ORANGE, PURPLE, RED, SKY, VIOLET
from crawler2d.pictures.labels import populations

if TYPE_CHECKING:
    import xarray
    from matplotlib.axes import Axes

__all__ = ["plot_outcomes"]

_COLORS = {
    "cleared": GREEN,
    "seized": RED,
    "cycling": PURPLE,
    "hung_up": ORANGE,
    "stalled": BLUE,
    "slipping": SKY,
    "tipped_over": VIOLET,
}
"""Of the common outcomes, in the order of a bar; the others are grey and come last."""

_ROW, _REST = 0.28, 1.5
"""[inch] Height of a bar, and of what is above and below all of them."""

_BETWEEN = 1.5
"""[-] Bars that would fit between one ground and the next."""


_LEGEND = 22.0
"""[point] Height of the legend, which stands between bars and title."""


def plot_outcomes(found: xarray.Dataset, ax: Axes | None) -> Axes:
    """Draw a bar for each ground and model: which share of its runs ended how, and the rate."""
    dims = ("terrain", "model")
    found = found.expand_dims([dim for dim in dims if dim not in found["rate"].dims])
    ended = sorted((str(name) for name in found if str(name).startswith("ended_")), key=_rank)
    banded = "band_low" in found
    counts = [found[name].sum("sample") if banded else found[name] for name in ended]
    parts = [count.transpose(*dims).to_numpy().ravel() for count in counts]
    figures = ("band_median", "band_low", "band_high") if banded else ("rate", "low", "high")
    rates = zip(*(found[name].transpose(*dims).to_numpy().ravel() for name in figures), strict=True)
    runs = np.sum(parts, axis=0)
    grounds, models = (found[dim].to_numpy().tolist() for dim in dims)
    at = np.arange(runs.size) + _BETWEEN * np.repeat(np.arange(len(grounds)), len(models))
    if ax is None:
        height = _ROW * (at[-1] + 2.0) + _REST
        pyplot = extra("matplotlib.pyplot", "plot")
        _, ax = pyplot.subplots(figsize=(8.0, height), layout="constrained")
    else:
        checked_axes(ax, "ax")
    left = np.zeros(runs.size)
    for name, part in zip(ended, parts, strict=True):
        outcome = name.removeprefix("ended_")
        share = part / np.maximum(runs, 1)
        label = outcome.replace("_", " ")
        ax.barh(at, share, 0.8, left, color=_COLORS.get(outcome, GRAY), label=label)
        left += share
    for place, count, (rate, low, high) in zip(at, runs, rates, strict=True):
        text = f"{rate:.2f} ({low:.2f} to {high:.2f}), {count} runs"
        ax.text(1.01, place, text, fontsize="x-small", va="center")
    for index, ground in enumerate(grounds):
        ax.text(0.0, at[index * len(models)] - 0.6, ground, fontweight="bold", fontsize="small")
    ax.set(xlim=(0.0, 1.32), xticks=np.linspace(0.0, 1.0, 6), ylim=(at[-1] + 0.8, -1.3))
    ax.set_yticks(at, models * len(grounds))
    ax.set_xlabel("share of the runs; at the right the rate of clearing")
    ax.spines[["top", "right"]].set_visible(False)
    ax.legend(
        fontsize="x-small",
        ncols=len(ended),
        loc="lower left",
        bbox_to_anchor=(0.0, 1.0),
        frameon=False,
    )
    title = populations(found.attrs, banded=banded)
    ax.set_title(title, loc="left", fontsize="small", pad=_LEGEND)
    return ax


def _rank(name: str) -> int:
    outcomes = list(_COLORS)
    outcome = name.removeprefix("ended_")
    return outcomes.index(outcome) if outcome in outcomes else len(outcomes)
