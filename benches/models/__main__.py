"""Run model files over obstacles in other engines, for comparison with crawler2d's predictions.

Usage, from the repository root: ``python -m benches.models predict``, ``run`` or ``table``.
"""

import argparse
import sys
from itertools import product
from pathlib import Path

from benches.models.cases import CASES, STARTS
from benches.models.files import FILES
from benches.models.runs import ENGINES, PREDICTIONS, RESULTS, engine_of, parts, predict, run
from benches.shared.measuring import write_parts
from benches.shared.results import read, write

_PAGE = Path(__file__).parents[2] / "docs" / "engines.md"


def main() -> None:
    """Parse the arguments and run."""
    parser = argparse.ArgumentParser(prog="python -m benches.models", description=__doc__)
    verbs = parser.add_subparsers(dest="verb", required=True)
    predictions = verbs.add_parser(
        "predict", help="search for repairs, and write the predictions down"
    )
    predictions.add_argument("--cases", nargs="+", choices=CASES, default=list(CASES))
    runs = verbs.add_parser("run", help="run; starts that the output has are not repeated")
    runs.add_argument("engine", choices=ENGINES)
    runs.add_argument("--cases", nargs="+", choices=CASES, default=list(CASES))
    runs.add_argument("--files", nargs="+", choices=FILES, default=list(FILES))
    runs.add_argument("--cells", nargs="+", metavar="LABEL", help="default: all")
    runs.add_argument("--starts", type=int, default=STARTS)
    runs.add_argument("--time-step", type=float, help="[s] other than the engine's own here")
    runs.add_argument("--output", type=Path, help="default: benches/models/results")
    runs.add_argument("--jobs", type=int, default=1, help="processes")
    tables = verbs.add_parser("table", help="print the outcomes, and put them into the page")
    tables.add_argument("results", nargs="*", type=Path, help="others: only print these")
    given = parser.parse_args()
    if given.verb == "predict":
        found = read(PREDICTIONS)
        found |= {name: predict(CASES[name], threads=1) for name in given.cases}
        write(PREDICTIONS, found)
    elif given.verb == "run":
        try:
            engine_of(given.engine)
        except ImportError as error:
            sys.stdout.write(f"{given.engine} is left out: {error}\n")
            return
        path = given.output or RESULTS / f"{given.engine}.json.xz"
        for case, file in product(given.cases, given.files):
            if file not in CASES[case].files:
                continue
            run(
                given.engine,
                case,
                file,
                given.cells or CASES[case].cells,
                path,
                starts=given.starts,
                time_step=given.time_step,
                jobs=given.jobs,
            )
    else:
        paths = given.results or [RESULTS / f"{engine}.json.xz" for engine in ENGINES]
        found = parts([path for path in paths if path.exists()])
        write_parts(found, None if given.results else _PAGE)


if __name__ == "__main__":
    main()
