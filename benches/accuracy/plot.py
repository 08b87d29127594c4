"""The figures of the study: error against cost, one panel for each model."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from statistics import median
from typing import Any, NamedTuple

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from benches.accuracy.findings import Finding, Study
from benches.accuracy.verdicts import size_of_difference

_COLUMNS = 4
_GREY, _BLUE, _RED = "#666666", "#0072B2", "#D55E00"
_ALL = "all cells"

# Settings of one family share a curve: by which argument of `Solver` they choose the step.
_FAMILIES: dict[str, tuple[str, dict[str, Any]]] = {
    "time_step": ("fixed time step", {"color": _GREY, "marker": "s", "linestyle": "--"}),
    "accuracy": ("error control", {"color": _BLUE, "marker": "o", "linestyle": "-"}),
}


class Point(NamedTuple):
    """A setting in a panel."""

    setting: str
    cost: float
    """[ms/s] Processor time per simulated time, median over cells."""
    error: float
    low: float
    high: float
    chance: float
    """What the error would be if all rates were equal; nan for paths."""


Points = Callable[[Sequence[Finding], str], Iterator[Point]]


def plot(study: Study, folder: Path) -> None:
    """Write ``rates.svg`` and ``paths.svg`` into a folder."""
    folder.mkdir(parents=True, exist_ok=True)
    groups = _groups(study.findings)
    # Text stays text, and equal figures give equal files.
    with mpl.rc_context({"svg.fonttype": "none", "svg.hashsalt": "crawler2d", "font.size": 8.0}):
        for name, make, label in (
            ("rates", _rate, "mean size of the\ndifference of rates"),
            ("paths", _path, "median path error [mm]"),
        ):
            figure = _draw(study, groups, make, label, is_log=name == "paths")
            figure.savefig(folder / f"{name}.svg", metadata={"Date": None})


def _groups(findings: Sequence[Finding]) -> dict[str, list[Finding]]:
    groups: dict[str, list[Finding]] = {_ALL: list(findings)}
    for each in findings:
        groups.setdefault(each.cell.what.model, []).append(each)
    return groups


def _draw(
    study: Study,
    groups: Mapping[str, Sequence[Finding]],
    make: Points,
    label: str,
    *,
    is_log: bool,
) -> Figure:
    rows = math.ceil(len(groups) / _COLUMNS)
    figure = Figure(figsize=(9.0, 0.5 + 1.9 * rows), layout="constrained")
    grid = figure.subplots(rows, _COLUMNS, sharey=True, squeeze=False)
    for ax in grid.flat[len(groups) :]:
        ax.set_axis_off()
    for ax, (name, own) in zip(grid.flat, groups.items(), strict=False):
        for family, (title, style) in _FAMILIES.items():
            points = [
                point
                for setting, arguments in study.settings.items()
                if family in arguments and setting != study.reference
                for point in make(own, setting)
            ]
            _curve(ax, points, title, style)
            _mark(ax, points, study.default, name == _ALL)
        ax.set_xscale("log")
        if is_log:
            ax.set_yscale("log")
        ax.set_title(f"{name} ({len(own)})", fontsize="medium")
        ax.grid(alpha=0.25)
        ax.spines[["top", "right"]].set_visible(False)
    figure.supxlabel("processor time per simulated time [ms/s]")
    figure.supylabel(label)
    handles, names = grid.flat[0].get_legend_handles_labels()
    figure.legend(handles, names, loc="outside lower center", ncols=len(names), frameon=False)
    return figure


def _rate(findings: Sequence[Finding], setting: str) -> Iterator[Point]:
    """Make the point of the error of the rates, if there are runs."""
    own = [each for each in findings if setting in each.by_setting]
    if own:
        size = size_of_difference(own, setting)
        chance = sum(each.by_setting[setting].pairs.by_chance for each in own) / len(own)
        yield Point(setting, _cost(own, setting), *size, chance)


def _path(findings: Sequence[Finding], setting: str) -> Iterator[Point]:
    """Make the point of the error of the path, from the cells that are not chaotic."""
    own = [each for each in findings if setting in each.by_setting and not each.is_chaotic]
    paths = [1e3 * each.by_setting[setting].path for each in own]
    paths = [path for path in paths if path > 0.0]  # neither nan nor off the scale
    if paths:
        yield Point(setting, _cost(own, setting), median(paths), min(paths), max(paths), math.nan)


def _cost(findings: Sequence[Finding], setting: str) -> float:
    return 1e3 * median(each.by_setting[setting].cost for each in findings)


def _curve(ax: Axes, points: Sequence[Point], title: str, style: Mapping[str, Any]) -> None:
    if not points:
        return
    costs = [point.cost for point in points]
    errors = [point.error for point in points]
    # Of a single cell there is no interval.
    sides = [
        [min(max(point.error - point.low, 0.0), point.error) for point in points],
        [point.high - point.error if math.isfinite(point.high) else 0.0 for point in points],
    ]
    ax.errorbar(
        costs, errors, yerr=sides, markersize=4, linewidth=1.2, elinewidth=0.7, label=title, **style
    )
    if not math.isnan(points[0].chance):
        chances = [point.chance for point in points]
        ax.plot(costs, chances, color=style["color"], linestyle=":", label=f"{title}, by chance")


def _mark(ax: Axes, points: Sequence[Point], default: str, is_named: bool) -> None:
    """Ring the setting that is judged, and name the settings in one panel."""
    for point in points:
        if point.setting == default:
            place = ([point.cost], [point.error])
            ring: dict[str, Any] = {
                "markersize": 10,
                "markerfacecolor": "none",
                "color": _RED,
                "linestyle": "",
            }
            ax.plot(*place, marker="o", label=default, **ring)
        if is_named:
            ax.annotate(
                point.setting,
                (point.cost, point.error),
                textcoords="offset points",
                xytext=(5, 5),
                fontsize="x-small",
            )
