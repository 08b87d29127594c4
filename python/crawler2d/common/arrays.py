"""Checked numbers, and read-only arrays, metrics and tables."""

from __future__ import annotations

import contextlib
import warnings
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import fields
from typing import TYPE_CHECKING, Any, NoReturn, TypeGuard

import numpy as np

from crawler2d.common.extras import extra
from crawler2d.common.keywords import suggestion
from crawler2d.common.units import RENAMED_METRICS
from crawler2d.errors import ScenarioError

if TYPE_CHECKING:
    import pandas
    from numpy.typing import NDArray

__all__ = [
    "ByValue",
    "Metrics",
    "Table",
    "freeze_array",
    "is_iterable",
    "read_bool",
    "read_instants",
    "read_range",
    "read_rows",
    "read_scalar",
    "real_number",
    "whole_number",
]


def freeze_array(array: NDArray[Any]) -> NDArray[Any]:
    """Return a permanently read-only view of an array.

    NumPy lets a view be made writeable again if its base array, or the owner of the memory, is
    writeable. Memory of the core never is; memory of other owners is copied.
    """
    bases = [array]
    while isinstance(bases[-1].base, np.ndarray):
        bases.append(bases[-1].base)
    if not _owned_by_core(bases[-1].base):
        bases = [array.copy()]
    for each in bases:
        each.flags.writeable = False
    return bases[0].view()


def _owned_by_core(owner: object) -> bool:
    """Whether the memory belongs to the core, out of reach of Python code."""
    if owner is None:
        return False
    try:
        memoryview(owner)  # type: ignore[arg-type]
    except TypeError:
        return True
    return False


def _unknown(name: object, known: Iterable[str]) -> KeyError:
    """Make the error for an unknown name, with the nearest known one."""
    return KeyError(f"{name}{suggestion(name, known)}" if isinstance(name, str) else name)


class Metrics(dict[str, float]):
    """A read-only dict of figures by name.

    Examples
    --------
    >>> metrics = Metrics({"time": 2.5})
    >>> metrics["time"] = 3.0
    Traceback (most recent call last):
        ...
    TypeError: metrics are read-only; change a copy, dict(metrics)
    """

    __slots__ = ()

    def __missing__(self, name: str) -> float:
        """Look up a former name of a metric, with a warning, or suggest the nearest name."""
        now = RENAMED_METRICS.get(name)
        if now is None or now not in self:
            raise _unknown(name, self)
        warnings.warn(
            f"the metric {name!r} is called {now!r} now", DeprecationWarning, stacklevel=2
        )
        return self[now]

    if not TYPE_CHECKING:  # same types as dict

        def get(self, name: str, default: Any = None, /) -> Any:
            """Look up a metric, also by a former name."""
            known = name in self or RENAMED_METRICS.get(name) in self
            return self[name] if known else default

    def _refuse(self, *_: Any, **__: Any) -> NoReturn:
        """Raise a TypeError that explains why."""
        raise TypeError("metrics are read-only; change a copy, dict(metrics)")

    __setitem__ = __delitem__ = __ior__ = _refuse
    clear = pop = popitem = setdefault = update = _refuse

    def __reduce__(self) -> tuple[type[Metrics], tuple[dict[str, float]]]:
        """Pickle and copy all items at once, as single ones cannot be set."""
        return Metrics, (dict(self),)


_ROWS = {None: "a number", 2: "a point (x, y)", 3: "a circle (x, y, radius)"}

# [s] How far an instant may be outside of the run, whose end titles round this much.
_ROUNDED = 0.01

# float64 represents every whole number up to here exactly.
_EXACT = 2**53


def read_scalar(value: Any, *, whole: bool) -> Any:
    """Convert a NumPy scalar or 0-d array to a Python number.

    Parameters
    ----------
    value : object
        Anything; non-numbers are returned unchanged, for the validator to reject.
    whole : bool
        Whether the field takes whole numbers; otherwise they become floats, as on reading JSON.

    Returns
    -------
    object
        The Python number; -0.0 becomes 0.0.
    """
    if isinstance(value, np.generic) or (type(value) is np.ndarray and value.ndim == 0):
        value = value.item()
    if isinstance(value, np.longdouble) and np.longdouble(float(value)) == value:
        value = float(value)  # .item() returns a longdouble again
    # A subclass may print and compare differently; adding 0.0 turns -0.0 into 0.0.
    if isinstance(value, float):
        return float(value) + 0.0
    if isinstance(value, int) and not isinstance(value, bool):
        value = int(value)
        if not whole:
            with contextlib.suppress(OverflowError):
                value = float(value)
    return value


def real_number(value: Any, path: str) -> float:
    """Convert any real number to a float.

    Raises
    ------
    ScenarioError
        If it is not a number (bools and strings are not).
    """
    number = read_scalar(value, whole=False)
    if type(number) is not float:
        raise ScenarioError(path, value, "must be a number")
    return number


def whole_number(value: Any, path: str, least: int, most: int) -> int:
    """Accept a whole number within bounds.

    Raises
    ------
    ScenarioError
        If it is not a whole number, such as a bool, or out of bounds.
    """
    number = read_scalar(value, whole=True)
    if type(number) is not int or not least <= number <= most:
        raise ScenarioError(path, value, f"must be a whole number from {least} to {most}")
    return number


def read_range(value: Any, path: str) -> tuple[float, float]:
    """Read two numbers, the lower first.

    Raises
    ------
    ScenarioError
        If it is anything else.
    """
    rule = "must be two numbers, the lower first"
    if not isinstance(value, (tuple, list)) or len(value) != 2:
        raise ScenarioError(path, value, rule)
    low, high = (real_number(each, f"{path}[{k}]") for k, each in enumerate(value))
    if not low < high:
        raise ScenarioError(path, value, rule)
    return low, high


def read_instants(
    value: Any, path: str, time: NDArray[np.float64], *, several: bool
) -> NDArray[np.float64]:
    """Read one instant, or several, shape (n,), in seconds, of a run with these samples of time.

    Raises
    ------
    ScenarioError
        If it is anything else, or outside of the run.
    """
    instants = np.asarray(value)
    is_real = instants.dtype.kind in "iuf" and instants.ndim <= several and instants.size > 0
    if not is_real or not np.isfinite(instants).all():
        rule = f"must be a number of seconds{', or several' if several else ''}"
        raise ScenarioError(path, value, rule)
    first, last = time[0], time[-1]
    if instants.min() < first - _ROUNDED or instants.max() > last + _ROUNDED:
        rule = f"must be within the run, from {first:.2f} to {last:.2f} s"
        raise ScenarioError(path, value, rule)
    return np.atleast_1d(instants.astype(np.float64))


def read_bool(value: object, path: str) -> bool:
    """Accept only True and False, not other truthy or falsy values.

    Raises
    ------
    ScenarioError
        If it is anything else.
    """
    if not isinstance(value, (bool, np.bool_)):
        raise ScenarioError(path, value, "must be True or False")
    return bool(value)


def is_iterable(value: object) -> TypeGuard[Iterable[Any]]:
    """Whether a value holds several; an array without dimensions only looks as if it did."""
    return isinstance(value, Iterable) and getattr(value, "ndim", 1) != 0


def read_rows(value: Any, path: str, *, rows: bool, columns: int | None) -> Any:
    """Copy an array-like of real numbers to tuples of floats, exactly.

    Parameters
    ----------
    value : array_like, shape (n, columns), (columns,) or (n,)
        Any layout, byte order and size of float or integer; None stays None.
    path : str
        Path of the field, for messages.
    rows : bool
        True for a list of rows; False for one row.
    columns : int, optional
        Numbers per row: 2 for a point (x, y), 3 for a circle (x, y, radius); None for plain
        numbers.

    Returns
    -------
    tuple or None
        A tuple of rows, one row, or numbers.

    Raises
    ------
    ScenarioError
        If the values are not real numbers, are masked, do not fit in float64 or have a wrong shape.
    """
    if value is None:
        return None
    if isinstance(value, np.ma.MaskedArray):
        raise ScenarioError(path, "a masked array", "must not be masked")
    try:
        array = np.asarray(value)
    except Exception as error:  # an object's own code may raise anything
        if rows:
            raise _row_error(value, path, columns) from error
        raise ScenarioError(path, value, f"must be {_ROWS[columns]}") from error
    if array.size == 0 and array.ndim == 1 and rows:
        return ()
    if array.dtype.kind not in "iuf":
        rule = f"must hold real numbers, not {array.dtype}"
        raise ScenarioError(path, _summary(value, array), rule)
    row = () if columns is None else (columns,)
    if array.ndim == 0 or (array.shape[1:] if rows else array.shape) != row:
        shape = ("n", *row) if rows else row
        rule = f"must have shape ({', '.join(map(str, shape))}{',' * (len(shape) == 1)})"
        raise ScenarioError(path, f"shape {array.shape}", rule)
    with np.errstate(over="ignore"):
        exact = array.astype(np.float64)
    if not _equals(array, exact):
        raise ScenarioError(path, _summary(value, array), "must hold numbers that fit in float64")
    numbers = (exact + 0.0).tolist()  # -0.0 becomes 0.0
    return tuple(map(tuple, numbers)) if array.ndim > 1 else tuple(numbers)


def _equals(array: np.ndarray[Any, Any], exact: np.ndarray[Any, Any]) -> bool:
    if array.dtype.kind in "iu":
        return bool(np.all((array <= _EXACT) & (array >= -_EXACT)))
    return bool(np.array_equal(exact.astype(array.dtype), array, equal_nan=True))


def _row_error(value: Any, path: str, columns: int | None) -> ScenarioError:
    """Name the first row of a ragged list that has the wrong number of numbers."""
    for index, row in enumerate(value if isinstance(value, (list, tuple)) else ()):
        try:
            shape = np.shape(row)
        except Exception:  # as above
            shape = ()
        if shape != (() if columns is None else (columns,)):
            return ScenarioError(f"{path}[{index}]", row, f"must be {_ROWS[columns]}")
    return ScenarioError(path, value, f"must be a list, each {_ROWS[columns]}")


def _summary(value: Any, array: np.ndarray[Any, Any]) -> object:
    """Describe an array by type and shape, to keep messages short; return others unchanged."""
    if isinstance(value, np.ndarray):
        return f"{array.dtype} array of shape {array.shape}"
    return value


# Numbers of an array that its hash depends on.
_HASHED = 32


class ByValue:
    """A dataclass of which two are equal if all fields are, also arrays and NaN in them."""

    __slots__ = ()

    def __eq__(self, other: object) -> bool:
        """Compare all fields."""
        if type(other) is not type(self):
            return NotImplemented
        names = [field.name for field in fields(self)]  # type: ignore[arg-type] # of a dataclass
        return all(_is_same(getattr(self, name), getattr(other, name)) for name in names)

    def __hash__(self) -> int:
        """Combine the hashes of all fields."""
        values = [getattr(self, field.name) for field in fields(self)]  # type: ignore[arg-type]
        return hash((type(self), *map(_hash, values)))


def _is_same(one: Any, other: Any) -> bool:
    """Compare values of which some may be, or hold, arrays."""
    if isinstance(one, np.ndarray) and isinstance(other, np.ndarray):
        if object in (one.dtype, other.dtype):
            return one.shape == other.shape and all(map(_is_same, one.flat, other.flat))
        return np.array_equal(one, other, equal_nan=one.dtype.kind == other.dtype.kind == "f")
    if isinstance(one, dict) and isinstance(other, dict):
        return one.keys() == other.keys() and all(_is_same(one[key], other[key]) for key in one)
    return bool(one == other) or bool(one != one and other != other)  # noqa: PLR0124 - NaN


def _hash(value: Any) -> int:
    """Return a number that equal values share, of long arrays that of their beginning."""
    if isinstance(value, np.ndarray):
        return hash(tuple(map(_hash, value.flat[:_HASHED])))
    if isinstance(value, dict):
        return hash(frozenset((key, _hash(each)) for key, each in value.items()))
    return hash(value) if value == value else 0  # noqa: PLR0124 - each NaN has a hash of its own


# Rows of a table shown by a notebook.
_SHOWN = 10

# Columns that hold a tuple of whole numbers in each row.
_TUPLES = ("bodies", "edges")


class Table(Mapping[str, "NDArray[Any]"]):
    """Columns of equal length, read-only, by name.

    Parameters
    ----------
    columns : mapping of str to array_like, or callable
        The columns in order; a list becomes an array of strings, or of objects if it holds tuples.
        A callable returns them on first use.

    Examples
    --------
    >>> table = Table({"x": [0.0, 0.5], "kind": ["stop", "stop"]})
    >>> len(table), list(table), table["x"].tolist()
    (2, ['x', 'kind'], [0.0, 0.5])

    pyarrow, polars and DuckDB accept it directly:

    >>> import pyarrow
    >>> pyarrow.table(table).schema.names
    ['x', 'kind']
    """

    __slots__ = ("_frozen", "_source")

    def __init__(self, columns: Mapping[str, Any] | Callable[[], Mapping[str, Any]]) -> None:
        self._source = columns if callable(columns) else lambda: columns
        self._frozen = None if callable(columns) else _freeze_columns(columns)

    @property
    def _columns(self) -> dict[str, NDArray[Any]]:
        if self._frozen is None:
            self._frozen = _freeze_columns(self._source())
        return self._frozen

    def __getitem__(self, name: str) -> NDArray[Any]:
        """Return one column, shape (n,); the error for an unknown name suggests the nearest."""
        try:
            return self._columns[name]
        except KeyError:
            raise _unknown(name, self._columns) from None

    def __iter__(self) -> Iterator[str]:
        """Iterate over the names of the columns."""
        return iter(self._columns)

    def __len__(self) -> int:
        """Count the rows."""
        return len(next(iter(self._columns.values()), ()))

    def __bool__(self) -> bool:
        """Whether there is any row."""
        return len(self) > 0

    def __eq__(self, other: object) -> bool:
        """Compare names and values of all columns, NaN with NaN."""
        return _is_same(self._columns, other._columns) if isinstance(other, Table) else False

    def __hash__(self) -> int:
        """Combine the hashes of all columns."""
        return _hash(self._columns)

    def __reduce__(self) -> tuple[type[Table], tuple[dict[str, Any]]]:
        """Pickle the columns; they stay read-only in the copy."""
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

    def __arrow_c_stream__(self, requested_schema: object = None) -> object:
        """Export to packages that read Arrow; columns of numbers are not copied.

        Use ``polars.from_dataframe(table)``, ``pyarrow.table(table)``, or DuckDB's SQL with the
        name of the table's variable. A tuple becomes a list of whole numbers, an outline a list of
        points. ``polars.DataFrame(table)`` takes single columns instead, with these as objects.

        Raises
        ------
        ImportError
            If pyarrow is missing; the message names the extra to install.
        """
        arrow = extra("pyarrow", "files")
        columns = {name: _arrow_column(arrow, name, each) for name, each in self.items()}
        return arrow.table(columns).__arrow_c_stream__(requested_schema)

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


def _freeze_columns(columns: Mapping[str, Any]) -> dict[str, NDArray[Any]]:
    return {name: freeze_array(_column(values)) for name, values in columns.items()}


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


def _arrow_column(arrow: Any, name: str, column: NDArray[Any]) -> Any:
    """Convert a column to Arrow; without rows, its name gives the type."""
    if name in _TUPLES:
        return arrow.array(column, arrow.list_(arrow.int64()))
    if name == "outline":
        points = arrow.list_(arrow.list_(arrow.float64()))
        return arrow.array([each.tolist() for each in column], points)
    is_unknown = column.dtype == object and not column.size
    return arrow.array(column, arrow.string() if is_unknown else None)


def _cell(value: object) -> str:
    return f"{value:.6g}" if isinstance(value, float) else str(value)
