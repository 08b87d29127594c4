"""Dotted paths of fields and elements: read what is there, or replace it in a copy."""

from __future__ import annotations

import dataclasses
import re
import reprlib
from collections.abc import Collection
from typing import Any, TypeVar

from crawler2d.common.arrays import frozen_rows, real_number
from crawler2d.errors import ScenarioError
from crawler2d.parameters.plain import Parameters, alternatives, field_hints

P = TypeVar("P", bound=Parameters)

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
    copy: P = _replaced(parameters, _steps(path), value, path)
    for other in excluded(copy, path):
        if value is not None and other not in given:
            copy = _replaced(copy, _steps(other), None, other)
    return copy


def read_path(parameters: Parameters, path: str) -> Any:
    """Return what is at a path; errors are those of `replace_path`."""
    node: Any = parameters
    steps = _steps(path)
    for depth in range(len(steps)):
        node = _held(node, steps[: depth + 1], None, path)
    return node


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


def _replaced(node: Any, steps: list[str | int], value: Any, path: str, depth: int = 0) -> Any:
    held = _held(node, steps[: depth + 1], value, path)
    step, is_last = steps[depth], depth + 1 == len(steps)
    if not is_last:
        value = _replaced(held, steps, value, path, depth + 1)
    if isinstance(step, str):
        return dataclasses.replace(node, **{step: value})
    if is_last and isinstance(held, tuple):
        value = frozen_rows(value, path, rows=False, columns=len(held))
    elif is_last:
        value = real_number(value, path)
    return (*node[:step], value, *node[step + 1 :])


def _held(node: Any, steps: list[str | int], value: Any, path: str) -> Any:
    """Return what the last step names; the earlier steps have led to `node`."""
    *before, step = steps
    place = "".join(f"[{s}]" if isinstance(s, int) else f".{s}" for s in before).removeprefix(".")
    if isinstance(step, str):
        if not isinstance(node, Parameters):
            rule = f"must be a known field: {place} = {reprlib.repr(node)} has no fields"
            raise ScenarioError(path, value, rule)
        if step not in _names(type(node)):
            raise ScenarioError(path, value, _rule(type(node), step))
        return getattr(node, step)
    if not isinstance(node, tuple):
        rule = f"must be a known field: {place} = {reprlib.repr(node)} has no elements"
        raise ScenarioError(path, value, rule)
    if not 0 <= step < len(node):
        rule = f"must be an element that exists: {place} has {len(node)} elements, counted from 0"
        raise ScenarioError(path, value, rule)
    return node[step]


def _names(cls: type[Parameters]) -> list[str]:
    return [*field_hints(cls), *cls.besides]


def _rule(cls: type[Parameters], name: str) -> str:
    import difflib  # noqa: PLC0415 - only a failure needs it

    fields = _names(cls)
    nearest = difflib.get_close_matches(name, fields, n=1)
    hint = f" (did you mean {nearest[0]}?)" if nearest else ""
    listed = ", ".join(fields) if fields else "no fields"
    return f"must be a known field: {cls.__name__} has {listed}{hint}"
