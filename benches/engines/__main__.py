"""Compare crawler2d with other physics engines on the same scenarios.

Usage, from the repository root: ``python -m benches.engines scan``, ``predict``, ``run``,
``converge``, ``refine``, ``speeds``, ``yaw``, ``costs`` or ``table``.
"""

from __future__ import annotations

import argparse
import sys
from concurrent.futures.process import BrokenProcessPool
from pathlib import Path

from benches.engines import costs, yaw
from benches.engines.cells import STARTS, Cell, read, write
from benches.engines.convergence import FINER, JAM, LADDERS, USUAL, converge
from benches.engines.engines import ENGINES, FINE
from benches.engines.momentum import speed_up
from benches.engines.predict import PREDICTIONS, predict, unlike
from benches.engines.refining import refine
from benches.engines.running import RESULTS, processes, run
from benches.engines.scan import scanned
from benches.engines.table import agreeing, parts
from benches.engines.telling import tell
from benches.peers import dots
from research.markdown import spliced

_PAGE = Path(__file__).parents[2] / "docs" / "engines.md"
_QUICK = Path("out") / "engines"  # a look, from nothing
_EVERY, _FEW = 6, 2  # cells and starts of it
_SLOW = "dart-fine"


def main() -> None:
    """Parse the arguments and run."""
    parser = argparse.ArgumentParser(prog="python -m benches.engines", description=__doc__)
    verbs = parser.add_subparsers(dest="verb", required=True)
    verbs.add_parser("scan", help="find the cells; predictions and results are void then")
    says = verbs.add_parser("predict", help="write down what crawler2d says; results are void then")
    says.add_argument("--output", type=Path, help="into this file, beside those that are kept")
    runs = verbs.add_parser("run", help="run the engines, where they stopped the last time")
    engines = ", ".join(ENGINES)
    runs.add_argument("--engines", nargs="+", choices=ENGINES, metavar="ENGINE", help=engines)
    runs.add_argument(
        "--starts", type=int, choices=range(1, STARTS + 1), metavar="N", help="runs of each cell"
    )
    runs.add_argument("--only", default="", metavar="TEXT", help="cells with this in their label")
    finer = verbs.add_parser("converge", help="make some runs at finer and finer settings")
    finer.add_argument("engine", choices=LADDERS)
    finer.add_argument("--jam", action="store_true", help="Chipmunk's smallest steps")
    finer.add_argument("--starts", type=int, default=6, help="runs of each cell")
    again = verbs.add_parser("refine", help="make runs that differ again, finer in both")
    again.add_argument("--engines", nargs="+", choices=FINE, default=list(FINE))
    again.add_argument("--most", type=int, default=3, help="runs of a cell")
    faster = verbs.add_parser("speeds", help="from which speed on is a robot carried past a stop?")
    faster.add_argument("--engines", nargs="+", choices=ENGINES, default=["pymunk", "ode-fine"])
    faster.add_argument("--starts", type=int, default=3, help="runs of each cell")
    askew = verbs.add_parser("yaw", help="do jams hold before edges that are not square to them?")
    sitting = verbs.add_parser("costs", help="time a simulated second in each engine")
    tables = verbs.add_parser("table", help="print the tables, and put them into the page")
    for verb in (runs, finer, again, faster, askew, sitting, tables):
        verb.add_argument("--output", type=Path, help=f"default: {RESULTS.name} beside this file")
    for verb in (runs, tables):
        verb.add_argument("--quick", action="store_true", help=f"a look, kept in {_QUICK}")
    given = parser.parse_args()
    match given.verb:
        case "scan":
            _scan()
        case "predict":
            _predict(given.output)
        case "run":
            _run(given)
        case "converge":
            _converge(given)
        case "refine":
            refine(read(), given.engines, given.output or RESULTS, given.most)
        case "speeds":
            speed_up(_jams()[0], given.engines, given.starts, given.output or RESULTS)
        case "yaw":
            yaw.turn(given.output or RESULTS)
        case "costs":
            costs.measure(given.output or RESULTS)
        case _:
            _tables(given.output or (_QUICK if given.quick else RESULTS))


def _scan() -> None:
    cells = []
    for cell, rate in scanned():
        cells.append(cell)
        tell(f"{rate:.2f} {cell.label}")
    write(cells)


def _predict(path: Path | None) -> None:
    predict(read(), path or PREDICTIONS)
    if path is not None:
        tell(unlike(path))


def _run(given: argparse.Namespace) -> None:
    cells = [cell for cell in read() if given.only in cell.label]
    engines, starts = given.engines or list(ENGINES), given.starts
    if given.quick:
        cells, starts = cells[::_EVERY], starts or _FEW
        engines = given.engines or [name for name in ENGINES if name != _SLOW]
    folder = given.output or (_QUICK if given.quick else RESULTS)
    try:
        with processes() as executor:
            for name in engines:
                run(name, cells, starts or ENGINES[name].starts, executor, folder)
    except ValueError as error:
        sys.exit(f"{name}: {error}")
    except (KeyboardInterrupt, BrokenProcessPool):  # one of them comes first after Ctrl-C
        sys.exit(f"interrupted: {folder} has the runs so far, and the same command goes on")


def _converge(given: argparse.Namespace) -> None:
    folder = given.output or RESULTS
    ladders, cells, file = (FINER, _jams(), JAM) if given.jam else (LADDERS, _told(), USUAL)
    if given.engine not in ladders:
        sys.exit(f"--jam: must be with {', '.join(ladders)}")
    converge(ladders[given.engine](), given.engine, cells, given.starts, folder / file)


def _told() -> list[Cell]:
    """Return undecided cells of three models, which are refined."""
    cells, found = read(), []
    for model in ("line of 3", "line of 5", "5 gears"):
        found.append(
            next(
                cell
                for cell in cells
                if cell.model == model and cell.drive == "60 N m, servos" and cell.ground == "step"
            )
        )
    return found


def _jams() -> list[Cell]:
    """Return cells of many small wheels: one whose runs seize, one whose first run clears."""
    wheels = [cell for cell in read() if cell.model == "24 all round" and cell.ground == "step"]
    strong = next(cell for cell in wheels if cell.group == "paper")
    weak = next(cell for cell in wheels if cell.drive == "60 N m, servos")
    return [strong, weak]


def _tables(folder: Path) -> None:
    found = parts(read(), folder)
    for name, text in found.items():
        sys.stdout.write(f"{name}:\n\n{text}\n\n")
    if folder == RESULTS:
        page = spliced(_PAGE.read_text(encoding="utf-8"), found)
        _PAGE.write_text(page, encoding="utf-8")
        dots.draw(
            agreeing(read(), folder), "runs that end as predicted [%]", _PAGE.with_suffix(".svg")
        )


if __name__ == "__main__":
    main()
