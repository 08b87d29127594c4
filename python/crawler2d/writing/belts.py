"""A belt round discs as convex parts: a cylinder a disc, and a box behind each straight run."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from crawler2d.models.poses import Array
from crawler2d.models.tree import Shape
from crawler2d.writing.solids import Solids

__all__ = ["belt_shapes", "runs_round"]

_SAME = 1e-9  # [-] of the largest distance: what rounding leaves of nothing


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Run:
    """A straight run of a belt, from a disc to the next one, counter-clockwise.

    Parameters
    ----------
    start, end : int
        Numbers of the discs.
    normal : ndarray, shape (2,)
        Out of the belt.
    """

    start: int
    end: int
    normal: Array


def runs_round(discs: Array) -> list[Run]:
    """Find the straight runs of the belt that is taut round discs.

    Parameters
    ----------
    discs : ndarray, shape (n, 3)
        [m] Centres and radii.

    Returns
    -------
    list of Run
        In no order.
    """
    centers, radii = discs[:, :2], discs[:, 2]
    tolerance = _SAME * float(np.abs(discs).max())
    found = []
    for start in range(len(discs)):
        for end in range(len(discs)):
            normal = _tangent(discs[start], discs[end])
            if start == end or normal is None:
                continue
            reach = centers @ normal + radii
            if reach.max() > reach[start] + tolerance:
                continue
            # Of several discs along one run, the first and the last one are its ends.
            touching = np.flatnonzero(reach >= reach[start] - tolerance)
            along = centers[touching] @ np.array([-normal[1], normal[0]])
            if start == touching[along.argmin()] and end == touching[along.argmax()]:
                found.append(Run(start=start, end=end, normal=normal))
    return found


def _tangent(start: Array, end: Array) -> Array | None:
    """Return the normal of the outer tangent from a disc to another, to the right of the way."""
    (x, y), narrower = end[:2] - start[:2], start[2] - end[2]
    distance = math.hypot(x, y)
    if distance <= abs(narrower):
        return None
    along, out = narrower / distance, math.sqrt(1.0 - (narrower / distance) ** 2)
    way, right = np.array([x, y]) / distance, np.array([y, -x]) / distance
    normal: Array = along * way + out * right
    return normal


def belt_shapes(discs: Array, solids: Solids) -> list[Shape]:
    """Return the parts of a belt, whose union has its exact outline.

    The middle of each box lies as deep as its surface is from the axis about which that turns.
    """
    # The box between two equal discs is that of its upper run, and so is not turned about.
    runs = sorted(runs_round(discs), key=lambda run: -float(run.normal[1]))
    ends = sorted({number for run in runs for number in (run.start, run.end)})
    shapes = [
        solids.cylinder(number, discs[end, :2], float(discs[end, 2]))
        for number, end in enumerate(ends)
    ]
    middles: list[Array] = []
    for run in runs:
        first, last = discs[run.start], discs[run.end]
        # So deep that its inner corners still lie within both discs.
        depth = 2.0 * float(min(first[2], last[2]))
        from_, to = (disc[:2] + disc[2] * run.normal for disc in (first, last))
        middle = 0.5 * (from_ + to) - 0.5 * depth * run.normal
        if any(math.hypot(*(middle - other)) <= _SAME * depth for other in middles):
            continue  # the box between two equal discs has both runs
        middles.append(middle)
        length = math.hypot(*(to - from_))
        # z points out of the belt, so that x points against the way round.
        along = np.array([run.normal[1], -run.normal[0]])
        shapes.append(solids.box(len(shapes), middle, along, length, depth))
    return shapes
