"""What was measured of each model, as dots: what `Found.plot` draws of the studies that measure."""

from __future__ import annotations

import textwrap
from collections import Counter
from typing import TYPE_CHECKING, Any

import numpy as np

from crawler2d.common.extras import extra
from crawler2d.drawings.canvas import checked_axes
from crawler2d.drawings.palette import BLACK, BLUE, GRAY, GREEN, ORANGE, RED
from crawler2d.errors import ScenarioError
from crawler2d.pictures.labels import populations, readable

if TYPE_CHECKING:
    import xarray
    from matplotlib.axes import Axes

__all__ = ["plot_measured"]

_ROW, _REST = 0.5, 1.7
"""[inch] Height of the row of a model, and of what is above and below all of them."""
_WIDE = 26
"""Characters of a line of a label."""
_UNCHANGED = "unchanged"
_STYLES = ((ORANGE, "D"), (GREEN, "s"), (RED, "^"))
"""Of the evidence: what was measured with each change."""
_DOWN = 0.26
"""[-] How far below its model the evidence is drawn, in rows."""


def plot_measured(found: xarray.Dataset, ax: Axes | None, *, of: str | None = None) -> Axes:
    """Draw a row for each model: the median, how far the repeats lie apart, and the evidence.

    Parameters
    ----------
    found : Dataset
        What a study measured.
    ax : Axes or None
        Where to draw.
    of : str, optional
        Which measure; None takes the study's own.

    Raises
    ------
    ScenarioError
        If there is no such measure.
    """
    name = found.attrs["measure"] if of is None else of
    if f"{name}_each" not in found:
        known = [str(key)[:-5] for key in found if str(key).endswith("_each")]
        raise ScenarioError("of", name, f"must be one of {', '.join(known)}")
    if "model" not in found.dims:
        found = found.expand_dims("model")
    models = [str(label) for label in found["model"].to_numpy()]
    if ax is None:
        size = (8.0, _ROW * len(models) + _REST)
        _, ax = extra("matplotlib.pyplot", "plot").subplots(figsize=size, layout="constrained")
    else:
        checked_axes(ax, "ax")
    factor, label = readable(found[name])
    banded, place = f"{name}_band_low" in found, ax.get_yaxis_transform()
    others = [d for d in found[name].dims if d not in ("model", "sample")]  # standing, driving
    if others:
        for part, (color, marker) in zip(found[others[0]].to_numpy(), _STYLES, strict=False):
            own = found.sel({others[0]: part})
            _draw(ax, own, name, factor, (color, marker, str(part)))
    else:
        _draw(ax, found, name, factor, (BLUE, "o", _UNCHANGED))
        _draw_evidence(ax, found, name, factor)
    for row in range(len(models)):
        text = "\n".join(_notes(found.isel(model=row), name))
        ax.text(1.01, row, text, transform=place, fontsize="x-small", va="center")
    ax.set_yticks(range(len(models)), [textwrap.fill(text, _WIDE) for text in models])
    ax.set(ylim=(len(models) - 0.5, -0.5), xlabel=label)
    _set_scale(ax, found, name)
    ax.grid(axis="x", alpha=0.3)
    ax.spines[["top", "right"]].set_visible(False)
    ax.set_title(_title(found, banded=banded), loc="left", fontsize="small")
    if len(ax.get_legend_handles_labels()[1]) > 1:
        ax.legend(fontsize="x-small", loc="upper left", bbox_to_anchor=(1.0, 0.0), frameon=False)
    return ax


def _draw(
    ax: Axes, found: xarray.Dataset, name: str, factor: float, style: tuple[str, str, str]
) -> None:
    """Draw medians and how far the repeats, or the samples of the unknowns, lie apart."""
    color, marker, label = style
    banded = f"{name}_band_low" in found
    keys = [f"{name}_band_{part}" for part in ("median", "low", "high")]
    middle, low, high = (
        factor * found[key].to_numpy()
        for key in (keys if banded else (name, f"{name}_low", f"{name}_high"))
    )
    rows = np.arange(middle.size)
    ax.hlines(rows, low, high, color=color, alpha=0.5, linewidth=5.0 if banded else 2.5)
    ax.plot(middle, rows, color=color, marker=marker, linestyle="", label=label, zorder=3)


def _draw_evidence(ax: Axes, found: xarray.Dataset, name: str, factor: float) -> None:
    """Draw the medians with each change as fainter points, a little below."""
    evidence = f"{name}_with"
    if evidence not in found:
        return
    key = f"{evidence}_band_median" if f"{evidence}_band_median" in found else evidence
    changes = [str(each) for each in found["change"].to_numpy() if each != _UNCHANGED]
    for index, (change, (color, marker)) in enumerate(zip(changes, _STYLES, strict=False)):
        values = factor * found[key].sel(change=change).to_numpy()
        rows = np.arange(values.size) + _DOWN + 0.07 * (index - 1)
        ax.plot(
            values,
            rows,
            color=color,
            marker=marker,
            markersize=4.5,
            alpha=0.6,
            linestyle="",
            label=change,
        )


def _notes(own: xarray.Dataset, name: str) -> list[str]:
    """Say what limits a model, why there is no figure, how its runs ended, or how it drove."""
    if "moved" in own:
        return [f"drove {own['moved'].sel(motion='driving').item():.2f} m"]
    ended = own["ended"].sel(change=_UNCHANGED) if "change" in own.dims else own["ended"]
    if "limit" not in own:
        return [_counted("", ended)]
    notes = [_counted("limit: ", own["limit"])]
    if not np.isfinite(own[name].to_numpy()).all():
        notes.append(_counted("no figure: ", ended))
    return notes


def _counted(before: str, words: xarray.DataArray) -> str:
    """Write a word, or the words of all samples with how many have each."""
    counts = Counter(str(word).replace("_", " ") for word in np.atleast_1d(words.to_numpy()))
    if len(counts) == 1:
        return before + next(iter(counts))
    listed = (f"{word} in {count}" for word, count in counts.most_common())
    return textwrap.fill(f"{before}{', '.join(listed)} of {counts.total()}", _WIDE)


def _set_scale(ax: Axes, found: xarray.Dataset, name: str) -> None:
    """Take logarithms of a real-time factor, with a line at real time; begin others at 0."""
    if found.attrs["figure"] == "real_time_factor":
        ax.set_xscale("log")
        ax.axvline(1.0, color=GRAY, linewidth=1.0, zorder=0)
        return
    values = found[f"{name}_each"].to_numpy()
    if not (values < 0.0).any():
        ax.set_xlim(left=0.0)
    else:
        ax.axvline(0.0, color=BLACK, linewidth=0.8, zorder=0)


def _title(found: xarray.Dataset, *, banded: bool) -> str:
    """Say what was varied, and what the lines are."""
    told: dict[str, Any] = found.attrs
    repeats = told["repeats"]
    if told["figure"] == "real_time_factor":
        return (
            f"{told['duration']:g} simulated seconds by processor time, {told['processor']};"
            f"\nmedians of {repeats} measurements, lines from the lowest to the highest"
        )
    text = populations(told, banded=banded, what=f"medians of {repeats} repeats")
    return text if banded else f"{text};\nlines from the lowest to the highest repeat"
