"""Run the study; it writes progress to stderr, the report to `out/`, and its page and figures.

Usage, from the repository root: ``python -m benches.scaling [--quick | --render]``.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from pathlib import Path
from typing import Any

import crawler2d as c2d
from benches.peers import machine
from benches.peers.timing import progress
from benches.scaling import plot, report, scenes
from benches.scaling.cost import measure
from benches.scaling.threads import threads
from research.markdown import spliced

_ROOT = Path(__file__).parents[2]
_PAGE = _ROOT / "docs" / "studies" / "scaling.md"
_ROUNDS = 15
# One round of the points takes most of a minute.
_ROUNDS_OF_POINTS = 4
_QUICK_PIECES = 1_000


def main() -> None:
    """Parse the arguments and run."""
    parser = argparse.ArgumentParser(prog="python -m benches.scaling", description=__doc__)
    kinds = parser.add_mutually_exclusive_group()
    kinds.add_argument("--quick", action="store_true", help="one short round, written to out/ only")
    kinds.add_argument("--render", action="store_true", help="only rewrite the page and figures")
    arguments = parser.parse_args()
    name = "scaling-quick" if arguments.quick else "scaling"
    path = _ROOT / "out" / f"{name}.json"
    if not arguments.render:
        path.parent.mkdir(exist_ok=True)
        measured = run(quick=arguments.quick)
        path.write_text(json.dumps(measured, indent=1) + "\n", encoding="utf-8")
    result = json.loads(path.read_text(encoding="utf-8"))
    text = report.render(result)
    path.with_suffix(".md").write_text(text, encoding="utf-8", newline="\n")
    plot.plot(result, (path if arguments.quick else _PAGE).with_suffix(""))
    if not arguments.quick:
        page = spliced(_PAGE.read_text(encoding="utf-8"), report.parts(result))
        _PAGE.write_text(page, encoding="utf-8", newline="\n")
    sys.stdout.write(text)


def run(*, quick: bool) -> dict[str, Any]:
    """Measure everything, panel by panel."""
    start, build = time.perf_counter(), c2d.build_info()["build_id"]
    found = machine.describe({"crawler2d": f"{c2d.__version__}, build {build}"})
    rows: list[dict[str, Any]] = []
    points = list(scenes.points())
    if quick:
        points = [point for point in points if point.x <= _QUICK_PIECES]
    for (figure, panel), own in scenes.panels(points).items():
        progress(f"{figure}: {panel}")
        rounds = _ROUNDS_OF_POINTS if figure == "points" else _ROUNDS
        rows += measure(own, 1 if quick else rounds)
    progress("threads")
    spread = threads(*((8, 4, 1) if quick else (64, 16, _ROUNDS)))
    wall = time.perf_counter() - start
    return {"machine": found, "wall": wall, "rows": rows, "threads": spread}


if __name__ == "__main__":
    main()
