"""How runs end over two fields: what `Found.plot` draws of `studies.seizure_map`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from crawler2d.common.extras import extra
from crawler2d.drawings.canvas import checked_axes
from crawler2d.drawings.palette import BLACK, GRAY, GREEN, RED
from crawler2d.errors import ScenarioError
from crawler2d.pictures.labels import populations, readable

if TYPE_CHECKING:
    import xarray
    from matplotlib.axes import Axes

__all__ = ["plot_map"]

_CLEARED, _OTHERWISE = "cleared", "otherwise"
_FAINT = 0.45
"""[-] Opacity of what was not simulated."""

_HATCH = "////"
"""Hatching of what is not certain."""

_BELOW = -46.0
"""[point] From the axes to the legend, past ticks and label."""


def plot_map(found: xarray.Dataset, ax: Axes | None) -> Axes:
    """Draw how most runs of every cell end: hatched if not certain, faint if not simulated."""
    if found.sizes.get("model", 1) > 1:
        models = ", ".join(map(str, found["model"].to_numpy()))
        rule = "must have one model: found.sel(model=...).plot()"
        raise ScenarioError("plot", models, rule)
    found = found.squeeze("model") if "model" in found.dims else found
    ending = found["ending"]
    if ending.ndim != 2:
        raise ScenarioError("plot", str(ending.dims), "must have both fields of the map")
    y, x = map(str, ending.dims)
    if ax is None:
        pyplot = extra("matplotlib.pyplot", "plot")
        _, ax = pyplot.subplots(figsize=(8.0, 6.0), layout="constrained")
    else:
        checked_axes(ax, "ax")
    (scale_x, label_x), (scale_y, label_y) = readable(found[x]), readable(found[y])
    at = scale_x * found[x].to_numpy(), scale_y * found[y].to_numpy()
    colors = {_OTHERWISE: GRAY, found.attrs["outcome"]: RED, _CLEARED: GREEN}
    kinds = list(colors)
    numbers = np.vectorize(kinds.index)(ending.to_numpy())
    guessed = np.isfinite(found["around"].to_numpy())
    unsure = found["unsure"].to_numpy()
    scale: dict[str, Any] = {
        "cmap": extra("matplotlib.colors", "plot").ListedColormap(list(colors.values())),
        "vmin": -0.5,
        "vmax": len(kinds) - 0.5,
        "shading": "nearest",
    }
    hatched: dict[str, Any] = {"hatch": _HATCH, "edgecolor": BLACK, "linewidth": 0.0}
    faint: dict[str, Any] = {"alpha": _FAINT}
    for chosen, style in (
        (~guessed & ~unsure, {}),
        (guessed & ~unsure, faint),
        (~guessed & unsure, hatched),
        (guessed & unsure, faint | hatched),
    ):
        ax.pcolor(*at, np.ma.masked_array(numbers, ~chosen), **scale, **style)
    ax.set(xlabel=label_x, ylabel=label_y)
    banded = "band_low" in found
    title = populations(found.attrs, banded=banded, what="how most runs end,")
    label = f"{found['model'].item()}\n" if "model" in found.coords else ""
    text = f"{label}{title}\n{_known(found, banded=banded)}"
    ax.set_title(text, loc="left", fontsize="small", parse_math=False)
    own = {name: color for name, color in colors.items() if (ending == name).any()}
    _legend(ax, own, guessed=bool(guessed.any()), unsure=bool(unsure.any()), banded=banded)
    return ax


def _known(found: xarray.Dataset, *, banded: bool) -> str:
    """Say how many runs stand behind a cell, and how well its rate is known."""
    counts = found["count"].to_numpy()
    counts = counts[counts > 0]
    least, most = int(counts.min()), int(counts.max())
    each = "of each sample " if banded else ""
    runs = f"{least} runs" if least == most else f"{least} to {most} runs"
    widths = (found["high"] - found["low"]).to_numpy()
    widest = float(np.nanmax(np.where(found["count"].to_numpy() > 0, widths, np.nan)))
    return f"{runs} {each}a cell; intervals of a rate up to {widest:.2f} wide"


def _legend(ax: Axes, colors: dict[str, str], *, guessed: bool, unsure: bool, banded: bool) -> None:
    """Explain the colours and marks, below the axes."""
    patch = extra("matplotlib.patches", "plot").Patch
    said = {_CLEARED: "most runs clear", _OTHERWISE: "most runs fail otherwise"}
    handles = [
        patch(facecolor=color, label=said.get(name, f"most runs end {name.replace('_', ' ')}"))
        for name, color in colors.items()
    ]
    if unsure:
        why = "of some samples half of the runs or fewer end so"
        text = why if banded else "not certain, half of the runs or fewer may end so"
        text = f"hatched: {text}"
        handles.append(patch(facecolor="white", edgecolor=BLACK, hatch=_HATCH, label=text))
    if guessed:
        text = f"faint: not simulated, all around it {'' if banded else 'certainly '}end so"
        handles.append(patch(facecolor=GRAY, alpha=_FAINT, label=text))
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
