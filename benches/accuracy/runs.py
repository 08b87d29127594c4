"""Make the runs that a study lacks, in batches, and store each batch."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from benches.accuracy import ensemble
from benches.accuracy.cells import Cell, Setting
from benches.accuracy.store import Store

# Ctrl-C keeps the finished runs of a batch; a process that is killed loses one batch.
_BATCH = 100


def complete(
    store: Store,
    cells: Sequence[Cell],
    settings: Mapping[str, Setting],
    count: int,
    *,
    threads: int | None,
    tell: Callable[[str], None],
) -> None:
    """Make the first runs of each cell with each setting, except those in the store.

    Parameters
    ----------
    store : Store
        Where finished runs are.
    cells : sequence of Cell
        The cells.
    settings : mapping of str to setting
        Settings of the solver by name.
    count : int
        Runs of a cell with a setting; repeat i has the same draws with every setting.
    threads : int or None
        See `crawler2d.simulate_many`.
    tell : callable
        Takes a line about each cell and setting.

    Raises
    ------
    Interrupted
        On Ctrl-C; the finished runs are in the store.
    """
    for number, cell in enumerate(cells, start=1):
        for name, setting in settings.items():
            finished = store.rows(cell, setting)
            missing = [repeat for repeat in range(count) if repeat not in finished]
            if not missing:
                continue
            plans = ensemble.plans(cell, setting, count, cell.seed)
            for first in range(0, len(missing), _BATCH):
                batch = missing[first : first + _BATCH]
                try:
                    rows = ensemble.simulate(plans, batch, threads)
                except ensemble.Interrupted as stopped:
                    store.add(cell, setting, stopped.rows)
                    raise
                store.add(cell, setting, rows)
            tell(f"{number} of {len(cells)}: {cell.name}, {name}: {len(missing)} runs")
