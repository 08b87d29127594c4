"""What Ctrl-C leaves of a batch."""

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
        One a scenario, in order. Where a run was not finished, its `error` is a `RunUnfinished`.
    """

    runs: list[Run]

    def __init__(self, runs: Sequence[Run]) -> None:
        super().__init__(list(runs))
        self.runs = list(runs)

    def __str__(self) -> str:
        """Say how far the batch came."""
        finished = sum(not isinstance(run.error, RunUnfinished) for run in self.runs)
        return f"interrupted after {finished} of {len(self.runs)} runs; .runs keeps them"
