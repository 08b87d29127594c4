"""What was found: parts of the page in Markdown, and a table of all cells."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Iterator, Sequence
from statistics import median
from typing import Any

from benches.accuracy.findings import Finding, Study
from benches.accuracy.statistics import (
    CELL_BOUND,
    CURVE,
    MEAN_BOUND,
    MODEL_BOUND,
    cell_interval,
    judge,
)
from benches.accuracy.verdicts import (
    Judged,
    judged_cells,
    mean_difference,
    model_difference,
    models,
    size_of_difference,
)
from benches.peers import markdown
from crawler2d.sweeps.statistics import Interval

_MEANING = {"inside": "yes", "outside": "**no**", "open": "not decided"}


def render(study: Study, machine: dict[str, Any]) -> dict[str, str]:
    """Write the parts of the page, by name.

    Parameters
    ----------
    study : Study
        What was found.
    machine : dict
        What `benches.peers.machine.describe` found.
    """
    cells = judged_cells(study)
    parts = {
        "models": _models(study, cells),
        "outliers": _outliers(study, cells),
        "result": _result(study, cells),
        "settings": _settings(study),
        "runs": _runs(study, machine),
    }
    return {name: markdown.page([part]).rstrip() for name, part in parts.items()}


def table_of_cells(study: Study) -> str:
    """Write a line of comma-separated values for each cell."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(
        [
            *("cell", "chaotic", "ground", "friction", "max_torque_Nm", "height_mm", "runs"),
            *("rate_reference", "rate", "difference", "low", "high", f"within_{CELL_BOUND}", "p"),
            "cost_ms_per_s",
        ]
    )
    for each in judged_cells(study):
        cell = each.cell
        writer.writerow(
            [
                cell.name,
                "yes" if each.finding.is_chaotic else "no",
                cell.obstacle["kind"],
                f"{cell.friction:g}",
                f"{cell.max_torque:g}",
                f"{1e3 * cell.height:.1f}",
                each.figures.pairs.runs,
                f"{each.finding.by_setting[study.reference].rate:.3f}",
                f"{each.figures.rate:.3f}",
                *(f"{value:z.3f}" for value in each.interval),
                _MEANING[each.verdict],
                f"{each.p_value:.2g}",
                _short(1e3 * each.figures.cost),
            ]
        )
    return text.getvalue()


def _runs(study: Study, machine: dict[str, Any]) -> str:
    runs = sum(f.runs for each in study.findings for f in each.by_setting.values())
    spent = sum(f.processor for each in study.findings for f in each.by_setting.values())
    failed = sum(f.failed for each in study.findings for f in each.by_setting.values())
    looks, curve = " or ".join(map(str, study.looks)), min(CURVE, study.looks[0])
    return f"""
Set {study.number} (`benches/accuracy/sets/{study.number}.json`): {len(study.findings)} cells,
{looks} runs of each with {study.default} and {study.reference}, {curve} with the other settings.
{runs:,} runs, {failed} of them without a result, {spent / 3600.0:.1f} hours of processor time,
until {machine["date"]}: {machine["processor"]}, {machine["cores"]} cores, {machine["system"]},
Python {machine["python"]}, crawler2d {machine["versions"]["crawler2d"]}, core
{", ".join(study.builds)}.
"""


def _result(study: Study, cells: Sequence[Judged]) -> str:
    if not cells:
        return f"There are no runs with {study.default}."
    found = mean_difference(study, study.default)
    of_models = [judge(model_difference(own), MODEL_BOUND) for own in models(cells).values()]
    of_cells = [each.verdict for each in cells]
    alone = [each for each in cells if each.p_value < 0.05]
    return f"""
- *Mean of all cells* within {MEAN_BOUND}: {_MEANING[judge(found, MEAN_BOUND)]},
  {_interval(found)} (95 %).
- *Models* within {MODEL_BOUND} (95 % each): {_tally(of_models)}.
- *Cells* within {CELL_BOUND} (90 % each): {_tally(of_cells)}.
- *Cells with another rate* than with {study.reference}: {len(alone)} of {len(cells)}
  (McNemar's test with Holm's correction, 5 %).
"""


def _settings(study: Study) -> str:
    rows = []
    for name in study.settings:
        own = [each for each in study.findings if name in each.by_setting]
        if not own or name == study.reference:
            continue
        found, size = mean_difference(study, name), size_of_difference(own, name)
        chance = sum(each.by_setting[name].pairs.by_chance for each in own) / len(own)
        # One look for all: these cells are counted, not judged.
        intervals = [cell_interval(each.by_setting[name].pairs, 1) for each in own]
        beyond = sum(judge(interval, CELL_BOUND) == "outside" for interval in intervals)
        cost = median(each.by_setting[name].cost for each in own)
        rows.append(
            [
                name,
                _interval(found),
                f"{size.rate:.3f}",
                f"{chance:.3f}",
                str(beyond),
                _path(own, name),
                _short(1e3 * cost),
            ]
        )
    head = [
        *("setting", "mean difference (95 %)", "mean size", "by chance"),
        *(f"cells beyond {CELL_BOUND}", "path error, median [mm]", "cost, median [ms/s]"),
    ]
    return markdown.table(head, rows)


def _models(study: Study, cells: Sequence[Judged]) -> str:
    rows = []
    for name, own in models(cells).items():
        found = model_difference(own)
        rows.append(
            [
                name,
                str(len(own)),
                _interval(found),
                _MEANING[judge(found, MODEL_BOUND)],
                _path([each.finding for each in own], study.default),
                _short(1e3 * median(each.figures.cost for each in own)),
            ]
        )
    head = [
        *("model", "cells", "mean difference (95 %)", f"within {MODEL_BOUND}?"),
        *("path error, median [mm]", "cost [ms/s]"),
    ]
    return markdown.table(head, rows)


def _outliers(study: Study, cells: Sequence[Judged]) -> str:
    chosen = [each for each in cells if each.p_value < 0.05 or each.verdict == "outside"]
    if not chosen:
        return f"With {study.default}, no cell differs beyond its interval."
    chosen.sort(key=lambda each: -abs(each.interval.rate))
    lines = (
        f"- *{each.cell.name}*: {each.interval.rate:+z.3f} ({each.interval.low:+z.3f} to"
        f" {each.interval.high:+z.3f}), p = {each.p_value:.2g}"
        for each in chosen
    )
    return "\n".join(lines)


def _path(findings: Sequence[Finding], setting: str) -> str:
    errors = list(_errors(findings, setting))
    return _short(1e3 * median(errors)) if errors else "-"


def _errors(findings: Sequence[Finding], setting: str) -> Iterator[float]:
    for each in findings:
        error = each.by_setting[setting].path
        if not each.is_chaotic and not math.isnan(error):
            yield error


def _tally(verdicts: Sequence[str]) -> str:
    inside, outside, undecided = (verdicts.count(each) for each in ("inside", "outside", "open"))
    return f"{inside} of {len(verdicts)}; {outside} beyond it, {undecided} not decided"


def _interval(found: Interval) -> str:
    return f"{found.rate:+z.3f} ({found.low:+z.3f} to {found.high:+z.3f})"


def _short(value: float) -> str:
    return f"{value:.0f}" if value >= 100.0 else f"{value:.2g}"


def _percent(share: float) -> str:
    return f"{100.0 * share:.3g}"
