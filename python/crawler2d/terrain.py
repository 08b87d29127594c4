"""The ground as parameters: x forward, y up, the first edge of the generated obstacles at x = 0."""

from __future__ import annotations

from dataclasses import KW_ONLY, dataclass
from typing import ClassVar

from crawler2d._json import Parameters

__all__ = [
    "Barrier",
    "Flat",
    "Gap",
    "HalfRound",
    "Lane",
    "Lanes",
    "Points",
    "Ramp",
    "Ridge",
    "Stairs",
    "Step",
    "Terrain",
]


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
class Barrier(Parameters):
    """A parallelepiped on level ground, its front face at x = 0.

    Parameters
    ----------
    height : float
        [m] Height, above 0.
    thickness : float
        [m] Extent along x.
    edge_radius : float
        [m] Radius of the convex edges; 0 is sharp.
    friction : float
        [-] Coulomb friction between robot and ground.
    """

    kind: ClassVar[str] = "barrier"
    place: ClassVar[str] = "terrain"

    height: float
    thickness: float
    _: KW_ONLY
    edge_radius: float = 0.0
    friction: float = 0.9


@dataclass(frozen=True, slots=True)
class Ridge(Parameters):
    """A triangular prism on level ground that begins at x = 0, its edge on top.

    Parameters
    ----------
    height : float
        [m] Height of the edge, above 0.
    edge_angle : float
        [rad] Angle between the two flanks: small is a blade, near pi a low bump.
    edge_radius : float
        [m] Radius of the convex edges; 0 is sharp.
    friction : float
        [-] Coulomb friction between robot and ground.
    """

    kind: ClassVar[str] = "ridge"
    place: ClassVar[str] = "terrain"

    height: float
    edge_angle: float
    _: KW_ONLY
    edge_radius: float = 0.0
    friction: float = 0.9


@dataclass(frozen=True, slots=True)
class Gap(Parameters):
    """A trench with vertical walls that begins at x = 0.

    Parameters
    ----------
    width : float
        [m] Extent along x.
    depth : float
        [m] Depth, above 0.
    edge_radius : float
        [m] Radius of the convex edges; 0 is sharp.
    friction : float
        [-] Coulomb friction between robot and ground.
    """

    kind: ClassVar[str] = "gap"
    place: ClassVar[str] = "terrain"

    width: float
    _: KW_ONLY
    depth: float = 0.5
    edge_radius: float = 0.0
    friction: float = 0.9


@dataclass(frozen=True, slots=True, kw_only=True)
class Stairs(Parameters):
    """Steps up, the first face at x = 0, then a level top.

    The default rise and run are those of a public arena's stairs.

    Parameters
    ----------
    count : int
        Number of steps.
    rise, run : float
        [m] Height of each step, and its extent along x.
    edge_radius : float
        [m] Radius of the convex edges; 0 is sharp.
    friction : float
        [-] Coulomb friction between robot and ground.
    """

    kind: ClassVar[str] = "stairs"
    place: ClassVar[str] = "terrain"

    count: int = 4
    rise: float = 0.20
    run: float = 0.233
    edge_radius: float = 0.0
    friction: float = 0.9


@dataclass(frozen=True, slots=True)
class HalfRound(Parameters):
    """Half a pipe lying on level ground, from x = 0.

    Parameters
    ----------
    radius : float
        [m] Radius, also its height.
    friction : float
        [-] Coulomb friction between robot and ground.
    """

    kind: ClassVar[str] = "half_round"
    place: ClassVar[str] = "terrain"

    radius: float
    _: KW_ONLY
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


Lane = Flat | Step | Ramp | Barrier | Ridge | Gap | Stairs | HalfRound | Points
"""Every terrain of one profile."""


@dataclass(frozen=True, slots=True)
class Lanes(Parameters):
    """A profile under each track and one under the belly.

    Parameters
    ----------
    left, right : Lane
        What each track meets.
    middle : Lane, optional
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
