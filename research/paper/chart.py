"""A chart that tests which drive, if any, gives the paper's Table 2.

Its cells are simulated over motor torque, rotor inertia and friction, and compared with the paper's
rates all at once. A store keeps every run: after Ctrl-C, the same call continues there.
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import product
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from scipy import stats  # type: ignore[import-untyped]

import crawler2d as c2d
from crawler2d.common.extras import extra
from crawler2d.drawings.palette import BLACK, GREEN, ORANGE, PALE, RED, SKY, VIOLET
from crawler2d.presets.unknowns import RUN_UP
from research import paper
from research.models import study_robot
from research.paper import PAPER_RUNS, TABLE_1
from research.paper.command import STORE, Pages, add_page_option
from research.paper.design import PRESET, PUBLIC, Setting, Work
from research.paper.table_2 import COLUMNS, FIELDS, cells, cross
from research.study import Job, Study
from research.tables import group_by, markdown_table, percent

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

LEVEL = 0.05
"""[-] One minus the confidence of the region."""

Table = Mapping[tuple[str, str], int]
"""Number of the paper's 20 runs that cleared, by field and layout."""


def _table(gears: str) -> Table:
    layout = {column: name for name, column in COLUMNS.items()}
    return {
        (row.obstacle, layout[column]): round(PAPER_RUNS * row.columns[column])
        for row in paper.TABLE_2
        for column in (paper.CWA_ROUND, paper.LWA_ROUND, gears)
    }


TABLES: Mapping[str, Table] = {
    "large gears": _table(paper.GEAR_MODEL),
    "small gears": _table(paper.GEAR_MODEL_OTHERWISE),
}
"""The nine cells of the paper's Table 2, by the reading of the column of gears."""
_HITS = {cell: hits for table in TABLES.values() for cell, hits in table.items()}

_DRAWS = 20_000

_DIAGONAL = "diagonal barrier"

_REAL_TORQUES = (6.0, 12.0)
"""[N m] Torques of a plausible drive: the preset's torque, and twice that."""

TILES = {"agrees": GREEN, "open": "#F5EE9E", "below": SKY, "above": ORANGE}
EXCLUDED = PALE

_ABOVE = 0.25
"""[-] Position of text above the middle of a tile, below which are the points of drives."""

_WIDE = 16.0
"""[in] Width from which the legend fits on one line."""

_POINT: dict[str, Any] = {
    "markersize": 8,
    "markerfacecolor": "none",
    "markeredgecolor": RED,
    "markeredgewidth": 2,
}


@dataclass(frozen=True, slots=True, kw_only=True)
class Drives:
    """The drives that are tried, and the numbers of runs."""

    torques: tuple[float, ...]
    """[N m] Of one sprocket."""
    inertias: tuple[float, ...]
    """[kg m^2] Moment of inertia of the rotor of one track, at its sprocket."""
    frictions: tuple[float, ...]
    """[-] Friction between track and ground."""
    runs: tuple[int, ...]
    """Runs per cell, by layout in the order of `COLUMNS`: gears that grind take longest."""
    most: int
    """Runs per cell if the first ones leave the drive in agreement with the paper."""

    def settings(self) -> list[Setting]:
        """List the drives for each friction, one friction after the other."""
        return [
            Setting(
                name=f"{torque:g} N m, {inertia:g} kg m^2, friction {friction:g}",
                max_torque=torque,
                rotor_inertia=inertia,
                friction=friction,
                reason="a point of the chart",
            )
            for friction in self.frictions
            for torque in self.torques
            for inertia in self.inertias
        ]


_DEFAULT = Drives(
    torques=(1.0, 10.0, 100.0, 1000.0),
    inertias=(0.0, 0.1),
    frictions=(0.5, 0.7, 0.8, 0.9),
    runs=(4, 4, 2, 1),
    most=20,
)
"""Coarse, because gears that grind in a jam until the end take most of the time."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Drive:
    """A drive on a ground."""

    torque: float
    """[N m] Of one sprocket."""
    inertia: float
    """[kg m^2] Moment of inertia of the rotor of one track, at its sprocket."""
    friction: float

    @property
    def label(self) -> str:
        """Its name, without the ground."""
        return f"{self.torque:g} N m, {self.inertia:g} kg m^2"


@dataclass(frozen=True, slots=True, kw_only=True)
class DriveCell(Drive):
    """One layout in one field, driven by one drive."""

    obstacle: str
    """As in `FIELDS`."""
    model: str
    cleared: int
    count: int
    """Runs with a result."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Verdict(Drive):
    """The verdict of the paper's table on one drive."""

    reading: str
    """As in `TABLES`."""
    deviance: float
    """[-] Deviance of all cells, relative to rates that are exactly the paper's."""
    probability: float
    """[-] Probability of a deviance at least as large, if the paper's robot had this drive."""
    straight: float
    """[-] The same without the diagonal barrier, on which a real robot may turn."""
    differing: int
    """Number of cells whose rates differ, as in `Agreement`."""
    cells: int
    farthest: str
    """The cells that contribute most to the deviance, as text."""

    @property
    def is_left(self) -> bool:
        """Whether the table does not exclude this drive."""
        return self.probability >= LEVEL


@dataclass(frozen=True, slots=True)
class _Grid:
    """Torques and inertias as tiles of equal size, because 0 has no logarithm."""

    torques: tuple[float, ...]
    inertias: tuple[float, ...]

    def tile(self, torque: float, inertia: float) -> tuple[float, float]:
        """Return the coordinates of a drive."""
        return _place(torque, self.torques), _place(inertia, self.inertias)

    def prepare(self, ax: Axes, *, named: bool) -> None:
        """Set limits and ticks, without names if a neighbour has them."""
        across, up = len(self.torques), len(self.inertias)
        ax.set(xlim=(-0.5, across - 0.5), ylim=(-0.5, up - 0.5))
        ax.set_xticks(range(across), [f"{each:g}" for each in self.torques] if named else [])
        ax.set_yticks(range(up), [])
        ax.tick_params(length=0, labelsize=7)


def _place(value: float, grid: tuple[float, ...]) -> float:
    """Return the coordinate of a value among tiles: logarithmic, with 0 on its own tile."""
    positive = [each for each in grid if each > 0.0]
    first = len(grid) - len(positive)
    if value <= 0.0 or not positive:
        return 0.0
    logs = [math.log(each) for each in positive]
    if value < positive[0]:
        decade = math.log(10.0) if len(logs) == 1 else logs[1] - logs[0]
        return first - min((logs[0] - math.log(value)) / decade, 0.5)
    return first + float(np.interp(math.log(value), logs, range(len(logs))))


_HITS_OF_PAPER = np.arange(PAPER_RUNS + 1)
_EXACT = stats.binom.logpmf(_HITS_OF_PAPER, PAPER_RUNS, _HITS_OF_PAPER / PAPER_RUNS)
"""[-] The logarithm of the probability of 0 to 20 successes at the rate that they give."""


def drive_cells(work: Work, drives: Drives) -> Iterator[list[DriveCell]]:
    """Drive the layouts of Table 2 over its fields with every drive.

    Yields
    ------
    list of DriveCell
        All cells so far, after every friction, and once more after more runs with the drives that
        are not excluded.
    """
    tried: dict[Setting, list[DriveCell]] = {}
    for settings in group_by(drives.settings(), "friction").values():
        for setting in settings:
            tried[setting] = _cross(work, setting, drives.runs)
        yield [cell for each in tried.values() for cell in each]
    for setting, rows in tried.items():
        if wanted := layouts_left(rows):
            runs = [
                max(count, drives.most) if model in wanted else count
                for model, count in zip(COLUMNS, drives.runs, strict=True)
            ]
            tried[setting] = _cross(work, setting, runs)
    yield [cell for each in tried.values() for cell in each]


def compare_drive(rows: Sequence[DriveCell], table: Table, reading: str = "") -> Verdict:
    """Compare the cells of one drive with a table, by one likelihood ratio of all of them.

    The paper has k of 20 runs in a cell, and the simulation s of n. With Jeffreys' prior, our runs
    give the rate a beta distribution, so the probability of the paper's k is beta-binomial; few
    runs make it broad, and exclude little. The deviance is minus twice the logarithm of the
    probability of all cells, relative to that for rates that are exactly the paper's. For rates of
    0 and 1, its asymptotic chi-squared distribution does not hold, and so its distribution is
    sampled from tables that the drive itself gives. A drive is left if at least one in twenty of
    them is as far off as the paper's. The drives that are left are a region of 95 % confidence,
    which is empty if no drive gives the table.

    Parameters
    ----------
    rows : sequence of DriveCell
        The cells of one drive; those that are not in the table are ignored.
    table : mapping of pair of str to int
        The table; all of its cells must be among the rows.
    reading : str
        The name of the table.

    Raises
    ------
    ValueError
        If a cell of the table has no runs.
    """
    own = {(row.obstacle, row.model): row for row in rows if row.count}
    if missing := set(table) - set(own):
        raise ValueError(f"no runs of {sorted(missing)}")
    shares, probability = _deviance(own, table)
    straight = {cell: hits for cell, hits in table.items() if cell[0] != _DIAGONAL}
    farthest = sorted(zip(shares, table, strict=True), reverse=True)[:3]
    first = rows[0]
    return Verdict(
        torque=first.torque,
        inertia=first.inertia,
        friction=first.friction,
        reading=reading,
        deviance=sum(shares),
        probability=probability,
        straight=_deviance(own, straight)[1],
        differing=sum(cell_verdict(own[cell], hits) == "differs" for cell, hits in table.items()),
        cells=len(table),
        farthest="; ".join(
            f"{model}, {obstacle}: {own[obstacle, model].cleared} of {own[obstacle, model].count},"
            f" the paper {table[obstacle, model]} of {PAPER_RUNS}"
            for _, (obstacle, model) in farthest
        ),
    )


def layouts_left(rows: Sequence[DriveCell]) -> set[str]:
    """Name the layouts of the readings of the paper's table that do not exclude the drive.

    More runs of these are useful; more runs of others would exclude the same.
    """
    left = [table for table in TABLES.values() if compare_drive(rows, table).is_left]
    return {model for table in left for _, model in table}


def cell_verdict(row: DriveCell, hits: int) -> str:
    """Return whether one of our rates agrees with one of the paper; see `Agreement`."""
    return paper.agreement(row.cleared, row.count, hits / PAPER_RUNS).verdict


def drives_text(rows: Sequence[DriveCell], verdicts: Sequence[Verdict]) -> str:
    """Describe the number of runs, the drives that are left, and those that come closest."""
    runs = []
    for model, cells_of in group_by(rows, "model").items():
        least, most = min(row.count for row in cells_of), max(row.count for row in cells_of)
        runs.append(f"{least if least == most else f'{least} to {most}'} of {model}")
    drives = {(row.torque, row.inertia) for row in rows}
    frictions = ", ".join(f"{each:g}" for each in sorted({row.friction for row in rows}))
    head = (
        f"{sum(row.count for row in rows)} runs, of {len(drives)} drives at frictions of"
        f" {frictions}; runs a cell: {'; '.join(runs)}."
    )
    table = []
    for (friction, reading), own in group_by(verdicts, "friction", "reading").items():
        left = [each.label for each in own if each.is_left]
        # Few runs exclude less and have a larger p, so drives are sorted by differing cells first.
        best = min(own, key=lambda each: (each.differing, -each.probability, each.deviance))
        table.append(
            (
                f"{friction:g}",
                reading,
                f"{len(left)} of {len(own)}" + (f": {'; '.join(left)}" if left else ""),
                best.label,
                f"{best.probability:.2g}",
                f"{best.straight:.2g}",
                f"{best.differing} of {best.cells}",
                best.farthest,
            )
        )
    columns = (
        *("friction", "gears read as", "drives left", "nearest drive", "p"),
        *("p without the diagonal", "cells that differ", "cells that are farthest off"),
    )
    return f"{head}\n\n{markdown_table(columns, table)}"


def real_inertias() -> tuple[float, float]:
    """[kg m^2] Return the smallest and the largest rotor inertia of a plausible drive.

    It is the run-up time times the torque over the no-load speed, which is the declared or the
    measured speed of the robot (Table 1).
    """
    outline = study_robot().outline
    radius = outline.rear_radius - outline.grouser_height
    fast, slow = TABLE_1.declared_max_speed / radius, TABLE_1.max_speed / radius
    return RUN_UP[0] * _REAL_TORQUES[0] / fast, RUN_UP[1] * _REAL_TORQUES[1] / slow


def plot_drives(rows: Sequence[DriveCell], verdicts: Sequence[Verdict]) -> Figure:
    """Draw the rates of every layout and field over torque and inertia, and the drives left.

    Parameters
    ----------
    rows : sequence of DriveCell
        One or more frictions; tiles without runs stay empty.
    verdicts : sequence of Verdict
        Of the same drives.
    """
    torques, inertias, frictions = (
        tuple(sorted(group_by(rows, name))) for name in ("torque", "inertia", "friction")
    )
    grid = _Grid(torques, inertias)
    width = 5.6 * len(frictions) + 1.2
    figure: Figure = extra("matplotlib.figure", "plot").Figure(figsize=(width, 11.0))
    columns, lines = len(frictions) * len(FIELDS), len(COLUMNS)
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
    own = group_by(rows, "model", "friction", "obstacle")
    for ax, place in zip(above.flat, product(COLUMNS, frictions, FIELDS), strict=True):
        model, friction, field = place
        hits = _HITS[field, model]
        _draw_rates(ax, own.get(place, ()), grid, hits)
        spot = ax.get_subplotspec()
        top = f"friction {friction:g}, {field}\n" if spot.is_first_row() else ""
        rate, low, high = (percent(each) for each in c2d.wilson(hits, PAPER_RUNS))
        title = f"{top}paper {rate} % ({low} to {high})"
        ax.set_title(title, fontsize=7, loc="left", pad=3)
        if spot.is_first_col():
            _name_inertias(ax, grid, model)
    below = whole[1].subgridspec(1, len(TABLES) * len(frictions), wspace=0.12)
    panels, tested = below.subplots(squeeze=False), group_by(verdicts, "friction", "reading")
    for ax, test in zip(panels.flat, product(frictions, TABLES), strict=True):
        _draw_verdicts(ax, tested.get(test, ()), grid)
        title = f"friction {test[0]:g}: all nine cells at once, {test[1]}"
        ax.set_title(title, fontsize=8, loc="left", pad=3)
        ax.set_xlabel("torque of a sprocket [N m]", fontsize=7)
    _name_inertias(panels[0, 0], grid, "all nine cells")
    _explain(figure, verdicts)
    return figure


def _cross(work: Work, setting: Setting, runs: Sequence[int]) -> list[DriveCell]:
    print(f"Table 2, {setting.name}", flush=True)
    return [
        DriveCell(
            torque=setting.max_torque,
            inertia=setting.rotor_inertia or 0.0,
            friction=setting.friction,
            obstacle=row.obstacle,
            model=row.model,
            cleared=row.cleared,
            count=row.count,
        )
        for model, count in zip(COLUMNS, runs, strict=True)
        for row in cells(setting, cross(setting, [model], work, count))
    ]


def _deviance(own: Mapping[tuple[str, str], DriveCell], table: Table) -> tuple[list[float], float]:
    """Return each cell's part of the deviance, and the probability of so large a sum."""
    chances = [_chances(own[cell].cleared, own[cell].count) for cell in table]
    deviances = [2.0 * (_EXACT - np.log(each)) for each in chances]
    shares = [float(each[hits]) for each, hits in zip(deviances, table.values(), strict=True)]
    # The seed is fixed: equal counts give equal probabilities.
    rng = np.random.default_rng(0)
    drawn = sum(
        each[rng.choice(PAPER_RUNS + 1, size=_DRAWS, p=chance)]
        for each, chance in zip(deviances, chances, strict=True)
    )
    # Sums of the same terms in a different order differ by rounding.
    farther = int(np.count_nonzero(drawn >= sum(shares) - 1e-9))
    return shares, (farther + 1) / (_DRAWS + 1)


def _chances(cleared: int, count: int) -> NDArray[np.float64]:
    """Return the beta-binomial probability of 0 to 20 of the paper's runs, with Jeffreys' prior."""
    a, b = cleared + 0.5, count - cleared + 0.5
    chances: NDArray[np.float64] = stats.betabinom.pmf(_HITS_OF_PAPER, PAPER_RUNS, a, b)
    chances /= chances.sum()  # 1, except for rounding
    return chances


def _name_inertias(ax: Axes, grid: _Grid, title: str) -> None:
    ax.set_yticks(range(len(grid.inertias)), [f"{each:g}" for each in grid.inertias])
    ax.set_ylabel(f"{title}\nrotor [kg m$^2$]", fontsize=7)


def _explain(figure: Figure, verdicts: Sequence[Verdict]) -> None:
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
    words = ("cleared / runs: agrees with the paper", "open", "below the paper", "above it")
    handles = [
        patches.Patch(color=color, label=text)
        for color, text in zip(TILES.values(), words, strict=True)
    ]
    handles += [
        lines.Line2D((), (), marker="o", linestyle="", label="preset", **_POINT),
        lines.Line2D((), (), marker="^", linestyle="", label="public simulation", **_POINT),
        patches.Patch(fill=False, edgecolor=VIOLET, linewidth=2.0, label="plausible real drive"),
        patches.Patch(color=GREEN, label="bottom row: left by all nine cells (p at least 0.05)"),
        patches.Patch(color=TILES["open"], label="left without the diagonal barrier"),
        patches.Patch(color=EXCLUDED, label="excluded"),
    ]
    figure.legend(
        handles=handles,
        loc="upper left",
        bbox_to_anchor=(0.005, 0.972),
        ncols=len(handles) if figure.get_figwidth() > _WIDE else 5,
        fontsize=8,
        frameon=False,
    )


def _draw_rates(ax: Axes, rows: Sequence[DriveCell], grid: _Grid, hits: int) -> None:
    grid.prepare(ax, named=False)
    ax.set_facecolor("white")
    for row in rows:
        if row.count:
            rate = row.cleared / row.count
            side = "below" if rate < hits / PAPER_RUNS else "above"
            color = TILES.get(cell_verdict(row, hits), TILES[side])
            _tile(ax, grid.tile(row.torque, row.inertia), color, f"{row.cleared}/{row.count}")


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


def _draw_verdicts(ax: Axes, verdicts: Sequence[Verdict], grid: _Grid) -> None:
    grid.prepare(ax, named=True)
    for each in verdicts:
        straight = TILES["open"] if each.straight >= LEVEL else EXCLUDED
        color = GREEN if each.is_left else straight
        chance = f"{each.probability:.2g}" if each.probability >= 1e-4 else "<1e-4"
        text = f"{each.differing} differ\np {chance}"
        _tile(ax, grid.tile(each.torque, each.inertia), color, text, above=_ABOVE)
    corners = zip(_REAL_TORQUES, real_inertias(), strict=True)
    (left, low), (right, high) = (grid.tile(*corner) for corner in corners)
    xs, ys = (left, right, right, left, left), (low, low, high, high, low)
    ax.plot(xs, ys, color=VIOLET, linewidth=2.0)
    ax.plot(*grid.tile(PRESET.max_torque, 0.0), "o", **_POINT)
    # The motors of the model's three wheels on a side.
    public = PUBLIC.on(study_robot(track="public")).drivetrain
    ax.plot(*grid.tile(public.max_torque, 0.0), "^", **_POINT)


def _run_chart(job: Job) -> None:
    options = job.options
    drives = Drives(
        torques=tuple(sorted(options.torques)),
        inertias=tuple(sorted(options.inertias)),
        frictions=tuple(options.frictions),
        runs=tuple(options.runs),
        most=options.most,
    )
    pages = Pages(job, Work(store=job.out / STORE, **job.sampling))
    for rows in drive_cells(pages.work, drives):
        print(_write_chart(rows, pages), flush=True)


def _write_chart(rows: Sequence[DriveCell], pages: Pages) -> str:
    """Write tables and picture of all runs so far, and the part of the page."""
    verdicts = [
        compare_drive(own, table, reading)
        for reading, table in TABLES.items()
        for own in group_by(rows, "friction", "torque", "inertia").values()
    ]
    verdicts.sort(key=lambda each: each.friction)
    pages.write_rows(drives=rows, drives_joint=verdicts)
    pages.draw(drives=partial(plot_drives, rows, verdicts))
    text = drives_text(rows, verdicts)
    pages.splice({"drives": text})
    return text


def _add_options(parser: argparse.ArgumentParser) -> None:
    for name, what, kind, count in (
        ("torques", "[N m] of a sprocket", float, "+"),
        ("inertias", "[kg m^2] of the rotor of a track", float, "+"),
        ("frictions", "between track and ground", float, "+"),
        ("runs", f"runs a cell of {', '.join(COLUMNS)}", int, len(COLUMNS)),
        ("most", "runs a cell of drives that these leave", int, None),
    ):
        default = getattr(_DEFAULT, name)
        values = " ".join(f"{each:g}" for each in np.atleast_1d(default))
        text = f"{what} (default: {values})"
        parser.add_argument(f"--{name}", type=kind, nargs=count, default=default, help=text)
    add_page_option(parser, "a page in Markdown whose part to replace")


CHART = Study(text=__doc__ or "", run=_run_chart, full=None, add_options=_add_options)
