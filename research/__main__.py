"""The project's own studies: the seizure study, others beside it, and the paper reproduced."""

from __future__ import annotations

import sys
from collections.abc import Sequence

from crawler2d.__main__ import Command, run_command
from research import study
from research.paper import chart
from research.paper import command as paper

__all__ = ["main"]


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a study; returns its exit status."""
    commands = {
        **{
            name: Command(text, study.add_arguments, run)
            for name, (text, run) in study.STUDIES.items()
        },
        "paper": Command(paper.__doc__, paper.add_arguments, paper.run),
        "chart": Command(chart.__doc__, chart.add_arguments, chart.run),
    }
    return run_command("python -m research", __doc__, commands, arguments)


if __name__ == "__main__":
    sys.exit(main())
