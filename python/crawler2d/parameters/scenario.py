"""What is simulated: one robot, one terrain, one command, complete and frozen."""

from __future__ import annotations

import json
import warnings
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from crawler2d import _core
from crawler2d.errors import ScenarioError, ScenarioWarning
from crawler2d.parameters.form import Form
from crawler2d.parameters.paths import replace_path
from crawler2d.parameters.plain import from_plain
from crawler2d.parameters.robot import Robot
from crawler2d.parameters.terrain import Terrain

__all__ = ["Scenario"]


@dataclass(frozen=True, slots=True)
class Scenario(Form):
    """One run, complete: the same scenario and build give the same bits.

    Parameters
    ----------
    robot : Robot
        The robot and the model of its track.
    terrain : Terrain
        The ground; `crawler2d.terrains` makes them.
    drive : Drive
        The command.
    start : Start
        How the robot stands at time 0.
    goal : float, optional
        [m] The x that the robot must leave behind; None takes the terrain's.
    gravity : float
        [m/s^2] Downwards.
    duration : float
        [s] Longest simulated time.
    solver : Solver
        How the equations are solved.
    criteria : SeizureCriteria
        When a run ends, and when a stop counts as one.
    schema : int
        Version of the JSON format.

    Examples
    --------
    >>> import crawler2d as c2d
    >>> scenario = c2d.Scenario(c2d.robots.engineer(flippers=None), c2d.terrains.step(0.05))
    >>> scenario.replace({"terrain.height": 0.10}).terrain.height
    0.1
    """

    robot: Robot
    terrain: Terrain

    def replace(self, fields: Mapping[str, Any]) -> Scenario:
        """Make a variant.

        Parameters
        ----------
        fields : mapping of str to object
            New values by dotted path, such as ``{"robot.track.count": 5}``, set in order. Indices
            name elements: ``{"terrain.points[3][1]": 0.06}``.

        Returns
        -------
        Scenario
            A copy with these fields replaced.

        Raises
        ------
        ScenarioError
            If a path names no field; the message lists the fields and the nearest name. If an
            index is out of range; the message has the length.

        Warns
        -----
        ScenarioWarning
            If the flippers are taken off a robot and their mass stays on it.
        """
        variant = self
        for path, value in fields.items():
            variant = replace_path(variant, path, value)
        if _leaves_mass_of_arms(self.robot, variant.robot):
            reason = (
                "leaves their mass on the robot if it alone is replaced; to take that off, too,"
                ' replace or sweep the whole robot: {"robot": robot.without_flippers()}'
            )
            warnings.warn(ScenarioWarning("robot.flippers", None, reason), stacklevel=2)
        return variant

    @classmethod
    def from_json(cls, text: str) -> Scenario:
        """Read and validate a scenario.

        Parameters
        ----------
        text : str
            What `to_json` wrote, or any JSON object with the same keys, all of them present.

        Returns
        -------
        Scenario
            Equal to the one that was written.

        Raises
        ------
        ScenarioError
            If the text is no JSON, or a field is missing, unknown, of a wrong type or out of range.
        """
        if not isinstance(text, str):
            raise ScenarioError("scenario", text, "must be a text")
        try:
            text.encode()
        except UnicodeEncodeError:
            raise ScenarioError("scenario", ascii(text[:80]), "must be valid Unicode") from None
        return from_plain(cls, json.loads(_core.canonical(text)))

    def validate(self) -> None:
        """Check every rule, and warn of what is unlikely to be meant.

        Raises
        ------
        ScenarioError
            The first broken rule: path of the field, value and rule.

        Warns
        -----
        ScenarioWarning
            Of each field whose value is legal but doubtful, such as a step of 75 m.
        """
        _core.validate(self.to_json())

    @property
    def identity(self) -> str:
        """SHA-256 of the canonical JSON, in hexadecimal: equal for equal scenarios only.

        Raises
        ------
        ScenarioError
            If the scenario is not valid.
        """
        return _core.identity(self.to_json())


def _leaves_mass_of_arms(before: Robot, after: Robot) -> bool:
    """Whether arms went from a robot whose masses are still those of the whole."""
    if not (isinstance(before, Robot) and isinstance(after, Robot)):
        return False  # for the validator to refuse
    names = ("mass", "center_of_mass", "moment_of_inertia")
    masses = [[getattr(robot, name) for name in names] for robot in (before, after)]
    return before.flippers is not None and after.flippers is None and masses[0] == masses[1]
