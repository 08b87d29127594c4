"""The figures of the study."""

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from benches.scaling.report import Curve, curves, deviations
from crawler2d.drawings.palette import look_of
from research.figures import GREY, add_legend, light_grid, make_panels, save_svg
from research.tables import group_by

_LABELS = {
    "wheels": "wheels a side",
    "grousers": "grousers a wheel",
    "points": "pieces of the ground, 6 m long",
}
_COLUMNS = 3


def plot(result: dict[str, Any], folder: Path) -> None:
    """Write one picture per figure into a folder."""
    folder.mkdir(parents=True, exist_ok=True)
    for figure in _LABELS:
        save_svg(_costs(figure, curves(result["rows"], figure)), folder / f"{figure}.svg")
    save_svg(_accuracies(result["rows"]), folder / "accuracy.svg")
    save_svg(_threads(result["threads"]), folder / "threads.svg")


def _costs(name: str, drawn: Sequence[Curve]) -> Figure:
    """Draw the cost of a simulated second, one panel per scene, with a line of slope 1."""
    panels = group_by(drawn, "panel")
    styles = {name: _style(index) for index, name in enumerate(group_by(drawn, "name"))}
    figure, (axes,) = make_panels(1, len(panels), (8.0, 3.8), sharex=True, sharey=True)
    for (panel, own), ax in zip(panels.items(), axes, strict=True):
        for curve in own:
            heights = [value * 1e3 for value in curve.per_second]
            ax.loglog(curve.x, heights, label=curve.name, **styles[curve.name])
        ax.set_title(panel, fontsize="medium")
        ax.set_xlabel(_LABELS[name])
        _grid(ax)
        if name != "points":
            _decimal_ticks(ax, own[0].x)
    _whole_decades(axes)
    _proportional(axes[0])
    axes[0].set_ylabel("wall time a simulated second [ms]")
    columns = min(_COLUMNS, len(axes[0].get_legend_handles_labels()[1]))
    add_legend(figure, axes[0], "lower center", ncols=columns, frameon=False)
    return figure


def _accuracies(rows: Sequence[dict[str, Any]]) -> Figure:
    """Draw the cost over the accuracy and over the error of the robot's position, per scene."""
    figure, ((cost, error),) = make_panels(1, 2, (8.0, 3.4))
    drawn = curves(rows, "accuracy")
    for index, curve in enumerate(drawn):
        look, x = _style(index), [value * 1e6 for value in curve.x]
        cost.loglog(x, [value * 1e3 for value in curve.per_second], label=curve.panel, **look)
        error.loglog(x[1:], [value * 1e3 for value in deviations(rows, curve)], **look)
        for ax in (cost, error):
            ax.set_xlabel("accuracy [µm]")
            _decimal_ticks(ax, x)
    cost.set_ylabel("wall time a simulated second [ms]")
    error.set_ylabel("final x, off the finest [mm]")
    for ax in (cost, error):
        _grid(ax)
        _whole_decades([ax])
    figure.legend(loc="outside lower center", ncols=len(drawn), frameon=False)
    return figure


def _threads(rows: Sequence[dict[str, Any]]) -> Figure:
    """Draw the speed-ups over one thread."""
    figure, ((ax,),) = make_panels(1, 1, (4.6, 3.4))
    counts = [row["threads"] for row in rows]
    ax.plot(counts, counts, color=GREY, linestyle=":", label="as many times as fast")
    for index, (kind, name) in enumerate((("worlds", "worlds"), ("loops", "a loop that counts"))):
        ax.plot(counts, [row[kind] for row in rows], label=name, **_style(index))
    ax.set(xlabel="threads", ylabel="speed-up over one thread", ylim=(0.0, None), xticks=counts)
    _grid(ax)
    ax.legend(loc="lower right", frameon=False)
    return figure


def _style(index: int) -> dict[str, Any]:
    return look_of(index) | {"markersize": 5}


def _whole_decades(axes: Sequence[Axes]) -> None:
    """Extend the y axes to powers of ten, because part of a decade has too few labels."""
    lows, highs = zip(*(ax.dataLim.intervaly for ax in axes), strict=True)
    low, high = math.floor(math.log10(min(lows))), math.ceil(math.log10(max(highs)))
    for ax in axes:
        ax.set_ylim(10.0**low, 10.0**high)


def _proportional(ax: Axes) -> None:
    """Draw proportional cost, at the top left, over half a decade."""
    (left, right), (low, high) = ax.get_xlim(), ax.get_ylim()
    rise = 10.0**0.5
    x, y = (1.3 * left, 1.3 * left * rise), (0.7 * high / rise, 0.7 * high)
    ax.plot(x, y, color=GREY, linestyle=":", label="in proportion")
    ax.set(xlim=(left, right), ylim=(low, high))


def _decimal_ticks(ax: Axes, values: Sequence[float]) -> None:
    ax.set_xticks(values, [f"{value:g}" for value in values])


def _grid(ax: Axes) -> None:
    ax.minorticks_off()
    light_grid(ax)
