"""Ctrl-C is answered at once, and finished runs are kept."""

import signal
import subprocess
import sys
import time
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import crawler2d as c2d

Say = Callable[[str], None]

# Fixed steps: on flat ground, steps with an accuracy soon reach the end of any run.

BATCH = """
import sys, time
import crawler2d as c2d

robot = c2d.robots.engineer(flippers=None, track=c2d.LineOfWheels(9))
solver = c2d.Solver(time_step=1e-3)
base = c2d.Scenario(robot, c2d.terrains.flat(length=50.0), solver=solver)
scenarios = [base.replace({"duration": 1.0})] * 3 + [base.replace({"duration": 1000.0})] * 20

def progress(done, total):
    if done == 3:
        print("ready", flush=True)

try:
    c2d.simulate_many(scenarios, threads=2, record="summary", progress=progress)
except c2d.BatchInterrupted as interrupt:
    now = time.monotonic()
    runs = interrupt.runs
    kept = [run.outcome is not None for run in runs]
    again = c2d.simulate(scenarios[0], record="summary").metrics == runs[0].metrics
    known = [run.scenario for run in runs] == scenarios
    rest = [type(run.error).__name__ for run in runs if run.outcome is None]
    told = f"after {sum(kept)} of {len(runs)} runs" in str(interrupt)
    print(now, len(runs), sum(kept), all(kept[:3]), again, known, told, *set(rest), flush=True)
"""

RUN = """
import time
import crawler2d as c2d

robot = c2d.robots.engineer(flippers=None)
solver = c2d.Solver(time_step=1e-3)
scenario = c2d.Scenario(robot, c2d.terrains.flat(length=900.0), duration=10000.0, solver=solver)
print("ready", flush=True)
try:
    c2d.simulate(scenario, sample_interval=1.0)
except KeyboardInterrupt:
    print(time.monotonic(), flush=True)
"""

ADVANCE = """
import time
import crawler2d as c2d

robot, solver = c2d.robots.engineer(flippers=None), c2d.Solver(time_step=1e-3)
sim = c2d.Simulation(c2d.Scenario(robot, c2d.terrains.flat(), solver=solver))
print("ready", flush=True)
try:
    sim.advance(10000.0)
except KeyboardInterrupt:
    now = time.monotonic()
    before = sim.time
    sim.advance(0.5)
    print(now, before > 0.0, abs(sim.time - before - 0.5) < 1e-9, flush=True)
"""

POLICY = """
import time
import numpy as np
from crawler2d.envs import FlipperVectorEnv

many = FlipperVectorEnv(2048)
many.reset(seed=0)
print("ready", flush=True)
try:
    while True:
        many.step(np.zeros((2048, 3)))
except KeyboardInterrupt:
    now = time.monotonic()
    many.reset()
    many.step(np.zeros((2048, 3)))
    print(now, (many.state.time == 0.05).all(), flush=True)
"""

# A run whose end is made up: repeating it up to there would take long.
BRANCH = """
import time
import crawler2d as c2d
from crawler2d.runs.branch import trial_at

robot = c2d.robots.engineer(flippers=None)
solver = c2d.Solver(time_step=1e-3)
scenario = c2d.Scenario(robot, c2d.terrains.flat(length=900.0), duration=1000.0, solver=solver)
run = c2d.Run(scenario, {{"outcome": "timed_out", "metrics": {{"time": 1000.0}}}})
print("ready", flush=True)
try:
    {call}
except KeyboardInterrupt:
    print(time.monotonic(), flush=True)
"""

# [s] The promise is 0.2 s; a loaded test machine may schedule the process late.
SLACK = 1.0


def interrupted(program: str, delay: float) -> tuple[float, list[str]]:
    """Run a program, interrupt it, and return its latency [s] and later output."""
    command = [sys.executable, "-c", program]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == "ready\n"
        time.sleep(delay)
        sent = time.monotonic()
        process.send_signal(signal.SIGINT)
        try:
            answer, _ = process.communicate(timeout=30.0)
        finally:
            process.kill()
    assert process.returncode == 0
    now, *said = answer.split()
    return float(now) - sent, said


pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="no SIGINT to a child")


def check_batch(delay: float) -> float:
    """Interrupt a batch `delay` seconds after its third run; return the latency [s]."""
    latency, (total, kept, *facts, unfinished) = interrupted(BATCH, delay)
    assert latency < SLACK
    assert (total, unfinished) == ("23", "RunUnfinished")
    assert facts == ["True"] * 4
    assert int(kept) >= 3
    return latency


def test_a_batch_answers_ctrl_c_and_keeps_the_finished_runs_and_all_scenarios(say: Say) -> None:
    say(f"a batch answered Ctrl-C after {1000 * check_batch(0.1):.0f} ms")


@pytest.mark.soak
def test_a_batch_answers_ctrl_c_at_any_time(say: Say) -> None:
    latencies = [check_batch(0.005 * repeat) for repeat in range(100)]
    say(f"100 batches answered Ctrl-C after at most {1000 * max(latencies):.0f} ms")


def test_a_run_answers_ctrl_c(say: Say) -> None:
    latency, _ = interrupted(RUN, 0.3)
    say(f"a run answered Ctrl-C after {1000 * latency:.0f} ms")
    assert latency < SLACK


@pytest.mark.parametrize(
    "call",
    [
        'run.branch(at=900.0, record="summary")',
        'run.branch(at=0.1, duration=1000.0, record="summary")',
        'trial_at(run, 900.0, "torque x 2")',
    ],
    ids=["on the way to a branch", "in a branch", "on the way to a trial"],
)
def test_a_branch_answers_ctrl_c(call: str, say: Say) -> None:
    latency, _ = interrupted(BRANCH.format(call=call), 0.2)
    say(f"{call} answered Ctrl-C after {1000 * latency:.0f} ms")
    assert latency < SLACK


def test_a_simulation_answers_ctrl_c_and_can_go_on(say: Say) -> None:
    latency, said = interrupted(ADVANCE, 0.3)
    say(f"a simulation answered Ctrl-C after {1000 * latency:.0f} ms")
    assert latency < SLACK
    assert said == ["True", "True"]


def test_environments_answer_ctrl_c_and_can_begin_anew(say: Say) -> None:
    latency, said = interrupted(POLICY, 0.5)
    say(f"2048 environments answered Ctrl-C after {1000 * latency:.0f} ms")
    assert latency < SLACK
    assert said == ["True"]


@pytest.mark.parametrize("begun", [c2d.Simulation, lambda one: c2d.Simulations([one])])
def test_a_signal_handler_may_read_the_interrupted_simulation(begun: Callable[..., Any]) -> None:
    robot = c2d.robots.engineer(flippers=None)
    scenario = c2d.Scenario(robot, c2d.terrains.flat(), solver=c2d.Solver(time_step=1e-3))
    running = begun(scenario)
    seen: list[float] = []

    def look(*_: Any) -> None:
        seen.append(float(np.max(running.state().time)))

    before = signal.signal(signal.SIGALRM, look)
    signal.setitimer(signal.ITIMER_REAL, 0.05, 0.05)
    try:
        while not seen:
            running.advance(20.0)
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)
    assert 0.0 < seen[0] <= np.max(running.state().time)


@pytest.mark.skipif(not hasattr(signal, "setitimer"), reason="needs timers")
def test_a_handler_that_uses_the_simulation_that_it_interrupts_is_refused() -> None:
    track = c2d.CircumferentialWheels(24, wheel_radius=0.016)
    robot = c2d.robots.engineer(flippers=None, track=track)
    scenario = c2d.Scenario(robot, c2d.terrains.step(0.1), duration=500.0)
    sim = c2d.Simulation(scenario.replace({"solver.accuracy": None, "solver.time_step": 1e-4}))
    refused = []

    def handler(*_: object) -> None:
        with pytest.raises(c2d.ScenarioError, match="must not be used by a signal handler"):
            sim.command(speed=0.1)
        refused.append(True)
        raise KeyboardInterrupt

    before = signal.signal(signal.SIGALRM, handler)
    signal.setitimer(signal.ITIMER_REAL, 0.3)
    try:
        with pytest.raises(KeyboardInterrupt):
            sim.advance(500.0)
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)
    assert refused
    sim.command(speed=0.1)
