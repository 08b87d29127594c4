"""Scenes as inline SVG, and cards that show robots and scenarios in notebooks."""

from __future__ import annotations

import html
import json
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

import numpy as np

from crawler2d.common.bodies import discs_in, end_discs, is_centered_pair
from crawler2d.drawings.palette import BLACK, GREEN, GROUND
from crawler2d.drawings.scene import STYLES, Extent, Look, Scene, extent_of
from crawler2d.errors import ignore_warnings

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

__all__ = [
    "MARGIN",
    "Sheet",
    "draw_robot_on",
    "escape",
    "robot_card",
    "scenario_card",
    "table",
]

MARGIN = 0.02
"""[-] Margin round a drawing, as a fraction of its width."""

_WIDTH, _HEIGHT = 360.0, 220.0
"""[px] Largest drawing of a card."""


def escape(text: str) -> str:
    """Escape a text for HTML, and make it valid UTF-8."""
    return html.escape(text.encode("utf-8", "replace").decode())


def table(rows: Iterable[tuple[str, str]]) -> str:
    """Return HTML with a row for each name and value; empty if there are none."""
    body = "".join(
        f"<tr><th>{escape(name)}</th><td>{escape(value)}</td></tr>" for name, value in rows
    )
    return f"<table><tbody>{body}</tbody></table>" if body else ""


class Sheet:
    """A drawing of a part of the plane, as large as fits into a width and a height.

    Parameters
    ----------
    extent : tuple of 4 floats
        [m] Left, right, bottom and top.
    width, height : float
        [px] Largest size of the drawing.

    Examples
    --------
    >>> sheet = Sheet((0.0, 2.0, -0.5, 0.5), width=100.0, height=100.0)
    >>> sheet.line([(0.0, 0.0), (1.0, 0.0), (1.0, 0.5)], 'fill="none"', is_closed=False)
    >>> sheet.svg()
    '<svg xmlns="http://www.w3.org/2000/svg" width="100" height="50" viewBox="0 0 100.0 50.0"\
 role="img"><path d="M0 25l50 0l0 -25" fill="none"/></svg>'
    """

    def __init__(self, extent: Extent, width: float, height: float) -> None:
        left, right, bottom, top = extent
        self.extent = extent
        self.scale = min(width / (right - left), height / (top - bottom))
        self._size = self.scale * (right - left), self.scale * (top - bottom)
        self._drawn: list[str] = []

    def pixels(self, points: ArrayLike) -> NDArray[np.float64]:
        """[px] Return the positions of points, shape (..., 2), from the upper left corner."""
        left, _, _, top = self.extent
        moved: NDArray[np.float64] = self.scale * (np.asarray(points) - (left, top)) * (1.0, -1.0)
        return moved

    def line(self, points: ArrayLike, look: str, *, is_closed: bool = True) -> None:
        """Draw a line through points [m]; `look` has SVG attributes."""
        self._drawn.append(f'<path d="{_steps(self.pixels(points))}{"Z" * is_closed}" {look}/>')

    def circle(self, center: ArrayLike, radius: float, look: str) -> None:
        """Draw a circle [m]."""
        x, y = self.pixels(center)
        self._drawn.append(
            f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{self.scale * radius:.1f}" {look}/>'
        )

    def cross(self, place: ArrayLike, look: str) -> None:
        """Mark a point [m] with a cross."""
        x, y = self.pixels(place)
        self._drawn.append(f'<path d="M{x - 4:.1f} {y:.1f}h8m-4 -4v8" {look}/>')

    def label(self, place: ArrayLike, text: str, look: str) -> None:
        """Write a text with its baseline at a point [m]."""
        x, y = self.pixels(place)
        self._drawn.append(f'<text x="{x:.1f}" y="{y:.1f}" {look}>{escape(text)}</text>')

    def svg(self, title: str = "") -> str:
        """Return one element; `title` describes it to those who cannot see it."""
        width, height = self._size
        label = f' aria-label="{escape(title)}"' if title else ""
        return (
            f'<svg xmlns="http://www.w3.org/2000/svg" width="{width:.0f}" height="{height:.0f}"'
            f' viewBox="0 0 {width:.1f} {height:.1f}" role="img"{label}>'
            f"{''.join(self._drawn)}</svg>"
        )


def _steps(pixels: NDArray[np.float64]) -> str:
    """Write a line as moves in tenths of a pixel, without repeated corners."""
    corners = np.round(pixels, 1)
    moves = np.round(np.diff(corners, axis=0), 1)
    steps = "".join(f"l{x:g} {y:g}" for x, y in moves if x or y)
    return f"M{corners[0, 0]:g} {corners[0, 1]:g}{steps}"


def draw_robot_on(sheet: Sheet, scene: Scene) -> None:
    """Draw the robot of a scene at its first sample, with its centre of mass, on a sheet."""
    for body, look in scene.seen.items():
        radius = scene.bodies["radius"][body]
        if np.isnan(radius):
            sheet.line(scene.outline(body, 0)[:-1], _attributes(look))
        else:
            sheet.circle(scene.poses[0, body, :2], radius, _attributes(look))
    sheet.cross(scene.center_of_mass[0], _attributes(Look.WHEEL))


def _draw_ground_on(sheet: Sheet, scene: Scene) -> None:
    left, right, bottom, top = sheet.extent
    for surface in scene.surfaces(left, right):
        below = np.vstack([surface, (right, bottom), (left, bottom)])
        sheet.line(below, f'fill="{GROUND}" fill-opacity="0.6" stroke="none"')
        sheet.line(surface, _attributes(Look.WHEEL), is_closed=False)
    goal = [(scene.goal, bottom), (scene.goal, top)]
    sheet.line(goal, f'stroke="{GREEN}" stroke-dasharray="2 3"', is_closed=False)


def _attributes(look: Look) -> str:
    """Write a look as attributes; black becomes the text's colour, visible on dark pages, too."""
    style = STYLES[look]
    color = "currentColor" if style.color == BLACK else style.color
    fill = f'fill="{color}" fill-opacity="{style.fill}"' if style.fill else 'fill="none"'
    width = "" if style.width == 1.0 else f' stroke-width="{style.width:g}"'
    return f'{fill} stroke="{color}"{width}'


def robot_card(text: str, title: str) -> str:
    """Show the robot of a scenario in JSON, in the frame of its chassis.

    Parameters
    ----------
    text : str
        A scenario with the robot on level ground.
    title : str
        The text above it.

    Returns
    -------
    str
        HTML.

    Raises
    ------
    ScenarioError
        If the robot breaks a rule.
    """
    with ignore_warnings():  # showing an object must not warn
        scene = Scene.of_robot(text)
    sheet = Sheet(extent_of(*scene.outlines(0), margin=MARGIN), _WIDTH, _HEIGHT)
    draw_robot_on(sheet, scene)
    return _card(title, sheet, _robot_rows(json.loads(text)["robot"]))


def scenario_card(text: str, title: str, terrain: str) -> str:
    """Show a scenario in JSON with the robot at its start; `terrain` describes the ground in words.

    The rest is as for `robot_card`.
    """
    with ignore_warnings():
        scene = Scene.at_start(text)
    sheet = Sheet(scene.course(), _WIDTH, _HEIGHT)
    _draw_ground_on(sheet, scene)
    draw_robot_on(sheet, scene)
    scenario = json.loads(text)
    gait, ground = scenario["drive"]["gait"], scenario["terrain"]
    lanes = [lane for lane in map(ground.get, ("left", "right")) if lane] or [ground]
    rows = [
        ("terrain", terrain),
        ("friction", _friction_of(lanes)),
        ("speed", f"{scenario['drive']['speed']:.4g} m/s"),
        *([("gait", gait["kind"])] if gait else []),
        ("goal", f"x = {scene.goal:.4g} m"),
        ("duration", f"at most {scenario['duration']:.4g} s"),
        ("mass", f"{scenario['robot']['mass']:.4g} kg"),
    ]
    return _card(title, sheet, rows)


def _friction_of(lanes: list[dict[str, Any]]) -> str:
    """List the friction coefficients of the ground; of more than two only the range."""
    segments = [lane.get("segment_friction") or [lane["friction"]] for lane in lanes]
    values = {value for each in segments for value in each}
    return _listed(values) if len(values) <= 2 else f"{min(values):.4g} to {max(values):.4g}"


def _card(title: str, sheet: Sheet, rows: list[tuple[str, str]]) -> str:
    return (
        f"<div><p><strong>{escape(title)}</strong></p>"
        '<div style="display: flex; flex-wrap: wrap; align-items: center; gap: 1.5em">'
        f"{sheet.svg()}{table(rows)}</div></div>"
    )


def _robot_rows(robot: dict[str, Any]) -> list[tuple[str, str]]:
    outline, drivetrain, flippers = robot["outline"], robot["drivetrain"], robot["flippers"]
    x, y = robot["center_of_mass"]
    discs = discs_in(outline)
    (rear, _, _), (front, _, _) = end_discs(discs)
    origin = "midway between the axles" if is_centered_pair(discs) else "the origin of the discs"
    rows = [
        ("mass", f"{robot['mass']:.4g} kg, of which tracks {robot['track_mass']:.3g} kg"),
        ("centre of mass", f"({x:.3f}, {y:.3f}) m from {origin}"),
        ("moment of inertia", f"{robot['moment_of_inertia']:.3g} kg m²"),
        ("axle distance", f"{front - rear:.4g} m"),
        ("radius", f"{_listed({radius for _, _, radius in discs})} m"),
    ]
    if outline["grouser_height"] > 0.0:
        height, pitch = outline["grouser_height"], outline["grouser_pitch"]
        rows.append(("grousers", f"{height:.3g} m high, {pitch:.3g} m apart"))
    if flippers:
        ends = {"both": "at both ends"}.get(flippers["ends"], f"at the {flippers['ends']}")
        rows.append(("flippers", f"{flippers['length']:.3g} m long, {ends}"))
    rows.append(("speed", f"up to {drivetrain['max_speed']:.3g} m/s"))
    rows.append(("torque", f"up to {drivetrain['max_torque']:.3g} N m a sprocket"))
    return rows


def _listed(values: set[float]) -> str:
    return " and ".join(f"{value:.4g}" for value in sorted(values))
