"""24 wheels all round on a knife edge that gets between two of them, solved in six ways."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np

import crawler2d as c2d
from benches.agreement.passing import counts, who_gets_over
from benches.engines.telling import tell
from crawler2d.parameters.scenario import Scenario
from crawler2d.parameters.settings import Solver
from research.markdown import markdown_table

__all__ = ["PINCHED", "pinched", "pinched_table"]

PINCHED = Path(__file__).with_name("pinched.json")
_SOLVERS = {
    "own": Solver(),
    "own, fixed steps": Solver(time_step=5e-5),
    "own, restitution 0.5": Solver(restitution=0.5),
    "own, restitution 1": Solver(restitution=1.0),
    "rapier": Solver(engine="rapier"),
}
_HEIGHTS = (0.02, 0.04, 0.06)  # [m]
_SPEEDS = (0.4, 0.05)  # [m/s]
_APPROACH, _SPREAD = 0.1, 0.03  # [m] over which the starts are drawn
_SEED = 3


def pinched(starts: int, path: Path = PINCHED) -> None:
    """Make the runs of each cell, and keep which of them get over.

    Raises
    ------
    ImportError
        If pymunk is missing.
    """
    rng = np.random.default_rng(_SEED)
    found = []
    for height in _HEIGHTS:
        for speed in _SPEEDS:
            starting = _APPROACH + _SPREAD * rng.random(starts)
            over = [_scenario(height, speed, float(approach)) for approach in starting]
            gets = who_gets_over(over, _SOLVERS)
            found.append({"height": height, "speed": speed, "gets_over": gets})
            tell(f"knife edge of {1e3 * height:.0f} mm at {speed} m/s")
    path.write_text(json.dumps(found) + "\n", encoding="utf-8")


def _scenario(height: float, speed: float, approach: float) -> Scenario:
    robot = c2d.robots.engineer(flippers=None).without_rotors()
    edge = c2d.terrains.knife_edge(height, thickness=0.01, friction=0.9)
    start = c2d.Start(approach=approach)
    small_wheels = robot.with_track(c2d.CircumferentialWheels(24))
    return Scenario(small_wheels, edge, drive=c2d.Drive(speed=speed), start=start)


def pinched_table(path: Path = PINCHED) -> str:
    """Write how many runs of each cell get over."""
    if not path.exists():
        return "Not tried."
    found: list[dict[str, Any]] = json.loads(path.read_text(encoding="utf-8"))
    names = list(found[0]["gets_over"])
    rows = [
        (
            f"{1e3 * cell['height']:.0f}",
            str(cell["speed"]),
            *counts(cell["gets_over"]),
        )
        for cell in found
    ]
    return markdown_table(("knife edge [mm]", "speed [m/s]", *names), rows)
