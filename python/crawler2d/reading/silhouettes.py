"""Collision shapes in side view: their outlines, as polygons in a plane."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from crawler2d.models.poses import Array
from crawler2d.models.tree import Shape, Tree
from crawler2d.models.where import Where
from crawler2d.reading.parts import corners_of
from crawler2d.reading.tracks import Base
from crawler2d.reading.view import SideView

__all__ = ["Silhouette", "hull", "silhouette", "silhouettes"]

_CHORDS = 16  # that stand for a circle; at most 2 % of its radius inside it
_DRAWN_CHORDS = 64  # the same where it is looked at; 0.2 %
_DIGITS = 6  # Files round to a micrometre.
_SMALLEST = 1e-6  # [m] Corners nearer than this are one, and a hull thinner than this is none.


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Silhouette:
    """What is seen of a collision shape from the side.

    Parameters
    ----------
    link : str
        The link that it is a shape of.
    kind : str
        As in `Shape`.
    outline : ndarray, shape (n, 2)
        [m] Its corners in the frame of the chassis, counter-clockwise; circles as polygons.
    at : Where
        Its line.
    """

    link: str
    kind: str
    outline: Array
    at: Where


def silhouettes(tree: Tree, view: SideView, base: Base) -> tuple[Silhouette, ...]:
    """Return what is seen of every collision shape, with all joints at zero."""
    found = []
    for link in tree.links:
        for shape in link.shapes:
            corners = hull(base.of(silhouette(shape, view, _DRAWN_CHORDS)))
            outline = np.array(corners).reshape(-1, 2)
            found.append(Silhouette(link=link.name, kind=shape.kind, outline=outline, at=shape.at))
    return tuple(found)


def silhouette(shape: Shape, view: SideView, chords: int = _CHORDS) -> Array:
    """[m] Return points of the side view whose hull is the shape's, rounds as chords."""
    if shape.kind in ("box", "hull"):
        return view.of(corners_of(shape))[:, :2]
    half = np.array([-0.5, 0.5]) * (0.0 if shape.kind == "sphere" else shape.length)
    middles = shape.pose.place + half[:, None] * shape.axis
    angles = np.linspace(0.0, 2.0 * math.pi, chords, endpoint=False)
    circle = shape.radius * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    if shape.kind == "cylinder":
        rim = circle @ shape.pose.turn[:, :2].T
        points = (middles[:, None, :] + rim).reshape(-1, 3)
        return view.of(points)[:, :2]
    return (view.of(middles)[:, None, :2] + circle).reshape(-1, 2)


def hull(points: Array) -> list[Array]:
    """Return the corners of the convex hull, counter-clockwise, none on a straight edge."""
    order = np.unique(np.round(points, _DIGITS) + 0.0, axis=0).tolist()  # floats, which are faster
    ends = [_chain(order), _chain(order[::-1])]
    return [np.array(corner) for chain in ends for corner in chain[:-1]]


def _chain(order: list[list[float]]) -> list[list[float]]:
    """Return one half of a hull of sorted points."""
    chain: list[list[float]] = []
    for point in order:
        while len(chain) > 1 and _height(chain[-2], chain[-1], point) <= _SMALLEST:
            chain.pop()
        chain.append(point)
    return chain


def _height(start: list[float], corner: list[float], end: list[float]) -> float:
    """[m] Return by how much a corner stands out to the right of the line past it."""
    x, y = end[0] - start[0], end[1] - start[1]
    length = math.hypot(x, y)
    out = y * (corner[0] - start[0]) - x * (corner[1] - start[1])
    return out / length if length > 0.0 else 0.0
