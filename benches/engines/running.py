"""Runs of cells in one engine, on several processes, kept in a file as they end."""

from __future__ import annotations

import json
import os
import signal
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Executor, ProcessPoolExecutor
from contextlib import contextmanager
from itertools import repeat
from multiprocessing import get_context
from pathlib import Path
from typing import Any

from benches.engines.cells import Cell
from benches.engines.driving import driven
from benches.engines.engines import engine_of, holds
from benches.engines.own import has_rapier, simulated
from benches.engines.predict import check
from benches.engines.telling import tell
from crawler2d.parameters.scenario import Scenario

__all__ = ["RESULTS", "processes", "results_of", "run"]

RESULTS = Path(__file__).with_name("results")
_KEEP = 20.0  # [s] between two writings of the file


def results_of(name: str, folder: Path) -> dict[str, Any] | None:
    """Return the results of an engine, with its version and the hash of the predictions."""
    path = folder / f"{name}.json"
    if not path.exists():
        return None
    found: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    return found


@contextmanager
def processes(count: int | None = None) -> Iterator[Executor]:
    """Open processes, as many as there are cores unless said; Ctrl-C ends them at once."""
    context = get_context("spawn")  # no engine is forked with its state
    pool = ProcessPoolExecutor(count, context, signal.signal, (signal.SIGINT, signal.SIG_DFL))
    try:
        yield pool
    finally:
        pool.shutdown(cancel_futures=True)


def run(
    name: str, cells: Sequence[Cell], starts: int, executor: Executor, folder: Path = RESULTS
) -> None:
    """Add runs of cells to the results of an engine, the first start of all cells first.

    Runs that the file already has are not made again, so that an interrupted comparison goes on.

    Raises
    ------
    ValueError
        If the cells are not predicted, or the results are for other predictions.
    """
    path = folder / f"{name}.json"
    results = results_of(name, folder) or {}
    now = check(cells, results)
    drive, version = _driver(name)
    if drive is None:
        tell(f"{name} is left out: {version}")
        return
    results = results or {"predictions": now, "engine": version, "runs": {}}
    held = [cell for cell in cells if holds(name, cell)]
    runs = {cell.label: results["runs"].setdefault(cell.label, []) for cell in held}
    missing = [
        (cell.label, cell.scenarios(start + 1)[start])
        for start in range(starts)
        for cell in held
        if len(runs[cell.label]) <= start
    ]
    folder.mkdir(parents=True, exist_ok=True)
    kept = time.monotonic()
    made = executor.map(_made, repeat(name), [scenario for _, scenario in missing])
    try:
        for number, ((label, _), found) in enumerate(zip(missing, made, strict=True), 1):
            runs[label].append(found)
            if time.monotonic() - kept > _KEEP:
                _keep(path, results)
                kept = time.monotonic()
                tell(f"{name}: {number} of {len(missing)} runs")
    finally:
        _keep(path, results)


def _made(name: str, scenario: Scenario) -> dict[str, Any]:
    """Make a run, in whichever process."""
    drive, missing = _driver(name)
    if drive is None:
        raise ImportError(missing)
    return drive(scenario)


def _driver(name: str) -> tuple[Callable[[Scenario], dict[str, Any]] | None, str]:
    """Return what drives a scenario and which version it has, or None and why not."""
    if name == "rapier":
        if not has_rapier():
            return None, "this crawler2d has no Solver(engine=...)"
        return lambda scenario: simulated(scenario, "rapier"), "rapier, through crawler2d"
    try:
        engine = engine_of(name)
    except ImportError as error:
        return None, str(error)
    return lambda scenario: driven(engine, scenario), engine.version


def _keep(path: Path, results: dict[str, Any]) -> None:
    """Write the results, one line a cell; the file is whole at any time."""
    lines = [f"{json.dumps(label)}: {json.dumps(runs)}" for label, runs in results["runs"].items()]
    head = json.dumps({"predictions": results["predictions"], "engine": results["engine"]})
    text = f'{head[:-1]}, "runs": {{\n' + ",\n".join(lines) + "\n}}\n"
    new = path.with_suffix(".new")
    new.write_text(text, encoding="utf-8")
    os.replace(new, path)
