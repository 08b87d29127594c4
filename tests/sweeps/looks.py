"""Exact results for a rate that is checked after every run, from all possible outcomes.

    python -m tests.sweeps.looks

prints the tables of docs/studies/stopping.md.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

from crawler2d import wilson
from crawler2d.sweeps.sequential import Until, sequential
from crawler2d.sweeps.statistics import Interval

Flags = NDArray[np.bool_]
"""Of every number of runs, and of every number of successes among them."""

MOST = 500
RATES = (0.02, 0.1, 0.25, 0.4, 0.5)
# Rates above a half mirror those below, by symmetry of successes and failures.
UP_TO_HALF = tuple(each / 100 for each in range(1, 51))
LEAST = 10
"""Runs before anybody looks at Wilson's interval."""


@dataclass(frozen=True)
class Looks:
    """All intervals of a kind, by number of runs and of successes."""

    low: NDArray[np.float64]
    high: NDArray[np.float64]

    @staticmethod
    def of(estimate: Callable[[int, int], Interval], most: int = MOST) -> "Looks":
        """Estimate from up to a number of runs; more successes than runs give 0 to 1.

        A failure rate is estimated as a success rate is, so half of these mirror the others.
        """
        low, high = np.zeros((most + 1, most + 1)), np.ones((most + 1, most + 1))
        for n in range(1, most + 1):
            for k in range(n // 2 + 1):
                _, low[n, k], high[n, k] = estimate(k, n)
                low[n, n - k], high[n, n - k] = 1.0 - high[n, k], 1.0 - low[n, k]
        return Looks(low, high)

    def misses(self, rate: float) -> Flags:
        """Which intervals do not contain a rate."""
        return (self.low > rate) | (self.high < rate)

    def stops(self, until: Until) -> Flags:
        """Which of these intervals end a cell: `Until.is_done` with any kind of interval."""
        runs = np.arange(len(self.low))[:, np.newaxis]
        enough = self.high - self.low <= until.width
        if until.threshold is not None:
            enough |= self.misses(until.threshold)
        return (runs >= until.min_runs) & enough | (runs >= until.max_runs)


@cache
def sequentials() -> Looks:
    """The tested intervals."""
    return Looks.of(sequential)


@cache
def wilsons() -> Looks:
    """Intervals for a single check; they are wrong for more."""
    return Looks.of(wilson)


def endings(rate: float, ends: Flags) -> NDArray[np.float64]:
    """Return the probability of every end, by number of runs and of successes.

    Runs go on until their numbers are among `ends`; those that never get there are missing.
    """
    found = np.zeros(ends.shape)
    left = np.zeros(ends.shape[1])
    left[0] = 1.0
    for n in range(1, len(ends)):
        now, over = left[: n + 1], ends[n, : n + 1]  # no more successes than runs
        now[1:] = now[1:] * (1.0 - rate) + now[:-1] * rate
        now[0] *= 1.0 - rate
        found[n, : n + 1] = np.where(over, now, 0.0)
        now[over] = 0.0
    return found


def ever_missed(looks: Looks, rate: float, least: int = 1) -> float:
    """Return the probability that any interval from `least` runs on does not contain the rate."""
    runs = np.arange(len(looks.low))[:, np.newaxis]
    return float(endings(rate, looks.misses(rate) & (runs >= least)).sum())


def missed_at_the_end(looks: Looks, rate: float, until: Until) -> float:
    """Return the probability that the final interval of a cell does not contain the rate."""
    return float(endings(rate, looks.stops(until))[looks.misses(rate)].sum())


def expected_runs(rate: float, ends: Flags) -> float:
    """Return the mean number of runs until one of the ends, which almost all must reach."""
    found = endings(rate, ends)
    assert found.sum() > 1.0 - 1e-6
    return float(found.sum(axis=1) @ np.arange(len(ends)))


def wilson_runs(rate: float, width: float) -> int:
    """Return the number of runs from which Wilson's interval of this rate is at most this wide."""
    wide = 0
    for n in range(1, MOST + 1):
        _, low, high = wilson(round(rate * n), n)
        if high - low > width:
            wide = n
    return wide + 1


def binomial_runs(rate: float, power: float) -> int:
    """Return the number of runs from which the exact two-sided test against 1/2 has this power.

    The test's level is 5 %.
    """
    from scipy import stats  # type: ignore[import-untyped] # noqa: PLC0415

    for n in range(MOST, 0, -1):
        k = np.arange(n + 1)
        tails = 2.0 * stats.binom.cdf(np.minimum(k, n - k), n, 0.5)
        if stats.binom.pmf(k[tails <= 0.05], n, rate).sum() < power:
            return n + 1
    return 1


def wrong_rows() -> Iterator[list[str]]:
    """Yield the table of how often intervals are wrong."""
    kinds = ("Wilson", "sequential")
    yield ["rate", *(f"{kind}, {when}" for when in ("any check", "at the end") for kind in kinds)]
    until = Until(threshold=0.5)
    shares = {
        rate: (
            ever_missed(wilsons(), rate, LEAST),
            ever_missed(sequentials(), rate),
            missed_at_the_end(wilsons(), rate, until),
            missed_at_the_end(sequentials(), rate, until),
        )
        for rate in UP_TO_HALF
    }
    rows = {str(rate): shares[rate] for rate in RATES}
    rows["the worst"] = tuple(np.max(list(shares.values()), axis=0))
    for name, row in rows.items():
        yield [name, *(f"{100.0 * share:.1f} %" for share in row)]


def cost_rows() -> Iterator[list[str]]:
    """Yield the table of costs."""
    yield ["rate", "width 0.2", "Wilson", "side of 0.5", "test", "either"]
    looks = sequentials()
    for rate in (0.02, 0.1, 0.25, 0.5):
        undecided = rate == 0.5
        yield [
            "0.5" if undecided else f"{rate} or {1.0 - rate}",
            f"{expected_runs(rate, looks.high - looks.low <= 0.2):.0f}",
            f"{wilson_runs(rate, 0.2)}",
            "-" if undecided else f"{expected_runs(rate, looks.misses(0.5)):.0f}",
            "-" if undecided else f"{binomial_runs(rate, 0.95)}",
            f"{expected_runs(rate, looks.stops(Until(threshold=0.5))):.0f}",
        ]


def lines(rows: Iterator[Sequence[str]]) -> list[str]:
    """Write a table in Markdown."""
    head, *body = rows
    return [f"| {' | '.join(row)} |" for row in (head, ["---"] * len(head), *body)]


if __name__ == "__main__":
    for table in (wrong_rows(), cost_rows()):
        print("\n".join(lines(table)), end="\n\n")
