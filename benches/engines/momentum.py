"""The same stop at several speeds, from which on a robot is carried past it."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from benches.engines.agreement import cleared
from benches.engines.cells import Cell
from benches.engines.driving import driven
from benches.engines.engines import engine_of
from benches.engines.own import simulated
from benches.engines.telling import tell
from research.markdown import markdown_table

__all__ = ["SPEEDS", "speed_up", "table"]

SPEEDS = (0.02, 0.05, 0.1, 0.2, 0.3, 0.4)
"""[m/s]"""

_FILE = "momentum.json"
_WAY = 2.0  # [m] driven in the longest time
_WAIT = 5.0  # [s] longer, so that a stop is seen


def speed_up(cell: Cell, engines: Sequence[str], starts: int, folder: Path) -> None:
    """Make the first runs of a cell at each speed, in crawler2d and in engines."""
    path = folder / _FILE
    found: dict[str, Any] = {}
    if path.exists():
        found = json.loads(path.read_text(encoding="utf-8"))
    for name in ("crawler2d", *engines):
        for speed in SPEEDS:
            runs = (
                found.setdefault(cell.label, {}).setdefault(name, {}).setdefault(f"{speed:g}", [])
            )
            for scenario in cell.scenarios(starts)[len(runs) :]:
                changed = scenario.replace(
                    {"drive.speed": speed, "duration": round(_WAY / speed + _WAIT, 1)}
                )
                is_own = name == "crawler2d"
                runs.append(simulated(changed) if is_own else driven(engine_of(name), changed))
            tell(f"{name}, {speed:g} m/s: {cleared(runs)} of {len(runs)} clear")
            path.write_text(json.dumps(found) + "\n", encoding="utf-8")


def table(folder: Path) -> str:
    """Return how many runs clear at each speed, and where the others stop."""
    path = folder / _FILE
    if not path.exists():
        return "Not tried."
    rows = []
    for label, engines in json.loads(path.read_text(encoding="utf-8")).items():
        for name, speeds in engines.items():
            row = [label, name]
            for runs in speeds.values():
                places = sorted(1e3 * run["x"] for run in runs if run["end"] != "cleared")
                where = f", {places[0]:.1f} to {places[-1]:.1f} mm" if places else ""
                row.append(f"{cleared(runs)}/{len(runs)}{where}")
            rows.append(row)
    return markdown_table(["cell", "engine", *(f"{speed:g} m/s" for speed in SPEEDS)], rows)
