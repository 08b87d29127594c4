"""Our rate beside the paper's: the difference, its interval, and whether the two agree."""

from __future__ import annotations

from dataclasses import dataclass

from crawler2d.sweeps.statistics import newcombe

__all__ = ["PAPER_RUNS", "WITHIN", "Agreement", "agreement"]

PAPER_RUNS = 20
"""Runs behind each percentage of the paper's Table 2."""

WITHIN = 0.15
"""[-] Rates that differ by no more than this agree: three of the paper's 20 runs."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Agreement:
    """A rate of ours less one of the paper."""

    difference: float
    """[-] Ours less the paper's."""
    low: float
    """[-] Of Newcombe's 95 % interval, both rates taken as binomial."""
    high: float
    verdict: str
    """"agrees" within `WITHIN`; else "differs", or "open" if the interval holds 0."""


def agreement(successes: int, count: int, share: float, runs: int = PAPER_RUNS) -> Agreement:
    """Compare a rate of ours with a percentage of the paper.

    The verdict is about the two rates as they are. With 20 runs on one side no interval is ever
    within `WITHIN`: 0 of 20 beside 0 of 100 gives -0.16 to 0.04.

    Parameters
    ----------
    successes, count : int
        Ours.
    share : float
        [-] The paper's, a whole number of its runs.
    runs : int
        How many runs the paper made.

    Raises
    ------
    ValueError
        If the share is not one of that many runs, or there are no runs of ours.

    Examples
    --------
    >>> agreement(90, 100, 1.0).verdict, agreement(50, 100, 1.0).verdict
    ('agrees', 'differs')
    >>> agreement(3, 5, 0.4).verdict
    'open'
    """
    theirs = round(share * runs)
    if abs(theirs - share * runs) > 1e-9 * runs:
        raise ValueError(f"share must be a whole number of {runs} runs, got {share}")
    difference, low, high = newcombe(successes, count, theirs, runs)
    # Rates are ratios of small whole numbers: 0.15 is no exact binary fraction.
    if abs(difference) <= WITHIN + 1e-12:
        verdict = "agrees"
    else:
        verdict = "open" if low <= 0.0 <= high else "differs"
    return Agreement(difference=difference, low=low, high=high, verdict=verdict)
