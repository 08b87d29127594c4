"""Executors get chunks, and return the same rows as one thread."""

import asyncio
import multiprocessing
import os
from concurrent.futures import (
    BrokenExecutor,
    Executor,
    Future,
    ProcessPoolExecutor,
    ThreadPoolExecutor,
)
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr

import crawler2d as c2d
from crawler2d.sweeps import collect
from crawler2d.sweeps.dask import reliable
from crawler2d.sweeps.store import stored_rows
from tests.kept import refusing
from tests.sweeps.small import BASE, MODELS, SAID, interrupt_after, quiet

OVER = {"robot.track": MODELS, "terrain.height": [0.03, 0.12]}


KILLED = BrokenExecutor("a worker was killed")


class Unreliable(Executor):
    """Runs tasks at once, but loses the first `losses` tasks after a number of others."""

    def __init__(self, losses: int, after: int = 0, error: BaseException = KILLED) -> None:
        self.losses, self.after, self.error = losses, after, error

    def submit(self, call: Any, /, *args: Any, **options: Any) -> Future[Any]:
        future: Future[Any] = Future()
        if self.after == 0 and self.losses > 0:
            self.losses -= 1
            future.set_exception(self.error)
        else:
            self.after = max(self.after - 1, 0)
            future.set_result(call(*args, **options))
        return future


@pytest.fixture(scope="module")
def plain() -> xr.Dataset:
    return quiet(BASE, OVER, repeats=8, threads=1, trials=("torque x 2",))


def swept(executor: Executor, **options: Any) -> xr.Dataset:
    return quiet(BASE, OVER, repeats=8, executor=executor, trials=("torque x 2",), **options)


def test_rows_of_processes_are_those_of_one_thread(plain: xr.Dataset) -> None:
    calls: list[int] = []
    spawn = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(2, mp_context=spawn) as executor:
        found = swept(executor, progress=lambda done, _total: calls.append(done))
    xr.testing.assert_identical(plain, found)
    assert calls[0] == 0
    assert calls[-1] == 32
    assert calls == sorted(calls)


def test_rows_of_threads_are_those_of_one_thread(plain: xr.Dataset) -> None:
    with ThreadPoolExecutor(3) as executor:
        xr.testing.assert_identical(plain, swept(executor))


@pytest.mark.parametrize("error", [KILLED, KeyboardInterrupt()], ids=["killed", "interrupted"])
def test_a_lost_worker_costs_nothing_but_its_time(plain: xr.Dataset, error: BaseException) -> None:
    """Also an interrupted one, which once counted as the user's Ctrl-C."""
    xr.testing.assert_identical(plain, swept(Unreliable(losses=4, error=error)))


class Poisoned(Executor):
    """Runs tasks at once, but loses every task with one of two runs."""

    def __init__(self) -> None:
        self.poison: list[str] = []

    def submit(self, call: Any, /, *args: Any, **options: Any) -> Future[Any]:
        future: Future[Any] = Future()
        texts = args[0]
        self.poison = self.poison or [texts[3], texts[5]]
        if set(self.poison) & set(texts):
            future.set_exception(KILLED)
        else:
            future.set_result(call(*args, **options))
        return future


def test_the_error_of_equal_runs_names_the_first_of_them_alone() -> None:
    lost = Unreliable(losses=10**6)
    with pytest.raises(c2d.errors.InternalError, match="none of 3 attempts") as caught:
        quiet(BASE, {}, vary={}, repeats=4, executor=lost)
    assert caught.value.__notes__ == ["in cell[repeat=0]"]


def test_runs_that_kill_their_workers_take_no_others_with_them(
    plain: xr.Dataset, tmp_path: Path
) -> None:
    store, poisoned = tmp_path / "a.sqlite", Poisoned()
    found = swept(poisoned, on_error="record", store=store)
    failed = found["outcome"].to_numpy() == "failed"
    assert np.argwhere(failed).tolist() == [[0, 0, 3], [0, 0, 5]]
    errors = set(found["error"].to_numpy()[failed])
    assert errors == {"none of 3 attempts gave a result: BrokenExecutor: a worker was killed"}
    with pytest.raises(c2d.errors.InternalError, match="none of 3 attempts") as caught:
        swept(poisoned, store=store)
    assert caught.value.__notes__ == ["in cell[track=belt, height=0.03, repeat=3]"]
    assert len(list(stored_rows(store))) == 30
    with ThreadPoolExecutor(1) as executor:
        xr.testing.assert_identical(plain, swept(executor, store=store))


def test_workers_lost_for_good_leave_what_was_finished_in_the_store(
    plain: xr.Dataset, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(collect, "_CHUNK", 4)
    monkeypatch.setattr(collect, "_GIVEN_UP", 10)
    store = tmp_path / "a.sqlite"
    with pytest.raises(
        c2d.errors.InternalError, match=r"executor failed \(BrokenExecutor: .*another executor"
    ):
        swept(Unreliable(losses=10**6, after=3), store=store)
    assert len(list(stored_rows(store))) == 12
    with ThreadPoolExecutor(2) as executor:
        xr.testing.assert_identical(plain, swept(executor, store=store))


def test_an_executor_has_failed_when_so_many_runs_in_a_row_have_no_result(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(collect, "_GIVEN_UP", 10)
    lost = partial(quiet, BASE, {}, executor=Unreliable(losses=10**6), on_error="record")
    assert set(lost(repeats=9)["outcome"].to_numpy().flat) == {"failed"}
    with pytest.raises(c2d.errors.InternalError, match="executor failed"):
        lost(repeats=10)


def kill_itself(*_: Any) -> Any:
    """A chunk during which its process is killed."""
    os._exit(9)


def test_a_killed_process_is_reported(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(collect, "simulate_chunk", kill_itself)
    spawn = multiprocessing.get_context("spawn")
    with (
        ProcessPoolExecutor(1, mp_context=spawn) as executor,
        pytest.raises(c2d.errors.InternalError, match="executor failed"),
    ):
        swept(executor, store=tmp_path / "a.sqlite")


def test_ctrl_c_keeps_what_came_back() -> None:
    with pytest.raises(c2d.BatchInterrupted) as caught:
        swept(Unreliable(losses=0), progress=interrupt_after(0))
    table = c2d.table(caught.value.runs)
    assert table.sizes == {"run": 32}
    failed = table["outcome"] == "failed"
    assert 0 < failed.sum() < 32
    assert "interrupted" in str(table["error"].values[failed][0])


def test_an_error_of_the_progress_is_no_fault_of_the_executor() -> None:
    def report(done: int, _total: int) -> None:
        if done:
            raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        swept(Unreliable(losses=0), progress=report)


def test_anything_but_an_executor_is_refused() -> None:
    with refusing(SAID, r"must be a concurrent\.futures\.Executor"):
        quiet(BASE, {}, executor=4)


class OfDask(Executor):
    """A result of a Dask client, as far as a sweep needs it."""

    __module__ = "distributed.cfexecutor"

    def __init__(self, client: Any) -> None:
        self._client = client


class Client:
    """Computes submitted tasks at once, and passes results on through a loop."""

    def __init__(self, *, is_lost: bool = False) -> None:
        self.is_lost, self.loop = is_lost, self
        self.pure: list[bool] = []
        self.cancelled: list[Any] = []

    def submit(self, call: Any, *args: Any, pure: bool) -> Any:
        self.pure.append(pure)

        async def task() -> Any:
            if self.is_lost:
                raise KILLED
            return call(*args)

        return Task(task(), self.cancelled)

    def add_callback(self, pass_on: Any, task: Any, answer: Future[Any]) -> None:
        asyncio.run(pass_on(task, answer))


class Task:
    def __init__(self, awaitable: Any, cancelled: list[Any]) -> None:
        self.awaitable, self.cancelled = awaitable, cancelled

    def __await__(self) -> Any:
        return self.awaitable.__await__()

    def cancel(self) -> None:
        self.cancelled.append(self)


def test_an_executor_of_dask_answers_by_its_client() -> None:
    """Each task is computed again if it is submitted again."""
    client = Client()
    used = reliable(OfDask(client))
    assert not isinstance(used, OfDask)
    assert used.submit(max, 3, 7).result() == 7
    assert client.pure == [False]
    lost = reliable(OfDask(Client(is_lost=True))).submit(max, 3, 7)
    assert lost.exception() is KILLED
    other = Unreliable(losses=0)
    assert reliable(other) is other


def test_a_task_that_nobody_waits_for_is_cancelled_in_dask(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    client = Client()
    monkeypatch.setattr(client, "add_callback", lambda *later: waiting.append(later))
    waiting: list[Any] = []
    answer = reliable(OfDask(client)).submit(max, 3, 7)
    assert answer.cancel()
    ((pass_on, task, _),) = waiting
    assert client.cancelled == [task]
    asyncio.run(pass_on(task, answer))  # which is too late, and not an error
    assert answer.cancelled()
