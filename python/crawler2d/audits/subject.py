"""What is audited: a robot, or a file with its friction on floors that may be."""

from __future__ import annotations

import os
import warnings
from collections.abc import Collection, Mapping
from typing import Literal, NamedTuple, TypedDict

from crawler2d.audits.population import FLOORS
from crawler2d.errors import ScenarioError, ScenarioWarning
from crawler2d.parameters.robot import Robot
from crawler2d.reading.friction import Engine
from crawler2d.reading.meshes import MeshRule
from crawler2d.reading.reading import Reading, read_robot

__all__ = ["HowToRead", "Subject", "subject_of"]


class HowToRead(TypedDict, total=False):
    """The keywords of `read_robot`, for the audit of a file."""

    engine: Engine | None
    forward: Literal["+x", "-x", "+y", "-y"] | None
    model: str | None
    mesh: MeshRule
    missing: Literal["refuse", "leave_out"]
    tracks: Collection[str]
    ground_friction: float | None
    tolerance: float
    trusted: bool
    packages: Mapping[str, str | os.PathLike[str]] | None
    arguments: Mapping[str, str] | None


class Subject(NamedTuple):
    """What is audited.

    Parameters
    ----------
    robot : Robot
        The robot.
    reading : Reading, optional
        What was read, if it is a file.
    floors : mapping of float to float, optional
        [-] The friction with the floor of each of `FLOORS`; None if that of the floor is given.
    """

    robot: Robot
    reading: Reading | None = None
    floors: Mapping[float, float] | None = None


def subject_of(robot: object, how: HowToRead) -> Subject:
    """Take a robot, or read a file; what reading doubts is left to the lint.

    Raises
    ------
    ScenarioError
        If it is neither, a keyword is unknown, or the file cannot be read.
    """
    if isinstance(robot, Robot):
        for name, value in how.items():
            raise ScenarioError(name, value, "must be left out: the robot is not read from a file")
        return Subject(robot)
    if not isinstance(robot, (str, os.PathLike)):
        raise ScenarioError("robot", robot, "must be a Robot or the name of a file")
    unknown = set(how) - set(HowToRead.__annotations__)
    if unknown:
        rule = f"must be one of {', '.join(HowToRead.__annotations__)}"
        raise ScenarioError("audit", min(unknown), rule)
    with warnings.catch_warnings():
        # What reading doubts is in the lint.
        warnings.simplefilter("ignore", ScenarioWarning)
        read = read_robot(robot, **how)
        if how.get("ground_friction") is not None:
            return Subject(read.robot, read)
        floors = {floor: _friction_on(robot, how, floor) for floor in FLOORS}
    return Subject(read.robot, read, floors)


def _friction_on(path: str | os.PathLike[str], how: HowToRead, floor: float) -> float:
    """[-] Return the friction with a floor of some coefficient, by the rule of the engine."""
    on_floor: HowToRead = {**how, "ground_friction": floor}
    return read_robot(path, **on_floor).friction
