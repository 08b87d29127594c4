"""The ground as parameters: x forward, y up, the first edge of the generated obstacles at x = 0."""

from __future__ import annotations

from dataclasses import KW_ONLY, dataclass
from typing import ClassVar

from crawler2d._json import Parameters

__all__ = ["Flat", "Lane", "Lanes", "Points", "Ramp", "Step", "Terrain"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Flat(Parameters):
    """Level ground.

    Parameters
    ----------
    length : float
        [m] Distance from x = 0 to the goal.
    friction : float
        [-] Coulomb friction between robot and ground.
    """

    kind: ClassVar[str] = "flat"
    place: ClassVar[str] = "terrain"

    length: float = 2.0
    friction: float = 0.9


@dataclass(frozen=True, slots=True)
class Step(Parameters):
    """One step up with a vertical face at x = 0 and a level top.

    Parameters
    ----------
    height : float
        [m] Height of the step, above 0.
    edge_radius : float
        [m] Radius of the edge; 0 is sharp.
    friction : float
        [-] Coulomb friction between robot and ground.
    """

    kind: ClassVar[str] = "step"
    place: ClassVar[str] = "terrain"

    height: float
    _: KW_ONLY
    edge_radius: float = 0.0
    friction: float = 0.9


@dataclass(frozen=True, slots=True)
class Ramp(Parameters):
    """A slope that begins at x = 0 and ends in a level top.

    Parameters
    ----------
    angle : float
        [rad] Angle of the slope, up > 0.
    length : float
        [m] Horizontal run of the slope.
    edge_radius : float
        [m] Radius of the convex edge; 0 is sharp.
    friction : float
        [-] Coulomb friction between robot and ground.
    """

    kind: ClassVar[str] = "ramp"
    place: ClassVar[str] = "terrain"

    angle: float
    _: KW_ONLY
    length: float = 1.0
    edge_radius: float = 0.0
    friction: float = 0.9


@dataclass(frozen=True, slots=True)
class Points(Parameters):
    """A profile of the user's own.

    Parameters
    ----------
    points : array_like, shape (n, 2)
        [m] Points (x, y) in order, from left to right or from right to left. Vertical faces are
        allowed, overhangs are not. Any real array is taken and copied.
    goal : float
        [m] The x that the robot must leave behind.
    edge_radius : float
        [m] Radius of every convex edge; 0 is sharp.
    friction : float
        [-] Coulomb friction between robot and ground.

    Raises
    ------
    ScenarioError
        If `points` holds no real numbers, is masked or has another shape.
    """

    kind: ClassVar[str] = "points"
    place: ClassVar[str] = "terrain"

    points: tuple[tuple[float, float], ...]
    _: KW_ONLY
    goal: float
    edge_radius: float = 0.0
    friction: float = 0.9


Lane = Flat | Step | Ramp | Points
"""Every terrain of one profile."""


@dataclass(frozen=True, slots=True)
class Lanes(Parameters):
    """A profile under each track and one under the belly.

    Parameters
    ----------
    left, right : Flat, Step, Ramp or Points
        What each track meets.
    middle : Flat, Step, Ramp or Points, optional
        What the belly meets; None is the upper envelope of the two.
    """

    kind: ClassVar[str] = "lanes"
    place: ClassVar[str] = "terrain"

    left: Lane
    right: Lane
    _: KW_ONLY
    middle: Lane | None = None


Terrain = Lane | Lanes
"""Every terrain."""
