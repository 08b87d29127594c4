"""The form of a scenario: its fields, their defaults and its JSON, for any robot and ground."""

from __future__ import annotations

import json
from dataclasses import KW_ONLY, dataclass

from crawler2d.common.keywords import takes_keywords
from crawler2d.parameters.plain import Parameters, to_plain
from crawler2d.parameters.settings import Drive, SeizureCriteria, Solver, Start

__all__ = ["Form"]


@dataclass(frozen=True, slots=True)
class Form(Parameters):
    """The base of `Scenario`, for modules that `Scenario` imports, such as `robot`.

    Parameters
    ----------
    robot, terrain, drive, start, goal, gravity, duration, solver, criteria, schema
        See `Scenario`.
    """

    robot: Parameters
    terrain: Parameters
    _: KW_ONLY
    drive: Drive = Drive()
    start: Start = Start()
    goal: float | None = None
    gravity: float = 9.81
    duration: float = 15.0
    solver: Solver = Solver()
    criteria: SeizureCriteria = SeizureCriteria()
    schema: int = 2

    @takes_keywords
    def to_json(self, *, indent: int | None = None) -> str:
        """Write the scenario as JSON, every field present, no bit lost.

        Parameters
        ----------
        indent : int, optional
            Spaces per level; None writes one line.

        Returns
        -------
        str
            The text. It is not validated: see `validate`.
        """
        separators = (",", ":") if indent is None else (",", ": ")
        return json.dumps(to_plain(self), allow_nan=False, indent=indent, separators=separators)
