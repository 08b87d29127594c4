"""Outline and track model: from pairs of wheels or drums to what a robot is made of."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from crawler2d.models.poses import Array
from crawler2d.parameters.track import HybridWheels, LineOfWheels
from crawler2d.reading.sides import Pair

__all__ = ["FIT", "Base", "wheels_of"]

FIT = 1e-5
"""[m] Wheels this near to an even line lie on it: files round to six decimals."""


@dataclass(frozen=True, slots=True, eq=False)
class Base:
    """The chassis frame in the side view: midway between the end axles.

    Parameters
    ----------
    rear, front : ndarray, shape (2,)
        [m] The end axles in the side view.
    is_level : bool
        Whether x is forward as in the model, instead of through both end axles.
    """

    rear: Array
    front: Array
    is_level: bool = False

    @property
    def length(self) -> float:
        """[m] Distance of the end axles along x."""
        if self.is_level:
            return float(self.front[0] - self.rear[0])
        return math.hypot(*(self.front - self.rear))

    def of(self, points: Array) -> Array:
        """[m] Return points of the side view, shape (n, 2), in the chassis frame."""
        ahead = (self.front - self.rear) / self.length
        if self.is_level:
            ahead = np.array([1.0, 0.0])
        up = np.array([-ahead[1], ahead[0]])
        turned: Array = (np.asarray(points) - 0.5 * (self.front + self.rear)) @ np.stack(
            [ahead, up], 1
        )
        return turned


def wheels_of(
    pairs: list[Pair], base: Base, *, is_whole: bool = True
) -> LineOfWheels | HybridWheels:
    """Return the track model that has these wheels where they are.

    A line of wheels, if they stand evenly on the line between the end axles and their radii are
    equal or change evenly; else wheels that are placed one by one, as also where one at an end
    axle is missing, which makes the line no whole one.
    """
    radii = np.array([pair.radius for pair in pairs])
    places = base.of(np.array([[pair.x, pair.y] for pair in pairs]))
    if is_whole:
        even = np.linspace(-0.5 * base.length, 0.5 * base.length, len(pairs))
        between = np.linspace(radii[0], radii[-1], len(pairs))
        off = np.abs([places[:, 0] - even, places[:, 1], radii - between]).max()
        if off <= FIT:
            return LineOfWheels(len(pairs))
    rows = zip(*places.T.tolist(), radii.tolist(), strict=True)
    return HybridWheels(tuple((x, y, radius) for x, y, radius in rows))
