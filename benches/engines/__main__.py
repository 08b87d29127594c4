"""Compare crawler2d with other physics engines on the same scenarios.

Usage, from the repository root: ``python -m benches.engines scan``, ``predict``, ``run``, ``costs``
or ``table``.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from benches.engines import costs
from benches.engines.cells import STARTS, read, write
from benches.engines.engines import ENGINES
from benches.engines.predict import predict
from benches.engines.running import RESULTS, run
from benches.engines.scan import scanned
from benches.engines.table import parts
from benches.engines.telling import tell
from crawler2d.reports.markdown import spliced

_PAGE = Path(__file__).parents[2] / "docs" / "engines.md"
_EVERY, _FEW = 6, 2  # cells and starts of a quick look
_QUICK = tuple(name for name in ENGINES if name != "dart-fine")


def main() -> None:
    """Parse the arguments and run."""
    parser = argparse.ArgumentParser(prog="python -m benches.engines", description=__doc__)
    verbs = parser.add_subparsers(dest="verb", required=True)
    verbs.add_parser("scan", help="find the cells; predictions and results are void then")
    verbs.add_parser("predict", help="write down what crawler2d says; results are void then")
    runs = verbs.add_parser("run", help="run the engines, where they stopped the last time")
    runs.add_argument("engines", nargs="*", choices=[[], *ENGINES], help="default: all")
    runs.add_argument("--starts", type=int, default=STARTS, help="runs of each cell")
    runs.add_argument("--group", choices=("plane", "space", "paper"), help="default: all cells")
    runs.add_argument("--every", type=int, default=1, help="take each n-th cell only")
    runs.add_argument("--quick", action="store_true", help="some cells and starts, ten minutes")
    sitting = verbs.add_parser("costs", help="time a simulated second in each engine")
    tables = verbs.add_parser("table", help="write the tables into docs/engines.md")
    for verb in (runs, sitting, tables):
        verb.add_argument("--output", type=Path, default=RESULTS, help="folder of the results")
    given = parser.parse_args()
    match given.verb:
        case "scan":
            cells = []
            for cell, rate in scanned():
                cells.append(cell)
                tell(f"{rate:.2f} {cell.label}")
            write(cells)
        case "predict":
            predict(read())
        case "run":
            _run(given)
        case "costs":
            costs.measure(given.output)
        case _:
            _tell(given.output)


def _run(given: argparse.Namespace) -> None:
    cells = [cell for cell in read() if given.group in (None, cell.group)]
    every, starts, engines = given.every, given.starts, given.engines or ENGINES
    if given.quick:
        every, starts, engines = _EVERY, _FEW, given.engines or _QUICK
    for name in engines:
        try:
            run(name, cells[::every], starts, given.output)
        except ValueError as error:
            sys.exit(f"{name}: {error}")


def _tell(folder: Path) -> None:
    found = parts(read(), folder)
    for name, text in found.items():
        sys.stdout.write(f"{name}:\n\n{text}\n\n")
    if folder == RESULTS:
        page = spliced(_PAGE.read_text(encoding="utf-8"), found)
        _PAGE.write_text(page, encoding="utf-8")


if __name__ == "__main__":
    main()
