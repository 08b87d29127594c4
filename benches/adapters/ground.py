"""The ground in three dimensions as boxes, also under one track only, or turned."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from crawler2d import Scenario, ScenarioError, simulate_many
from crawler2d.parameters.terrain import (
    Barrier,
    DiagonalBarrier,
    Flat,
    Lanes,
    RandomStepfield,
    Stairs,
    Step,
    Terrain,
)

BEFORE, AFTER, DEPTH, WIDTH = 3.0, 8.0, 1.0, 6.0
"""[m] Ground before the first edge and behind the last, below y = 0, and across."""


@dataclass(frozen=True, slots=True)
class Box:
    """A block of the ground.

    Parameters
    ----------
    center, size : tuple of float, shape (3,)
        [m] Forward, to the left, up.
    yaw : float
        [rad] Counter-clockwise seen from above.
    """

    center: tuple[float, float, float]
    size: tuple[float, float, float]
    yaw: float = 0.0


def profile_of(ground: Terrain) -> NDArray[np.float64]:
    """[m] Return the corners of a terrain of level tops and upright faces, shape (n, 2).

    Raises
    ------
    ScenarioError
        If the terrain has slopes or round edges.

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
    >>> [round(box.center[2] + 0.5 * box.size[2], 9) for box in boxes_of(profile_of(Step(0.1)))]
    [0.0, 0.1]
    """
    boxes = []
    for (left, low), (right, high) in pairwise(profile.tolist()):
        if right > left:
            if low != high:
                raise ScenarioError("profile", [left, low], "must be level or upright")
            center = (0.5 * (left + right), 0.0, 0.5 * (high - DEPTH))
            boxes.append(Box(center, (right - left, WIDTH, high + DEPTH)))
    return boxes


def blocks_of(scenario: Scenario) -> list[Box]:
    """Return the ground of a scenario as blocks.

    Level ground, steps and barriers extend across the whole width. The front face of a diagonal
    barrier passes the middle of the track that meets it first at x = 0. Of lanes, the left one is a
    barrier and the right one level. A step field has one row of posts on either side, each half as
    wide as the ground, without the middle lane, which only the belly meets.
    """
    ground = scenario.terrain
    if isinstance(ground, DiagonalBarrier):
        along, yaw = 0.5 * ground.thickness, ground.yaw
        y = math.copysign(0.5 * scenario.robot.gauge, yaw)
        at = along * math.cos(yaw), y + along * math.sin(yaw)
        return [_level(), _edge(ground.height, ground.thickness, at, WIDTH, yaw)]
    if isinstance(ground, Lanes):
        left = ground.left
        if not isinstance(left, Barrier):
            raise ScenarioError("terrain.left", left, "must be a barrier")
        at = 0.5 * left.thickness, 0.25 * WIDTH
        return [_level(), _edge(left.height, left.thickness, at, 0.5 * WIDTH, 0.0)]
    if isinstance(ground, RandomStepfield):
        return _posts(scenario)
    return boxes_of(profile_of(ground))


def turned(blocks: Sequence[Box], yaw: float, x: float = 0.0) -> list[Box]:
    """Return blocks turned about the vertical through the point (x, 0).

    Parameters
    ----------
    blocks : sequence of Box
        The blocks.
    yaw : float
        [rad] Counter-clockwise seen from above.
    x : float
        [m] Of the point.

    Examples
    --------
    >>> (block,) = turned([Box((3.0, 0.0, 0.5), (2.0, 6.0, 1.0))], math.pi / 2.0, 1.0)
    >>> [round(each, 9) for each in block.center]
    [1.0, 2.0, 0.5]
    """
    cos, sin = math.cos(yaw), math.sin(yaw)
    result = []
    for block in blocks:
        along, y, z = block.center[0] - x, *block.center[1:]
        center = x + along * cos - y * sin, along * sin + y * cos, z
        result.append(Box(center, block.size, block.yaw + yaw))
    return result


def goal_of(scenario: Scenario) -> float:
    """[m] Return the x of the last edge that a track meets, in its middle."""
    ground = scenario.terrain
    if isinstance(ground, DiagonalBarrier):
        yaw = abs(ground.yaw)
        return scenario.robot.gauge * math.tan(yaw) + ground.thickness / math.cos(yaw)
    if isinstance(ground, RandomStepfield):
        return ground.posts * ground.post
    return float(profile_of(ground.left if isinstance(ground, Lanes) else ground)[-2, 0])


def _level() -> Box:
    size = (BEFORE + AFTER, WIDTH, DEPTH)
    return Box((0.5 * (AFTER - BEFORE), 0.0, -0.5 * DEPTH), size)


def _edge(
    height: float, thickness: float, at: tuple[float, float], width: float, yaw: float
) -> Box:
    return Box((*at, 0.5 * (height - DEPTH)), (thickness, width, height + DEPTH), yaw)


def _posts(scenario: Scenario) -> list[Box]:
    """Return a block under each level piece of the two outer lanes."""
    (run,) = simulate_many([scenario.replace({"duration": 0.001})], record="summary", threads=1)
    lanes, xs, ys = (np.asarray(run.edges[name]) for name in ("lane", "x", "y"))
    blocks = []
    for lane, side in ((1, 1.0), (2, -1.0)):
        corners = np.column_stack([xs, ys])[lanes == lane]
        profile = np.vstack([(-BEFORE, 0.0), corners, (corners[-1, 0] + AFTER, 0.0)])
        for box in boxes_of(profile):
            (x, _, z), (length, _, height) = box.center, box.size
            blocks.append(Box((x, 0.25 * side * WIDTH, z), (length, 0.5 * WIDTH, height)))
    return blocks
