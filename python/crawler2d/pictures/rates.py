"""Figures of studies: outcomes as bars or maps, and measures as dots."""

from __future__ import annotations

import itertools
import re
import textwrap
from collections import Counter
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from crawler2d.common.extras import extra
from crawler2d.drawings.canvas import axes_or_new, below_axis
from crawler2d.drawings.palette import (
    BLACK,
    BLUE,
    GRAY,
    GREEN,
    ORANGE,
    PALE,
    PURPLE,
    RED,
    SKY,
    VIOLET,
)
from crawler2d.errors import ScenarioError

if TYPE_CHECKING:
    import xarray
    from matplotlib.axes import Axes
    from numpy.typing import NDArray

__all__ = [
    "LOOKS",
    "legend_below",
    "one_model",
    "plot_map",
    "plot_measured",
    "plot_outcomes",
    "populations",
    "readable",
    "with_dims",
]

_SCALES = {"m": (1e3, "mm"), "rad": (180.0 / np.pi, "deg")}
"""Display unit of each unit, and its factor."""

LOOKS = {
    "cleared": (GREEN, ""),
    "seized": (RED, "//"),
    "cycling": (PURPLE, ".."),
    "hung_up": (ORANGE, "\\\\"),
    "stalled": (BLUE, "--"),
    "slipping": (SKY, "||"),
    "tipped_over": (VIOLET, "xx"),
    "timed_out": (PALE, ""),
    "left_terrain": (PALE, "++"),
    "detracked": (PALE, "oo"),
    "diverged": (BLACK, ""),
    "refused": (BLACK, "//"),
    "failed": (BLACK, ".."),
}
"""Colours and hatching of the outcomes, in the order of a bar."""

_ROW, _REST = 0.28, 1.5
"""[inch] Height of a bar, and of the space above and below all bars."""

_BETWEEN = 1.5
"""[-] Gap between one ground and the next, in bars."""

_LEGEND = 22.0
"""[point] Height of the legend, which stands between bars and title."""

_CLEARED, _OTHERWISE = "cleared", "otherwise"

_HATCH, _DOTS = "////", ".."
"""Hatches of uncertain cells, and of cells that were not simulated."""

_RIM = 2.5
"""[point] Width of the line round areas where most runs have the outcome of a map."""

_BELOW = 46.0 / 72.0
"""[inch] From the axes to the legend, past ticks and label."""

_MEASURE_ROW, _MEASURE_REST = 0.5, 1.7
"""[inch] Height of the row of a model, and of the space above and below all rows."""

_WIDE = 26
"""Characters of a line of a label."""

_UNCHANGED = "unchanged"

_STYLES = ((ORANGE, "D"), (GREEN, "s"), (RED, "^"))
"""Markers of the evidence, which was measured with each change."""

_DOWN = 0.26
"""[-] Distance of the evidence below its model, in rows."""


def readable(values: xarray.DataArray) -> tuple[float, str]:
    """Return the factor to the display unit of an array, and its name with that unit."""
    given = values.attrs.get("units", "")
    factor, unit = _SCALES.get(given, (1.0, given))
    name = str(values.attrs.get("long_name", values.name))
    return factor, name if unit in ("", "1") else f"{name} [{unit}]"


def populations(attributes: Mapping[str, Any], *, banded: bool, what: str = "rates") -> str:
    """Describe the population of the rates for a title."""
    varied = _field_names(attributes.get("vary", attributes.get("varied", "")))
    text = f"{what} over {varied}" if varied else f"{what} of equal runs"
    unknown = _field_names(attributes.get("unknown", ""))
    if banded:
        return f"{text};\nmedian and 5 to 95 % over {unknown}"
    kind = attributes.get("interval", "")
    level = attributes.get("confidence_level")
    return f"{text}\n{kind} intervals, {100 * level:.12g} %" if level else text


def _field_names(text: str) -> str:
    """Name the fields of ``path: distribution; path: distribution``."""
    paths = [part.partition(":")[0] for part in text.split("; ") if part]
    names = [re.sub(r"\[[^\]]*\]", "", path.rpartition(".")[2]) for path in paths]
    names = [name.replace("center_of_mass", "centre of mass") for name in names]
    return ", ".join(dict.fromkeys(name.replace("_", " ") for name in names))


def plot_outcomes(data: xarray.Dataset, ax: Axes | None) -> Axes:
    """Draw a bar of outcomes for each ground and model, with its rate."""
    dims = ("terrain", "model")
    data = data.expand_dims([dim for dim in dims if dim not in data["rate"].dims])
    ended = sorted((str(name) for name in data if str(name).startswith("ended_")), key=_rank)
    banded = "band_low" in data
    counts = [data[name].sum("sample") if banded else data[name] for name in ended]
    parts = [count.transpose(*dims).to_numpy().ravel() for count in counts]
    figures = ("band_median", "band_low", "band_high") if banded else ("rate", "low", "high")
    rates = zip(*(data[name].transpose(*dims).to_numpy().ravel() for name in figures), strict=True)
    runs = np.sum(parts, axis=0)
    grounds, models = (data[dim].to_numpy().tolist() for dim in dims)
    at = np.arange(runs.size) + _BETWEEN * np.repeat(np.arange(len(grounds)), len(models))
    ax = axes_or_new(ax, (8.0, _ROW * (at[-1] + 2.0) + _REST))
    left = np.zeros(runs.size)
    for name, part in zip(ended, parts, strict=True):
        outcome = name.removeprefix("ended_")
        fraction = part / np.maximum(runs, 1)
        label = outcome.replace("_", " ")
        color, hatch = LOOKS[outcome]
        style: dict[str, Any] = {"color": color, "hatch": hatch, "edgecolor": "white"}
        ax.barh(at, fraction, 0.8, left, **style, linewidth=0.5, label=label)
        left += fraction
    for place, count, (rate, low, high) in zip(at, runs, rates, strict=True):
        text = f"{rate:.2f} ({low:.2f} to {high:.2f}), {count} runs"
        if np.isnan(rate):
            text = f"no result in {count} runs"
        ax.text(1.01, place, text, fontsize="x-small", va="center")
    for index, ground in enumerate(grounds):
        where = 0.0, at[index * len(models)] - 0.6
        ax.text(*where, ground, fontweight="bold", fontsize="small", parse_math=False)
    ax.set(xlim=(0.0, 1.32), xticks=np.linspace(0.0, 1.0, 6), ylim=(at[-1] + 0.8, -1.3))
    ax.set_yticks(at, models * len(grounds), parse_math=False)
    ax.set_xlabel("share of the runs; at the right the rate of clearing")
    ax.spines[["top", "right"]].set_visible(False)
    ax.legend(
        fontsize="x-small",
        ncols=len(ended),
        loc="lower left",
        bbox_to_anchor=(0.0, 1.0),
        frameon=False,
    )
    title = populations(data.attrs, banded=banded)
    ax.set_title(title, loc="left", fontsize="small", pad=_LEGEND)
    return ax


def _rank(name: str) -> int:
    return list(LOOKS).index(name.removeprefix("ended_"))


def plot_map(data: xarray.Dataset, ax: Axes | None) -> Axes:
    """Draw the commonest outcome of every cell, hatched if uncertain, dotted if not simulated."""
    data = one_model(data)
    ending = data["ending"]
    if ending.ndim != 2 or min(ending.shape) < 2:
        rule = "must have both fields of the map, with two values of each or more"
        raise ScenarioError("plot", str(dict(ending.sizes)), rule)
    y, x = map(str, ending.dims)
    ax = axes_or_new(ax, (8.0, 6.0))
    (scale_x, label_x), (scale_y, label_y) = readable(data[x]), readable(data[y])
    at = scale_x * data[x].to_numpy(), scale_y * data[y].to_numpy()
    outcome = data.attrs["outcome"]
    colors = {_OTHERWISE: PALE, outcome: RED, _CLEARED: GREEN}
    kinds = list(colors)
    numbers = np.vectorize(kinds.index)(ending.to_numpy())
    guessed = np.isfinite(data["around"].to_numpy())
    unsure = data["unsure"].to_numpy()
    scale: dict[str, Any] = {
        "cmap": extra("matplotlib.colors", "plot").ListedColormap(list(colors.values())),
        "vmin": -0.5,
        "vmax": len(kinds) - 0.5,
        "shading": "nearest",
    }
    for dotted, hatched in itertools.product((False, True), repeat=2):
        marks = _HATCH * hatched + _DOTS * dotted
        style: dict[str, Any] = {}
        if marks:
            style = {"hatch": marks, "edgecolor": BLACK, "linewidth": 0.0}
        others = (guessed != dotted) | (unsure != hatched)
        ax.pcolor(*at, np.ma.masked_array(numbers, others), **scale, **style)
    inside = (ending == outcome).to_numpy()
    if inside.any() and outcome != _CLEARED:
        _draw_rim(ax, at, inside)
    ax.set(xlabel=label_x, ylabel=label_y)
    banded = "band_low" in data
    title = populations(data.attrs, banded=banded, what="how most runs end,")
    label = f"{data['model'].item()}\n" if "model" in data.coords else ""
    text = f"{label}{title}\n{_certainty(data, banded=banded)}"
    ax.set_title(text, loc="left", fontsize="small", parse_math=False)
    own = {name: color for name, color in colors.items() if (ending == name).any()}
    _legend(ax, own, guessed=bool(guessed.any()), unsure=bool(unsure.any()), banded=banded)
    return ax


def _draw_rim(
    ax: Axes, at: tuple[NDArray[np.float64], NDArray[np.float64]], inside: NDArray[np.bool_]
) -> None:
    """Draw a line round the cells with an outcome, for readers who cannot see its colour."""
    x, y = (_edges(each) for each in at)
    padded = np.pad(inside, 1)
    sides = [
        ((x[j], y[i]), (x[j], y[i + 1]))
        for i, j in np.argwhere(padded[1:-1, 1:] != padded[1:-1, :-1])
    ] + [
        ((x[j], y[i]), (x[j + 1], y[i]))
        for i, j in np.argwhere(padded[1:, 1:-1] != padded[:-1, 1:-1])
    ]
    lines = extra("matplotlib.collections", "plot").LineCollection
    ax.add_collection(lines(sides, colors=BLACK, linewidths=_RIM, capstyle="round"))


def _edges(middles: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the boundaries of cells, halfway between their centres."""
    between = 0.5 * (middles[1:] + middles[:-1])
    return np.concatenate(
        [2.0 * middles[:1] - between[:1], between, 2.0 * middles[-1:] - between[-1:]]
    )


def _certainty(data: xarray.Dataset, *, banded: bool) -> str:
    """Describe the number of runs per cell, and the widest interval."""
    counts = data["count"].to_numpy()
    counts = counts[counts > 0]
    if not counts.size:
        return "no run has a result"
    least, most = int(counts.min()), int(counts.max())
    each = "of each sample " if banded else ""
    runs = f"{least} runs" if least == most else f"{least} to {most} runs"
    widths = (data["high"] - data["low"]).to_numpy()
    widest = float(np.nanmax(np.where(data["count"].to_numpy() > 0, widths, np.nan)))
    return f"{runs} {each}a cell; intervals of a rate up to {widest:.2f} wide"


def _legend(ax: Axes, colors: dict[str, str], *, guessed: bool, unsure: bool, banded: bool) -> None:
    """Explain the colours and marks."""
    patch = extra("matplotlib.patches", "plot").Patch
    labels = {_CLEARED: "most runs clear", _OTHERWISE: "most runs fail otherwise"}
    handles = [
        patch(
            facecolor=color,
            edgecolor=BLACK if color == RED else color,
            label=labels.get(name, f"most runs end {name.replace('_', ' ')}"),
        )
        for name, color in colors.items()
    ]
    if unsure:
        why = "in some samples half of the runs or fewer end like this"
        text = why if banded else "uncertain, half of the runs or fewer may end like this"
        text = f"hatched: {text}"
        handles.append(patch(facecolor="white", edgecolor=BLACK, hatch=_HATCH, label=text))
    if guessed:
        text = f"dotted: not simulated; all cells around it {'' if banded else 'certainly '}agree"
        handles.append(patch(facecolor="white", edgecolor=BLACK, hatch=_DOTS, label=text))
    legend_below(ax, handles=handles)


def legend_below(ax: Axes, **options: Any) -> None:
    """Draw the legend below ticks and label of the axes, without parsing labels as formulas."""
    legend = ax.legend(
        loc="upper left",
        bbox_to_anchor=(0.0, 0.0),
        bbox_transform=below_axis(ax, _BELOW),
        borderaxespad=0.0,
        fontsize="small",
        **options,
    )
    for text in legend.get_texts():
        text.set_parse_math(False)


def one_model(data: xarray.Dataset) -> xarray.Dataset:
    """Return a data set of one model without that dimension.

    Raises
    ------
    ScenarioError
        If it has several models.
    """
    if data.sizes.get("model", 1) > 1:
        models = ", ".join(map(str, data["model"].to_numpy()))
        rule = "must have one model: found.sel(model=...).plot()"
        raise ScenarioError("plot", models, rule)
    return data.squeeze("model") if "model" in data.dims else data


def with_dims(data: xarray.Dataset, *dims: str) -> xarray.Dataset:
    """Restore a selected dimension of a data set, with length one."""
    return data.expand_dims([dim for dim in dims if dim in data.coords and dim not in data.dims])


def plot_measured(data: xarray.Dataset, ax: Axes | None, *, of: str | None = None) -> Axes:
    """Draw a row for each model: median, range of the repeats, and evidence.

    Parameters
    ----------
    data : Dataset
        Measures of a study.
    ax : Axes or None
        Where to draw.
    of : str, optional
        Name of the measure; None takes the study's own.

    Raises
    ------
    ScenarioError
        If the measure is unknown.
    """
    name = data.attrs["measure"] if of is None else of
    if f"{name}_each" not in data:
        known = [str(key)[:-5] for key in data if str(key).endswith("_each")]
        raise ScenarioError("of", name, f"must be one of {', '.join(known)}")
    data = with_dims(data, "model", "motion")
    models = [str(label) for label in data["model"].to_numpy()]
    ax = axes_or_new(ax, (8.0, _MEASURE_ROW * len(models) + _MEASURE_REST))
    factor, label = readable(data[name])
    banded, place = f"{name}_band_low" in data, ax.get_yaxis_transform()
    others = [d for d in data[name].dims if d not in ("model", "sample")]  # standing, driving
    if others:
        for part, (color, marker) in zip(data[others[0]].to_numpy(), _STYLES, strict=False):
            own = data.sel({others[0]: part})
            _draw(ax, own, name, factor, (color, marker, str(part)))
    else:
        _draw(ax, data, name, factor, (BLUE, "o", _UNCHANGED))
        _draw_evidence(ax, data, name, factor)
    for row in range(len(models)):
        text = "\n".join(_notes(data.isel(model=row), name))
        ax.text(1.01, row, text, transform=place, fontsize="x-small", va="center")
    names = [textwrap.fill(text, _WIDE) for text in models]
    ax.set_yticks(range(len(models)), names, parse_math=False)
    ax.set(ylim=(len(models) - 0.5, -0.5), xlabel=label)
    _set_scale(ax, data, name)
    ax.grid(axis="x", alpha=0.3)
    ax.spines[["top", "right"]].set_visible(False)
    ax.set_title(_title(data, banded=banded), loc="left", fontsize="small")
    if len(ax.get_legend_handles_labels()[1]) > 1:
        ax.legend(fontsize="x-small", loc="upper left", bbox_to_anchor=(1.0, 0.0), frameon=False)
    return ax


def _draw(
    ax: Axes, data: xarray.Dataset, name: str, factor: float, style: tuple[str, str, str]
) -> None:
    """Draw medians and the range of the repeats, or the band over the unknowns."""
    color, marker, label = style
    banded = f"{name}_band_low" in data
    keys = [f"{name}_band_{part}" for part in ("median", "low", "high")]
    middle, low, high = (
        factor * data[key].to_numpy()
        for key in (keys if banded else (name, f"{name}_low", f"{name}_high"))
    )
    rows = np.arange(middle.size)
    ax.hlines(rows, low, high, color=color, alpha=0.5, linewidth=5.0 if banded else 2.5)
    ax.plot(middle, rows, color=color, marker=marker, linestyle="", label=label, zorder=3)


def _draw_evidence(ax: Axes, data: xarray.Dataset, name: str, factor: float) -> None:
    """Draw the medians with each change as fainter points, a little below."""
    evidence = f"{name}_with"
    if evidence not in data or "change" not in data.dims:
        return
    key = f"{evidence}_band_median" if f"{evidence}_band_median" in data else evidence
    changes = [str(each) for each in data["change"].to_numpy() if each != _UNCHANGED]
    for index, (change, (color, marker)) in enumerate(zip(changes, _STYLES, strict=False)):
        values = factor * data[key].sel(change=change).to_numpy()
        rows = np.arange(values.size) + _DOWN + 0.07 * (index - 1)
        look: dict[str, Any] = {"color": color, "marker": marker, "markersize": 4.5, "alpha": 0.6}
        ax.plot(values, rows, linestyle="", label=change, **look)


def _notes(own: xarray.Dataset, name: str) -> list[str]:
    """Return a note: the limit of a model, reason for a missing figure, outcome, or motion."""
    if "moved" in own:
        ways = own["moved"].to_numpy()[own["motion"].to_numpy() == "driving"]
        return [f"drove {way:.2f} m" for way in ways]
    ended = own["ended"].sel(change=_UNCHANGED) if "change" in own.dims else own["ended"]
    if "limit" not in own:
        return [_tally("", ended)]
    notes = [_tally("limit: ", own["limit"])]
    if not np.isfinite(own[name].to_numpy()).all():
        notes.append(_tally("no figure: ", ended))
    return notes


def _tally(before: str, words: xarray.DataArray) -> str:
    """Return a word, or the words of all samples with their counts."""
    counts = Counter(str(word).replace("_", " ") for word in np.atleast_1d(words.to_numpy()))
    if len(counts) == 1:
        return before + next(iter(counts))
    listed = (f"{word} in {count}" for word, count in counts.most_common())
    return textwrap.fill(f"{before}{', '.join(listed)} of {counts.total()}", _WIDE)


def _set_scale(ax: Axes, data: xarray.Dataset, name: str) -> None:
    """Use a logarithmic axis for a real-time factor, with a line at 1; start others at 0."""
    if data.attrs["figure"] == "real_time_factor":
        ax.set_xscale("log")
        ax.axvline(1.0, color=GRAY, linewidth=1.0, zorder=0)
        return
    values = data[f"{name}_each"].to_numpy()
    if not (values < 0.0).any():
        ax.set_xlim(left=0.0)
    else:
        ax.axvline(0.0, color=BLACK, linewidth=0.8, zorder=0)


def _title(data: xarray.Dataset, *, banded: bool) -> str:
    """Describe the population and the lines."""
    attributes: dict[str, Any] = data.attrs
    repeats = attributes["repeats"]
    if attributes["figure"] == "real_time_factor":
        return (
            f"{attributes['duration']:g} simulated seconds by processor time,"
            f" {attributes['processor']};"
            f"\nmedians of {repeats} measurements, lines from the lowest to the highest"
        )
    text = populations(attributes, banded=banded, what=f"medians of {repeats} repeats")
    return text if banded else f"{text};\nlines from the lowest to the highest repeat"
