"""Valid answers of an executor's worker, and errors for invalid ones."""

from concurrent.futures import Future
from typing import Any

import pytest

import crawler2d as c2d
from crawler2d import _core
from crawler2d.sweeps import collect
from tests.sweeps.small import BRIEF

RUNS = [
    _core.PreparedScenario(BRIEF.to_json()),
    _core.PreparedScenario(BRIEF.replace({"duration": 0.06}).to_json()),
]
BUILD = collect._build()


def answered(answer: Any) -> Future[Any]:
    future: Future[Any] = Future()
    if isinstance(answer, BaseException):
        future.set_exception(answer)
    else:
        future.set_result(answer)
    return future


@pytest.fixture(scope="module")
def right() -> Any:
    """The answer of a worker to two runs."""
    return collect.simulate_chunk([each.text for each in RUNS], (), BUILD)


def changed(right: Any, **values: Any) -> Any:
    """The same with other values in the result of its second run."""
    build, (first, (identity, result)) = right
    return build, [first, (identity, {**result, **values})]


def test_an_answer_is_a_row_for_each_run(right: Any) -> None:
    rows = collect._read_answer(answered(right), RUNS, BUILD)
    assert [row.identity for row in rows] == [each.identity for each in RUNS]
    assert [row.scenario for row in rows] == [each.text for each in RUNS]
    assert [row.outcome for row in rows] == ["timed_out", "timed_out"]
    assert [row.metrics["time"] for row in rows] == [0.05, 0.06]


def test_an_answer_that_cannot_be_read_is_a_lost_task(right: Any) -> None:
    build, (first, second) = right
    metrics = dict(second[1]["metrics"])
    whole = {**metrics, "time": 1}
    less = {name: value for name, value in metrics.items() if name != "time"}
    own, other = (each.identity[:12] for each in RUNS)
    unread = "its answer cannot be read ({})"
    for answer, why in (
        (KeyError("a"), "KeyError: 'a'"),
        (list(right), unread.format("TypeError: it is a list")),
        (
            (build, [first]),
            unread.format("ValueError: zip() argument 2 is shorter than argument 1"),
        ),
        (
            (build, [second, first]),
            unread.format(f"ValueError: it is of the run {other}, not {own}"),
        ),
        (
            (build, [first, (second[0], None)]),
            unread.format("ValueError: the worker was interrupted"),
        ),
        (changed(right, metrics=less), unread.format("ValueError: its figures are others")),
        (changed(right, metrics=whole), unread.format("ValueError: its figures are others")),
        (changed(right, wall_time=1), unread.format("ValueError: its figures are others")),
        (changed(right, outcome="x"), unread.format("ValueError: 'x' is not a valid Outcome")),
    ):
        with pytest.raises(collect._LostTask) as caught:
            collect._read_answer(answered(answer), RUNS, BUILD)
        assert str(caught.value) == why
    cancelled: Future[Any] = Future()
    cancelled.cancel()
    with pytest.raises(collect._LostTask, match=r"^its executor cancelled it$"):
        collect._read_answer(cancelled, RUNS, BUILD)


def test_an_answer_of_another_build_is_no_lost_task() -> None:
    words = rf"^a worker has another build of crawler2d \(b, not {BUILD}\)$"
    with pytest.raises(c2d.errors.InternalError, match=words):
        collect._read_answer(answered(("b", [])), RUNS, BUILD)


def test_a_run_that_is_not_finished_says_so() -> None:
    broken = c2d.ScenarioError("a", 1, "must be 2")
    batch = collect.Batch([RUNS[0], broken, RUNS[1], RUNS[0]])
    assert batch.done == 1
    assert [each.identity for each in batch.missing] == [each.identity for each in RUNS]
    _, answers = collect.simulate_chunk([RUNS[0].text], (), BUILD)
    assert batch.take([collect._read_row(RUNS[0], *answers[0])]) == 2
    assert batch.done == 3
    assert [each.identity for each in batch.missing] == [RUNS[1].identity]
    rows = batch.rows()
    assert [row.outcome for row in rows] == ["timed_out", "refused", "failed", "timed_out"]
    assert str(rows[2].error) == "the batch was interrupted before this run had ended"
    runs = collect.runs_of(rows)
    assert [run.error is None for run in runs] == [True, False, True]
    assert [run.scenario.duration for run in runs] == [0.05, 0.06, 0.05]


def test_the_run_of_a_row_has_all_that_the_row_has() -> None:
    wheels = c2d.robots.engineer(flippers=None, track=c2d.LineOfWheels(4))
    stuck = _core.PreparedScenario(c2d.Scenario(wheels, c2d.terrains.step(0.1)).to_json())
    _, answers = collect.simulate_chunk([stuck.text], ("torque x 2",), BUILD)
    row = collect._read_row(stuck, *answers[0])
    (run,) = collect.runs_of([row])
    again = c2d.simulate(
        c2d.Scenario.from_json(stuck.text), trials=("torque x 2",), record="summary"
    )
    assert run.outcome == again.outcome == row.outcome == "seized"
    assert run.metrics == again.metrics == row.metrics
    assert str(run.diagnosis) == str(again.diagnosis)
    assert run.diagnosis is not None
    assert any(trial.name == "torque x 2" for trial in run.diagnosis.trials)
    assert run.wall_time == row.wall_time > 0.0
