"""What is audited: a robot, or a model file with its friction on floors that may be."""

from __future__ import annotations

import os
import warnings
from collections.abc import Collection, Mapping
from typing import Literal, NamedTuple, TypedDict

from crawler2d.audits.lint_robot import of_robot
from crawler2d.audits.population import FLOORS
from crawler2d.errors import ScenarioError, ScenarioWarning
from crawler2d.parameters.robot import Robot
from crawler2d.reading.friction import Engine
from crawler2d.reading.meshes import MeshRule
from crawler2d.reading.reading import Reading, read_robot

__all__ = ["HowToRead", "Subject", "check_size", "subject_of"]


class HowToRead(TypedDict, total=False):
    """The keywords of `read_robot`, for the audit of a file."""

    engine: Engine | None
    forward: Literal["+x", "-x", "+y", "-y"] | None
    model: str | None
    mesh: MeshRule
    missing: Literal["leave_out", "refuse"]
    tracks: Collection[str]
    ground_friction: float | None
    tolerance: float
    scale: float | None
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
        What was read, if it is of a file.
    floors : mapping of float to float, optional
        [-] The friction with the floor of each of `FLOORS`; None if that of the floor is given.
    """

    robot: Robot
    reading: Reading | None = None
    floors: Mapping[float, float] | None = None


def subject_of(robot: object, how: HowToRead) -> Subject:
    """Take a robot or what was read, or read a file; what reading doubts is left to the lint.

    Raises
    ------
    ScenarioError
        If it is none of them, a keyword is given with no file, or the file cannot be read.
    """
    if isinstance(robot, (Robot, Reading)):
        for name, value in how.items():
            raise ScenarioError(name, value, "must be left out: no file is read")
    if isinstance(robot, Robot):
        return Subject(robot)
    read = robot if isinstance(robot, Reading) else _read(robot, how)
    if read.how.ground_friction is not None:
        return Subject(read.robot, read)
    return Subject(read.robot, read, {floor: read.friction_on(floor) for floor in FLOORS})


def _read(path: object, how: HowToRead) -> Reading:
    if not isinstance(path, (str, os.PathLike)):
        rule = "must be a Robot, a Reading, or the name of a file"
        raise ScenarioError("robot", path, rule)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ScenarioWarning)
        return read_robot(path, **how)


def check_size(read: Reading) -> None:
    """Refuse what would be the audit of another robot, unless somebody said that it is meant.

    Raises
    ------
    ScenarioError
        If it has a size that no tracked robot has, and was read without a `scale`.
    """
    found = next((each for each in of_robot(read.robot) if each.rule == "size"), None)
    if found is None or "scale" in read.how.given:
        return
    where = read.sources["robot.outline.axle_distance"]
    rule = (
        f"must be given: {read.tree.file} is {found.what} [{where}], and scale=1 leaves it as it is"
    )
    raise ScenarioError("scale", None, rule)
