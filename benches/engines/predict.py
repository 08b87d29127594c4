"""What crawler2d says will happen, written down before the engines run, and its hash."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Sequence
from math import hypot
from pathlib import Path
from typing import Any

import crawler2d
from benches.engines.cells import Cell
from benches.engines.own import simulated
from benches.engines.telling import tell
from crawler2d.results.outcome import Outcome

__all__ = ["PREDICTIONS", "check", "hash_of", "predict", "read", "unlike"]

PREDICTIONS = Path(__file__).with_name("predictions.json")
_NEAR = 1e-3  # [m]


def predict(cells: Sequence[Cell], path: Path = PREDICTIONS) -> None:
    """Write a line for each cell: its runs, in the order of their draws."""
    lines = []
    for number, cell in enumerate(cells, 1):
        runs = [simulated(scenario) for scenario in cell.scenarios()]
        for run in runs:
            del run["cost"]  # would make another file each time
        lines.append(f"{json.dumps(cell.label)}: {json.dumps(runs)}")
        tell(f"{number} of {len(cells)}: {cell.label}")
    version = json.dumps(crawler2d.__version__)
    body = ",\n".join(lines)
    path.write_text(f'{{"version": {version}, "cells": {{\n{body}\n}}}}\n', encoding="utf-8")


def read(path: Path = PREDICTIONS) -> dict[str, list[dict[str, Any]]]:
    """Read the predicted runs by cell."""
    found: dict[str, list[dict[str, Any]]] = json.loads(path.read_text(encoding="utf-8"))["cells"]
    return found


def hash_of(path: Path = PREDICTIONS) -> str:
    """Return the SHA-256 of the predictions.

    Raises
    ------
    FileNotFoundError
        If nothing was predicted.
    """
    return hashlib.sha256(path.read_bytes()).hexdigest()


def unlike(path: Path, kept: Path = PREDICTIONS) -> str:
    """Say how many runs of another file end otherwise than those of the kept one."""
    before, now = read(kept), read(path)
    lines = []
    for wheels, has_gears in (("round wheels", False), ("gear wheels", True)):
        pairs = [
            pair
            for label, runs in now.items()
            if ("gears" in label) is has_gears
            for pair in zip(before[label], runs, strict=True)
        ]
        clears = sum((one["end"] == "cleared") != (two["end"] == "cleared") for one, two in pairs)
        ends = sum(one["end"] != two["end"] for one, two in pairs)
        stops = [pair for pair in pairs if all(Outcome(run["end"]).is_stop for run in pair)]
        far = sum(hypot(one["x"] - two["x"], one["y"] - two["y"]) > _NEAR for one, two in stops)
        lines.append(
            f"{wheels}, {len(pairs)} runs: {clears} clear in one of both, {ends} have another "
            f"outcome; {far} of {len(stops)} that stop in both do so more than 1 mm apart"
        )
    return "\n".join(lines)


def check(cells: Sequence[Cell], results: dict[str, Any], path: Path = PREDICTIONS) -> str:
    """Return the hash of the predictions, if runs may be added to results.

    Raises
    ------
    ValueError
        If there are none, a cell has none, or the results were made for others.
    """
    if not path.exists():
        raise ValueError(f"{path.name} is missing: predict before an engine runs")
    now = hash_of(path)
    if results and results["predictions"] != now:
        raise ValueError(f"the results are for predictions {results['predictions'][:12]}")
    missing = {cell.label for cell in cells} - read(path).keys()
    if missing:
        raise ValueError(f"not predicted: {min(missing)}")
    return now
