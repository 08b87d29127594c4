"""The axes of a sweep: which fields take which values, and the names of the dimensions."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from crawler2d.common.arrays import frozen_scalar
from crawler2d.common.units import METRICS, unit_of
from crawler2d.errors import ScenarioError
from crawler2d.results.glossary import TRIALS
from crawler2d.sweeps.labels import Label, labelled
from crawler2d.sweeps.stops import stop_columns

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["COLUMNS", "Axis", "coordinates", "field_attributes", "read_axes", "short_names"]

COLUMNS = (
    *(
        "sample",
        "repeat",
        "seed",
        "outcome",
        "error",
        *stop_columns((), tuple(TRIALS)),
        "wall_time",
        "identity",
        "scenario",
    ),
    *("rate", "low", "high", "count", "distinct", "band_low", "band_median", "band_high"),
)
"""Columns of a sweep and its rates besides the metrics; no axis may have these names."""

Coordinate = tuple[str, "NDArray[Any]", dict[str, str]]
"""Dimension, values and attributes, as xarray expects them."""


@dataclass(frozen=True, slots=True)
class Axis:
    """Fields that change together: one dimension of the table."""

    name: str
    paths: tuple[str, ...]
    values: Mapping[Label, Mapping[str, Any]]
    """By label, then by path; a path without a value keeps the scenario's own."""

    def points(self) -> Iterator[tuple[str, Mapping[str, Any]]]:
        """Yield the name of each point, for messages, and its values by path."""
        for label, row in self.values.items():
            yield f"{self.name}={label}", row


def read_axes(over: object) -> list[Axis]:
    """Read the argument `over` of `sweep`.

    Raises
    ------
    ScenarioError
        If it is not such a mapping, a value does not fit, or a path overwrites an earlier one.
    """
    if not isinstance(over, Mapping):
        raise ScenarioError("over", over, "must be a mapping from paths to values")
    keys = {key: _paths(key) for key in over}
    every = [path for paths in keys.values() for path in paths]
    _refuse_undoing(every)
    dimensions = _dimensions(list(keys.values()))
    axes = []
    for (key, paths), name in zip(keys.items(), dimensions, strict=True):
        place = f"over[{key!r}]"
        values = labelled(over[key], place)
        if isinstance(key, tuple):
            rows = {label: _row(value, paths, place) for label, value in values.items()}
        else:
            rows = {label: {key: value} for label, value in values.items()}
        axes.append(Axis(name, paths, rows))
    return axes


def coordinates(axes: Sequence[Axis]) -> dict[str, Coordinate]:
    """Return the coordinates of the axes: labels, and numbers that are swept together."""
    names = short_names([path for axis in axes for path in axis.paths])
    found: dict[str, Coordinate] = {}
    for axis in axes:
        labels = list(axis.values)
        rows = axis.values.values()
        columns = [_numbers([row.get(path) for row in rows]) for path in axis.paths]
        attributes = field_attributes(axis.paths)
        if columns != [labels]:
            attributes.pop("units", None)  # labels have no unit, even if they are numbers
        found[axis.name] = (axis.name, np.array(labels), attributes)
        if len(axis.paths) > 1:
            for path, numbers in zip(axis.paths, columns, strict=True):
                if numbers is not None:
                    found[names[path]] = (axis.name, np.array(numbers), field_attributes([path]))
    return found


def field_attributes(paths: Sequence[str]) -> dict[str, str]:
    """Name the fields of an array, and the unit if there is only one."""
    lasts = [path.rpartition(".")[2] for path in paths]
    attributes = {
        "path": ", ".join(paths),
        "long_name": " and ".join(dict.fromkeys(lasts)).replace("_", " "),
    }
    unit = unit_of(paths[0]) if len(paths) == 1 else None
    if unit is not None:
        attributes["units"] = unit
    return attributes


def short_names(paths: Sequence[str]) -> dict[str, str]:
    """Name each path by its last part, or by the whole path if that name is taken."""
    uses = Counter([*map(_last, paths), *METRICS, *COLUMNS])
    return {p: _last(p) if uses[_last(p)] == 1 else _name(p) for p in paths}


def _dimensions(axes: Sequence[tuple[str, ...]]) -> list[str]:
    """Name the axes; the name of an axis of several paths joins their last parts."""
    names = short_names([path for paths in axes for path in paths])
    joined = ["_".join(dict.fromkeys(map(_last, paths))) for paths in axes]
    taken = [*joined, *names.values(), *METRICS, *COLUMNS]
    return [
        name if len(paths) > 1 and taken.count(name) == 1 else "_".join(names[p] for p in paths)
        for name, paths in zip(joined, axes, strict=True)
    ]


def _last(path: str) -> str:
    return _name(path.rpartition(".")[2])


def _name(path: str) -> str:
    """Write a path as an identifier."""
    return re.sub(r"\[(\d+)\]", r"_\1", path.replace("[*]", "")).replace(".", "_")


def _paths(key: object) -> tuple[str, ...]:
    paths = key if isinstance(key, tuple) else (key,)
    if not paths or not all(isinstance(path, str) for path in paths):
        raise ScenarioError("over", key, "must have dotted paths, or tuples of them, as keys")
    return paths


def _refuse_undoing(paths: Sequence[str]) -> None:
    for index, path in enumerate(paths):
        for earlier in paths[:index]:
            if earlier == path:
                raise ScenarioError("over", path, "must have each path only once")
            if earlier.startswith((f"{path}.", f"{path}[")):
                raise ScenarioError("over", path, f"must come before {earlier}, which it replaces")


def _numbers(column: Sequence[Any]) -> list[int | float] | None:
    numbers = [frozen_scalar(value, whole=True) for value in column]
    return numbers if all(type(number) in (int, float) for number in numbers) else None


def _row(value: Any, paths: Sequence[str], place: str) -> dict[str, Any]:
    if isinstance(value, np.ndarray):
        value = value.tolist()
    if not isinstance(value, (tuple, list)) or len(value) != len(paths):
        raise ScenarioError(place, value, f"must have tuples of {len(paths)} values, one per path")
    return dict(zip(paths, value, strict=True))
