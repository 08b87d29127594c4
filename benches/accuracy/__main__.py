"""Draw cells, run them, write their figures into the page.

Usage, from the repository root: ``python -m benches.accuracy [search | run | report] [--set N]``.
``search`` completes set N of cells, drawn with seed N; ``run`` adds the runs that are missing, and
more where a cell is undecided; ``report`` writes the figures into the page. Without a verb, it
runs and reports. ``--quick`` tries all of it in half a minute. Ctrl-C loses nothing: the same
command continues. The settings file names arguments of `Solver`, the finest last, the
``reference`` among them that all are compared with, and the ``default`` that gets the verdicts.
"""

import argparse
import json
import sys
from pathlib import Path

import crawler2d as c2d
from benches.accuracy import plot, report
from benches.accuracy.cells import KINDS, Cell, path_of, read
from benches.accuracy.findings import CURVE, LOOKS, Study, collect, undecided
from benches.accuracy.runs import Store, complete
from benches.accuracy.search import DRAWS, complete_cells
from benches.shared.measuring import machine, write_parts
from benches.shared.results import progress

_ROOT = Path(__file__).parents[2]
_PAGE = _ROOT / "docs" / "accuracy.md"
_STORE = _ROOT / "out" / "accuracy.sqlite"
_SETTINGS = Path(__file__).with_name("settings.json")

_QUICK_KINDS = ("line of 3 round", "line of 5 gears", "belt (a)")  # which cost little
_QUICK_LOOKS = [6, 12]
_QUICK_SETTINGS = {
    "settings": {
        "2 ms": {"time_step": 2e-3},
        "1 ms": {"time_step": 1e-3},
        "0.5 ms": {"time_step": 5e-4},
    },
    "reference": "0.5 ms",
    "default": "2 ms",
}


def main(arguments: list[str] | None = None) -> None:
    """Parse the arguments, search cells, run them, and write the page."""
    parser = argparse.ArgumentParser(prog="python -m benches.accuracy", description=__doc__)
    parser.add_argument("verb", nargs="?", choices=("search", "run", "report"))
    parser.add_argument(
        "--quick", action="store_true", help="few runs, all files next to the store"
    )
    parser.add_argument("--set", type=int, default=1, help="number of the set of cells")
    parser.add_argument("--rotors", action="store_true", help="search cells of motors with rotors")
    parser.add_argument("--settings", type=Path, default=_SETTINGS, help="settings of the solver")
    parser.add_argument("--looks", type=int, nargs="+", default=list(LOOKS), help="runs of a cell")
    parser.add_argument("--store", type=Path, default=_STORE, help="runs")
    parser.add_argument("--page", type=Path, default=_PAGE, help="the page that is written")
    parser.add_argument("--only", default="", help="only cells with this in their name")
    parser.add_argument("--any-build", action="store_true", help="take runs of other builds, too")
    parser.add_argument("--threads", type=int, default=None)
    given = parser.parse_args(arguments)
    chosen = json.loads(given.settings.read_text(encoding="utf-8"))
    given.cells, kinds = path_of(given.set), tuple(KINDS)
    if given.quick:
        chosen, kinds, given.looks = _QUICK_SETTINGS, _QUICK_KINDS, _QUICK_LOOKS
        folder = given.store.parent
        folder.mkdir(parents=True, exist_ok=True)
        given.cells, given.store, given.page = (
            folder / f"accuracy-quick.{ending}" for ending in ("json", "sqlite", "md")
        )
    vars(given).update(chosen)
    for role in (given.reference, given.default):
        if role not in given.settings:
            parser.error(f"no setting {role}; settings: {', '.join(given.settings)}")
    if given.verb == "search" or (given.verb is None and given.quick):
        kinds = tuple(name for name in kinds if given.only in name)
        without = complete_cells(given.cells, given.set, kinds, given.threads, rotors=given.rotors)
        for name in without:
            progress(f"{name}: no height found in {DRAWS} draws")
    if given.verb == "search":
        return
    with Store(given.store, any_build=given.any_build) as store:
        if given.verb in ("run", None):
            _run(given, store)
        if given.verb in ("report", None):
            study, here = _study(given, store), machine({"crawler2d": c2d.__version__})
            folder, parts = given.page.with_suffix(""), report.render(study, here)
            plot.plot(study, folder)
            cells = report.table_of_cells(study)
            (folder / "cells.csv").write_text(cells, encoding="utf-8", newline="\n")
            has_marks = given.page.exists() and not given.quick
            write_parts(
                parts,
                page=given.page if has_marks else None,
                report=None if has_marks else given.page,
            )


def _run(given: argparse.Namespace, store: Store) -> None:
    """Add runs: those of the verdicts, those of the curve, and more of undecided cells."""
    pair = {name: given.settings[name] for name in (given.default, given.reference)}
    complete(store, _cells(given), pair, given.looks[0], given.threads)
    complete(store, _cells(given), given.settings, min(CURVE, given.looks[0]), given.threads)
    for count in given.looks[1:]:
        complete(store, undecided(_study(given, store)), pair, count, given.threads)


def _cells(given: argparse.Namespace) -> list[Cell]:
    return [cell for cell in read(given.cells) if given.only in cell.name]


def _study(given: argparse.Namespace, store: Store) -> Study:
    return Study(
        number=given.set,
        findings=collect(store, _cells(given), given.settings, given.reference),
        settings=given.settings,
        reference=given.reference,
        default=given.default,
        looks=tuple(given.looks),
        builds=store.builds(),
    )


if __name__ == "__main__":
    try:
        main()
    except KeyboardInterrupt:
        sys.exit("interrupted; the same command continues from here")
