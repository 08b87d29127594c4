"""Outcomes side by side: predictions, and what the engines came to."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Sequence
from itertools import product
from pathlib import Path
from typing import Any

from benches.models.cases import CASES
from benches.models.predict import PREDICTIONS
from benches.models.running import FILES
from research.markdown import markdown_table

__all__ = ["agreement", "counts", "parts", "rows", "summary"]

_KINDS = ("runs", "firm")


def summary(runs: Sequence[dict[str, Any]]) -> str:
    """Return how runs ended, and where the chassis frame of those that stopped is [mm].

    Examples
    --------
    >>> summary([{"end": "seized", "x": -0.3372}] * 2 + [{"end": "cleared", "x": 0.56}])
    '2 seized at -337, 1 cleared'
    """
    words = []
    for end, count in Counter(run["end"] for run in runs).most_common():
        places = sorted(1e3 * run["x"] for run in runs if run["end"] == end)
        low, high = (f"{places[i]:.0f}" for i in (0, -1))
        at = f" at {low}" if low == high else f" at {low} to {high}"
        words.append(f"{count} {end}" + ("" if end == "cleared" else at))
    return ", ".join(words)


def agreement(predicted: Sequence[dict[str, Any]], found: Sequence[dict[str, Any]]) -> int:
    """Return in how many starts both clear or both do not."""
    pairs = zip(predicted, found, strict=False)
    return sum((a["end"] == "cleared") == (b["end"] == "cleared") for a, b in pairs)


def rows(results: dict[str, dict[str, Any]]) -> list[list[str]]:
    """Return a row for each cell that was run: what it is, the predictions, and each engine."""
    predictions = json.loads(PREDICTIONS.read_text(encoding="utf-8"))
    found = []
    for name, case in CASES.items():
        for label, cell in case.cells.items():
            for file in case.files:
                predicted = predictions[name][FILES[file]]["runs"][label]
                if not any(runs.get(f"{name} | {file} | {label}") for runs in results.values()):
                    continue
                firm = predictions[name][FILES[file]]["firm"][label]
                is_same = agreement(predicted, firm) == len(predicted)
                row = [name, f"{label}, {cell.friction:g}", file, summary(predicted)]
                row.append("the same" if is_same else summary(firm))
                for runs in results.values():
                    own = runs.get(f"{name} | {file} | {label}", [])
                    same = f" ({agreement(predicted, own)} of {len(own)})" if own else ""
                    row.append(summary(own) + same)
                found.append(row)
    return found


def counts(results: dict[str, dict[str, Any]]) -> list[list[str]]:
    """Return a row for each engine: in how many starts it agrees, by what was predicted.

    First with the predictions that were written before, then with those of firm motors.
    """
    predictions = json.loads(PREDICTIONS.read_text(encoding="utf-8"))
    found = []
    for engine, runs in results.items():
        same, of = Counter[tuple[str, bool]](), Counter[tuple[str, bool]]()
        for key, own in runs.items():
            name, file, label = key.split(" | ")
            for kind in _KINDS:
                predicted = predictions[name][FILES[file]][kind][label]
                for a, b in zip(predicted, own, strict=False):
                    cell = kind, a["end"] == "cleared"
                    of[cell] += 1
                    same[cell] += agreement([a], [b])
        cells = product(_KINDS, (False, True))
        found.append([engine, *(f"{same[cell]} of {of[cell]}" for cell in cells)])
    return found


def parts(paths: Sequence[Path]) -> dict[str, str]:
    """Return the tables in Markdown, by name; results are named after their files."""
    results = {path.stem: json.loads(path.read_text(encoding="utf-8")) for path in paths}
    header = ["robot", "cell, friction", "file", "crawler2d", "firm motors", *results]
    ends = ("predicted to stop", "predicted to clear")
    firm = (f"{end}, firm motors" for end in ends)
    return {
        "outcomes": markdown_table(header, rows(results)),
        "files": markdown_table(["engine", *ends, *firm], counts(results)),
    }
