"""From checked scenarios to rows: read from a store, or simulated, here or by a worker."""

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
from crawler2d.runs.run import Run
from crawler2d.sweeps.database import Place
from crawler2d.sweeps.plan import Checked
from crawler2d.sweeps.store import Store

__all__ = ["Batch", "Collector", "RowsInterrupted", "runs_of", "simulate_chunk"]


def simulate_chunk(
    texts: Sequence[str], trials: Sequence[str], build: str
) -> list[dict[str, Any] | None]:
    """Simulate a few valid scenarios on one thread; None is a run that was interrupted.

    Raises
    ------
    InternalError
        If the worker has another build of the core, whose bits may differ.
    """
    own = str(_core.build_info()["build_id"])
    if own != build:
        raise InternalError(f"a worker has another build of crawler2d ({own}, not {build})")
    results: list[dict[str, Any] | None] = [None] * len(texts)

    def take(finished: list[tuple[int, dict[str, Any]]]) -> None:
        for place, result in finished:
            results[place] = result

    passed = [_core.Passed(text) for text in texts]
    _core.simulate_many(passed, 1, 0.01, "row", list(trials), take)
    return results


# Runs that a task of an executor has: milliseconds to seconds of work, little to send.
_CHUNK = 25
# Tasks that are out at once: more than any executor of this size of work has workers.
_OUT = 256
# How often a task is given out before the loss of its worker ends the batch.
_ATTEMPTS = 5

Take = Callable[[list[tuple[int, dict[str, Any]]]], None]


class RowsInterrupted(KeyboardInterrupt):
    """Ctrl-C ended the simulations early; `rows` has a `RunUnfinished` for each that is missing."""

    def __init__(self, rows: list[Row]) -> None:
        super().__init__(rows)
        self.rows = rows


class Collector:
    """Where rows come from, and where they are kept: one for a whole sweep or study.

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
        """Read what is in the store of these scenarios."""
        batch = Batch(checked)
        if self._store is not None:
            known = self._store.found([each.identity for each in batch.missing])
            batch.take(known.values())
        return batch

    def rows(self, batch: Batch, report: Callable[[int], None]) -> list[Row]:
        """Simulate what is missing of a batch, each scenario once, and return a row for every one.

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
            made = []
            for place, result in finished:
                each = missing[place]
                made.append(Row.of_result(each.identity, each.text, result))
            new = batch.take(made)
            if self._store is not None:
                self._store.add(row for row in made if _is_lasting(row))
            report(new)

        try:
            if self._executor is None:
                interrupted = _core.simulate_many(
                    missing, self._threads, 0.01, "row", self._trials, take
                )
            else:
                interrupted = _by_executor(self._executor, missing, self._trials, take)
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
        """Take finished rows; returns how many scenarios have got one."""
        before = self.done
        for row in rows:
            places = self._places[row.identity]
            for place in places:
                self._rows[place] = row
            self.done += len(places)
        return self.done - before

    def rows(self) -> list[Row]:
        """Return a row for every scenario; one that was not finished says so."""
        unfinished = RunUnfinished("the batch was interrupted before this run had ended")
        return [
            Row.of_error(unfinished, each.identity, each.text)
            if row is None and isinstance(each, _core.Passed)
            else cast("Row", row)
            for row, each in zip(self._rows, self._checked, strict=True)
        ]


def runs_of(rows: Iterable[Row]) -> list[Run]:
    """Make runs of rows, with what rows hold; those that break a rule are left out."""
    return [_run(row) for row in rows if row.scenario]


def _run(row: Row) -> Run:
    """Make a run of a row, with what rows hold."""
    scenario = Scenario.from_json(row.scenario)
    result = {
        "outcome": row.outcome,
        "metrics": row.metrics,
        "diagnosis": row.diagnosis,
        "wall_time": row.wall_time,
    }
    return Run(scenario, {} if row.error is not None else result, row.error)


def _is_lasting(row: Row) -> bool:
    """Whether a run would end in the same way again: not so if memory was short."""
    return row.error is None or isinstance(row.error, SimulationDiverged)


def _by_executor(
    executor: Executor, missing: Sequence[_core.Passed], trials: Sequence[str], take: Take
) -> bool:
    """Give the runs out in chunks, and take what comes back in any order.

    A chunk whose worker is lost is given out again. Returns whether Ctrl-C ended it.
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
            f"the executor cannot go on ({type(error).__name__}: {error}); a store keeps what was"
            " finished: the same call with another executor goes on from there"
        ) from error
    finally:
        for future in out:
            future.cancel()
    return False
