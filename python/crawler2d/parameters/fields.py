"""Base of the parameter objects: types of fields, JSON, and dotted paths to fields.

JSON has no non-finite numbers. They are written as "NaN", "Infinity" and "-Infinity", so that the
validator, which knows the rules, can name the field.
"""

from __future__ import annotations

import dataclasses
import functools
import inspect
import re
import reprlib
import sys
import types
import typing
from collections.abc import Callable, Collection, Iterator
from typing import Any, ClassVar, TypeVar, cast

from crawler2d.common.arrays import read_rows, read_scalar, real_number
from crawler2d.common.keywords import TakesKeywords, suggestion
from crawler2d.errors import ScenarioError

P = TypeVar("P", bound="Parameters")

ROWS: dict[Any, tuple[str | None, int | None]] = {
    tuple[float, float]: (None, 2),
    tuple[float, ...]: ("n", None),
    tuple[tuple[float, float], ...]: ("n", 2),
    tuple[tuple[float, float, float], ...]: ("n", 3),
}
"""Rows and columns of the fields that hold arrays; None for either means numbers, not nested."""

_ROWS = {
    (None, 2): "a point (x, y)",
    ("n", None): "a list of numbers",
    ("n", 2): "a list of points (x, y)",
    ("n", 3): "a list of circles (x, y, radius)",
}
_WORDS = {
    float: "a number",
    int: "a whole number",
    str: "a string",
    bool: "True or False",
    type(None): "None",
}
# A whole number of more bits exceeds every float.
_LARGEST_WHOLE = 1024


class Parameters(TakesKeywords):
    """Base of the parameter dataclasses: fields are normalised once, on creation.

    NumPy scalars become Python numbers, whole numbers become floats where the field is a float, and
    arrays of points become tuples. Objects therefore compare, hash and print the same whatever they
    were made from, and do not change when an input array does.
    """

    __slots__ = ()

    kind: ClassVar[str] = ""
    """Tag of the class in JSON; empty where a field has only one class."""
    default_path: ClassVar[str] = ""
    """Usual path of objects of this class in a scenario, for errors."""
    exclusive: ClassVar[tuple[str, ...]] = ()
    """Fields of which only one may be set: replacing one by path clears the others."""
    overridden_by: ClassVar[dict[str, str]] = {}
    """Field to the field that overrides it; replacing the first clears the second."""
    proportional: ClassVar[dict[str, str]] = {}
    """Field to the rows proportional to it in column 2; replacing the field scales them."""
    omitted_defaults: ClassVar[tuple[str, ...]] = ()
    """Fields that JSON omits at their defaults, because older files do not have them."""
    property_fields: ClassVar[tuple[str, ...]] = ()
    """Properties that paths address like fields."""

    @property
    def written_as(self) -> dict[str, tuple[str, ...]]:
        """Map each field that JSON and repr replace by properties to those properties."""
        return {}

    def __init_subclass__(cls, kind: str | None = None, path: str | None = None) -> None:
        """Set `kind` and `default_path`, and keep `dataclass` from making another repr."""
        super().__init_subclass__()
        if kind is not None:  # `dataclass` with slots makes the class again without keywords
            cls.kind = kind
        if path is not None:
            cls.default_path = path
        cls.__repr__ = Parameters.__repr__  # type: ignore[method-assign]

    def __repr__(self) -> str:
        """Write an expression that evaluates to an equal object.

        Fields at their defaults are left out, unless they choose one of several models.
        """
        arguments = []
        for field in fields_of(type(self)):
            for name in self.written_as.get(field.name, (field.name,)):
                value = getattr(self, name)
                is_model = isinstance(value, Parameters) and value.kind
                # Compare as text, which works for any value.
                if is_model or repr(value) != repr(field.default):
                    arguments.append(f"{name}={value!r}")
        return f"{type(self).__name__}({', '.join(arguments)})"

    def __post_init__(self) -> None:
        """Convert every field to plain Python objects, and refuse other types.

        The validator checks which numbers and names are allowed.

        Raises
        ------
        ScenarioError
            If a value has the wrong type, such as a string where a number is needed.
        """
        cls = type(self)
        for name, hint in field_hints(cls).items():
            value, path = getattr(self, name), f"{cls.default_path}.{name}".removeprefix(".")
            shape = shape_of_rows(hint)
            if shape is None:
                value = read_scalar(value, whole=float not in alternatives(hint))
            else:
                rows, columns = shape
                value = read_rows(value, path, rows=rows is not None, columns=columns)
            _check_type(value, hint, path)
            object.__setattr__(self, name, value)


def _check_type(value: Any, hint: Any, path: str) -> None:
    """Refuse a value whose type the field does not accept."""
    kinds = alternatives(hint)
    if callable(value) and not isinstance(value, type) and _takes_functions(hint):
        return
    if type(value) in kinds and not isinstance(value, (str, int)):  # numbers, objects, None
        return
    if isinstance(value, str) and any(kind is str or _choices(kind) for kind in kinds):
        if not value.isascii() and any("\ud800" <= each <= "\udfff" for each in value):
            raise ScenarioError(path, ascii(value), "must be valid Unicode")
    elif type(value) in (int, float) and not {int, float}.isdisjoint(kinds):
        if isinstance(value, int) and value.bit_length() > _LARGEST_WHOLE:
            raise ScenarioError(path, value, "must fit in float64")
    elif not (
        isinstance(value, nested_classes(hint))
        or (type(value) is tuple and shape_of_rows(hint) is not None)  # made by read_rows
        or (type(value) is bool and bool in kinds)
    ):
        raise ScenarioError(path, value, f"must be {_expected(hint)}{_remedy(value, kinds)}")


def _takes_functions(hint: Any) -> bool:
    return any(typing.get_origin(kind) is Callable for kind in alternatives(hint))


def _choices(kind: Any) -> tuple[str, ...]:
    """List the names of a Literal; empty for any other annotation."""
    return typing.get_args(kind) if typing.get_origin(kind) is typing.Literal else ()


def _expected(hint: Any) -> str:
    """Describe what a field takes."""
    words = [cls.__name__ for cls in nested_classes(hint)]
    if words:
        words[0] = f"a {words[0]}"
    shape = shape_of_rows(hint)
    words += [] if shape is None else [_ROWS[shape]]
    for kind in alternatives(hint):
        words += [f"one of {', '.join(_choices(kind))}"] if _choices(kind) else []
        words += [_WORDS[kind]] if kind in _WORDS else []
    words += ["a function"] if _takes_functions(hint) else []
    return " or ".join(words)


def _remedy(value: Any, kinds: tuple[Any, ...]) -> str:
    """Say what is wrong where the value does not show it."""
    if isinstance(value, type) and issubclass(value, Parameters):
        return f"; write {value.__name__}(...)"
    if inside := robot_inside(value, kinds):
        return f"; use {inside}"
    return ", not a string" if isinstance(value, str) and not {float, int}.isdisjoint(kinds) else ""


def robot_inside(value: Any, kinds: tuple[Any, ...]) -> str:
    """Write the attribute of a value, such as what `read_robot` returned, that holds a robot."""
    # Looked up in the class first, as attributes of foreign objects may do anything.
    is_there = hasattr(type(value), "robot") and type(value.robot) in kinds
    return f"{type(value).__name__.lower()}.robot" if is_there else ""


_FIELDS: dict[type[Parameters], list[dataclasses.Field[Any]]] = {}
_HINTS: dict[type[Parameters], dict[str, Any]] = {}


def fields_of(cls: type[Parameters]) -> list[dataclasses.Field[Any]]:
    """List the fields in the order of JSON: the class's own, then inherited ones."""
    if cls not in _FIELDS:
        fields = {field.name: field for field in dataclasses.fields(cls)}  # type: ignore[arg-type]
        names = [name for base in cls.__mro__ for name in inspect.get_annotations(base)]
        _FIELDS[cls] = [fields[name] for name in dict.fromkeys(names) if name in fields]
    return _FIELDS[cls]


def field_hints(cls: type[Parameters]) -> dict[str, Any]:
    """Resolve the annotations of the fields, in order, once per class."""
    if cls not in _HINTS:
        hints = typing.get_type_hints(cls)
        _HINTS[cls] = {field.name: hints[field.name] for field in fields_of(cls)}
    return _HINTS[cls]


@functools.cache
def alternatives(hint: Any) -> tuple[Any, ...]:
    """Split a union into its members; any other annotation is its only member."""
    if typing.get_origin(hint) in (typing.Union, types.UnionType):
        return typing.get_args(hint)
    return (hint,)


@functools.cache
def shape_of_rows(hint: Any) -> tuple[str | None, int | None] | None:
    """Look up the rows and columns of an array field; None for any other field."""
    return next((ROWS[a] for a in alternatives(hint) if a in ROWS), None)


@functools.cache
def nested_classes(hint: Any) -> tuple[type[Parameters], ...]:
    """List the parameter classes that a field may hold."""
    return tuple(a for a in alternatives(hint) if isinstance(a, type) and issubclass(a, Parameters))


def to_dict(parameters: Parameters) -> dict[str, Any]:
    """Convert a parameter object to dicts, lists, numbers and strings.

    Every field is present, except `omitted_defaults` at their defaults.

    Raises
    ------
    ScenarioError
        If a field is a function.
    """
    cls = type(parameters)
    values: dict[str, Any] = {"kind": cls.kind} if cls.kind else {}
    for field in fields_of(cls):
        name = field.name
        if callable(value := getattr(parameters, name)):
            rule = "must not be a function, which only a Simulation can call"
            raise ScenarioError(f"{cls.default_path}.{name}", value, rule)
        if name not in cls.omitted_defaults or value != field.default:
            for each in parameters.written_as.get(name, (name,)):
                values[each] = _json_value(getattr(parameters, each))
    return values


def _json_value(value: Any) -> Any:
    if isinstance(value, (int, float)):  # as nearly all are
        if abs(value) <= sys.float_info.max:
            return value
        if value != value:  # noqa: PLR0124 - the definition of NaN
            return "NaN"
        return "Infinity" if value > 0 else "-Infinity"
    if isinstance(value, Parameters):
        return to_dict(value)
    if isinstance(value, tuple):
        return [_json_value(each) for each in value]
    return value


def from_dict(cls: type[P], values: dict[str, Any]) -> P:
    """Rebuild a parameter object from a validated dictionary of `to_dict`."""
    hints, arguments = field_hints(cls), {}
    for name, value in values.items():
        if isinstance(value, dict):
            classes = nested_classes(hints.get(name))
            nested = next(each for each in classes if each.kind == value.get("kind", ""))
            arguments[name] = from_dict(nested, value)
        elif name != "kind":
            arguments[name] = value
    return cls(**arguments)


# A name and its indices, without leading zeros.
_PART = re.compile(r"([^\[\]]*)((?:\[(?:0|-?[1-9][0-9]*)\])*)")


def replace_path(parameters: P, path: str, value: Any, *, given: Collection[str] = ()) -> P:
    """Copy a parameter object, with the field or element at a path replaced.

    Fields that exclude or override it become None, and proportional ones are scaled, except for the
    paths in `given`: the validator refuses two fields that exclude each other.

    Raises
    ------
    ScenarioError
        If a part of the path is not a field; the message lists the fields and the nearest name. If
        an index is out of range; the message gives the length.
    """
    if not isinstance(path, str):
        raise ScenarioError("path", path, "must be a string")
    copy = _replace_at(parameters, path, value)
    for other in excluded(copy, path):
        if value is not None and other not in given:
            copy = _replace_at(copy, other, None)
    for column, rows in in_proportion(parameters, path).items():
        if column not in {each.partition("[")[0] for each in given}:
            factor = read_path(copy, path) / read_path(parameters, path)
            copy = _replace_at(copy, column, [(first, factor * second) for first, second in rows])
    return copy


def read_path(parameters: Parameters, path: str, given: Any = None) -> Any:
    """Return the value at a path; raises the errors of `replace_path`, about what was given."""
    return _nodes_along(parameters, path, given)[-1]


def expand_path(parameters: Parameters, path: str) -> list[str]:
    """Expand ``[*]`` in a path to the paths of all elements.

    Examples
    --------
    >>> from crawler2d.parameters.terrain import Points
    >>> expand_path(Points([(-1, 0), (1, 0)], goal=0.0), "points[*][1]")
    ['points[0][1]', 'points[1][1]']
    """
    before, star, after = path.partition("[*]")
    if not star:
        return [path]
    rows = read_path(parameters, before)
    if not isinstance(rows, tuple):
        raise ScenarioError(path, rows, f"must be a path of elements: {before} has none")
    return [
        each
        for index in range(len(rows))
        for each in expand_path(parameters, f"{before}[{index}]{after}")
    ]


def json_pointer(path: str) -> str:
    """Write a path as a JSON pointer: ``/terrain/points/3/1``."""
    return "".join(f"/{step}" for step in _steps(path))


def excluded(parameters: Parameters, path: str) -> list[str]:
    """List the paths of fields that exclude the one at a path, or currently override it."""
    parent, _, name = path.rpartition(".")
    holder = _holder(parameters, parent)
    names, override = type(holder).exclusive, type(holder).overridden_by.get(name)
    others = [other for other in names if other != name] if name in names else []
    if override and getattr(holder, override) is not None:
        others.append(override)
    return [f"{path.removesuffix(name)}{other}" for other in others]


def in_proportion(parameters: Parameters, path: str) -> dict[str, tuple[tuple[float, float], ...]]:
    """Return the rows proportional to the number at a path, by their path; none if it is 0.

    Examples
    --------
    >>> from crawler2d.parameters.drivetrain import Drivetrain
    >>> limits = {"max_speed": 1.0, "max_acceleration": 1.0, "max_deceleration": 1.0}
    >>> motor = Drivetrain(**limits, max_torque=6.0, torque_curve=[(0.0, 6.0), (1.0, 2.0)])
    >>> in_proportion(motor, "max_torque")
    {'torque_curve': ((0.0, 6.0), (1.0, 2.0))}
    """
    parent, _, name = path.rpartition(".")
    holder = _holder(parameters, parent)
    column = type(holder).proportional.get(name)
    rows = getattr(holder, column) if column and getattr(holder, name) else None
    return {f"{path.removesuffix(name)}{column}": rows} if rows else {}


def is_whole(parameters: Parameters, path: str) -> bool:
    """Whether the field at a path takes only whole numbers."""
    parent, _, name = path.rpartition(".")
    kinds = alternatives(field_hints(type(_holder(parameters, parent))).get(name))
    return int in kinds and float not in kinds


def read_number_path(parameters: Parameters, path: str, name: str) -> str:
    """Refuse the path of anything but a real number; `name` is the argument's."""
    number = read_path(parameters, path) if isinstance(path, str) else None
    if type(number) not in (int, float) or is_whole(parameters, path):
        raise ScenarioError(name, path, "must be the path of a real number")
    return path


def _holder(parameters: Parameters, path: str) -> Parameters:
    holder: Parameters = read_path(parameters, path) if path else parameters
    return holder


def _steps(path: str) -> list[str | int]:
    """Split ``terrain.points[3]`` into ``terrain``, ``points`` and 3."""
    steps: list[str | int] = []
    for part in path.split("."):
        match = _PART.fullmatch(part)
        name, indices = match.groups() if match else (part, "")
        steps += [name, *map(int, re.findall(r"-?[0-9]+", indices))]
    return steps


def _replace_at(root: P, path: str, value: Any) -> P:
    steps, nodes = _steps(path), _nodes_along(root, path, value)
    for depth in reversed(range(len(steps))):
        step, node, old = steps[depth], nodes[depth], nodes[depth + 1]
        if isinstance(step, str):
            value = _replace_field(node, step, value, path)
            continue
        if depth + 1 == len(steps) and isinstance(old, tuple):
            value = read_rows(value, path, rows=False, columns=len(old))
        elif depth + 1 == len(steps):
            value = real_number(value, path)
        value = (*node[:step], value, *node[step + 1 :])
    return cast("P", value)


def _replace_field(node: Any, name: str, value: Any, path: str) -> Any:
    """Replace a field; errors get its real path instead of the object's default path."""
    try:
        return dataclasses.replace(node, **{name: value})
    except ScenarioError as error:
        before = path.rpartition(name)[0]
        field = error.path.removeprefix(f"{node.default_path}.")
        raise type(error)(f"{before}{field}", error.value, error.rule) from None


def _nodes_along(root: Parameters, path: str, value: Any) -> list[Any]:
    """List the root and the node at each step of a path; errors show the value to be set."""
    nodes: list[Any] = [root]
    parent = ""
    for step in _steps(path):
        node = nodes[-1]
        kind: Any = Parameters if isinstance(step, str) else tuple
        if not isinstance(node, kind):
            lacking = "elements" if kind is tuple else "fields"
            rule = f"must be a known field: {parent} = {reprlib.repr(node)} has no {lacking}"
            raise ScenarioError(path, value, rule)
        if isinstance(step, str):
            names = _field_names(type(node))
            if step not in names:
                hint = suggestion(step, names, known_paths(root))
                listed = f"{type(node).__name__} has {', '.join(names) or 'no fields'}"
                raise ScenarioError(path, value, f"must be a known field: {listed}{hint}")
            nodes.append(getattr(node, step))
            parent = f"{parent}.{step}".removeprefix(".")
        elif 0 <= step < len(node):
            nodes.append(node[step])
            parent += f"[{step}]"
        else:
            rule = f"must be an existing element: {parent} has {len(node)} elements, counted from 0"
            raise ScenarioError(path, value, rule)
    return nodes


def _field_names(cls: type[Parameters]) -> list[str]:
    return [*field_hints(cls), *cls.property_fields]


def known_paths(parameters: Parameters) -> Iterator[str]:
    """List the paths of all fields, nested ones after their parents."""
    for name in _field_names(type(parameters)):
        yield name
        nested = getattr(parameters, name)
        if isinstance(nested, Parameters):
            yield from (f"{name}.{path}" for path in known_paths(nested))
