"""The runs that a batch had finished at Ctrl-C."""

from __future__ import annotations

from typing import TYPE_CHECKING

from crawler2d.errors import RunUnfinished

if TYPE_CHECKING:
    from collections.abc import Sequence

    from crawler2d.runs.run import Run

__all__ = ["BatchInterrupted"]


class BatchInterrupted(KeyboardInterrupt):
    """Ctrl-C ended a batch early.

    Parameters
    ----------
    runs : sequence of Run
        One per scenario, in order. An unfinished run has a `RunUnfinished` as its `error`.
    """

    runs: list[Run]

    def __init__(self, runs: Sequence[Run]) -> None:
        super().__init__(list(runs))
        self.runs = list(runs)

    def __str__(self) -> str:
        """Say how many runs were finished."""
        finished = sum(not isinstance(run.error, RunUnfinished) for run in self.runs)
        return f"interrupted after {finished} of {len(self.runs)} runs; .runs holds them"
