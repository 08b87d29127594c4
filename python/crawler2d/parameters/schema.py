"""JSON Schema of scenario files, from the classes, their docstrings and the rules of the core."""

from __future__ import annotations

import functools
import inspect
import json
import re
from collections.abc import Iterator
from dataclasses import MISSING
from typing import Any, Literal, get_args, get_origin

from crawler2d import _core
from crawler2d.errors import ScenarioError
from crawler2d.parameters.fields import (
    Parameters,
    alternatives,
    field_hints,
    fields_of,
    nested_classes,
    shape_of_rows,
    to_dict,
)
from crawler2d.parameters.robot import Robot
from crawler2d.parameters.scenario import Scenario
from crawler2d.parameters.terrain import Step
from crawler2d.parameters.track import LineOfWheels

__all__ = ["scenario_schema"]

Json = dict[str, Any]
Place = tuple[str, int | None]
"""A field, and the column if it holds rows."""

_DRAFT = "https://json-schema.org/draft/2020-12/schema"
_TYPES = {float: "number", int: "integer", str: "string", bool: "boolean", type(None): "null"}

_BELOW = -1e300
"""Below the range of every number."""
_REALS = re.compile(r"must be (>=?) (\S+).* and <= (\S+)")
_WHOLES = re.compile(r"must be (?:an integer from (\d+) to )?(\d+)$")
_ROW = re.compile(r"(\w+)((?:\[\d+\])*)")


def scenario_schema() -> Json:
    """Describe scenario files in JSON Schema, draft 2020-12.

    Types come from the classes, descriptions from their docstrings, ranges from the core.
    `Scenario.from_json` checks rules about several fields.

    Returns
    -------
    dict
        Plain data.

    Examples
    --------
    >>> schema = scenario_schema()
    >>> schema["$defs"]["Step"]["properties"]["height"]["exclusiveMinimum"]
    0.0
    """
    return {
        "$schema": _DRAFT,
        "title": "crawler2d scenario",
        "$comment": "crawler2d {version}, core {build_id}".format_map(_core.build_info()),
        **_object(Scenario),
        "$defs": {cls.__name__: _object(cls) for cls in _classes(Scenario) if cls is not Scenario},
    }


def _classes(cls: type[Parameters], found: tuple[type[Parameters], ...] = ()) -> Any:
    """List a class and all classes that its fields may hold, each once."""
    if cls in found:
        return found
    found = (*found, cls)
    for hint in field_hints(cls).values():
        for each in nested_classes(hint):
            found = _classes(each, found)
    return found


def _object(cls: type[Parameters]) -> Json:
    """Describe the JSON object of a class."""
    texts, limits = _descriptions(cls), _limits(cls)
    properties: Json = {"kind": {"const": cls.kind}} if cls.kind else {}
    for field in fields_of(cls):
        name = field.name
        properties[name] = _value(field_hints(cls)[name], name, limits)
        if name in texts:
            properties[name]["description"] = texts[name]
        if field.default is None or type(field.default) in _TYPES:
            properties[name]["default"] = field.default
    described: Json = {
        "description": " ".join((inspect.getdoc(cls) or cls.__name__).partition("\n\n")[0].split()),
        "type": "object",
        "properties": properties,
        "additionalProperties": False,
        "required": [name for name in properties if name not in cls.omitted_defaults],
    }
    for name, others in _written_as(cls).items():
        for other in others:
            properties[other] = _value(float, other, limits) | {"description": texts[other]}
        described["required"].remove(name)
        described["oneOf"] = [
            {"required": [name], "properties": dict.fromkeys(others, False)},
            {"required": list(others), "properties": {name: False}},
        ]
    if cls.exclusive:
        given = {name: {"not": {"type": "null"}} for name in cls.exclusive}
        described["not"] = {"required": list(given), "properties": given}
    return described


def _value(hint: Any, name: str, limits: dict[Place, Json]) -> Json:
    """Describe what a field holds."""
    kinds, nested = alternatives(hint), nested_classes(hint)
    types = [_TYPES[kind] for kind in kinds if kind in _TYPES]
    if nested:
        options: list[Json] = [{"$ref": f"#/$defs/{cls.__name__}"} for cls in nested]
        options += [{"type": each} for each in types]
        return options[0] if len(options) == 1 else {"oneOf": options}
    names = [each for kind in kinds if get_origin(kind) is Literal for each in get_args(kind)]
    if names:
        return {"enum": names}
    shape = shape_of_rows(hint)
    if shape is None:
        return {"type": types[0] if len(types) == 1 else types, **limits.get((name, None), {})}
    rows, columns = shape
    if columns is None:
        cell = {"type": "number", **limits[name, 0]}
        return {"type": ["array", *types], "items": cell}
    cells = [{"type": "number", **limits[name, column]} for column in range(columns)]
    row = {"type": "array", "prefixItems": cells, "items": False, "minItems": columns}
    value = row if rows is None else {"type": "array", "items": row}
    return {**value, "type": ["array", *types]} if types else value


def _descriptions(cls: type[Parameters]) -> dict[str, str]:
    """Read the description of each field from the docstring."""
    section = re.search(
        r"^Parameters\n-+\n(.*?)(?=^\w[^\n]*\n-+$|\Z)",
        inspect.getdoc(cls) or "",
        re.MULTILINE | re.DOTALL,
    )
    found = re.findall(
        r"^(\w[^:\n]*) : .*\n((?:    .*\n?|\n)*)", section[1] if section else "", re.M
    )
    return {
        name: " ".join(text.split()) for names, text in found for name in names.strip().split(", ")
    }


@functools.cache
def _sample() -> Scenario:
    """Make a valid scenario, to fill in everything except the class under test."""
    robot = Robot.simple(20.0, axle_distance=0.4, radius=0.06)
    return Scenario(robot.with_track(LineOfWheels(4)), Step(0.05))


def _written_as(cls: type[Parameters]) -> dict[str, tuple[str, ...]]:
    """Map each field to those that a file may have instead."""
    held: Any = _sample()
    if not cls.property_fields:
        return {}
    for name in cls.default_path.split("."):
        held = getattr(held, name)
    return dict(held.written_as)


def _limits(cls: type[Parameters]) -> dict[Place, Json]:
    """Ask the core for the range of every number of a class.

    All numbers start below their range. The core refuses them one at a time and names the range;
    the number then moves to its end.
    """
    limits: dict[Place, Json] = {}
    for values in _with_wrong_numbers(cls):
        while (refused := _refusal(cls, values)) is not None:
            name, indices, rule = refused
            limit, within = _range(rule)
            if limit is not None:
                limits[name, indices[-1] if indices else None] = limit
                steps: list[str | int] = [name, *indices]
                holder: Any = values
                for step in steps[:-1]:
                    holder = holder[step]
                holder[steps[-1]] = within
            elif values.get(name) is not None and type(None) in alternatives(
                field_hints(cls)[name]
            ):
                values[name] = None  # a rule about several fields, or several rows
            else:
                break
    return limits


def _with_wrong_numbers(cls: type[Parameters]) -> Iterator[Json]:
    """Write objects of a class with all numbers out of range, one for each notation."""
    values: Json = {"kind": cls.kind} if cls.kind else {}
    for name, hint in field_hints(cls).items():
        values[name] = _wrong(hint, f"{cls.default_path}.{name}".removeprefix("."))
    for name, others in _written_as(cls).items():
        short = {**values, **dict.fromkeys(others, _BELOW)}
        del short[name]
        yield short
    yield values


def _wrong(hint: Any, path: str) -> Any:
    """Choose a value for a field: valid unless it is a number."""
    kinds, shape, nested = alternatives(hint), shape_of_rows(hint), nested_classes(hint)
    if shape is not None:
        rows, columns = shape
        if columns is None:
            return [_BELOW] * 2
        return [_BELOW] * columns if rows is None else [[_BELOW] * columns for _ in range(2)]
    if nested:
        return None if type(None) in kinds else _part(path, nested)
    names = [each for kind in kinds if get_origin(kind) is Literal for each in get_args(kind)]
    if names:
        return names[0]
    return "" if str in kinds else False if bool in kinds else _BELOW


def _part(path: str, classes: tuple[type[Parameters], ...]) -> Json:
    """Take the sample's object at a path, or the first class that needs no arguments."""
    held: Any = _sample()
    for name in path.split("."):
        held = getattr(held, name, None)
    if isinstance(held, classes):
        return to_dict(held)
    defaults = (cls for cls in classes if all(f.default is not MISSING for f in fields_of(cls)))
    return to_dict(next(defaults)())


def _refusal(cls: type[Parameters], values: Json) -> tuple[str, list[int], str] | None:
    """Let the core read an object; return field, indices and rule if it refuses one."""
    scenario = to_dict(_sample())
    holder, (*parents, last) = scenario, cls.default_path.split(".")
    for name in parents:
        holder = holder[name]
    if last:
        holder[last] = values
    else:
        scenario = values
    try:
        _core.canonical(json.dumps(scenario))
    except ScenarioError as error:
        inside = error.path.removeprefix(cls.default_path).removeprefix(".")
        match = _ROW.fullmatch(inside)
        if match:
            return match[1], [int(each) for each in re.findall(r"\d+", match[2])], error.rule
    return None


def _range(rule: str) -> tuple[Json | None, float]:
    """Turn a rule about one number into its range and a number in it; None for other rules."""
    if match := _WHOLES.match(rule):
        low, high = int(match[1] or match[2]), int(match[2])
        return {"minimum": low, "maximum": high}, low
    if match := _REALS.match(rule):
        end, most = float(match[2]), float(match[3])
        least = "minimum" if match[1] == ">=" else "exclusiveMinimum"
        return {least: end, "maximum": most}, end if match[1] == ">=" else most
    return None, 0.0
