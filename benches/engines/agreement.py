"""How runs of an engine compare with those that were predicted."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

from benches.engines.cells import Cell
from crawler2d.sweeps.statistics import newcombe, wilson

__all__ = ["Run", "Runs", "apart", "cleared", "pairs", "rate", "share"]

Run = Mapping[str, Any]
Runs = Mapping[str, Sequence[Run]]
"""Runs by the label of their cell, in the order of their draws."""


def cleared(runs: Iterable[Run]) -> int:
    """Count the runs that clear.

    Examples
    --------
    >>> cleared([{"end": "cleared"}, {"end": "stopped"}, {"end": "seized"}])
    1
    """
    return sum(run["end"] == "cleared" for run in runs)


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


def pairs(cells: Iterable[Cell], predicted: Runs, found: Runs) -> Iterator[tuple[Cell, Run, Run]]:
    """Yield cell, predicted and found run of each draw that an engine has run."""
    for cell in cells:
        own = found.get(cell.label, ())
        for one, other in zip(predicted[cell.label], own, strict=False):
            if not other["end"].startswith("refused"):
                yield cell, one, other


def share(of: Iterable[tuple[Cell, Run, Run]]) -> str:
    """Return in how many pairs both clear or both do not."""
    same = [(one["end"] == "cleared") == (other["end"] == "cleared") for _, one, other in of]
    return f"{sum(same)} of {len(same)}" if same else ""


def rate(runs: Sequence[Run]) -> str:
    """Return how many runs clear, and Wilson's 95 % interval of that rate in percent.

    Examples
    --------
    >>> rate([{"end": "cleared"}, {"end": "stopped"}])
    '1/2 (9 to 91)'
    """
    if not runs:
        return ""
    if runs[0]["end"].startswith("refused"):
        return "refused"
    interval = wilson(cleared(runs), len(runs))
    low, high = (100.0 * end for end in (interval.low, interval.high))
    return f"{cleared(runs)}/{len(runs)} ({low:.0f} to {high:.0f})"
