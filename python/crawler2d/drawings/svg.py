"""A scene as inline SVG: small, and without any other package."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from crawler2d.drawings.palette import GRAY, GREEN, GROUND
from crawler2d.drawings.scene import Look
from crawler2d.drawings.sheet import Sheet

if TYPE_CHECKING:
    from crawler2d.drawings.scene import Scene

__all__ = ["draw_robot_on", "svg"]

# [px] Largest drawing.
_WIDTH, _HEIGHT = 360.0, 220.0
# Lines take the colour of the text, so that they are seen on a dark page, too.
_LOOKS = {
    Look.BELLY: f'fill="{GREEN}" fill-opacity="0.25" stroke="{GREEN}"',
    Look.HINT: f'fill="none" stroke="{GRAY}"',
    Look.LINE: 'fill="none" stroke="currentColor"',
    Look.SHOE: 'fill="currentColor" fill-opacity="0.5" stroke="currentColor" stroke-width="0.6"',
}


def svg(scene: Scene, extent: tuple[float, float, float, float], *, ground: bool) -> str:
    """Draw the robot of a scene at its first sample.

    Parameters
    ----------
    scene : Scene
        What to draw.
    extent : tuple of 4 floats
        [m] Left, right, bottom and top of the drawing.
    ground : bool
        Whether to draw the ground and the goal.

    Returns
    -------
    str
        One element.
    """
    sheet = Sheet(extent, _WIDTH, _HEIGHT)
    if ground:
        _draw_ground_on(sheet, scene)
    draw_robot_on(sheet, scene)
    return sheet.svg()


def _draw_ground_on(sheet: Sheet, scene: Scene) -> None:
    left, right, bottom, top = sheet.extent
    for _, profile in scene.lanes:
        inner = profile[(profile[:, 0] > left) & (profile[:, 0] < right)]
        sides = np.interp([left, right], *profile.T)
        line = np.vstack([(left, sides[0]), inner, (right, sides[1])])
        below = np.vstack([line, (right, bottom), (left, bottom)])
        sheet.line(below, f'fill="{GROUND}" fill-opacity="0.6" stroke="none"')
        sheet.line(line, _LOOKS[Look.LINE], is_closed=False)
    goal = [(scene.goal, bottom), (scene.goal, top)]
    sheet.line(goal, f'stroke="{GREEN}" stroke-dasharray="2 3"', is_closed=False)


def draw_robot_on(sheet: Sheet, scene: Scene) -> None:
    """Draw the robot of a scene at its first sample, with its centre of mass, on a sheet."""
    for body, look in scene.parts():
        radius = scene.bodies["radius"][body]
        if np.isnan(radius):
            sheet.line(scene.outline(body, 0)[:-1], _LOOKS[look])
        else:
            sheet.circle(scene.poses[0, body, :2], radius, _LOOKS[look])
    sheet.cross(scene.center_of_mass[0], _LOOKS[Look.LINE])
