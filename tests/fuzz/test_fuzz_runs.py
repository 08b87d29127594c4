"""Any valid scenario gives numbers, or an error that says why not; and it answers Ctrl-C."""

import gc
import re
import sys
import time
from collections.abc import Callable, Iterable, Iterator
from typing import Any

import numpy as np
import pytest

import crawler2d as c2d
from crawler2d.common.arrays import Table
from crawler2d.parameters.scenario import Scenario
from crawler2d.results.outcome import Outcome
from crawler2d.runs.dataset import UNITS
from tests.census import strata
from tests.fuzz.account import SEED, Account, cases, interrupted
from tests.fuzz.drawn_robots import Draw
from tests.fuzz.drawn_scenes import STEPS, drawn_scenario

Say = Callable[[str], None]

PATIENCE = 5.0  # [s] of processor time, after which a case is interrupted
ANSWER = 0.2  # [s] of processor time from an interrupt to its answer


def _columns(name: str, table: Table) -> Iterable[tuple[str, Any]]:
    return ((f"{name}.{column}", table[column]) for column in table)


def unbounded(named: Iterable[tuple[str, Any]]) -> list[str]:
    """Names of values with numbers that are not finite."""

    def is_finite(values: Any) -> bool:
        array = np.asarray(values)
        return array.dtype.kind not in "fc" or bool(np.isfinite(array).all())

    return [name for name, values in named if not is_finite(values)]


def of_run(run: c2d.Run) -> list[str]:
    """Names of values of a run that are not finite."""
    named: list[tuple[str, Any]] = [
        (name, value)
        for name, value in run.metrics.items()
        if not (name == "time_to_clear" and value == np.inf)
    ]
    named += [*_columns("events", run.events), *_columns("edges", run.edges)]
    if run._trace:
        named += [(name, getattr(run, name)) for name in UNITS]
        named += _columns("contacts", run.contacts)
    if run.diagnosis is not None and "nan" in str(run.diagnosis):
        named.append(("diagnosis", np.nan))
    return unbounded(named)


def of_state(sim: c2d.Simulation) -> list[str]:
    """Names of values of an instant that are not finite."""
    state = sim.state()
    numbers = ("position", "velocity", "chassis_angle", "angular_velocity", "commanded_speed")
    more = ("time", "track_speed", "track_position", "flipper_angles")
    named = [(name, getattr(state, name)) for name in numbers + more]
    named += [*_columns("contacts", state.contacts), *_columns("intrusions", sim.intrusions())]
    return unbounded(named)


def simulated(draw: Draw, scenario: Scenario) -> tuple[str, list[str]]:
    """Simulate it in one call."""
    record: Any = draw.choice(("summary", "full"))
    # Down to a tenth of a step, about.
    shortest = 0.1 * scenario.duration / STEPS
    interval = draw.size(shortest, 1.0, (shortest, 0.01))
    trials: Any = draw.choice((None, None, None, "auto", "all"))
    run = c2d.simulate(scenario, record=record, sample_interval=interval, trials=trials)
    return str(run.outcome), of_run(run)


def stepwise(draw: Draw, scenario: Scenario) -> tuple[str, list[str]]:
    """Advance it in pieces, with commands and snapshots between them."""
    sim = c2d.Simulation(scenario)
    wrong = of_state(sim)
    arms = scenario.robot.flippers
    for _ in range(4):
        given: dict[str, float] = {"push": draw.signed(1e6, 10.0 * scenario.robot.mass)}
        high = scenario.robot.drivetrain.max_speed
        given["speed"] = max(-high, min(high, draw.signed(high, high)))
        if arms is not None:
            name = "rear_flipper_angle" if arms.ends == "rear" else "flipper_angle"
            given[name] = max(-6.3, min(6.3, draw.signed(6.3, 2.0)))
        sim.command(**given)
        sim.advance(0.25 * scenario.duration)
        wrong += of_state(sim)
        copy = c2d.Simulation.from_snapshot(sim.snapshot())
        if copy.snapshot() != sim.snapshot() or copy.scenario != scenario:
            wrong.append("snapshot")
        told = sim.diagnosis()
        if told is not None and "nan" in str(told):
            wrong.append("diagnosis")
    return f"steps: {sim.state().outcome}", wrong


def tried(draw: Draw, account: Account, case: str, scenario: Scenario) -> None:
    """Run a scenario in one of the ways, and record the result."""
    way = stepwise if draw.random() < 0.25 else simulated
    # Some are interrupted early on, wherever they are; half of all take less than 10 ms.
    patience = draw.size(1e-3, 1.0, (1e-3, 0.01)) if draw.random() < 0.4 else PATIENCE
    begin = time.process_time()
    result, late = interrupted(patience, lambda: way(draw, scenario))
    account.took(time.process_time() - begin, case)
    if late is not None:
        account.counts["interrupted" if patience < PATIENCE else "too long, interrupted"] += 1
        account.latest = max(account.latest, late)
        if late > ANSWER:
            account.fault("an interrupt is not answered", f"{case}: {late:.2f} s, {way.__name__}")
    elif result is not None:
        outcome, wrong = result
        account.counts[outcome] += 1
        for name in wrong:
            account.fault(f"no number in {name}", case)


def scenario_of(number: int, draw: Draw) -> Scenario:
    """An ordinary robot, likely to stop or to clear, and by turns one with extreme numbers."""
    if number % 2:
        return drawn_scenario(draw)
    names = list(strata.STRATA)
    return strata.draw(names[number // 2 % len(names)], number, SEED)


def fuzzed(count: int) -> Account:
    """Try a number of cases; a case is determined by its number and the seed."""
    account = Account("runs")
    for number in range(count):
        case = f"case {number}"
        draw = Draw(f"{SEED}:runs:{number}")
        scenario = scenario_of(number, draw)
        try:
            begin = time.thread_time()
            try:
                scenario.validate()
            finally:
                took = time.thread_time() - begin
                if took > ANSWER:
                    account.fault("checking is not interrupted", f"{case}: {took:.2f} s")
            tried(draw, account, case, scenario)
        except c2d.ScenarioError:
            account.counts["refused"] += 1
        except (c2d.SimulationDiverged, c2d.LimitError) as error:
            account.counts[type(error).__name__] += 1
            reason = re.sub(r"\d+", "..", f"{type(error).__name__}: {error}")
            account.reasons[reason] += 1
        except Exception as error:
            account.fault(f"{type(error).__name__}: {error!s:.60}", case)
    return account


def check(count: int, say: Say = print) -> None:
    account = fuzzed(count)
    say(f"{account}; answers to interrupts within {1e3 * account.latest:.0f} ms")
    assert not account.faults
    assert account.counts["refused"] < 0.6 * count
    # Implausible numbers are rare, as is impossible memory.
    assert account.counts["SimulationDiverged"] < 0.01 * count
    assert account.counts["LimitError"] < 0.01 * count
    ends = {str(outcome) for outcome in Outcome if outcome.is_stop} | {"cleared"}
    ended = sum(account.counts[way + end] for end in ends for way in ("", "steps: "))
    interrupted = account.counts["interrupted"]
    assert ended > (count - account.counts["refused"] - interrupted) / 3
    assert interrupted > 0


pytestmark = [
    pytest.mark.filterwarnings("ignore::crawler2d.ScenarioWarning"),
    pytest.mark.skipif(sys.platform == "win32", reason="no timer of processor time"),
]


@pytest.fixture(autouse=True)
def nothing_of_other_tests_is_collected() -> Iterator[None]:
    """A collection that looks through all that a whole suite has left takes longer than ANSWER."""
    gc.freeze()
    yield
    gc.unfreeze()


def test_extreme_scenarios_run_to_numbers_or_say_why_not(
    capfd: pytest.CaptureFixture[str],
) -> None:
    check(100)
    assert "panicked" not in capfd.readouterr().err


@pytest.mark.soak
def test_ten_thousand_extreme_scenarios_run_to_numbers_or_say_why_not(say: Say) -> None:
    check(cases("RUNS", 10_000), say)
