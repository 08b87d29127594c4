"""Exceptions and warnings of the package; all keep their attributes when pickled.

Every exception is a `Crawler2dError`, except `BatchInterrupted`, which is defined with the runs
that it holds: ``except Exception`` must not swallow an interrupt.
"""

from __future__ import annotations

import contextlib
import re
import reprlib
import sys
import warnings
from collections.abc import Iterable, Iterator
from typing import Any

__all__ = [
    "ArgumentError",
    "Crawler2dError",
    "InternalError",
    "LimitError",
    "RunUnfinished",
    "ScenarioError",
    "ScenarioWarning",
    "SimulationDiverged",
    "StoreError",
    "ignore_warnings",
    "own_error",
    "raise_first",
    "warn",
]

# The core cuts values at the same length. Whole numbers with more bits exceed every float.
_LONGEST_TEXT = 80
_LARGEST_WHOLE = 1024


class _Short(reprlib.Repr):
    """Short representations; Python refuses to print whole numbers of thousands of digits."""

    def repr_int(self, x: int, level: int) -> str:
        if x.bit_length() <= _LARGEST_WHOLE:
            return super().repr_int(x, level)
        return f"a whole number of {x.bit_length()} bits"


def _short(value: object) -> object:
    """Keep small values; other objects may be huge, or fail to print or pickle."""
    if isinstance(value, str):
        return value if len(value) <= _LONGEST_TEXT else f"{value[:_LONGEST_TEXT]}..."
    if isinstance(value, (float, type(None))):
        return value
    if isinstance(value, int) and value.bit_length() <= _LARGEST_WHOLE:
        return value
    return _Short().repr(value)


# Up to a colon, a semicolon or a hint; brackets may hold any of these.
_WRONG = re.compile(
    r"(?:\{.*?\}|\[.*?\]|\((?!did you mean).*?\)|(?![:;] | \(did you mean).)*", re.DOTALL
)


class Crawler2dError(Exception):
    """Base of every error that crawler2d raises."""

    def __str__(self) -> str:
        """Return the message, without further arguments."""
        return str(self.args[0]) if self.args else ""


class ScenarioError(Crawler2dError, ValueError):
    """A field or an argument breaks a rule; nothing was simulated.

    Parameters
    ----------
    path : str
        Dotted path of the field, such as ``robot.track.count``.
    value : object
        Its value. Anything but a number, a string or None is kept as text; long texts and whole
        numbers too large for a float are shortened.
    rule : str
        The rule it breaks, "must be ...", and after a colon or semicolon what to write instead;
        the message has the value between the two.

    Examples
    --------
    >>> print(ScenarioError("robot.mass", -1.0, "must be > 0 kg"))
    robot.mass must be > 0 kg, got -1.0
    >>> print(ScenarioError("robot.drivetrain", "fast", "must be a Drivetrain: write Drivetrain()"))
    robot.drivetrain must be a Drivetrain, got fast: write Drivetrain()
    """

    path: str
    value: object
    rule: str

    def __init__(self, path: str, value: object, rule: str) -> None:
        kept = _short(value)
        super().__init__(path, kept, rule)
        self.path = path
        self.value = kept
        self.rule = rule

    def __str__(self) -> str:
        """Return rule, value and remedy in one line."""
        match = _WRONG.match(self.rule)
        end = match.end() if match else len(self.rule)
        return f"{self.path} {self.rule[:end]}, got {self.value}{self.rule[end:]}"


class ArgumentError(ScenarioError, TypeError):
    """A function or class was called with an unknown keyword, or without a required one.

    The rule lists the known keywords and suggests the nearest.

    Examples
    --------
    >>> import crawler2d as c2d
    >>> try:
    ...     c2d.LineOfWheels(4, radius=0.06)
    ... except ArgumentError as error:
    ...     print(error.path, error.rule[-28:])
    radius (did you mean wheel_radius?)
    """


class ScenarioWarning(UserWarning):
    """A scenario is legal but probably not intended; it is simulated as it is.

    Also issued if a run sank deeper into the ground than the softness of its contacts explains.

    Parameters
    ----------
    path : str
        Dotted path of the field, such as ``terrain.height``, or the metric ``max_penetration``.
    value : object
        Its value.
    reason : str
        Why it is unlikely to be intended: "is usually ...".

    Examples
    --------
    >>> print(ScenarioWarning("terrain.height", 75.0, "is usually at most 1.5 m"))
    terrain.height is usually at most 1.5 m, got 75.0
    """

    path: str
    value: object
    reason: str

    def __init__(self, path: str, value: object, reason: str) -> None:
        super().__init__(path, value, reason)
        self.path = path
        self.value = value
        self.reason = reason

    def __str__(self) -> str:
        """Return path, reason and value in one line."""
        return f"{self.path} {self.reason}, got {self.value}"


class SimulationDiverged(Crawler2dError, RuntimeError):
    """The state became non-finite, or faster than light; the run has no result.

    Parameters
    ----------
    message : str
        What went wrong.
    step : int, optional
        Step in which it happened, counted from 1.
    body : str, optional
        The body whose state became non-finite.
    """

    step: int | None
    body: str | None

    def __init__(self, message: str, step: int | None = None, body: str | None = None) -> None:
        super().__init__(message, step, body)
        self.step = step
        self.body = body


class RunUnfinished(Crawler2dError, RuntimeError):
    """The batch was interrupted before this run was finished; it has no result."""


class LimitError(Crawler2dError, ValueError):
    """A request exceeds what this machine or this program can handle.

    Parameters
    ----------
    message : str
        What is too large, and the limit and how to set it.
    needed : int, optional
        [bytes] Memory that the request needs, approximately.
    available : int, optional
        [bytes] Memory available to it.
    """

    needed: int | None
    available: int | None

    def __init__(
        self, message: str, needed: int | None = None, available: int | None = None
    ) -> None:
        super().__init__(message, needed, available)
        self.needed = needed
        self.available = available


class StoreError(Crawler2dError, OSError):
    """A store of runs cannot be read or written; the runs that it holds are kept.

    Parameters
    ----------
    message : str
        The file, what is wrong, and how to fix it.

    Attributes
    ----------
    runs : list of Run
        Runs that a sweep or study had simulated when its store failed: one per scenario of the last
        batch, in order; `table` arranges them. An unfinished run has a `RunUnfinished` as its
        `error`. Empty if nothing was simulated.
    """

    def __init__(self, message: str) -> None:
        super().__init__(message)
        self.runs: list[Any] = []


class InternalError(Crawler2dError, RuntimeError):
    """A bug in crawler2d or a failure of its process, not a fault of the scenario."""


def own_error(error: BaseException) -> Crawler2dError:
    """Return an error of the package; wrap others, such as a MemoryError."""
    if isinstance(error, Crawler2dError):
        return error
    return InternalError(f"{type(error).__name__}: {error}")


def raise_first(results: Iterable[object]) -> None:
    """Raise the first error of the package in a list of results."""
    for result in results:
        if isinstance(result, Crawler2dError):
            raise result


_PACKAGE = __name__.partition(".")[0]


def warn(path: str, value: object, reason: str) -> None:
    """Issue a `ScenarioWarning`; called by the core, too.

    Parameters
    ----------
    path, value, reason
        See `ScenarioWarning`.
    """
    frame, level = sys._getframe(1), 2
    while frame.f_back and frame.f_globals.get("__name__", "").partition(".")[0] == _PACKAGE:
        frame, level = frame.f_back, level + 1
    warnings.warn(ScenarioWarning(path, value, reason), stacklevel=level)


@contextlib.contextmanager
def ignore_warnings() -> Iterator[None]:
    """Suppress each `ScenarioWarning`: they are reported elsewhere, or would be out of place."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ScenarioWarning)
        yield
