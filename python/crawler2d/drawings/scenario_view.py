"""The side view of a scenario: the ground with the robot at its start, and the goal."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from crawler2d.drawings.canvas import Canvas
from crawler2d.drawings.dimensions import height
from crawler2d.drawings.extents import course
from crawler2d.drawings.outlines import Outlines, draw_goal, draw_ground
from crawler2d.drawings.palette import BLACK
from crawler2d.drawings.scene import Scene, at_start

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["draw_scenario"]


def draw_scenario(text: str, title: str, ax: Axes | None) -> Axes:
    """Draw a scenario; see `Scenario.plot`.

    Parameters
    ----------
    text : str
        The scenario in JSON.
    title : str
        What to write over it.
    ax : Axes or None
        Where to draw; None makes a figure.
    """
    scene = Scene(text, at_start(text))
    extent = course(scene)
    canvas = Canvas(ax, extent)
    ax = canvas.ax
    draw_ground(scene.lanes, extent[2], ax)
    Outlines(scene, ax).show(0)
    _draw_height(scene, extent[:2], ax)
    ax.plot([], [], "+", color=BLACK, markersize=8, label="centre of mass")
    draw_goal(scene.goal, ax)
    return canvas.caption(title)


def _draw_height(scene: Scene, sides: tuple[float, float], ax: Axes) -> None:
    """Draw how far the ground rises or falls from where the robot stands, where it does so most."""
    start = float(scene.carriers[0].poses[0, 0])
    base = float(np.interp(start, *scene.lanes[-1][1].T))
    found = []
    for _, profile in scene.lanes:
        inner = (profile[:, 0] > sides[0]) & (profile[:, 0] < sides[1])
        x = np.concatenate([sides[:1], profile[inner, 0], sides[1:]])
        y = np.interp(x, *profile.T)
        y[1:-1] = profile[inner, 1]  # a vertical face has two heights in one place
        first = int(np.abs(y - base).argmax())
        level = int((np.abs(y[first:] - y[first]) > 1e-9).argmax()) or len(y) - first
        found.append((float(y[first]), 0.5 * float(x[first] + x[first + level - 1])))
    top, place = max(found, key=lambda each: abs(each[0] - base))
    if abs(top - base) > 1e-6:
        height(ax, place, (base, top))
