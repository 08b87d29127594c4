"""The ground as parameters: x forward, y up; the first edge of an obstacle is at x = 0."""

from __future__ import annotations

from dataclasses import KW_ONLY, dataclass
from typing import ClassVar, Literal

from crawler2d.parameters.heights import HasHeights

__all__ = [
    "Barrier",
    "DiagonalBarrier",
    "Flat",
    "Gap",
    "Ground",
    "GroundWithEdges",
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
class Ground(HasHeights):
    """A terrain with one ground for both tracks: any but `Lanes`.

    Parameters
    ----------
    friction : float
        [-] Coulomb friction between robot and ground.
    """

    friction: float = 0.9


@dataclass(frozen=True, slots=True, kw_only=True)
class GroundWithEdges(Ground):
    """A terrain whose convex edges all have one radius.

    Parameters
    ----------
    edge_radius : float
        [m] Radius of every convex edge; 0 is sharp.
    friction : float
        [-] Coulomb friction between robot and ground.
    """

    edge_radius: float = 0.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Flat(Ground, kind="flat"):
    """Level ground.

    Parameters
    ----------
    length : float
        [m] Distance from x = 0 to the goal.
    friction : float
        [-] Coulomb friction between robot and ground.
    """

    length: float = 2.0


@dataclass(frozen=True, slots=True)
class Step(GroundWithEdges, kind="step"):
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

    height: float


@dataclass(frozen=True, slots=True)
class Ramp(GroundWithEdges, kind="ramp"):
    """A slope that begins at x = 0 and ends in a level top.

    Parameters
    ----------
    angle : float
        [rad] Angle of the slope, up > 0.
    length : float
        [m] Horizontal length of the slope.
    edge_radius : float
        [m] Radius of the convex edge; 0 is sharp.
    friction : float
        [-] Coulomb friction between robot and ground.
    """

    angle: float
    _: KW_ONLY
    length: float = 1.0


@dataclass(frozen=True, slots=True)
class Barrier(GroundWithEdges, kind="barrier"):
    """A block on level ground, with its front face at x = 0.

    Parameters
    ----------
    height : float
        [m] Height, above 0.
    thickness : float
        [m] Thickness along x.
    edge_radius : float
        [m] Radius of the convex edges; 0 is sharp.
    friction : float
        [-] Coulomb friction between robot and ground.
    """

    height: float
    thickness: float


@dataclass(frozen=True, slots=True)
class Ridge(GroundWithEdges, kind="ridge"):
    """A triangular prism on level ground, starting at x = 0, with its edge on top.

    Parameters
    ----------
    height : float
        [m] Height of the edge, above 0.
    edge_angle : float
        [rad] Angle between the two flanks: a small one is a blade, one near pi a low bump.
    edge_radius : float
        [m] Radius of the convex edges; 0 is sharp.
    friction : float
        [-] Coulomb friction between robot and ground.
    """

    height: float
    edge_angle: float


@dataclass(frozen=True, slots=True)
class Gap(GroundWithEdges, kind="gap"):
    """A trench with vertical walls that begins at x = 0.

    Parameters
    ----------
    width : float
        [m] Width along x.
    depth : float
        [m] Depth, above 0.
    edge_radius : float
        [m] Radius of the convex edges; 0 is sharp.
    friction : float
        [-] Coulomb friction between robot and ground.
    """

    width: float
    _: KW_ONLY
    depth: float = 0.5


@dataclass(frozen=True, slots=True, kw_only=True)
class Stairs(GroundWithEdges, kind="stairs"):
    """Steps up, the first face at x = 0, then a level top.

    The default rise and run are those of a public arena's stairs.

    Parameters
    ----------
    count : int
        Number of steps.
    rise, run : float
        [m] Height and depth of each step.
    edge_radius : float
        [m] Radius of the convex edges; 0 is sharp.
    friction : float
        [-] Coulomb friction between robot and ground.
    """

    count: int = 4
    rise: float = 0.20
    run: float = 0.233


@dataclass(frozen=True, slots=True)
class HalfRound(Ground, kind="half_round"):
    """Half a pipe lying on level ground, starting at x = 0.

    Parameters
    ----------
    radius : float
        [m] Radius, and so the height.
    friction : float
        [-] Coulomb friction between robot and ground.
    """

    radius: float


@dataclass(frozen=True, slots=True)
class DiagonalBarrier(GroundWithEdges, kind="diagonal_barrier"):
    """A block on level ground, turned about the vertical axis.

    With `gauge` that of the robot, the tracks meet it `gauge` tan(`yaw`) apart, and each crosses it
    over a length of `thickness` / cos(`yaw`). The robot does not roll or yaw, as in any side view.
    The belly is assumed to be as wide as the gauge.

    Parameters
    ----------
    yaw : float
        [rad] Yaw of the barrier, counter-clockwise seen from above, at most 80 degrees either way.
        Above 0 the left track meets it first, at x = 0.
    height : float
        [m] Height, above 0.
    thickness : float
        [m] Thickness at right angles to its front face.
    edge_radius : float
        [m] Radius of the convex edges; 0 is sharp.
    friction : float
        [-] Coulomb friction between robot and ground.
    """

    yaw: float
    _: KW_ONLY
    height: float = 0.05
    thickness: float = 0.1

    @property
    def _turn(self) -> float:
        """[rad] By how much a part of it is turned about the vertical."""
        return self.yaw


@dataclass(frozen=True, slots=True)
class RandomStepfield(GroundWithEdges, kind="random_stepfield"):
    """Square posts of random heights from x = 0, a row under each track (Jacoff et al., 2008).

    Parameters
    ----------
    seed : int
        Seed of the random heights, 0 to 2^32 - 1; heights depend on nothing else.
    pattern : {"flat", "hill", "diagonal"}
        "flat": all levels are equally likely. "hill" and "diagonal": up to a ridge and down again,
        plus or minus one level at random; the ridge lies straight across the field ("hill"), or
        diagonally, met first on the left.
    posts : int
        Posts in a row.
    post : float
        [m] Side length of a post.
    rise : float
        [m] Height of one level. The default is a quarter of a public arena's 0.10 m, for robots as
        small as the Engineer.
    levels : int
        Number of levels above the ground.
    barrier_height : float
        [m] Height of a barrier across the middle of the field; 0 for none.
    barrier_thickness : float
        [m] Thickness of the barrier at right angles to its front face. A barrier longer than the
        field begins before x = 0.
    barrier_yaw : float
        [rad] Yaw of the barrier, as for `DiagonalBarrier`.
    edge_radius : float
        [m] Radius of the convex edges; 0 is sharp.
    friction : float
        [-] Coulomb friction between robot and ground.
    """

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

    @property
    def _turn(self) -> float:
        """[rad] By how much a part of it is turned about the vertical."""
        return self.barrier_yaw if self.barrier_height else 0.0


@dataclass(frozen=True, slots=True)
class Points(GroundWithEdges, kind="points"):
    """A user-defined profile.

    Parameters
    ----------
    points : array_like, shape (n, 2)
        [m] 2 to 200,000 points (x, y) in order, from left to right or from right to left. Vertical
        faces are allowed; overhangs and faces that fold back on each other are not. Any array of
        real numbers; it is copied.
    goal : float
        [m] The x that the whole robot must pass, on this ground.
    edge_radius : float
        [m] Radius of every convex edge; 0 is sharp. All edges together may have at most a million
        facets of 1 degree.
    friction : float
        [-] Coulomb friction between robot and ground.
    segment_friction : array_like, shape (n - 1,), optional
        [-] Friction of each segment between two points, instead of `friction`; at a corner the
        larger of the two applies. Not in rapier. Replacing or sweeping ``"terrain.friction"``
        removes these; distributions of it are drawn for each segment.

    Raises
    ------
    ScenarioError
        If `points` or `segment_friction` does not hold real numbers, is masked or has another
        shape.

    Examples
    --------
    A step with a wet face:

    >>> points = [(-2, 0), (0, 0), (0, 0.05), (2, 0.05)]
    >>> Points(points, goal=0.0, segment_friction=[0.9, 0.2, 0.9]).segment_friction
    (0.9, 0.2, 0.9)
    """

    overridden_by: ClassVar[dict[str, str]] = {"friction": "segment_friction"}
    omitted_defaults: ClassVar[tuple[str, ...]] = ("segment_friction",)

    points: tuple[tuple[float, float], ...]
    _: KW_ONLY
    goal: float
    segment_friction: tuple[float, ...] | None = None


Lane = Flat | Step | Ramp | Barrier | Ridge | Gap | Stairs | HalfRound | Points
"""Any terrain with one profile."""


@dataclass(frozen=True, slots=True)
class Lanes(HasHeights, kind="lanes"):
    """A profile under each track and one under the belly.

    Each track has half of the moving track mass and half of the motor force; the robot does not
    roll or yaw. Equal profiles are simulated as one, with both tracks lumped together. All profiles
    must overlap in x, and the farther of the two tracks' goals must lie in the overlap.

    Parameters
    ----------
    left, right : Lane
        The profile under each track.
    middle : Lane, optional
        The profile under the belly; None takes the higher of the two, with the larger friction.
    """

    left: Lane
    right: Lane
    _: KW_ONLY
    middle: Lane | None = None


Terrain = Lane | Lanes | DiagonalBarrier | RandomStepfield
"""Any terrain."""
