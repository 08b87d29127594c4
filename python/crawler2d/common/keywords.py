"""Refuse unknown keywords, with the nearest known one, and superfluous positional arguments."""

from __future__ import annotations

import functools
import inspect
from collections.abc import Callable, Iterable, Mapping, Sequence
from types import FunctionType
from typing import Any, ParamSpec, Self, TypeVar, cast

from crawler2d.errors import ArgumentError, ScenarioError

__all__ = [
    "TakesKeywords",
    "limits_hint",
    "read_choice",
    "refuse_unknown",
    "suggestion",
    "takes_keywords",
]

P = ParamSpec("P")
R = TypeVar("R")

_BEYOND_A_SIDE_VIEW = (
    *("roll", "yaw", "turn", "turning", "steer", "steering", "heading", "lateral"),
    *("soil", "sand", "mud", "sinkage", "cohesion", "suspension"),
    *("stl", "mesh", "heightmap", "pid", "kp", "ki", "kd", "controller"),
)
"""Features that users look for and a side view lacks; see README, "Limits"."""

_LIMITS = (
    " (crawler2d is a side view; README, Limits, lists what it leaves out, such as roll, yaw,"
    " turning, soil, suspension, meshes of the ground and controllers)"
)
_MISSPELT, _ALIKE = 0.8, 0.6
"""Similarity by `difflib`: for a missing letter, and for half of the letters in common."""
_MOST = 3
"""Names in one hint."""


def limits_hint(name: str) -> str:
    """Point to the limits if a name asks for a feature that a side view lacks, else ""."""
    parts = name.lower().split("_")
    return _LIMITS if any(part in _BEYOND_A_SIDE_VIEW for part in parts) else ""


def suggestion(name: str, names: Iterable[str], paths: Iterable[str] = ()) -> str:
    """Suggest the known name that was probably meant; "" if none is similar.

    Parameters
    ----------
    name : str
        The unknown name.
    names, paths : iterable of str
        Known names in the same object, and paths elsewhere.

    Examples
    --------
    >>> suggestion("radius", ["count", "wheel_radius"])
    ' (did you mean wheel_radius?)'
    >>> suggestion("gait", ["gravity", "drive"], ["drive.speed", "drive.gait"])
    ' (did you mean drive.gait?)'
    """
    import difflib  # noqa: PLC0415 - only a failure needs it

    here, there = ({each: each.rpartition(".")[2] for each in known} for known in (names, paths))
    meant = [path for path, last in there.items() if last == name]
    for least in (_MISSPELT, _ALIKE):
        for known in (here, there):
            nearest = difflib.get_close_matches(name, known.values(), n=1, cutoff=least)
            meant = meant or [each for each, last in known.items() if last in nearest]
        if not meant and limits_hint(name):
            return limits_hint(name)
    return f" (did you mean {' or '.join(meant[:_MOST])}?)" if meant else ""


def read_choice(value: object, path: str, names: Sequence[str]) -> str:
    """Return a name from a list.

    Raises
    ------
    ScenarioError
        If it is not in the list; the message suggests the nearest.
    """
    if isinstance(value, str) and value in names:
        return str(value)
    import difflib  # noqa: PLC0415 - only a failure needs it

    nearest = difflib.get_close_matches(str(value), names, n=1)
    hint = f" (did you mean {nearest[0]}?)" if nearest else ""
    if any("," in name for name in names):
        names = [f'"{name}"' for name in names]
    raise ScenarioError(path, value, f"must be one of {', '.join(names)}{hint}")


def refuse_unknown(
    called: str, given: Mapping[str, object], known: Sequence[str], paths: Iterable[str] = ()
) -> None:
    """Refuse unknown keywords.

    Parameters
    ----------
    called : str
        The function or class.
    given : mapping of str to object
        The keywords with their values.
    known : sequence of str
        Known keywords.
    paths : iterable of str
        Other names that may have been meant.

    Raises
    ------
    ArgumentError
        For the first unknown keyword.
    """
    for name, value in given.items():
        if name not in known:
            listed = f"{called} takes {', '.join(known) or 'none'}"
            hint = suggestion(name, known, paths)
            raise ArgumentError(name, value, f"must be a known keyword: {listed}{hint}")


def _refuse_nameless(called: str, given: Sequence[object], function: FunctionType) -> None:
    """Refuse a positional argument that must be a keyword, and list the keywords.

    Without further keywords, Python's own error applies.
    """
    code = function.__code__
    most = code.co_argcount
    if len(given) <= most or code.co_flags & inspect.CO_VARARGS:
        return
    bound = code.co_varnames[:1] in (("self",), ("cls",))
    if known := (_keyword_names(function) or ())[most - bound :]:
        rule = f"must be given by keyword: {called} takes {', '.join(known)}"
        raise ArgumentError(f"argument {most + 1 - bound} of {called}", given[most], rule)


def takes_keywords(function: Callable[P, R]) -> Callable[P, R]:
    """Make a function refuse unknown keywords with the nearest known name."""
    known = _keyword_names(cast("FunctionType", function))
    if known is None:
        return function
    name, refuse, refuse_nameless = function.__qualname__, refuse_unknown, _refuse_nameless
    inner = cast("FunctionType", function)

    def call(*args: P.args, **keywords: P.kwargs) -> R:
        refuse(name, keywords, known)
        refuse_nameless(name, args, inner)
        return function(*args, **keywords)

    # Keep the function's globals, by which doctest finds the module of the examples.
    wrapper = FunctionType(call.__code__, function.__globals__, name, None, call.__closure__)
    return functools.update_wrapper(wrapper, function)


class TakesKeywords:
    """Base of classes that refuse unknown keywords in the same way."""

    __slots__ = ()

    def __new__(cls, *arguments: Any, **keywords: Any) -> Self:
        """Check the keywords; `__init__` takes them."""
        made_by = cast("FunctionType", cls.__init__)
        if keywords:
            refuse_unknown(cls.__name__, keywords, _keyword_names(made_by) or ())
        if arguments:
            _refuse_nameless(cls.__name__, (cls, *arguments), made_by)
        return object.__new__(cls)


def _keyword_names(function: FunctionType) -> tuple[str, ...] | None:
    """List the parameters that can be keywords; None if any keyword is accepted."""
    code = function.__code__
    named = code.co_argcount + code.co_kwonlyargcount
    names = code.co_varnames[code.co_posonlyargcount : named]
    names = tuple(name for name in names if name not in ("self", "cls"))
    if not code.co_flags & inspect.CO_VARKEYWORDS:
        return names
    rest = code.co_varnames[named + bool(code.co_flags & inspect.CO_VARARGS)]
    of_rest = str(function.__annotations__.get(rest)).removeprefix("Unpack[").removesuffix("]")
    more = getattr(function.__globals__.get(of_rest), "__annotations__", None)
    return None if more is None else (*names, *more)
