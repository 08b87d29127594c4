"""Drawings in the page of an audit: a robot over the shapes of its file, pockets between wheels."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from crawler2d.audits import words
from crawler2d.audits.candidates import left_wheels
from crawler2d.drawings.scene import Scene, extent_of
from crawler2d.drawings.svg import MARGIN, Sheet, draw_robot_on, escape
from crawler2d.errors import ignore_warnings
from crawler2d.parameters.scenario import Scenario
from crawler2d.parameters.settings import Drive
from crawler2d.parameters.terrain import Flat

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from crawler2d.audits.candidates import Pocket
    from crawler2d.parameters.robot import Robot
    from crawler2d.reading.assembly import Silhouette

__all__ = ["draw_pockets", "draw_robot"]

_LARGEST, _SMALLEST = 13.0, 5.0  # [px] height of numbers; smaller ones are unreadable and left out
_LETTER = 0.7  # width of a letter by its height
_TOGETHER = 1e-6  # [m] Wheels closer than this coincide.

_WIDTH = 230.0  # [px] of the widest
_ROUND = 0.04  # margin by the largest width
_CHORDS = 24
_DIGITS = 5  # [m] Pockets equal to 0.01 mm are drawn once.

_SCREEN = (
    "A screen of the geometry, not a verdict: whether ground stays in a pocket depends on the whole"
    " robot, and robots have seized in pockets that these figures call harmless. All are drawn to"
    " one scale, in the frame of the belt, front to the right."
)


def draw_robot(
    robot: Robot,
    title: str,
    shapes: Sequence[Silhouette] = (),
    *,
    width: float = 760.0,
    height: float = 300.0,
) -> str:
    """Draw a robot in the frame of its chassis over collision shapes, as one SVG element.

    `title` is the text for screen readers; `width` and `height` [px] are limits.
    """
    with ignore_warnings():  # a display must not warn
        # At rest, as the usual speed may exceed the robot's.
        scene = Scene.of_robot(Scenario(robot, Flat(), drive=Drive(speed=0.0)).to_json())
    seen = [each.outline for each in shapes if len(each.outline) > 2]
    extent = extent_of(*scene.outlines(0), *seen, margin=MARGIN)
    sheet = Sheet(extent, width, height)
    # Both sides of a robot are equal.
    different = {each.round(6).tobytes(): each for each in seen}
    for outline in different.values():
        sheet.line(outline, 'class="collision"')
    draw_robot_on(sheet, scene)
    _number(sheet, robot)
    return sheet.svg(title)


def _number(sheet: Sheet, robot: Robot) -> None:
    """Write the numbers of the left wheels on them; coinciding wheels share a label."""
    places: dict[tuple[float, float], tuple[float, list[int]]] = {}
    for body, _, x, y, radius in left_wheels(robot):
        near = (each for each in places if math.dist(each, (x, y)) < _TOGETHER)
        place = next(near, (x, y))
        widest, bodies = places.get(place, (0.0, []))
        places[place] = max(widest, radius), [*bodies, body]
    for place, (radius, bodies) in places.items():
        text = ", ".join(map(str, bodies))
        others = [math.dist(place, each) for each in places if each != place]
        room = sheet.scale * min([2.0 * radius, *others])
        size = min(_LARGEST, room / (_LETTER * len(text)))
        if size >= _SMALLEST:
            look = f'class="number" font-size="{size:.1f}" text-anchor="middle" dy="0.36em"'
            sheet.label(place, text, look)


def draw_pockets(robot: Robot, pockets: Sequence[Pocket]) -> str:
    """Draw each different pocket, with the wheels on either side."""
    if not pockets:
        return "<p>None: there are no neighbouring wheels.</p>"
    radii = {wheel.body: wheel.radius for wheel in left_wheels(robot)}
    alike: dict[tuple[float, ...], list[Pocket]] = {}
    for each in pockets:
        rear, front = (radii[body] for body in each.bodies)
        sizes = (each.width, each.gap, rear, front)
        alike.setdefault(tuple(round(size, _DIGITS) for size in sizes), []).append(each)
    span = max(rear + width + front for width, _, rear, front in alike)
    scale = _WIDTH / (span * (1.0 + 2.0 * _ROUND))
    top = 1.1 * max(max(rear, front) for _, _, rear, front in alike)
    figures = "".join(
        _figure(group, rear, front, scale, top) for (_, _, rear, front), group in alike.items()
    )
    return f'<p class="about">{_SCREEN}</p><div class="pockets">{figures}</div>'


def _figure(group: list[Pocket], rear: float, front: float, scale: float, top: float) -> str:
    pocket = group[0]
    margin = _ROUND * _WIDTH / scale
    left, right, bottom = -rear - margin, pocket.width + front + margin, -3.0 * margin
    sheet = Sheet((left, right, bottom, top), scale * (right - left), 1.01 * scale * (top - bottom))
    sheet.line(_open(pocket, rear, front), 'class="open"')
    sheet.circle((0.0, rear), rear, 'class="wheel"')
    sheet.circle((pocket.width, front), front, 'class="wheel"')
    sheet.line([(-rear, 0.0), (pocket.width + front, 0.0)], 'class="belt"', is_closed=False)
    _mark(sheet, pocket, rear, front, margin)
    places = ", ".join("-".join(map(str, each.bodies)) for each in group)
    carriers = " or ".join(dict.fromkeys(each.carrier for each in group))
    title = f"{'slot' if pocket.is_slot else 'pocket'} between wheels {places} of the {carriers}"
    return (
        f"<figure>{sheet.svg(title)}<figcaption><strong>{escape(places)}</strong>"
        f" {escape(carriers)}<br>{escape(_measures(group))}</figcaption></figure>"
    )


def _measures(group: list[Pocket]) -> str:
    pocket = group[0]
    wide = f"{1e3 * pocket.width:.1f} mm wide"
    if pocket.is_slot:
        return f"slot, {wide}, {1e3 * pocket.gap:.1f} mm open: an edge gets through"
    held = words.holding_friction([each.friction for each in group])
    return f"pocket, {wide}, {1e3 * pocket.depth:.1f} mm deep; by its walls alone it holds {held}"


def _bottom(pocket: Pocket, rear: float, front: float) -> tuple[float, float]:
    """[m] Closest or common point of the wheels, from the belt's tangent point on the rear one."""
    if not pocket.is_slot:
        return math.sqrt(max(rear**2 - (rear - pocket.depth) ** 2, 0.0)), pocket.depth
    apart = math.hypot(pocket.width, front - rear)
    part = (rear + 0.5 * pocket.gap) / apart
    return part * pocket.width, rear + part * (front - rear)


def _open(pocket: Pocket, rear: float, front: float) -> NDArray[np.float64]:
    """[m] Outline of the open space: up along the rear wheel, down along the front wheel."""
    x, y = _bottom(pocket, rear, front)
    up = _arc((0.0, rear), rear, math.atan2(x, rear - y))
    down = _arc((pocket.width, front), front, math.atan2(x - pocket.width, front - y))
    return np.vstack([up, down[::-1]])


def _arc(center: tuple[float, float], radius: float, to: float) -> NDArray[np.float64]:
    """[m] Points of a wheel from its lowest one to an angle [rad] from there, > 0 to the front."""
    angles = np.linspace(0.0, to, _CHORDS)
    return np.asarray(center) + radius * np.column_stack([np.sin(angles), -np.cos(angles)])


def _mark(sheet: Sheet, pocket: Pocket, rear: float, front: float, margin: float) -> None:
    """Draw the width below the belt, and the depth above it."""
    level = -1.5 * margin
    sheet.line([(0.0, level), (pocket.width, level)], 'class="measure"', is_closed=False)
    for x in (0.0, pocket.width):
        sheet.line([(x, 0.0), (x, level - 0.5 * margin)], 'class="measure"', is_closed=False)
    if not pocket.is_slot:
        x, y = _bottom(pocket, rear, front)
        sheet.line([(x, 0.0), (x, y)], 'class="measure"', is_closed=False)
