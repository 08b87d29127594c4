"""Figures of rates: what `Found.plot` draws."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from crawler2d.common.extras import extra
from crawler2d.drawings.canvas import checked_axes
from crawler2d.drawings.palette import BLACK, BLUE, GREEN, ORANGE, RED, SKY, VIOLET
from crawler2d.errors import ScenarioError
from crawler2d.pictures.decides import plot_decides
from crawler2d.pictures.labels import populations, readable
from crawler2d.pictures.maps import plot_map
from crawler2d.pictures.measured import plot_measured
from crawler2d.pictures.outcomes import plot_outcomes
from crawler2d.pictures.search import plot_search

if TYPE_CHECKING:
    import xarray
    from matplotlib.axes import Axes

__all__ = ["FIGURES"]

_COLORS = (BLUE, ORANGE, GREEN, RED, SKY, VIOLET, BLACK)
_MARKERS = "osD^vPX"
_APART = 0.06
"""[-] Share of the figure's width that the points of all lines at one place take."""


def plot_rates(found: xarray.Dataset, ax: Axes | None) -> Axes:
    """Draw rates over the last dimension of numbers, one line for each of the others.

    Bars are intervals; thick ones are the bands of the rates over the unknowns.
    """
    rates = found["rate"]
    banded_too = "band_low" in found
    shown = found["band_median"] if banded_too else rates
    along = _along(shown)
    pyplot = extra("matplotlib.pyplot", "plot")
    if ax is None:
        _, ax = pyplot.subplots(figsize=(8.0, 5.0), layout="constrained")
    else:
        checked_axes(ax, "ax")
    factor, label = readable(shown[along])
    x = factor * shown[along].to_numpy().astype(float)
    lines = list(_lines(shown, along))
    # Side by side, so that no interval hides another.
    apart = _APART * float(np.ptp(x)) / max(len(lines), 5) if x.size > 1 else 0.0
    for index, (name, place) in enumerate(lines):
        color, marker = _COLORS[index % len(_COLORS)], _MARKERS[index % len(_MARKERS)]
        own = shown.sel(place).to_numpy()
        at = x + apart * (index - 0.5 * (len(lines) - 1))
        low, high = ("band_low", "band_high") if banded_too else ("low", "high")
        lower, upper = (found[name].sel(place).to_numpy() for name in (low, high))
        known = np.isfinite(own)  # not every value is tried with every model
        at, own, lower, upper = at[known], own[known], lower[known], upper[known]
        ax.plot(at, own, color=color, marker=marker, markersize=5.0, label=name, zorder=3)
        ax.vlines(at, lower, upper, color=color, alpha=0.5, linewidth=4.0 if banded_too else 1.5)
    ax.set(xlabel=label, ylabel=str(rates.attrs.get("long_name", "rate")), ylim=(-0.03, 1.03))
    ax.grid(alpha=0.3)
    ax.set_title(populations(found.attrs, banded=banded_too), loc="left", fontsize="small")
    if len(ax.get_lines()) > 1:
        ax.legend(fontsize="small", loc="best")
    return ax


def _along(shown: xarray.DataArray) -> str:
    numeric = [str(d) for d in shown.dims if d in shown.coords and shown[d].dtype.kind in "iuf"]
    if not numeric:
        raise ScenarioError("plot", "labels only", "must have a dimension of numbers")
    return numeric[-1]


def _lines(shown: xarray.DataArray, along: str) -> Iterator[tuple[str, dict[str, Any]]]:
    others = [str(dim) for dim in shown.dims if dim != along]
    for place in np.ndindex(*(shown.sizes[dim] for dim in others)):
        labels = {dim: shown[dim].values[k] for dim, k in zip(others, place, strict=True)}
        text = [v if isinstance(v, str) else f"{d} {v:g}" for d, v in labels.items()]
        yield ", ".join(map(str, text)), labels


FIGURES: Mapping[str, Callable[..., Any]] = {
    "rates": plot_rates,
    "max_obstacle": plot_rates,
    "max_slope": plot_rates,
    "max_gap": plot_rates,
    "critical": plot_rates,
    "seizure_map": plot_map,
    "search": plot_search,
    "what_decides": plot_decides,
    "success": plot_outcomes,
    "max_speed": plot_measured,
    "acceleration": plot_measured,
    "braking_distance": plot_measured,
    "ride": plot_measured,
    "odometry": plot_measured,
    "real_time_factor": plot_measured,
}
"""By the attribute `figure` of a data set."""
