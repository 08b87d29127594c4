"""What a simulated second costs in each engine, in one sitting."""

from __future__ import annotations

import json
import time
from pathlib import Path

from benches.engines.cells import Cell
from benches.engines.driving import driven
from benches.engines.engines import ENGINES, engine_of
from benches.engines.own import has_rapier, simulated
from benches.engines.telling import tell
from research.markdown import markdown_table

__all__ = ["measure", "table"]

_REPEATS, _ENOUGH = 3, 20.0  # runs, or [s] after which no more are made
_MODELS = ("line of 3", "5 gears", "24 all round")
_FILE = "costs.json"


def measure(folder: Path) -> None:
    """Time runs of three models over an edge in every engine that is here, the best of up to three.

    A run's time contains building its world, and in ODE starting the process.
    """
    path = folder / _FILE
    path.parent.mkdir(parents=True, exist_ok=True)
    found: dict[str, dict[str, float]] = {}
    for model in _MODELS:
        cell = Cell(
            group="plane",
            robot="engineer",
            model=model,
            drive="60 N m, servos",
            ground="step",
            height=0.04,
            friction=1.0,
        )
        (scenario,) = cell.scenarios(1)
        for name in ("crawler2d", *ENGINES):
            if name == "rapier" and not has_rapier():
                continue
            times: list[float] = []
            begun = time.perf_counter()
            while len(times) < _REPEATS and time.perf_counter() - begun < _ENOUGH:
                if name in ("crawler2d", "rapier"):
                    run = simulated(scenario, None if name == "crawler2d" else name)
                else:
                    try:
                        run = driven(engine_of(name), scenario)
                    except ImportError:
                        break
                times.append(run["cost"])
            if times:
                found.setdefault(name, {})[model] = min(times)
                tell(f"{name}, {model}: {min(times):g} s a simulated second")
                path.write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")


def table(folder: Path) -> str:
    """Return the costs in milliseconds a simulated second."""
    path = folder / _FILE
    if not path.exists():
        return "Not measured."
    found = json.loads(path.read_text(encoding="utf-8"))
    rows = [
        [name, *(f"{1e3 * costs[model]:.3g}" if model in costs else "" for model in _MODELS)]
        for name, costs in found.items()
    ]
    return markdown_table(["ms a simulated second", *_MODELS], rows)
