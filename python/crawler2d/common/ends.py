"""The end axles of a track: those of the discs that reach farthest back and forwards."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

__all__ = ["Disc", "discs_in", "ends_of", "is_short", "two_discs"]

Disc = tuple[float, float, float]
"""[m] Centre (x, y) in the chassis frame, and radius."""


def ends_of(discs: Sequence[Disc]) -> tuple[Disc, Disc]:
    """Find the rearmost and the foremost disc; of two that reach equally far the higher one.

    Examples
    --------
    >>> ends_of([(0.3, 0.1, 0.04), (-0.2, 0.0, 0.06), (0.2, 0.0, 0.06)])
    ((-0.2, 0.0, 0.06), (0.3, 0.1, 0.04))
    """
    if is_short(discs):
        return discs[0], discs[1]  # also where one would enclose the other, which is refused
    rear = max(discs, key=lambda disc: (disc[2] - disc[0], disc[1]))
    front = max(discs, key=lambda disc: (disc[2] + disc[0], disc[1]))
    return rear, front


def two_discs(axle_distance: float, rear: float, front: float) -> tuple[Disc, Disc]:
    """Make two discs of their distance and radii [m], the chassis frame midway between them."""
    half = 0.5 * axle_distance
    return (-half, 0.0, rear), (half, 0.0, front)


def discs_in(outline: Mapping[str, Any]) -> Sequence[Disc]:
    """Read the discs of an outline in JSON."""
    if "discs" in outline:
        return [(x, y, radius) for x, y, radius in outline["discs"]]
    distance, rear, front = (
        outline[name] for name in ("axle_distance", "rear_radius", "front_radius")
    )
    return two_discs(distance, rear, front)


def is_short(discs: Sequence[Disc]) -> bool:
    """Whether these are two discs, the rear one first, with the chassis frame midway between them.

    Their distance and radii say it all then.
    """
    if len(discs) != 2:
        return False
    (rear, rear_y, _), (front, front_y, _) = discs
    return rear < 0.0 and front == -rear and rear_y == 0.0 and front_y == 0.0
