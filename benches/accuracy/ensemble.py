"""The runs of a cell: the draws of `crawler2d.sweep`, the same for every setting of the solver."""

from __future__ import annotations

import time
from collections.abc import Sequence
from typing import NamedTuple

from benches.accuracy.cells import Cell, Setting
from crawler2d._core import Passed
from crawler2d.errors import ScenarioError
from crawler2d.results.record import Row as SweepRow
from crawler2d.runs.progress import thread_count
from crawler2d.sweeps.collect import Collector, RowsInterrupted
from crawler2d.sweeps.plan import Planner, plan_runs
from crawler2d.variation.draws import Variation

FAILED = "failed"
"""Outcome of a run without a result; its figures are 0."""


class Row(NamedTuple):
    """What is kept of a run."""

    repeat: int
    outcome: str
    x: float
    """[m] Final position and angle of the chassis."""
    y: float
    angle: float
    time: float
    """[s] Simulated time."""
    solves: float
    processor: float
    """[s] Processor time."""


_FAILED = Row(0, FAILED, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


class Interrupted(KeyboardInterrupt):
    """Ctrl-C; `rows` are those of the runs that were finished."""

    def __init__(self, rows: list[Row]) -> None:
        super().__init__()
        self.rows = rows


def plans(cell: Cell, setting: Setting, count: int, seed: int) -> list[Passed]:
    """Draw the first runs of a cell, as a sweep would."""
    base = cell.scenario(setting)
    planner = Planner(Variation.of(base, None, ()), Variation({}), seed)
    (plan,) = plan_runs(base, (), planner, repeats=count)
    for each in plan.checked:
        if isinstance(each, ScenarioError):
            raise each
    return [each for each in plan.checked if isinstance(each, Passed)]


def simulate(plans: Sequence[Passed], repeats: Sequence[int], threads: int | None) -> list[Row]:
    """Simulate some repeats.

    Parameters
    ----------
    plans : sequence of Passed
        All repeats of the cell.
    repeats : sequence of int
        Those to simulate.
    threads : int or None
        See `crawler2d.simulate_many`.

    Returns
    -------
    list of Row
        In the order of `repeats`.

    Raises
    ------
    Interrupted
        On Ctrl-C, with the rows of the runs that were finished.
    """
    chosen = [plans[repeat] for repeat in repeats]
    begin = time.process_time()
    try:
        with Collector((), threads=thread_count(threads)) as collector:
            rows = collector.rows(collector.batch(chosen), lambda _: None)
    except RowsInterrupted as stopped:
        spent = time.process_time() - begin
        kept = _rows(repeats, stopped.rows, spent, interrupted=True)
        raise Interrupted(kept) from None
    return _rows(repeats, rows, time.process_time() - begin, interrupted=False)


def _rows(
    repeats: Sequence[int], runs: Sequence[SweepRow], spent: float, *, interrupted: bool
) -> list[Row]:
    """Keep what is needed; the processor time of the batch is shared out by wall time."""
    total = sum(run.wall_time for run in runs if run.error is None)
    rows = []
    for repeat, run in zip(repeats, runs, strict=True):
        if run.error is None:
            metrics = run.metrics
            rows.append(
                Row(
                    repeat,
                    run.outcome,
                    metrics["final_x"],
                    metrics["final_y"],
                    metrics["final_angle"],
                    metrics["time"],
                    metrics["solves"],
                    spent * run.wall_time / total,
                )
            )
        elif not interrupted:
            rows.append(_FAILED._replace(repeat=repeat))
    return rows
