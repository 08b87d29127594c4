"""A table of columns: contacts, edges and events of a run."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from crawler2d.common.extras import extra
from crawler2d.common.frozen import read_only

if TYPE_CHECKING:
    import pandas
    from numpy.typing import NDArray

__all__ = ["Table"]

# How many rows of a table a notebook shows.
_SHOWN = 10


class Table(Mapping[str, "NDArray[Any]"]):
    """Columns of equal length, read-only, by name.

    Parameters
    ----------
    columns : mapping of str to array_like, or callable
        The columns in order; a list becomes an array of strings, or of objects if it holds tuples.
        A callable makes them when they are first used.

    Examples
    --------
    >>> table = Table({"x": [0.0, 0.5], "kind": ["stop", "stop"]})
    >>> len(table), list(table), table["x"].tolist()
    (2, ['x', 'kind'], [0.0, 0.5])
    """

    __slots__ = ("_given", "_made")

    # As with arrays, comparing columns has no single answer: a table equals only itself.
    __eq__ = object.__eq__
    __hash__ = object.__hash__

    def __init__(self, columns: Mapping[str, Any] | Callable[[], Mapping[str, Any]]) -> None:
        self._given = columns
        self._made = None if callable(columns) else _frozen(columns)

    @property
    def _columns(self) -> dict[str, NDArray[Any]]:
        if self._made is None:
            self._made = _frozen(self._given() if callable(self._given) else self._given)
        return self._made

    def __getitem__(self, name: str) -> NDArray[Any]:
        """Return one column, shape (n,)."""
        return self._columns[name]

    def __iter__(self) -> Iterator[str]:
        """Iterate over the names of the columns."""
        return iter(self._columns)

    def __len__(self) -> int:
        """Count the rows."""
        return len(next(iter(self._columns.values()), ()))

    def __bool__(self) -> bool:
        """Tell whether there is any row."""
        return len(self) > 0

    def __reduce__(self) -> tuple[type[Table], tuple[dict[str, Any]]]:
        """Pickle the columns; they are read-only again in the copy."""
        return Table, (self._columns,)

    def __repr__(self) -> str:
        """Show the number of rows and the column names."""
        return f"Table({len(self)} rows: {', '.join(self)})"

    def to_pandas(self) -> pandas.DataFrame:
        """Copy to a data frame.

        Raises
        ------
        ImportError
            If pandas is missing; the message names the extra to install.
        """
        frames = extra("pandas", "analysis")
        frame: pandas.DataFrame = frames.DataFrame({n: c.copy() for n, c in self._columns.items()})
        return frame

    def _repr_html_(self) -> str:
        """Show the first rows in a notebook."""
        import html  # noqa: PLC0415 - costs nothing until used

        head = "".join(f"<th>{html.escape(name)}</th>" for name in self)
        rows = "".join(
            "<tr>"
            + "".join(f"<td>{html.escape(_cell(c[i]))}</td>" for c in self.values())
            + "</tr>"
            for i in range(min(len(self), _SHOWN))
        )
        more = f"<p>{len(self)} rows, first {_SHOWN} shown</p>" if len(self) > _SHOWN else ""
        return f"<table><thead><tr>{head}</tr></thead><tbody>{rows}</tbody></table>{more}"


def _frozen(columns: Mapping[str, Any]) -> dict[str, NDArray[Any]]:
    return {name: read_only(_column(values)) for name, values in columns.items()}


def _column(values: Any) -> NDArray[Any]:
    if isinstance(values, np.ndarray):
        return values
    rows = list(values)
    if any(isinstance(row, (tuple, list)) for row in rows):
        # NumPy would turn tuples of equal length into a second dimension.
        column = np.empty(len(rows), dtype=object)
        for index, row in enumerate(rows):
            column[index] = tuple(row)
        return column
    return np.array(rows) if rows else np.empty(0, dtype=object)


def _cell(value: object) -> str:
    return f"{value:.6g}" if isinstance(value, float) else str(value)
