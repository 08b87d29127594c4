"""The tables of the page: rates by cell, agreement by model, poses of stops, costs."""

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from benches.engines import yaw
from benches.engines.cells import GROUNDS, MODELS, Cell
from benches.engines.runs import (
    ENGINES,
    MODELS_TIMED,
    SPEEDS,
    Run,
    Runs,
    both_stop,
    cleared,
    distance,
    hash_of,
    holds,
    pairs,
    predictions,
)
from benches.shared.measuring import quantiles, rate
from benches.shared.results import read, table_of
from crawler2d import newcombe
from research.tables import markdown_table


def apart(one: Sequence[Run], other: Sequence[Run]) -> bool:
    """Whether Newcombe's 95 % interval of the difference of two rates is without zero.

    Examples
    --------
    >>> stops, clears = [{"end": "stopped"}] * 8, [{"end": "cleared"}] * 8
    >>> apart(stops, clears), apart(stops, stops[:6] + clears[:2])
    (True, False)
    """
    gap = newcombe(cleared(one), len(one), cleared(other), len(other))
    return gap.low > 0.0 or gap.high < 0.0


def same_outcome(of: Iterable[tuple[Cell, Run, Run]]) -> str:
    """Return the number of pairs in which both or none clear."""
    same = [(one["end"] == "cleared") == (other["end"] == "cleared") for _, one, other in of]
    return f"{sum(same)} of {len(same)}" if same else ""


def rate_of(runs: Sequence[Run]) -> str:
    """Return the rate at which runs clear, if there are any and the engine takes their robot.

    Examples
    --------
    >>> rate_of([{"end": "cleared"}, {"end": "stopped"}])
    '1/2 (9 to 91)'
    """
    if not runs:
        return ""
    if runs[0]["end"].startswith("refused"):
        return "refused"
    return rate(cleared(runs), len(runs))


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
        data = read(folder / f"{name}.json.xz")
        if data is not None:
            if data["predictions"] != now:
                raise ValueError(f"{name} has results for other predictions")
            results[name], versions[name] = data["runs"], data["engine"]
    return results, versions


def parts(cells: Sequence[Cell], folder: Path) -> dict[str, str]:
    """Return the parts of the page by name, in Markdown."""
    results, versions = load(folder)
    predicted = predictions()
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
        "costs": table_of(folder / "costs.json.xz", _costs),
        "convergence": table_of(folder / "convergence.json.xz", _convergence),
        "jam": table_of(folder / "jam.json.xz", _convergence),
        "speeds": table_of(folder / "momentum.json.xz", _speeds),
        "refined": table_of(folder / "refined.json.xz", _refined),
        "yaw": table_of(folder / "yaw.json.xz", yaw.table),
        "cells": _cells(plane, predicted, results),
    }


def agreeing(cells: Sequence[Cell], folder: Path) -> dict[str, dict[str, float]]:
    """Return by engine the fraction of runs [%] that agree with each predicted outcome."""
    plane, predicted = [cell for cell in cells if cell.group == "plane"], predictions()
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
    """Return a row for each engine: its description and agreement."""
    rows = []
    for name, runs in results.items():
        found = list(pairs(cells, predicted, runs))
        stops = [pair for pair in found if pair[1]["end"] != "cleared"]
        clears = [pair for pair in found if pair[1]["end"] == "cleared"]
        tried = [cell for cell in cells if runs.get(cell.label) and holds(name, cell)]
        far = sum(apart(predicted[c.label][: len(runs[c.label])], runs[c.label]) for c in tried)
        what = f"{ENGINES[name].what} ({versions[name]})"
        agree = [same_outcome(found), same_outcome(stops), same_outcome(clears)]
        rows.append([name, what, *agree, f"{far} of {len(tried)}"])
    head = ["column", "engine", "same outcome", "predicted to stop", "predicted to clear"]
    return markdown_table([*head, "cells that differ"], rows)


def _models(cells: Sequence[Cell], predicted: Runs, results: Results) -> str:
    """Return a row for each model: in how many runs each engine has the same outcome."""
    rows = []
    for model in MODELS:
        mine = [cell for cell in cells if cell.model == model]
        row = [same_outcome(pairs(mine, predicted, runs)) for runs in results.values()]
        if any(row):
            rows.append([model, *row])
    return markdown_table(["model", *results], rows)


def _poses(cells: Sequence[Cell], predicted: Runs, results: Results) -> str:
    """Return the distances between the poses of stops, if both stop."""
    rows = []
    for name, runs in results.items():
        row = [name]
        for is_gear in (False, True):
            kind = [cell for cell in cells if (_GEARS in cell.model) == is_gear]
            away, turned = [], []
            for _, one, other in pairs(kind, predicted, runs):
                if both_stop(one, other):
                    away.append(1e3 * distance(one, other))
                    turned.append(np.degrees(abs(one["angle"] - other["angle"])))
            row.append(str(len(away)))
            for values in (away, turned):
                row.append(quantiles(values, ".2f"))
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
    """Return how many runs clear on grounds that vary across the width."""
    columns = {name: runs for name, runs in results.items() if ENGINES[name].in_space}
    rows = []
    for cell in sorted(cells, key=lambda cell: GROUNDS.index(cell.ground)):
        names = [cell.ground, cell.model, f"{1e3 * cell.height:.4g}", f"{cell.friction:g}"]
        rows.append([*names, *_rates_of(cell, predicted, columns)])
    head = ["ground", "model", "mm", "friction", "crawler2d: no yaw, no roll"]
    return markdown_table([*head, *columns], rows)


def _paper(cells: Sequence[Cell], predicted: Runs, results: Results) -> str:
    """Return how many runs clear at the settings of the public simulation model."""
    rows = [
        [
            *(cell.model, f"{cell.ground} of {1e3 * cell.height:g} mm"),
            *_rates_of(cell, predicted, results),
        ]
        for cell in cells
    ]
    return markdown_table(["model", "ground", "crawler2d", *results], rows)


def _cells(cells: Sequence[Cell], predicted: Runs, results: Results) -> str:
    """Return a row for each cell with the rates of clearing."""
    rows = []
    for cell in cells:
        names = [cell.robot, cell.model, cell.drive, cell.ground]
        names += [f"{1e3 * cell.height:.4g}", f"{cell.friction:g}"]
        rows.append([*names, *_rates_of(cell, predicted, results)])
    head = ["robot", "model", "motors", "ground", "mm", "friction", "crawler2d"]
    return markdown_table([*head, *results], rows)


def _rates_of(cell: Cell, predicted: Runs, results: Results) -> list[str]:
    """Return the rates of a cell: crawler2d's, and those of engines."""
    return [rate_of(runs.get(cell.label, ())) for runs in (predicted, *results.values())]


def _convergence(found: dict[str, Any]) -> str:
    """Return rates, poses against crawler2d's and costs by engine and setting."""
    predicted = predictions()
    rows: list[list[str]] = []
    for name, settings in found.items():
        for number, (setting, cells) in enumerate(settings.items()):
            if number == 0:
                own = [predicted[label][: len(runs)] for label, runs in cells.items()]
                rows.append(["crawler2d", f"the runs of {name}", _rates(own), "", ""])
            away = [
                1e3 * distance(one, other)
                for label, runs in cells.items()
                for one, other in zip(predicted[label], runs, strict=False)
                if both_stop(one, other)
            ]
            cost = np.median([run["cost"] for runs in cells.values() for run in runs])
            median = f"{np.median(away):.2f}" if away else ""
            rows.append([name, setting, _rates(cells.values()), median, f"{1e3 * cost:.3g}"])
    head = [
        "engine",
        "setting",
        "runs that clear, by cell",
        "distance of stops [mm]",
        "ms per second",
    ]
    return markdown_table(head, rows)


def _rates(cells: Iterable[Sequence[Run]]) -> str:
    return ", ".join(f"{cleared(runs)}/{len(runs)}" for runs in cells)


def _costs(found: dict[str, Any]) -> str:
    """Return the costs in milliseconds per simulated second."""
    rows = [
        [name, *(f"{1e3 * costs[model]:.3g}" if model in costs else "" for model in MODELS_TIMED)]
        for name, costs in found.items()
    ]
    return markdown_table(["ms per simulated second", *MODELS_TIMED], rows)


def _speeds(found: dict[str, Any]) -> str:
    """Return how many runs clear at each speed, and the positions of other stops."""
    rows = []
    for label, engines in found.items():
        for name, speeds in engines.items():
            row = [label, name]
            for runs in speeds.values():
                places = sorted(1e3 * run["x"] for run in runs if run["end"] != "cleared")
                where = f", {places[0]:.1f} to {places[-1]:.1f} mm" if places else ""
                row.append(f"{cleared(runs)}/{len(runs)}{where}")
            rows.append(row)
    return markdown_table(["cell", "engine", *(f"{speed:g} m/s" for speed in SPEEDS)], rows)


def _refined(found: dict[str, Any]) -> str:
    """Return whose outcome changed, by engine."""
    rows = []
    for name, cells in found.items():
        kept = [ends for refined in cells.values() for ends in refined.values()]
        runs = [[end == "cleared" for end in ends[:4]] for ends in kept]
        placed = [ends[4] for ends in kept if ends[4]]
        now = sum(own == again for _, _, own, again in runs)
        ours = sum(own != before for before, _, own, _ in runs)
        theirs = sum(again != before for _, before, _, again in runs)
        stays = f"{placed.count('stays')} of {len(placed)}" if placed else ""
        rows.append([name, str(len(runs)), str(now), str(theirs), str(ours), stays])
    head = ["engine", "differing runs refined", "equal then", "the engine changed"]
    return markdown_table([*head, "crawler2d changed", "stays in crawler2d's stop"], rows)
