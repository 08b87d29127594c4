"""Labels for the values of a sweep: numbers and strings themselves, objects in short form."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from crawler2d.common.arrays import frozen_scalar
from crawler2d.errors import ScenarioError
from crawler2d.parameters.plain import Parameters

__all__ = ["Label", "labelled"]

Label = str | int | float

# Longer labels make tables hard to read.
_LONGEST = 60


def labelled(values: object, place: str) -> dict[Label, Any]:
    """Read the values of an axis: a mapping from labels, or a sequence that labels itself.

    Parameters
    ----------
    values : mapping or iterable
        What the user gave.
    place : str
        The argument that holds them, for messages.

    Returns
    -------
    dict
        Values by label, in order. The labels are all numbers, or all strings.

    Raises
    ------
    ScenarioError
        If there are no values, or a label is missing or not unique.
    """
    given = _given(values, place)
    if not given:
        raise ScenarioError(place, values, "must have at least one value")
    if not all(isinstance(label, (int, float)) for _, label, _ in given):
        given = [(where, str(label), value) for where, label, value in given]
    found: dict[Label, Any] = {}
    for where, label, value in given:
        if label in found:
            rule = f"must have unique labels, not {label} twice: give a mapping from labels"
            raise ScenarioError(where, value, rule)
        found[label] = value
    return found


def _given(values: object, place: str) -> list[tuple[str, Label, Any]]:
    """List the place of each value, its label, and the value."""
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
    label = frozen_scalar(key, whole=True)
    if type(label) not in (str, int, float):
        raise ScenarioError(place, key, "must have strings or numbers as labels")
    return label  # type: ignore[no-any-return]


def _label(value: object, where: str) -> Label:
    value = frozen_scalar(value, whole=True)
    if isinstance(value, (int, float)) and not isinstance(value, bool):
        return value
    label = _text(value)
    if len(label) > _LONGEST:
        rule = "must have a short label: give a mapping from labels to values"
        raise ScenarioError(where, value, rule)
    return label


def _text(value: Any) -> str:
    """Write a value as the call that makes it, without defaults."""
    value = frozen_scalar(value, whole=True)
    if isinstance(value, np.ndarray):
        value = value.tolist()
    if isinstance(value, (tuple, list)):
        return f"({', '.join(map(_text, value))})"
    if not isinstance(value, Parameters):
        return str(value)
    shown = []
    for field in dataclasses.fields(value):  # type: ignore[arg-type]
        inner = getattr(value, field.name)
        if inner != field.default and _counts(value, field):
            text = _text(inner)
            shown.append(f"{field.name}={text}" if field.kw_only else text)
    return f"{type(value).__name__}({', '.join(shown)})"


def _counts(value: Any, field: dataclasses.Field[Any]) -> bool:
    """Whether the value would be another one with the default of a field."""
    is_required = field.default is dataclasses.MISSING
    return is_required or dataclasses.replace(value, **{field.name: field.default}) != value
