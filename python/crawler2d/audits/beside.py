"""The belt that an audit puts beside a model: the same robot with a closed track."""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

from crawler2d.parameters.robot import Robot
from crawler2d.parameters.track import (
    BeltTrack,
    ClosedTrack,
    GrouserBeltTrack,
    HybridWheels,
    LineOfWheels,
)

__all__ = ["Belt", "belt_of"]


class Belt(NamedTuple):
    """A robot on belts.

    Parameters
    ----------
    robot : Robot
        The same robot, on belts.
    reason : str
        Which belts, and why.
    """

    robot: Robot
    reason: str


def belt_of(robot: Robot) -> Belt:
    """Put belts in the place of a robot's tracks.

    They follow the outlines of chassis and flippers, `BeltTrack`, wherever these are the model's
    own. Where wheels are placed one by one, or stand for no track, no outline tells where a belt
    would run; then it is taut round the model's own wheels, `ClosedTrack`.

    Parameters
    ----------
    robot : Robot
        Any robot.

    Examples
    --------
    >>> import crawler2d as c2d
    >>> belt = belt_of(c2d.robots.engineer(track=c2d.LineOfWheels(4), flippers=None))
    >>> belt.robot.track, belt.reason
    (BeltTrack(), 'BeltTrack, along the outline')
    >>> belt_of(c2d.robots.marv(track="public")).reason
    'ClosedTrack, round the wheels that there are: no track runs between those of the chassis'
    """
    arms = robot.flippers
    tracks = [robot.track] if arms is None else [robot.track, arms.track or robot.track]
    if all(isinstance(each, BeltTrack | GrouserBeltTrack | ClosedTrack) for each in tracks):
        return Belt(robot, "the robot itself, which is on belts")
    if isinstance(robot.track, LineOfWheels) and not robot.track.as_track:
        why = "no track runs between those of the chassis"
    elif any(isinstance(each, HybridWheels) for each in tracks):
        why = "some are placed one by one, which no outline follows"
    else:
        belted = robot.with_track(BeltTrack())
        if arms is not None:
            belted = replace(belted, flippers=replace(arms, track=BeltTrack()))
            return Belt(belted, "BeltTrack, along the outlines of chassis and flippers")
        return Belt(belted, "BeltTrack, along the outline")
    closed = robot.track
    if isinstance(closed, ClosedTrack):
        return Belt(robot, "the robot itself, whose track is closed")
    return Belt(
        robot.with_track(ClosedTrack(closed)),
        f"ClosedTrack, round the wheels that there are: {why}",
    )
