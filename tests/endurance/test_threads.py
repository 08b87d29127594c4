"""Sixteen threads with own and shared objects: the same bits as with one, and no hang."""

import os
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import crawler2d as c2d
from tests.shared import VARIANTS
from tests.sweeps.small import BASE, BRIEF, MODELS, quiet

Say = Callable[[str], None]

THREADS = 16
PIECE = 1.0 / 512.0
"""[s] Any sum of them is exact; others may end just beyond a sample, which is then the last."""
START = c2d.variability.of_start()
NAMES = ("belt-step", "gears-diagonal-barrier", "force-ramp", "segmental-step", "flippers-climb")


def together(work: Callable[[int], Any], count: int = THREADS) -> list[Any]:
    """Call a function in several threads that start at the same time."""
    gate = threading.Barrier(count)

    def begin(number: int) -> Any:
        gate.wait()
        return work(number)

    with ThreadPoolExecutor(count) as pool:
        return list(pool.map(begin, range(count), timeout=300.0))


def alone(number: int, pieces: int) -> bytes:
    """The results of a simulation in one thread, with commands during it."""
    sim = c2d.Simulation(VARIANTS[NAMES[number % len(NAMES)]])
    for piece in range(pieces):
        sim.command(speed=0.05 * (1 + (number + piece) % 5))
        sim.advance(0.02)
    return sim.snapshot()


def short_and_long(short: int, long: int) -> pytest.MarkDecorator:
    """A short test, and a long one with the soak tests."""
    each = [short, pytest.param(long, marks=pytest.mark.soak)]
    return pytest.mark.parametrize("pieces", each)


@short_and_long(3, 300)
def test_simulations_of_sixteen_threads_have_the_bits_of_one(pieces: int) -> None:
    serial = [alone(number, pieces) for number in range(THREADS)]
    assert together(lambda number: alone(number, pieces)) == serial


@short_and_long(8, 2000)
def test_a_simulation_that_sixteen_threads_share_does_all_they_ask(pieces: int) -> None:
    shared = c2d.Simulation(VARIANTS["belt-step"])

    def work(number: int) -> None:
        for piece in range(pieces):
            way = (number + piece) % 4
            if way == 0:
                shared.advance(PIECE)
            elif way == 1:
                shared.command(speed=0.01 * (1 + number))
            elif way == 2:
                assert np.isfinite(shared.state().position).all()
            else:
                c2d.Simulation.from_snapshot(shared.snapshot()).advance(PIECE)

    together(work)
    # Its log has the actual order: repeated alone, it gives the same bits.
    run = shared.to_run()
    assert run.time[-1] == shared.time == PIECE * THREADS * pieces / 4
    assert (run.position[-1] == shared.state().position).all()


@short_and_long(6, 600)
def test_a_batch_that_sixteen_threads_share_does_all_they_ask(pieces: int) -> None:
    many = c2d.Simulations([VARIANTS[name] for name in NAMES], threads=2)

    def work(number: int) -> None:
        for piece in range(pieces):
            way = (number + piece) % 3
            if way == 0:
                many.advance(PIECE, which=[number % len(NAMES)])
            elif way == 1:
                many.command(speed=0.2)
            else:
                assert np.isfinite(many.state().position).all()

    together(work)
    for place in range(len(NAMES)):
        run = many.to_run(place)
        assert (run.position[-1] == many.state().position[place]).all()


def test_sweeps_of_several_threads_have_the_tables_of_one(tmp_path: Path) -> None:
    over = {"robot.track": MODELS, "terrain.height": [0.03, 0.12]}

    def swept(number: int, folder: Path | None = None) -> Any:
        store = None if folder is None else folder / f"{number}.sqlite"
        return quiet(BASE, over, vary=START, seed=number % 2, store=store)

    serial = [swept(number) for number in range(2)]
    for number, table in enumerate(together(lambda number: swept(number, tmp_path), 4)):
        assert table.equals(serial[number % 2])
        assert c2d.check_store(tmp_path / f"{number}.sqlite") == ()


def test_of_many_threads_with_one_store_one_writes_and_the_others_get_an_error(
    tmp_path: Path,
) -> None:
    def swept(_: int) -> str:
        try:
            quiet(BASE, {}, repeats=20, vary=START, store=tmp_path / "one.sqlite")
        except c2d.StoreError as error:
            return str(error)
        return "done"

    told = together(swept, 4)
    assert "done" in told
    assert all(each == "done" or "is being written by another" in each for each in told)
    assert c2d.check_store(tmp_path / "one.sqlite") == ()


class Enough(Exception):
    """Raised by a callback."""


def test_exceptions_of_callbacks_propagate_in_each_thread() -> None:
    def work(number: int) -> str:
        def progress(done: int, _: int) -> None:
            # Runs that finish together are reported together, so a count may be skipped.
            if done > number % 3:
                raise Enough(str(number))

        try:
            c2d.simulate_many([BRIEF] * 5, threads=2, record="summary", progress=progress)
        except Enough as error:
            return str(error)
        return "none"

    assert together(work) == [str(number) for number in range(THREADS)]
    assert c2d.simulate(BRIEF, record="summary").outcome is c2d.Outcome.TIMED_OUT


def test_callbacks_in_threads_may_use_all_of_the_simulator(tmp_path: Path) -> None:
    shared = c2d.Simulation(BASE)

    def work(number: int) -> int:
        calls = 0

        def progress(done: int, _: int) -> None:
            nonlocal calls
            calls += 1
            shared.advance(0.001)
            c2d.Simulations([BRIEF]).advance(0.001)
            if done == 0:
                store = tmp_path / f"{number}.sqlite"
                quiet(BRIEF, {}, repeats=1, store=store, progress=lambda *_: shared.state())

        c2d.simulate_many([BRIEF] * 3, threads=2, record="summary", progress=progress)
        return calls

    calls = sum(together(work, 4))
    assert shared.time == pytest.approx(0.001 * calls)


def test_a_gait_may_read_its_own_simulation_and_others() -> None:
    seen = []

    def gait(state: Any) -> tuple[float, float]:
        seen.append(sim.time)
        sim.command(speed=0.2)
        sim.intrusions()
        c2d.Simulation(BRIEF).advance(0.001)
        return 0.5 - state.chassis_angle, 0.0

    drive = c2d.Drive(gait=gait)
    sim = c2d.Simulation(c2d.Scenario(c2d.robots.engineer(), c2d.terrains.flat(), drive=drive))
    sim.advance(0.1)
    assert len(seen) == 10
    assert sim.time == pytest.approx(0.1)


HEAD = """
import os, signal, sys, threading, time, warnings
import crawler2d as c2d

warnings.simplefilter("ignore", c2d.ScenarioWarning)  # runs that are short of the goal

robot = c2d.robots.engineer(flippers=None, track=c2d.LineOfWheels(9))
solver = c2d.Solver(time_step=1e-3)
base = c2d.Scenario(robot, c2d.terrains.flat(length=900.0), solver=solver)
long = base.replace({"duration": 10000.0})
brief = base.replace({"duration": 1.0})

def later(seconds):
    threading.Timer(seconds, os.kill, (os.getpid(), signal.SIGINT)).start()
"""

PROGRAMS = {
    "Ctrl-C ends what the main thread does, and no other thread": """
results = []
def work():
    results.append(c2d.simulate(base.replace({"duration": 10.0}), record="summary").metrics)
threads = [threading.Thread(target=work) for _ in range(4)]
[each.start() for each in threads]
later(0.1)
try:
    c2d.simulate(long, record="summary")
except KeyboardInterrupt:
    print("interrupted")
[each.join() for each in threads]
print(len(results), all(each == results[0] for each in results))
""",
    "Ctrl-C while the main thread only waits leaves the others alone": """
results = []
def work():
    results.append(c2d.simulate(base.replace({"duration": 20.0}), record="summary").metrics)
threads = [threading.Thread(target=work) for _ in range(4)]
[each.start() for each in threads]
later(0.05)
try:
    time.sleep(60.0)
except KeyboardInterrupt:
    print("interrupted")
[each.join() for each in threads]
print(len(results), all(each == results[0] for each in results))
""",
    "a handler of one's own that returns lets the work go on": """
calls = []
signal.signal(signal.SIGINT, lambda *_: calls.append(c2d.simulate(brief).outcome))
alone = c2d.simulate(base.replace({"duration": 10.0}), record="summary").metrics
def send():
    while len(calls) < 5:
        time.sleep(0.02)
        os.kill(os.getpid(), signal.SIGINT)
threading.Thread(target=send).start()
run = None
while len(calls) < 5:
    run = c2d.simulate(base.replace({"duration": 10.0}), record="summary")
    runs = c2d.simulate_many([base.replace({"duration": 10.0})] * 3, record="summary")
    sim = c2d.Simulation(base)
    sim.advance(5.0)
    many = c2d.Simulations([base] * 2)
    many.advance(5.0)
print("interrupted" if len(calls) >= 5 else "")
same = run.metrics == alone and all(each.metrics == alone for each in runs)
print(4, same and abs(sim.time - 5.0) < 1e-9 and (abs(many.state().time - 5.0) < 1e-9).all())
""",
    "Ctrl-C is answered while another thread has the simulation": """
sim, many = c2d.Simulation(long), c2d.Simulations([long] * 2)
for call in (lambda: sim.advance(1e4), lambda: many.advance(1e4)):
    threading.Thread(target=call, daemon=True).start()
time.sleep(0.2)
answered = 0
for call in (lambda: sim.command(speed=0.1), lambda: many.command(speed=0.1), many.state):
    later(0.1)
    try:
        call()
    except KeyboardInterrupt:
        answered += 1
print("interrupted" if answered else "")
print(answered + 1, answered == 3, flush=True)
os._exit(0)
""",
    "a program ends while threads of it compute": """
for call in (
    lambda: c2d.simulate(long, record="summary"),
    lambda: c2d.simulate_many([long] * 4, threads=2, record="summary"),
    lambda: c2d.Simulation(long).advance(1e4),
    lambda: c2d.Simulations([long] * 4).advance(1e4),
):
    threading.Thread(target=call, daemon=True).start()
time.sleep(0.3)
print("interrupted")
print(4, True, flush=True)
""",
}


@pytest.mark.skipif(sys.platform == "win32", reason="no SIGINT to a child")
@pytest.mark.parametrize("name", PROGRAMS)
def test_signals_and_threads(name: str, say: Say) -> None:
    begin = time.monotonic()
    done = subprocess.run(
        [sys.executable, "-c", HEAD + PROGRAMS[name]],
        capture_output=True,
        text=True,
        timeout=60.0,
        check=False,
        env={**os.environ, "OPENBLAS_NUM_THREADS": "1"},
    )
    assert (done.returncode, done.stdout) == (0, "interrupted\n4 True\n"), done.stderr[-2000:]
    assert done.stderr == ""
    say(f"{name}: {time.monotonic() - begin:.1f} s")
