"""Sample models of a small tracked robot: the same robot as SDF, URDF and MJCF.

It is not a real robot. As in many models, wheels replace its tracks, so an audit has something to
find.
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
    """Return the names of all samples.

    Examples
    --------
    >>> names()
    ('rover.sdf', 'rover.urdf', 'rover.xml')
    """
    return _NAMES


def path(name: str = "rover.sdf") -> Path:
    """Return the path of a sample.

    Parameters
    ----------
    name : str
        One of `names`.

    Raises
    ------
    ScenarioError
        If there is no such sample; the message suggests the nearest name.

    Examples
    --------
    >>> import crawler2d as c2d
    >>> c2d.read_robot(path("rover.urdf")).robot.description
    'rover: 5 round wheels in a line'
    """
    return Path(__file__).with_name(read_choice(name, "name", _NAMES))
