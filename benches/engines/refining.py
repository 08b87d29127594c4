"""Runs in which crawler2d and a fine engine differ, made again with finer steps in both."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from benches.engines.agreement import pairs
from benches.engines.cells import Cell
from benches.engines.convergence import LADDERS
from benches.engines.driving import driven
from benches.engines.engines import FINE
from benches.engines.own import simulated
from benches.engines.predict import read
from benches.engines.running import results_of
from benches.engines.telling import tell
from crawler2d.reports.markdown import markdown_table

__all__ = ["refine", "table"]

_FILE = "refined.json"
_ACCURACY = 3e-8  # [m] a tenth of the default


def refine(cells: Sequence[Cell], folder: Path, most: int) -> None:
    """Make runs that differ again, at the finest setting of the ladder and at a tenth of accuracy.

    Runs that were made again are not made once more.

    Parameters
    ----------
    cells : sequence of Cell
        Which to look at.
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
    for name in FINE:
        ladder = LADDERS.get(name.removesuffix("-fine"))
        results = results_of(name, folder)
        if ladder is None or results is None:
            continue
        *_, engine = ladder().values()
        for cell in cells:
            made = found.setdefault(name, {}).setdefault(cell.label, {})
            scenarios = cell.scenarios()
            for number, (_, one, other) in enumerate(pairs([cell], predicted, results["runs"])):
                differs = (one["end"] == "cleared") != (other["end"] == "cleared")
                if not differs or str(number) in made or len(made) >= most:
                    continue
                scenario = scenarios[number]
                own = simulated(scenario.replace({"solver.accuracy": _ACCURACY}))
                again = driven(engine, scenario)
                made[str(number)] = [one["end"], other["end"], own["end"], again["end"]]
                tell(f"{name}, {cell.label}: {', '.join(made[str(number)])}")
                path.write_text(json.dumps(found) + "\n", encoding="utf-8")


def table(folder: Path) -> str:
    """Return who came over to whom, by engine."""
    path = folder / _FILE
    if not path.exists():
        return "Not tried."
    rows = []
    for name, cells in json.loads(path.read_text(encoding="utf-8")).items():
        runs = [
            [end == "cleared" for end in ends] for made in cells.values() for ends in made.values()
        ]
        now = sum(own == again for _, _, own, again in runs)
        ours = sum(own != before for before, _, own, _ in runs)
        theirs = sum(again != before for _, before, _, again in runs)
        rows.append([name, str(len(runs)), str(now), str(theirs), str(ours)])
    head = ["engine", "differing runs refined", "equal then", "the engine changed"]
    return markdown_table([*head, "crawler2d changed"], rows)
