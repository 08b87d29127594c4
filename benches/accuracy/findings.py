"""What the stored runs say of each cell with each setting."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

from benches.accuracy.cells import Cell, Setting
from benches.accuracy.ensemble import FAILED, Row
from benches.accuracy.statistics import Pairs, pair, path_error
from benches.accuracy.store import Store


class Figures(NamedTuple):
    """A cell with one setting."""

    runs: int
    failed: int
    """Those without a result; they count as not cleared."""
    rate: float
    cost: float
    """[-] Processor time per simulated time."""
    processor: float
    """[s] Processor time of all runs."""
    pairs: Pairs
    """With the runs of the reference."""
    path: float
    """[m] See `statistics.path_error`."""


class Finding(NamedTuple):
    """A cell with every setting that has runs."""

    cell: Cell
    by_setting: dict[str, Figures]
    is_chaotic: bool
    """Whether the last setting before the reference differs from it as new draws would."""


class Study(NamedTuple):
    """All that a report needs."""

    number: int
    """Of the set of cells."""
    findings: list[Finding]
    settings: Mapping[str, Setting]
    """By name, the finest last."""
    reference: str
    """Name of the setting that the others are compared with, the finest."""
    default: str
    """Name of the setting that is judged."""
    looks: tuple[int, ...]
    """See `statistics.LOOKS`."""
    builds: list[str]

    def judged(self) -> list[Finding]:
        """List the cells that have runs with the setting that is judged."""
        return [each for each in self.findings if self.default in each.by_setting]


def collect(
    store: Store, cells: Sequence[Cell], settings: Mapping[str, Setting], reference: str
) -> list[Finding]:
    """Read the runs of each cell that has some of the reference."""
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
