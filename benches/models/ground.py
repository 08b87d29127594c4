"""The ground in three dimensions: level terrains as boxes across the whole width."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from crawler2d.errors import ScenarioError
from crawler2d.parameters.terrain import Barrier, Flat, Stairs, Step, Terrain

__all__ = ["AFTER", "BEFORE", "Box", "boxes_of", "profile_of"]

BEFORE, AFTER, DEPTH, WIDTH = 3.0, 8.0, 1.0, 6.0
"""[m] Ground before the first edge and behind the last, below y = 0, and across."""


@dataclass(frozen=True, slots=True)
class Box:
    """A block of the ground.

    Parameters
    ----------
    center, size : tuple of float, shape (3,)
        [m] Forward, to the left, up.
    """

    center: tuple[float, float, float]
    size: tuple[float, float, float]


def profile_of(ground: Terrain) -> NDArray[np.float64]:
    """[m] Return the corners of a terrain of level tops and upright faces, shape (n, 2).

    Raises
    ------
    ScenarioError
        If it has others: those are no boxes.

    Examples
    --------
    >>> profile_of(Barrier(0.07, 0.01)).tolist()
    [[-3.0, 0.0], [0.0, 0.0], [0.0, 0.07], [0.01, 0.07], [0.01, 0.0], [8.01, 0.0]]
    """
    if getattr(ground, "edge_radius", 0.0) != 0.0:
        raise ScenarioError("terrain.edge_radius", ground, "must be 0: a rounded edge is no box")
    corners: list[tuple[float, float]]
    match ground:
        case Flat():
            corners = []
        case Step():
            corners = [(0.0, 0.0), (0.0, ground.height)]
        case Barrier():
            high, end = ground.height, ground.thickness
            corners = [(0.0, 0.0), (0.0, high), (end, high), (end, 0.0)]
        case Stairs():
            corners = [
                (number * ground.run, (number + more) * ground.rise)
                for number in range(ground.count)
                for more in (0, 1)
            ]
        case _:
            raise ScenarioError("terrain", ground, "must be level, a step, a barrier or stairs")
    last, height = corners[-1] if corners else (0.0, 0.0)
    return np.array([(-BEFORE, 0.0), *corners, (last + AFTER, height)])


def boxes_of(profile: NDArray[np.float64]) -> list[Box]:
    """Return one box under each level piece of a profile, all with the same floor.

    Two boxes meet only at upright faces, where one is higher: no wheel rolls over a seam.

    Parameters
    ----------
    profile : ndarray, shape (n, 2)
        [m] Corners from left to right.

    Examples
    --------
    >>> [box.center[2] + 0.5 * box.size[2] for box in boxes_of(profile_of(Step(0.1)))]
    [0.0, 0.1]
    """
    found = []
    for (left, low), (right, high) in pairwise(profile.tolist()):
        if right > left:
            if low != high:
                raise ScenarioError("profile", [left, low], "must be level or upright")
            center = (0.5 * (left + right), 0.0, 0.5 * (high - DEPTH))
            found.append(Box(center=center, size=(right - left, WIDTH, high + DEPTH)))
    return found
