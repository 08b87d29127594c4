"""Surveyed profiles: read points from a text file, and simplify lines."""

from __future__ import annotations

import math
import re
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from crawler2d.errors import ScenarioError

if TYPE_CHECKING:
    from os import PathLike

    from numpy.typing import NDArray

__all__ = ["read_survey", "simplified"]

# A comma or a semicolon, or white space alone.
_SEPARATOR = re.compile(r"\s*[,;]\s*|\s+")

# Names of columns with other units, or in the other order.
_OTHERWISE = re.compile(r"\b(mm|cm|km|ft|feet|inch|inches|yd)\b|^y\b.*\bx\b", re.IGNORECASE)


def read_survey(path: str | PathLike[str]) -> NDArray[np.float64]:
    """[m] Read the points of a file, shape (n, 2); see `terrains.from_csv`."""
    path = Path(path)
    try:
        text = path.read_text(encoding="utf-8-sig")
    except UnicodeDecodeError as error:
        raise ScenarioError(str(path), f"byte {error.start}", "must be a text in UTF-8") from None
    points: list[tuple[float, float]] = []
    lines: list[int] = []
    is_first = True
    for number, line in enumerate(text.splitlines(), start=1):
        content = line.partition("#")[0].strip()
        if not content:
            continue
        where = f"{path}, line {number},"
        fields = _SEPARATOR.split(content)
        if is_first and not any(map(_is_number, fields)):
            is_first = False  # column names
            if _OTHERWISE.search(content):
                raise ScenarioError(where, content, "must name x and then y, in metres")
            continue
        is_first = False
        points.append(_read_point(fields, where, content))
        lines.append(number)
    if len(points) < 2:
        rule = "must have at least 2 lines with a point each, x and y [m]"
        raise ScenarioError(str(path), f"{len(points)}", rule)
    found = np.array(points)
    _check_order(found[:, 0], lines, path)
    return found


def _is_number(field: str) -> bool:
    try:
        float(field)
    except ValueError:
        return False
    return True


def _read_point(fields: list[str], where: str, line: str) -> tuple[float, float]:
    if len(fields) != 2:
        rule = (
            "must have two numbers, x and y [m], with decimal points and one separator between them"
        )
        raise ScenarioError(where, line, rule)
    for field in fields:
        if not (_is_number(field) and math.isfinite(float(field))):
            raise ScenarioError(where, field, "must have finite numbers only")
    x, y = map(float, fields)
    return x, y


def _check_order(x: NDArray[np.float64], lines: list[int], path: Path) -> None:
    """Refuse an x that goes back, in either direction of the file."""
    steps = np.diff(x) if x[0] <= x[-1] else -np.diff(x)
    back = np.flatnonzero(steps < 0.0)
    if back.size:
        row = int(back[0]) + 1
        rule = f"must not go back from x = {x[row - 1]:g} m: points are in order, without overhangs"
        raise ScenarioError(f"{path}, line {lines[row]},", float(x[row]), rule)


def simplified(points: NDArray[np.float64], tolerance: float) -> NDArray[np.float64]:
    """[m] Drop points within a distance of the line through the others (Douglas and Peucker).

    Parameters
    ----------
    points : ndarray, shape (n, 2)
        [m] A line.
    tolerance : float
        [m] The distance.

    Returns
    -------
    ndarray, shape (k, 2)
        [m] The remaining points, with both ends.

    Examples
    --------
    >>> simplified(np.array([(0, 0), (1, 0.01), (2, 0), (3, 1), (4, 2)]), 0.02).tolist()
    [[0.0, 0.0], [2.0, 0.0], [4.0, 2.0]]
    """
    kept = np.zeros(len(points), dtype=bool)
    kept[[0, -1]] = True
    open_ = [(0, len(points) - 1)]
    while open_:
        first, last = open_.pop()
        if last - first < 2:
            continue
        distances = _distances(points[first + 1 : last], points[first], points[last])
        farthest = int(distances.argmax())
        if distances[farthest] > tolerance:
            middle = first + 1 + farthest
            kept[middle] = True
            open_ += [(first, middle), (middle, last)]
    return points[kept]


def _distances(
    points: NDArray[np.float64], start: NDArray[np.float64], end: NDArray[np.float64]
) -> NDArray[np.float64]:
    """[m] Distances of points from the segment between two others."""
    along = end - start
    length = float(along @ along)
    share = np.zeros(len(points)) if length == 0.0 else (points - start) @ along / length
    feet = start + np.clip(share, 0.0, 1.0)[:, None] * along
    distances: NDArray[np.float64] = np.hypot(*(points - feet).T)
    return distances
