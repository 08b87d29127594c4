"""What crawler2d says will happen, written down before the engines run."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from benches.models.cases import Case
from crawler2d.audits.audit import audit
from crawler2d.parameters.robot import Robot
from crawler2d.parameters.scenario import Scenario
from crawler2d.parameters.terrain import Flat, Terrain
from crawler2d.runs.batch import simulate_many
from crawler2d.variation.variability import of_start

__all__ = ["PREDICTIONS", "predicted", "robot_of"]

PREDICTIONS = Path(__file__).with_name("predictions.json")


def predicted(case: Case, threads: int | None) -> dict[str, Any]:
    """Search for a repair under the conditions of a case, and drive both robots from its starts.

    Returns
    -------
    dict
        By model, "original" and "repair": what it is, the robot in a scenario on level ground, and
        by obstacle one entry for each start: outcome, mechanism, the wheels between which ground is held, and the last
        place of the chassis frame [m].
    """
    own = case.robot()
    grounds = case.obstacles(own)
    drive = case.drive(own, next(iter(grounds.values())))
    found = audit(
        own, grounds, drive=drive, unknown={}, vary=of_start(), repeats=20, threads=threads
    )
    repair = next(each for each in found.repairs if each.kind == "wheels")
    models = {"original": ("as it is", own), "repair": (repair.what, repair.robot)}
    return {
        name: {
            "what": what,
            "scenario": json.loads(Scenario(robot, Flat()).to_json()),
            "confirmed": name == "original" or repair.confirmed,
            "runs": {label: _runs(case, robot, ground) for label, ground in grounds.items()},
        }
        for name, (what, robot) in models.items()
    }


def robot_of(entry: dict[str, Any]) -> Robot:
    """Return the robot of an entry of the predictions."""
    return Scenario.from_json(json.dumps(entry["scenario"])).robot


def _runs(case: Case, robot: Robot, ground: Terrain) -> list[dict[str, Any]]:
    runs = simulate_many(case.scenarios(robot, ground), record="summary", threads=1)
    return [
        {
            "end": str(run.outcome),
            "mechanism": str(run.mechanism or ""),
            "x": round(run.metrics["final_x"], 4),
            "y": round(run.metrics["final_y"], 4),
            "angle": round(run.metrics["final_angle"], 4),
        }
        for run in runs
    ]
