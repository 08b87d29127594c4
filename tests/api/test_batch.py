"""Many runs: order, threads, errors, progress."""

import dataclasses
import itertools
import sys
from typing import Any

import numpy as np
import pytest

import crawler2d as c2d
from crawler2d.parameters.scenario import Scenario
from tests.shared import ROBOT, VARIANTS

HEIGHTS = (0.02, 0.2, 0.03, 0.04, 0.15, 0.05)


@pytest.fixture(scope="module")
def batch() -> list[Scenario]:
    base = Scenario(ROBOT.with_track(c2d.LineOfWheels(3)), c2d.terrains.step(0.03), duration=3.0)
    return [base.replace({"terrain.height": height}) for height in HEIGHTS]


def bits(run: c2d.Run) -> tuple[Any, ...]:
    """All parts of a run that must be reproducible."""
    columns = [*run._trace.values(), *run.contacts.values(), *run.edges.values()]
    return run.outcome, tuple(run.metrics.items()), *(column.tobytes() for column in columns)


def test_runs_come_in_the_order_of_the_scenarios(batch: list[Scenario]) -> None:
    runs = c2d.simulate_many(batch)
    assert [run.scenario for run in runs] == batch
    assert [bits(run) for run in runs] == [bits(c2d.simulate(s)) for s in batch]


@pytest.mark.parametrize("threads", [2, 3, 16])
def test_any_number_of_threads_gives_the_same_bits(batch: list[Scenario], threads: int) -> None:
    one = c2d.simulate_many(batch, threads=1)
    assert [bits(r) for r in c2d.simulate_many(batch, threads=threads)] == [bits(r) for r in one]


def test_any_order_of_the_batch_gives_the_same_bits(batch: list[Scenario]) -> None:
    order = [3, 0, 5, 1, 4, 2]
    runs = c2d.simulate_many([batch[i] for i in order], threads=2)
    expected = c2d.simulate_many(batch, threads=2)
    assert [bits(run) for run in runs] == [bits(expected[i]) for i in order]


def test_the_hundredth_run_is_the_first(scenario: Scenario) -> None:
    short = scenario.replace({"duration": 1.0})
    assert len({bits(run) for run in c2d.simulate_many([short] * 100)}) == 1


def test_an_empty_batch_has_no_runs() -> None:
    assert c2d.simulate_many([]) == []
    assert c2d.simulate_many(iter(()), progress=True) == []


def test_a_generator_is_a_batch(batch: list[Scenario]) -> None:
    runs = c2d.simulate_many(itertools.islice(batch, 2), record="summary")
    assert [run.scenario for run in runs] == batch[:2]


def test_a_broken_scenario_ends_the_batch_before_it_begins(batch: list[Scenario]) -> None:
    calls: list[int] = []
    broken = batch[1].replace({"robot.mass": -1.0})
    with pytest.raises(c2d.ScenarioError) as caught:
        c2d.simulate_many([batch[0], broken], progress=lambda done, _: calls.append(done))
    assert caught.value.path == "scenarios[1].robot.mass"
    assert calls == []


def test_a_broken_scenario_can_be_recorded_without_affecting_the_others(
    batch: list[Scenario],
) -> None:
    broken = batch[1].replace({"robot.mass": -1.0})
    odd = batch[1].replace({"robot.name": "x" * 2000})
    runs = c2d.simulate_many([batch[0], broken, odd, batch[2]], on_error="record")
    assert [run.error is None for run in runs] == [True, False, False, True]
    assert bits(runs[3]) == bits(c2d.simulate(batch[2]))
    assert isinstance(runs[1].error, c2d.ScenarioError)
    assert runs[1].outcome is None
    assert "ScenarioError" in repr(runs[1])
    assert "ScenarioError" in repr(runs[2])
    with pytest.raises(AttributeError, match=r"robot\.mass"):
        _ = runs[1].time


def test_anything_but_a_scenario_ends_the_batch(batch: list[Scenario]) -> None:
    wrong: Any = [batch[0], ROBOT]
    with pytest.raises(c2d.ScenarioError) as caught:
        c2d.simulate_many(wrong, on_error="record")
    assert caught.value.path == "scenarios[1]"


@pytest.mark.parametrize(
    ("argument", "value"),
    [
        ("record", "all"),
        ("record", 5),
        ("sample_interval", 0.0),
        ("sample_interval", -0.01),
        ("sample_interval", float("nan")),
        ("sample_interval", "0.01"),
        ("sample_interval", True),
        ("on_error", "ignore"),
        ("progress", "yes"),
        ("progress", 1),
    ],
)
def test_a_wrong_argument_is_refused_by_name(
    scenario: Scenario, argument: str, value: object
) -> None:
    options: dict[str, Any] = {argument: value}
    with pytest.raises(c2d.ScenarioError) as caught:
        c2d.simulate_many([scenario], **options)
    assert caught.value.path == argument


@pytest.mark.parametrize("threads", [0, -1, 1025, 10**5, 2.5, "2", True, np.nan])
def test_an_impossible_number_of_threads_is_refused(scenario: Scenario, threads: Any) -> None:
    with pytest.raises(c2d.LimitError, match="threads must be"):
        c2d.simulate_many([scenario], threads=threads)


@pytest.mark.parametrize("text", ["0", "-1", "two", "2.5", "1e3", "99999999999999", "²"])
def test_garbage_in_the_environment_is_refused(
    scenario: Scenario, text: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("CRAWLER2D_THREADS", text)
    with pytest.raises(c2d.LimitError, match="CRAWLER2D_THREADS"):
        c2d.simulate_many([scenario])


def test_the_environment_limits_the_threads(monkeypatch: pytest.MonkeyPatch) -> None:
    from crawler2d.runs.progress import thread_count  # noqa: PLC0415

    monkeypatch.setenv("CRAWLER2D_THREADS", " 2 ")
    assert thread_count(8) == 2
    assert thread_count(1) == 1
    assert thread_count(None) <= 2
    monkeypatch.setenv("CRAWLER2D_THREADS", "")
    whole: Any = np.int64(8)
    assert thread_count(whole) == 8


def test_a_history_too_large_is_refused_before_it_begins(scenario: Scenario) -> None:
    long = scenario.replace({"duration": 1e5, "solver.time_step": 1e-5})
    with pytest.raises(c2d.LimitError, match="GiB"):
        c2d.simulate_many([long], sample_interval=1e-5)


def test_progress_counts_from_0_to_all(batch: list[Scenario]) -> None:
    calls: list[tuple[int, int]] = []
    c2d.simulate_many(batch, progress=lambda done, total: calls.append((done, total)))
    assert [total for _, total in calls] == [len(batch)] * len(calls)
    counts = [done for done, _ in calls]
    assert counts == sorted(set(counts))
    assert counts[-1] == len(batch)


def test_an_exception_of_a_progress_callback_propagates_unchanged(batch: list[Scenario]) -> None:
    error = OSError("the display is gone")

    def fail(_done: int, _total: int) -> None:
        raise error

    with pytest.raises(OSError, match="display") as caught:
        c2d.simulate_many(batch, progress=fail)
    assert caught.value is error
    assert c2d.simulate(batch[0]).outcome is not None  # the simulator still works


def test_a_progress_callback_may_simulate(batch: list[Scenario]) -> None:
    outcomes: list[object] = []

    def nested(_done: int, _total: int) -> None:
        outcomes.append(c2d.simulate(batch[0], record="summary").outcome)

    c2d.simulate_many(batch[:2], progress=nested)
    assert set(outcomes) == {c2d.simulate(batch[0]).outcome}


def test_a_progress_bar_ends_full(
    batch: list[Scenario], capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True)
    c2d.simulate_many(batch, progress=True, record="summary")
    assert f"{len(batch)}/{len(batch)}" in capsys.readouterr().err


def test_without_tqdm_progress_is_a_line(
    batch: list[Scenario], capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "tqdm.auto", None)
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True)
    c2d.simulate_many(batch, progress=True, record="summary")
    last = capsys.readouterr().err.split("\r")[-1]
    assert last.startswith(f"{len(batch)} of {len(batch)} runs")


def test_progress_that_is_no_terminal_is_lines_without_a_bar(
    batch: list[Scenario], capsys: pytest.CaptureFixture[str]
) -> None:
    c2d.simulate_many(batch, progress=True, record="summary")
    said = capsys.readouterr().err
    assert said.splitlines()[-1].startswith(f"{len(batch)} of {len(batch)} runs")
    assert "\r" not in said
    assert len(said.splitlines()) <= 10


def test_fields_complete_a_robot_and_replace_those_of_a_scenario(scenario: Scenario) -> None:
    run = c2d.simulate(ROBOT, c2d.terrains.flat(), duration=0.5, drive=c2d.Drive(speed=0.1))
    expected = Scenario(ROBOT, c2d.terrains.flat(), duration=0.5, drive=c2d.Drive(speed=0.1))
    assert run.scenario == expected
    assert c2d.simulate(scenario, duration=0.5).scenario == scenario.replace({"duration": 0.5})
    flat = c2d.terrains.flat()
    assert c2d.simulate(scenario, flat, duration=0.5).scenario.terrain == flat


@pytest.mark.parametrize(
    ("arguments", "fields", "path"),
    [
        ((ROBOT,), {}, "terrain"),
        (("engineer", c2d.terrains.flat()), {}, "scenario"),
        ((ROBOT, "flat"), {}, "terrain"),
        ((ROBOT, c2d.terrains.flat()), {"duratoin": 1.0}, "duratoin"),
        ((ROBOT, c2d.terrains.flat()), {"duration": -1.0}, "duration"),
    ],
)
def test_what_cannot_be_simulated_is_refused_by_name(
    arguments: tuple[Any, ...], fields: dict[str, Any], path: str
) -> None:
    with pytest.raises(c2d.ScenarioError) as caught:
        c2d.simulate(*arguments, **fields)
    assert caught.value.path == path


def test_a_run_of_no_duration_has_the_initial_state_only(scenario: Scenario) -> None:
    run = c2d.simulate(scenario, duration=0.0)
    assert run.time.tolist() == [0.0]
    assert run.outcome == c2d.Outcome.TIMED_OUT


@pytest.mark.parametrize("name", VARIANTS)
def test_every_variant_runs(name: str) -> None:
    run = c2d.simulate(VARIANTS[name], duration=1.0)
    assert np.isfinite(run.position).all()
    assert dataclasses.asdict(run.scenario)["duration"] == 1.0
