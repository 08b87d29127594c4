"""Which drives the paper's Table 2 leaves, in Markdown."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from research.markdown import markdown_table
from research.paper.fields import BESIDE_TABLE_2

if TYPE_CHECKING:
    from research.paper.joint import DriveCell, Judged

__all__ = ["drives_text"]


def drives_text(rows: Sequence[DriveCell], verdicts: Sequence[Judged]) -> str:
    """Tell how many runs there are, how many drives are left, and which come nearest."""
    runs = []
    for model in BESIDE_TABLE_2:
        counts = [row.count for row in rows if row.model == model]
        least, most = min(counts), max(counts)
        runs.append(f"{least if least == most else f'{least} to {most}'} of {model}")
    drives = {(row.torque, row.inertia) for row in rows}
    frictions = ", ".join(f"{each:g}" for each in sorted({row.friction for row in rows}))
    head = (
        f"{sum(row.count for row in rows)} runs, of {len(drives)} drives at frictions of"
        f" {frictions}; runs a cell: {'; '.join(runs)}."
    )
    table = []
    for friction, reading in dict.fromkeys((each.friction, each.reading) for each in verdicts):
        own = [each for each in verdicts if (each.friction, each.reading) == (friction, reading)]
        left = [_drive(each) for each in own if each.is_left]
        # With few runs p is larger, as they exclude less; cells that differ come first therefore.
        best = min(own, key=lambda each: (each.differing, -each.probability, each.deviance))
        table.append(
            (
                f"{friction:g}",
                reading,
                f"{len(left)} of {len(own)}" + (f": {'; '.join(left)}" if left else ""),
                _drive(best),
                f"{best.probability:.2g}",
                f"{best.straight:.2g}",
                f"{best.differing} of {best.cells}",
                best.farthest,
            )
        )
    columns = (
        *(
            "friction",
            "gears read as",
            "drives left",
            "nearest drive",
            "p",
            "p without the diagonal",
            "cells that differ",
        ),
        "cells that are farthest off",
    )
    return f"{head}\n\n{markdown_table(columns, table)}"


def _drive(each: Judged) -> str:
    return f"{each.torque:g} N m, {each.inertia:g} kg m^2"
