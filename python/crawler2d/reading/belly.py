"""The belly: the convex hull, in side view, of what is fixed to the chassis and does not turn."""

from __future__ import annotations

import numpy as np

from crawler2d.models.tree import Link, Shape
from crawler2d.reading.silhouettes import hull, silhouette
from crawler2d.reading.tracks import Base
from crawler2d.reading.view import SideView

__all__ = ["belly_of"]

Corners = tuple[tuple[float, float], ...]


def belly_of(shapes: list[tuple[Link, Shape]], view: SideView, base: Base) -> Corners | None:
    """Return the belly in the chassis frame, counter-clockwise; None if there is none."""
    if not shapes:
        return None
    flat = [base.of(silhouette(shape, view)) for _, shape in shapes]
    corners = hull(np.concatenate(flat))
    if len(corners) < 3:
        return None
    return tuple((float(x), float(y)) for x, y in corners)
