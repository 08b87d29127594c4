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
    store : str
        The file that keeps the finished runs; "" if there is none.
    """

    runs: list[Run]
    store: str

    def __init__(self, runs: Sequence[Run], store: str = "") -> None:
        super().__init__(list(runs), store)
        self.runs = list(runs)
        self.store = store

    def __str__(self) -> str:
        """Say how many runs were finished."""
        finished = sum(not isinstance(run.error, RunUnfinished) for run in self.runs)
        kept = f"{self.store} keeps them" if self.store else ".runs holds them"
        return f"interrupted after {finished} of {len(self.runs)} runs; {kept}"
