"""Errors have one base class, and lose nothing on the way to another process."""

import pickle

import pytest

import crawler2d as c2d
from crawler2d import errors

EXAMPLES = [
    errors.Crawler2dError("text"),
    errors.ScenarioError("robot.mass", -1.0, "must be > 0 kg"),
    errors.SimulationDiverged("chassis is not finite", step=7, body="chassis"),
    errors.SimulationDiverged("unknown place"),
    errors.RunUnfinished("interrupted"),
    errors.LimitError("too many"),
    errors.InternalError("a fault"),
]


@pytest.mark.parametrize("error", EXAMPLES, ids=lambda e: type(e).__name__)
def test_an_error_survives_pickling_with_text_and_attributes(error: Exception) -> None:
    copy = pickle.loads(pickle.dumps(error))
    assert type(copy) is type(error)
    assert str(copy) == str(error)
    assert copy.args == error.args
    assert vars(copy) == vars(error)


def test_an_interrupt_survives_pickling_with_its_runs(run: c2d.Run) -> None:
    refused = c2d.Run(run.scenario, {}, errors.ScenarioError("gravity", -1.0, "must be > 0 m/s^2"))
    rest = c2d.Run(run.scenario, {}, c2d.RunUnfinished("interrupted"))
    copy = pickle.loads(pickle.dumps(c2d.BatchInterrupted([run, rest, refused])))
    assert str(copy) == "interrupted after 2 of 3 runs; .runs holds them"
    assert copy.runs[0].outcome == run.outcome
    assert copy.runs[1].scenario == run.scenario
    assert isinstance(copy.runs[1].error, c2d.RunUnfinished)


def test_every_error_derives_from_the_base_and_from_its_python_counterpart() -> None:
    kinds: dict[type[Exception], type[Exception]] = {
        errors.ScenarioError: ValueError,
        errors.SimulationDiverged: RuntimeError,
        errors.RunUnfinished: RuntimeError,
        errors.LimitError: ValueError,
        errors.InternalError: RuntimeError,
    }
    for error, builtin in kinds.items():
        assert issubclass(error, errors.Crawler2dError)
        assert issubclass(error, builtin)


def test_an_interrupt_is_not_caught_as_an_exception() -> None:
    assert issubclass(c2d.BatchInterrupted, KeyboardInterrupt)
    assert not issubclass(c2d.BatchInterrupted, Exception)


def test_a_scenario_error_names_path_rule_and_value() -> None:
    error = errors.ScenarioError("robot.track.count", 1, "must be at least 2")
    assert str(error) == "robot.track.count must be at least 2, got 1"
    assert (error.path, error.value, error.rule) == ("robot.track.count", 1, "must be at least 2")


def test_a_scenario_error_keeps_a_strange_value_as_short_text() -> None:
    error = errors.ScenarioError("robot", [lambda: None] * 1000, "must be a Robot")
    assert isinstance(error.value, str)
    assert len(str(error)) < 300
    pickle.dumps(error)
