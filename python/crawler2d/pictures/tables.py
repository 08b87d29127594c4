"""Figures of rates, searches and sensitivities, for `FigureDataset.plot`."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from crawler2d.drawings.canvas import axes_or_new, moved, set_title
from crawler2d.drawings.palette import BLACK, BLUE, GRAY, GREEN, ORANGE, look_of
from crawler2d.errors import ScenarioError
from crawler2d.pictures.jams import plot_jam_chart
from crawler2d.pictures.policies import plot_policy
from crawler2d.pictures.rates import (
    legend_below,
    one_model,
    plot_map,
    plot_measured,
    plot_outcomes,
    populations,
    readable,
    with_dims,
)

if TYPE_CHECKING:
    import xarray
    from matplotlib.axes import Axes
    from numpy.typing import NDArray

__all__ = ["FIGURES"]

_FAINT = 0.35
"""[-] Opacity of eliminated candidates."""

_GAP = 2.0
"""[-] Gap between one cost and the next, in candidates."""

_LABELS = 16
"""Largest number of costs with labels on the axis."""

_ROW, _REST = 0.6, 1.6
"""[inch] Height of an unknown, and of the space above and below all unknowns."""

_BAR = 0.36
"""[-] Thickness of each of the two bars in a row, as a fraction of its height."""

_ASIDE = 3.5, 6.0
"""[point] Distance between the intervals of two lines at the same value, and between bands."""

_LINES = 6
"""Number of distinguishable lines; more are drawn as a map if possible."""

_LARGEST, _LEAST = 8.0, 3.5
"""[point] Size of the markers of the first line, and the smallest size; each line's are smaller."""


def plot_search(data: xarray.Dataset, ax: Axes | None) -> Axes:
    """Draw every candidate's lowest rate in order of cost, and the fresh runs of two of them."""
    data = with_dims(data, "candidate")
    ax = axes_or_new(ax, (8.0, 6.0))
    two = [data.attrs["winner"], data.attrs["runner_up"]]
    names = data["candidate"].to_numpy().tolist()
    costs = data["cost"].to_numpy()
    at = _places(costs, [name in two for name in names])
    rounds = data["round"].to_numpy()
    rate, low, high = _lowest(data, "rate", "low", "high")
    for last, opacity, text in ((False, _FAINT, "eliminated"), (True, 1.0, "in the last round")):
        chosen = (rounds == rounds.max()) == last
        label = f"{text}: {chosen.sum()}, rates of the search"
        if not chosen.any():
            continue
        style: dict[str, Any] = {"color": BLUE, "alpha": opacity}
        ax.vlines(at[chosen], low[chosen], high[chosen], linewidth=1.2, **style)
        filled = BLUE if last else "none"
        style |= {"linestyle": "", "marker": "o", "markersize": 5.0, "markerfacecolor": filled}
        ax.plot(at[chosen], rate[chosen], label=label, **style)
    goal = data.attrs["at_least"]
    ax.axhline(goal, color=BLACK, linestyle="--", linewidth=1.0, label=f"goal: {goal:g}")
    again, lower, upper = _lowest(data, "confirmed_rate", "confirmed_low", "confirmed_high")
    looks = (("winner", GREEN, "D"), ("runner-up", ORANGE, "s"))
    for name, (role, color, marker) in zip(two, looks, strict=True):
        if name not in names:
            continue
        k = names.index(name)
        x = at[k] + 1.0
        text = f"{role}: {name}, fresh runs {again[k]:.3f} ({lower[k]:.3f} to {upper[k]:.3f})"
        if np.isnan(again[k]):
            text = f"{role}: {name}, no fresh run has a result"
        ax.vlines(x, lower[k], upper[k], color=color, linewidth=2.5)
        ax.plot(x, again[k], marker, color=color, markersize=7.0, label=text, zorder=3)
    # Candidates of one cost are side by side in a strip labelled with the cost.
    for left, right in _strips(at, costs)[::2]:
        ax.axvspan(left, right, color=BLACK, alpha=0.05, linewidth=0.0, zorder=0)
    several = data["terrain"].size > 1
    levels = np.unique(costs)[:: -(-np.unique(costs).size // _LABELS)]
    ax.set_xticks([at[costs == level].mean() for level in levels], [f"{v:g}" for v in levels])
    ax.set(
        xlabel=data.attrs["objective"],
        ylabel="lowest rate of clearing over the terrains" if several else "rate of clearing",
        ylim=(-0.03, 1.03),
    )
    ax.grid(axis="y", alpha=0.3)
    drawn = {**data.attrs, "vary": data.attrs["population"]}
    title = f"{populations(drawn, banded=False)}; of fresh runs Wilson's"
    ax.set_title(title, loc="left", fontsize="small")
    legend_below(ax)
    return ax


def _lowest(data: xarray.Dataset, *names: str) -> list[NDArray[np.float64]]:
    """Return each candidate's rate with its bounds on its worst terrain."""
    columns = [data[name].to_numpy().reshape(data["candidate"].size, -1) for name in names]
    at = np.where(np.isnan(columns[0]), np.inf, columns[0]).argmin(axis=1)[:, None]
    return [np.take_along_axis(each, at, axis=1)[:, 0] for each in columns]


def _places(costs: NDArray[np.float64], chosen: Sequence[bool]) -> NDArray[np.float64]:
    """Position candidates side by side by cost, with space next to those that were confirmed."""
    at = np.empty(costs.size)
    x, last = 0.0, costs.min()
    for k in np.argsort(costs, kind="stable"):
        x += _GAP if costs[k] > last else 0.0
        at[k], last = x, costs[k]
        x += 2.0 if chosen[k] else 1.0
    return at


def _strips(at: NDArray[np.float64], costs: NDArray[np.float64]) -> list[tuple[float, float]]:
    """List the left and right ends of each cost's strip, from the positions of its candidates."""
    ends = [(at[costs == cost].min(), at[costs == cost].max()) for cost in np.unique(costs)]
    between = [0.5 * (one[1] + other[0]) for one, other in itertools.pairwise(ends)]
    edges = [ends[0][0] - _GAP, *between, ends[-1][1] + _GAP]
    return list(itertools.pairwise(edges))


def plot_sensitivity(data: xarray.Dataset, ax: Axes | None, show: str = "indices") -> Axes:
    """Draw the indices of every unknown of one model, or with ``show="boundary"`` their ranges."""
    drawings = {"indices": _indices, "boundary": _boundary}
    if show not in drawings:
        raise ScenarioError("show", show, f"must be one of {', '.join(drawings)}")
    data = with_dims(one_model(data), "unknown")
    if show == "boundary":
        data = data.isel(unknown=np.flatnonzero(data["path"].to_numpy() != ""))
    ax = axes_or_new(ax, (8.0, _ROW * data.sizes["unknown"] + _REST))
    drawings[show](data, ax)
    ax.spines[["top", "right"]].set_visible(False)
    return ax


def _indices(data: xarray.Dataset, ax: Axes) -> None:
    """Draw two bars for each unknown with their intervals, the largest on top."""
    order = np.argsort(-data["total"].to_numpy(), kind="stable")
    data = data.isel(unknown=order)
    at = np.arange(order.size)
    for name, label, color, down in (
        ("total", "total: what would remain if all others were known", ORANGE, _BAR / 2.0),
        ("first", "first order: what would vanish if it were known", BLUE, -_BAR / 2.0),
    ):
        own, low, high = (data[key].to_numpy() for key in (name, f"{name}_low", f"{name}_high"))
        ax.barh(at + down, own, _BAR, color=color, label=label)
        ax.hlines(at + down, low, high, color=BLACK, linewidth=1.2)
    ax.set_yticks(at, [_spoken(name) for name in data["unknown"].to_numpy()])
    bounds = data[["first_low", "first_high", "total_high"]].to_array().to_numpy()
    left, right = np.nanmin([0.0, *bounds.flat]), np.nanmax([1.0, *bounds.flat])
    ax.set(xlim=(left - 0.02, right + 0.02), ylim=(order.size - 0.4, -0.6))
    outcome = data.attrs["outcome"].replace("_", " ")
    ax.set_xlabel(f"share of the variance of the outcome, {outcome} or not")
    ax.axvline(0.0, color=BLACK, linewidth=0.8)
    caveat = str(data["caveat"].item())
    if caveat:
        ax.text(0.5, 0.5, caveat, transform=ax.transAxes, ha="center", va="center")
    else:
        handles, labels = ax.get_legend_handles_labels()
        ax.legend(handles[::-1], labels[::-1], loc="lower right", fontsize="small")
    rate = f"{outcome} in {data['rate'].item():.2f} of {data['count'].item()} runs"
    over = populations({**data.attrs, "vary": data.attrs["population"]}, banded=False)
    _entitle(data, ax, rate, over)


def _boundary(data: xarray.Dataset, ax: Axes) -> None:
    """Draw the range of each unknown, with the part where most runs have the outcome."""
    outcome = data.attrs["outcome"].replace("_", " ")
    styles: dict[str, Any] = {
        "outcome": {"color": GREEN, "linewidth": 7.0, "label": f"most runs: {outcome}"},
        "range": {"color": GRAY, "linewidth": 2.0, "label": "range"},
        "own": {"color": BLACK, "markersize": 6.0, "label": "the scenario's own value"},
        "half": {"color": BLUE, "linewidth": 2.0, "label": "rate crosses one half"},
    }
    for k in range(data.sizes["unknown"]):
        row = data.isel(unknown=k)
        factor, unit = _readable(row)
        low, high = row["range_low"].item(), row["range_high"].item()
        span = high - low or 1.0
        ax.plot([0.0, 1.0], [k, k], "-", zorder=1, solid_capstyle="butt", **styles["range"])
        for begin, end in _parts(row):
            ends = (np.array([begin, end]) - low) / span
            ax.plot(ends, [k, k], "-", zorder=2, solid_capstyle="butt", **styles["outcome"])
        own = (row["own"].item() - low) / span
        ax.plot(own, k, "D", zorder=4, **styles["own"])
        ax.annotate(f"{factor * row['own'].item():.3g}", (own, k), **_label(above=False))
        crossing = 0.5 * (row["bracket_low"].item() + row["bracket_high"].item())
        if np.isfinite(crossing):
            x = (crossing - low) / span
            ax.plot([x, x], [k - 0.22, k + 0.1], "-", zorder=3, **styles["half"])
            bounds = [factor * row[f"bracket_{end}"].item() for end in ("low", "high")]
            again = "" if row["monotone"].item() else ", and again"
            text = f"{_between(*bounds)} {unit}".rstrip() + again
            ax.annotate(text, (x, k - 0.22), color=BLUE, **_label(above=True))
        for x, value, side in ((0.0, low, "right"), (1.0, high, "left")):
            step = -6.0 if side == "right" else 6.0
            text = f"{factor * value:.3g}"
            style: dict[str, Any] = {"fontsize": "x-small", "va": "center", "ha": side}
            ax.annotate(text, (x, k), (step, 0.0), textcoords="offset points", **style)
    count = data.sizes["unknown"]
    names = [_spoken(name) for name in data["unknown"].to_numpy()]
    units = [_readable(data.isel(unknown=k))[1] for k in range(count)]
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
    over = populations({"vary": data.attrs["vary"]}, banded=False)
    _entitle(data, ax, "one parameter varied at a time, the others as in the scenario", over)


def _parts(row: xarray.Dataset) -> list[tuple[float, float]]:
    """List the parts of a range where most runs have the outcome, up to halfway to other values."""
    known = row["tried"].notnull().to_numpy()
    values, often = row["tried"].to_numpy()[known], row["tried_rate"].to_numpy()[known] >= 0.5
    edges = np.concatenate([values[:1], 0.5 * (values[1:] + values[:-1]), values[-1:]])
    changes = np.flatnonzero(np.diff(often, prepend=False, append=False))
    return [(edges[begin], edges[end]) for begin, end in changes.reshape(-1, 2)]


def _spoken(name: str) -> str:
    """Write a column's name in words.

    Examples
    --------
    >>> _spoken("max_torque"), _spoken("center_of_mass_1"), _spoken("belly_1")
    ('max torque', 'centre of mass, y', 'belly, y')
    """
    place, _, axis = name.rpartition("_")
    if place in ("center_of_mass", "belly") and axis in ("0", "1"):
        name = f"{place}, {'xy'[int(axis)]}"
    return name.replace("center_of_mass", "centre of mass").replace("_", " ")


def _readable(row: xarray.Dataset) -> tuple[float, str]:
    """Return the factor to the display unit of an unknown, and the unit."""
    factor, text = readable(row["own"].assign_attrs(units=row["unit"].item(), long_name=""))
    return factor, text.strip(" []")


def _between(low: float, high: float) -> str:
    """Write an interval with enough digits to distinguish its ends."""
    digits = max(0, -int(np.floor(np.log10(high - low))))
    return f"{low:.{digits}f} to {high:.{digits}f}"


def _label(*, above: bool) -> dict[str, Any]:
    return {
        "xytext": (0.0, 2.0 if above else -7.0),
        "textcoords": "offset points",
        "ha": "center",
        "va": "bottom" if above else "top",
        "fontsize": "x-small",
    }


def _entitle(data: xarray.Dataset, ax: Axes, *paragraphs: str) -> None:
    label = [str(data["model"].item())] if "model" in data.coords else []
    lines = [line for text in paragraphs for line in text.split("\n")]
    set_title(ax, *label, *lines)


def plot_rates(data: xarray.Dataset, ax: Axes | None) -> Axes:
    """Draw rates over the last numeric dimension, with a line for each value of the others.

    Bars are intervals, thick bars the bands of the rates over the unknowns. Bars of several lines
    stand side by side at the value tried, which has a tick. Many lines over two numeric dimensions
    become a map.
    """
    banded = "band_low" in data
    numbers = _numbers(data["band_median" if banded else "rate"])
    data = data.sortby(numbers)  # values may be in any order
    rates = data["rate"]
    shown = data["band_median"] if banded else rates
    along = numbers[-1]
    if len(numbers) == 2 and shown.size > _LINES * shown.sizes[along] and shown.squeeze().ndim == 2:
        return _plot_rate_map(data.squeeze(), numbers, ax)
    ax = axes_or_new(ax, (8.0, 5.0))
    factor, label = readable(shown[along])
    x = factor * shown[along].to_numpy().astype(float)
    lines = list(_lines(shown, along))
    aside = _ASIDE[banded]
    for index, (name, place) in enumerate(lines):
        own = shown.sel(place).to_numpy()
        low, high = ("band_low", "band_high") if banded else ("low", "high")
        lower, upper = (data[name].sel(place).to_numpy() for name in (low, high))
        known = np.isfinite(own)  # models may have different values
        look = look_of(index)
        # Where lines coincide, later ones leave earlier ones visible: dashes over lines, small over
        # large markers.
        size = max(_LARGEST - index, _LEAST)
        ax.plot(x[known], own[known], **look, markersize=size, label=name, zorder=3)
        # Points are at the values tried; their intervals are side by side, so that none is hidden.
        style: dict[str, Any] = {"color": look["color"], "linewidth": 4.0 if banded else 1.5}
        beside = moved(ax, aside * (index - 0.5 * (len(lines) - 1)))
        ax.vlines(x[known], lower[known], upper[known], alpha=0.5, transform=beside, **style)
    ax.set_xticks(np.unique(x), minor=True)
    ax.tick_params(axis="x", which="minor", length=5.0)
    ax.set(xlabel=label, ylabel=str(rates.attrs.get("long_name", "rate")), ylim=(-0.03, 1.03))
    ax.grid(alpha=0.3)
    ax.set_title(populations(data.attrs, banded=banded), loc="left", fontsize="small")
    if len(lines) > 1:
        legend_below(ax, handlelength=3.5)
    return ax


def _numbers(shown: xarray.DataArray) -> list[str]:
    numeric = [str(d) for d in shown.dims if d in shown.coords and shown[d].dtype.kind in "iuf"]
    if not numeric:
        rule = "must have a dimension of numbers (studies.success_rate draws a bar for each model)"
        raise ScenarioError("plot", "labels only", rule)
    return numeric


def _plot_rate_map(data: xarray.Dataset, dims: Sequence[str], ax: Axes | None) -> Axes:
    """Draw rates over two numeric dimensions, hatched where the majority is uncertain."""
    banded = "band_low" in data
    names = ("band_median", "band_low", "band_high") if banded else ("rate", "low", "high")
    rates, low, high = (data[name].transpose(*dims).to_numpy() for name in names)
    (scale_y, label_y), (scale_x, label_x) = (readable(data[dim]) for dim in dims)
    at = scale_x * data[dims[1]].to_numpy(), scale_y * data[dims[0]].to_numpy()
    ax = axes_or_new(ax, (8.0, 6.0))
    scale: dict[str, Any] = {"cmap": "cividis", "vmin": 0.0, "vmax": 1.0, "shading": "nearest"}
    drawn = ax.pcolormesh(*at, np.ma.masked_invalid(rates), **scale)
    unsure = np.ma.masked_array(rates, ~((low < 0.5) & (high > 0.5)))
    ax.pcolor(*at, unsure, hatch="////", edgecolor=BLACK, linewidth=0.0, **scale)
    ax.figure.colorbar(drawn, ax=ax, label=str(data["rate"].attrs.get("long_name", "rate")))
    ax.set(xlabel=label_x, ylabel=label_y)
    what = "bands" if banded else "intervals"
    _entitle(data, ax, populations(data.attrs, banded=banded), f"hatched: {what} include a half")
    return ax


def _lines(shown: xarray.DataArray, along: str) -> Iterator[tuple[str, dict[str, Any]]]:
    others = [str(dim) for dim in shown.dims if dim != along]
    for place in np.ndindex(*(shown.sizes[dim] for dim in others)):
        labels = {dim: shown[dim].values[k] for dim, k in zip(others, place, strict=True)}
        text = [v if isinstance(v, str) else _value(shown[d], v) for d, v in labels.items()]
        yield ", ".join(text), labels


def _value(values: xarray.DataArray, value: float) -> str:
    """Name a value of a dimension in the unit of its axis, such as ``height 50 mm``."""
    factor, label = readable(values)
    unit = label.partition(" [")[2].rstrip("]")
    return f"{values.name} {factor * value:.4g} {unit}".rstrip()


def plot_comparison(data: xarray.Dataset, ax: Axes | None) -> Axes:
    """Draw the difference of each model's rate from the reference's, with its interval."""
    data = with_dims(data, "model")
    names, reference = data["model"].to_numpy().tolist(), data.attrs["reference"]
    ax = axes_or_new(ax, (8.0, _ROW * len(names) + _REST))
    at = np.arange(len(names))
    middle, low, high = (data[f"difference{end}"].to_numpy() for end in ("", "_low", "_high"))
    ax.axvline(0.0, color=GRAY, linewidth=1.0, zorder=0)
    ax.hlines(at, low, high, color=BLUE, linewidth=2.0)
    ax.plot(middle, at, "o", color=BLUE, markersize=6.0)
    for k, name in enumerate(names):
        won, lost = data["only_model"].to_numpy()[k], data["only_reference"].to_numpy()[k]
        text = f"clears {data['rate'].to_numpy()[k]:.0%}"
        text += "" if name == reference else f"; cleared alone: {won}, {reference} alone: {lost}"
        ax.text(1.07, k, text, fontsize="x-small", va="center", parse_math=False)
    ax.set_yticks(at, list(map(str, names)), parse_math=False)
    ax.set(xlim=(-1.05, 1.05), ylim=(len(names) - 0.4, -0.6))
    ax.set_xlabel(f"rate of clearing, minus that of {reference}", parse_math=False)
    ax.spines[["top", "right"]].set_visible(False)
    repeats = data.sizes.get("repeat", 1)
    pairs = f"{repeats} pairs of runs for each model; intervals of 95 % (Newcombe, paired)"
    _entitle(data.drop_vars("model"), ax, pairs, populations(data.attrs, banded=False))
    return ax


FIGURES: Mapping[str, Callable[..., Any]] = {
    "rates": plot_rates,
    "max_obstacle": plot_rates,
    "max_slope": plot_rates,
    "max_gap": plot_rates,
    "critical_value": plot_rates,
    "seizure_map": plot_map,
    "jam_chart": plot_jam_chart,
    "policy": plot_policy,
    "comparison": plot_comparison,
    "search": plot_search,
    "sensitivity": plot_sensitivity,
    "success_rate": plot_outcomes,
    "max_speed": plot_measured,
    "acceleration": plot_measured,
    "braking_distance": plot_measured,
    "ride": plot_measured,
    "odometry": plot_measured,
    "real_time_factor": plot_measured,
}
"""Figures by the attribute `figure` of a data set."""
