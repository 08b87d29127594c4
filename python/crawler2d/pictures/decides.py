"""What decides, and where: what `Found.plot` draws of `studies.what_decides`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from crawler2d.common.extras import extra
from crawler2d.drawings.canvas import checked_axes, set_title
from crawler2d.drawings.palette import BLACK, BLUE, GRAY, GREEN, ORANGE
from crawler2d.errors import ScenarioError
from crawler2d.pictures.labels import populations, readable

if TYPE_CHECKING:
    import xarray
    from matplotlib.axes import Axes

__all__ = ["plot_decides"]

_ROW, _REST = 0.6, 1.6
"""[inch] Height of an unknown, and of what is above and below all of them."""

_BAR = 0.36
"""[-] Of a row, the thickness of each of its two bars."""


def plot_decides(found: xarray.Dataset, ax: Axes | None, show: str = "indices") -> Axes:
    """Draw one model: the indices of every unknown, or with ``show="boundary"`` their ranges."""
    drawings = {"indices": _indices, "boundary": _boundary}
    if show not in drawings:
        raise ScenarioError("show", show, f"must be one of {', '.join(drawings)}")
    if found.sizes.get("model", 1) > 1:
        models = ", ".join(map(str, found["model"].to_numpy()))
        rule = "must have one model: found.sel(model=...).plot()"
        raise ScenarioError("plot", models, rule)
    found = found.squeeze("model") if "model" in found.dims else found
    if show == "boundary":
        found = found.isel(unknown=np.flatnonzero(found["path"].to_numpy() != ""))
    if ax is None:
        height = _ROW * found.sizes["unknown"] + _REST
        pyplot = extra("matplotlib.pyplot", "plot")
        _, ax = pyplot.subplots(figsize=(8.0, height), layout="constrained")
    else:
        checked_axes(ax, "ax")
    drawings[show](found, ax)
    ax.spines[["top", "right"]].set_visible(False)
    return ax


def _indices(found: xarray.Dataset, ax: Axes) -> None:
    """Draw two bars for each factor with their intervals, the largest on top."""
    order = np.argsort(-found["total"].to_numpy(), kind="stable")
    found = found.isel(unknown=order)
    at = np.arange(order.size)
    for name, label, color, down in (
        ("total", "total: left if all others were known", ORANGE, _BAR / 2.0),
        ("first", "first order: gone if it were known", BLUE, -_BAR / 2.0),
    ):
        own, low, high = (found[key].to_numpy() for key in (name, f"{name}_low", f"{name}_high"))
        ax.barh(at + down, own, _BAR, color=color, label=label)
        ax.hlines(at + down, low, high, color=BLACK, linewidth=1.2)
    ax.set_yticks(at, [name.replace("_", " ") for name in found["unknown"].to_numpy()])
    bounds = found[["first_low", "first_high", "total_high"]].to_array().to_numpy()
    left, right = np.nanmin([0.0, *bounds.flat]), np.nanmax([1.0, *bounds.flat])
    ax.set(xlim=(left - 0.02, right + 0.02), ylim=(order.size - 0.4, -0.6))
    outcome = found.attrs["outcome"].replace("_", " ")
    ax.set_xlabel(f"share of the variance of the outcome, {outcome} or not")
    ax.axvline(0.0, color=BLACK, linewidth=0.8)
    caveat = str(found["caveat"].item())
    if caveat:
        ax.text(0.5, 0.5, caveat, transform=ax.transAxes, ha="center", va="center")
    else:
        handles, labels = ax.get_legend_handles_labels()
        ax.legend(handles[::-1], labels[::-1], loc="lower right", fontsize="small")
    rate = f"{outcome} in {found['rate'].item():.2f} of {found['count'].item()} runs"
    over = populations({**found.attrs, "vary": found.attrs["population"]}, banded=False)
    _entitle(found, ax, rate, over)


def _boundary(found: xarray.Dataset, ax: Axes) -> None:
    """Draw the range of each unknown, with the part where most runs have the outcome."""
    outcome = found.attrs["outcome"].replace("_", " ")
    styles: dict[str, Any] = {
        "outcome": {"color": GREEN, "linewidth": 7.0, "label": f"most runs: {outcome}"},
        "range": {"color": GRAY, "linewidth": 2.0, "label": "range of the unknown"},
        "own": {"color": BLACK, "markersize": 6.0, "label": "the scenario's own value"},
        "half": {"color": BLUE, "linewidth": 2.0, "label": "rate of one half"},
    }
    for k in range(found.sizes["unknown"]):
        row = found.isel(unknown=k)
        factor, unit = _readable(row)
        low, high = row["range_low"].item(), row["range_high"].item()
        span = high - low or 1.0
        ax.plot([0.0, 1.0], [k, k], zorder=1, solid_capstyle="butt", **styles["range"])
        for begin, end in _parts(row):
            ends = (np.array([begin, end]) - low) / span
            ax.plot(ends, [k, k], zorder=2, solid_capstyle="butt", **styles["outcome"])
        own = (row["own"].item() - low) / span
        ax.plot(own, k, "D", zorder=4, **styles["own"])
        ax.annotate(f"{factor * row['own'].item():.3g}", (own, k), **_beside(above=False))
        crossing = 0.5 * (row["bracket_low"].item() + row["bracket_high"].item())
        if np.isfinite(crossing):
            x = (crossing - low) / span
            ax.plot([x, x], [k - 0.22, k + 0.22], zorder=3, **styles["half"])
            bounds = [factor * row[f"bracket_{end}"].item() for end in ("low", "high")]
            again = "" if row["monotone"].item() else ", and again"
            text = f"{_between(*bounds)} {unit}".rstrip() + again
            ax.annotate(text, (x, k - 0.22), color=BLUE, **_beside(above=True))
        for x, value, side in ((0.0, low, "right"), (1.0, high, "left")):
            step = -6.0 if side == "right" else 6.0
            text = f"{factor * value:.3g}"
            style: dict[str, Any] = {"fontsize": "x-small", "va": "center", "ha": side}
            ax.annotate(text, (x, k), (step, 0.0), textcoords="offset points", **style)
    count = found.sizes["unknown"]
    names = [name.replace("_", " ") for name in found["unknown"].to_numpy()]
    units = [_readable(found.isel(unknown=k))[1] for k in range(count)]
    pairs = zip(names, units, strict=True)
    ax.set_yticks(range(count), [f"{name} [{unit}]" if unit else name for name, unit in pairs])
    ax.tick_params(axis="y", length=0.0)
    ax.set(ylim=(count - 0.4, -0.6), xlim=(-0.1, 1.1), xticks=[])
    ax.spines[["left", "bottom"]].set_visible(False)
    handles = dict(zip(*ax.get_legend_handles_labels()[::-1], strict=True))
    ax.legend(
        handles.values(),
        handles,
        ncols=len(handles),
        columnspacing=1.2,
        handlelength=1.5,
        loc="upper center",
        bbox_to_anchor=(0.5, 0.0),
        fontsize="small",
        frameon=False,
    )
    over = populations({"vary": found.attrs["vary"]}, banded=False)
    _entitle(found, ax, "one unknown moved at a time, the others as in the scenario", over)


def _parts(row: xarray.Dataset) -> list[tuple[float, float]]:
    """List the parts of a range where most runs have the outcome: halfway to a value where not."""
    known = row["tried"].notnull().to_numpy()
    values, often = row["tried"].to_numpy()[known], row["tried_rate"].to_numpy()[known] >= 0.5
    edges = np.concatenate([values[:1], 0.5 * (values[1:] + values[:-1]), values[-1:]])
    changes = np.flatnonzero(np.diff(often, prepend=False, append=False))
    return [(edges[begin], edges[end]) for begin, end in changes.reshape(-1, 2)]


def _readable(row: xarray.Dataset) -> tuple[float, str]:
    """Return the factor to the unit in which people read an unknown, and the unit."""
    factor, text = readable(row["own"].assign_attrs(units=row["unit"].item(), long_name=""))
    return factor, text.strip(" []")


def _between(low: float, high: float) -> str:
    """Write a bracket with as many digits as tell its ends apart."""
    digits = max(0, -int(np.floor(np.log10(high - low))))
    return f"{low:.{digits}f} to {high:.{digits}f}"


def _beside(*, above: bool) -> dict[str, Any]:
    return {
        "xytext": (0.0, 2.0 if above else -7.0),
        "textcoords": "offset points",
        "ha": "center",
        "va": "bottom" if above else "top",
        "fontsize": "x-small",
    }


def _entitle(found: xarray.Dataset, ax: Axes, *paragraphs: str) -> None:
    label = [str(found["model"].item())] if "model" in found.coords else []
    lines = [line for text in paragraphs for line in text.split("\n")]
    set_title(ax, *label, *lines)
