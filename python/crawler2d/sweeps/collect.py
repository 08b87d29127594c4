"""From checked scenarios to rows: those of a store are read, the others simulated and kept."""

from __future__ import annotations

import contextlib
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Executor, Future, wait
from typing import Any

from crawler2d import _core
from crawler2d.errors import (
    Crawler2dError,
    InternalError,
    RunUnfinished,
    ScenarioError,
    SimulationDiverged,
)
from crawler2d.results.row import Row
from crawler2d.runs.progress import Progress, reporter
from crawler2d.sweeps.chunk import simulate_chunk
from crawler2d.sweeps.store import Place, Store

__all__ = ["RowsInterrupted", "collect"]

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


def collect(
    checked: Sequence[_core.Passed | ScenarioError],
    trials: Sequence[str],
    *,
    store: Place | None,
    executor: Executor | None,
    threads: int,
    progress: bool | Progress | None,
) -> list[Row]:
    """Simulate what is not in the store, each scenario once, and return a row for every scenario.

    Raises
    ------
    RowsInterrupted
        On Ctrl-C.
    StoreError
        If the store cannot be used, or not written any longer.
    InternalError
        If the executor lost its workers; what was finished is in the store.
    """
    places: dict[str, list[int]] = {}
    rows: list[Row | None] = [None] * len(checked)
    firsts: list[_core.Passed] = []
    for place, each in enumerate(checked):
        if isinstance(each, ScenarioError):
            rows[place] = Row.of_error(each)
            continue
        same = places.setdefault(each.identity, [])
        same.append(place)
        if len(same) == 1:
            firsts.append(each)

    def keep(row: Row) -> int:
        for place in places[row.identity]:
            rows[place] = row
        return len(places[row.identity])

    _core.warn(firsts)
    with _opened(store, trials) as kept:
        known = kept.found(list(places)) if kept is not None else {}
        done = sum(row is not None for row in rows)
        done += sum(map(keep, known.values()))
        missing = [each for each in firsts if each.identity not in known]
        with reporter(progress, len(checked), done) as report:

            def take(finished: list[tuple[int, dict[str, Any]]]) -> None:
                made = []
                for place, result in finished:
                    each = missing[place]
                    made.append(Row.of_result(each.identity, each.text, result))
                if kept is not None:
                    kept.add(row for row in made if _is_lasting(row))
                report(sum(map(keep, made)))

            if executor is None:
                interrupted = _core.simulate_many(missing, threads, 0.01, "row", list(trials), take)
            else:
                interrupted = _by_executor(executor, missing, trials, take)
    whole = [
        Row.of_error(RunUnfinished("the batch was interrupted"), each.identity, each.text)
        if row is None and isinstance(each, _core.Passed)
        else row
        for row, each in zip(rows, checked, strict=True)
    ]
    found = [row for row in whole if row is not None]
    if interrupted:
        raise RowsInterrupted(found)
    return found


def _is_lasting(row: Row) -> bool:
    """Whether a run would end in the same way again: not so if memory was short."""
    return row.error is None or isinstance(row.error, SimulationDiverged)


@contextlib.contextmanager
def _opened(store: Place | None, trials: Sequence[str]) -> Iterator[Store | None]:
    if store is None:
        yield None
        return
    with Store(store, trials) as kept:
        yield kept


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
