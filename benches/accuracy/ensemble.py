"""The runs of a cell: the draws of `crawler2d.sweep`, the same for every setting of the solver."""

from __future__ import annotations

import time
from collections.abc import Sequence
from typing import NamedTuple

from benches.accuracy.cells import Cell, Setting
from crawler2d.runs.batch import simulate_passed
from crawler2d.runs.interrupted import BatchInterrupted
from crawler2d.runs.recording import recording
from crawler2d.runs.run import Run
from crawler2d.runs.threads import thread_count
from crawler2d.sweeps.draws import Variation
from crawler2d.sweeps.plan import Plan, plan_runs

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


def plans(cell: Cell, setting: Setting, count: int, seed: int) -> list[Plan]:
    """Draw the first runs of a cell, as a sweep would."""
    base = cell.scenario(setting)
    return plan_runs(base, (), Variation.of(base, None, ()), repeats=count, seed=seed)


def simulate(plans: Sequence[Plan], repeats: Sequence[int], threads: int | None) -> list[Row]:
    """Simulate some repeats.

    Parameters
    ----------
    plans : sequence of Plan
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
    interrupted = False
    begin = time.process_time()
    try:
        runs = simulate_passed(
            [plan.scenario for plan in chosen],
            [plan.checked for plan in chosen],
            (*recording(0.01, "summary"), []),
            threads=thread_count(threads),
            progress=False,
        )
    except BatchInterrupted as stopped:
        runs, interrupted = stopped.runs, True
    spent = time.process_time() - begin
    rows = _rows(repeats, runs, spent, interrupted=interrupted)
    if interrupted:
        raise Interrupted(rows)
    return rows


def _rows(
    repeats: Sequence[int], runs: Sequence[Run], spent: float, *, interrupted: bool
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
                    str(run.outcome),
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
