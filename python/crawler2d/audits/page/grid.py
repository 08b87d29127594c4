"""Tables of a page: in rows where there is room, one below the other on a narrow screen."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence

from crawler2d.common.markup import escaped

__all__ = ["grid"]

_SHORT = ' class="short"'


def grid(
    head: Sequence[str], rows: Iterable[Sequence[str]], *, label: str, short: Collection[str] = ()
) -> str:
    """Write a table whose first column names its rows.

    Parameters
    ----------
    head : sequence of str, length n
        Titles of the columns, as text.
    rows : iterable of sequence of str, length n
        Cells as HTML.
    label : str
        What the table is, for those who do not see what stands round it.
    short : collection of str
        Titles of columns whose cells are so short that no line breaks in them.
    """
    titles = "".join(f'<th scope="col">{escaped(title)}</th>' for title in head)
    body = "".join(f"<tr>{_row(head, row, short)}</tr>" for row in rows)
    return (
        f'<table class="grid" aria-label="{escaped(label)}"><thead><tr>{titles}</tr></thead>'
        f"<tbody>{body}</tbody></table>"
    )


def _row(head: Sequence[str], cells: Sequence[str], short: Collection[str]) -> str:
    first, *others = cells
    values = "".join(
        f'<td data-head="{escaped(title)}"{_SHORT if title in short else ""}>'
        f"{f'<div>{cell}</div>' if cell else ''}</td>"
        for title, cell in zip(head[1:], others, strict=True)
    )
    return f'<th scope="row">{first}</th>{values}'
