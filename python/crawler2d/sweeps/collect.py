"""Get the rows of checked scenarios: from a store, or simulated here or by workers."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import FIRST_COMPLETED, Executor, Future, wait
from typing import Any, Self, cast

from crawler2d import _core
from crawler2d.common.units import METRICS
from crawler2d.errors import (
    InternalError,
    RunUnfinished,
    ScenarioError,
    SimulationDiverged,
    StoreError,
)
from crawler2d.parameters.scenario import Scenario
from crawler2d.results.outcome import Outcome
from crawler2d.results.record import Row
from crawler2d.runs.batch import BatchInterrupted
from crawler2d.runs.run import Run
from crawler2d.sweeps.dask import reliable
from crawler2d.sweeps.database import Place
from crawler2d.sweeps.plan import Checked
from crawler2d.sweeps.store import Store

__all__ = ["Batch", "Collector", "RowsInterrupted", "runs_of", "simulate_chunk"]


def simulate_chunk(
    texts: Sequence[str], trials: Sequence[str], build: str
) -> tuple[str, list[tuple[str, dict[str, Any] | None]]]:
    """Simulate a few valid scenarios on one thread, if this is the requested build.

    Parameters
    ----------
    texts : sequence of str
        The scenarios, as JSON.
    trials : sequence of str
        Trials to make at a stop.
    build : str
        The requested build of the core.

    Returns
    -------
    build : str
        The build of this process; if it differs, nothing was simulated.
    answers : list of (str, dict or None)
        Identity and result of each scenario; None if interrupted.
    """
    own = _build()
    if own != build:
        return own, []
    results: dict[int, dict[str, Any]] = {}
    checked = [_core.PreparedScenario(text) for text in texts]
    _core.simulate_many(checked, 1, 0.01, "row", list(trials), results.update)
    return own, [(each.identity, results.get(index)) for index, each in enumerate(checked)]


def _build() -> str:
    """Return the identity of the core of this process."""
    return str(_core.build_info()["build_id"])


# Runs per task of an executor: milliseconds to seconds of work, little to send.
_CHUNK = 25
# Tasks submitted at once: more than the workers of any executor for such work.
_OUT = 256
# Submissions of a run: first with others, then alone. Dask tries each four times.
_ATTEMPTS = 3
# This many runs in a row without an answer are the fault of the executor, not of the runs.
_GIVEN_UP = 100

Take = Callable[[list[Row]], None]


class RowsInterrupted(KeyboardInterrupt):
    """Ctrl-C ended the simulations; `rows` has a `RunUnfinished` for each missing run."""

    def __init__(self, rows: list[Row]) -> None:
        super().__init__(rows)
        self.rows = rows

    def as_batch(self, store: Place | None) -> BatchInterrupted:
        """Convert it for the caller of a sweep or a study."""
        return BatchInterrupted(runs_of(self.rows), "" if store is None else str(store))


class Collector:
    """Simulates the scenarios of a sweep or study, and keeps their rows in a store.

    Parameters
    ----------
    trials : sequence of str
        Trials to make at a stop.
    store : str or path-like, optional
        File for all runs; locked until the end.
    executor : Executor, optional
        Executor of the simulations; None uses threads of this process.
    threads : int
        Number of threads.
    """

    def __init__(
        self,
        trials: Sequence[str],
        *,
        store: Place | None = None,
        executor: Executor | None = None,
        threads: int,
    ) -> None:
        self._trials = list(trials)
        self._executor = None if executor is None else reliable(executor)
        self._threads = threads
        self._store = None if store is None else Store(store, trials)

    def __enter__(self) -> Self:
        """Return the collector."""
        return self

    def __exit__(self, *error: object) -> None:
        """Close the store."""
        if self._store is not None:
            self._store.close()

    def batch(self, checked: Sequence[Checked]) -> Batch:
        """Make a batch of scenarios, with their rows in the store."""
        batch = Batch(checked)
        if self._store is not None:
            batch.take(self._store.read([each.identity for each in batch.missing]).values())
        return batch

    def rows(self, batch: Batch, report: Callable[[int], None]) -> list[Row]:
        """Simulate the missing scenarios of a batch, each once, and return all rows.

        Raises
        ------
        RowsInterrupted
            On Ctrl-C.
        StoreError
            If the store can no longer be written; `runs` of the error has the simulated runs.
        InternalError
            If the executor accepts no more tasks, fails with all of them, or has workers of another
            build; finished runs are in the store.
        """
        missing = batch.missing
        _core.warn(missing)

        def take(rows: list[Row]) -> None:
            new = batch.take(rows)
            if self._store is not None:
                self._store.add(row for row in rows if _is_reproducible(row))
            report(new)

        try:
            if self._executor is None:
                interrupted = _simulate_here(missing, self._trials, self._threads, take)
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
        Number of scenarios with a row.
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
    def missing(self) -> list[_core.PreparedScenario]:
        """The scenarios without a row, each once."""
        lacking = (places[0] for places in self._places.values() if self._rows[places[0]] is None)
        return [cast("_core.PreparedScenario", self._checked[place]) for place in lacking]

    def take(self, rows: Iterable[Row]) -> int:
        """Add finished rows; return the number of scenarios that they complete."""
        before = self.done
        for row in rows:
            places = self._places[row.identity]
            for place in places:
                self._rows[place] = row
            self.done += len(places)
        return self.done - before

    def rows(self) -> list[Row]:
        """Return a row for every scenario; unfinished ones have an error."""
        unfinished = RunUnfinished("the batch was interrupted before this run had ended")
        return [
            Row.of_error(unfinished, each.identity, each.text)
            if row is None and isinstance(each, _core.PreparedScenario)
            else cast("Row", row)
            for row, each in zip(self._rows, self._checked, strict=True)
        ]


def runs_of(rows: Iterable[Row]) -> list[Run]:
    """Convert rows to runs without history; skip those that break a rule."""
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
    """Whether a run would end the same way again, unlike one that ran out of memory."""
    return row.error is None or isinstance(row.error, SimulationDiverged)


def _simulate_here(
    missing: list[_core.PreparedScenario], trials: Sequence[str], threads: int, take: Take
) -> bool:
    """Simulate the runs on threads of this process; return whether Ctrl-C ended it."""

    def take_results(finished: list[tuple[int, dict[str, Any]]]) -> None:
        take([_row(missing[index], result) for index, result in finished])

    return _core.simulate_many(missing, threads, 0.01, "row", list(trials), take_results)


def _simulate_by_executor(
    executor: Executor, missing: Sequence[_core.PreparedScenario], trials: Sequence[str], take: Take
) -> bool:
    """Submit the runs in chunks, take rows in any order; return whether Ctrl-C ended it.

    The runs of a failed task are submitted again, each alone, as one of them may kill its workers.
    After some attempts, its result is an error.
    """
    build = _build()
    due = deque((missing[k : k + _CHUNK], 1) for k in range(0, len(missing), _CHUNK))
    out: dict[Future[Any], tuple[Sequence[_core.PreparedScenario], int]] = {}
    given_up = 0
    try:
        while due or out:
            while due and len(out) < _OUT:
                runs, attempt = due.popleft()
                texts = [each.text for each in runs]
                out[_submit(executor, texts, list(trials), build)] = runs, attempt
            for future in wait(out, return_when=FIRST_COMPLETED).done:
                runs, attempt = out.pop(future)
                try:
                    rows = _read_answer(future, runs, build)
                    given_up = 0
                except _LostTask as lost:
                    if attempt < _ATTEMPTS:
                        due.extend(([each], attempt + 1) for each in runs)
                        continue
                    given_up += 1
                    if given_up == _GIVEN_UP:
                        raise _failed(lost) from lost
                    error = InternalError(f"none of {attempt} attempts gave a result: {lost}")
                    rows = [Row.of_error(error, each.identity, each.text) for each in runs]
                take(rows)
    except KeyboardInterrupt:
        return True
    finally:
        for future in out:
            future.cancel()
    return False


def _submit(executor: Executor, *args: Any) -> Future[Any]:
    try:
        return executor.submit(simulate_chunk, *args)
    except Exception as error:
        raise _failed(f"{type(error).__name__}: {error}") from error


def _failed(why: object) -> InternalError:
    return InternalError(
        f"the executor failed ({why}); a store keeps the finished runs: the same call with another"
        " executor continues from there"
    )


class _LostTask(Exception):
    """A task failed; the text says why."""


def _read_answer(
    future: Future[Any], runs: Sequence[_core.PreparedScenario], build: str
) -> list[Row]:
    """Make rows from an answer, which must be for these runs.

    Raises
    ------
    _LostTask
        If it is for other runs, or there is none.
    InternalError
        If it comes from another build, whose bits may differ.
    """
    if future.cancelled():
        raise _LostTask("its executor cancelled it")
    error = future.exception()
    if error is not None:
        raise _LostTask(f"{type(error).__name__}: {error}")
    try:
        answer = future.result()
        if not isinstance(answer, tuple):
            raise TypeError(f"it is a {type(answer).__name__}")
        own, answers = answer
        if own != build:
            raise InternalError(f"a worker has another build of crawler2d ({own}, not {build})")
        return [_read_row(run, *answer) for run, answer in zip(runs, answers, strict=True)]
    except (AttributeError, LookupError, TypeError, ValueError) as fault:
        text = f"its answer cannot be read ({type(fault).__name__}: {fault})"
        raise _LostTask(text) from fault


def _read_row(run: _core.PreparedScenario, identity: str, result: dict[str, Any] | None) -> Row:
    """Make the row of a run from a worker's answer."""
    if identity != run.identity:
        raise ValueError(f"it is of the run {str(identity)[:12]}, not {run.identity[:12]}")
    if result is None:
        raise ValueError("the worker was interrupted")
    row = _row(run, result)
    if row.error is None:
        Outcome(row.outcome)
        figures = [*row.metrics.values(), row.wall_time]
        if row.metrics.keys() != METRICS.keys() or {*map(type, figures)} != {float}:
            raise ValueError("its figures are others")
        row.read_diagnosis()
    return row


def _row(run: _core.PreparedScenario, result: dict[str, Any]) -> Row:
    return Row.of_result(run.identity, run.text, result)
