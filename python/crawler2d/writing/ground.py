"""The ground of a side view in three dimensions: a plane, and convex pieces on it."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from crawler2d.common.bodies import Lane
from crawler2d.models.poses import Array
from crawler2d.writing.across import Across

__all__ = ["Ground", "Piece", "ground_of"]

# Two bodies side by side: room to drift without falling off the obstacle.
_WIDTH = 2.0  # gauges and track widths
_FLAT = 1e-9  # [m] Heights that differ by less are equal.


@dataclass(frozen=True, slots=True, kw_only=True)
class Piece:
    """A convex prism across the robot.

    Parameters
    ----------
    corners : ndarray, shape (n, 2)
        [m] Its outline in side view, counter-clockwise, x forward and y up.
    across, width : float
        [m] Place of its middle, to the left, and its width.
    friction : float
        [-] Of its surface.
    """

    corners: Array
    across: float
    width: float
    friction: float

    @property
    def is_box(self) -> bool:
        """Whether it is a rectangle with level and upright sides."""
        sides = np.abs(np.diff(self.corners, axis=0, append=self.corners[:1]))
        return len(self.corners) == 4 and bool((sides.min(axis=1) < _FLAT).all())


@dataclass(frozen=True, slots=True, kw_only=True)
class Ground:
    """What the robot drives over.

    Parameters
    ----------
    level : float
        [m] Height of a plane: that of the lowest ground.
    friction : float
        [-] Of the plane.
    pieces : tuple of Piece
        What stands on it.
    """

    level: float
    friction: float
    pieces: tuple[Piece, ...]


def ground_of(
    lanes: list[tuple[int, Array]],
    frictions: dict[int, float],
    across: Across,
    ends: tuple[float, float],
) -> Ground:
    """Extrude the profiles of a side view across the robot.

    Parameters
    ----------
    lanes : list of tuple of int and ndarray
        Each lane with its profile [m], as the core has them.
    frictions : dict of int to float
        [-] Of each lane.
    across : Across
        Widths and lateral places of the robot.
    ends : tuple of float, shape (2,)
        [m] From where to where the ground is wanted; the plane goes on.
    """
    profiles = [(lane, _between(points, *ends)) for lane, points in lanes]
    level = min(float(points[:, 1].min()) for _, points in profiles)
    half = 0.5 * _WIDTH * (across.gauge + across.track_width)
    inner = 0.5 * (across.gauge - across.track_width)
    strips = {
        Lane.BOTH: (-half, half),
        Lane.LEFT: (inner, half),
        Lane.RIGHT: (-half, -inner),
        Lane.MIDDLE: (-inner, inner),
    }
    pieces = [
        Piece(
            corners=corners,
            across=0.5 * sum(strips[Lane(lane)]),
            width=float(np.ptp(strips[Lane(lane)])),
            friction=frictions[lane],
        )
        for lane, points in profiles
        for corners in _convex(points, level)
    ]
    return Ground(level=level, friction=max(frictions.values()), pieces=tuple(pieces))


def _between(points: Array, left: float, right: float) -> Array:
    """Cut a profile at two places, at which the ground is level or slopes."""
    inner = points[(points[:, 0] > left) & (points[:, 0] < right)]
    first, last = ([x, float(np.interp(x, *points.T))] for x in (left, right))
    return np.array([first, *inner, last])


def _convex(points: Array, level: float) -> Iterator[Array]:
    """Cut what is below a profile and above a level into convex polygons.

    A cut goes straight down from each inner corner of the ground, where no track can touch it.
    """
    ahead = np.diff(points, axis=0)
    turns = ahead[:-1, 0] * ahead[1:, 1] - ahead[:-1, 1] * ahead[1:, 0]
    inner = [0, *(np.flatnonzero(turns > 0.0) + 1).tolist(), len(points) - 1]
    for first, last in itertools.pairwise(inner):
        run = points[first : last + 1]
        if np.ptp(run[:, 0]) < _FLAT or run[:, 1].max() < level + _FLAT:
            continue
        # A run that begins or ends on the level, or at a wall, has its foot in line already.
        foot = np.array([[run[0, 0], level], [run[-1, 0], level]])
        yield _corners(np.array([foot[0], foot[1], *run[::-1]]))


def _corners(points: Array) -> Array:
    """Return the corners of a convex polygon: no point twice, and none on a side."""
    there = np.abs(points - np.roll(points, 1, axis=0)).max(axis=1) > _FLAT
    points = points[there]
    to, on = points - np.roll(points, 1, axis=0), np.roll(points, -1, axis=0) - points
    turns = to[:, 0] * on[:, 1] - to[:, 1] * on[:, 0]
    corners: Array = points[turns > _FLAT * np.linalg.norm(to, axis=1) * np.linalg.norm(on, axis=1)]
    return corners
