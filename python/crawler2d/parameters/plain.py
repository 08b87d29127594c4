"""Parameter objects as plain data: what a frozen dataclass may hold, and how it becomes JSON.

JSON has no non-finite numbers; they are written as the strings "NaN", "Infinity" and "-Infinity",
so that the validator, which knows the rules, can name the field.
"""

from __future__ import annotations

import dataclasses
import functools
import sys
import types
import typing
from typing import Any, ClassVar, TypeVar

from crawler2d.common.arrays import frozen_rows, frozen_scalar
from crawler2d.errors import ScenarioError

P = TypeVar("P", bound="Parameters")

ROWS = {
    tuple[float, float]: (None, 2),
    tuple[tuple[float, float], ...]: ("n", 2),
    tuple[tuple[float, float, float], ...]: ("n", 3),
}
"""Rows and columns of the fields that hold arrays; None for rows means a single row, not nested."""

_RULES = {float: "must be a number", int: "must be a whole number", str: "must be a string"}


class Parameters:
    """Base of the parameter dataclasses: fields are normalised once, on creation.

    NumPy scalars become Python numbers, whole numbers become floats where the field is a float, and
    arrays of points become tuples. So objects compare, hash and print the same whatever they were
    made from, and later changes of an input array do not reach them.
    """

    __slots__ = ()

    kind: ClassVar[str] = ""
    """Tag of the class in JSON; empty where a field has only one class."""
    place: ClassVar[str] = ""
    """Where objects of this class sit in a scenario, for messages."""
    either: ClassVar[tuple[str, ...]] = ()
    """Fields of which only one may be set: a path that sets one takes the others off."""

    unsaid: ClassVar[tuple[str, ...]] = ()
    """Fields that texts leave out where they have their defaults: older texts do not have them."""
    besides: ClassVar[tuple[str, ...]] = ()
    """Properties that paths name like fields."""

    @property
    def in_place_of(self) -> dict[str, tuple[str, ...]]:
        """What texts have in place of a field: numbers that are properties."""
        return {}

    def __init_subclass__(cls) -> None:
        """Keep `dataclass` from giving the class a repr of its own."""
        super().__init_subclass__()
        cls.__repr__ = Parameters.__repr__  # type: ignore[method-assign]

    def __repr__(self) -> str:
        """Write an expression that makes an equal object.

        Fields that have their defaults are left out, except for those that say which of several
        models it is.
        """
        given = []
        for field in dataclasses.fields(self):  # type: ignore[arg-type]
            for name in self.in_place_of.get(field.name, (field.name,)):
                value = getattr(self, name)
                # Texts can be compared whatever a field holds.
                if repr(value) != repr(field.default) or _is_model(value):
                    given.append(f"{name}={value!r}")
        return f"{type(self).__name__}({', '.join(given)})"

    def __post_init__(self) -> None:
        """Convert every field to its plain Python form."""
        for name, hint in field_hints(type(self)).items():
            value = getattr(self, name)
            shape = shape_of_rows(hint)
            if shape is not None:
                rows, columns = shape
                path = f"{self.place}.{name}"
                value = frozen_rows(value, path, rows=rows is not None, columns=columns)
            else:
                value = frozen_scalar(value, whole=float not in alternatives(hint))
            object.__setattr__(self, name, value)


def _is_model(value: Any) -> bool:
    return isinstance(value, Parameters) and bool(value.kind)


_HINTS: dict[type[Parameters], dict[str, Any]] = {}


def field_hints(cls: type[Parameters]) -> dict[str, Any]:
    """Resolve the annotations of the fields, in order, once per class."""
    if cls not in _HINTS:
        hints = typing.get_type_hints(cls)
        _HINTS[cls] = {f.name: hints[f.name] for f in dataclasses.fields(cls)}  # type: ignore[arg-type]
    return _HINTS[cls]


@functools.cache
def alternatives(hint: Any) -> tuple[Any, ...]:
    """Split a union into its members; any other annotation is its own only member."""
    if typing.get_origin(hint) in (typing.Union, types.UnionType):
        return typing.get_args(hint)
    return (hint,)


@functools.cache
def shape_of_rows(hint: Any) -> tuple[str | None, int] | None:
    """Look up the rows and columns of an array field; None for any other field."""
    return next((ROWS[a] for a in alternatives(hint) if a in ROWS), None)


@functools.cache
def nested_classes(hint: Any) -> tuple[type[Parameters], ...]:
    """List the parameter classes that a field may hold."""
    return tuple(a for a in alternatives(hint) if isinstance(a, type) and issubclass(a, Parameters))


def to_plain(parameters: Parameters, path: str = "") -> dict[str, Any]:
    """Convert a parameter object to dicts, lists, numbers and strings, with every field present.

    But those of `Parameters.unsaid` that have their defaults.

    Raises
    ------
    ScenarioError
        If a field holds something JSON cannot represent.
    """
    cls = type(parameters)
    plain: dict[str, Any] = {"kind": cls.kind} if cls.kind else {}
    for name, hint in field_hints(cls).items():
        if name in cls.unsaid and _is_default(parameters, name):
            continue
        numbers = parameters.in_place_of.get(name)
        for each in numbers or (name,):
            inner = f"{path}.{each}" if path else each
            plain[each] = _plain_field(getattr(parameters, each), float if numbers else hint, inner)
    return plain


def _is_default(parameters: Parameters, name: str) -> bool:
    default = next(f.default for f in dataclasses.fields(parameters) if f.name == name)  # type: ignore[arg-type]
    value = getattr(parameters, name)
    return type(value) is type(default) and value == default  # others compare as they like


def _plain_field(value: Any, hint: Any, path: str) -> Any:
    classes = nested_classes(hint)
    if classes and not (value is None and type(None) in alternatives(hint)):
        if not isinstance(value, classes):
            names = " or ".join(cls.__name__ for cls in classes)
            raise ScenarioError(path, value, f"must be a {names}")
        return to_plain(value, path)
    if isinstance(value, tuple) and shape_of_rows(hint) is not None:  # from frozen_rows: numbers
        rows = [[_plain_number(x) for x in v] if isinstance(v, tuple) else v for v in value]
        return [row if isinstance(row, list) else _plain_number(row) for row in rows]
    if isinstance(value, str):
        try:
            value.encode()
        except UnicodeEncodeError:
            raise ScenarioError(path, ascii(value), "must be valid Unicode") from None
        return value
    if value is None or isinstance(value, bool):
        return value
    if isinstance(value, (int, float)) and str not in alternatives(hint):  # "Infinity" is a name
        return _plain_number(value)
    rule = next((_RULES[a] for a in alternatives(hint) if a in _RULES), "must be a string or None")
    raise ScenarioError(path, value, rule)


def _plain_number(value: float) -> float | str:
    """Write a non-finite number as a string; a whole number too large for a float is infinite."""
    if -sys.float_info.max <= value <= sys.float_info.max:
        return value
    if value != value:  # noqa: PLR0124 - the definition of NaN
        return "NaN"
    return "Infinity" if value > 0 else "-Infinity"


def from_plain(cls: type[P], plain: dict[str, Any]) -> P:
    """Rebuild a parameter object from plain data that has been validated."""
    hints = field_hints(cls)
    given = {name: value for name, value in plain.items() if name != "kind"}
    return cls(**{name: _rebuilt(value, hints.get(name)) for name, value in given.items()})


def _rebuilt(value: Any, hint: Any) -> Any:
    if not isinstance(value, dict):
        return value
    classes = nested_classes(hint)
    kind = value.get("kind", "")
    return from_plain(next(cls for cls in classes if cls.kind == kind), value)
