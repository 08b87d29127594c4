"""Gear wheels as convex parts: a cylinder as large as the root circle, and one part a grouser."""

from __future__ import annotations

import math

import numpy as np

from crawler2d.models.poses import Array
from crawler2d.models.tree import Shape
from crawler2d.writing.solids import Solids

__all__ = ["gear_shapes", "grousers_of"]

_SAME = 1e-9  # [-] of the radius: what rounding leaves of equal lengths


def grousers_of(outline: Array) -> tuple[float, Array]:
    """[m] Find the root radius and the grousers in the exact outline of a gear wheel.

    Parameters
    ----------
    outline : ndarray, shape (n, 2)
        [m] About the axle, counter-clockwise: arcs of the root circle between trapezoids.

    Returns
    -------
    tuple of float and ndarray, shape (k, 4, 2)
        [m] Radius of the root circle; the corners of each grouser, from its base up one flank,
        over the tip and down to its base.
    """
    radii = np.hypot(*outline.T)
    tip = radii.max()
    at_tip = radii >= tip * (1.0 - _SAME)
    if at_tip.all():  # grousers that rounding cannot tell from the wheel
        return float(tip), np.zeros((0, 4, 2))
    first = np.flatnonzero(at_tip & ~np.roll(at_tip, 1))
    count = len(outline)
    corners = outline[(first[:, None] + np.array([-1, 0, 1, 2])) % count]
    return float(np.hypot(*corners[0, 0])), corners


def gear_shapes(
    outline: Array, solids: Solids, center: Array, *, hulls: bool
) -> list[Shape] | None:
    """Return the parts of a gear wheel, whose union has its exact outline.

    Parameters
    ----------
    outline : ndarray, shape (n, 2)
        [m] About the axle, turned as the wheel starts.
    solids : Solids
        Makes the shapes.
    center : ndarray, shape (2,)
        [m] Its axle.
    hulls : bool
        Whether the format holds convex hulls. Without them a grouser must be a box.

    Returns
    -------
    list of Shape or None
        None if the grousers taper, and the format holds boxes only.
    """
    root, grousers = grousers_of(outline)
    shapes = [solids.cylinder(0, center, root)]
    for number, corners in enumerate(grousers, 1):
        base, tip = corners[3] - corners[0], corners[2] - corners[1]
        wide, thick = math.hypot(*base), math.hypot(*tip)
        if abs(wide - thick) <= _SAME * root:
            low, high = corners[[0, 3]].mean(axis=0), corners[[1, 2]].mean(axis=0)
            middle, height = 0.5 * (low + high), math.hypot(*(high - low))
            # Seen from the root, the outline runs from right to left: the box is turned about.
            shapes.append(solids.box(number, center + middle, -base / wide, thick, height))
        elif hulls:
            shapes.append(solids.prism(number, center + corners))
        else:
            return None
    return shapes
