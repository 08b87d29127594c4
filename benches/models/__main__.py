"""Drive files of models over obstacles in other engines, beside what crawler2d predicted.

Usage, from the repository root: ``python -m benches.models predict | run | table``.
"""

from __future__ import annotations

import argparse
import json
import sys

from benches.models.cases import CASES
from benches.models.predict import PREDICTIONS, predicted


def main() -> None:
    """Parse the arguments and run."""
    parser = argparse.ArgumentParser(prog="python -m benches.models", description=__doc__)
    verbs = parser.add_subparsers(dest="verb", required=True)
    verbs.add_parser("predict", help="search for repairs, and write the predictions down")
    parser.parse_args()
    found = {name: predicted(case, threads=1) for name, case in CASES.items()}
    PREDICTIONS.write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")
    sys.stdout.write(f"{PREDICTIONS}\n")


if __name__ == "__main__":
    main()
