"""Continue a run from one of its instants, with something changed."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from crawler2d import _core
from crawler2d.common.arrays import real_number
from crawler2d.errors import ScenarioError
from crawler2d.results.findings import Counterfactual
from crawler2d.runs.recording import Recording, recording, yes_or_no

if TYPE_CHECKING:
    from crawler2d.parameters.scenario import Scenario
    from crawler2d.results.record import Record

__all__ = ["branch_scenario", "branch_time", "simulate_branch", "try_belt"]


def branch_time(run: Record, at: float | str) -> float:
    """[s] The instant given by `at`: a time of the run, or the stop it ended in."""
    if run.trunk is not None:
        raise ScenarioError("run", run, "must not be a branch itself: branch the original run")
    if run.error is not None:
        raise ScenarioError("run", run, f"must have a result, but ended with: {run.error}")
    if isinstance(at, str) and at == "stop":
        if run.diagnosis is None:
            raise ScenarioError("at", at, "must be a time: the run did not end in a stop")
        return run.diagnosis.time
    end = run.metrics["time"]
    try:
        time = real_number(at, "at")
    except ScenarioError:
        time = math.nan
    if not 0.0 <= time <= end:
        raise ScenarioError("at", at, f'must be "stop" or a time from 0 to {end:.6g} s')
    return time


def branch_scenario(run: Record, changes: dict[str, Any]) -> Scenario:
    """Change the given fields of a run's scenario."""
    paths = {
        "track": "robot.track",
        "friction": "terrain.friction",
        "drive": "drive",
        "duration": "duration",
    }
    given = {paths[name]: value for name, value in changes.items() if value is not None}
    return run.scenario.replace(given)


def simulate_branch(
    run: Record, time: float, variant: Scenario, record: Recording, sample_interval: float
) -> dict[str, Any]:
    """Repeat the run up to a time, and continue as another scenario."""
    recorded = recording(sample_interval, record)
    return _core.branch(run.scenario.to_json(), time, variant.to_json(), *recorded)


def try_belt(run: Record, time: float, grousers: bool) -> Counterfactual:
    """Repeat the run up to a time, and try a closed belt there."""
    asked = yes_or_no(grousers, "grousers")
    return Counterfactual.from_core(_core.counterfactual(run.scenario.to_json(), time, asked))
