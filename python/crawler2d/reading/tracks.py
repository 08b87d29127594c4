"""Outline and track model: from pairs of wheels or drums to what a robot is made of."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from crawler2d.models.poses import Array
from crawler2d.parameters.track import HybridWheels, LineOfWheels
from crawler2d.reading.gear_wheels import wheel_on
from crawler2d.reading.sides import Pair, centers
from crawler2d.reading.telling import Telling
from crawler2d.reading.view import SideView

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

    @property
    def ahead(self) -> Array:
        """Direction of x in the side view, shape (2,)."""
        if self.is_level:
            return np.array([1.0, 0.0])
        along: Array = (self.front - self.rear) / self.length
        return along

    @property
    def tilt(self) -> float:
        """[rad] Angle of x above forward."""
        return math.atan2(self.ahead[1], self.ahead[0])

    def of(self, points: Array) -> Array:
        """[m] Return points of the side view, shape (n, 2), in the chassis frame."""
        ahead = self.ahead
        up = np.array([-ahead[1], ahead[0]])
        turned: Array = (np.asarray(points) - 0.5 * (self.front + self.rear)) @ np.stack(
            [ahead, up], 1
        )
        return turned


def wheels_of(
    told: Telling,
    pairs: list[Pair],
    base: Base,
    view: SideView,
    *,
    path: str = "robot.track",
    run: float = 0.0,
    is_whole: bool = True,
) -> LineOfWheels | HybridWheels:
    """Return the track model that has these wheels where they are.

    A line of wheels, if they stand evenly on the line between the end axles and their radii are
    equal or change evenly; else wheels that are placed one by one, as also where one at an end
    axle is missing, which makes the line no whole one.

    Parameters
    ----------
    told : Telling
        Takes what is to be told about gear wheels.
    pairs : list of Pair
        From the rear to the front.
    base : Base
        The frame of what carries them.
    view : SideView
        The side view.
    path : str
        Of the track in a scenario.
    run : float
        [m] How far the track has run before the start, because its flipper is raised.
    is_whole : bool
        Whether wheels are at both end axles.

    Raises
    ------
    ScenarioError
        If some are gear wheels, and not all are alike.
    """
    radii = np.array([pair.radius for pair in pairs])
    places = base.of(centers(pairs))
    is_line = False
    if is_whole:
        even = np.linspace(-0.5 * base.length, 0.5 * base.length, len(pairs))
        between = np.linspace(radii[0], radii[-1], len(pairs))
        off = np.abs([places[:, 0] - even, places[:, 1], radii - between]).max()
        is_line = bool(off <= FIT)
    angles = [base.tilt - run / pair.radius for pair in pairs]
    wheel, order = wheel_on(told, pairs, view, angles=angles, path=f"{path}.wheel", is_line=is_line)
    if is_line:
        return LineOfWheels(len(pairs), wheel=wheel)
    rows = [(*places[k].tolist(), float(radii[k])) for k in order]
    return HybridWheels(tuple(rows), wheel=wheel)
