"""The project's own studies, and the paper that introduced gear wheels, reproduced."""

import sys
from collections.abc import Sequence

from crawler2d.__main__ import run_command
from research import drive, seizure, steps
from research.paper import chart
from research.paper import command as paper


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a study; returns its exit status."""
    studies = {
        "seizure": seizure.SEIZURE,
        "stops": seizure.STOPS,
        "chains": steps.CHAINS,
        "chain-steps": steps.CHAIN_STEPS,
        "flippers": steps.FLIPPERS,
        "drive": drive.DRIVE,
        "paper": paper.PAPER,
        "chart": chart.CHART,
    }
    commands = {name: study.command() for name, study in studies.items()}
    return run_command("python -m research", __doc__, commands, arguments)


if __name__ == "__main__":
    sys.exit(main())
