"""What lint finds: one row for each rule that a model breaks."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["RULES", "SEVERITIES", "Finding"]

SEVERITIES = ("error", "warning", "note")
"""An error: another robot is simulated; a warning: hardly meant; a note: to be known."""

RULES = {
    "size": "The robot is as long as tracked robots are.",
    "mass": "The robot is neither as light as a balloon nor as heavy as steel.",
    "inertia": "Bodies have moments of inertia that a body of their size can have.",
    "placeholder": "Three equal moments of inertia belong to balls and cubes.",
    "no track": "A round shape stands wherever a track should be.",
    "effort": "Motors have a limit of effort, and the tracks push with no more than floors take.",
    "not driven": "Every wheel has a motor.",
    "friction": "Wheels and tracks have a friction that surfaces have.",
    "balance": "The centre of mass of a wheel is on its axle.",
    "sides": "Left and right are alike.",
    "overlap": "Wheels of one side do not push each other apart.",
    "doubt": "Nothing is doubted by the reader or by the simulator.",
}
"""Every rule, as what a model that keeps it is like; ``docs/conventions.md`` says when it fires."""


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
