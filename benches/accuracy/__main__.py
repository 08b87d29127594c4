"""Draw cells, make their runs, write their figures into the page.

Usage, from the repository root: ``python -m benches.accuracy [search | run | report] [--set N]``.
``search`` completes set N of cells, drawn with seed N; ``run`` makes the runs that are missing, and
more where a cell is undecided; ``report`` writes the figures into the page. Without a verb, it runs
and reports. ``--quick`` tries all of it in half a minute. Ctrl-C loses nothing: the same command
goes on where it ended. The settings file names arguments of `Solver`, the finest last, the
``reference`` among them that all are compared with, and the ``default`` that is judged.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import crawler2d as c2d
from benches.accuracy import plot, report, runs, search
from benches.accuracy.cells import Cell, Setting, path_of, read
from benches.accuracy.findings import Study, collect
from benches.accuracy.kinds import KINDS
from benches.accuracy.statistics import CURVE, LOOKS
from benches.accuracy.store import Store
from benches.accuracy.verdicts import undecided
from benches.peers import machine
from benches.peers.timing import progress
from research.markdown import spliced

_ROOT = Path(__file__).parents[2]
_PAGE = _ROOT / "docs" / "accuracy.md"
_STORE = _ROOT / "out" / "accuracy.sqlite"
_SETTINGS = Path(__file__).with_name("settings.json")

# Of the quick try: kinds that cost little, and their runs.
_QUICK_KINDS = ("line of 3 round", "line of 5 gears", "belt (a)")
_QUICK_LOOKS = (6, 12)
_QUICK_FINE: Setting = {"time_step": 0.5e-3}
_QUICK_DEFAULT: Setting = {"time_step": 2e-3}


@dataclass(frozen=True, kw_only=True)
class Job:
    """What is to be done with which cells, settings and files."""

    cells: Path
    seed: int
    kinds: tuple[str, ...]
    settings: dict[str, Setting]
    reference: str
    default: str
    looks: tuple[int, ...]
    store: Path
    page: Path
    only: str
    any_build: bool
    threads: int | None

    def search(self) -> None:
        """Complete the set of cells."""
        kinds = [name for name in self.kinds if self.only in name]
        without = search.complete(self.cells, self.seed, kinds, self.threads, progress)
        for name in without:
            progress(f"{name}: no height found in {search.DRAWS} draws")

    def run(self) -> None:
        """Make the runs that judge, more where they are needed, and those that draw the curve."""
        cells = self._cells()
        with Store(self.store, any_build=self.any_build) as store:
            pair = {name: self.settings[name] for name in (self.default, self.reference)}
            self._complete(store, cells, pair, self.looks[0])
            self._complete(store, cells, self.settings, min(CURVE, self.looks[0]))
            for count in self.looks[1:]:
                self._complete(store, undecided(self._study(store)), pair, count)

    def report(self) -> None:
        """Write the parts of the page, the figures and the table of cells from the store."""
        with Store(self.store, any_build=self.any_build) as store:
            study = self._study(store)
        parts = report.render(study, machine.describe({"crawler2d": c2d.__version__}))
        if self.page.exists():
            page = self.page.read_text(encoding="utf-8")
        else:
            page = "\n\n".join(f"<!-- {name} -->\n<!-- end of {name} -->" for name in parts) + "\n"
        text, folder = spliced(page, parts), self.page.with_suffix("")
        plot.plot(study, folder)
        for path, written in {
            self.page: text,
            folder / "cells.csv": report.table_of_cells(study),
        }.items():
            path.write_text(written, encoding="utf-8", newline="\n")
        sys.stdout.write(text)

    def _cells(self) -> list[Cell]:
        return [cell for cell in read(self.cells) if self.only in cell.name]

    def _study(self, store: Store) -> Study:
        return Study(
            number=self.seed,
            findings=collect(store, self._cells(), self.settings, self.reference),
            settings=self.settings,
            reference=self.reference,
            default=self.default,
            looks=self.looks,
            builds=store.builds(),
        )

    def _complete(
        self, store: Store, cells: list[Cell], settings: dict[str, Setting], count: int
    ) -> None:
        runs.complete(store, cells, settings, count, threads=self.threads, tell=progress)


def main(arguments: list[str] | None = None) -> None:
    """Parse the arguments and do the job."""
    parser = argparse.ArgumentParser(prog="python -m benches.accuracy", description=__doc__)
    parser.add_argument("verb", nargs="?", choices=("search", "run", "report"))
    parser.add_argument(
        "--quick", action="store_true", help="a few runs, all files beside the store"
    )
    parser.add_argument("--set", type=int, default=1, help="number of the set of cells")
    parser.add_argument("--settings", type=Path, default=_SETTINGS, help="settings of the solver")
    parser.add_argument("--looks", type=int, nargs="+", default=list(LOOKS), help="runs of a cell")
    parser.add_argument("--store", type=Path, default=_STORE, help="runs")
    parser.add_argument("--page", type=Path, default=_PAGE, help="the page that is written")
    parser.add_argument("--only", default="", help="only cells with this in their name")
    parser.add_argument("--any-build", action="store_true", help="take runs of other builds, too")
    parser.add_argument("--threads", type=int, default=None)
    asked = parser.parse_args(arguments)
    chosen: dict[str, Any] = json.loads(asked.settings.read_text(encoding="utf-8"))
    for role in ("reference", "default"):
        if chosen[role] not in chosen["settings"]:
            names = ", ".join(chosen["settings"])
            parser.error(f"{role} must be one of the settings: {names}, got {chosen[role]}")
    job = Job(
        cells=path_of(asked.set),
        seed=asked.set,
        kinds=tuple(KINDS),
        settings=chosen["settings"],
        reference=chosen["reference"],
        default=chosen["default"],
        looks=tuple(asked.looks),
        store=asked.store,
        page=asked.page,
        only=asked.only,
        any_build=asked.any_build,
        threads=asked.threads,
    )
    if asked.quick:
        job = _quick(job, asked.store.parent)
    steps: dict[str | None, list[Callable[[], None]]] = {
        "search": [job.search],
        "run": [job.run],
        "report": [job.report],
        None: [job.search, job.run, job.report] if asked.quick else [job.run, job.report],
    }
    for step in steps[asked.verb]:
        step()


def _quick(job: Job, folder: Path) -> Job:
    """Make a job that tries everything on a few cells, with all files in a folder."""
    folder.mkdir(parents=True, exist_ok=True)
    return replace(
        job,
        cells=folder / "accuracy-quick.json",
        kinds=_QUICK_KINDS,
        settings={"2 ms": _QUICK_DEFAULT, "1 ms": {"time_step": 1e-3}, "0.5 ms": _QUICK_FINE},
        reference="0.5 ms",
        default="2 ms",
        looks=_QUICK_LOOKS,
        store=folder / "accuracy-quick.sqlite",
        page=folder / "accuracy-quick.md",
    )


if __name__ == "__main__":
    try:
        main()
    except KeyboardInterrupt:
        sys.exit("interrupted; the same command goes on from here")
