"""What lint finds: one row for each rule that a model breaks."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["SEVERITIES", "Finding", "named"]

SEVERITIES = ("error", "warning", "note")
"""An error: another robot is simulated; a warning: hardly meant; a note: to be known."""

_MOST = 3  # names that are listed one by one


@dataclass(frozen=True, slots=True, kw_only=True)
class Finding:
    """One thing that lint found.

    Parameters
    ----------
    rule : str
        Name of the rule, as in ``docs/conventions.md``.
    severity : {"error", "warning", "note"}
        With an error another robot is simulated than is meant, a warning is hardly meant, a note is
        to be known.
    what : str
        What was found, with its figures.
    where : str
        File and lines; "" for a robot that was not read from a file.
    """

    rule: str
    severity: str
    what: str
    where: str = ""


def named(names: list[str]) -> str:
    """List names; of many, the first and how many more.

    Examples
    --------
    >>> named(["a", "b"]), named(["a", "b", "c", "d", "e"])
    ('a, b', 'a, b, c and 2 more')
    """
    more = len(names) - _MOST
    shown = ", ".join(names[:_MOST])
    return shown if more <= 0 else f"{shown} and {more} more"
