"""Models of a small tracked robot to try things on: one robot, as SDF, URDF and MJCF.

Nothing of it is of a real robot. It has wheels in the place of tracks, as people do it, so that an
audit has something to find.
"""

from __future__ import annotations

from pathlib import Path

from crawler2d.common.keywords import read_choice

__all__ = ["names", "path"]


def __dir__() -> list[str]:
    """List what is public, for completion."""
    return sorted(__all__)


_NAMES = ("rover.sdf", "rover.urdf", "rover.xml")


def names() -> tuple[str, ...]:
    """Return the names of all samples: the robot as SDF, URDF and MJCF.

    Examples
    --------
    >>> names()
    ('rover.sdf', 'rover.urdf', 'rover.xml')
    """
    return _NAMES


def path(name: str = "rover.sdf") -> Path:
    """Return where a sample is.

    Parameters
    ----------
    name : str
        One of `names`.

    Raises
    ------
    ScenarioError
        If there is none of that name; the message suggests the nearest.

    Examples
    --------
    >>> import crawler2d as c2d
    >>> c2d.read_robot(path("rover.urdf")).robot.description
    'rover: 5 round wheels in a line'
    """
    return Path(__file__).with_name(read_choice(name, "name", _NAMES))
