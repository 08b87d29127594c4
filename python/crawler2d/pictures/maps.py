"""A rate over two fields: what `Found.plot` draws of `studies.seizure_map`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from crawler2d.common.extras import extra
from crawler2d.drawings.canvas import checked_axes
from crawler2d.drawings.palette import BLACK
from crawler2d.errors import ScenarioError
from crawler2d.pictures.labels import populations, readable

if TYPE_CHECKING:
    import xarray
    from matplotlib.axes import Axes

__all__ = ["plot_map"]

_COLORS = "cividis"
"""A map of equal steps of lightness, the same to the colour-blind."""

_FAINT, _HATCH = 0.35, "////"
"""[-] Opacity, and hatching, of what was not simulated."""

_GRAY = "#A5AEBD"
"""Of the legend's patch: a faint middle of the map of colours."""

_BELOW = -46.0
"""[point] From the axes to the legend, past ticks and label."""


def plot_map(found: xarray.Dataset, ax: Axes | None) -> Axes:
    """Draw the rate of every cell; those that were not simulated are faint and hatched."""
    if found.sizes.get("model", 1) > 1:
        models = ", ".join(map(str, found["model"].to_numpy()))
        rule = "must have one model: found.sel(model=...).plot()"
        raise ScenarioError("plot", models, rule)
    found = found.squeeze("model") if "model" in found.dims else found
    banded = "band_low" in found
    shown = found["band_median"] if banded else found["rate"]
    if shown.ndim != 2:
        raise ScenarioError("plot", str(shown.dims), "must have both fields of the map")
    y, x = map(str, shown.dims)
    if ax is None:
        pyplot = extra("matplotlib.pyplot", "plot")
        _, ax = pyplot.subplots(figsize=(8.0, 6.0), layout="constrained")
    else:
        checked_axes(ax, "ax")
    (scale_x, label_x), (scale_y, label_y) = readable(found[x]), readable(found[y])
    at_x, at_y = scale_x * found[x].to_numpy(), scale_y * found[y].to_numpy()
    scale: dict[str, Any] = {"cmap": _COLORS, "vmin": 0.0, "vmax": 1.0}
    drawn = ax.pcolormesh(at_x, at_y, shown.to_numpy(), shading="nearest", **scale)
    around = found["around"].to_numpy()
    guessed = np.isfinite(around).any()
    if guessed:
        faint = np.ma.masked_invalid(around)
        style: dict[str, Any] = {
            "alpha": _FAINT,
            "hatch": _HATCH,
            "edgecolor": "white",
            "linewidth": 0.0,
        }
        ax.pcolor(at_x, at_y, faint, shading="nearest", **scale, **style)
    rows, columns = np.nonzero(found["unsure"].to_numpy())
    ax.scatter(at_x[columns], at_y[rows], s=22.0, facecolor="white", edgecolor=BLACK, zorder=3)
    name = found["rate"].attrs["long_name"]
    text = f"median {name} over the unknowns" if banded else name
    ax.figure.colorbar(drawn, ax=ax, label=text)
    ax.set(xlabel=label_x, ylabel=label_y)
    title = populations(found.attrs, banded=banded)
    label = f"{found['model'].item()}\n" if "model" in found.coords else ""
    ax.set_title(f"{label}{title}", loc="left", fontsize="small", parse_math=False)
    _legend(ax, guessed=bool(guessed), unsure=rows.size > 0, banded=banded)
    return ax


def _legend(ax: Axes, *, guessed: bool, unsure: bool, banded: bool) -> None:
    """Explain the marks, below the axes."""
    patches = extra("matplotlib.patches", "plot")
    lines = extra("matplotlib.lines", "plot")
    handles = []
    if unsure:
        kind = "5 to 95 % of the unknowns" if banded else "its interval"
        dot: dict[str, Any] = {"marker": "o", "markerfacecolor": "white", "markeredgecolor": BLACK}
        text = f"on either side of one half: {kind}"
        handles.append(lines.Line2D([], [], linestyle="", **dot, label=text))
    if guessed:
        text = "not simulated: all around it are on one side of one half"
        handles.append(patches.Patch(hatch=_HATCH, edgecolor="white", facecolor=_GRAY, label=text))
    if not handles:
        return
    # Ticks and label of the axis take the same height, however large the map is.
    move = extra("matplotlib.transforms", "plot").ScaledTranslation
    down = move(0.0, _BELOW / 72.0, ax.figure.dpi_scale_trans)
    ax.legend(
        handles=handles,
        loc="upper left",
        bbox_to_anchor=(0.0, 0.0),
        bbox_transform=ax.transAxes + down,
        borderaxespad=0.0,
        fontsize="small",
    )
