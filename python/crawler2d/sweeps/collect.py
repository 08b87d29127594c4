"""Rows of checked scenarios: read from a store, or simulated, here or by workers."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import FIRST_COMPLETED, Executor, Future, wait
from typing import Any, Self, cast

from crawler2d import _core
from crawler2d.errors import (
    Crawler2dError,
    InternalError,
    RunUnfinished,
    ScenarioError,
    SimulationDiverged,
    StoreError,
)
from crawler2d.parameters.scenario import Scenario
from crawler2d.results.record import Row
from crawler2d.runs.batch import BatchInterrupted
from crawler2d.runs.run import Run
from crawler2d.sweeps.database import Place
from crawler2d.sweeps.plan import Checked
from crawler2d.sweeps.store import Store

__all__ = ["Batch", "Collector", "RowsInterrupted", "runs_of", "simulate_chunk"]


def simulate_chunk(
    texts: Sequence[str], trials: Sequence[str], build: str
) -> list[dict[str, Any] | None]:
    """Simulate a few valid scenarios on one thread; an interrupted run is None.

    Raises
    ------
    InternalError
        If the worker has another build of the core, whose bits may differ.
    """
    own = str(_core.build_info()["build_id"])
    if own != build:
        raise InternalError(f"a worker has another build of crawler2d ({own}, not {build})")
    results: dict[int, dict[str, Any]] = {}
    checked = [_core.Passed(text) for text in texts]
    _core.simulate_many(checked, 1, 0.01, "row", list(trials), results.update)
    return [results.get(index) for index in range(len(texts))]


# Runs per task of an executor: milliseconds to seconds of work, little to send.
_CHUNK = 25
# Tasks submitted at once: more than any executor of this size of work has workers.
_OUT = 256
# How often a task is submitted before the loss of its worker ends the batch.
_ATTEMPTS = 5

Take = Callable[[list[tuple[int, dict[str, Any]]]], None]


class RowsInterrupted(KeyboardInterrupt):
    """Ctrl-C ended the simulations early; `rows` has a `RunUnfinished` for each that is missing."""

    def __init__(self, rows: list[Row]) -> None:
        super().__init__(rows)
        self.rows = rows

    def as_batch(self, store: Place | None) -> BatchInterrupted:
        """Convert it for the caller of a sweep or a study."""
        return BatchInterrupted(runs_of(self.rows), "" if store is None else str(store))


class Collector:
    """Simulates scenarios, and keeps their rows in a store: one for a whole sweep or study.

    Parameters
    ----------
    trials : sequence of str
        What to try at a stop.
    store : str or path-like, optional
        The file that keeps every run; it is locked until the end.
    executor : Executor, optional
        Where to simulate; None takes the threads of this process.
    threads : int
        How many of them.
    """

    def __init__(
        self,
        trials: Sequence[str],
        *,
        store: Place | None = None,
        executor: Executor | None = None,
        threads: int = 1,
    ) -> None:
        self._trials = list(trials)
        self._executor, self._threads = executor, threads
        self._store = None if store is None else Store(store, trials)

    def __enter__(self) -> Self:
        """Return the collector."""
        return self

    def __exit__(self, *error: object) -> None:
        """Close the store."""
        if self._store is not None:
            self._store.close()

    def batch(self, checked: Sequence[Checked]) -> Batch:
        """Make a batch of scenarios, with those rows that are in the store."""
        batch = Batch(checked)
        if self._store is not None:
            batch.take(self._store.read([each.identity for each in batch.missing]).values())
        return batch

    def rows(self, batch: Batch, report: Callable[[int], None]) -> list[Row]:
        """Simulate what is missing in a batch, each scenario once, and return all rows.

        Raises
        ------
        RowsInterrupted
            On Ctrl-C.
        StoreError
            If the store cannot be written any longer; its `runs` have what was simulated.
        InternalError
            If the executor lost its workers; what was finished is in the store.
        """
        missing = batch.missing
        _core.warn(missing)

        def take(finished: list[tuple[int, dict[str, Any]]]) -> None:
            rows = [
                Row.of_result(missing[index].identity, missing[index].text, result)
                for index, result in finished
            ]
            new = batch.take(rows)
            if self._store is not None:
                self._store.add(row for row in rows if _is_reproducible(row))
            report(new)

        try:
            if self._executor is None:
                interrupted = _core.simulate_many(
                    missing, self._threads, 0.01, "row", self._trials, take
                )
            else:
                interrupted = _simulate_by_executor(self._executor, missing, self._trials, take)
        except StoreError as error:
            error.runs = runs_of(batch.rows())
            raise
        rows = batch.rows()
        if interrupted:
            raise RowsInterrupted(rows)
        return rows


class Batch:
    """Scenarios, and the rows of those that are finished.

    Attributes
    ----------
    done : int
        How many scenarios have a row.
    """

    def __init__(self, checked: Sequence[Checked]) -> None:
        self._checked = checked
        self._rows: list[Row | None] = [None] * len(checked)
        self._places: dict[str, list[int]] = {}
        self.done = 0
        for place, each in enumerate(checked):
            if isinstance(each, ScenarioError):
                self._rows[place] = Row.of_error(each)
                self.done += 1
            else:
                self._places.setdefault(each.identity, []).append(place)

    @property
    def missing(self) -> list[_core.Passed]:
        """The scenarios without a row, each once."""
        lacking = (places[0] for places in self._places.values() if self._rows[places[0]] is None)
        return [cast("_core.Passed", self._checked[place]) for place in lacking]

    def take(self, rows: Iterable[Row]) -> int:
        """Take finished rows; return how many scenarios they complete."""
        before = self.done
        for row in rows:
            places = self._places[row.identity]
            for place in places:
                self._rows[place] = row
            self.done += len(places)
        return self.done - before

    def rows(self) -> list[Row]:
        """Return a row for every scenario; one that is not finished has an error."""
        unfinished = RunUnfinished("the batch was interrupted before this run had ended")
        return [
            Row.of_error(unfinished, each.identity, each.text)
            if row is None and isinstance(each, _core.Passed)
            else cast("Row", row)
            for row, each in zip(self._rows, self._checked, strict=True)
        ]


def runs_of(rows: Iterable[Row]) -> list[Run]:
    """Convert rows to runs without history; those that break a rule are left out."""
    return [_run(row) for row in rows if row.scenario]


def _run(row: Row) -> Run:
    scenario = Scenario.from_json(row.scenario)
    result = {
        "outcome": row.outcome,
        "metrics": row.metrics,
        "diagnosis": row.diagnosis,
        "wall_time": row.wall_time,
    }
    return Run(scenario, {} if row.error is not None else result, row.error)


def _is_reproducible(row: Row) -> bool:
    """Whether a run would end in the same way again, unlike one that was out of memory."""
    return row.error is None or isinstance(row.error, SimulationDiverged)


def _simulate_by_executor(
    executor: Executor, missing: Sequence[_core.Passed], trials: Sequence[str], take: Take
) -> bool:
    """Submit the runs in chunks, and take the results in any order.

    A chunk whose worker is lost is submitted again. Returns whether Ctrl-C ended it.
    """
    build = str(_core.build_info()["build_id"])
    due = deque((begin, _ATTEMPTS) for begin in range(0, len(missing), _CHUNK))
    out: dict[Future[list[dict[str, Any] | None]], tuple[int, int]] = {}
    try:
        while due or out:
            while due and len(out) < _OUT:
                begin, attempts = due.popleft()
                texts = [each.text for each in missing[begin : begin + _CHUNK]]
                future = executor.submit(simulate_chunk, texts, list(trials), build)
                out[future] = (begin, attempts - 1)
            for future in wait(out, return_when=FIRST_COMPLETED).done:
                begin, attempts = out.pop(future)
                lost = future.exception()
                if isinstance(lost, KeyboardInterrupt):
                    return True
                if isinstance(lost, InternalError) or (lost is not None and attempts == 0):
                    raise lost
                if lost is not None:
                    due.append((begin, attempts))
                    continue
                results = future.result()
                take([(begin + k, r) for k, r in enumerate(results) if r is not None])
                if None in results:
                    return True
    except KeyboardInterrupt:
        return True
    except Crawler2dError:
        raise
    except Exception as error:
        raise InternalError(
            f"the executor failed ({type(error).__name__}: {error}); a store keeps the finished"
            " runs: the same call with another executor continues from there"
        ) from error
    finally:
        for future in out:
            future.cancel()
    return False
