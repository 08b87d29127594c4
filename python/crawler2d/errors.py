"""What can go wrong, as exceptions.

Every exception of the package is a `Crawler2dError`, except `BatchInterrupted`, which holds runs
and lies with them: an interrupt must not be swallowed by ``except Exception``. A `ScenarioWarning`
stops nothing. All of them survive pickling with their attributes.
"""

from __future__ import annotations

import reprlib

__all__ = [
    "Crawler2dError",
    "InternalError",
    "LimitError",
    "RunUnfinished",
    "ScenarioError",
    "ScenarioWarning",
    "SimulationDiverged",
]


# As long as the core keeps a value, and in bits what every float is below.
_LONGEST_TEXT = 80
_LARGEST_WHOLE = 1024


class _Short(reprlib.Repr):
    """Texts of objects; Python writes no whole number of thousands of digits."""

    def repr_int(self, x: int, level: int) -> str:
        if x.bit_length() <= _LARGEST_WHOLE:
            return super().repr_int(x, level)
        return f"a whole number of {x.bit_length()} bits"


def _short(value: object) -> object:
    """Keep what is small; an arbitrary object may be huge, or refuse to be shown or pickled."""
    if isinstance(value, str):
        return value if len(value) <= _LONGEST_TEXT else f"{value[:_LONGEST_TEXT]}..."
    if isinstance(value, (float, type(None))):
        return value
    if isinstance(value, int) and value.bit_length() <= _LARGEST_WHOLE:
        return value
    return _Short().repr(value)


class Crawler2dError(Exception):
    """Base of every error that crawler2d raises."""


class ScenarioError(Crawler2dError, ValueError):
    """A field or an argument breaks a rule; nothing has been simulated.

    Parameters
    ----------
    path : str
        Dotted path of the field, such as ``robot.track.count``.
    value : object
        The value found there. Anything but a number, a text or None is kept as its text; long texts
        are shortened, and so are whole numbers beyond every float.
    rule : str
        The rule it breaks, starting with a verb: "must be ...".

    Examples
    --------
    >>> print(ScenarioError("robot.mass", -1.0, "must be > 0 kg"))
    robot.mass must be > 0 kg, got -1.0
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
        """Name the field, the rule and the value."""
        return f"{self.path} {self.rule}, got {self.value}"


class ScenarioWarning(UserWarning):
    """A scenario is legal but unlikely to be what was meant; it is simulated as it is.

    Parameters
    ----------
    path : str
        Dotted path of the field, such as ``terrain.height``.
    value : object
        The value found there.
    reason : str
        What makes it doubtful, starting with a verb: "is usually ...".

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
        """Name the field, the reason and the value."""
        return f"{self.path} {self.reason}, got {self.value}"


class SimulationDiverged(Crawler2dError, RuntimeError):
    """The state became non-finite; the run has no result.

    Parameters
    ----------
    message : str
        What happened.
    step : int, optional
        Number of the step in which it happened, from 1.
    body : str, optional
        The body whose state it was.
    """

    step: int | None
    body: str | None

    def __init__(self, message: str, step: int | None = None, body: str | None = None) -> None:
        super().__init__(message, step, body)
        self.step = step
        self.body = body

    def __str__(self) -> str:
        """Say what happened."""
        return str(self.args[0])


class RunUnfinished(Crawler2dError, RuntimeError):
    """The batch was interrupted before this run had ended; it has no result."""


class LimitError(Crawler2dError, ValueError):
    """A request is larger than this machine or this program can serve.

    Parameters
    ----------
    message : str
        What is too large, its limit and how that is set.
    needed : int, optional
        [bytes] Memory that the request needs, about.
    left : int, optional
        [bytes] Memory that it may have.
    """

    needed: int | None
    left: int | None

    def __init__(self, message: str, needed: int | None = None, left: int | None = None) -> None:
        super().__init__(message, needed, left)
        self.needed = needed
        self.left = left

    def __str__(self) -> str:
        """Say what is too large."""
        return str(self.args[0])


class InternalError(Crawler2dError, RuntimeError):
    """A fault of crawler2d itself, or of the process that it runs in, not of the scenario."""
