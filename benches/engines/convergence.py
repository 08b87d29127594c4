"""How fine is fine enough: the same runs at finer and finer settings of an engine."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from benches.engines.agreement import Run, cleared
from benches.engines.cells import Cell
from benches.engines.driving import driven
from benches.engines.engine import Engine
from benches.engines.predict import read
from benches.engines.telling import tell
from research.markdown import markdown_table

__all__ = ["FINER", "JAM", "LADDERS", "USUAL", "converge", "table"]


def _chipmunk(settings: Sequence[tuple[float, int]]) -> dict[str, Engine]:
    from benches.engines.engine_pymunk import Pymunk  # noqa: PLC0415 - loads Chipmunk

    return {
        f"{1e3 * step:g} ms, {many} iterations": Pymunk(step, iterations=many)
        for step, many in settings
    }


def _pymunk() -> dict[str, Engine]:
    return _chipmunk(((1e-3, 30), (5e-4, 60), (2.5e-4, 60), (1.25e-4, 120)))


def _finer() -> dict[str, Engine]:
    steps = (5e-4, 60), (1e-4, 100), (5e-5, 100), (2e-5, 100), (1e-5, 100), (1e-5, 300)
    return _chipmunk(steps)


def _ode() -> dict[str, Engine]:
    from benches.engines.engine_ode import Ode  # noqa: PLC0415 - asks for ODE
    from benches.models.ode_child import FINE, GAZEBO  # noqa: PLC0415 - only for ODE

    fine = {
        f"{1e3 * step:g} ms, {many} iterations": Ode(replace(FINE, time_step=step, iterations=many))
        for step, many in ((1e-3, 100), (5e-4, 150), (2.5e-4, 300), (1.25e-4, 300))
    }
    return {"Gazebo classic": Ode(GAZEBO), **fine}


def _bullet() -> dict[str, Engine]:
    from benches.engines.engine_bullet import (  # noqa: PLC0415 - loads Bullet
        PYBULLET,
        Bullet,
        Setting,
    )

    fine = {
        f"{1e3 * step:g} ms, {many} iterations": Bullet(
            Setting(time_step=step, iterations=many, is_default=False)
        )
        for step, many in ((2e-3, 100), (1e-3, 200), (5e-4, 200), (2.5e-4, 400))
    }
    return {"PyBullet": Bullet(PYBULLET), **fine}


def _dart() -> dict[str, Engine]:
    from benches.engines.engine_dart import GZ, Dart, Setting  # noqa: PLC0415 - loads DART

    fine = {
        f"{1e3 * step:g} ms, {sweeps} sweeps": Dart(Setting(time_step=step, sweeps=sweeps))
        for step, sweeps in ((1e-3, 100), (1e-3, 300), (5e-4, 300))
    }
    dantzig = {"0.25 ms, Dantzig": Dart(Setting(time_step=2.5e-4, sweeps=0))}
    return {"gz-sim": Dart(GZ), **dantzig, **fine}


LADDERS: Mapping[str, Callable[[], Mapping[str, Engine]]] = {
    "pymunk": _pymunk,
    "ode": _ode,
    "bullet": _bullet,
    "dart": _dart,
}
"""The settings of each engine by name, the finest last."""

FINER: Mapping[str, Callable[[], Mapping[str, Engine]]] = {"pymunk": _finer}
"""Those for stops that a robot is carried past."""

USUAL, JAM = "convergence.json", "jam.json"
"""Files in the folder of the results."""


def converge(
    ladder: Mapping[str, Engine], name: str, cells: Sequence[Cell], starts: int, path: Path
) -> None:
    """Make the first runs of cells at all settings of an engine, and keep them in a file."""
    found: dict[str, Any] = {}
    if path.exists():
        found = json.loads(path.read_text(encoding="utf-8"))
    for setting, engine in ladder.items():
        for cell in cells:
            runs = found.setdefault(name, {}).setdefault(setting, {}).setdefault(cell.label, [])
            for scenario in cell.scenarios(starts)[len(runs) :]:
                runs.append(driven(engine, scenario))
            tell(f"{name}, {setting}: {cleared(runs)} of {len(runs)} clear, {cell.label}")
            path.write_text(json.dumps(found) + "\n", encoding="utf-8")


def table(path: Path) -> str:
    """Return rates, poses against crawler2d's and costs by engine and setting."""
    if not path.exists():
        return "Not tried."
    predicted = read()
    rows: list[list[str]] = []
    for name, settings in json.loads(path.read_text(encoding="utf-8")).items():
        for number, (setting, cells) in enumerate(settings.items()):
            if number == 0:
                own = [predicted[label][: len(runs)] for label, runs in cells.items()]
                rates = [f"{cleared(runs)}/{len(runs)}" for runs in own]
                rows.append(["crawler2d", f"the runs of {name}", ", ".join(rates), "", ""])
            rates = [f"{cleared(runs)}/{len(runs)}" for runs in cells.values()]
            away = [each for label, runs in cells.items() for each in _away(predicted[label], runs)]
            cost = np.median([run["cost"] for runs in cells.values() for run in runs])
            median = f"{np.median(away):.2f}" if away else ""
            rows.append([name, setting, ", ".join(rates), median, f"{1e3 * cost:.3g}"])
    head = ["engine", "setting", "runs that clear, by cell", "stops apart [mm]", "ms a second"]
    return markdown_table(head, rows)


def _away(predicted: Sequence[Run], found: Sequence[Run]) -> list[float]:
    """[mm] Return how far apart stops are."""
    return [
        1e3 * float(np.hypot(one["x"] - other["x"], one["y"] - other["y"]))
        for one, other in zip(predicted, found, strict=False)
        if "cleared" not in (one["end"], other["end"])
    ]
