"""The paper, reproduced: its Tables 1 to 3, eq. (1), its claims and its figures.

Everything is simulated with settings that were chosen beforehand, and compared with the paper. A
store keeps every run: after Ctrl-C, the same call continues there.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import crawler2d as c2d
from crawler2d.sweeps.figure_dataset import FigureDataset
from research.paper import GEAR_MODEL_OTHERWISE, figures, performance, table_2
from research.paper.claims import checks_text, claims, claims_text
from research.paper.design import FULL, QUICK, Setting, Work, layouts
from research.study import Job, Study
from research.tables import splice_into

if TYPE_CHECKING:
    from matplotlib.figure import Figure

STORE = "paper.sqlite"
"""The file that keeps every run."""

_SLOWEST = {"24 gears all round", "chain of 22 shoes"}
"""Our layouts whose runs take longer than those of all others together; they come last."""

_ORDER = (
    *("chosen beforehand", "table 2", "all layouts", "failures", "table 1", "table 3"),
    *("highest obstacles", "real-time factors", "equation (1)", "claims", "checks", "figures"),
)
"""Order of the sections in the page."""

_REPLAYS = "replays_paper"
"""Folder of the pages that replay Figs. 4 and 5; the study empties its own folder."""

Sections = Iterator[tuple[str, str]]
"""Names of sections with their text."""


@dataclass(slots=True)
class Pages:
    """The output: the page of all sections, written after every part; tables, pictures, replays.

    Attributes
    ----------
    job : Job
        The study with its options.
    work : Work
        How runs are made, and their numbers.
    sections : dict of str to str
        Finished sections by name.
    fields : list of pair of Setting and FigureDataset
        The finished runs of Table 2.
    blocks : dict of str to FigureDataset
        The runs over the parallelepiped of Table 3, by setting.
    """

    job: Job
    work: Work
    sections: dict[str, str] = field(default_factory=dict)
    fields: list[tuple[Setting, FigureDataset]] = field(default_factory=list)
    blocks: dict[str, FigureDataset] = field(default_factory=dict)

    @property
    def into(self) -> Path | None:
        """Another page, written by hand, with marks for sections."""
        page: Path | None = self.job.options.into
        return page

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
        (self.job.out / "paper.md").write_text(f"{self.text}\n", encoding="utf-8")
        self.splice({"how it was made": self._head(), name: text})

    def splice(self, parts: Mapping[str, str]) -> None:
        """Insert parts between their marks in the other page."""
        if self.into is not None:
            splice_into(self.into, parts)

    def write_rows(self, **tables: Sequence[Any]) -> None:
        """Write rows of dataclasses as paper_NAME.csv."""
        self.job.write_rows(**{f"paper_{name}": rows for name, rows in tables.items()})

    def draw(self, **drawings: Callable[[], Figure]) -> None:
        """Draw figures as paper_NAME.png, also next to the other page if it shows them."""
        for name, drawing in drawings.items():
            shown = self.into is not None and f"paper_{name}.png" in self.into.read_text("utf-8")
            also = [self.into.parent] if self.into is not None and shown else []
            self.job.draw({f"paper_{name}": drawing}, also)

    def _head(self) -> str:
        design = self.work.design
        build = ", ".join(f"{name} {value}" for name, value in c2d.build_info().items())
        quick = "**A quick run, to see what comes out: few repeats.** " * (design == QUICK)
        tried = self.work.tried
        return (
            f"{quick}Build: {build}. Seed {self.work.seed}; {design.field_repeats} runs a cell of"
            f" Table 2, {design.height_repeats} a height, {design.claim_repeats} a cell of a claim."
            f" Tried in all: {tried['runs']} runs in {tried['settings']} cells of layout, motors,"
            " friction and ground; a cell that two questions share counts twice."
        )


def _chosen(_work: Work, _pages: Pages) -> Sections:
    yield "chosen beforehand", table_2.chosen_text()


def _fields(work: Work, pages: Pages, columns: Collection[str]) -> Sections:
    """Make Table 2 with the layouts for some columns, where "" means our own layouts."""
    chosen = work.design.field_layouts or tuple(layouts())
    names = [name for name in chosen if table_2.COLUMNS.get(name, "") in columns]
    for slow in (False, True):
        batch = [name for name in names if (name in _SLOWEST) == slow]
        for setting_and_runs in table_2.cross_fields(work, batch):
            pages.fields.append(setting_and_runs)
            rows = [row for each in pages.fields for row in table_2.cells(*each)]
            yield "all layouts", table_2.layouts_text(rows)
            pairs = table_2.compare(rows)
            pages.write_rows(table_2=rows, table_2_beside=pairs)
            yield "table 2", table_2.table_2_text(pairs)
            pages.draw(table_2=partial(table_2.plot_table_2, pairs))
    failed = table_2.failures(pages.fields, work.store)
    pages.write_rows(failures=failed)
    yield "failures", table_2.failures_text(failed, table_2.COLUMNS)


def _tables_1_and_3(work: Work, pages: Pages) -> Sections:
    driven, factors = performance.driving(work), performance.computing(work)
    slopes = performance.steepest_slopes(work)
    heights, pages.blocks = performance.highest_obstacles(work)
    pages.write_rows(driving=driven, computing=factors, slopes=slopes, heights=heights)
    yield "table 1", performance.table_1_text(slopes, driven)
    yield "table 3", performance.table_3_text(driven)
    yield "highest obstacles", performance.heights_text(heights)
    yield "real-time factors", performance.computing_text(factors)


def _equation(work: Work, pages: Pages) -> Sections:
    angles, shaken = figures.phases(work), figures.shaking(work)
    pages.write_rows(phases=angles, shaking=shaken)
    yield "equation (1)", figures.equation_text(angles, shaken)


def _claims(work: Work, _pages: Pages) -> Sections:
    settled = claims(work, figures.shaking(work))
    yield "claims", claims_text(settled)
    yield "checks", checks_text(settled)


def _figures(work: Work, pages: Pages) -> Sections:
    if not pages.blocks:
        _, pages.blocks = performance.highest_obstacles(work)
    stuck = figures.stuck_runs(pages.blocks)
    figures.write_stuck(stuck, pages.job.out / _REPLAYS)
    pages.draw(layouts=figures.plot_layouts, stuck=partial(figures.plot_stuck, stuck))
    yield "figures", figures.figures_text(stuck, _REPLAYS)


class _Part(NamedTuple):
    """A part of the reproduction."""

    name: str
    option: str
    """Value of ``--table`` that selects it."""
    make: Callable[[Work, Pages], Sections]


_COLUMNS = set(table_2.COLUMNS.values()) - {GEAR_MODEL_OTHERWISE}
_PARTS = (
    _Part("what was chosen beforehand", "chosen", _chosen),
    _Part("Table 2, the paper's layouts", "2", partial(_fields, columns=_COLUMNS)),
    _Part("eq. (1)", "eq1", _equation),
    _Part("Tables 1 and 3", "3", _tables_1_and_3),
    _Part("figures", "figures", _figures),
    _Part("claims", "claims", _claims),
    _Part("Table 2, gears read otherwise", "2", partial(_fields, columns={GEAR_MODEL_OTHERWISE})),
    _Part("Table 2, other layouts", "2", partial(_fields, columns={""})),
)
"""Layouts of the paper come first; small gears all round take longest."""


def add_page_option(parser: argparse.ArgumentParser, text: str) -> None:
    """Add the option for a page into which parts are spliced."""
    parser.add_argument("--into", type=Path, default=None, help=text)


def _run_paper(job: Job) -> None:
    wanted = job.options.table
    work = Work(store=job.out / STORE, design=FULL if job.full else QUICK, **job.sampling)
    pages = Pages(job, work)
    start, processor = time.perf_counter(), time.process_time()
    for part in _PARTS:
        if wanted is None or part.option in wanted:
            begin = time.perf_counter()
            for name, text in part.make(work, pages):
                pages.add(name, text)
            print(f"{part.name}: {(time.perf_counter() - begin) / 60.0:.1f} min", flush=True)
    elapsed = (time.perf_counter() - start) / 60.0
    processor = (time.process_time() - processor) / 60.0
    cost = f"{elapsed:.1f} min, {processor:.1f} min of processor time"
    print(f"\n{pages.text}\n\n{cost}; tables, pictures and replays are in {job.out}")


def _add_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--table",
        choices=sorted({part.option for part in _PARTS}),
        action="append",
        help="only this part; may be given more than once",
    )
    add_page_option(parser, "a page in Markdown whose tables to replace")


PAPER = Study(
    text=__doc__ or "", run=_run_paper, full="all of it; an hour or two", add_options=_add_options
)
