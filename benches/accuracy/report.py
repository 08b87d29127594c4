"""The page of the study: Markdown from what was found."""

from __future__ import annotations

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


def render(study: Study, machine: dict[str, Any], figures: str) -> str:
    """Write the page.

    Parameters
    ----------
    study : Study
        What was found.
    machine : dict
        What `benches.peers.machine.describe` found.
    figures : str
        Folder of the figures, as seen from the page.
    """
    cells = judged_cells(study)
    return markdown.page(
        [
            _head(study, machine),
            _result(study, cells),
            "## What a finer step changes, and what it costs",
            f"![Error against cost, of all cells together]({figures}/all.svg)",
            f"![Error of the rates against cost, for each model]({figures}/rates.svg)",
            f"![Error of the path against cost, for each model]({figures}/paths.svg)",
            _FIGURES,
            _settings(study),
            "## Models",
            _models(study),
            "## Cells that stand out",
            _standing_out(study, cells),
            "## All cells",
            _CELLS,
            _cells(study, cells),
        ]
    )


def _head(study: Study, machine: dict[str, Any]) -> str:
    runs = sum(f.runs for each in study.findings for f in each.by_setting.values())
    spent = sum(f.processor for each in study.findings for f in each.by_setting.values())
    failed = sum(f.failed for each in study.findings for f in each.by_setting.values())
    looks, curve = " or ".join(map(str, study.looks)), min(CURVE, study.looks[0])
    again = (
        f" A cell whose interval is undecided after {study.looks[0]} runs gets"
        f" {study.looks[-1]}; since it is looked at {len(study.looks)} times, each of its intervals"
        f" has a confidence of {_percent(1.0 - 0.1 / len(study.looks))} %, so that both together"
        " have 90 %, and its p-value is multiplied by the number of looks."
        if len(study.looks) > 1
        else ""
    )
    return f"""
# How exact rates are

What `make bench-accuracy` measures: how far the rates of clearing are from those of the finest
setting, here {study.reference}, and what each setting of the solver costs.

A *cell* is a robot, an obstacle and a population of starts: approach, track phase, speed and
friction vary as in `crawler2d.sweep`. Robot (the Engineer with another centre of mass, torque and
track model), friction, speed and obstacle were drawn; then the height was searched at which some
runs clear and some do not, because elsewhere errors hardly show. Every setting has the same draws,
so rates are compared run by run: {looks} runs of each cell with {study.default} and
{study.reference}, {curve} with the other settings.{again}

The default is chosen with set 1 of cells and judged with sets that are drawn afterwards. This is
set {study.number} (`benches/accuracy/sets/{study.number}.json`): {len(study.findings)} cells,
{runs:,} runs, {failed} of them without a result, {spent / 3600.0:.1f} hours of processor time,
until {machine["date"]}: {machine["processor"]}, {machine["cores"]} cores, {machine["system"]},
Python {machine["python"]}, crawler2d {machine["versions"]["crawler2d"]}, core
{", ".join(study.builds)}.
"""


def _result(study: Study, cells: Sequence[Judged]) -> str:
    if not cells:
        return f"## Result\n\nThere are no runs with {study.default}."
    found = mean_difference(study, study.default)
    of_models = [judge(model_difference(own), MODEL_BOUND) for own in models(cells).values()]
    of_cells = [each.verdict for each in cells]
    alone = [each for each in cells if each.p_value < 0.05]
    return f"""
## Result for {study.default}

- *Mean of all cells* within {MEAN_BOUND}: {_MEANING[judge(found, MEAN_BOUND)]},
  {_interval(found)} (95 %).
- *Models* within {MODEL_BOUND} (95 % each): {_tally(of_models)}.
- *Cells* within {CELL_BOUND} (90 % each): {_tally(of_cells)}.
- *Cells with another rate* than with {study.reference}: {len(alone)} of {len(cells)}
  (McNemar's test with Holm's correction, 5 %).
"""


_FIGURES = """
Each point is a setting; the ring marks the one that is judged. The *difference of rates* is that to
the finest setting, in size, the mean over cells with its 95 % interval (bootstrap over cells). The
dotted line is what it would be by chance alone if all rates were equal. The *path error* of a cell
is the median distance, at one time, between runs that both cleared: it grows with every moment that
one hesitates at an edge and the other does not. The point is the median over cells, the bar half of
them. Chaotic cells are left out there: those in which runs with the two finest settings differ at
least half as often as two new draws would, in either direction.
"""

_CELLS = """
Rates of clearing with the finest setting and the one that is judged; their difference, with the
interval of the cell; whether that is within the bound; the p-value after correction; processor time
in ms per simulated second with the setting that is judged. *Chaotic* cells are marked with a star.
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
                str(len(own)),
                _interval(found),
                f"{size.rate:.3f}",
                f"{chance:.3f}",
                str(beyond),
                _path(own, name),
                _short(1e3 * cost),
            ]
        )
    head = [
        *("setting", "cells", "mean difference (95 %)", "mean size", "size by chance"),
        *(f"cells beyond {CELL_BOUND}", "path error, median [mm]", "cost, median [ms/s]"),
    ]
    return markdown.table(head, rows)


def _models(study: Study) -> str:
    rows = []
    for name, own in models(judged_cells(study)).items():
        found = model_difference(own)
        findings = [each.finding for each in own]
        size = size_of_difference(findings, study.default)
        cost = median(each.figures.cost for each in own)
        fine = median(each.finding.by_setting[study.reference].cost for each in own)
        rows.append(
            [
                name,
                str(len(own)),
                _interval(found),
                _MEANING[judge(found, MODEL_BOUND)],
                f"{size.rate:.3f}",
                _path(findings, study.default),
                _short(1e3 * cost),
                _short(1e3 * fine),
            ]
        )
    head = [
        *("model", "cells", "mean difference (95 %)", f"within {MODEL_BOUND}?", "mean size"),
        *("path error, median [mm]", "cost [ms/s]", f"cost at {study.reference} [ms/s]"),
    ]
    return markdown.table(head, rows)


def _standing_out(study: Study, cells: Sequence[Judged]) -> str:
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


def _cells(study: Study, cells: Sequence[Judged]) -> str:
    rows = [
        [
            each.cell.name + ("*" if each.finding.is_chaotic else ""),
            _ground(each.finding),
            f"{1e3 * each.cell.height:.1f}",
            f"{each.finding.by_setting[study.reference].rate:.3f}",
            f"{each.figures.rate:.3f}",
            f"{each.interval.rate:+z.3f} ({each.interval.low:+z.3f} to {each.interval.high:+z.3f})",
            _MEANING[each.verdict],
            f"{each.p_value:.2g}",
            str(each.figures.pairs.runs),
            _short(1e3 * each.figures.cost),
        ]
        for each in cells
    ]
    head = [
        *("cell", "ground", "height [mm]", study.reference, study.default, "difference"),
        *(f"within {CELL_BOUND}?", "p", "runs", "cost [ms/s]"),
    ]
    return markdown.table(head, rows)


def _ground(found: Finding) -> str:
    cell = found.cell
    return f"{cell.obstacle['kind']}, {cell.friction:g}, {cell.max_torque:g} N m"


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
