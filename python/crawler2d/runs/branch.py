"""Continue a run from one of its instants, with something changed."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, Literal

from crawler2d import _core
from crawler2d.common.arrays import real_number
from crawler2d.errors import ScenarioError
from crawler2d.parameters.track import ClosedTrack
from crawler2d.runs.recording import Recording, recording

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from crawler2d.parameters.scenario import Scenario
    from crawler2d.parameters.settings import Drive
    from crawler2d.parameters.track import Track
    from crawler2d.results.record import Record

__all__ = [
    "branch_scenario",
    "branch_time",
    "pushed",
    "refuse_without_result",
    "simulate_branch",
]


def refuse_without_result(run: Record) -> None:
    """Refuse a run that ended with an error, and a branch, whose scenario is not all of it."""
    if run.trunk is not None:
        raise ScenarioError("run", run, "must not be a branch itself: take the original run")
    if run.error is not None:
        raise ScenarioError("run", run, f"must have a result, but ended with: {run.error}")


def branch_time(run: Record, at: float | str) -> float:
    """[s] The instant given by `at`: a time of the run, or the stop it ended in."""
    refuse_without_result(run)
    if isinstance(at, str) and at == "stop":
        if run.diagnosis is None:
            ended = f"the run did not end in a stop, but {run.outcome}"
            rule = f"must be a time: {ended}; its `reason` says how"
            raise ScenarioError("at", at, rule)
        return run.diagnosis.time
    end = run.metrics["time"]
    try:
        time = real_number(at, "at")
    except ScenarioError:
        time = math.nan
    if not 0.0 <= time <= end:
        raise ScenarioError("at", at, f'must be "stop" or a time from 0 to {end:.6g} s')
    return time


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
    """Change the given fields of a run's scenario; our own dynamics move every branch."""
    changes = {
        "robot.track": _closed(run.scenario.robot.track) if track == "closed" else track,
        "terrain.friction": friction,
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


def _closed(track: Track) -> ClosedTrack:
    return track if isinstance(track, ClosedTrack) else ClosedTrack(track)


def simulate_branch(
    run: Record,
    time: float,
    variant: Scenario,
    *,
    push: tuple[float, float] | None,
    record: Recording,
    sample_interval: float,
) -> dict[str, Any]:
    """Repeat the run up to a time, and continue as another scenario."""
    recorded = recording(sample_interval, record)
    text, changed = run.scenario.to_json(), variant.to_json()
    return _core.branch(text, time, changed, pushed(push), *recorded)


def pushed(push: tuple[float, float] | None) -> tuple[float, float]:
    """Read a force and the time in which it rises; none is a force of 0."""
    if push is None:
        return 0.0, 0.0
    if not isinstance(push, tuple) or len(push) != 2:
        raise ScenarioError("push", push, "must be a tuple of a force and a time")
    return real_number(push[0], "push"), real_number(push[1], "push.rise_time")
