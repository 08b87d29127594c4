"""Keywords that a function or a class does not take, with the nearest that it does."""

from __future__ import annotations

import functools
import inspect
from collections.abc import Callable, Iterable, Mapping, Sequence
from types import FunctionType
from typing import Any, ParamSpec, Self, TypeVar, cast

from crawler2d.errors import ArgumentError

__all__ = ["TakesKeywords", "beyond", "refuse_unknown", "suggestion", "takes_keywords"]

P = ParamSpec("P")
R = TypeVar("R")

_BEYOND_A_SIDE_VIEW = (
    *("roll", "yaw", "turn", "turning", "steer", "steering", "heading", "lateral"),
    *("soil", "sand", "mud", "sinkage", "cohesion", "suspension"),
    *("stl", "mesh", "heightmap", "pid", "kp", "ki", "kd", "controller"),
)
"""What users ask for that a side view does not have; README, "Limits", says so."""

_LIMITS = (
    " (crawler2d is a side view, in the sagittal plane; what it leaves out, such as roll, yaw,"
    " turning, soil, suspension, meshes of the ground and controllers, is in README, Limits)"
)
_MISSPELT, _ALIKE = 0.8, 0.6
"""Likeness by `difflib`: of a name with a letter missing, and of one that has half of another."""
_MOST = 3
"""Names that one hint has."""


def beyond(name: str) -> str:
    """Say where the limits stand, if a name asks for what a side view does not have; else empty."""
    parts = name.lower().split("_")
    return _LIMITS if any(part in _BEYOND_A_SIDE_VIEW for part in parts) else ""


def suggestion(name: str, names: Iterable[str], paths: Iterable[str] = ()) -> str:
    """Say which known name was probably meant; empty if none is near.

    Parameters
    ----------
    name : str
        What is not known.
    names, paths : iterable of str
        What is: in the same place, and elsewhere, by path.

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
        if not meant and beyond(name):
            return beyond(name)
    return f" (did you mean {' or '.join(meant[:_MOST])}?)" if meant else ""


def refuse_unknown(
    called: str, given: Mapping[str, object], taken: Sequence[str], paths: Iterable[str] = ()
) -> None:
    """Refuse keywords that are not among those taken.

    Parameters
    ----------
    called : str
        The function or class.
    given : mapping of str to object
        The keywords with their values.
    taken : sequence of str
        The keywords that it takes.
    paths : iterable of str
        What else may be meant.

    Raises
    ------
    ArgumentError
        About the first.
    """
    for name, value in given.items():
        if name not in taken:
            rule = f"must be a keyword that {called} takes: {', '.join(taken) or 'it takes none'}"
            raise ArgumentError(name, value, f"{rule}{suggestion(name, taken, paths)}")


def takes_keywords(function: Callable[P, R]) -> Callable[P, R]:
    """Let a function refuse unknown keywords with the nearest known name."""
    taken = _taken(cast("FunctionType", function))
    if taken is None:
        return function
    name, refuse = function.__qualname__, refuse_unknown

    def call(*args: P.args, **keywords: P.kwargs) -> R:
        refuse(name, keywords, taken)
        return function(*args, **keywords)

    # With the globals of the function: by them doctest tells whose examples these are.
    made = FunctionType(call.__code__, function.__globals__, name, None, call.__closure__)
    return functools.update_wrapper(made, function)


class TakesKeywords:
    """Base of classes that refuse unknown keywords in the same way."""

    __slots__ = ()

    def __new__(cls, *_: Any, **keywords: Any) -> Self:
        """Check the keywords; `__init__` takes them."""
        if keywords:
            refuse_unknown(cls.__name__, keywords, _taken(cast("FunctionType", cls.__init__)) or ())
        return object.__new__(cls)


def _taken(function: FunctionType) -> tuple[str, ...] | None:
    """Names of the parameters that can be given by keyword; None if it takes any."""
    code = function.__code__
    named = code.co_argcount + code.co_kwonlyargcount
    names = code.co_varnames[code.co_posonlyargcount : named]
    names = tuple(name for name in names if name != "self")
    if not code.co_flags & inspect.CO_VARKEYWORDS:
        return names
    rest = code.co_varnames[named + bool(code.co_flags & inspect.CO_VARARGS)]
    of_rest = str(function.__annotations__.get(rest)).removeprefix("Unpack[").removesuffix("]")
    more = getattr(function.__globals__.get(of_rest), "__annotations__", None)
    return None if more is None else (*names, *more)
