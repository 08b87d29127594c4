"""The runs: planned like those of `crawler2d.sweep`, stored in SQLite, and run if missing.

All settings of the solver have the same draws. Nothing is lost on Ctrl-C, and no run is repeated.
"""

import hashlib
import json
import sqlite3
import time
from collections.abc import Iterable, Mapping, Sequence
from contextlib import closing
from dataclasses import asdict
from pathlib import Path
from typing import NamedTuple, Self

import crawler2d as c2d
from benches.accuracy.cells import Cell, Setting
from benches.shared.results import progress
from crawler2d import ScenarioError
from crawler2d._core import PreparedScenario
from crawler2d.results.record import Row as SweepRow
from crawler2d.runs.progress import thread_count
from crawler2d.sweeps.collect import Collector, RowsInterrupted
from crawler2d.sweeps.plan import Planner, plan_runs
from crawler2d.variation.draws import Variation

FAILED = "failed"
"""Outcome of a run without a result; its figures are 0."""


class Row(NamedTuple):
    """The stored data of a run."""

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


_METRICS = ("final_x", "final_y", "final_angle", "time", "solves")


class Interrupted(KeyboardInterrupt):
    """Ctrl-C; `rows` are those of the runs that were finished."""

    def __init__(self, rows: list[Row]) -> None:
        super().__init__()
        self.rows = rows


def plan(cell: Cell, setting: Setting, count: int, seed: int) -> list[PreparedScenario]:
    """Draw the first runs of a cell, like a sweep."""
    base = cell.scenario(setting)
    planner = Planner(Variation.read(base, None, ()), Variation({}), seed)
    (plan,) = plan_runs(base, (), planner, repeats=count)
    for each in plan.checked:
        if isinstance(each, ScenarioError):
            raise each
    return [each for each in plan.checked if isinstance(each, PreparedScenario)]


def simulate(
    plans: Sequence[PreparedScenario], repeats: Sequence[int], threads: int | None
) -> list[Row]:
    """Simulate some repeats.

    Parameters
    ----------
    plans : sequence of PreparedScenario
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
            runs = collector.rows(collector.batch(chosen), lambda _: None)
    except RowsInterrupted as stopped:
        kept = _rows(repeats, stopped.rows, time.process_time() - begin)
        raise Interrupted([row for row in kept if row.outcome != FAILED]) from None
    return _rows(repeats, runs, time.process_time() - begin)


def _rows(repeats: Sequence[int], runs: Sequence[SweepRow], spent: float) -> list[Row]:
    """Return the data to store; the processor time of the batch is split by wall time."""
    total = sum(run.wall_time for run in runs if run.error is None)
    rows = []
    for repeat, run in zip(repeats, runs, strict=True):
        row = Row(repeat, FAILED, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
        if run.error is None:
            x, y, angle, duration, solves = (run.metrics[name] for name in _METRICS)
            processor = spent * run.wall_time / total
            row = Row(repeat, run.outcome, x, y, angle, duration, solves, processor)
        rows.append(row)
    return rows


_TABLE = """
create table if not exists runs (
    build text, cell text, name text, setting text, repeat integer, outcome text,
    x real, y real, angle real, time real, solves real, processor real,
    primary key (build, cell, setting, repeat)
)
"""


class Store:
    """The runs of any cells with any settings.

    Parameters
    ----------
    path : Path
        The file; it is made if it is not there.
    any_build : bool
        Whether runs of other builds of the core count as well, for a build that moves no run.
    """

    def __init__(self, path: Path, *, any_build: bool = False) -> None:
        path.parent.mkdir(parents=True, exist_ok=True)
        self._file = sqlite3.connect(path)
        self._build = str(c2d.build_info()["build_id"])
        self._builds = "%" if any_build else self._build
        with self._file as transaction:
            transaction.execute(_TABLE)

    def __enter__(self) -> Self:
        """Return itself."""
        return self

    def __exit__(self, *error: object) -> None:
        """Close the file."""
        self._file.close()

    def rows(self, cell: Cell, setting: Setting) -> dict[int, Row]:
        """Read the runs of a cell with a setting, by repeat."""
        asked = (
            "select repeat, outcome, x, y, angle, time, solves, processor from runs"
            " where build like ? and cell = ? and setting = ? order by build = ?, repeat"
        )
        wanted = (self._builds, key(cell), _text(setting), self._build)
        with closing(self._file.execute(asked, wanted)) as found:
            return {row[0]: Row(*row) for row in found}

    def add(self, cell: Cell, setting: Setting, rows: Iterable[Row]) -> None:
        """Store finished runs, all of them or none."""
        place = (self._build, key(cell), cell.name, _text(setting))
        with self._file as transaction:
            transaction.executemany(
                f"insert or replace into runs values ({', '.join('?' * 12)})",
                [(*place, *row) for row in rows],
            )

    def builds(self) -> list[str]:
        """List the builds whose runs count."""
        asked = "select distinct build from runs where build like ? order by build"
        with closing(self._file.execute(asked, (self._builds,))) as found:
            return [build for (build,) in found]


def key(cell: Cell) -> str:
    """Return a hash of everything on which the runs of a cell depend."""
    fields = {name: value for name, value in asdict(cell).items() if name != "found"}
    if not cell.rotors:
        del fields["rotors"]  # as in stores that are older than this field
    return hashlib.sha256(_text(fields).encode()).hexdigest()[:16]


def _text(fields: Setting) -> str:
    return json.dumps(fields, sort_keys=True)


# Ctrl-C keeps the finished runs of a batch; a process that is killed loses one batch.
_BATCH = 100


def complete(
    store: Store,
    cells: Sequence[Cell],
    settings: Mapping[str, Setting],
    count: int,
    threads: int | None,
) -> None:
    """Add the first runs of each cell with each setting, except those in the store.

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
            planned = plan(cell, setting, count, cell.seed)
            for first in range(0, len(missing), _BATCH):
                batch = missing[first : first + _BATCH]
                try:
                    rows = simulate(planned, batch, threads)
                except Interrupted as stopped:
                    store.add(cell, setting, stopped.rows)
                    raise
                store.add(cell, setting, rows)
            progress(f"{number} of {len(cells)}: {cell.name}, {name}: {len(missing)} runs")
