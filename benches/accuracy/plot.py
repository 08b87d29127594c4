"""The figures of the study: error against cost, of all cells and of each model."""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from statistics import median
from typing import Any, Literal, NamedTuple

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator

from benches.accuracy.findings import Finding, Study, models, size_of_difference
from crawler2d.drawings.palette import BLUE, RED
from research.figures import GREY, add_legend, light_grid, make_panels, save_svg

_COLUMNS = 5
_COST = "processor time per simulated time [ms/s]"
_ERRORS = {"rates": "mean size of the difference of rates", "paths": "median path error [mm]"}


class _Family(NamedTuple):
    """Settings that share a curve: those that choose the step by the same argument of `Solver`."""

    argument: str
    title: str
    style: dict[str, Any]
    side: Literal["left", "right"]
    """Position of the settings' names relative to their points."""


_FAMILIES = (
    _Family(
        "time_step", "fixed time step", {"color": GREY, "marker": "s", "linestyle": "--"}, "right"
    ),
    _Family("accuracy", "error control", {"color": BLUE, "marker": "o", "linestyle": "-"}, "left"),
)


class Point(NamedTuple):
    """A setting in a panel."""

    setting: str
    cost: float
    """[ms/s] Processor time per simulated time, median over cells."""
    error: float
    low: float
    high: float
    chance: float
    """Error if all rates were equal; NaN for paths."""


_Points = Callable[[Sequence[Finding], str], Iterator[Point]]


def plot(study: Study, folder: Path) -> None:
    """Write ``all.svg``, ``rates.svg`` and ``paths.svg`` into a folder."""
    folder.mkdir(parents=True, exist_ok=True)
    with mpl.rc_context({"font.size": 8.0}):
        figures = {"all": _all(study)} | {name: _models(study, name) for name in _ERRORS}
        for name, figure in figures.items():
            save_svg(figure, folder / f"{name}.svg")


def _all(study: Study) -> Figure:
    """Draw all cells together, and name the settings."""
    figure, (axes,) = make_panels(1, 2, (8.0, 3.6))
    for ax, name in zip(axes, _ERRORS, strict=True):
        _panel(ax, study, study.findings, name, is_named=True)
        ax.set(xlabel=_COST, ylabel=_ERRORS[name])
    axes[0].set_ylim(bottom=0.0)
    _legend(figure, axes[0])
    return figure


def _models(study: Study, name: str) -> Figure:
    """Draw one panel for each model."""
    groups = models(study.findings)
    rows = max(1, math.ceil(len(groups) / _COLUMNS))
    size = (10.0, 0.9 + 1.7 * rows)
    figure, grid = make_panels(rows, _COLUMNS, size, sharex=True, sharey=True)
    for ax in grid.flat[len(groups) :]:
        ax.set_axis_off()
    for ax, (model, own) in zip(grid.flat, groups.items(), strict=False):
        _panel(ax, study, own, name, is_named=False)
        ax.set_title(f"{model} ({len(own)})", fontsize="medium")
    # Panels above an empty place have no panel below that shows the costs.
    for ax in grid.flat[max(0, len(groups) - _COLUMNS) : len(groups)]:
        ax.tick_params(labelbottom=True)
    if name == "rates":
        grid.flat[0].set_ylim(bottom=0.0)
    figure.supxlabel(_COST, fontsize="medium")
    figure.supylabel(_ERRORS[name], fontsize="medium")
    _legend(figure, grid.flat[0])
    return figure


def _panel(
    ax: Axes, study: Study, findings: Sequence[Finding], name: str, *, is_named: bool
) -> None:
    make = {"rates": _rate, "paths": _path}[name]
    for family in _FAMILIES:
        points = _points(study, family, findings, make)
        if not points:
            continue
        _curve(ax, points, family)
        for point in points:
            place = (point.cost, point.error)
            if point.setting == study.default:
                ring: dict[str, Any] = {"markersize": 10, "markerfacecolor": "none"}
                ax.plot(*place, marker="o", color=RED, linestyle="", label=point.setting, **ring)
            if is_named:
                _name(ax, point, family.side)
    if is_named:
        # Space for the names.
        ax.margins(x=0.2)
    ax.set_xscale("log")
    if name == "paths":
        ax.set_yscale("log")
    for axis in (ax.xaxis, ax.yaxis) if name == "paths" else (ax.xaxis,):
        axis.set_major_locator(LogLocator(subs=(1.0, 3.0)))
        axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    ax.minorticks_off()
    light_grid(ax)


def _points(
    study: Study, family: _Family, findings: Sequence[Finding], make: _Points
) -> list[Point]:
    return [
        point
        for setting, arguments in study.settings.items()
        if family.argument in arguments and setting != study.reference
        for point in make(findings, setting)
    ]


def _rate(findings: Sequence[Finding], setting: str) -> Iterator[Point]:
    """Yield the point of the error of the rates, if there are runs."""
    own = [each for each in findings if setting in each.by_setting]
    if own:
        size = size_of_difference(own, setting)
        chance = sum(each.by_setting[setting].pairs.by_chance for each in own) / len(own)
        yield Point(setting, _cost(own, setting), *size, chance)


def _path(findings: Sequence[Finding], setting: str) -> Iterator[Point]:
    """Yield the point of the error of the path, from the cells that are not chaotic."""
    own = [each for each in findings if setting in each.by_setting and not each.is_chaotic]
    paths = [1e3 * each.by_setting[setting].path for each in own]
    paths = [path for path in paths if path > 0.0]  # neither nan nor off the scale
    if paths:
        low, middle, high = np.quantile(paths, (0.25, 0.5, 0.75)).tolist()
        yield Point(setting, _cost(own, setting), middle, low, high, math.nan)


def _cost(findings: Sequence[Finding], setting: str) -> float:
    return 1e3 * median(each.by_setting[setting].cost for each in findings)


def _curve(ax: Axes, points: Sequence[Point], family: _Family) -> None:
    costs = [point.cost for point in points]
    errors = [point.error for point in points]
    # A single cell has no interval.
    sides = [
        [min(max(point.error - point.low, 0.0), point.error) for point in points],
        [point.high - point.error if math.isfinite(point.high) else 0.0 for point in points],
    ]
    style: Mapping[str, Any] = {"markersize": 4, "linewidth": 1.2, "elinewidth": 0.7}
    ax.errorbar(costs, errors, yerr=sides, label=family.title, **style, **family.style)
    if not math.isnan(points[0].chance):
        chances = [point.chance for point in points]
        title = f"{family.title}, by chance"
        ax.plot(costs, chances, color=family.style["color"], linestyle=":", label=title)


def _name(ax: Axes, point: Point, side: Literal["left", "right"]) -> None:
    """Write the name of a setting next to its point: at the top right or at the bottom left."""
    place, offset = (point.cost, point.error), {"right": (5, 5), "left": (-5, -11)}[side]
    anchor: Literal["left", "right"] = "left" if side == "right" else "right"
    ax.annotate(point.setting, place, xytext=offset, textcoords="offset points", ha=anchor)


def _legend(figure: Figure, ax: Axes) -> None:
    if ax.get_legend_handles_labels()[0]:
        add_legend(figure, ax, "upper center", frameon=False)
