"""The parts of the page docs/accuracy.md, and its table of all cells."""

import csv
import io
import math
from collections.abc import Sequence
from statistics import median
from typing import Any

from benches.accuracy.findings import (
    CELL_BOUND,
    CURVE,
    MEAN_BOUND,
    MODEL_BOUND,
    CellVerdict,
    Finding,
    Study,
    cell_interval,
    cell_verdicts,
    mean_difference,
    model_difference,
    models,
    size_of_difference,
    verdict_of,
)
from crawler2d.sweeps.statistics import Interval
from research.tables import table

_MEANING = {"inside": "yes", "outside": "**no**", "open": "not decided"}


def render(study: Study, machine: dict[str, Any]) -> dict[str, str]:
    """Return the parts of the page by name.

    Parameters
    ----------
    study : Study
        What was found.
    machine : dict
        What `benches.shared.measuring.machine` returned.
    """
    cells = cell_verdicts(study)
    return {
        "models": _models(study, cells),
        "outliers": _outliers(study, cells),
        "result": _result(study, cells),
        "settings": _settings(study),
        "runs": _runs(study, machine),
    }


def table_of_cells(study: Study) -> str:
    """Write a line of comma-separated values for each cell."""
    rows = [
        {
            "cell": each.cell.name,
            "chaotic": "yes" if each.finding.is_chaotic else "no",
            "ground": each.cell.obstacle["kind"],
            "friction": f"{each.cell.friction:g}",
            "max_torque_Nm": f"{each.cell.max_torque:g}",
            "height_mm": f"{1e3 * each.cell.height:.1f}",
            "runs": each.figures.pairs.runs,
            "rate_reference": f"{each.finding.by_setting[study.reference].rate:.3f}",
            "rate": f"{each.figures.rate:.3f}",
            "difference": f"{each.interval.rate:z.3f}",
            "low": f"{each.interval.low:z.3f}",
            "high": f"{each.interval.high:z.3f}",
            f"within_{CELL_BOUND}": _MEANING[each.verdict],
            "p": f"{each.p_value:.2g}",
            "cost_ms_per_s": _short(1e3 * each.figures.cost),
        }
        for each in cell_verdicts(study)
    ]
    text = io.StringIO()
    writer = csv.DictWriter(text, list(rows[0]) if rows else (), lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    return text.getvalue()


def _runs(study: Study, machine: dict[str, Any]) -> str:
    figures = [own for each in study.findings for own in each.by_setting.values()]
    runs, failed = sum(own.runs for own in figures), sum(own.failed for own in figures)
    spent = sum(own.processor for own in figures)
    rotors = sum(each.cell.rotors for each in study.findings)
    looks, curve = " or ".join(map(str, study.looks)), min(CURVE, study.looks[0])
    return f"""
Set {study.number} (`benches/accuracy/sets/{study.number}.json`): {len(study.findings)} cells,
{rotors} of them of motors with rotors; {looks} runs of each with {study.default} and
{study.reference}, {curve} with the other settings. {runs:,} runs, {failed} of them without
a result, {spent / 3600.0:.1f} hours of processor time, until {machine["date"]}:
{machine["processor"]}, {machine["cores"]} cores, {machine["system"]}, Python
{machine["python"]}, crawler2d {machine["versions"]["crawler2d"]}, core
{", ".join(study.builds)}.
""".strip()


def _result(study: Study, cells: Sequence[CellVerdict]) -> str:
    if not cells:
        return f"There are no runs with {study.default}."
    found = mean_difference(study, study.default)
    of_models = [verdict_of(model_difference(own), MODEL_BOUND) for own in models(cells).values()]
    of_cells = [each.verdict for each in cells]
    alone = [each for each in cells if each.p_value < 0.05]
    return f"""
- *Mean of all cells* within {MEAN_BOUND}: {_MEANING[verdict_of(found, MEAN_BOUND)]},
  {_interval(found)} (95 %).
- *Models* within {MODEL_BOUND} (95 % each): {_tally(of_models)}.
- *Cells* within {CELL_BOUND} (90 % each): {_tally(of_cells)}.
- *Cells with another rate* than with {study.reference}: {len(alone)} of {len(cells)}
  (McNemar's test with Holm's correction, 5 %).
""".strip()


def _settings(study: Study) -> str:
    rows = []
    for name in study.settings:
        own = [each for each in study.findings if name in each.by_setting]
        if not own or name == study.reference:
            continue
        found, size = mean_difference(study, name), size_of_difference(own, name)
        chance = sum(each.by_setting[name].pairs.by_chance for each in own) / len(own)
        # One check for all, as these cells are only counted.
        intervals = [cell_interval(each.by_setting[name].pairs, 1) for each in own]
        beyond = sum(verdict_of(interval, CELL_BOUND) == "outside" for interval in intervals)
        cost = median(each.by_setting[name].cost for each in own)
        rows.append(
            {
                "setting": name,
                "mean difference (95 %)": _interval(found),
                "mean size": f"{size.rate:.3f}",
                "expected by chance": f"{chance:.3f}",
                f"cells beyond {CELL_BOUND}": str(beyond),
                "path error, median [mm]": _path(own, name),
                "cost, median [ms/s]": _short(1e3 * cost),
            }
        )
    return table(rows)


def _models(study: Study, cells: Sequence[CellVerdict]) -> str:
    rows = []
    for name, own in models(cells).items():
        found = model_difference(own)
        rows.append(
            {
                "model": name,
                "cells": str(len(own)),
                "mean difference (95 %)": _interval(found),
                f"within {MODEL_BOUND}?": _MEANING[verdict_of(found, MODEL_BOUND)],
                "path error, median [mm]": _path([each.finding for each in own], study.default),
                "cost [ms/s]": _short(1e3 * median(each.figures.cost for each in own)),
            }
        )
    return table(rows)


def _outliers(study: Study, cells: Sequence[CellVerdict]) -> str:
    chosen = [each for each in cells if each.p_value < 0.05 or each.verdict == "outside"]
    if not chosen:
        return f"With {study.default}, no cell differs beyond its interval."
    chosen.sort(key=lambda each: -abs(each.interval.rate))
    lines = (
        f"- *{each.cell.name}*: {_interval(each.interval)}, p = {each.p_value:.2g}"
        for each in chosen
    )
    return "\n".join(lines)


def _path(findings: Sequence[Finding], setting: str) -> str:
    own = [each.by_setting[setting].path for each in findings if not each.is_chaotic]
    errors = [error for error in own if not math.isnan(error)]
    return _short(1e3 * median(errors)) if errors else "-"


def _tally(verdicts: Sequence[str]) -> str:
    inside, outside, undecided = (verdicts.count(each) for each in ("inside", "outside", "open"))
    return f"{inside} of {len(verdicts)}; {outside} beyond it, {undecided} not decided"


def _interval(found: Interval) -> str:
    return f"{found.rate:+z.3f} ({found.low:+z.3f} to {found.high:+z.3f})"


def _short(value: float) -> str:
    return f"{value:.0f}" if value >= 100.0 else f"{value:.2g}"
