"""Results of the stored runs: paired differences of rates, intervals, tests and verdicts.

A verdict says whether a difference lies within a bound, for a cell, a model or all cells.
"""

import math
from collections import Counter
from collections.abc import Mapping, Sequence
from itertools import product
from typing import Literal, NamedTuple, TypeVar

import numpy as np

from benches.accuracy.cells import Cell, Setting
from benches.accuracy.runs import FAILED, Row, Store
from crawler2d import newcombe_paired
from crawler2d.sweeps.statistics import Interval, bootstrap_mean, mcnemar
from research.tables import group_by

LOOKS = (400, 1600)
"""Runs of a cell after which it gets a verdict; it gets more only if its interval is open."""

CURVE = 100
"""Runs of a cell with the settings that are used only for the curve of error against cost."""

CELL_BOUND, MODEL_BOUND, MEAN_BOUND = 0.08, 0.05, 0.02
"""[-] Largest acceptable differences of rates: for a cell, a model and the mean."""

CELL_CONFIDENCE, CONFIDENCE = 0.90, 0.95
"""[-] Confidence for a cell, over all its checks together, and for models and the mean."""

Verdict = Literal["inside", "outside", "open"]

# [-] A cell is chaotic if pairs differ in at least this fraction of the cases of new draws.
_CHAOTIC = 0.5


class Pairs(NamedTuple):
    """Numbers of pairs of runs with equal draws in which both, one or none cleared."""

    both: int
    only: int
    """Only the run with the setting cleared."""
    reference: int
    """Only the run with the reference cleared."""
    neither: int

    @property
    def runs(self) -> int:
        """Number of pairs."""
        return sum(self)

    @property
    def difference(self) -> float:
        """[-] Rate of the setting minus that of the reference."""
        return (self.only - self.reference) / self.runs

    @property
    def by_chance(self) -> float:
        """[-] Mean size of the difference if the rates were equal."""
        return math.sqrt(2.0 / math.pi * (self.only + self.reference)) / self.runs

    @property
    def p_value(self) -> float:
        """[-] p-value of the hypothesis of equal rates, by McNemar's exact test."""
        return mcnemar(self.only, self.reference)

    @property
    def is_chaotic(self) -> bool:
        """Whether pairs differ in both directions, almost as often as with new draws.

        Where all differ in one direction, the rate has moved, but the runs are not chaotic.
        """
        first, second = self.both + self.only, self.both + self.reference
        anew = (first * (self.runs - second) + second * (self.runs - first)) / self.runs
        return 2 * min(self.only, self.reference) >= _CHAOTIC * anew > 0.0

    def interval(self, confidence: float) -> Interval:
        """Estimate the difference with Newcombe's interval for paired data."""
        return newcombe_paired(*self, confidence)


def pair(rows: Mapping[int, Row], reference: Mapping[int, Row]) -> Pairs:
    """Count the common repeats; a run without a result counts as not cleared."""
    shared = rows.keys() & reference.keys()
    counts = Counter((_cleared(rows[each]), _cleared(reference[each])) for each in shared)
    return Pairs(*(counts[ours, theirs] for ours, theirs in product((True, False), repeat=2)))


def path_error(rows: Mapping[int, Row], reference: Mapping[int, Row], speed: float) -> float:
    """[m] Median distance, at one time, between pairs that both cleared; NaN if there are none.

    Runs end at the same place beyond the obstacle, at different times; from there on both drive at
    the commanded speed. Where both stop, they end in the same equilibrium whatever happened before.
    """
    both = ((rows[repeat], reference[repeat]) for repeat in rows.keys() & reference.keys())
    apart = [
        math.hypot(ours.x - theirs.x - speed * (ours.time - theirs.time), ours.y - theirs.y)
        for ours, theirs in both
        if _cleared(ours) and _cleared(theirs)
    ]
    return float(np.median(apart)) if apart else math.nan


def cell_interval(pairs: Pairs, looks: int) -> Interval:
    """Interval of a cell that may be checked several times.

    Each check gets its part of the error, so that all intervals of a cell together hold with
    `CELL_CONFIDENCE`, whenever the checks end.
    """
    return pairs.interval(1.0 - (1.0 - CELL_CONFIDENCE) / looks)


def holm(p_values: Sequence[float]) -> list[float]:
    """Correct p-values for their number: Holm's step-down procedure.

    References
    ----------
    Holm, S. (1979). A simple sequentially rejective multiple test procedure. Scandinavian Journal
    of Statistics 6, 65-70.
    """
    corrected = [0.0] * len(p_values)
    largest = 0.0
    for rank, index in enumerate(np.argsort(p_values, kind="stable")):
        largest = max(largest, min(1.0, (len(p_values) - rank) * p_values[index]))
        corrected[index] = largest
    return corrected


def mean(intervals: Sequence[Interval]) -> Interval:
    """Estimate the mean of independent estimates: the sides of their intervals, square and add.

    References
    ----------
    Zou, G. Y. and Donner, A. (2008). Construction of confidence limits about effect measures: a
    general approach. Statistics in Medicine 27, 1693-1702.
    """
    count = len(intervals)
    center = sum(each.rate for each in intervals) / count
    below = math.hypot(*(each.rate - each.low for each in intervals)) / count
    above = math.hypot(*(each.high - each.rate for each in intervals)) / count
    return Interval(center, center - below, center + above)


def verdict_of(interval: Interval, bound: float) -> Verdict:
    """Return whether an interval lies within -bound to bound, beyond it, or neither."""
    if -bound <= interval.low and interval.high <= bound:
        return "inside"
    if interval.high < -bound or interval.low > bound:
        return "outside"
    return "open"


def _cleared(row: Row) -> bool:
    return row.outcome == "cleared"


class Figures(NamedTuple):
    """A cell with one setting."""

    runs: int
    failed: int
    """Runs without a result; they count as not cleared."""
    rate: float
    cost: float
    """[-] Processor time per simulated time."""
    processor: float
    """[s] Processor time of all runs."""
    pairs: Pairs
    """Comparison with the runs of the reference."""
    path: float
    """[m] See `path_error`."""


class Finding(NamedTuple):
    """A cell with every setting that has runs."""

    cell: Cell
    by_setting: dict[str, Figures]
    is_chaotic: bool
    """Whether the last setting before the reference differs from it as much as new draws."""


class Study(NamedTuple):
    """The data of the page."""

    number: int
    """Number of the set of cells."""
    findings: list[Finding]
    settings: Mapping[str, Setting]
    """Settings by name, the finest last."""
    reference: str
    """Name of the setting that the others are compared with, the finest."""
    default: str
    """Name of the setting that gets the verdicts."""
    looks: tuple[int, ...]
    """See `LOOKS`."""
    builds: list[str]

    def with_default(self) -> list[Finding]:
        """List the cells that have runs with the default."""
        return [each for each in self.findings if self.default in each.by_setting]


def collect(
    store: Store, cells: Sequence[Cell], settings: Mapping[str, Setting], reference: str
) -> list[Finding]:
    """Read the runs of each cell that has runs with the reference."""
    found = []
    for cell in cells:
        rows = {name: store.rows(cell, setting) for name, setting in settings.items()}
        if not rows[reference]:
            continue
        figures = {
            name: _figures(own, rows[reference], cell.speed)
            for name, own in rows.items()
            if own.keys() & rows[reference].keys()
        }
        finest = [name for name in figures if name != reference][-1:]
        is_chaotic = any(figures[name].pairs.is_chaotic for name in finest)
        found.append(Finding(cell, figures, is_chaotic))
    return found


def _figures(rows: Mapping[int, Row], reference: Mapping[int, Row], speed: float) -> Figures:
    processor = sum(row.processor for row in rows.values())
    simulated = sum(row.time for row in rows.values())
    return Figures(
        runs=len(rows),
        failed=sum(row.outcome == FAILED for row in rows.values()),
        rate=sum(row.outcome == "cleared" for row in rows.values()) / len(rows),
        cost=processor / simulated if simulated else 0.0,
        processor=processor,
        pairs=pair(rows, reference),
        path=path_error(rows, reference, speed),
    )


class CellVerdict(NamedTuple):
    """The verdict on a cell with the default setting."""

    finding: Finding
    figures: Figures
    interval: Interval
    verdict: Verdict
    p_value: float
    """p-value, corrected for the number of checks and of cells."""

    @property
    def cell(self) -> Cell:
        """Its subject."""
        return self.finding.cell


def cell_verdicts(study: Study) -> list[CellVerdict]:
    """Return the verdict on each cell that has runs with the default setting."""
    found = study.with_default()
    looks = len(study.looks)
    pairs = [each.by_setting[study.default].pairs for each in found]
    p_values = holm([min(1.0, looks * own.p_value) for own in pairs])
    intervals = [cell_interval(own, looks) for own in pairs]
    return [
        CellVerdict(
            each, each.by_setting[study.default], interval, verdict_of(interval, CELL_BOUND), p
        )
        for each, interval, p in zip(found, intervals, p_values, strict=True)
    ]


OfCell = TypeVar("OfCell", Finding, CellVerdict)


def models(cells: Sequence[OfCell]) -> dict[str, list[OfCell]]:
    """Group cells by model, in the order of the kinds."""
    return group_by(cells, "cell.what.model")


def model_difference(cells: Sequence[CellVerdict]) -> Interval:
    """Estimate the mean difference of a model's cells, which are taken as given."""
    return mean([each.figures.pairs.interval(CONFIDENCE) for each in cells])


def mean_difference(study: Study, setting: str) -> Interval:
    """Estimate the mean difference over all cells.

    At each end, the wider of two intervals counts: that of the given cells, whose runs vary, and
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
    return [each.cell for each in cell_verdicts(study) if each.verdict == "open"]
