"""Collision shapes of a side view, as wide as they are across: cylinders, boxes and prisms."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from crawler2d.models.poses import Array, Pose, from_rpy
from crawler2d.models.tree import Friction, Shape, Tree

__all__ = ["Solids", "in_space", "lowest"]

_UPRIGHT = from_rpy((-0.5 * math.pi, 0.0, 0.0))
"""Turns the axis of a cylinder, its z, to the left."""


def in_space(point: Array, across: float) -> Array:
    """[m] Return where a point of the side view is in a model: x forward, y to the left, z up."""
    placed: Array = np.array([point[0], across, point[1]])
    return placed


@dataclass(frozen=True, slots=True, kw_only=True)
class Solids:
    """Makes shapes of one width at one place across the robot.

    Parameters
    ----------
    name : str
        With which the names of all begin.
    across, width : float
        [m] Place of the middle, to the left, and width.
    friction : float
        [-] Of their surfaces.
    speed : float
        [m/s] At which their surfaces move; 0: they do not.
    """

    name: str
    across: float
    width: float
    friction: float
    speed: float = 0.0

    def cylinder(self, number: int, center: Array, radius: float) -> Shape:
        """Return a disc in side view."""
        pose = Pose(place=in_space(center, self.across), turn=_UPRIGHT.turn)
        return self._shape(number, "cylinder", pose, radius=radius, length=self.width)

    def box(
        self, number: int, center: Array, direction: Array, length: float, height: float
    ) -> Shape:
        """Return a rectangle in side view, its length along a direction."""
        (x, z), up = direction, (-direction[1], direction[0])
        turn = np.array([[x, 0.0, up[0]], [0.0, 1.0, 0.0], [z, 0.0, up[1]]])
        pose = Pose(place=in_space(center, self.across), turn=turn)
        return self._shape(number, "box", pose, size=np.array([length, self.width, height]))

    def prism(self, number: int, corners: Array) -> Shape:
        """Return a convex polygon in side view, shape (n, 2)."""
        half = 0.5 * self.width
        sides = [self.across - half, self.across + half]
        points = np.array([in_space(corner, side) for side in sides for corner in corners])
        # A mesh lies about its own middle.
        pose = Pose(place=points.mean(axis=0))
        return self._shape(number, "hull", pose, points=points)

    def _shape(self, number: int, kind: str, pose: Pose, **sizes: object) -> Shape:
        return Shape(
            name=f"{self.name}_{number}",
            kind=kind,
            pose=pose,
            friction=Friction(first=self.friction, second=self.friction),
            surface_speed=self.speed,
            **sizes,  # type: ignore[arg-type]
        )


def lowest(tree: Tree) -> float:
    """[m] Return the height of the lowest point of all shapes."""
    return min((_low(shape) for link in tree.links for shape in link.shapes), default=0.0)


def _low(shape: Shape) -> float:
    if shape.kind == "hull":
        return float(shape.points[:, 2].min())
    if shape.kind == "cylinder":
        return float(shape.pose.place[2]) - shape.radius
    reach: Array = np.abs(shape.pose.turn[2]) @ shape.size
    return float(shape.pose.place[2] - 0.5 * reach)
