"""Dotted paths of fields and elements: read what is there, or replace it in a copy."""

from __future__ import annotations

import dataclasses
import re
import reprlib
from collections.abc import Collection, Iterator
from typing import Any, TypeVar, cast

from crawler2d.common.arrays import frozen_rows, real_number
from crawler2d.common.keywords import suggestion
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
        if step not in _names(type(node)):
            raise ScenarioError(path, value, _rule(nodes[0], type(node), step))
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


def _rule(root: Parameters, cls: type[Parameters], name: str) -> str:
    fields = _names(cls)
    hint = suggestion(name, fields, known_paths(root))
    listed = ", ".join(fields) if fields else "no fields"
    return f"must be a known field: {cls.__name__} has {listed}{hint}"


def known_paths(parameters: Parameters) -> Iterator[str]:
    """List the paths of all fields, those of nested objects after their own."""
    for name in _names(type(parameters)):
        yield name
        held = getattr(parameters, name)
        if isinstance(held, Parameters):
            yield from (f"{name}.{path}" for path in known_paths(held))
