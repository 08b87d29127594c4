"""How much of a scene a drawing shows when the robot is at its start."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from crawler2d.drawings.scene import Scene

__all__ = ["course", "robot_box"]

# Of the width of the view: room round what is shown, and above it.
_ROUND, _ABOVE = 0.03, 0.05


def robot_box(scene: Scene) -> tuple[float, float, float, float]:
    """[m] Left, right, bottom and top of what is seen of the robot at the first sample."""
    points = np.concatenate([scene.outline(body, 0) for body, _ in scene.parts()])
    (left, bottom), (right, top) = points.min(axis=0).tolist(), points.max(axis=0).tolist()
    return left, right, bottom, top


def course(scene: Scene) -> tuple[float, float, float, float]:
    """[m] The same of the robot and of the ground that it has to cross to be past the goal."""
    left, right, bottom, top = robot_box(scene)
    length = right - left
    left, right = min(left, scene.goal - length), max(right, scene.goal + length)
    ground = scene.heights(left, right)
    width = right - left
    bottom, top = min(bottom, float(ground.min())), max(top, float(ground.max()))
    margin = _ROUND * width
    return left - margin, right + margin, bottom - margin, top + _ABOVE * width
