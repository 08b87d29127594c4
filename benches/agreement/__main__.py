"""Compare crawler2d's own dynamics with rapier's on random robots.

Usage, from the repository root: ``python -m benches.agreement run``,
``study``, and, with pymunk, ``third``, ``one-by-one``, ``ensembles`` and ``pinched``; then
``table``.
"""

from __future__ import annotations

import argparse
from pathlib import Path

from benches.agreement.ensembles import ensembles, ensembles_table
from benches.agreement.one_by_one import one_by_one, one_by_one_table
from benches.agreement.pairs import RESULTS, read, run
from benches.agreement.pinched import pinched, pinched_table
from benches.agreement.study import study, study_shares, study_table
from benches.agreement.table import parts
from benches.agreement.third import ask, read_third
from benches.engines.telling import tell
from benches.peers import dots
from research.markdown import spliced

_PAGE = Path(__file__).parents[2] / "docs" / "studies" / "agreement.md"


def main() -> None:
    """Parse the arguments and run."""
    parser = argparse.ArgumentParser(prog="python -m benches.agreement", description=__doc__)
    verbs = parser.add_subparsers(dest="verb", required=True)
    runs = verbs.add_parser("run", help="make the pairs, on from where it stopped")
    runs.add_argument("--robots", type=int, default=300)
    cells = verbs.add_parser("study", help="make the cells of the seizure study")
    cells.add_argument("--repeats", type=int, default=8)
    verbs.add_parser("one-by-one", help="make the study's that end unlike on round wheels again")
    many = verbs.add_parser("ensembles", help="make cells that end unlike over many starts")
    many.add_argument("--starts", type=int, default=24)
    edge = verbs.add_parser("pinched", help="make the runs of 24 wheels on a knife edge")
    edge.add_argument("--starts", type=int, default=12)
    third = verbs.add_parser("third", help="make those that end unlike in Chipmunk, too")
    tables = verbs.add_parser("table", help="print the tables, and put them into the page")
    for verb in (runs, third, tables):
        verb.add_argument("--output", type=Path, default=RESULTS, help="default: %(default)s")
    given = parser.parse_args()
    match given.verb:
        case "run":
            run(given.robots, given.output)
        case "third":
            ask(read(given.output))
        case "study":
            study(given.repeats)
        case "one-by-one":
            one_by_one()
        case "ensembles":
            ensembles(given.starts)
        case "pinched":
            pinched(given.starts)
        case _:
            _tell_tables(given.output)


def _tell_tables(output: Path) -> None:
    made = {**parts(read(output), read_third()), "study": study_table()}
    made.update({"one by one": one_by_one_table(), "ensembles": ensembles_table()})
    made["pinched"] = pinched_table()
    tell("\n\n".join(made.values()))
    if output == RESULTS:
        page = _PAGE.read_text(encoding="utf-8")
        _PAGE.write_text(spliced(page, made), encoding="utf-8", newline="\n")
        dots.draw(study_shares(), "runs [%]", _PAGE.with_suffix(".svg"))


if __name__ == "__main__":
    main()
