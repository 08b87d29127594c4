"""Cost against success: what `Found.plot` draws of `studies.search`."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from crawler2d.common.extras import extra
from crawler2d.drawings.canvas import checked_axes
from crawler2d.drawings.palette import BLACK, BLUE, GREEN, ORANGE
from crawler2d.pictures.labels import populations

if TYPE_CHECKING:
    import xarray
    from matplotlib.axes import Axes
    from numpy.typing import NDArray

__all__ = ["plot_search"]

_FAINT = 0.35
"""[-] Opacity of candidates that were left behind."""

_GAP = 2.0
"""[-] Candidates that would fit between one cost and the next."""

_LABELS = 16
"""So many costs have room at the axis."""

_BELOW = -46.0
"""[point] From the axes to the legend, past ticks and label."""


def plot_search(found: xarray.Dataset, ax: Axes | None) -> Axes:
    """Draw every candidate at its cost and lowest rate; diamonds are the fresh runs of two."""
    if ax is None:
        pyplot = extra("matplotlib.pyplot", "plot")
        _, ax = pyplot.subplots(figsize=(8.0, 6.0), layout="constrained")
    else:
        checked_axes(ax, "ax")
    two = [found.attrs["winner"], found.attrs["runner_up"]]
    names = found["candidate"].to_numpy().tolist()
    costs = found["cost"].to_numpy()
    at = _places(costs, [name in two for name in names])
    rounds = found["round"].to_numpy()
    rate, low, high = _lowest(found, "rate", "low", "high")
    for last, opacity, text in ((False, _FAINT, "left behind"), (True, 1.0, "in the last round")):
        chosen = (rounds == rounds.max()) == last
        label = f"{text}: {chosen.sum()}, rates of the search"
        if not chosen.any():
            continue
        style: dict[str, Any] = {"color": BLUE, "alpha": opacity}
        ax.vlines(at[chosen], low[chosen], high[chosen], linewidth=1.2, **style)
        ax.plot(at[chosen], rate[chosen], "o", markersize=5.0, label=label, **style)
    goal = found.attrs["at_least"]
    ax.axhline(goal, color=BLACK, linestyle="--", linewidth=1.0, label=f"goal: {goal:g}")
    again, lower, upper = _lowest(found, "confirmed_rate", "confirmed_low", "confirmed_high")
    for role, name, color in zip(("winner", "runner-up"), two, (GREEN, ORANGE), strict=True):
        if name not in names:
            continue
        k = names.index(name)
        x = at[k] + 1.0
        text = f"{role}: {name}, fresh runs {again[k]:.3f} ({lower[k]:.3f} to {upper[k]:.3f})"
        ax.vlines(x, lower[k], upper[k], color=color, linewidth=2.5)
        ax.plot(x, again[k], "D", color=color, markersize=7.0, label=text, zorder=3)
    several = found["terrain"].size > 1
    levels = np.unique(costs)[:: -(-np.unique(costs).size // _LABELS)]
    ax.set_xticks([at[costs == level].mean() for level in levels], [f"{v:g}" for v in levels])
    ax.set(
        xlabel=found.attrs["objective"],
        ylabel="lowest rate of clearing over the terrains" if several else "rate of clearing",
        ylim=(-0.03, 1.03),
    )
    ax.grid(axis="y", alpha=0.3)
    drawn = {**found.attrs, "vary": found.attrs["population"]}
    title = f"{populations(drawn, banded=False)}; of fresh runs Wilson's"
    ax.set_title(title, loc="left", fontsize="small")
    move = extra("matplotlib.transforms", "plot").ScaledTranslation
    ax.legend(
        loc="upper left",
        bbox_to_anchor=(0.0, 0.0),
        # Ticks and label of the axis take the same height, however large the figure is.
        bbox_transform=ax.transAxes + move(0.0, _BELOW / 72.0, ax.figure.dpi_scale_trans),
        borderaxespad=0.0,
        fontsize="small",
    )
    return ax


def _lowest(found: xarray.Dataset, *names: str) -> list[NDArray[np.float64]]:
    """Take a rate and its bounds on the terrain where each candidate's rate is lowest."""
    columns = [found[name].to_numpy().reshape(found["candidate"].size, -1) for name in names]
    at = np.where(np.isnan(columns[0]), np.inf, columns[0]).argmin(axis=1)[:, None]
    return [np.take_along_axis(each, at, axis=1)[:, 0] for each in columns]


def _places(costs: NDArray[np.float64], chosen: Sequence[bool]) -> NDArray[np.float64]:
    """Place candidates side by side by their cost, with room beside those that were confirmed."""
    at = np.empty(costs.size)
    x, last = 0.0, costs.min()
    for k in np.argsort(costs, kind="stable"):
        x += _GAP if costs[k] > last else 0.0
        at[k], last = x, costs[k]
        x += 2.0 if chosen[k] else 1.0
    return at
