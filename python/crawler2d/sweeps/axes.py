"""Axes and columns of tables: swept fields with labels, and columns about stops."""

from __future__ import annotations

import dataclasses
import math
import re
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from crawler2d.common.arrays import read_scalar
from crawler2d.common.units import METRICS, unit_of
from crawler2d.errors import ScenarioError
from crawler2d.parameters.fields import Parameters, fields_of
from crawler2d.results.outcome import TRIALS

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from crawler2d.results.diagnosis import Diagnosis
    from crawler2d.results.findings import TrialResult

__all__ = [
    "COLUMNS",
    "Axis",
    "Label",
    "coordinates",
    "field_attributes",
    "read_axes",
    "read_labels",
    "short_name",
    "short_names",
    "stop_columns",
]

Label = str | int | float

# Longer labels make tables hard to read.
_LONGEST = 60


def read_labels(values: object, place: str) -> dict[Label, Any]:
    """Read the values of an axis: a mapping from labels, or a sequence.

    Parameters
    ----------
    values : mapping or iterable
        The user's argument.
    place : str
        Name of the argument, for messages.

    Returns
    -------
    dict
        Values by label, in order. The labels are all numbers, or all strings.

    Raises
    ------
    ScenarioError
        If there are no values, or a label is missing or not unique.
    """
    given = _list_values(values, place)
    if not given:
        raise ScenarioError(place, values, "must have at least one value")
    if not all(isinstance(label, (int, float)) for _, label, _ in given):
        given = [(where, str(label), value) for where, label, value in given]
    by_label: dict[Label, Any] = {}
    for where, label, value in given:
        if label in by_label:
            rule = f"must have unique labels, not {label} twice: give a mapping from labels"
            raise ScenarioError(where, value, rule)
        by_label[label] = value
    return by_label


def _list_values(values: object, place: str) -> list[tuple[str, Label, Any]]:
    """List the path of each value, its label, and the value."""
    if isinstance(values, Mapping):
        return [(f"{place}[{key!r}]", _key(key, place), value) for key, value in values.items()]
    # A set has no order, and a string is a single value.
    if not isinstance(values, Iterable) or isinstance(values, (str, bytes, set, frozenset)):
        rule = "must be a sequence of values, or a mapping from labels to values"
        raise ScenarioError(place, values, rule)
    if isinstance(values, np.ndarray) and values.ndim == 0:
        raise ScenarioError(place, values, "must have one dimension")
    listed = list(values)
    places = [f"{place}[{index}]" for index in range(len(listed))]
    return [(where, _label(v, where), v) for where, v in zip(places, listed, strict=True)]


def _key(key: object, place: str) -> Label:
    label = read_scalar(key, whole=True)
    if type(label) not in (str, int, float):
        raise ScenarioError(place, key, "must have strings or numbers as labels")
    return label  # type: ignore[no-any-return]


def _label(value: object, where: str) -> Label:
    value = read_scalar(value, whole=True)
    if isinstance(value, (int, float)) and not isinstance(value, bool):
        return value
    label = _text(value)
    if len(label) > _LONGEST:
        rule = f"must have a label of at most {_LONGEST} letters: give a mapping from labels"
        raise ScenarioError(where, value, rule)
    return label


def _text(value: Any) -> str:
    """Write a value as its constructor call, without defaults."""
    value = read_scalar(value, whole=True)
    if isinstance(value, np.ndarray):
        value = value.tolist()
    if isinstance(value, (tuple, list)):
        return f"({', '.join(map(_text, value))})"
    if not isinstance(value, Parameters):
        return str(value)
    shown = []
    for field in fields_of(type(value)):
        inner = getattr(value, field.name)
        if inner != field.default and _matters(value, field):
            text = _text(inner)
            shown.append(f"{field.name}={text}" if field.kw_only else text)
    return f"{type(value).__name__}({', '.join(shown)})"


def _matters(value: Any, field: dataclasses.Field[Any]) -> bool:
    """Whether the value would differ if a field had its default."""
    is_required = field.default is dataclasses.MISSING
    return is_required or dataclasses.replace(value, **{field.name: field.default}) != value


Column = tuple[type, str, list[Any]]


_ALWAYS = (
    *("closed track", "closed track, clear of the ground", "belt"),
    *("belt, from the start", "closed track, from the start"),
)
"""Trials made for every jam."""


def short_name(trial: str) -> str:
    """Convert the name of a trial for column names.

    Examples
    --------
    >>> short_name("closed track, clear of the ground"), short_name("torque x 2")
    ('closed_track_clear_of_the_ground', 'torque_x2')
    """
    return trial.replace(" x ", "_x").replace(", ", "_").replace(" ", "_")


def stop_columns(
    diagnoses: Sequence[Diagnosis | None], trials: Sequence[str] = ()
) -> dict[str, Column]:
    """Return type, unit and values of each column by name; empty for runs that did not stop.

    The given trials, and those made for every jam, have three columns each.
    """

    def of(name: str, empty: Any) -> list[Any]:
        return [empty if d is None else getattr(d, name) for d in diagnoses]

    def of_edge(name: str, empty: Any) -> list[Any]:
        pieces = [None if d is None else d.intrusion for d in diagnoses]
        return [empty if piece is None else getattr(piece, name) for piece in pieces]

    columns: dict[str, Column] = {
        "symptom": (str, "", [str(each) for each in of("symptom", "")]),
        "transient": (bool, "", of("transient", False)),
        "mechanism": (str, "", [str(each or "") for each in of("mechanism", "")]),
        "jammed": (bool, "", of("jammed", False)),
        "belly_side": (str, "", of("belly_side", "")),
        "stop_x": (float, "m", [math.nan if d is None else d.position[0] for d in diagnoses]),
        "stop_angle": (float, "rad", of("chassis_angle", math.nan)),
        "stop_edge": (int, "", of_edge("edge", -1)),
        "stop_side": (str, "", [str(each) for each in of_edge("side", "")]),
        "stop_carrier": (str, "", [str(each) for each in of_edge("carrier", "")]),
        "stop_bodies": (str, "", [_pair(each) for each in of_edge("bodies", ())]),
    }
    for name in (each for each in TRIALS if each in trials or each in _ALWAYS):
        results = [_trial(d, name) for d in diagnoses]
        short = short_name(name)
        columns[f"tried_{short}"] = (bool, "", [t is not None for t in results])
        columns[f"freed_by_{short}"] = (bool, "", [t is not None and t.freed for t in results])
        columns[f"then_{short}"] = (str, "", ["" if t is None else str(t.outcome) for t in results])
    return columns


def _trial(diagnosis: Diagnosis | None, name: str) -> TrialResult | None:
    trials = () if diagnosis is None else diagnosis.trials
    return next((trial for trial in trials if trial.name == name), None)


def _pair(bodies: tuple[int, ...]) -> str:
    return "-".join(map(str, sorted(bodies)))


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
"""Columns of a sweep and its rates, without metrics; axes must not use these names."""

Coordinate = tuple[str, "NDArray[Any]", dict[str, str]]
"""Dimension, values and attributes, as xarray expects them."""


@dataclass(frozen=True, slots=True)
class Axis:
    """Fields that are swept together: one dimension of the table."""

    name: str
    paths: tuple[str, ...]
    values: Mapping[Label, Mapping[str, Any]]
    """Values by label, then by path; without a value, a path keeps the scenario's own."""

    def points(self) -> Iterator[tuple[str, Mapping[str, Any]]]:
        """Yield name (for errors) and values by path of each point."""
        for label, row in self.values.items():
            yield f"{self.name}={label}", row


def read_axes(over: object) -> list[Axis]:
    """Read the argument `over` of `sweep`.

    Raises
    ------
    ScenarioError
        If it is not a mapping from paths, a value does not fit, or a path overwrites an earlier
        one.
    """
    if not isinstance(over, Mapping):
        raise ScenarioError("over", over, "must be a mapping from paths to values")
    keys = {key: _paths(key) for key in over}
    every = [path for paths in keys.values() for path in paths]
    _check_order(every)
    dimensions = _dimensions(list(keys.values()))
    axes = []
    for (key, paths), name in zip(keys.items(), dimensions, strict=True):
        place = f"over[{key!r}]"
        values = read_labels(over[key], place)
        if isinstance(key, tuple):
            rows = {label: _row(value, paths, place) for label, value in values.items()}
        else:
            rows = {label: {key: value} for label, value in values.items()}
        axes.append(Axis(name, paths, rows))
    return axes


def coordinates(axes: Sequence[Axis]) -> dict[str, Coordinate]:
    """Return the coordinates of the axes: labels, and numbers that are swept together."""
    names = short_names([path for axis in axes for path in axis.paths])
    by_name: dict[str, Coordinate] = {}
    for axis in axes:
        labels = list(axis.values)
        rows = axis.values.values()
        columns = [_numbers([row.get(path) for row in rows]) for path in axis.paths]
        attributes = field_attributes(axis.paths)
        if columns != [labels]:
            attributes.pop("units", None)  # labels have no unit, not even numbers
        by_name[axis.name] = (axis.name, np.array(labels), attributes)
        if len(axis.paths) > 1:
            for path, numbers in zip(axis.paths, columns, strict=True):
                if numbers is not None:
                    by_name[names[path]] = (axis.name, np.array(numbers), field_attributes([path]))
    return by_name


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
    """Name each path by its last part, or by the full path if that name is taken.

    If full paths differ only in the position of a ``[*]``, it is written as "all".

    Examples
    --------
    >>> list(short_names(["robot.mass", "robot.belly[*][1]"]).values())
    ['mass', 'belly_1']
    >>> list(short_names(["robot.belly[*][1]", "robot.belly[1][*]"]).values())
    ['robot_belly_all_1', 'robot_belly_1_all']
    """
    uses = Counter([*map(_last, paths), *METRICS, *COLUMNS])
    whole = Counter(map(_name, paths))
    return {
        path: _last(path)
        if uses[_last(path)] == 1
        else _name(path if whole[_name(path)] == 1 else path.replace("[*]", "_all"))
        for path in paths
    }


def _dimensions(axes: Sequence[tuple[str, ...]]) -> list[str]:
    """Name the axes; an axis of several paths joins their last parts."""
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


def _check_order(paths: Sequence[str]) -> None:
    for index, path in enumerate(paths):
        for earlier in paths[:index]:
            if earlier == path:
                raise ScenarioError("over", path, "must have each path only once")
            if earlier.startswith((f"{path}.", f"{path}[")):
                raise ScenarioError("over", path, f"must come before {earlier}, which it replaces")


def _numbers(column: Sequence[Any]) -> list[int | float] | None:
    numbers = [read_scalar(value, whole=True) for value in column]
    return numbers if all(type(number) in (int, float) for number in numbers) else None


def _row(value: Any, paths: Sequence[str], place: str) -> dict[str, Any]:
    if isinstance(value, np.ndarray):
        value = value.tolist()
    if not isinstance(value, (tuple, list)) or len(value) != len(paths):
        raise ScenarioError(place, value, f"must have tuples of {len(paths)} values, one per path")
    return dict(zip(paths, value, strict=True))
