"""The ground in space: blocks across the whole width, turned ones, and those under one track."""

from __future__ import annotations

import math
from dataclasses import dataclass

from benches.models.ground import AFTER, BEFORE, DEPTH, WIDTH, Box, boxes_of, profile_of
from crawler2d.errors import ScenarioError
from crawler2d.parameters.terrain import Barrier, DiagonalBarrier, Lanes, Terrain

__all__ = ["TurnedBox", "blocks_of", "goal_of"]


@dataclass(frozen=True, slots=True)
class TurnedBox(Box):
    """A block that is turned about the vertical.

    Parameters
    ----------
    yaw : float
        [rad] Counter-clockwise seen from above.
    """

    yaw: float = 0.0


def blocks_of(ground: Terrain, gauge: float) -> list[TurnedBox]:
    """Return the ground as blocks.

    Parameters
    ----------
    ground : Terrain
        A level one, a step, a barrier; a diagonal barrier, whose front face the middle of the left
        track meets at x = 0; or lanes with a barrier on the left and level ground on the right.
    gauge : float
        [m] Lateral distance between the tracks.

    Examples
    --------
    >>> level, edge = blocks_of(Lanes(Barrier(0.05, 0.01), Flat()), 0.2)
    >>> edge.center, edge.size
    ((0.005, 1.5, -0.475), (0.01, 3.0, 1.05))
    """
    if isinstance(ground, DiagonalBarrier):
        along, yaw = 0.5 * ground.thickness, ground.yaw
        # The front face passes the middle of the track that meets it first, at x = 0.
        y = math.copysign(0.5 * gauge, yaw)
        at = along * math.cos(yaw), y + along * math.sin(yaw)
        return [_level(), _edge(ground.height, ground.thickness, at, WIDTH, yaw)]
    if isinstance(ground, Lanes):
        left = ground.left
        if not isinstance(left, Barrier):
            raise ScenarioError("terrain.left", left, "must be a barrier")
        at = 0.5 * left.thickness, 0.25 * WIDTH
        return [_level(), _edge(left.height, left.thickness, at, 0.5 * WIDTH, 0.0)]
    return [TurnedBox(box.center, box.size) for box in boxes_of(profile_of(ground))]


def goal_of(ground: Terrain, gauge: float) -> float:
    """[m] Return the x of the last edge that a track meets, in its middle."""
    if isinstance(ground, DiagonalBarrier):
        yaw = abs(ground.yaw)
        return gauge * math.tan(yaw) + ground.thickness / math.cos(yaw)
    if isinstance(ground, Lanes):
        return float(profile_of(ground.left)[-2, 0])
    return float(profile_of(ground)[-2, 0])


def _level() -> TurnedBox:
    size = (BEFORE + AFTER, WIDTH, DEPTH)
    return TurnedBox((0.5 * (AFTER - BEFORE), 0.0, -0.5 * DEPTH), size)


def _edge(
    height: float, thickness: float, at: tuple[float, float], width: float, yaw: float
) -> TurnedBox:
    size = (thickness, width, height + DEPTH)
    return TurnedBox((*at, 0.5 * (height - DEPTH)), size, yaw)
