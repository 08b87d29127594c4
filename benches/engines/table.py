"""The tables of the page: rates by cell, agreement by model, poses of stops, costs."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from benches.engines import convergence, costs, momentum, refining, yaw
from benches.engines.agreement import Run, Runs, apart, cleared, pairs, rate, share
from benches.engines.cells import GROUNDS, Cell
from benches.engines.engines import ENGINES, holds
from benches.engines.predict import hash_of, read
from benches.engines.robots import MODELS
from benches.engines.running import results_of
from research.markdown import markdown_table

__all__ = ["agreeing", "load", "parts"]

Results = Mapping[str, Runs]
"""Runs by engine."""

_GEARS = "gears"


def load(folder: Path) -> tuple[dict[str, dict[str, list[Run]]], dict[str, str]]:
    """Return the results of a folder by engine, and the version of each.

    Raises
    ------
    ValueError
        If some are for other predictions.
    """
    results, versions = {}, {}
    now = hash_of()
    for name in ENGINES:
        data = results_of(name, folder)
        if data is not None:
            if data["predictions"] != now:
                raise ValueError(f"{name} has results for other predictions")
            results[name], versions[name] = data["runs"], data["engine"]
    return results, versions


def parts(cells: Sequence[Cell], folder: Path) -> dict[str, str]:
    """Return the parts of the page by name, in Markdown."""
    results, versions = load(folder)
    predicted = read()
    groups = {
        group: [cell for cell in cells if cell.group == group]
        for group in ("plane", "space", "paper")
    }
    plane = groups["plane"]
    return {
        "predictions": f"SHA-256 of `predictions.json`: `{hash_of()}`",
        "engines": _engines(plane, predicted, results, versions),
        "models": _models(plane, predicted, results),
        "poses": _poses(plane, predicted, results),
        "ends": _ends(plane, predicted, results),
        "space": _space(groups["space"], predicted, results),
        "paper": _paper(groups["paper"], predicted, results),
        "costs": costs.table(folder),
        "convergence": convergence.table(folder / convergence.USUAL),
        "jam": convergence.table(folder / convergence.JAM),
        "speeds": momentum.table(folder),
        "refined": refining.table(folder),
        "yaw": yaw.table(folder),
        "cells": _cells(plane, predicted, results),
    }


def agreeing(cells: Sequence[Cell], folder: Path) -> dict[str, dict[str, float]]:
    """Return by engine in how many runs [%] it agrees with each predicted outcome."""
    plane, predicted = [cell for cell in cells if cell.group == "plane"], read()
    found: dict[str, dict[str, float]] = {}
    for name, runs in load(folder)[0].items():
        ends = [[b["end"] == "cleared" for b in pair[1:]] for pair in pairs(plane, predicted, runs)]
        for clears, what in ((False, "predicted to stop"), (True, "predicted to clear")):
            same = [own == clears for mine, own in ends if mine == clears]
            found.setdefault(name, {})[what] = 100.0 * sum(same) / len(same)
    return found


def _engines(
    cells: Sequence[Cell], predicted: Runs, results: Results, versions: Mapping[str, str]
) -> str:
    """Return a row for each engine: what it is, and in how much it agrees."""
    rows = []
    for name, runs in results.items():
        found = list(pairs(cells, predicted, runs))
        stops = [pair for pair in found if pair[1]["end"] != "cleared"]
        clears = [pair for pair in found if pair[1]["end"] == "cleared"]
        tried = [cell for cell in cells if runs.get(cell.label) and holds(name, cell)]
        far = sum(apart(predicted[c.label][: len(runs[c.label])], runs[c.label]) for c in tried)
        what = f"{ENGINES[name].what} ({versions[name]})"
        agree = [share(found), share(stops), share(clears)]
        rows.append([name, what, *agree, f"{far} of {len(tried)}"])
    head = ["column", "engine", "same outcome", "predicted to stop", "predicted to clear"]
    return markdown_table([*head, "cells apart"], rows)


def _models(cells: Sequence[Cell], predicted: Runs, results: Results) -> str:
    """Return a row for each model: in how many runs each engine has the same outcome."""
    rows = []
    for model in MODELS:
        mine = [cell for cell in cells if cell.model == model]
        row = [share(pairs(mine, predicted, runs)) for runs in results.values()]
        if any(row):
            rows.append([model, *row])
    return markdown_table(["model", *results], rows)


def _poses(cells: Sequence[Cell], predicted: Runs, results: Results) -> str:
    """Return how far apart the poses of stops are, where both stop."""
    rows = []
    for name, runs in results.items():
        row = [name]
        for is_gear in (False, True):
            kind = [cell for cell in cells if (_GEARS in cell.model) == is_gear]
            away, turned = [], []
            for _, one, other in pairs(kind, predicted, runs):
                if other["end"] != "cleared" and one["end"] not in ("cleared", "tipped_over"):
                    away.append(1e3 * np.hypot(one["x"] - other["x"], one["y"] - other["y"]))
                    turned.append(np.degrees(abs(one["angle"] - other["angle"])))
            row.append(str(len(away)))
            for values in (away, turned):
                quantiles = np.quantile(values, (0.5, 0.9)) if values else ()
                row.append(", ".join(f"{each:.2f}" for each in quantiles))
        rows.append(row)
    head = [f"{of}: {what}" for of in ("round", _GEARS) for what in ("runs", "mm", "degrees")]
    return markdown_table(["engine", *head], rows)


def _ends(cells: Sequence[Cell], predicted: Runs, results: Results) -> str:
    """Return how many runs clear in each engine, by predicted outcome."""
    words = Counter(run["end"] for cell in cells for run in predicted[cell.label])
    rows = []
    for word, _ in words.most_common():
        row = [word]
        for runs in results.values():
            found = [b for _, a, b in pairs(cells, predicted, runs) if a["end"] == word]
            row.append(f"{cleared(found)} of {len(found)}" if found else "")
        rows.append(row)
    return markdown_table(["predicted", *results], rows)


def _space(cells: Sequence[Cell], predicted: Runs, results: Results) -> str:
    """Return how many runs clear on grounds that are not the same across."""
    columns = {name: runs for name, runs in results.items() if ENGINES[name].in_space}
    rows = []
    for cell in sorted(cells, key=lambda cell: GROUNDS.index(cell.ground)):
        row = [cell.ground, cell.model, f"{1e3 * cell.height:.4g}", f"{cell.friction:g}"]
        row.append(rate(predicted[cell.label]))
        rows.append([*row, *(rate(runs.get(cell.label, ())) for runs in columns.values())])
    head = ["ground", "model", "mm", "friction", "crawler2d: no yaw, no roll"]
    return markdown_table([*head, *columns], rows)


def _paper(cells: Sequence[Cell], predicted: Runs, results: Results) -> str:
    """Return how many runs clear at the settings of the public simulation model."""
    rows = []
    for cell in cells:
        row = [cell.model, f"{cell.ground} of {1e3 * cell.height:g} mm"]
        row.append(rate(predicted[cell.label]))
        rows.append([*row, *(rate(runs.get(cell.label, ())) for runs in results.values())])
    return markdown_table(["model", "ground", "crawler2d", *results], rows)


def _cells(cells: Sequence[Cell], predicted: Runs, results: Results) -> str:
    """Return a row for each cell with the rates of clearing."""
    rows = []
    for cell in cells:
        row = [cell.robot, cell.model, cell.drive, cell.ground]
        row += [f"{1e3 * cell.height:.4g}", f"{cell.friction:g}", rate(predicted[cell.label])]
        rows.append([*row, *(rate(runs.get(cell.label, ())) for runs in results.values())])
    head = ["robot", "model", "motors", "ground", "mm", "friction", "crawler2d"]
    return markdown_table([*head, *results], rows)
