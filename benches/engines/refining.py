"""Runs in which crawler2d and a fine engine differ: finer in both, and from where it stops."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from benches.engines.agreement import Run, pairs
from benches.engines.cells import Cell
from benches.engines.convergence import LADDERS
from benches.engines.driving import driven, scene_of
from benches.engines.engine import Engine
from benches.engines.own import simulated
from benches.engines.predict import read
from benches.engines.running import results_of
from benches.engines.telling import tell
from crawler2d.parameters.scenario import Scenario
from crawler2d.parameters.settings import Solver
from research.markdown import markdown_table

__all__ = ["refine", "table"]

_FILE = "refined.json"
_ACCURACY = 3e-8  # [m] a tenth of the default
_RAPIER, _FINER_RAPIER = "rapier", Solver(engine="rapier", time_step=2e-5)
_STAYS = 0.02  # [m] from the pose of a stop


def refine(cells: Sequence[Cell], engines: Sequence[str], folder: Path, most: int) -> None:
    """Make runs that differ again, at the finest setting of the ladder and at a tenth of accuracy.

    Only on grounds that are the same across: on others the third dimension makes a difference.
    Where crawler2d stops on round wheels and the engine goes on, the engine also starts from rest
    in the pose of that stop: if it stays there, the stop is one in its mechanics, too, and the two
    differ in how the robot came by. Where gear wheels stand then, is not known.

    Runs that were made again are not made once more.

    Parameters
    ----------
    cells : sequence of Cell
        Which to look at.
    engines : sequence of str
        Names of fine ones.
    folder : Path
        Of the results.
    most : int
        Runs of a cell and an engine at most.
    """
    path = folder / _FILE
    found: dict[str, Any] = {}
    if path.exists():
        found = json.loads(path.read_text(encoding="utf-8"))
    predicted = read()
    for name in engines:
        ladder = LADDERS.get(name.removesuffix("-fine"))
        results = results_of(name, folder)
        if results is None or (ladder is None and name != _RAPIER):
            continue
        engine = None if ladder is None else [*ladder().values()][-1]
        for cell in (cell for cell in cells if cell.is_even):
            made = found.setdefault(name, {}).setdefault(cell.label, {})
            scenarios = cell.scenarios()
            for number, (_, one, other) in enumerate(pairs([cell], predicted, results["runs"])):
                differs = (one["end"] == "cleared") != (other["end"] == "cleared")
                if not differs or str(number) in made or len(made) >= most:
                    continue
                scenario = scenarios[number]
                own = simulated(scenario.replace({"solver.accuracy": _ACCURACY}))
                again = _finer_rapier(scenario) if engine is None else driven(engine, scenario)
                ends = [one["end"], other["end"], own["end"], again["end"]]
                made[str(number)] = [*ends, _from(engine, cell, scenario, one)]
                tell(f"{name}, {cell.label}: {', '.join(made[str(number)])}")
                path.write_text(json.dumps(found) + "\n", encoding="utf-8")


def table(folder: Path) -> str:
    """Return who came over to whom, by engine."""
    path = folder / _FILE
    if not path.exists():
        return "Not tried."
    rows = []
    for name, cells in json.loads(path.read_text(encoding="utf-8")).items():
        kept = [ends for made in cells.values() for ends in made.values()]
        runs = [[end == "cleared" for end in ends[:4]] for ends in kept]
        placed = [ends[4] for ends in kept if ends[4]]
        now = sum(own == again for _, _, own, again in runs)
        ours = sum(own != before for before, _, own, _ in runs)
        theirs = sum(again != before for _, before, _, again in runs)
        stays = f"{placed.count('stays')} of {len(placed)}" if placed else ""
        rows.append([name, str(len(runs)), str(now), str(theirs), str(ours), stays])
    head = ["engine", "differing runs refined", "equal then", "the engine changed"]
    return markdown_table([*head, "crawler2d changed", "stays in crawler2d's stop"], rows)


def _finer_rapier(scenario: Scenario) -> Run:
    return simulated(scenario.replace({"solver": _FINER_RAPIER}))


def _from(engine: Engine | None, cell: Cell, scenario: Scenario, stop: Run) -> str:
    """Return whether an engine "stays" in or "leaves" the pose of a stop, or "" if it is none.

    rapier, which crawler2d starts as the scenario says, is not asked.
    """
    if engine is None:
        return ""
    if "gears" in cell.model or stop["end"] not in ("seized", "stalled", "slipping", "hung_up"):
        return ""
    scene = replace(scene_of(scenario), x=stop["x"], z=stop["y"], angle=stop["angle"])
    found = driven(engine, scenario, scene)
    away = math.hypot(found["x"] - stop["x"], found["y"] - stop["y"])
    return "stays" if found["end"] == "stopped" and away < _STAYS else "leaves"
