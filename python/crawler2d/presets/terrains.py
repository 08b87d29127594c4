"""Functions that make terrains: the short way to write the ground of a scenario."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any, cast

from crawler2d.common.arrays import real_number
from crawler2d.common.keywords import limits_hint
from crawler2d.parameters.terrain import (
    Barrier,
    DiagonalBarrier,
    Flat,
    Gap,
    HalfRound,
    Lanes,
    Points,
    Ramp,
    RandomStepfield,
    Ridge,
    Stairs,
    Step,
)

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

__all__ = [
    "barrier",
    "diagonal_barrier",
    "flat",
    "from_points",
    "gap",
    "half_round",
    "knife_edge",
    "lanes",
    "ramp",
    "random_stepfield",
    "ridge",
    "stairs",
    "step",
    "stepfield_with_barrier",
]

flat = Flat
step = Step
ramp = Ramp
barrier = Barrier
ridge = Ridge
gap = Gap
stairs = Stairs
half_round = HalfRound
lanes = Lanes
diagonal_barrier = DiagonalBarrier
random_stepfield = RandomStepfield


if not TYPE_CHECKING:  # which would let any name pass

    def __getattr__(name: str) -> object:
        """Say what a side view does not have."""
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}{limits_hint(name)}")


def knife_edge(height: float, *, thickness: float = 0.01, **fields: float) -> Barrier:
    """Make a barrier thin enough to fit between wheels.

    Parameters
    ----------
    height : float
        [m] Height, above 0.
    thickness : float
        [m] Thickness along x.
    **fields : float
        Further fields of `Barrier`, such as `edge_radius` [m] and `friction` [-].

    Returns
    -------
    Barrier
        The terrain.

    Examples
    --------
    >>> knife_edge(0.05).thickness
    0.01
    """
    return Barrier(height, thickness, **fields)


def stepfield_with_barrier(
    seed: int = 0,
    *,
    height: float | None = None,
    thickness: float = 0.1,
    yaw: float = 0.0,
    **fields: Any,
) -> RandomStepfield:
    """Make a random step field with a barrier across its middle.

    Parameters
    ----------
    seed : int
        Seed of the heights of the posts.
    height : float, optional
        [m] Height of the barrier. None takes one and a half times the largest possible height of a
        post, 0.15 m in the default field.
    thickness : float
        [m] Of the barrier.
    yaw : float
        [rad] Turn of the barrier about the vertical, as for `DiagonalBarrier`.
    **fields
        Further fields of `RandomStepfield`.

    Returns
    -------
    RandomStepfield
        The terrain.

    Raises
    ------
    ScenarioError
        If the barrier's height would follow from fields that are not numbers.

    Notes
    -----
    "Gear Wheels based Simulation of Crawlers for Mobile Robot Servosila Engineer" drives over such
    fields (Table 2) without giving their dimensions. Its Figures 18 and 19 have barriers of 0.10
    and 0.20 m; 0.15 m is the middle, and the highest obstacle of its line of wheels (Table 3). The
    thickness is an estimate: that of a post.

    Examples
    --------
    >>> stepfield_with_barrier(7, yaw=0.5).barrier_height
    0.15
    """
    field = RandomStepfield(seed, barrier_thickness=thickness, barrier_yaw=yaw, **fields)
    if height is None:
        rise = real_number(field.rise, "terrain.rise")
        highest = rise * real_number(field.levels, "terrain.levels")
        height = round(1.5 * highest, 9)  # to the nanometre, so that 0.15 stays 0.15
    return replace(field, barrier_height=height)


def from_points(points: ArrayLike, *, goal: float, **fields: float) -> Points:
    """Make a terrain of any polyline.

    Parameters
    ----------
    points : array_like, shape (n, 2)
        [m] Points (x, y) from left to right or from right to left; copied.
    goal : float
        [m] The x that the whole robot must pass.
    **fields : float
        Further fields of `Points`, such as `edge_radius` [m] and `friction` [-].

    Returns
    -------
    Points
        The terrain.

    Raises
    ------
    ScenarioError
        If `points` is not an array of real numbers of that shape.

    Examples
    --------
    >>> from_points([[-2, 0], [0, 0], [0, 0.05], [3, 0.05]], goal=0.0).points[2]
    (0.0, 0.05)
    """
    return Points(cast("Any", points), goal=goal, **fields)
