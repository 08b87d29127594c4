"""Tables for a terminal: cells under a header, lengths in millimetres."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

__all__ = ["aligned", "in_mm", "mm", "percent"]


def mm(length: float) -> str:
    """Write a length [m] in millimetres."""
    return f"{1e3 * length:.0f}"


def percent(share: float) -> str:
    """Write a share [-] in whole per cent."""
    return f"{100 * share:.0f}"


def in_mm(heights: Iterable[float]) -> str:
    """Write heights [m] in millimetres, separated by commas."""
    return ", ".join(map(mm, heights))


def aligned(header: Sequence[str], rows: Iterable[Sequence[str]], left: Iterable[int] = ()) -> str:
    """Write rows as columns: the first one and those in `left` flush left, others flush right."""
    lines = [list(header), *map(list, rows)]
    widths = [max(map(len, column)) for column in zip(*lines, strict=True)]
    lines.insert(1, ["-" * width for width in widths])
    to_left = {0, *left}
    return "\n".join(
        "  ".join(
            cell.ljust(width) if index in to_left else cell.rjust(width)
            for index, (cell, width) in enumerate(zip(line, widths, strict=True))
        ).rstrip()
        for line in lines
    )
