"""Parameter objects as plain data: what a field may hold, its JSON, and dotted paths to it.

Parameter objects as plain data: what a frozen dataclass may hold, and how it becomes JSON.

JSON has no non-finite numbers; they are written as the strings "NaN", "Infinity" and "-Infinity",
so that the validator, which knows the rules, can name the field.
"""

from __future__ import annotations

import dataclasses
import functools
import re
import reprlib
import sys
import types
import typing
from collections.abc import Collection, Iterator
from typing import Any, ClassVar, TypeVar, cast

from crawler2d.common.arrays import frozen_rows, frozen_scalar, real_number
from crawler2d.common.keywords import TakesKeywords, suggestion
from crawler2d.errors import ScenarioError

P = TypeVar("P", bound="Parameters")

ROWS = {
    tuple[float, float]: (None, 2),
    tuple[tuple[float, float], ...]: ("n", 2),
    tuple[tuple[float, float, float], ...]: ("n", 3),
}
"""Rows and columns of the fields that hold arrays; None for rows means a single row, not nested."""

_ROWS = {
    (None, 2): "a point (x, y)",
    ("n", 2): "a list of points (x, y)",
    ("n", 3): "a list of circles (x, y, radius)",
}
_NUMBERS = {float: "a number", int: "a whole number"}
# A whole number of more bits exceeds every float.
_LARGEST_WHOLE = 1024


class Parameters(TakesKeywords):
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
        """Convert every field to its plain Python form, and refuse what is no value of it.

        Which numbers and names are values is for the validator to say.

        Raises
        ------
        ScenarioError
            If a field has something of another type, such as a text in place of a number.
        """
        for name, hint, path, shape, whole in _forms(type(self)):
            value = getattr(self, name)
            if shape is not None:
                rows, columns = shape
                value = frozen_rows(value, path, rows=rows is not None, columns=columns)
            else:
                value = frozen_scalar(value, whole=whole)
            _check_type(value, hint, path)
            object.__setattr__(self, name, value)


_Form = tuple[str, Any, str, tuple[str | None, int] | None, bool]
_FORMS: dict[type[Parameters], list[_Form]] = {}


def _forms(cls: type[Parameters]) -> list[_Form]:
    """List name, annotation, path and shape of each field, and whether it takes whole numbers."""
    if cls not in _FORMS:
        _FORMS[cls] = [
            (
                *(name, hint, f"{cls.place}.{name}" if cls.place else name),
                *(shape_of_rows(hint), float not in alternatives(hint)),
            )
            for name, hint in field_hints(cls).items()
        ]
    return _FORMS[cls]


def _check_type(value: Any, hint: Any, path: str) -> None:
    """Refuse a value of a type that a field does not have."""
    kinds = alternatives(hint)
    if type(value) in kinds and not isinstance(value, (str, int)):  # numbers, objects, None
        return
    if isinstance(value, str) and any(kind is str or _names(kind) for kind in kinds):
        if not value.isascii() and any("\ud800" <= each <= "\udfff" for each in value):
            raise ScenarioError(path, ascii(value), "must be valid Unicode")
    elif type(value) in (int, float) and not {int, float}.isdisjoint(kinds):
        if isinstance(value, int) and value.bit_length() > _LARGEST_WHOLE:
            raise ScenarioError(path, value, "must fit in float64")
    elif not (
        isinstance(value, nested_classes(hint))
        or (type(value) is tuple and shape_of_rows(hint) is not None)  # made by frozen_rows
        or (type(value) is bool and bool in kinds)
    ):
        raise ScenarioError(path, value, f"must be {_described(hint)}{_instead(value, kinds)}")


def _names(kind: Any) -> tuple[str, ...]:
    """List the names that a field may have, if that is what it has."""
    return typing.get_args(kind) if typing.get_origin(kind) is typing.Literal else ()


def _described(hint: Any) -> str:
    """Say what a field takes."""
    words = [cls.__name__ for cls in nested_classes(hint)]
    if words:
        words[0] = f"a {words[0]}"
    shape = shape_of_rows(hint)
    words += [] if shape is None else [_ROWS[shape]]
    for kind in alternatives(hint):
        words += [f"one of {', '.join(_names(kind))}"] if _names(kind) else []
        words += [_NUMBERS[kind]] if kind in _NUMBERS else []
        words += ["a string"] if kind is str else ["True or False"] if kind is bool else []
    return " or ".join([*words, *(["None"] if type(None) in alternatives(hint) else [])])


def _instead(value: Any, kinds: tuple[Any, ...]) -> str:
    """Say what was given, where its text does not show it."""
    if isinstance(value, type) and issubclass(value, Parameters):
        return f", not a class: write {value.__name__}(...)"
    return ", not a string" if isinstance(value, str) and not {float, int}.isdisjoint(kinds) else ""


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


def to_plain(parameters: Parameters) -> dict[str, Any]:
    """Convert a parameter object to dicts, lists, numbers and strings, with every field present.

    But those of `Parameters.unsaid` that have their defaults.
    """
    cls = type(parameters)
    plain: dict[str, Any] = {"kind": cls.kind} if cls.kind else {}
    for name in field_hints(cls):
        if name not in cls.unsaid or not _is_default(parameters, name):
            for each in parameters.in_place_of.get(name, (name,)):
                plain[each] = _plain_value(getattr(parameters, each))
    return plain


def _is_default(parameters: Parameters, name: str) -> bool:
    default = next(f.default for f in dataclasses.fields(parameters) if f.name == name)  # type: ignore[arg-type]
    return bool(getattr(parameters, name) == default)


def _plain_value(value: Any) -> Any:
    if isinstance(value, Parameters):
        return to_plain(value)
    if isinstance(value, tuple):
        return [
            [_plain_number(x) for x in v] if isinstance(v, tuple) else _plain_number(v)
            for v in value
        ]
    is_number = isinstance(value, (int, float)) and not isinstance(value, bool)
    return _plain_number(value) if is_number else value


def _plain_number(value: float) -> float | str:
    """Write a non-finite number as a string."""
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


# A name and its indices, without leading zeros.
_PART = re.compile(r"([^\[\]]*)((?:\[(?:0|-?[1-9][0-9]*)\])*)")


def replace_path(parameters: P, path: str, value: Any, *, given: Collection[str] = ()) -> P:
    """Copy a parameter object, with the field or element at a path replaced.

    Fields that exclude it are set to None, except those at the paths `given`: that both are there
    is for the validator to refuse.

    Raises
    ------
    ScenarioError
        If a part of the path is not a field; the message lists the fields and the nearest name. If
        an index is out of range; the message gives the length.
    """
    if not isinstance(path, str):
        raise ScenarioError("path", path, "must be a string")
    copy = _replaced(parameters, path, value)
    for other in excluded(copy, path):
        if value is not None and other not in given:
            copy = _replaced(copy, other, None)
    return copy


def read_path(parameters: Parameters, path: str) -> Any:
    """Return what is at a path; errors are those of `replace_path`."""
    return _nodes(parameters, path, None)[-1]


def expand_path(parameters: Parameters, path: str) -> list[str]:
    """List the paths that one with ``[*]`` stands for: every element there.

    Examples
    --------
    >>> from crawler2d.parameters.terrain import Points
    >>> expand_path(Points([(-1, 0), (1, 0)], goal=0.0), "points[*][1]")
    ['points[0][1]', 'points[1][1]']
    """
    before, star, after = path.partition("[*]")
    if not star:
        return [path]
    held = read_path(parameters, before)
    if not isinstance(held, tuple):
        raise ScenarioError(path, held, f"must be a path of elements: {before} has none")
    return [
        each
        for index in range(len(held))
        for each in expand_path(parameters, f"{before}[{index}]{after}")
    ]


def json_pointer(path: str) -> str:
    """Write a path as a JSON pointer: ``/terrain/points/3/1``."""
    return "".join(f"/{step}" for step in _steps(path))


def excluded(parameters: Parameters, path: str) -> list[str]:
    """List the paths of the fields that exclude the one at a path."""
    parent, _, name = path.rpartition(".")
    either = type(read_path(parameters, parent) if parent else parameters).either
    others = [other for other in either if other != name] if name in either else []
    return [f"{path.removesuffix(name)}{other}" for other in others]


def is_whole(parameters: Parameters, path: str) -> bool:
    """Whether the field at a path takes only whole numbers."""
    parent, _, name = path.rpartition(".")
    holder = read_path(parameters, parent) if parent else parameters
    kinds = alternatives(field_hints(type(holder)).get(name))
    return int in kinds and float not in kinds


def _steps(path: str) -> list[str | int]:
    """Split ``terrain.points[3]`` into ``terrain``, ``points`` and 3."""
    steps: list[str | int] = []
    for part in path.split("."):
        match = _PART.fullmatch(part)
        name, indices = match.groups() if match else (part, "")
        steps += [name, *map(int, re.findall(r"-?[0-9]+", indices))]
    return steps


def _replaced(root: P, path: str, value: Any) -> P:
    steps, nodes = _steps(path), _nodes(root, path, value)
    for depth in reversed(range(len(steps))):
        step, node, held = steps[depth], nodes[depth], nodes[depth + 1]
        if isinstance(step, str):
            value = _with(node, step, value, path)
            continue
        if depth + 1 == len(steps) and isinstance(held, tuple):
            value = frozen_rows(value, path, rows=False, columns=len(held))
        elif depth + 1 == len(steps):
            value = real_number(value, path)
        value = (*node[:step], value, *node[step + 1 :])
    return cast("P", value)


def _with(node: Any, name: str, value: Any, path: str) -> Any:
    """Replace a field; an object does not know where it is, and names the usual place in errors."""
    try:
        return dataclasses.replace(node, **{name: value})
    except ScenarioError as error:
        before = path.rpartition(name)[0]
        field = error.path.removeprefix(f"{node.place}.")
        raise type(error)(f"{before}{field}", error.value, error.rule) from None


def _nodes(root: Parameters, path: str, value: Any) -> list[Any]:
    """Return what the steps of a path lead through, the root first."""
    nodes: list[Any] = [root]
    steps = _steps(path)
    for depth in range(len(steps)):
        nodes.append(_held(nodes, steps[: depth + 1], value, path))
    return nodes


def _held(nodes: list[Any], steps: list[str | int], value: Any, path: str) -> Any:
    """Return what the last step names; the earlier steps have led through these nodes."""
    *before, step = steps
    node = nodes[-1]
    place = "".join(f"[{s}]" if isinstance(s, int) else f".{s}" for s in before).removeprefix(".")
    if isinstance(step, str):
        if not isinstance(node, Parameters):
            rule = f"must be a known field: {place} = {reprlib.repr(node)} has no fields"
            raise ScenarioError(path, value, rule)
        if step not in _field_names(type(node)):
            raise ScenarioError(path, value, _rule(nodes[0], type(node), step))
        return getattr(node, step)
    if not isinstance(node, tuple):
        rule = f"must be a known field: {place} = {reprlib.repr(node)} has no elements"
        raise ScenarioError(path, value, rule)
    if not 0 <= step < len(node):
        rule = f"must be an element that exists: {place} has {len(node)} elements, counted from 0"
        raise ScenarioError(path, value, rule)
    return node[step]


def _field_names(cls: type[Parameters]) -> list[str]:
    return [*field_hints(cls), *cls.besides]


def _rule(root: Parameters, cls: type[Parameters], name: str) -> str:
    fields = _field_names(cls)
    hint = suggestion(name, fields, known_paths(root))
    listed = ", ".join(fields) if fields else "no fields"
    return f"must be a known field: {cls.__name__} has {listed}{hint}"


def known_paths(parameters: Parameters) -> Iterator[str]:
    """List the paths of all fields, those of nested objects after their own."""
    for name in _field_names(type(parameters)):
        yield name
        held = getattr(parameters, name)
        if isinstance(held, Parameters):
            yield from (f"{name}.{path}" for path in known_paths(held))
