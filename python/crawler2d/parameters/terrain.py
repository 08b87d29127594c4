"""The ground as parameters: x forward, y up, the first edge of the generated obstacles at x = 0."""

from __future__ import annotations

from dataclasses import KW_ONLY, dataclass
from typing import ClassVar, Literal

from crawler2d.parameters.plain import Parameters

__all__ = [
    "Barrier",
    "DiagonalBarrier",
    "Flat",
    "Gap",
    "HalfRound",
    "Lane",
    "Lanes",
    "Points",
    "Ramp",
    "RandomStepfield",
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
class DiagonalBarrier(Parameters):
    """A parallelepiped on level ground whose front face is turned about the vertical.

    The tracks meet it `gauge` tan(`yaw`) apart, and `thickness` / cos(`yaw`) long; the gauge is the
    robot's. Roll and yaw of the robot are held: what a side view can say of such a barrier. The
    belly is taken to be as wide as the gauge.

    Parameters
    ----------
    yaw : float
        [rad] Turn of the barrier, counter-clockwise seen from above: above 0 the left track meets
        it first, at x = 0. At most 80 degrees either way.
    height : float
        [m] Height, above 0.
    thickness : float
        [m] Extent across its front face.
    edge_radius : float
        [m] Radius of the convex edges; 0 is sharp.
    friction : float
        [-] Coulomb friction between robot and ground.
    """

    kind: ClassVar[str] = "diagonal_barrier"
    place: ClassVar[str] = "terrain"

    yaw: float
    _: KW_ONLY
    height: float = 0.05
    thickness: float = 0.1
    edge_radius: float = 0.0
    friction: float = 0.9


@dataclass(frozen=True, slots=True)
class RandomStepfield(Parameters):
    """Square posts of random heights from x = 0, a row under each track (Jacoff et al., 2008).

    Parameters
    ----------
    seed : int
        Of the heights, 0 to 2^32 - 1. Nothing else of the field changes them.
    pattern : {"flat", "hill", "diagonal"}
        Posts of all levels alike; or up to a ridge and down again, one level more or less at
        random, the ridge across the field or, sooner on the left, askew.
    posts : int
        Posts in a row.
    post : float
        [m] Side of a post.
    rise : float
        [m] Height of a level. The default is a quarter of a public arena's 0.10 m, for robots as
        small as the Engineer.
    levels : int
        Levels above the ground.
    barrier_height : float
        [m] Height of a barrier across the middle of the field; 0 is none.
    barrier_thickness : float
        [m] Its extent across its front face.
    barrier_yaw : float
        [rad] Its turn, as that of a `DiagonalBarrier`.
    edge_radius : float
        [m] Radius of the convex edges; 0 is sharp.
    friction : float
        [-] Coulomb friction between robot and ground.
    """

    kind: ClassVar[str] = "random_stepfield"
    place: ClassVar[str] = "terrain"

    seed: int = 0
    _: KW_ONLY
    pattern: Literal["flat", "hill", "diagonal"] = "flat"
    posts: int = 10
    post: float = 0.1
    rise: float = 0.025
    levels: int = 4
    barrier_height: float = 0.0
    barrier_thickness: float = 0.1
    barrier_yaw: float = 0.0
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


Lane = Flat | Step | Ramp | Barrier | Ridge | Gap | Stairs | HalfRound | Points
"""Every terrain of one profile."""


@dataclass(frozen=True, slots=True)
class Lanes(Parameters):
    """A profile under each track and one under the belly.

    Each track has half of the mass that moves with the surfaces and half of the motors' force;
    roll and yaw are held. Equal profiles are simulated as one with both tracks lumped.

    Parameters
    ----------
    left, right : Lane
        What each track meets.
    middle : Lane, optional
        What the belly meets; None is the upper envelope of the two, with the larger friction.
    """

    kind: ClassVar[str] = "lanes"
    place: ClassVar[str] = "terrain"

    left: Lane
    right: Lane
    _: KW_ONLY
    middle: Lane | None = None


Terrain = Lane | Lanes | DiagonalBarrier | RandomStepfield
"""Every terrain."""
