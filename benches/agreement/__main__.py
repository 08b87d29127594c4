"""Compare crawler2d's own dynamics with rapier's on random robots.

Usage, from the repository root: ``python -m benches.agreement run``,
``study``, and, with pymunk, ``third``, ``one-by-one``, ``ensembles`` and ``pinched``; then
``table``.
"""

import argparse
from collections.abc import Mapping
from pathlib import Path

from benches.agreement import study
from benches.agreement.pairs import RESULTS, parts, read_pairs, run, run_third
from benches.shared.measuring import write_parts
from benches.shared.results import read, table_of
from research.figures import draw_dots

_FILES = ("pairs", "third", "study", "one_by_one", "ensembles", "pinched")
_PAGE = Path(__file__).parents[2] / "docs" / "studies" / "agreement.md"


def main() -> None:
    """Parse the arguments and run."""
    parser = argparse.ArgumentParser(prog="python -m benches.agreement", description=__doc__)
    verbs = parser.add_subparsers(dest="verb", required=True)
    runs = verbs.add_parser("run", help="run the pairs that are missing")
    runs.add_argument("--robots", type=int, default=300)
    cells = verbs.add_parser("study", help="run the cells of the seizure study")
    cells.add_argument("--repeats", type=int, default=8)
    again = verbs.add_parser("one-by-one", help="repeat those of round wheels whose ends differ")
    many = verbs.add_parser("ensembles", help="run cells with unequal ends over many starts")
    many.add_argument("--starts", type=int, default=12)
    edge = verbs.add_parser("pinched", help="run 24 wheels on a knife edge")
    edge.add_argument("--starts", type=int, default=12)
    third = verbs.add_parser("third", help="run those with unequal ends in Chipmunk, too")
    tables = verbs.add_parser("table", help="print the tables, and put them into the page")
    for verb in (runs, cells, again, many, edge, third, tables):
        verb.add_argument(
            "--output", type=Path, default=RESULTS, help="folder; default: %(default)s"
        )
    given = parser.parse_args()
    files = {name: given.output / f"{name}.json.xz" for name in _FILES}
    match given.verb:
        case "run":
            run(given.robots, files["pairs"])
        case "third":
            run_third(files["pairs"], files["third"])
        case "study":
            study.study(given.repeats, files["study"])
        case "one-by-one":
            study.one_by_one(files["study"], files["one_by_one"])
        case "ensembles":
            study.ensembles(given.starts, files["study"], files["ensembles"])
        case "pinched":
            study.pinched(given.starts, files["pinched"])
        case _:
            is_kept = given.output == RESULTS
            write_parts(all_tables(files), _PAGE if is_kept else None)
            if is_kept:
                over = study.study_percentages(study.read_cells(files["study"]))
                draw_dots(over, "runs [%]", _PAGE.with_suffix(".svg"))


def all_tables(files: Mapping[str, Path]) -> dict[str, str]:
    """Return the tables by their names on the page."""
    return {
        **parts(read_pairs(files["pairs"]), read(files["third"], {})),
        "study": table_of(files["study"], study.study_table),
        "one by one": table_of(files["one_by_one"], study.one_by_one_table),
        "ensembles": table_of(files["ensembles"], study.ensembles_table),
        "pinched": table_of(files["pinched"], study.pinched_table),
    }


if __name__ == "__main__":
    main()
