"""The verdicts of a study: on each cell, each model, and all cells together."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from benches.accuracy.cells import Cell
from benches.accuracy.findings import Figures, Finding, Study
from benches.accuracy.statistics import (
    CELL_BOUND,
    CONFIDENCE,
    Verdict,
    cell_interval,
    holm,
    judge,
    mean,
)
from crawler2d.sweeps.statistics import Interval, bootstrap_mean


class Judged(NamedTuple):
    """A cell with the setting that is judged."""

    finding: Finding
    figures: Figures
    interval: Interval
    verdict: Verdict
    p_value: float
    """Corrected for the number of looks and of cells."""

    @property
    def cell(self) -> Cell:
        """What it is about."""
        return self.finding.cell


def judged_cells(study: Study) -> list[Judged]:
    """Judge each cell that has runs with the setting in question."""
    found = study.judged()
    looks = len(study.looks)
    pairs = [each.by_setting[study.default].pairs for each in found]
    p_values = holm([min(1.0, looks * own.p_value) for own in pairs])
    intervals = [cell_interval(own, looks) for own in pairs]
    return [
        Judged(each, each.by_setting[study.default], interval, judge(interval, CELL_BOUND), p)
        for each, interval, p in zip(found, intervals, p_values, strict=True)
    ]


def models(cells: Sequence[Judged]) -> dict[str, list[Judged]]:
    """Group cells by model, in the order of the kinds."""
    groups: dict[str, list[Judged]] = {}
    for each in cells:
        groups.setdefault(each.cell.what.model, []).append(each)
    return groups


def model_difference(cells: Sequence[Judged]) -> Interval:
    """Estimate the mean difference of a model's cells; the cells themselves count as given."""
    return mean([each.figures.pairs.interval(CONFIDENCE) for each in cells])


def mean_difference(study: Study, setting: str) -> Interval:
    """Estimate the mean difference over all cells.

    The wider of two intervals counts at each end: that of the given cells, whose runs vary, and
    the bootstrap over cells, which were drawn themselves.
    """
    own = [each.by_setting[setting].pairs for each in study.findings if setting in each.by_setting]
    given = mean([pairs.interval(CONFIDENCE) for pairs in own])
    drawn = bootstrap_mean([pairs.difference for pairs in own], CONFIDENCE)
    return Interval(given.rate, min(given.low, drawn.low), max(given.high, drawn.high))


def size_of_difference(findings: Sequence[Finding], setting: str) -> Interval:
    """Estimate the mean size of the differences: bootstrap over cells."""
    sizes = [abs(each.by_setting[setting].pairs.difference) for each in findings]
    return bootstrap_mean(sizes, CONFIDENCE)


def undecided(study: Study) -> list[Cell]:
    """List the cells that need more runs: their interval is neither inside nor outside."""
    return [each.cell for each in judged_cells(study) if each.verdict == "open"]
