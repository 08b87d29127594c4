"""Processes started while objects exist get right results or an error, and never hang."""

import contextlib
import multiprocessing
import os
import pickle
import select
import signal
import sys
import threading
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

import crawler2d as c2d
from crawler2d.sweeps.store import Store
from tests.api.test_processes import final_pose
from tests.sweeps.small import BASE, BRIEF, quiet

pytestmark = [
    pytest.mark.filterwarnings("ignore:.*multi-threaded.*fork:DeprecationWarning"),
    pytest.mark.skipif(sys.platform == "win32", reason="no fork"),
]

START = c2d.variability.of_start()

# Steps so small that it takes for ever.
ENDLESS = BASE.replace({"solver.time_step": 1e-5})


@contextlib.contextmanager
def busy(call: Callable[[], None]) -> Iterator[None]:
    """A thread that calls a function repeatedly."""
    end = threading.Event()

    def work() -> None:
        while not end.is_set():
            call()

    thread = threading.Thread(target=work)
    thread.start()
    try:
        yield
    finally:
        end.set()
        thread.join()


def forked(call: Callable[[], object]) -> str:
    """The result of a call in a fork of this process, or its error."""
    read, write = os.pipe()
    child = os.fork()
    if child == 0:
        try:
            text = repr(call())
        except BaseException as error:
            text = f"{type(error).__name__}: {error}"
        os.write(write, text.encode())
        os._exit(0)
    os.close(write)
    with os.fdopen(read) as pipe:
        ready, _, _ = select.select([pipe], [], [], 20.0)
        if not ready:
            os.kill(child, signal.SIGKILL)
        os.waitpid(child, 0)
        return pipe.read() if ready else "hangs"


def end_of(sim: c2d.Simulation) -> bytes:
    sim.advance(0.1)
    return sim.snapshot()


@pytest.mark.parametrize("method", multiprocessing.get_all_start_methods())
def test_children_of_a_process_full_of_live_objects_find_the_same_bits(
    method: str, tmp_path: Path
) -> None:
    text = BASE.to_json()
    here = final_pose(text)
    many = c2d.Simulations([BASE] * 4, threads=4)
    sim = c2d.Simulation(BASE)
    sim.advance(0.5)
    twin = pickle.loads(pickle.dumps(sim))
    context = multiprocessing.get_context(method)
    with Store(tmp_path / "a.sqlite"), busy(lambda: many.advance(0.01)), context.Pool(2) as pool:
        assert pool.map_async(final_pose, [text] * 4).get(timeout=60.0) == [here] * 4
        assert pool.apply_async(end_of, (sim,)).get(timeout=60.0) == end_of(twin)


def test_an_inherited_simulation_goes_on_in_a_fork_as_in_its_parent() -> None:
    sim, many = c2d.Simulation(BASE), c2d.Simulations([BASE] * 3)
    for each in (sim, many):
        each.advance(0.5)

    def go_on() -> tuple[bytes, bytes]:
        many.advance(0.1)
        return end_of(sim), many.snapshot(2)

    assert forked(go_on) == repr(go_on())


def test_a_fork_does_not_wait_for_a_thread_of_its_parent() -> None:
    sim, many = c2d.Simulation(ENDLESS), c2d.Simulations([ENDLESS] * 2)
    with busy(lambda: sim.advance(0.01)), busy(lambda: many.advance(0.001)):
        for _ in range(3):
            for call in (lambda: sim.advance(0.1), sim.state, many.state, many.reset):
                told = forked(call)
                # Between two pieces it is consistent, and can be used.
                assert "when this process was forked" in told or "Error" not in told
                assert told != "hangs"
        fresh = forked(lambda: c2d.simulate(BRIEF, record="summary").metrics["final_x"])
    assert fresh == repr(c2d.simulate(BRIEF, record="summary").metrics["final_x"])


def test_a_fork_reads_the_store_that_its_parent_writes_and_writes_it_after_that(
    tmp_path: Path,
) -> None:
    path = tmp_path / "a.sqlite"

    def write() -> object:
        return quiet(BRIEF, {}, repeats=3, store=path).sizes["repeat"]

    with Store(path):
        assert forked(lambda: dict(c2d.table(path).sizes)) == "{'run': 0}"
        assert "StoreError: " in (told := forked(write))
        assert "is being written by another" in told
    assert forked(write) == "3"
    assert c2d.check_store(path) == ()


def test_a_fork_that_outlives_the_store_of_its_parent_can_open_it(tmp_path: Path) -> None:
    """It has inherited its parent's record of the lock, but not the lock."""
    path = tmp_path / "a.sqlite"
    go, went = os.pipe()

    def write() -> object:
        os.read(go, 1)
        return quiet(BRIEF, {}, repeats=3, store=path).sizes["repeat"]

    store = Store(path)

    def close() -> None:
        store.close()
        os.write(went, b"1")

    closing = threading.Timer(0.2, close)
    closing.start()
    assert forked(write) == "3"
    closing.join()
    for each in (go, went):
        os.close(each)
    assert c2d.check_store(path) == ()


def test_a_fork_in_the_middle_of_a_sweep_leaves_its_store_sound(tmp_path: Path) -> None:
    path = tmp_path / "a.sqlite"
    told = []

    def progress(done: int, _: int) -> None:
        told.append(forked(lambda: quiet(BRIEF, {}, store=path)) if done == 0 else "")

    table = quiet(BASE, {}, repeats=5, vary=START, store=path, progress=progress)
    assert "is being written by another" in told[0]
    assert c2d.check_store(path) == ()
    again = quiet(BASE, {}, repeats=5, vary=START, store=path)
    assert again.equals(table)
