"""Tables for a terminal, for pages in Markdown, and as CSV."""

import csv
import dataclasses
import operator
import re
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import product
from pathlib import Path
from typing import Any, TypeVar

import xarray

_Row = TypeVar("_Row")


def mm(length: float, digits: int = 0) -> str:
    """Write a length [m] in millimetres."""
    return f"{1e3 * length:.{digits}f}"


def in_mm(heights: Iterable[float]) -> str:
    """Write heights [m] in millimetres, separated by commas."""
    return ", ".join(map(mm, heights))


def gaps(heights: Sequence[float]) -> str:
    """Write, in brackets, heights [m] that were not cleared below one that was."""
    return f" (not {in_mm(heights)})" if heights else ""


def percent(rate: float) -> str:
    """Write a rate [-] in whole per cent."""
    return f"{100 * rate:.0f}"


def counts(names: Iterable[str]) -> str:
    """Write how often each name occurs, the commonest first.

    Examples
    --------
    >>> counts(["stalled", "seized", "stalled"])
    '2 stalled, 1 seized'
    """
    return ", ".join(f"{n} {name}" for name, n in Counter(names).most_common())


def group_by(rows: Iterable[_Row], *names: str) -> dict[Any, list[_Row]]:
    """Group rows by one or more of their fields or keys, in the order of their appearance.

    Returns
    -------
    dict of (str or tuple) to list
        By the value of the field, or by the values of several.
    """
    of_field, of_key = operator.attrgetter(*names), operator.itemgetter(*names)
    groups = dict[Any, list[_Row]]()
    for row in rows:
        key = of_key(row) if isinstance(row, dict) else of_field(row)
        groups.setdefault(key, []).append(row)
    return groups


def cells_of(table: xarray.Dataset, *dims: str) -> Iterator[dict[str, Any]]:
    """Yield the coordinates of every cell along some dimensions, as `table.sel` takes them."""
    for values in product(*(table[dim].to_numpy().tolist() for dim in dims)):
        yield dict(zip(dims, values, strict=True))


def aligned_table(rows: Iterable[Mapping[str, str]], left: Iterable[str] = ()) -> str:
    """Write rows with the same keys as columns.

    The first column and those in `left` are aligned to the left, others to the right.

    Examples
    --------
    >>> print(aligned_table([{"model": "belt", "rate": "1.0"}]))
    model  rate
    -----  ----
    belt    1.0
    """
    rows = list(rows)
    lines = [list(rows[0]), *(list(row.values()) for row in rows)]
    widths = [max(map(len, column)) for column in zip(*lines, strict=True)]
    lines.insert(1, ["-" * width for width in widths])
    to_left = [index == 0 or name in left for index, name in enumerate(rows[0])]
    return "\n".join(
        "  ".join(
            cell.ljust(width) if is_left else cell.rjust(width)
            for cell, width, is_left in zip(line, widths, to_left, strict=True)
        ).rstrip()
        for line in lines
    )


def table(rows: Iterable[Mapping[str, str]]) -> str:
    """Write rows with the same keys, which become the head, as a table in Markdown.

    Examples
    --------
    >>> print(table([{"model": "belt", "rate": "1.0"}]))
    | model | rate |
    |---|---|
    | belt | 1.0 |
    """
    rows = list(rows)
    return markdown_table(list(rows[0]), [list(row.values()) for row in rows]) if rows else "None."


def markdown_table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Write a table.

    Examples
    --------
    >>> print(markdown_table(("model", "rate"), [("belt", "1.0")]))
    | model | rate |
    |---|---|
    | belt | 1.0 |
    """
    lines = [f"| {' | '.join(cells)} |" for cells in (head, *rows)]
    lines.insert(1, "|" + "---|" * len(head))
    return "\n".join(lines)


def splice(page: str, parts: Mapping[str, str]) -> str:
    r"""Insert parts between their marks in a page, ``<!-- name -->`` and ``<!-- end of name -->``.

    Parameters
    ----------
    page : str
        The page with marks, written by hand.
    parts : mapping of str to str
        Texts by name; those without marks in the page are left out.

    Returns
    -------
    str
        The page with these parts instead of the old ones.

    Examples
    --------
    >>> page = "Found:\n\n<!-- rates -->\nold\n<!-- end of rates -->\n"
    >>> print(splice(page, {"rates": "new"}))
    Found:
    <BLANKLINE>
    <!-- rates -->
    <BLANKLINE>
    new
    <BLANKLINE>
    <!-- end of rates -->
    <BLANKLINE>
    """
    for name, text in parts.items():
        begin, end = f"<!-- {name} -->", f"<!-- end of {name} -->"
        between = re.compile(f"{re.escape(begin)}.*?{re.escape(end)}", re.DOTALL)
        page = between.sub(lambda _, new=f"{begin}\n\n{text}\n\n{end}": new, page)  # type: ignore[misc]
    return page


def splice_into(page: Path, parts: Mapping[str, str]) -> None:
    """Put parts between their marks in the file of a page."""
    text = splice(page.read_text(encoding="utf-8"), parts)
    page.write_text(text, encoding="utf-8", newline="\n")


def write_csv(path: Path, rows: Sequence[Any]) -> None:
    """Write rows of one dataclass, with the names of its fields as the header."""
    names = [column.name for column in dataclasses.fields(rows[0])]
    with path.open("w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(names)
        for row in rows:
            values = (getattr(row, name) for name in names)
            writer.writerow(
                [" ".join(map(str, each)) if isinstance(each, tuple) else each for each in values]
            )
