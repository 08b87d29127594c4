"""Numbers and arrays that a parameter accepts, and the one frozen form they are kept in."""

from __future__ import annotations

from typing import Any

import numpy as np

from crawler2d.errors import ScenarioError

# What a row of two or three numbers means.
_ROWS = {2: "a point (x, y)", 3: "a circle (x, y, radius)"}

# float64 holds every whole number up to here exactly.
_EXACT = 2**53


def frozen_scalar(value: Any, *, whole: bool) -> Any:
    """Convert a NumPy scalar or a 0-d array to the Python number it holds.

    Parameters
    ----------
    value : object
        Anything; what is not a number is returned unchanged, for the validator to reject.
    whole : bool
        Whether the field takes whole numbers; if not, they become floats where that is exact.

    Returns
    -------
    object
        An equal Python object; -0.0 becomes 0.0.
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
        if not whole and abs(value) <= _EXACT:
            value = float(value)
    return value


def real_number(value: Any, path: str) -> float:
    """Convert any real number to a float.

    Raises
    ------
    ScenarioError
        If it is not a number; a bool or a string is not.
    """
    number = frozen_scalar(value, whole=False)
    if type(number) is not float:
        raise ScenarioError(path, value, "must be a number")
    return number


def whole_number(value: Any, path: str, least: int, most: int) -> int:
    """Accept a whole number within bounds.

    Raises
    ------
    ScenarioError
        If it is no whole number, or out of bounds; a bool is none.
    """
    number = frozen_scalar(value, whole=True)
    if type(number) is not int or not least <= number <= most:
        raise ScenarioError(path, value, f"must be a whole number from {least} to {most}")
    return number


def frozen_rows(value: Any, path: str, *, rows: bool, columns: int) -> Any:
    """Copy an array-like of real numbers to tuples of floats, exactly.

    Parameters
    ----------
    value : array_like, shape (n, columns) or (columns,)
        Any layout, byte order and size of float or integer; None stays None.
    path : str
        Path of the field, for messages.
    rows : bool
        True for a list of rows; False for one row.
    columns : int
        Numbers per row: 2 for a point (x, y), 3 for a circle (x, y, radius).

    Returns
    -------
    tuple or None
        A tuple of rows, or one row.

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
    numbers = (exact + 0.0).tolist()  # -0.0 becomes 0.0
    return tuple(map(tuple, numbers)) if rows else tuple(numbers)


def _same_numbers(array: np.ndarray[Any, Any], exact: np.ndarray[Any, Any]) -> bool:
    if array.dtype.kind in "iu":
        return bool(np.all((array <= _EXACT) & (array >= -_EXACT)))
    return bool(np.array_equal(exact.astype(array.dtype), array, equal_nan=True))


def _bad_row(value: Any, path: str, columns: int) -> ScenarioError:
    """Find the first row of a ragged list that has the wrong number of numbers."""
    for index, row in enumerate(value if isinstance(value, (list, tuple)) else ()):
        try:
            shape = np.shape(row)
        except Exception:  # as above
            shape = ()
        if shape != (columns,):
            return ScenarioError(f"{path}[{index}]", row, f"must be {_ROWS[columns]}")
    return ScenarioError(path, value, f"must be a list, each {_ROWS[columns]}")


def _described(value: Any, array: np.ndarray[Any, Any]) -> object:
    """Describe an array by type and shape, to keep messages short; return the rest as it is."""
    if isinstance(value, np.ndarray):
        return f"{array.dtype} array of shape {array.shape}"
    return value
