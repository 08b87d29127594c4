"""The robot of an audit in side view, its wheels numbered, over the shapes of its file."""

from __future__ import annotations

import math
import warnings
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from crawler2d.drawings.extents import robot_box
from crawler2d.drawings.robot_view import robot_alone
from crawler2d.drawings.sheet import Sheet
from crawler2d.drawings.svg import draw_robot_on
from crawler2d.parameters.scenario import Scenario
from crawler2d.parameters.terrain import Flat

if TYPE_CHECKING:
    from crawler2d.parameters.robot import Robot
    from crawler2d.reading.silhouettes import Silhouette

__all__ = ["robot_drawn"]

_MARGIN = 0.02  # of the width
_LARGEST, _SMALLEST = 13.0, 5.0  # [px] of numbers; smaller ones cannot be read and are left out
_LETTER = 0.6  # of the size: how wide a letter is
_TOGETHER = 1e-6  # [m] Wheels nearer than this are in one place.


def robot_drawn(
    robot: Robot,
    title: str,
    shapes: Sequence[Silhouette] = (),
    *,
    width: float = 1100.0,
    height: float = 520.0,
) -> str:
    """Draw a robot in the frame of its chassis.

    Parameters
    ----------
    robot : Robot
        The robot, flippers at their `angle`.
    title : str
        What it shows, for those who cannot see it.
    shapes : sequence of Silhouette
        Collision shapes to draw below it.
    width, height : float
        [px] The most that it may have.

    Returns
    -------
    str
        One SVG element.
    """
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # a look at something is no call to be warned of
        scene = robot_alone(Scenario(robot, Flat()).to_json())
    seen = [each.outline for each in shapes if len(each.outline) > 2]
    left, right, bottom, top = robot_box(scene)
    corners = np.concatenate([[(left, bottom), (right, top)], *seen])
    (left, bottom), (right, top) = corners.min(axis=0).tolist(), corners.max(axis=0).tolist()
    margin = _MARGIN * (right - left)
    extent = (left - margin, right + margin, bottom - margin, top + margin)
    sheet = Sheet(extent, width, height)
    for outline in _different(seen):
        sheet.line(outline, 'class="collision"')
    draw_robot_on(sheet, scene)
    _number(sheet, robot)
    return sheet.svg(title)


def _different(outlines: list[np.ndarray[tuple[int, int]]]) -> list[np.ndarray[tuple[int, int]]]:
    """Leave out what lies on what is there: the two sides of a robot are the same."""
    found = {tuple(each.round(6).ravel().tolist()): each for each in outlines}
    return list(found.values())


def _number(sheet: Sheet, robot: Robot) -> None:
    """Write the numbers of the wheels of the left side on them; several in one place together."""
    table = robot.wheels()
    left = table["side"] == "left"
    columns = (table[name][left].tolist() for name in ("x", "y", "radius", "body"))
    places: dict[tuple[float, float], tuple[float, list[int]]] = {}
    for x, y, radius, body in zip(*columns, strict=True):
        near = (each for each in places if math.dist(each, (x, y)) < _TOGETHER)
        place = next(near, (x, y))
        widest, bodies = places.get(place, (0.0, []))
        places[place] = max(widest, radius), [*bodies, int(body)]
    for place, (radius, bodies) in places.items():
        text = ", ".join(map(str, bodies))
        others = [math.dist(place, each) for each in places if each != place]
        room = sheet.scale * min([2.0 * radius, *others])
        size = min(_LARGEST, room / (_LETTER * len(text)))
        if size >= _SMALLEST:
            look = f'class="number" font-size="{size:.1f}" text-anchor="middle" dy="0.36em"'
            sheet.label(place, text, look)
