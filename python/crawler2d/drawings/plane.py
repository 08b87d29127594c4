"""Points, poses and polygons in the plane, as arrays."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["SLIVER", "closed", "inset", "placed", "relative"]

SLIVER = 2e-5
"""[m] Lines that coincide enclose slivers by rounding; anything shallower is not an intrusion."""


def placed(points: NDArray[np.float64], poses: NDArray[np.float64]) -> NDArray[np.float64]:
    """[m] Points of a frame, shape (..., 2), moved by the poses of that frame, shape (..., 3)."""
    (x, y), (left, up, angle) = np.moveaxis(points, -1, 0), np.moveaxis(poses, -1, 0)
    cosine, sine = np.cos(angle), np.sin(angle)
    return np.stack([left + cosine * x - sine * y, up + sine * x + cosine * y], axis=-1)


def relative(poses: NDArray[np.float64], frames: NDArray[np.float64]) -> NDArray[np.float64]:
    """[m, m, rad] Poses at n samples, shape (n, 3), relative to frames with these poses."""
    (x, y), angle = (poses - frames).T[:2], frames[:, 2]
    cosine, sine = np.cos(angle), np.sin(angle)
    return np.column_stack([cosine * x + sine * y, cosine * y - sine * x, poses[:, 2] - angle])


def closed(polygon: NDArray[np.float64]) -> NDArray[np.float64]:
    """[m] A polygon as a line that ends where it began."""
    return np.vstack([polygon, polygon[:1]])


def inset(belt: NDArray[np.float64], depth: float) -> NDArray[np.float64]:
    """[m] A closed convex line, counter-clockwise, offset inwards by a depth."""
    way = np.roll(belt, -1, axis=0) - belt
    belt = belt[np.hypot(*way.T) > 1e-9]  # drops coincident corners
    way = np.roll(belt, -1, axis=0) - belt
    inwards = np.column_stack([-way[:, 1], way[:, 0]])
    inwards /= np.hypot(*way.T)[:, None]
    inwards = inwards + np.roll(inwards, 1, axis=0)
    line: NDArray[np.float64] = belt + depth * inwards / np.hypot(*inwards.T)[:, None]
    return line
