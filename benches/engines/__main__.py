"""Compare crawler2d with other physics engines on the same scenarios.

Usage, from the repository root: ``python -m benches.engines scan``, ``predict``, ``run``,
``converge``, ``refine``, ``speeds``, ``yaw``, ``costs`` or ``table``.
"""

import argparse
import sys
from concurrent.futures.process import BrokenProcessPool
from pathlib import Path

from benches.engines import runs, yaw
from benches.engines.cells import STARTS, Cell, find_cells, read_cells, write_cells
from benches.engines.runs import ENGINES, FINE, FINER, LADDERS, PREDICTIONS, RESULTS
from benches.engines.table import agreeing, parts
from benches.shared.measuring import write_parts
from benches.shared.results import processes, progress
from research.figures import draw_dots

_PAGE = Path(__file__).parents[2] / "docs" / "engines.md"
_QUICK = Path("out") / "engines"  # a quick run, without earlier results
_EVERY, _FEW = 6, 2  # cells and starts of it
_SLOW = "dart-fine"


def main() -> None:
    """Parse the arguments and run."""
    given = _parser().parse_args()
    folder = given.output or (_QUICK if getattr(given, "quick", False) else RESULTS)
    match given.verb:
        case "scan":
            cells = []
            for cell, rate in find_cells():
                cells.append(cell)
                progress(f"{rate:.2f} {cell.label}")
            write_cells(cells)
        case "predict":
            runs.predict(read_cells(), given.output or PREDICTIONS)
            if given.output is not None:
                sys.stdout.write(runs.compare_predictions(given.output) + "\n")
        case "run":
            _run(given, folder)
        case "converge":
            if given.jam and given.engine not in FINER:
                sys.exit(
                    f"--jam needs one of these engines: {', '.join(FINER)}; got {given.engine}"
                )
            file = folder / ("jam.json.xz" if given.jam else "convergence.json.xz")
            cells = _jams() if given.jam else _undecided()
            runs.converge(given.engine, cells, given.starts, file, is_jam=given.jam)
        case "refine":
            runs.refine(read_cells(), given.engines, folder, given.most)
        case "speeds":
            runs.accelerate(_jams()[0], given.engines, given.starts, folder / "momentum.json.xz")
        case "yaw":
            yaw.turn(folder / "yaw.json.xz")
        case "costs":
            runs.time_engines(folder / "costs.json.xz")
        case _:
            _write(folder)


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python -m benches.engines", description=__doc__)
    parser.set_defaults(output=None)
    verbs = parser.add_subparsers(dest="verb", required=True)
    verbs.add_parser("scan", help="find the cells; predictions and results are void then")
    says = verbs.add_parser("predict", help="write down what crawler2d says; results are void then")
    says.add_argument("--output", type=Path, help="into this file, to compare with the kept one")
    several = verbs.add_parser("run", help="run the engines, where they stopped the last time")
    names, count = ", ".join(ENGINES), range(1, STARTS + 1)
    several.add_argument("--engines", nargs="+", choices=ENGINES, metavar="ENGINE", help=names)
    several.add_argument("--starts", type=int, choices=count, metavar="N", help="runs of each cell")
    several.add_argument(
        "--only", default="", metavar="TEXT", help="cells with this in their label"
    )
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
    costs = verbs.add_parser("costs", help="time a simulated second in each engine")
    tables = verbs.add_parser("table", help="print the tables, and put them into the page")
    for verb in (several, finer, again, faster, askew, costs, tables):
        verb.add_argument("--output", type=Path, help=f"default: {RESULTS.name} in this folder")
    for verb in (several, tables):
        verb.add_argument("--quick", action="store_true", help=f"a look, kept in {_QUICK}")
    return parser


def _run(given: argparse.Namespace, folder: Path) -> None:
    cells = [cell for cell in read_cells() if given.only in cell.label]
    engines, starts = given.engines or list(ENGINES), given.starts
    if given.quick:
        cells, starts = cells[::_EVERY], starts or _FEW
        engines = given.engines or [name for name in ENGINES if name != _SLOW]
    try:
        with processes() as executor:
            for name in engines:
                runs.run(name, cells, starts or ENGINES[name].starts, executor, folder)
    except ValueError as error:
        sys.exit(f"{name}: {error}")
    except (KeyboardInterrupt, BrokenProcessPool):  # one of them comes first after Ctrl-C
        sys.exit(f"interrupted: {folder} has the runs so far, and the same command continues")


def _write(folder: Path) -> None:
    cells, is_kept = read_cells(), folder == RESULTS
    write_parts(parts(cells, folder), _PAGE if is_kept else None)
    if is_kept:
        same = agreeing(cells, folder)
        draw_dots(same, "runs that end as predicted [%]", _PAGE.with_suffix(".svg"))


def _undecided() -> list[Cell]:
    """Return undecided cells of three models, which are refined."""
    steps = [cell for cell in read_cells() if (cell.drive, cell.ground) == _SERVOS]
    return [
        next(cell for cell in steps if cell.model == model)
        for model in ("line of 3", "line of 5", "5 gears")
    ]


_SERVOS = "60 N m, servos", "step"


def _jams() -> list[Cell]:
    """Return cells of many small wheels: one whose runs seize, one whose first run clears."""
    wheels = [
        cell for cell in read_cells() if (cell.model, cell.ground) == ("24 all round", "step")
    ]
    strong = next(cell for cell in wheels if cell.group == "paper")
    return [strong, next(cell for cell in wheels if cell.drive == _SERVOS[0])]


if __name__ == "__main__":
    main()
