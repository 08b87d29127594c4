"""What a format cannot hold is refused, by the field of the robot that asks for it."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any, NoReturn

from crawler2d.errors import ScenarioError
from crawler2d.writing.carriers import Carrier, track_of

__all__ = ["Format", "refuse_tapering", "refuse_unheld"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Format:
    """What a format can hold.

    Parameters
    ----------
    name : str
        Its name.
    moves_surfaces : bool
        Whether it can move the surface of a shape, as a belt needs.
    has_hulls : bool
        Whether it can hold the corners of a convex hull.
    has_rotors : bool
        Whether it can hold the rotor inertia of a motor at its joint, and the gain of a servo.
    reserved : str
        A pattern of names that it keeps for itself.
    """

    name: str
    moves_surfaces: bool
    has_hulls: bool
    has_rotors: bool
    reserved: str = ""


_REASONS = {
    "belt": "{} has no surface that moves",
    "grouser_belt": "{} has no grousers that travel along a belt",
    "segmental": "a chain is a loop of links, and {} has trees",
    "force": "{} has no motor that pushes the chassis",
}


def refuse_unheld(robot: dict[str, Any], carriers: Iterable[Carrier], form: Format) -> None:
    """Refuse a robot whose tracks or name a format cannot hold.

    Parameters
    ----------
    robot : dict
        As in a scenario in JSON.
    carriers : iterable of Carrier
        What runs on its chassis and flippers.
    form : Format
        The format.

    Raises
    ------
    ScenarioError
        If the track, or that of the flippers, is one of those that no model file holds, or a belt
        where surfaces do not move; or if the name cannot be written.
    """
    for carrier in carriers:
        if carrier.surface == "wheels" or (carrier.surface == "belt" and form.moves_surfaces):
            continue
        path, track = track_of(robot, carrier.end)
        held = "wheels or a smooth belt" if form.moves_surfaces else "wheels"
        reason = _REASONS[carrier.surface].format(form.name)
        raise ScenarioError(f"{path}.kind", track["kind"], f"must be {held}: {reason}")
    name = robot["name"]
    if not all(letter >= " " and letter not in "\x7f\ufffe\uffff" for letter in name):
        raise ScenarioError("robot.name", name, "must have letters only that XML can hold")
    if form.reserved and re.fullmatch(form.reserved, name):
        rule = f"must be no name that {form.name} reserves, with :: in it or between pairs of _"
        raise ScenarioError("robot.name", name, rule)


def refuse_tapering(robot: dict[str, Any], end: str, form: Format) -> NoReturn:
    """Refuse gear wheels whose grousers taper, of the chassis or of the flippers at an end.

    Raises
    ------
    ScenarioError
        Always.
    """
    path, track = track_of(robot, end)
    rule = f"must be as thick as the tip: {form.name} has boxes for grousers, and no hulls"
    thickness = track["wheel"]["base_thickness"]
    raise ScenarioError(f"{path}.wheel.base_thickness", thickness, rule)
