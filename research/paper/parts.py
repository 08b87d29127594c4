"""The parts of the reproduction in the order in which they are made, and the page they make up."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import TYPE_CHECKING, Any

from crawler2d._core import build_info
from research.markdown import spliced
from research.paper import fields_report, report
from research.paper.claims import claims
from research.paper.design import QUICK
from research.paper.failures import failures, gathered
from research.paper.fields import BESIDE_TABLE_2, beside, cells, cross_fields
from research.paper.figures import plot_layouts, plot_stuck
from research.paper.layouts import GEAR_MODEL_OTHERWISE, layouts
from research.paper.performance import (
    computing,
    driving,
    highest_obstacles,
    steepest_slopes,
)
from research.paper.phases import phases, shaking
from research.paper.plot import plot_table_2
from research.paper.stuck import stuck_runs, write_stuck
from research.tables import write_csv

if TYPE_CHECKING:
    from pathlib import Path

    from matplotlib.figure import Figure

    from crawler2d.sweeps.found import Found
    from research.paper.design import Work
    from research.paper.settings import Setting

__all__ = ["PARTS", "Pages", "Part"]

_SLOWEST = {"24 gears all round", "chain of 22 shoes"}
"""Layouts of ours whose runs take longer than those of all others together: they come last."""

Made = Iterator[tuple[str, str]]
"""Names of sections with their text."""

_ORDER = (
    *("chosen beforehand", "table 2", "all layouts", "failures", "table 1", "table 3"),
    *("highest obstacles", "real-time factors", "equation (1)", "claims", "checks", "figures"),
)
"""Of the sections in the page."""

_REPLAYS = "replays_paper"
"""The folder of the pages that replay Figs. 4 and 5: the study empties its own."""


@dataclass(slots=True)
class Pages:
    """What is written: the page of all sections, after every part; tables, pictures, replays.

    Attributes
    ----------
    out : Path
        The folder.
    work : Work
        What is made.
    into : Path or None
        Another page, written by hand, with marks where sections go.
    sections : dict of str to str
        Those that have been made, by name.
    fields : list of pair of Setting and Found
        The runs of Table 2, so far.
    blocks : dict of str to Found
        Those over the parallelepiped of Table 3, by setting.
    """

    out: Path
    work: Work
    into: Path | None = None
    sections: dict[str, str] = field(default_factory=dict)
    fields: list[tuple[Setting, Found]] = field(default_factory=list)
    blocks: dict[str, Found] = field(default_factory=dict)

    @property
    def text(self) -> str:
        """The page."""
        parts = [
            f"## {name[0].upper()}{name[1:]}\n\n{self.sections[name]}"
            for name in _ORDER
            if name in self.sections
        ]
        return "\n\n".join(("# The paper, reproduced", self._head(), *parts))

    def add(self, name: str, text: str) -> None:
        """Add a section, or replace it, and write the page."""
        self.sections[name] = text
        (self.out / "paper.md").write_text(f"{self.text}\n", encoding="utf-8")
        if self.into is not None:
            page = self.into.read_text(encoding="utf-8")
            parts = {"how it was made": self._head(), name: text}
            self.into.write_text(spliced(page, parts), encoding="utf-8")

    def rows(self, name: str, rows: Sequence[Any]) -> None:
        """Write rows of one dataclass as paper_NAME.csv."""
        if rows:
            write_csv(self.out / f"paper_{name}.csv", rows)

    def picture(self, name: str, draw: Callable[[], Figure]) -> None:
        """Draw a figure as paper_NAME.png, beside the other page, too, if that shows it."""
        file, folders = f"paper_{name}.png", [self.out]
        if self.into is not None and file in self.into.read_text(encoding="utf-8"):
            folders.append(self.into.parent)
        try:
            figure = draw()
            for folder in folders:
                figure.savefig(folder / file, dpi=100)
        except ImportError as missing:
            print(f"no picture: {missing}", file=sys.stderr)

    def _head(self) -> str:
        design = self.work.design
        build = ", ".join(f"{name} {value}" for name, value in build_info().items())
        quick = "**A quick run, to see what comes out: few repeats.** " * (design == QUICK)
        tried = self.work.tried
        return (
            f"{quick}Build: {build}. Seed {self.work.seed}; {design.field_repeats} runs a cell of"
            f" Table 2, {design.height_repeats} a height, {design.claim_repeats} a cell of a claim."
            f" Tried in all: {tried['runs']} runs in {tried['settings']} cells of layout, motors,"
            " friction and ground; a cell that two questions share counts twice."
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class Part:
    """A part of the reproduction."""

    name: str
    option: str
    """By which ``--table`` chooses it."""
    make: Callable[[Work, Pages], Made]


def _chosen(_work: Work, _pages: Pages) -> Made:
    yield "chosen beforehand", fields_report.chosen_text()


def _paper_fields(work: Work, pages: Pages) -> Made:
    yield from _fields(work, pages, _named(work, lambda row: row not in ("", GEAR_MODEL_OTHERWISE)))


def _fields_read_otherwise(work: Work, pages: Pages) -> Made:
    yield from _fields(work, pages, _named(work, lambda row: row == GEAR_MODEL_OTHERWISE))


def _other_fields(work: Work, pages: Pages) -> Made:
    ours = _named(work, lambda row: row == "")
    for names in (set(ours) - _SLOWEST, set(ours) & _SLOWEST):
        yield from _fields(work, pages, [name for name in ours if name in names])


def _named(work: Work, wanted: Callable[[str], bool]) -> list[str]:
    """Name the layouts for Table 2 by what they stand for: a column, or "" if they are ours."""
    chosen = work.design.field_layouts or tuple(layouts())
    return [name for name in chosen if wanted(BESIDE_TABLE_2.get(name, ""))]


def _fields(work: Work, pages: Pages, names: Sequence[str]) -> Made:
    for made in cross_fields(work, names):
        pages.fields.append(made)
        rows = [row for setting, found in pages.fields for row in cells(setting, found)]
        pages.rows("table_2", rows)
        yield "all layouts", fields_report.layouts_text(rows)
        pairs = beside(rows)
        pages.rows("table_2_beside", pairs)
        yield "table 2", fields_report.table_2_text(pairs)
        pages.picture("table_2", partial(plot_table_2, pairs))
    failed = failures(pages.fields, work.store)
    pages.rows("failures", failed)
    yield "failures", fields_report.failures_text(gathered(failed), BESIDE_TABLE_2)


def _tables_1_and_3(work: Work, pages: Pages) -> Made:
    driven, factors, slopes = driving(work), computing(work), steepest_slopes(work)
    heights, pages.blocks = highest_obstacles(work)
    pages.rows("driving", driven)
    pages.rows("computing", factors)
    pages.rows("slopes", slopes)
    pages.rows("heights", heights)
    yield "table 1", report.table_1_text(slopes, driven)
    yield "table 3", report.table_3_text(driven)
    yield "highest obstacles", report.heights_text(heights)
    yield "real-time factors", report.computing_text(factors)


def _equation(work: Work, pages: Pages) -> Made:
    angles, shaken = phases(work), shaking(work)
    pages.rows("phases", angles)
    pages.rows("shaking", shaken)
    yield "equation (1)", report.equation_text(angles, shaken)


def _claims(work: Work, _pages: Pages) -> Made:
    found = claims(work, shaking(work))
    yield "claims", report.claims_text(found)
    yield "checks", report.checks_text(found)


def _figures(work: Work, pages: Pages) -> Made:
    if not pages.blocks:
        _, pages.blocks = highest_obstacles(work)
    stuck = stuck_runs(pages.blocks)
    write_stuck(stuck, pages.out / _REPLAYS)
    pages.picture("layouts", plot_layouts)
    pages.picture("stuck", partial(plot_stuck, stuck))
    yield "figures", report.figures_text(stuck, _REPLAYS)


PARTS = (
    Part(name="what was chosen beforehand", option="chosen", make=_chosen),
    Part(name="Table 2, the paper's layouts", option="2", make=_paper_fields),
    Part(name="eq. (1)", option="eq1", make=_equation),
    Part(name="Tables 1 and 3", option="3", make=_tables_1_and_3),
    Part(name="figures", option="figures", make=_figures),
    Part(name="claims", option="claims", make=_claims),
    Part(name="Table 2, gears read otherwise", option="2", make=_fields_read_otherwise),
    Part(name="Table 2, other layouts", option="2", make=_other_fields),
)
"""What the paper itself has comes first: small gears all round take longest."""
