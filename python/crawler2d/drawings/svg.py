"""A scene as inline SVG: small, and without any other package."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from crawler2d.drawings.palette import GRAY, GREEN, GROUND
from crawler2d.drawings.scene import Look

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from crawler2d.drawings.scene import Scene

__all__ = ["svg"]

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
    left, right, bottom, top = extent
    scale = min(_WIDTH / (right - left), _HEIGHT / (top - bottom))
    width, height = scale * (right - left), scale * (top - bottom)

    def pixels(points: NDArray[np.float64]) -> NDArray[np.float64]:
        return scale * (points - (left, top)) * (1.0, -1.0)

    def path(points: NDArray[np.float64], look: str, end: str = "Z") -> str:
        return f'<path d="{_steps(pixels(points))}{end}" {look}/>'

    drawn = []
    if ground:
        for _, profile in scene.lanes:
            inner = profile[(profile[:, 0] > left) & (profile[:, 0] < right)]
            sides = np.interp([left, right], *profile.T)
            line = np.vstack([(left, sides[0]), inner, (right, sides[1])])
            below = np.vstack([line, (right, bottom), (left, bottom)])
            drawn.append(path(below, f'fill="{GROUND}" fill-opacity="0.6" stroke="none"'))
            drawn.append(path(line, _LOOKS[Look.LINE], end=""))
        goal = np.array([(scene.goal, bottom), (scene.goal, top)])
        drawn.append(path(goal, f'stroke="{GREEN}" stroke-dasharray="2 3"', end=""))
    for body, look in scene.parts():
        radius = scene.bodies["radius"][body]
        if np.isnan(radius):
            drawn.append(path(scene.outline(body, 0)[:-1], _LOOKS[look]))
            continue
        x, y = pixels(scene.poses[0, body, :2])
        drawn.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{scale * radius:.1f}" {_LOOKS[look]}/>')
    x, y = pixels(scene.center_of_mass[0])
    drawn.append(f'<path d="M{x - 4:.1f} {y:.1f}h8m-4 -4v8" {_LOOKS[Look.LINE]}/>')
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width:.0f}" height="{height:.0f}"'
        f' viewBox="0 0 {width:.1f} {height:.1f}" role="img">{"".join(drawn)}</svg>'
    )


def _steps(pixels: NDArray[np.float64]) -> str:
    """Write a line as moves in tenths of a pixel; corners that fall together are left out."""
    corners = np.round(pixels, 1)
    moves = np.round(np.diff(corners, axis=0), 1)
    steps = "".join(f"l{x:g} {y:g}" for x, y in moves if x or y)
    return f"M{corners[0, 0]:g} {corners[0, 1]:g}{steps}"
