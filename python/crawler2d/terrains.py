"""Generators of terrains: the short way to write the ground of a scenario."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, cast

from crawler2d.terrain import Flat, Lanes, Points, Ramp, Step

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

__all__ = ["flat", "from_points", "lanes", "ramp", "step"]

flat = Flat
step = Step
ramp = Ramp
lanes = Lanes


def from_points(points: ArrayLike, *, goal: float, **fields: float) -> Points:
    """Make a terrain of any polyline.

    Parameters
    ----------
    points : array_like, shape (n, 2)
        [m] Points (x, y) from left to right or from right to left; copied.
    goal : float
        [m] The x that the robot must leave behind.
    **fields : float
        Further fields of `Points`: `edge_radius` [m], `friction` [-].

    Returns
    -------
    Points
        The terrain.

    Raises
    ------
    ScenarioError
        If `points` is no array of real numbers of that shape.

    Examples
    --------
    >>> from_points([[-2, 0], [0, 0], [0, 0.05], [3, 0.05]], goal=0.0).points[2]
    (0.0, 0.05)
    """
    return Points(cast("Any", points), goal=goal, **fields)
