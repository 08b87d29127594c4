"""Which drives the paper's Table 2 leaves: one likelihood ratio of all its cells at once.

The paper has k of 20 runs in a cell, and the simulation s of n. With Jeffreys' prior our runs give
the rate a beta distribution, so the chance of the paper's k is beta-binomial: few runs of ours make
it broad, and exclude little. Minus twice the logarithm of the chances of all cells, over those
under rates that are exactly the paper's, is the deviance. Rates of 0 and 1 are no place for its
asymptotic chi-squared distribution, and so its distribution is drawn: tables that the drive itself
gives. A drive is left if at least one in twenty of them is as far off as the paper's. The drives
that are left are a region of 95 % confidence, and it is empty if no drive gives the table.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from research.paper.agreement import PAPER_RUNS, agreement
from research.paper.fields import BESIDE_TABLE_2
from research.paper.layouts import GEAR_MODEL, GEAR_MODEL_OTHERWISE
from research.paper.published import CWA_ROUND, LWA_ROUND, TABLE_2

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["LEVEL", "TABLES", "DriveCell", "Judged", "Table", "judged", "layouts_left", "verdict"]

LEVEL = 0.05
"""[-] One less the confidence of the region."""

Table = Mapping[tuple[str, str], int]
"""How many of its 20 runs the paper has cleared, by field and layout."""


def _table(gear: str) -> Table:
    model = {column: layout for layout, column in BESIDE_TABLE_2.items()}
    return {
        (row.obstacle, model[column]): round(PAPER_RUNS * share)
        for row in TABLE_2
        for column, share in ((CWA_ROUND, row.cwa), (LWA_ROUND, row.lwa), (gear, row.gear))
    }


TABLES: Mapping[str, Table] = {
    "large gears": _table(GEAR_MODEL),
    "small gears": _table(GEAR_MODEL_OTHERWISE),
}
"""The nine cells of the paper's Table 2, by how the column of gears is read."""

_DRAWS = 20_000

DIAGONAL = "diagonal barrier"


@dataclass(frozen=True, slots=True, kw_only=True)
class DriveCell:
    """One layout in one field, driven by one drive."""

    torque: float
    """[N m] Of one sprocket."""
    inertia: float
    """[kg m^2] Of the rotor of one track, at its sprocket."""
    friction: float
    obstacle: str
    """As in `FIELDS`."""
    model: str
    cleared: int
    count: int
    """Runs with a result."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Judged:
    """What the paper's table says of one drive."""

    torque: float
    inertia: float
    friction: float
    reading: str
    """As in `TABLES`."""
    deviance: float
    """[-] Of all cells, from the table under rates that are exactly the paper's."""
    probability: float
    """[-] Of a deviance at least as large, if the paper's robot had this drive."""
    straight: float
    """[-] The same without the diagonal barrier, on which a robot may turn: a side view cannot."""
    differing: int
    """Cells whose rates differ, as in `Agreement`."""
    cells: int
    farthest: str
    """The cells with the largest shares of the deviance, as text."""

    @property
    def is_left(self) -> bool:
        """Whether the table leaves this drive."""
        return self.probability >= LEVEL


def judged(rows: Sequence[DriveCell], table: Table, reading: str = "") -> Judged:
    """Compare the cells of one drive with a table.

    Parameters
    ----------
    rows : sequence of DriveCell
        Of one drive; cells that the table lacks are passed over.
    table : mapping of pair of str to int
        Every cell of it must be among the rows.
    reading : str
        The name of the table.

    Raises
    ------
    ValueError
        If a cell of the table has no runs.
    """
    own = {(row.obstacle, row.model): row for row in rows if row.count}
    if missing := set(table) - set(own):
        raise ValueError(f"no runs of {sorted(missing)}")
    shares, probability = _tested(own, table)
    straight = {cell: hits for cell, hits in table.items() if cell[0] != DIAGONAL}
    farthest = sorted(zip(shares, table, strict=True), reverse=True)[:3]
    first = rows[0]
    return Judged(
        torque=first.torque,
        inertia=first.inertia,
        friction=first.friction,
        reading=reading,
        deviance=sum(shares),
        probability=probability,
        straight=_tested(own, straight)[1],
        differing=sum(verdict(own[cell], hits) == "differs" for cell, hits in table.items()),
        cells=len(table),
        farthest="; ".join(
            f"{model}, {obstacle}: {own[obstacle, model].cleared} of {own[obstacle, model].count},"
            f" the paper {table[obstacle, model]} of {PAPER_RUNS}"
            for _, (obstacle, model) in farthest
        ),
    )


def _tested(own: Mapping[tuple[str, str], DriveCell], table: Table) -> tuple[list[float], float]:
    """Return each cell's share of the deviance, and the chance of so large a sum."""
    chances = [_chances(own[cell].cleared, own[cell].count) for cell in table]
    deviances = [2.0 * (_EXACT - np.log(each)) for each in chances]
    shares = [float(each[hits]) for each, hits in zip(deviances, table.values(), strict=True)]
    # The seed is fixed: equal counts give equal probabilities.
    rng = np.random.default_rng(0)
    drawn = sum(
        each[rng.choice(PAPER_RUNS + 1, size=_DRAWS, p=chance)]
        for each, chance in zip(deviances, chances, strict=True)
    )
    # Sums of the same terms in another order differ by rounding.
    farther = int(np.count_nonzero(drawn >= sum(shares) - 1e-9))
    return shares, (farther + 1) / (_DRAWS + 1)


def layouts_left(rows: Sequence[DriveCell]) -> set[str]:
    """Name the layouts of those readings of the paper's table that leave the drive of these cells.

    Their runs are worth repeating; more runs of others would exclude the same.
    """
    left = [table for table in TABLES.values() if judged(rows, table).is_left]
    return {model for table in left for _, model in table}


def verdict(row: DriveCell, hits: int) -> str:
    """Return whether a rate of ours agrees with one of the paper; see `Agreement`."""
    return agreement(row.cleared, row.count, hits / PAPER_RUNS).verdict


def _chances(cleared: int, count: int) -> NDArray[np.float64]:
    """Return the chance of 0 to 20 of the paper's runs: beta-binomial, with Jeffreys' prior."""
    a, b = cleared + 0.5, count - cleared + 0.5
    logs = [
        _log_choices(hits) + _log_beta(a + hits, b + PAPER_RUNS - hits) - _log_beta(a, b)
        for hits in range(PAPER_RUNS + 1)
    ]
    chances: NDArray[np.float64] = np.exp(logs)
    chances /= chances.sum()  # 1, but for rounding
    return chances


def _log_choices(hits: int) -> float:
    return -math.log(PAPER_RUNS + 1) - _log_beta(hits + 1, PAPER_RUNS - hits + 1)


def _log_beta(a: float, b: float) -> float:
    return math.lgamma(a) + math.lgamma(b) - math.lgamma(a + b)


def _log_power(rate: float, hits: int) -> float:
    return hits * math.log(rate) if hits else 0.0


_EXACT = np.array(
    [
        _log_choices(hits)
        + _log_power(hits / PAPER_RUNS, hits)
        + _log_power(1.0 - hits / PAPER_RUNS, PAPER_RUNS - hits)
        for hits in range(PAPER_RUNS + 1)
    ]
)
"""[-] The logarithm of the chance of 0 to 20 runs under the rate that they give."""
