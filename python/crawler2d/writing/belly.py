"""The belly as convex parts: one hull where a format holds that, else boxes along its edges."""

from __future__ import annotations

import math

import numpy as np

from crawler2d.models.poses import Array
from crawler2d.models.tree import Shape
from crawler2d.writing.solids import Solids

__all__ = ["belly_shapes"]

_THIN = 0.001  # [m] Depth of the box behind an edge with a corner sharper than a right angle.
_SHARE = 0.05  # that depth at most, of the height of the belly over the edge
_LEVELS = 64  # depths that are tried for the largest box
_SAME = 1e-9  # [-] of its size: what rounding leaves of nothing


def belly_shapes(corners: Array, solids: Solids, *, hulls: bool) -> list[Shape]:
    """Return the parts of the belly.

    Boxes lie inside it and along its edges. A corner sharper than a right angle is cut off, as far
    from it as a thin box needs.

    Parameters
    ----------
    corners : ndarray, shape (n, 2)
        [m] Convex, counter-clockwise.
    solids : Solids
        Makes the shapes.
    hulls : bool
        Whether the format holds convex hulls.
    """
    edges = [_Edge(corners, number) for number in range(len(corners))]
    if len(corners) == 4 and all(edge.is_square for edge in edges):
        return [edges[0].box(0, edges[0].height, solids)]
    if hulls:
        return [solids.prism(0, corners)]
    most = max(edges, key=lambda edge: edge.largest[0])
    boxes = [most.box(0, most.largest[1], solids)]
    return boxes + [edge.box(n, edge.depth, solids) for n, edge in enumerate(edges, 1)]


class _Edge:
    """An edge of a convex polygon, with rectangles inside the polygon that have a side on it."""

    def __init__(self, corners: Array, number: int) -> None:
        self.start = corners[number]
        way = corners[(number + 1) % len(corners)] - self.start
        self.length = math.hypot(*way)
        self.along = way / self.length
        self.inward = np.array([-self.along[1], self.along[0]])
        out = corners - self.start
        self.places = np.stack([out @ self.along, out @ self.inward], axis=1)
        self.height = float(self.places[:, 1].max())

    def within(self, depth: float) -> tuple[float, float]:
        """[m] Return from where to where along the edge a rectangle of this depth fits."""
        crossed = []
        for (x0, y0), (x1, y1) in zip(self.places, np.roll(self.places, -1, axis=0), strict=True):
            if min(y0, y1) <= depth <= max(y0, y1):
                share = 0.0 if y0 == y1 else (depth - y0) / (y1 - y0)
                crossed.append(x0 + share * (x1 - x0))
                if y0 == y1:
                    crossed.append(x1)
        if not crossed:
            return 0.0, 0.0
        return max(0.0, min(crossed)), min(self.length, max(crossed))

    @property
    def is_square(self) -> bool:
        """Whether the rectangle on it is all of a quadrilateral."""
        low, high = self.within(self.height)
        return high - low >= self.length * (1.0 - _SAME) and self.places[:, 0].max() <= (
            self.length * (1.0 + _SAME)
        )

    @property
    def largest(self) -> tuple[float, float]:
        """[m^2, m] Area and depth of the largest rectangle on it."""
        depths = np.linspace(0.0, self.height, _LEVELS + 1)[1:]
        areas = [(high - low) * d for d in depths for low, high in [self.within(float(d))]]
        best = int(np.argmax(areas))
        return areas[best], float(depths[best])

    @property
    def depth(self) -> float:
        """[m] Of the deepest rectangle as long as the edge, or of a thin one that is shorter."""
        low, high = 0.0, self.height
        for _ in range(60):
            middle = 0.5 * (low + high)
            left, right = self.within(middle)
            fits = right - left >= self.length * (1.0 - _SAME)
            low, high = (middle, high) if fits else (low, middle)
        thin = min(_THIN, _SHARE * self.height)
        return max(low, thin)

    def box(self, number: int, depth: float, solids: Solids) -> Shape:
        """Return the rectangle of a depth."""
        low, high = self.within(depth)
        middle = self.start + 0.5 * (low + high) * self.along + 0.5 * depth * self.inward
        return solids.box(number, middle, self.along, high - low, depth)
