"""The cells of the seizure study that rapier holds, in both engines with the same draws."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np

import crawler2d as c2d
from crawler2d.parameters.scenario import Scenario
from crawler2d.parameters.track import Track
from crawler2d.sweeps.statistics import newcombe_paired
from research.markdown import markdown_table
from research.models import study_models
from research.sweeps import FULL

__all__ = ["STUDY", "at_height", "read_cells", "study", "study_shares", "study_table"]

STUDY = Path(__file__).with_name("study.json")
_ENGINES = ["own", "rapier"]
_FRICTION = 0.9  # of the study
_THICKNESS = {"barrier": 0.1, "knife edge": 0.01}  # [m] likewise


def study(repeats: int, path: Path = STUDY) -> None:
    """Make the runs of every obstacle, and keep what came of each cell."""
    robot = c2d.robots.engineer(flippers=None).without_rotors()
    found = json.loads(path.read_text(encoding="utf-8")) if path.exists() else []
    for obstacle, heights in list(FULL.heights.items())[len(found) :]:
        base = _on(robot, obstacle, heights[0])
        over = {
            "robot.track": _tracks(robot.outline.axle_distance),
            "terrain.height": list(heights),
            "solver.engine": _ENGINES,
        }
        found.append(_cells(obstacle, c2d.sweep(base, over, repeats=repeats)))
        path.write_text(json.dumps(found) + "\n", encoding="utf-8")


def read_cells(path: Path = STUDY) -> list[dict[str, Any]]:
    """Read what came of each cell."""
    return [cell for part in json.loads(path.read_text(encoding="utf-8")) for cell in part]


def at_height(model: str, obstacle: str, height: float) -> Scenario:
    """Give the scenario of a cell, before its draws."""
    robot = c2d.robots.engineer(flippers=None).without_rotors()
    track = _tracks(robot.outline.axle_distance)[model]
    return _on(robot.with_track(track), obstacle, height)


def _on(robot: c2d.Robot, obstacle: str, height: float) -> Scenario:
    return Scenario(robot, _ground(obstacle, height), drive=c2d.Drive(speed=0.4))


def _ground(obstacle: str, height: float) -> Any:
    if obstacle == "step":
        return c2d.terrains.step(height, friction=_FRICTION)
    return c2d.terrains.barrier(height, _THICKNESS[obstacle], friction=_FRICTION)


def _tracks(axle_distance: float) -> dict[str, Track]:
    """List the models that rapier holds on one motor for all wheels, as the study has them."""
    robot = c2d.robots.engineer(flippers=None).without_rotors()
    in_rapier = c2d.Scenario(
        robot, c2d.terrains.step(0.05), solver=c2d.Solver(engine="rapier")
    ).replace
    held = {}
    for name, model in study_models(axle_distance).items():
        try:
            in_rapier({"robot.track": model.track}).validate()
        except c2d.ScenarioError:
            continue
        held[name] = model.track
    return held


def _cells(obstacle: str, table: Any) -> list[dict[str, Any]]:
    """Keep outcomes and last poses, by model and height."""
    cells = []
    for model in table["track"].values.tolist():
        for height in table["height"].values.tolist():
            here = table.sel(track=model, height=height)
            pair = [here.sel(engine=engine) for engine in _ENGINES]
            poses = [
                np.stack([each[name].values for name in ("final_x", "final_y")]) for each in pair
            ]
            cells.append(
                {
                    "obstacle": obstacle,
                    "model": model,
                    "height": height,
                    "ends": [each["outcome"].values.tolist() for each in pair],
                    "apart": np.hypot(*(poses[1] - poses[0])).tolist(),
                }
            )
    return cells


def study_table(path: Path = STUDY) -> str:
    """Write how runs ended alike, and how far stops are apart, by model."""
    if not path.exists():
        return "Not tried."
    cells = read_cells(path)
    head = (
        *("model", "runs", "same: gets over or not", "same outcome", "get over: own, rapier"),
        *("difference of rates [%]", "both stop", "apart [mm]: median, 90th"),
    )
    models = list(dict.fromkeys(cell["model"] for cell in cells))
    groups = [(model, [c for c in cells if c["model"] == model]) for model in models]
    return markdown_table(head, [_row(*group) for group in [*groups, ("all", cells)]])


def study_shares(path: Path = STUDY) -> dict[str, dict[str, float]]:
    """Return by model in how many runs [%] each engine gets over, and how many end alike."""
    found = {}
    cells = read_cells(path)
    for model in dict.fromkeys(cell["model"] for cell in cells):
        runs = [
            [end == "cleared" for end in ends]
            for cell in cells
            if cell["model"] == model
            for ends in zip(*cell["ends"], strict=True)
        ]
        over = {
            f"get over in {name}": 100.0 * sum(column) / len(runs)
            for name, column in zip(("crawler2d", "rapier"), zip(*runs, strict=True), strict=True)
        }
        alike = 100.0 * sum(own == other for own, other in runs) / len(runs)
        found[model] = {**over, "end alike": alike}
    return found


def _row(name: str, cells: list[dict[str, Any]]) -> tuple[str, ...]:
    runs = [
        (own, other, apart)
        for cell in cells
        for own, other, apart in zip(*cell["ends"], cell["apart"], strict=True)
    ]
    stops = [1e3 * apart for own, other, apart in runs if _stops(own) and _stops(other)]
    gets = [(own == "cleared", other == "cleared") for own, other, _ in runs]
    both, neither = gets.count((True, True)), gets.count((False, False))
    gap = newcombe_paired(both, gets.count((False, True)), gets.count((True, False)), neither)
    spread = "{:.2g}, {:.2g}".format(*np.quantile(stops, (0.5, 0.9))) if stops else ""
    return (
        name,
        str(len(runs)),
        str(sum(own == other for own, other in gets)),
        str(sum(own == other for own, other, _ in runs)),
        f"{sum(own for own, _ in gets)}, {sum(other for _, other in gets)}",
        f"{100 * gap.low:+.0f} to {100 * gap.high:+.0f}",
        str(len(stops)),
        spread,
    )


def _stops(outcome: str) -> bool:
    return outcome in ("seized", "stalled", "slipping", "hung_up", "cycling")
