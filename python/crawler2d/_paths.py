"""Dotted paths of fields: how a variant of a scenario is made."""

from __future__ import annotations

import dataclasses
from typing import Any, TypeVar

from crawler2d._json import Parameters, field_hints
from crawler2d.errors import ScenarioError

P = TypeVar("P", bound=Parameters)


def replace_path(parameters: P, path: str, value: Any) -> P:
    """Copy a parameter object with the field at a dotted path replaced.

    Raises
    ------
    ScenarioError
        If a part of the path is no field there; the message lists the fields and the nearest name.
    """
    return _replaced(parameters, path.split("."), value, path)


def _replaced(parameters: P, names: list[str], value: Any, path: str) -> P:
    name, *rest = names
    if name not in field_hints(type(parameters)):
        raise ScenarioError(path, value, _rule(type(parameters), name))
    if rest:
        inner = getattr(parameters, name)
        if not isinstance(inner, Parameters):
            prefix = path.removesuffix("." + ".".join(rest))
            raise ScenarioError(
                path, value, f"must name a field, but {prefix} = {inner!r} has none"
            )
        value = _replaced(inner, rest, value, path)
    return dataclasses.replace(parameters, **{name: value})  # type: ignore[type-var]


def _rule(cls: type[Parameters], name: str) -> str:
    import difflib  # noqa: PLC0415 - only a failure needs it

    fields = list(field_hints(cls))
    nearest = difflib.get_close_matches(name, fields, n=1)
    hint = f" (did you mean {nearest[0]}?)" if nearest else ""
    listed = ", ".join(fields) if fields else "it has none"
    return f"must name a field of {cls.__name__}: {listed}{hint}"
