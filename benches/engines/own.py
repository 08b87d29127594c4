"""crawler2d itself: its own dynamics, or those of another engine behind the same door."""

from __future__ import annotations

import time
from dataclasses import fields
from typing import Any

from crawler2d.errors import ScenarioError
from crawler2d.parameters.scenario import Scenario
from crawler2d.parameters.settings import Solver
from crawler2d.runs.batch import simulate_many

__all__ = ["has_rapier", "simulated"]


def has_rapier() -> bool:
    """Whether `Solver` has other engines."""
    return "engine" in {field.name for field in fields(Solver)}


def simulated(scenario: Scenario, engine: str | None = None) -> dict[str, Any]:
    """Simulate a scenario.

    Parameters
    ----------
    scenario : Scenario
        What.
    engine : str, optional
        Of `Solver`; None takes its default.

    Returns
    -------
    dict
        As of `driven`, "end" being the outcome, with the mechanism of a stop and no heading; one
        that is refused ends so, with the path of the field.
    """
    if engine is not None:
        scenario = scenario.replace({"solver.engine": engine})
    begun = time.perf_counter()
    try:
        (run,) = simulate_many([scenario], record="summary", threads=1)
    except ScenarioError as error:
        return {"end": f"refused: {error.path}"}
    took, lasted = time.perf_counter() - begun, run.metrics["time"]
    return {
        "end": str(run.outcome),
        "mechanism": str(run.mechanism or ""),
        "time": round(lasted, 3),
        "x": round(run.metrics["final_x"], 5),
        "y": round(run.metrics["final_y"], 5),
        "angle": round(run.metrics["final_angle"], 5),
        "yaw": 0.0,
        "roll": 0.0,
        "cost": round(took / lasted, 4),
    }
