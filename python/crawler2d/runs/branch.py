"""Branches of a run: continue from an instant with something changed, as trials do."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, fields
from functools import cached_property
from typing import TYPE_CHECKING, Any, Generic, Literal, NamedTuple, Self, TypeVar

from crawler2d import _core
from crawler2d.common.arrays import real_number
from crawler2d.common.keywords import read_choice
from crawler2d.errors import ScenarioError
from crawler2d.parameters.scenario import Scenario
from crawler2d.parameters.track import ClosedTrack
from crawler2d.results.findings import TrialResult
from crawler2d.results.record import Record
from crawler2d.variation.draws import fields_at

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from crawler2d.parameters.settings import Drive
    from crawler2d.parameters.track import Track

__all__ = [
    "EscapeForce",
    "RecordMode",
    "Trial",
    "Trials",
    "branch_scenario",
    "branch_time",
    "check_recording",
    "read_push",
    "refuse_unrepeatable",
    "refuse_without_result",
    "run_of_trial",
    "simulate_branch",
    "stop_time",
    "trial_at",
    "trial_names",
    "trials_at",
    "try_variant",
]

RecordMode = Literal["full", "summary"]


def check_recording(sample_interval: object, record: object) -> tuple[float, str]:
    """Check the arguments that select what to keep of a run."""
    mode = read_choice(record, "record", ("full", "summary"))
    return real_number(sample_interval, "sample_interval"), mode


Trials = Literal["auto", "all"] | Sequence[str] | None
R = TypeVar("R", bound=Record)

_ALL = tuple(_core.kinds()["trial"])
_SETS = {"auto": ("torque x 2", "friction x 2"), "all": _ALL}


def trial_names(trials: Trials) -> tuple[str, ...]:
    """List the requested trials; those that decide the outcome are always made."""
    if trials is None:
        return ()
    if isinstance(trials, str) and trials in _SETS:
        return _SETS[trials]
    if isinstance(trials, str) or not isinstance(trials, Sequence):
        rule = 'must be "auto", "all", None or a sequence of names'
        raise ScenarioError("trials", trials, rule)
    return tuple(read_choice(name, "trials", _ALL) for name in trials)


@dataclass(frozen=True, kw_only=True, eq=False)
class Trial(TrialResult, Generic[R]):
    """The result of one change at a stop, and the run that shows it; see `Run.trials`.

    A trial changes one thing in the pose of the stop and drives on, for `criteria.escape_time` plus
    the time needed to drive `criteria.escape_distance` as commanded; or it restarts the run.
    Torque, friction, belly and a push leave the rest of the state unchanged. Another track takes
    over pose and speeds; ground inside it is released without pushing the robot.

    Attributes
    ----------
    name, freed, starts, freeing, distance, time, outcome, jammed, intrusion, duration
        See `TrialResult`.
    position, chassis_angle, flipper_angles
        See `TrialResult`.
    run : Run
        The run from the instant of the stop on. If the robot rattles and is tried from several
        instants, the first that ended like most of them. Simulated again on first access.
    """

    simulate: Callable[[], R] = field(repr=False)

    def __repr__(self) -> str:
        """Show what was changed and how it ended, in one line."""
        end = "jammed" if self.jammed else str(self.outcome).replace("_", " ")
        how = f"free after {self.time:.1f} s, then {end}" if self.freed else end
        return f"Trial({self.name}: {how})"

    @classmethod
    def of(cls, result: TrialResult, simulate: Callable[[], R]) -> Trial[R]:
        """Add a function that simulates the run."""
        values = {each.name: getattr(result, each.name) for each in fields(TrialResult)}
        return cls(**values, simulate=simulate)

    @cached_property
    def run(self) -> R:
        """The run behind the result."""
        return self.simulate()


class EscapeForce(NamedTuple("_Levels", [("low", float), ("high", float)])):
    """The push in the commanded direction that frees a robot; see `Run.escape_force`.

    Attributes
    ----------
    low : float
        [N] The last level that did not free it; 0 if the first did.
    high : float
        [N] The first level that moved it `criteria.escape_distance` beyond its greatest x so far;
        inf if ten weights were not enough.
    tips : bool
        Whether that push tipped it over within two seconds.
    """

    tips: bool = False

    def __new__(cls, low: float, high: float, tips: bool = False) -> Self:
        """Keep the two levels as a tuple."""
        levels = super().__new__(cls, low, high)
        levels.tips = tips
        return levels


def trials_at(run: Record, time: float, names: tuple[str, ...]) -> tuple[TrialResult, ...]:
    """Make trials at a stop, without those that change nothing on the robot."""
    results = _core.trials(run.scenario.to_json(), time, list(names))
    return tuple(map(TrialResult.from_core, results))


def trial_at(run: Record, time: float, name: str) -> TrialResult:
    """Make one trial at a stop."""
    results = trials_at(run, time, (read_choice(name, "name", _ALL),))
    if not results:
        raise ScenarioError("name", name, "must be a trial that changes something on the robot")
    return results[0]


def run_of_trial(run: Record, time: float, name: str) -> tuple[Scenario, dict[str, Any]]:
    """Simulate a trial again, with its history."""
    simulated = _core.run_of_trial(run.scenario.to_json(), time, name, 0.01, "full")
    assert simulated is not None  # it was made, so it changes something on the robot
    text, result = simulated
    return Scenario.from_json(text), result


def try_variant(
    run: Record, time: float, variant: Scenario, push: tuple[float, float]
) -> tuple[TrialResult, int]:
    """Continue from a stop as another scenario; also return the start of that run."""
    found = _core.what_if(run.scenario.to_json(), time, variant.to_json(), push)
    if found is None:
        raise ScenarioError("run", run, "must have stopped")
    result, start = found
    return TrialResult.from_core(result), start


def refuse_without_result(run: Record) -> None:
    """Refuse a run that ended with an error, or that its scenario does not define."""
    if run.parent is not None:
        rule = "must not be a branch or a run of a Simulation: take the original run"
        raise ScenarioError("run", run, rule)
    if run.error is not None:
        raise ScenarioError("run", run, f"must have a result, not the error {run.error}")


def branch_time(run: Record, at: float | str) -> float:
    """[s] Read `at`: a time of the run, or the stop it ended in."""
    refuse_unrepeatable(run)
    end = run.metrics["time"]
    if isinstance(at, str) and at == "stop":
        if run.diagnosis is None:
            rule = f"must be a time from 0 to {end:.6g} s: the run ended as {run.outcome}"
            raise ScenarioError("at", at, rule)
        return run.diagnosis.time
    try:
        time = real_number(at, "at")
    except ScenarioError:
        time = math.nan
    if not 0.0 <= time <= end:
        raise ScenarioError("at", at, f'must be "stop" or a time from 0 to {end:.6g} s')
    return time


def stop_time(run: Record) -> float:
    """[s] The stop that a run ended in."""
    refuse_unrepeatable(run)
    if run.diagnosis is None:
        rule = f"must have ended in a stop, not as {run.outcome}: `reason` says why it ended"
        raise ScenarioError("run", run, rule)
    return run.diagnosis.time


def refuse_unrepeatable(run: Record) -> None:
    """Refuse a run that cannot be repeated bit by bit."""
    refuse_without_result(run)
    build = _core.build_info()["build_id"]
    if run.build["build_id"] != build:
        rule = (
            f"must be of this build, {build}, to be repeated, not of {run.build['build_id']}:"
            " simulate(run.scenario) makes such a run"
        )
        raise ScenarioError("run", run, rule)


def branch_scenario(
    run: Record,
    *,
    track: Track | Literal["closed"] | None,
    friction: float | None,
    max_torque: float | None,
    belly: ArrayLike | Literal["built"] | None,
    drive: Drive | None,
    duration: float | None,
) -> Scenario:
    """Change the given fields of a run's scenario; branches always use our own dynamics."""
    robot = run.scenario.robot
    if track == "closed":
        own = robot.track
        track = own if isinstance(own, ClosedTrack) else ClosedTrack(own)
    grounds = fields_at(run.scenario, "terrain.friction")
    changes = {
        "robot": None if track is None else robot.with_track(track),
        **dict.fromkeys(grounds, friction),
        "robot.drivetrain.max_torque": max_torque,
        "drive": drive,
        "duration": duration,
    }
    given: dict[str, Any] = {path: value for path, value in changes.items() if value is not None}
    if not (isinstance(belly, str) and belly == "built"):
        given["robot.belly"] = belly
    if run.scenario.solver.engine != "own":
        given["solver.engine"] = "own"
    return run.scenario.replace(given)


def simulate_branch(
    run: Record,
    time: float,
    variant: Scenario,
    *,
    push: tuple[float, float] | None,
    record: RecordMode,
    sample_interval: float,
    start: int | None = None,
) -> dict[str, Any]:
    """Repeat the run up to a time, or to the start of a trial, and continue as another scenario."""
    kept = check_recording(sample_interval, record)
    text, place = variant.to_json(), (time, start)
    return _core.branch(run.scenario.to_json(), place, text, read_push(push), *kept)


def read_push(push: tuple[float, float] | None) -> tuple[float, float]:
    """Read a force and its rise time; None is a force of 0."""
    if push is None:
        return 0.0, 0.0
    if not isinstance(push, tuple) or len(push) != 2:
        raise ScenarioError("push", push, "must be a tuple of a force and a time")
    return real_number(push[0], "push"), real_number(push[1], "push.rise_time")
