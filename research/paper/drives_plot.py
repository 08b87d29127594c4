"""The paper's Table 2 over all drives as one picture."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from crawler2d.common.extras import extra
from crawler2d.drawings.scene import BLACK, GREEN, RED, VIOLET
from crawler2d.presets.robots import engineer
from crawler2d.presets.unknowns import RUN_UP
from crawler2d.sweeps.statistics import wilson
from research.columns import percent
from research.paper.agreement import PAPER_RUNS
from research.paper.fields import BESIDE_TABLE_2, FIELDS
from research.paper.joint import LEVEL, TABLES, verdict
from research.paper.published import TABLE_1
from research.paper.settings import PRESET, PUBLIC

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from research.paper.joint import DriveCell, Judged

__all__ = ["REAL_TORQUES", "plot_drives", "real_inertias"]

REAL_TORQUES = (6.0, 12.0)
"""[N m] Of a plausible drive: the preset's torque, and twice as much."""

_COLORS = {"agrees": GREEN, "open": "#A5DCC9", "below": "#9CC3E6", "above": "#F4C07A"}
_EXCLUDED = "#E4E4E4"

_ABOVE = 0.25
"""Of a tile: so that words leave the room to the points of drives."""

_WIDE = 16.0
"""[in] From which the legend fits in one line."""


@dataclass(frozen=True, slots=True)
class _Grid:
    """Torques and inertias as tiles of equal size, for 0 has no logarithm."""

    torques: tuple[float, ...]
    inertias: tuple[float, ...]

    def x(self, torque: float) -> float:
        return _place(torque, self.torques)

    def y(self, inertia: float) -> float:
        return _place(inertia, self.inertias)

    def tile(self, drive: DriveCell | Judged) -> tuple[float, float]:
        return self.x(drive.torque), self.y(drive.inertia)

    def prepare(self, ax: Axes, *, named: bool) -> None:
        """Set limits and ticks; without names where a neighbour has them."""
        across, up = len(self.torques), len(self.inertias)
        ax.set(xlim=(-0.5, across - 0.5), ylim=(-0.5, up - 0.5))
        ax.set_xticks(range(across), [f"{each:g}" for each in self.torques] if named else [])
        ax.set_yticks(range(up), [])
        ax.tick_params(length=0, labelsize=7)


def real_inertias() -> tuple[float, float]:
    """[kg m^2] Return the least and the greatest rotor inertia of a plausible drive.

    The run-up time times the torque over the no-load speed: the declared speed of the robot, or the
    one that was measured (Table 1).
    """
    outline = engineer().outline
    radius = outline.rear_radius - outline.grouser_height
    fast, slow = TABLE_1.declared_max_speed / radius, TABLE_1.max_speed / radius
    return RUN_UP[0] * REAL_TORQUES[0] / fast, RUN_UP[1] * REAL_TORQUES[1] / slow


def plot_drives(rows: Sequence[DriveCell], verdicts: Sequence[Judged]) -> Figure:
    """Draw the rates of every layout and field over torque and inertia, and which drives are left.

    Parameters
    ----------
    rows : sequence of DriveCell
        One or more frictions; tiles without runs stay empty.
    verdicts : sequence of Judged
        Of the same drives.

    Returns
    -------
    Figure
        Not shown and not saved.

    Raises
    ------
    ImportError
        If matplotlib is missing; the message names the extra to install.
    """
    figures = extra("matplotlib.figure", "plot")
    grid = _Grid(
        tuple(sorted({row.torque for row in rows})), tuple(sorted({row.inertia for row in rows}))
    )
    frictions = sorted({row.friction for row in rows})
    width = 5.6 * len(frictions) + 1.2
    figure: Figure = figures.Figure(figsize=(width, 11.0))
    columns, lines = len(FIELDS) * len(frictions), len(BESIDE_TABLE_2)
    whole = figure.add_gridspec(
        *(2, 1),
        height_ratios=(lines, 1.6),
        hspace=0.13,
        left=0.9 / width,
        right=1.0 - 0.1 / width,
        top=0.90,
        bottom=0.05,
    )
    above = whole[0].subgridspec(lines, columns, wspace=0.06, hspace=0.24).subplots(squeeze=False)
    for line, model in enumerate(BESIDE_TABLE_2):
        for column in range(columns):
            ax, friction = above[line, column], frictions[column // len(FIELDS)]
            field = list(FIELDS)[column % len(FIELDS)]
            wanted = (field, model, friction)
            own = [row for row in rows if (row.obstacle, row.model, row.friction) == wanted]
            _draw_rates(ax, own, grid, _paper(field, model))
            top = f"friction {friction:g}, {field}\n" if line == 0 else ""
            ax.set_title(f"{top}{_paper_text(_paper(field, model))}", fontsize=7, loc="left", pad=3)
            if column == 0:
                _name_inertias(ax, grid, model)
    below = whole[1].subgridspec(1, len(TABLES) * len(frictions), wspace=0.12)
    for place, ax in enumerate(below.subplots(squeeze=False).flat):
        friction, reading = frictions[place // len(TABLES)], list(TABLES)[place % len(TABLES)]
        here = [each for each in verdicts if (each.friction, each.reading) == (friction, reading)]
        _draw_verdicts(ax, here, grid)
        ax.set_title(
            f"friction {friction:g}: all nine cells at once, {reading}",
            fontsize=8,
            loc="left",
            pad=3,
        )
        ax.set_xlabel("torque of a sprocket [N m]", fontsize=7)
        if place == 0:
            _name_inertias(ax, grid, "all nine cells")
    _explain(figure, verdicts)
    return figure


def _draw_rates(ax: Axes, rows: Sequence[DriveCell], grid: _Grid, hits: int) -> None:
    grid.prepare(ax, named=False)
    ax.set_facecolor("white")
    for row in rows:
        if row.count:
            rate = row.cleared / row.count
            side = "below" if rate < hits / PAPER_RUNS else "above"
            color = _COLORS.get(verdict(row, hits), _COLORS[side])
            _tile(ax, grid.tile(row), color, f"{row.cleared}/{row.count}")


def _draw_verdicts(ax: Axes, verdicts: Sequence[Judged], grid: _Grid) -> None:
    grid.prepare(ax, named=True)
    for each in verdicts:
        straight = _COLORS["open"] if each.straight >= LEVEL else _EXCLUDED
        color = GREEN if each.is_left else straight
        chance = f"{each.probability:.2g}" if each.probability >= 1e-4 else "<1e-4"
        text = f"{each.differing} differ\np {chance}"
        _tile(ax, grid.tile(each), color, text, above=_ABOVE)
    corners = zip(REAL_TORQUES, real_inertias(), strict=True)
    (left, low), (right, high) = ((grid.x(torque), grid.y(each)) for torque, each in corners)
    xs, ys = (left, right, right, left, left), (low, low, high, high, low)
    ax.plot(xs, ys, color=VIOLET, linewidth=2.0)
    ax.plot(grid.x(PRESET.max_torque), grid.y(0.0), "o", **_POINT)
    ax.plot(grid.x(_public_torque()), grid.y(0.0), "^", **_POINT)


_POINT: dict[str, Any] = {
    "markersize": 8,
    "markerfacecolor": "none",
    "markeredgecolor": RED,
    "markeredgewidth": 2,
}


def _tile(ax: Axes, place: tuple[float, float], color: str, text: str, above: float = 0.0) -> None:
    x, y = place
    ax.fill(
        (x - 0.5, x + 0.5, x + 0.5, x - 0.5),
        (y - 0.5, y - 0.5, y + 0.5, y + 0.5),
        facecolor=color,
        edgecolor="white",
        linewidth=0.8,
    )
    ax.text(x, y + above, text, fontsize=7.5, ha="center", va="center", color=BLACK)


def _explain(figure: Figure, verdicts: Sequence[Judged]) -> None:
    drives = len({(each.torque, each.inertia, each.friction) for each in verdicts})
    left = sum(each.is_left for each in verdicts)
    figure.suptitle(
        f"Which drive gives the paper's Table 2? {drives} were tried, with the gears read in two"
        f" ways: {left or 'none'} left",
        x=0.01,
        y=0.985,
        ha="left",
        fontsize=13,
    )
    patches, lines = extra("matplotlib.patches", "plot"), extra("matplotlib.lines", "plot")
    words = {
        "agrees": "cleared / runs: agrees with the paper",
        "open": "open",
        "below": "below the paper",
        "above": "above it",
    }
    handles = [patches.Patch(color=_COLORS[key], label=text) for key, text in words.items()]
    handles += [
        lines.Line2D((), (), marker="o", linestyle="", label="preset", **_POINT),
        lines.Line2D((), (), marker="^", linestyle="", label="public simulation", **_POINT),
        patches.Patch(fill=False, edgecolor=VIOLET, linewidth=2.0, label="plausible real drive"),
        patches.Patch(color=GREEN, label="bottom row: left by all nine cells (p at least 0.05)"),
        patches.Patch(color=_COLORS["open"], label="left without the diagonal barrier"),
        patches.Patch(color=_EXCLUDED, label="excluded"),
    ]
    figure.legend(
        handles=handles,
        loc="upper left",
        bbox_to_anchor=(0.005, 0.972),
        ncols=len(handles) if figure.get_figwidth() > _WIDE else 5,
        fontsize=8,
        frameon=False,
    )


def _name_inertias(ax: Axes, grid: _Grid, title: str) -> None:
    ax.set_yticks(range(len(grid.inertias)), [f"{each:g}" for each in grid.inertias])
    ax.set_ylabel(f"{title}\nrotor [kg m$^2$]", fontsize=7)


def _paper(field: str, model: str) -> int:
    return next(
        hits for table in TABLES.values() for cell, hits in table.items() if cell == (field, model)
    )


def _paper_text(hits: int) -> str:
    rate, low, high = (percent(each) for each in wilson(hits, PAPER_RUNS))
    return f"paper {rate} % ({low} to {high})"


def _public_torque() -> float:
    """[N m] Add up the motors of the three wheels that the model has on a side."""
    wheels = engineer(track="public").without_flippers().wheels()["side"].tolist()
    count: int = wheels.count("left")
    return count * PUBLIC.max_torque


def _place(value: float, grid: tuple[float, ...]) -> float:
    """Return where a value lies among tiles: in the logarithm, and 0 on its own tile."""
    positive = [each for each in grid if each > 0.0]
    first = len(grid) - len(positive)
    if value <= 0.0 or not positive:
        return 0.0
    logs = [math.log(each) for each in positive]
    if value < positive[0]:
        decade = math.log(10.0) if len(logs) == 1 else logs[1] - logs[0]
        return first - min((logs[0] - math.log(value)) / decade, 0.5)
    return first + float(np.interp(math.log(value), logs, range(len(logs))))
