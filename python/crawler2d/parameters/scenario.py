"""A scenario: one robot, one terrain and one command, complete and frozen."""

from __future__ import annotations

import json
import textwrap
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from crawler2d import _core
from crawler2d.common.keywords import takes_keywords
from crawler2d.errors import ScenarioError, warn
from crawler2d.parameters.fields import fields_of, from_dict, replace_path, robot_inside
from crawler2d.parameters.robot import Robot
from crawler2d.parameters.settings import ScenarioBase
from crawler2d.parameters.terrain import Terrain

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["Scenario", "check_scenario"]

_LONGEST = 120
"""Characters of a terrain in a notebook, or of keys in an error, at most."""

_MOST_KEYS = 5
"""Keys of JSON that is not a scenario, in an error, at most."""


@dataclass(frozen=True, slots=True)
class Scenario(ScenarioBase):
    """Everything that defines a run: the same scenario and build give the same bits.

    Parameters
    ----------
    robot : Robot
        The robot and the model of its track.
    terrain : Terrain
        The ground; see `crawler2d.terrains`.
    drive : Drive
        The command.
    start : Start
        Position and angle of the robot at time 0.
    goal : float, optional
        [m] The x that the whole robot must pass; None takes the terrain's.
    gravity : float
        [m/s^2] Acceleration of gravity, downwards.
    duration : float
        [s] Longest simulated time.
    solver : Solver
        How the equations are solved.
    criteria : SeizureCriteria
        When a run ends, and what counts as a stop.
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

    @takes_keywords
    def replace(self, fields: Mapping[str, Any]) -> Scenario:
        """Make a variant.

        Parameters
        ----------
        fields : mapping of str to object
            New values by dotted path, such as ``{"robot.track.count": 5}``, set in order. Elements
            have an index: ``{"terrain.points[3][1]": 0.06}``. Setting one of two fields that
            exclude each other clears the other; ``"terrain.friction"`` replaces the friction of all
            segments. ``"robot.track"`` sets `torque_sharing` as `Robot.with_track` does.

        Returns
        -------
        Scenario
            A copy with these fields replaced.

        Raises
        ------
        ScenarioError
            If `fields` is not a mapping; if a path is not a field (the message lists the fields and
            the nearest name); if an index is out of range (the message gives the length).

        Warns
        -----
        ScenarioWarning
            If the flippers are removed but their mass stays on the robot.
        """
        if not isinstance(fields, Mapping):
            rule = 'must be a mapping from paths to values, such as {"terrain.height": 0.06}'
            raise ScenarioError("fields", fields, rule)
        variant = self
        given = {path for path, value in fields.items() if value is not None}
        for path, value in fields.items():
            variant = replace_path(variant, path, value, given=given)
        if "robot.track" in given and "robot.drivetrain.torque_sharing" not in given:
            robot = variant.robot.with_track(variant.robot.track)
            variant = replace_path(variant, "robot", robot)
        if _leaves_mass_of_arms(self.robot, variant.robot):
            reason = (
                "leaves their mass on the robot if replaced alone; to remove the mass, too, replace"
                ' or sweep the whole robot: {"robot": robot.without_flippers()}'
            )
            warn("robot.flippers", None, reason)
        return variant

    @classmethod
    def from_json(cls, text: str) -> Scenario:
        """Read and validate a scenario.

        Parameters
        ----------
        text : str
            Output of `to_json`, or any JSON object with the same keys.

        Returns
        -------
        Scenario
            Equal to the one that was written.

        Raises
        ------
        ScenarioError
            If the text is not JSON, or a field is missing, unknown, out of range or of the wrong
            type.
        """
        if not isinstance(text, str):
            raise ScenarioError("scenario", text, "must be a string")
        try:
            text.encode()
        except UnicodeEncodeError:
            raise ScenarioError("scenario", ascii(text[:80]), "must be valid Unicode") from None
        try:
            whole = _core.canonical(text)
        except ScenarioError as error:
            if error.path == "schema":
                _refuse_another_file(text, error)
            raise
        return from_dict(cls, json.loads(whole))

    def validate(self) -> None:
        """Check every rule, and warn of values that are probably mistakes.

        Raises
        ------
        ScenarioError
            For the first broken rule: path of the field, value and rule.

        Warns
        -----
        ScenarioWarning
            For each field whose value is legal but unlikely to be intended, such as a step of 75 m.
        """
        _core.validate(self.to_json())

    @property
    def identity(self) -> str:
        """SHA-256 of the canonical JSON, in hexadecimal: equal for equal scenarios only.

        Raises
        ------
        ScenarioError
            If the scenario breaks a rule.
        """
        return _core.identity(self.to_json())

    @takes_keywords
    def plot(self, ax: Axes | None = None) -> Axes:
        """Draw the ground with the robot at its start, the goal and the height of the obstacle.

        Parameters
        ----------
        ax : Axes, optional
            Where to draw; None makes a figure.

        Returns
        -------
        Axes
            With x and y in metres, at equal scale.

        Raises
        ------
        ScenarioError
            If the scenario breaks a rule.
        ImportError
            If matplotlib is missing; the message names the extra to install.

        Examples
        --------
        >>> import crawler2d as c2d
        >>> ax = c2d.Scenario(c2d.robots.engineer(), c2d.terrains.step(0.1)).plot()
        >>> ax.get_title(loc="left")
        'engineer: smooth belt; ground: step'
        """
        from crawler2d.drawings.views import draw_scenario  # noqa: PLC0415 - optional

        return draw_scenario(self.to_json(), self._description(), ax)

    def _description(self) -> str:
        return f"{self.robot.description}; ground: {self.terrain.kind.replace('_', ' ')}"

    def _repr_html_(self) -> str | None:
        """Show start and ground in a notebook; a broken scenario is shown as text."""
        from crawler2d.drawings.svg import scenario_card  # noqa: PLC0415 - costs nothing until used

        try:
            terrain = textwrap.shorten(repr(self.terrain), _LONGEST)
            return scenario_card(self.to_json(), self._description(), terrain)
        except Exception:  # the display of a scenario must never fail
            return None


def _refuse_another_file(text: str, error: ScenarioError) -> None:
    """Refuse JSON without any field of a scenario, and a scenario of a newer version.

    Raises
    ------
    ScenarioError
        If no key is a field of a scenario, or the version of the format is greater than this one.
    """
    version = str(error.value)
    if version.isdecimal() and int(version) > int(_core.build_info()["schema"]):
        rule = f"{error.rule}; a newer version of crawler2d wrote the file"
        raise ScenarioError("schema", error.value, rule)
    keys = list(json.loads(text, parse_int=float))  # int refuses more than 4300 digits
    if not {"schema", *(field.name for field in fields_of(Scenario))}.intersection(keys):
        shown = ", ".join(keys[:_MOST_KEYS]) + (", ..." if len(keys) > _MOST_KEYS else "")
        rule = "must be what Scenario.to_json writes, with the keys schema, robot, terrain and more"
        value = f"JSON of something else, with the keys {shown[:_LONGEST]}" if keys else "{}"
        raise ScenarioError("scenario", value, rule)


def check_scenario(scenario: object) -> Scenario:
    """Refuse an argument `scenario` that is not a Scenario."""
    if not isinstance(scenario, Scenario):
        inside = robot_inside(scenario, (Robot,))
        remedy = f": write Scenario({inside}, terrain)" if inside else ""
        raise ScenarioError("scenario", scenario, f"must be a Scenario{remedy}")
    return scenario


def _leaves_mass_of_arms(before: Robot, after: Robot) -> bool:
    """Whether arms were removed while mass, centre of mass and inertia stayed the same."""
    names = ("mass", "center_of_mass", "moment_of_inertia")
    masses = [[getattr(robot, name) for name in names] for robot in (before, after)]
    return before.flippers is not None and after.flippers is None and masses[0] == masses[1]
