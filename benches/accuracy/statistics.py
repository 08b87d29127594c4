"""Paired differences of rates, their intervals and tests, and whether they are small enough."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Literal, NamedTuple

import numpy as np

from benches.accuracy.ensemble import Row
from crawler2d.sweeps.statistics import Interval, mcnemar, newcombe_paired

LOOKS = (400, 1600)
"""Runs of a cell after which it is judged; it gets more only while its interval is undecided."""

CURVE = 100
"""Runs of a cell with the settings that only draw the curve of error against cost."""

CELL_BOUND, MODEL_BOUND, MEAN_BOUND = 0.08, 0.05, 0.02
"""[-] Differences of rates that are small enough: of a cell, of a model, of the mean."""

CELL_CONFIDENCE, CONFIDENCE = 0.90, 0.95
"""[-] Of a cell, over all its looks together; of models and of the mean."""

Verdict = Literal["inside", "outside", "open"]

# [-] From this share of the pairs that would differ if runs were drawn anew, a cell is chaotic.
_CHAOTIC = 0.5


class Pairs(NamedTuple):
    """How many pairs of runs with equal draws cleared in which way."""

    both: int
    only: int
    """Only the one with the setting."""
    reference: int
    """Only the one with the reference."""
    neither: int

    @property
    def runs(self) -> int:
        """Number of pairs."""
        return sum(self)

    @property
    def difference(self) -> float:
        """[-] Rate of the setting less that of the reference."""
        return (self.only - self.reference) / self.runs

    @property
    def by_chance(self) -> float:
        """[-] Mean size that the difference would have if the rates were equal."""
        return math.sqrt(2.0 / math.pi * (self.only + self.reference)) / self.runs

    @property
    def p_value(self) -> float:
        """[-] Of the hypothesis of equal rates, McNemar's exact test."""
        return mcnemar(self.only, self.reference)

    @property
    def is_chaotic(self) -> bool:
        """Whether pairs differ in both directions, almost as often as if drawn anew.

        Where all differ in one direction, the rate has moved, but the runs are not chaotic.
        """
        first, second = self.both + self.only, self.both + self.reference
        anew = (first * (self.runs - second) + second * (self.runs - first)) / self.runs
        return 2 * min(self.only, self.reference) >= _CHAOTIC * anew > 0.0

    def interval(self, confidence: float) -> Interval:
        """Estimate the difference with Newcombe's interval for paired data."""
        return newcombe_paired(*self, confidence)


def pair(rows: Mapping[int, Row], reference: Mapping[int, Row]) -> Pairs:
    """Count the repeats that both have; a run without a result has not cleared."""
    counts = {(True, True): 0, (True, False): 0, (False, True): 0, (False, False): 0}
    for repeat in rows.keys() & reference.keys():
        counts[_cleared(rows[repeat]), _cleared(reference[repeat])] += 1
    return Pairs(*counts.values())


def path_error(rows: Mapping[int, Row], reference: Mapping[int, Row], speed: float) -> float:
    """[m] Median distance, at one time, between pairs that both cleared; nan if there are none.

    Runs end at the same place beyond the obstacle, at different times; from there on both drive at
    the commanded speed. Where both stop, they end in the same equilibrium whatever came before.
    """
    apart = []
    for repeat in rows.keys() & reference.keys():
        ours, theirs = rows[repeat], reference[repeat]
        if _cleared(ours) and _cleared(theirs):
            lead = ours.x - theirs.x - speed * (ours.time - theirs.time)
            apart.append(math.hypot(lead, ours.y - theirs.y))
    return float(np.median(apart)) if apart else math.nan


def cell_interval(pairs: Pairs, looks: int) -> Interval:
    """Interval of a cell that may be looked at several times.

    Each look gets its share of the error, so that all intervals of a cell together hold with
    `CELL_CONFIDENCE`, whenever the looking ended.
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


def judge(interval: Interval, bound: float) -> Verdict:
    """Say whether an interval lies within -bound to bound, beyond it, or neither."""
    if -bound <= interval.low and interval.high <= bound:
        return "inside"
    if interval.high < -bound or interval.low > bound:
        return "outside"
    return "open"


def _cleared(row: Row) -> bool:
    return row.outcome == "cleared"
