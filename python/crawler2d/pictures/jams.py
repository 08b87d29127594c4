"""Where a model can jam: regions of height and friction, one for each pair of wheels."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from crawler2d.common.extras import extra
from crawler2d.drawings.canvas import axes_or_new
from crawler2d.drawings.palette import BLACK, GRAY, LINES
from crawler2d.pictures.rates import legend_below, one_model, readable

if TYPE_CHECKING:
    import xarray
    from matplotlib.axes import Axes
    from numpy.typing import NDArray

__all__ = ["plot_jam_chart"]

_FILL = 0.55
"""[-] Opacity of a region."""
_STRIPES = "////", "....", "xxxx"
"""Hatches, for those who tell colours badly."""

Interval = tuple[float, float]


def plot_jam_chart(data: xarray.Dataset, ax: Axes | None) -> Axes:
    """Fill where one model can jam, and draw round where a belt can."""
    data = one_model(data)
    ax = axes_or_new(ax, (8.0, 6.0))
    name = data.attrs["x"]
    factor, label = readable(data[name])
    at = factor * data[name].to_numpy()
    low, high = (data[end].to_numpy() for end in ("low", "high"))
    bodies = np.stack([data["rear"].to_numpy(), data["front"].to_numpy()], axis=-1)
    known = np.isfinite(low)
    pairs = sorted({(int(rear), int(front)) for rear, front in bodies[known]})
    handles = []
    for place, pair in enumerate(pairs):
        own = known & (bodies == pair).all(axis=-1)
        inside = pair[0] >= 0
        style: dict[str, Any] = {
            "facecolor": LINES[place % len(LINES)] if inside else GRAY,
            "hatch": _STRIPES[place % len(_STRIPES)] if inside else None,
            "edgecolor": BLACK,
            "alpha": _FILL,
            "linewidth": 0.0,
        }
        text = f"between wheels {pair[0]} and {pair[1]}" if inside else "nothing inside the track"
        _fill(ax, at, _intervals(low, high, own), style)
        handles.append(extra("matplotlib.patches", "plot").Patch(label=text, **style))
    belt_low, belt_high = (data[f"belt_{end}"].to_numpy() for end in ("low", "high"))
    held = np.isfinite(belt_low)
    if held.any():
        line: dict[str, Any] = {"facecolor": "none", "edgecolor": BLACK, "hatch": "\\\\"}
        line |= {"linewidth": 0.0, "alpha": 1.0}
        _fill(ax, at, _intervals(belt_low, belt_high, held), line)
        text = "a belt can jam, too"
        handles.append(extra("matplotlib.patches", "plot").Patch(label=text, **line))
    top = np.nanmax(np.concatenate([high[known], belt_high[held], [0.1]]))
    ax.set(xlabel=label, ylabel="friction", xlim=(at[0], at[-1]), ylim=(0.0, float(top)))
    title = f"{data['model'].item()}\n" if "model" in data.coords else ""
    text = f"{title}where it can stand still with its drives running, on three contacts"
    ax.set_title(text, loc="left", fontsize="small", parse_math=False)
    if handles:
        legend_below(ax, handles=handles)
    return ax


def _intervals(
    low: NDArray[np.float64], high: NDArray[np.float64], own: NDArray[np.bool_]
) -> list[list[Interval]]:
    """List the intervals at each value that belong together, joined where they overlap."""
    rows = []
    for lows, highs, of_row in zip(low, high, own, strict=True):
        joined: list[Interval] = []
        for begin, end in sorted(zip(lows[of_row], highs[of_row], strict=True)):
            if joined and begin <= joined[-1][1]:
                joined[-1] = (joined[-1][0], max(end, joined[-1][1]))
            else:
                joined.append((begin, end))
        rows.append(joined)
    return rows


def _fill(
    ax: Axes, at: NDArray[np.float64], rows: list[list[Interval]], style: dict[str, Any]
) -> None:
    """Fill between intervals of neighbouring values that overlap; those of one value are a line."""
    quads = []
    for here, there, own, others in zip(at, at[1:], rows, rows[1:], strict=False):
        for low, high in own:
            for low_there, high_there in others:
                if low <= high_there and low_there <= high:
                    quads.append(
                        [(here, low), (here, high), (there, high_there), (there, low_there)]
                    )
    for x, row in zip(at, rows, strict=True):
        quads += [[(x, low), (x, high)] for low, high in row]
    collection = extra("matplotlib.collections", "plot").PolyCollection
    ax.add_collection(collection(quads, **style))
