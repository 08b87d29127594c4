"""Check and apply the choices of the user, for all presets."""

from __future__ import annotations

from dataclasses import replace

from crawler2d.errors import ScenarioError
from crawler2d.parameters.flippers import Flippers
from crawler2d.parameters.robot import Robot
from crawler2d.parameters.track import Track

__all__ = ["is_rough", "with_choices"]


def with_choices(
    robot: Robot,
    *,
    flippers: Flippers | str | None,
    built: Flippers,
    track: Track | str | None,
    public: tuple[Track | None, Track | None],
) -> Robot:
    """Set the track model of a robot without flippers, and mount the requested flippers.

    Parameters
    ----------
    robot : Robot
        Without flippers.
    flippers : Flippers, "built" or None
        What the user asked for.
    built : Flippers
        The robot's own.
    track : Track, "public" or None
        What the user asked for.
    public : tuple of (Track or None, Track or None)
        Models of the robot's and the flippers' tracks in the public simulation model; None takes
        the preset's.

    Returns
    -------
    Robot
        The preset.

    Raises
    ------
    ScenarioError
        If `flippers` or `track` is another string.
    """
    of_robot, of_flippers = None, None
    if isinstance(track, str):
        if track != "public":
            raise ScenarioError("track", track, 'must be a track model, "public" or None')
        of_robot, of_flippers = public
    else:
        of_robot = track
    if of_robot is not None:
        robot = robot.with_track(of_robot)
    if isinstance(flippers, str):
        if flippers != "built":
            raise ScenarioError("flippers", flippers, 'must be Flippers, "built" or None')
        flippers = built
    if flippers is None:
        return robot
    if of_flippers is not None:
        flippers = replace(flippers, track=of_flippers)
    return robot.with_flippers(flippers)


def is_rough(source: object) -> bool:
    """Return whether mass and torques are from the ROUGH data set, not the SubT model.

    Raises
    ------
    ScenarioError
        If it is neither "rough" nor "subt".
    """
    if not isinstance(source, str) or source not in ("rough", "subt"):
        raise ScenarioError("source", source, 'must be "subt" or "rough"')
    return source == "rough"
