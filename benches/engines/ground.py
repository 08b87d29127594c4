"""The ground in space: blocks across the whole width, turned ones, and those under one track."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from benches.models.ground import AFTER, BEFORE, DEPTH, WIDTH, Box, boxes_of, profile_of
from crawler2d.errors import ScenarioError
from crawler2d.parameters.scenario import Scenario
from crawler2d.parameters.terrain import Barrier, DiagonalBarrier, Lanes, RandomStepfield
from crawler2d.runs.batch import simulate_many

__all__ = ["TurnedBox", "blocks_of", "goal_of", "turned"]


@dataclass(frozen=True, slots=True)
class TurnedBox(Box):
    """A block that is turned about the vertical.

    Parameters
    ----------
    yaw : float
        [rad] Counter-clockwise seen from above.
    """

    yaw: float = 0.0


def blocks_of(scenario: Scenario) -> list[TurnedBox]:
    """Return the ground of a scenario as blocks.

    Level ground, steps and barriers go across the whole width. The front face of a diagonal barrier
    passes the middle of the track that meets it first at x = 0. Of lanes, the left one is a barrier
    and the right one level. A step field has one row of posts on either side, each half as wide as
    the ground: the middle lane, which is for the belly alone, is left out.
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
    return [TurnedBox(box.center, box.size) for box in boxes_of(profile_of(ground))]


def turned(blocks: Sequence[TurnedBox], yaw: float, x: float = 0.0) -> list[TurnedBox]:
    """Return blocks turned about the vertical through a point of the middle.

    Parameters
    ----------
    blocks : sequence of TurnedBox
        What is turned.
    yaw : float
        [rad] Counter-clockwise seen from above.
    x : float
        [m] Of that point.

    Examples
    --------
    >>> (block,) = turned([TurnedBox((3.0, 0.0, 0.5), (2.0, 6.0, 1.0))], math.pi / 2.0, 1.0)
    >>> [round(each, 9) for each in block.center]
    [1.0, 2.0, 0.5]
    """
    cos, sin = math.cos(yaw), math.sin(yaw)
    found = []
    for block in blocks:
        along, y, z = block.center[0] - x, *block.center[1:]
        center = x + along * cos - y * sin, along * sin + y * cos, z
        found.append(TurnedBox(center, block.size, block.yaw + yaw))
    return found


def goal_of(scenario: Scenario) -> float:
    """[m] Return the x of the last edge that a track meets, in its middle."""
    ground = scenario.terrain
    if isinstance(ground, DiagonalBarrier):
        yaw = abs(ground.yaw)
        return scenario.robot.gauge * math.tan(yaw) + ground.thickness / math.cos(yaw)
    if isinstance(ground, Lanes):
        return float(profile_of(ground.left)[-2, 0])
    if isinstance(ground, RandomStepfield):
        return ground.posts * ground.post
    return float(profile_of(ground)[-2, 0])


def _level() -> TurnedBox:
    size = (BEFORE + AFTER, WIDTH, DEPTH)
    return TurnedBox((0.5 * (AFTER - BEFORE), 0.0, -0.5 * DEPTH), size)


def _edge(
    height: float, thickness: float, at: tuple[float, float], width: float, yaw: float
) -> TurnedBox:
    size = (thickness, width, height + DEPTH)
    return TurnedBox((*at, 0.5 * (height - DEPTH)), size, yaw)


def _posts(scenario: Scenario) -> list[TurnedBox]:
    """Return a block under each level piece of the two lanes that crawler2d has drawn."""
    (run,) = simulate_many([scenario.replace({"duration": 0.001})], record="summary", threads=1)
    lanes, xs, ys = (np.asarray(run.edges[name]) for name in ("lane", "x", "y"))
    found = []
    for lane, side in ((1, 1.0), (2, -1.0)):
        corners = np.column_stack([xs, ys])[lanes == lane]
        end = corners[-1, 0] + AFTER
        profile = np.vstack([(-BEFORE, 0.0), corners, (end, 0.0)])
        for box in boxes_of(profile):
            x, _, z = box.center
            length, _, height = box.size
            middle = (x, 0.25 * side * WIDTH, z)
            found.append(TurnedBox(middle, (length, 0.5 * WIDTH, height)))
    return found
