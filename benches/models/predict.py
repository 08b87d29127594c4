"""What crawler2d says will happen, written down before the engines run."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from benches.models.cases import Case
from crawler2d.audits.audit import audit
from crawler2d.parameters.robot import Robot
from crawler2d.parameters.scenario import Scenario
from crawler2d.parameters.terrain import Flat
from crawler2d.runs.batch import simulate_many
from crawler2d.variation.variability import of_start

__all__ = ["PREDICTIONS", "predicted", "robot_of"]

PREDICTIONS = Path(__file__).with_name("predictions.json")


def predicted(case: Case, threads: int | None) -> dict[str, Any]:
    """Search for a repair under the conditions of a case, and drive both robots from its starts.

    The search is over the cells at the speed of an audit.

    Returns
    -------
    dict
        By model, "original" and, where one was found, "repair": what it is, the robot in a scenario
        on level ground, and by cell one entry for each start: outcome, mechanism, and the last pose
        of the chassis frame [m, rad]; "runs" are those of the robot, "firm" those with motors that
        hold their speeds through impacts.
    """
    own = case.robot()
    usual = {label: cell for label, cell in case.cells.items() if cell.speed is None}
    grounds = {label: case.ground(cell, own) for label, cell in usual.items()}
    drive = case.drive(next(iter(usual.values())), own)
    found = audit(
        own, grounds, drive=drive, unknown={}, vary=of_start(), repeats=20, threads=threads
    )
    models = {"original": ("as it is", own, True)}
    repair = next((each for each in found.repairs if each.kind == "wheels"), None)
    if repair is not None:
        models["repair"] = (repair.what, repair.robot, repair.confirmed)
    return {
        name: {
            "what": what,
            "scenario": json.loads(Scenario(robot, Flat()).to_json()),
            "confirmed": confirmed,
            "runs": _by_cell(case, robot, threads),
            "firm": _by_cell(case, case.firm(robot), threads),
        }
        for name, (what, robot, confirmed) in models.items()
    }


def robot_of(entry: dict[str, Any]) -> Robot:
    """Return the robot of an entry of the predictions."""
    return Scenario.from_json(json.dumps(entry["scenario"])).robot


def _by_cell(case: Case, robot: Robot, threads: int | None) -> dict[str, Any]:
    return {label: _runs(case.scenarios(label, robot), threads) for label in case.cells}


def _runs(scenarios: list[Scenario], threads: int | None) -> list[dict[str, Any]]:
    runs = simulate_many(scenarios, record="summary", threads=threads)
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
