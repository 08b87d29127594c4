"""The parts of a running gear in the side view: wheels, drums, flippers, and what is left."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from crawler2d.models.poses import Array
from crawler2d.models.tree import Joint, Link, Shape

__all__ = ["Arm", "Grousers", "Runner", "RunningGear", "corners_of", "farthest"]


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Grousers:
    """The grousers of a gear wheel.

    Parameters
    ----------
    count : int
        How many.
    radius : float
        [m] Of their tips about the axle.
    height, tip_thickness, base_thickness : float
        [m] As in `GearWheel`.
    direction : ndarray, shape (3,)
        Of one of them from the axle.
    shapes : tuple of Shape
        All of them.
    """

    count: int
    radius: float
    height: float
    tip_thickness: float
    base_thickness: float
    direction: Array
    shapes: tuple[Shape, ...]


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Runner:
    """A wheel, or a drum of a track.

    Parameters
    ----------
    name : str
        Of its link, and of its shape if that is one of several.
    x, y, z : float
        [m] Its middle: forward, up and to the left.
    radius : float
        [m] Its radius, to the tips of grousers if it has such.
    link : Link
        What it is part of.
    shape : Shape
        Its own shape, the largest if there are several.
    joint : Joint, optional
        On which it turns; None for a drum, which is fixed while a plugin moves its surface.
    mass : float
        [kg] Of what turns; 0 for a drum.
    inertia : float
        [kg m^2] Of that, about its axis.
    grousers : Grousers, optional
        Those of a gear wheel.
    """

    name: str
    x: float
    y: float
    z: float
    radius: float
    link: Link
    shape: Shape
    joint: Joint | None = None
    mass: float = 0.0
    inertia: float = 0.0
    grousers: Grousers | None = None

    @property
    def surfaces(self) -> tuple[Shape, ...]:
        """Its own shape and its grousers."""
        return (self.shape, *(self.grousers.shapes if self.grousers else ()))


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Arm:
    """What turns about the pivot of a flipper.

    Parameters
    ----------
    joint : Joint
        The pivot.
    pivot : ndarray, shape (3,)
        [m] In the side view.
    links : tuple of Link
        Everything that turns with it.
    runners : tuple of Runner
        Its wheels or drums.
    shapes : tuple of (Link, Shape)
        What is neither wheel nor drum.
    """

    joint: Joint
    pivot: Array
    links: tuple[Link, ...]
    runners: tuple[Runner, ...]
    shapes: tuple[tuple[Link, Shape], ...]


@dataclass(slots=True, eq=False)
class RunningGear:
    """The running gear of a model.

    Parameters
    ----------
    runners : list of Runner
        Wheels and drums of the chassis.
    bars : list of (Link, Shape)
        Shapes on it whose surface is moved, and which are no drums.
    arms : list of Arm
        The flippers.
    shapes : list of (Link, Shape)
        What the chassis has besides, fixed to it.
    moving : list of (Joint, Link, Shape)
        Shapes of other moving parts, such as a lidar or a manipulator.
    passive : set of str
        Names of wheels that nothing drives, while something drives others.
    """

    runners: list[Runner] = field(default_factory=list)
    bars: list[tuple[Link, Shape]] = field(default_factory=list)
    arms: list[Arm] = field(default_factory=list)
    shapes: list[tuple[Link, Shape]] = field(default_factory=list)
    moving: list[tuple[Joint, Link, Shape]] = field(default_factory=list)
    passive: set[str] = field(default_factory=set)

    def without_castors(self, middle: float, tolerance: float) -> list[Runner]:
        """Take out the wheels in the middle that nothing drives, which become skids."""
        castors = [
            wheel
            for wheel in self.runners
            if wheel.name in self.passive and abs(wheel.z - middle) <= tolerance
        ]
        self.runners = [wheel for wheel in self.runners if wheel not in castors]
        self.shapes += [(castor.link, castor.shape) for castor in castors]
        return castors


def corners_of(shape: Shape) -> Array:
    """[m] Return the corners of a box or hull in the frame of the model, shape (n, 3)."""
    if shape.kind == "hull":
        return shape.points
    signs = np.array([[i, j, k] for i in (-0.5, 0.5) for j in (-0.5, 0.5) for k in (-0.5, 0.5)])
    return shape.pose.at(signs * shape.size)


def farthest(shape: Shape, point: Array) -> float:
    """[m] Return how far a shape reaches from a point, or a little more."""
    if shape.kind in ("box", "hull"):
        return float(np.linalg.norm(corners_of(shape) - point, axis=1).max())
    own = math.hypot(shape.radius, 0.5 * shape.length)
    own += shape.radius if shape.kind == "capsule" else 0.0
    return float(np.linalg.norm(shape.pose.place - point)) + own
