"""Run the study; it writes progress to stderr, the report to `out/`, and its page and figures.

Usage, from the repository root: ``python -m benches.scaling [--quick | --render]``.
"""

import argparse
import json
from pathlib import Path

from benches.scaling import plot, report
from benches.scaling.measure import run
from benches.shared.measuring import write_parts

_ROOT = Path(__file__).parents[2]
_PAGE = _ROOT / "docs" / "studies" / "scaling.md"


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
    page = None if arguments.quick else _PAGE
    result = json.loads(path.read_text(encoding="utf-8"))
    plot.plot(result, (page or path).with_suffix(""))
    write_parts(report.render(result), page, path.with_suffix(".md"))


if __name__ == "__main__":
    main()
