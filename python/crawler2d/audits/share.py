"""A share of runs: over all of them with an interval, and of single robots as a band."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from crawler2d.sweeps.sequential import sequential
from crawler2d.sweeps.statistics import clustered

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["Share", "share_of"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Share:
    """How often something happened over one obstacle.

    Parameters
    ----------
    rate : float
        [-] Of all runs with a result; nan without one.
    low, high : float
        [-] 95 % interval of that, with the samples of the unknowns as its clusters: see
        `sweeps.statistics.clustered`; of fewer runs than were planned, see `share_of`. Without
        unknowns every repeat counts.
    band_low, band_median, band_high : float
        [-] Of the rates of single samples, each a robot on a floor, 5, 50 and 95 %; without
        unknowns all are the rate.
    runs, samples : int
        Runs with a result, and samples that have some.
    """

    rate: float
    low: float
    high: float
    band_low: float
    band_median: float
    band_high: float
    runs: int
    samples: int


def share_of(
    happened: NDArray[np.bool_], made: NDArray[np.bool_], *, is_stopped: bool = False
) -> Share:
    """Count how often something happened.

    Parameters
    ----------
    happened, made : ndarray of bool, shape (samples, repeats)
        Whether it happened in a run, and whether the run has a result.
    is_stopped : bool
        Whether what came decided that no more runs were made: then the interval is that of
        `sweeps.sequential`, which holds however often one looks.

    Examples
    --------
    Twenty robots in four runs each; five seize in every run, one in half of them:

    >>> happened = np.zeros((20, 4), dtype=bool)
    >>> happened[:5], happened[5, :2] = True, True
    >>> share = share_of(happened, np.ones((20, 4), dtype=bool))
    >>> share.rate, share.band_median, share.band_high
    (0.275, 0.0, 1.0)
    >>> round(share.low, 3), round(share.high, 3)  # about as 5 or 6 robots in 20
    (0.131, 0.488)
    """
    hits, counts = (happened & made).sum(axis=1), made.sum(axis=1)
    rates = hits[counts > 0] / counts[counts > 0]
    if not rates.size:
        return Share(
            rate=math.nan,
            low=0.0,
            high=1.0,
            band_low=math.nan,
            band_median=math.nan,
            band_high=math.nan,
            runs=0,
            samples=0,
        )
    rate, low, high = clustered(hits, counts)
    if is_stopped:
        _, low, high = sequential(int(hits.sum()), int(counts.sum()))
    band = np.quantile(rates, (0.05, 0.5, 0.95))
    return Share(
        rate=rate,
        low=low,
        high=high,
        band_low=float(band[0]),
        band_median=float(band[1]),
        band_high=float(band[2]),
        runs=int(counts.sum()),
        samples=int(rates.size),
    )
