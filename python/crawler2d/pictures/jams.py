"""Where a model can jam: regions of height and friction, one for each pair of wheels."""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from crawler2d.common.extras import extra
from crawler2d.drawings.canvas import axes_or_new, moved
from crawler2d.drawings.palette import BLACK, GRAY, LINES
from crawler2d.pictures.rates import legend_below, one_model, readable, with_dims

if TYPE_CHECKING:
    import xarray
    from matplotlib.axes import Axes
    from numpy.typing import NDArray

__all__ = ["JamRegion", "jam_regions", "plot_jam_chart"]

_FILL = 0.55
"""[-] Opacity of a region."""
_LINE = 3.0
"""[point] Width of a region at a single value."""
_ROOM = 0.1
"""[-] Margin beside the only value of a chart."""
_STRIPES = "////", "....", "xxxx"
"""Hatches, for readers who distinguish colours badly."""

Interval = tuple[float, float]
Corner = tuple[float, float]


class JamRegion(NamedTuple):
    """Where a model can jam in one way.

    Parameters
    ----------
    text : str
        Its description in a legend.
    place : int or None
        Number of the pair of wheels with the ground between them, from the rear; None if no ground
        is inside the track.
    is_belt : bool
        Whether it is a jam of the belt.
    pieces : list of list of tuple
        Corners of its pieces as (value along the first axis, friction). A piece with two corners is
        at a single value.
    """

    text: str
    place: int | None
    is_belt: bool
    pieces: list[list[Corner]]


def jam_regions(data: xarray.Dataset) -> list[JamRegion]:
    """Divide the chart of one model into regions: one for each pair of wheels, then the belt's."""
    at = data[data.attrs["x"]].to_numpy()
    low, high = (data[end].to_numpy() for end in ("low", "high"))
    bodies = np.stack([data["rear"].to_numpy(), data["front"].to_numpy()], axis=-1)
    known = np.isfinite(low)
    found = []
    places = itertools.count()
    for pair in sorted({(int(rear), int(front)) for rear, front in bodies[known]}):
        own = known & (bodies == pair).all(axis=-1)
        inside = pair[0] >= 0
        text = f"between wheels {pair[0]} and {pair[1]}" if inside else "nothing inside the track"
        pieces = _pieces(at, _intervals(low, high, own))
        found.append(JamRegion(text, next(places) if inside else None, False, pieces))
    belt_low, belt_high = (data[f"belt_{end}"].to_numpy() for end in ("low", "high"))
    held = np.isfinite(belt_low)
    if held.any():
        pieces = _pieces(at, _intervals(belt_low, belt_high, held))
        found.append(JamRegion("a belt can jam, too", None, True, pieces))
    return found


def plot_jam_chart(data: xarray.Dataset, ax: Axes | None) -> Axes:
    """Fill the regions where one model can jam, and hatch those where a belt can."""
    name = data.attrs["x"]
    data = with_dims(one_model(data), name)
    ax = axes_or_new(ax, (8.0, 6.0))
    factor, label = readable(data[name])
    at = factor * data[name].to_numpy()
    handles: list[Any] = []
    top = 0.1
    collections = extra("matplotlib.collections", "plot")
    collection, segments = collections.PolyCollection, collections.LineCollection
    for text, place, is_belt, pieces in jam_regions(data):
        style: dict[str, Any] = {"edgecolor": BLACK, "linewidth": 0.0}
        if is_belt:
            style |= {"facecolor": "none", "hatch": "\\\\"}
        elif place is None:
            style |= {"facecolor": GRAY, "alpha": _FILL}
        else:
            hatch = _STRIPES[place % len(_STRIPES)]
            style |= {"facecolor": LINES[place % len(LINES)], "hatch": hatch, "alpha": _FILL}
        scaled = [[(factor * x, friction) for x, friction in piece] for piece in pieces]
        ax.add_collection(collection(scaled, **style))
        if lines := [piece for piece in scaled if len(piece) == 2]:
            color = BLACK if is_belt else style["facecolor"]
            look: dict[str, Any] = {"color": color, "linewidth": 1.0 if is_belt else _LINE}
            beside = moved(ax, _LINE * len(handles))  # at one value, all would cover each other
            ax.add_collection(segments(lines, transform=beside, **look))
        handles.append(extra("matplotlib.patches", "plot").Patch(label=text, **style))
        top = max(top, *(friction for piece in pieces for _, friction in piece))
    room = 0.0 if at.size > 1 else _ROOM * abs(at[0]) or 1.0
    ends = at[0] - room, at[-1] + room
    ax.set(xlabel=label, ylabel="friction", xlim=ends, ylim=(0.0, top))
    title = f"{data['model'].item()}\n" if "model" in data.coords else ""
    text = f"{title}where it can stand still with its drives running, on three contacts"
    ax.set_title(text, loc="left", fontsize="small", parse_math=False)
    if handles:
        legend_below(ax, handles=handles)
    return ax


def _intervals(
    low: NDArray[np.float64], high: NDArray[np.float64], own: NDArray[np.bool_]
) -> list[list[Interval]]:
    """List the intervals at each value, with overlapping ones joined."""
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


def _pieces(at: NDArray[np.float64], rows: list[list[Interval]]) -> list[list[Corner]]:
    """List the pieces between overlapping intervals of neighbours, and single intervals."""
    pieces: list[list[Corner]] = []
    alone = [set(row) for row in rows]
    for k, (here, there, own, others) in enumerate(zip(at, at[1:], rows, rows[1:], strict=False)):
        for low, high in own:
            for low_there, high_there in others:
                if low <= high_there and low_there <= high:
                    pieces.append(
                        [(here, low), (here, high), (there, high_there), (there, low_there)]
                    )
                    alone[k].discard((low, high))
                    alone[k + 1].discard((low_there, high_there))
    for x, row in zip(at, alone, strict=True):
        pieces += [[(x, low), (x, high)] for low, high in sorted(row)]
    return pieces
