"""The side view of a robot by itself, in the frame of its chassis, with its dimensions."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from crawler2d import _core
from crawler2d.drawings.canvas import Canvas
from crawler2d.drawings.dimensions import radius, span
from crawler2d.drawings.extents import robot_box
from crawler2d.drawings.outlines import Outlines
from crawler2d.drawings.palette import BLACK, GRAY, GREEN
from crawler2d.drawings.plane import closed
from crawler2d.drawings.scene import Look, Scene, at_start, on_chassis

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from numpy.typing import NDArray

__all__ = ["draw_robot", "robot_alone"]

# Of the width of the view: room round the robot, and below it for dimensions.
_ROUND, _BELOW = 0.04, 0.11


def robot_alone(text: str) -> Scene:
    """Put the robot of a scenario in JSON into the frame of its chassis, as it is at time 0."""
    return Scene(text, on_chassis(at_start(text)))


def draw_robot(text: str, title: str, ax: Axes | None) -> Axes:
    """Draw a robot; see `Robot.plot`.

    Parameters
    ----------
    text : str
        A scenario in JSON with the robot on level ground.
    title : str
        What to write over it.
    ax : Axes or None
        Where to draw; None makes a figure.
    """
    plain = json.loads(text)
    scene, outline = robot_alone(text), _outline(plain)
    left, right, bottom, top = robot_box(scene)
    margin, room = _ROUND * (right - left), _BELOW * (right - left)
    arms = _arms(scene, plain["robot"])
    reached = np.array([(left, bottom - room), (right, top), *(each.beside for each in arms)])
    (left, below), (right, top) = reached.min(axis=0).tolist(), reached.max(axis=0).tolist()
    canvas = Canvas(ax, (left - margin, right + margin, below - margin, top + margin))
    ax = canvas.ax
    Outlines(scene, ax, hidden=True).show(0)
    # Wheels of another size, or spaced ones, leave the outline of the real track.
    if not any(_is_same(scene.outline(body, 0), outline) for body, _ in scene.parts()):
        line: Any = {"color": GRAY, "linewidth": 0.8, "linestyle": "--", "zorder": 1.9}
        ax.plot(*outline.T, **line, label="track as built")
    levels = bottom - 0.25 * room, bottom - 0.55 * room
    _draw_dimensions(ax, plain["robot"], arms, levels)
    if any(look == Look.BELLY for _, look in scene.parts()):
        ax.fill([], [], facecolor=(GREEN, 0.25), edgecolor=GREEN, label="belly")
    ax.plot([], [], "+", color=BLACK, markersize=8, label="centre of mass")
    return canvas.caption(title)


def _outline(plain: dict[str, Any]) -> NDArray[np.float64]:
    """[m] The closed outline of the track as built: that of a belt."""
    robot = {**plain["robot"], "track": {"kind": "belt"}, "flippers": None}
    geometry = _core.geometry(json.dumps({**plain, "robot": robot}))
    return closed(geometry["carriers"][0]["envelope"])


def _is_same(one: NDArray[np.float64], other: NDArray[np.float64]) -> bool:
    return one.shape == other.shape and bool(np.allclose(one, other))


@dataclass(frozen=True, slots=True)
class _Arm:
    """[m] Axles of a flipper, and where its dimension goes: beside it, on its free side."""

    pivot: NDArray[np.float64]
    tip: NDArray[np.float64]
    beside: NDArray[np.float64]


def _arms(scene: Scene, robot: dict[str, Any]) -> list[_Arm]:
    """Find the flippers at each end, the front first."""
    half, found = 0.5 * robot["outline"]["axle_distance"], []
    for carrier in scene.carriers[1:]:
        pivot = np.array([half if carrier.name.startswith("front") else -half, 0.0])
        tip = 2.0 * carrier.poses[0, :2] - pivot
        radii = robot["flippers"]["root_radius"], robot["flippers"]["tip_radius"]
        across = np.array([pivot[1] - tip[1], tip[0] - pivot[0]])
        # Below a raised arm, above a lowered one.
        away = across if (across[1] < 0.0) == (tip[1] >= 0.0) else -across
        beside = tip + 1.4 * max(radii) * away / np.hypot(*away)
        found.append(_Arm(pivot, tip, beside))
    return found


def _draw_dimensions(
    ax: Axes, robot: dict[str, Any], arms: list[_Arm], levels: tuple[float, float]
) -> None:
    """Mark the axles, and draw their distances and radii; what is equal at both ends only once.

    `levels` [m] are those of the labels of radii and of the distance of the end axles.
    """
    outline = robot["outline"]
    front = np.array([0.5 * outline["axle_distance"], 0.0])
    axles = np.array([-front, front, *(point for arm in arms for point in (arm.pivot, arm.tip))])
    ax.plot(*axles.T, "o", color=BLACK, markersize=2.5, zorder=2.5)
    half, (label, line) = front[0], levels
    span(ax, (-front, front), np.array([-half, line]), "axle distance")
    radius(ax, -front, outline["rear_radius"], np.array([-0.8 * half, label]))
    if outline["front_radius"] != outline["rear_radius"]:
        radius(ax, front, outline["front_radius"], np.array([0.8 * half, label]))
    for arm in arms[:1]:
        shift = arm.beside - arm.tip
        span(ax, (arm.pivot, arm.tip), arm.pivot + shift, "flipper")
