"""Which numbers and arrays a parameter takes, and their one frozen form."""

from __future__ import annotations

from typing import Any

import numpy as np

from crawler2d.errors import ScenarioError

# What a row of so many numbers stands for.
_ROWS = {2: "a point (x, y)", 3: "a circle (x, y, radius)"}

# Every whole number up to here is a float64.
_EXACT = 2**53


def frozen_scalar(value: Any, *, whole: bool) -> Any:
    """Take a NumPy scalar or an array of no dimension as the Python number it holds.

    Parameters
    ----------
    value : object
        Anything; what is no number stays as it is, for the validator to refuse.
    whole : bool
        Whether the field is a whole number; where it is not, whole numbers become floats if exact.

    Returns
    -------
    object
        An equal Python object; there is one zero, 0.0.
    """
    if isinstance(value, np.generic) or (type(value) is np.ndarray and value.ndim == 0):
        value = value.item()
    if isinstance(value, np.longdouble) and np.longdouble(float(value)) == value:
        value = float(value)  # its .item() is itself
    # A class of one's own may write and compare itself otherwise; and there is one zero.
    if isinstance(value, float):
        return float(value) + 0.0
    if isinstance(value, int) and not isinstance(value, bool):
        value = int(value)
        if not whole and abs(value) <= _EXACT:
            value = float(value)
    return value


def real_number(value: Any, path: str) -> float:
    """Take any real number as a float.

    Raises
    ------
    ScenarioError
        If it is none; a bool or a text is none.
    """
    number = frozen_scalar(value, whole=False)
    if type(number) is not float:
        raise ScenarioError(path, value, "must be a number")
    return number


def frozen_rows(value: Any, path: str, *, rows: bool, columns: int) -> Any:
    """Copy an array-like of real numbers to tuples of floats, without losing a bit.

    Parameters
    ----------
    value : array_like, shape (n, columns) or (columns,)
        Any layout, byte order, and width of float or integer; None stays None.
    path : str
        Path of the field, for messages.
    rows : bool
        True for a list of rows; False for one row.
    columns : int
        Numbers of a row: 2 of a point (x, y), 3 of a placed circle (x, y, radius).

    Returns
    -------
    tuple or None
        Of rows as tuples, or one such tuple.

    Raises
    ------
    ScenarioError
        If the values are no real numbers, are masked, lose digits as float64 or are misshapen.
    """
    if value is None:
        return None
    if isinstance(value, np.ma.MaskedArray):
        raise ScenarioError(path, "a masked array", "must not be masked")
    try:
        array = np.asarray(value)
    except Exception as error:  # an object's own code may raise anything
        if rows:
            raise _bad_row(value, path, columns) from error
        raise ScenarioError(path, value, f"must be {_ROWS[columns]}") from error
    if array.size == 0 and array.ndim == 1 and rows:
        return ()
    if array.dtype.kind not in "iuf":
        rule = f"must hold real numbers, not {array.dtype}"
        raise ScenarioError(path, _described(value, array), rule)
    if (array.shape[1:] if rows else array.shape) != (columns,):
        rule = f"must have shape {f'(n, {columns})' if rows else f'({columns},)'}"
        raise ScenarioError(path, f"shape {array.shape}", rule)
    with np.errstate(over="ignore"):
        exact = array.astype(np.float64)
    if not _same_numbers(array, exact):
        raise ScenarioError(path, _described(value, array), "must hold numbers that fit in float64")
    numbers = (exact + 0.0).tolist()  # there is one zero
    return tuple(map(tuple, numbers)) if rows else tuple(numbers)


def _same_numbers(array: np.ndarray[Any, Any], exact: np.ndarray[Any, Any]) -> bool:
    if array.dtype.kind in "iu":
        return bool(np.all((array <= _EXACT) & (array >= -_EXACT)))
    return bool(np.array_equal(exact.astype(array.dtype), array, equal_nan=True))


def _bad_row(value: Any, path: str, columns: int) -> ScenarioError:
    """Find the first row of a ragged list that has not as many numbers."""
    for index, row in enumerate(value if isinstance(value, (list, tuple)) else ()):
        try:
            shape = np.shape(row)
        except Exception:  # as above
            shape = ()
        if shape != (columns,):
            return ScenarioError(f"{path}[{index}]", row, f"must be {_ROWS[columns]}")
    return ScenarioError(path, value, f"must be a list, each {_ROWS[columns]}")


def _described(value: Any, array: np.ndarray[Any, Any]) -> object:
    """Keep a message short: an array by its type and shape, anything else by itself."""
    if isinstance(value, np.ndarray):
        return f"{array.dtype} array of shape {array.shape}"
    return value
