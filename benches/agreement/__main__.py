"""Compare crawler2d's own dynamics with rapier's on random robots.

Usage, from the repository root: ``python -m benches.agreement run``,
``study``, and, with pymunk, ``third``, ``one-by-one`` and ``pinched``; then ``table``.
"""

from __future__ import annotations

import argparse
from pathlib import Path

from benches.agreement.one_by_one import one_by_one, one_by_one_table
from benches.agreement.pairs import RESULTS, read, run
from benches.agreement.pinched import pinched, pinched_table
from benches.agreement.study import study, study_table
from benches.agreement.table import parts
from benches.agreement.third import ask, read_third
from benches.engines.telling import tell
from crawler2d.reports.markdown import spliced

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
    edge = verbs.add_parser("pinched", help="make the runs of 24 wheels on a knife edge")
    edge.add_argument("--starts", type=int, default=12)
    third = verbs.add_parser("third", help="make those that end unlike in Chipmunk, too")
    tables = verbs.add_parser("table", help="print the tables, and put them into the page")
    for verb in (runs, third, tables):
        verb.add_argument("--output", type=Path, default=RESULTS, help="default: %(default)s")
    given = parser.parse_args()
    if given.verb == "run":
        run(given.robots, given.output)
        return
    if given.verb == "third":
        ask(read(given.output))
        return
    if given.verb == "one-by-one":
        one_by_one()
        return
    if given.verb == "pinched":
        pinched(given.starts)
        return
    if given.verb == "study":
        study(given.repeats)
        return
    made = {**parts(read(given.output), read_third()), "study": study_table()}
    made.update({"one by one": one_by_one_table(), "pinched": pinched_table()})
    tell("\n\n".join(made.values()))
    if given.output == RESULTS:
        page = _PAGE.read_text(encoding="utf-8")
        _PAGE.write_text(spliced(page, made), encoding="utf-8", newline="\n")


if __name__ == "__main__":
    main()
