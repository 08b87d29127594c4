"""The belly: the convex hull, in side view, of what is fixed to the chassis and does not turn."""

from __future__ import annotations

import math

import numpy as np

from crawler2d.models.poses import Array
from crawler2d.models.tree import Link, Shape
from crawler2d.reading.parts import corners_of
from crawler2d.reading.tracks import Base
from crawler2d.reading.view import SideView

__all__ = ["belly_of", "silhouette"]

_CHORDS = 16  # that stand for a circle; at most 2 % of its radius inside it
_DIGITS = 6  # Files round to a micrometre.
_SMALLEST = 1e-6  # [m] Corners nearer than this are one, and a hull thinner than this is none.
_CIRCLE = np.linspace(0.0, 2.0 * math.pi, _CHORDS, endpoint=False)

Corners = tuple[tuple[float, float], ...]


def belly_of(shapes: list[tuple[Link, Shape]], view: SideView, base: Base) -> Corners | None:
    """Return the belly in the chassis frame, counter-clockwise; None if there is none."""
    if not shapes:
        return None
    flat = [base.of(silhouette(shape, view)) for _, shape in shapes]
    corners = _hull(np.concatenate(flat))
    if len(corners) < 3:
        return None
    return tuple((float(x), float(y)) for x, y in corners)


def silhouette(shape: Shape, view: SideView) -> Array:
    """[m] Return points of the side view whose hull is the shape's, rounds as chords."""
    if shape.kind in ("box", "hull"):
        return view.of(corners_of(shape))[:, :2]
    half = np.array([-0.5, 0.5]) * (0.0 if shape.kind == "sphere" else shape.length)
    middles = shape.pose.place + half[:, None] * shape.axis
    circle = shape.radius * np.stack([np.cos(_CIRCLE), np.sin(_CIRCLE)], axis=1)
    if shape.kind == "cylinder":
        rim = circle @ shape.pose.turn[:, :2].T
        points = (middles[:, None, :] + rim).reshape(-1, 3)
        return view.of(points)[:, :2]
    return (view.of(middles)[:, None, :2] + circle).reshape(-1, 2)


def _hull(points: Array) -> list[Array]:
    """Return the corners of the convex hull, counter-clockwise, none on a straight edge."""
    order = np.unique(np.round(points, _DIGITS) + 0.0, axis=0)
    ends = [_chain(order), _chain(order[::-1])]
    return [corner for chain in ends for corner in chain[:-1]]


def _chain(order: Array) -> list[Array]:
    """Return one half of a hull of sorted points."""
    chain: list[Array] = []
    for point in order:
        while len(chain) > 1 and _height(chain[-2], chain[-1], point) <= _SMALLEST:
            chain.pop()
        chain.append(point)
    return chain


def _height(start: Array, corner: Array, end: Array) -> float:
    """[m] Return by how much a corner stands out to the right of the line past it."""
    along, to = end - start, corner - start
    length = math.hypot(*along)
    return float(along[1] * to[0] - along[0] * to[1]) / length if length > 0.0 else 0.0
