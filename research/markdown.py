"""Tables and parts of pages in Markdown."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence

__all__ = ["markdown_table", "spliced"]


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


def spliced(page: str, parts: Mapping[str, str]) -> str:
    r"""Put parts between their marks in a page, ``<!-- name -->`` and ``<!-- end of name -->``.

    Parameters
    ----------
    page : str
        What is written by hand, with the marks.
    parts : mapping of str to str
        What is made, by name; those that the page has no marks for are left out.

    Returns
    -------
    str
        The page with these parts in the place of what was there.

    Examples
    --------
    >>> page = "Found:\n\n<!-- rates -->\nold\n<!-- end of rates -->\n"
    >>> print(spliced(page, {"rates": "new"}))
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
