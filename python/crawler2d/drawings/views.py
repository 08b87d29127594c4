"""Side views of a robot and of a scenario, as artists of matplotlib."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from crawler2d import _core
from crawler2d.common.bodies import discs_in, end_discs
from crawler2d.common.extras import extra
from crawler2d.drawings.canvas import Canvas, height, radius, span
from crawler2d.drawings.scene import (
    BLACK,
    GRAY,
    GREEN,
    GROUND,
    Look,
    Scene,
    at_start,
    closed,
    course,
    on_chassis,
    robot_box,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from numpy.typing import NDArray

__all__ = ["Outlines", "draw_goal", "draw_ground", "draw_robot", "draw_scenario", "robot_alone"]

_COLORS = {Look.BELLY: GREEN, Look.LINE: BLACK, Look.HINT: GRAY}


class Outlines:
    """The robot of a scene in Axes, at one sample at a time.

    Parameters
    ----------
    scene : Scene
        The robot and where it is.
    ax : Axes
        Where to draw.
    alpha : float
        Opacity.
    hidden : bool
        Whether to hint at the wheels within belts.
    """

    def __init__(self, scene: Scene, ax: Axes, *, alpha: float = 1.0, hidden: bool = False) -> None:
        self._scene = scene
        self._lines: list[tuple[int, Any]] = []
        self._fills: list[tuple[int, Any]] = []
        self._shoes: list[int] = []
        for body, look in scene.parts(hidden=hidden):
            if look == Look.SHOE:
                self._shoes.append(body)
                continue
            color = _COLORS[look]
            if look == Look.BELLY:
                fill = ax.fill([], [], color=GREEN, alpha=0.25 * alpha, linewidth=0.0, zorder=2)
                self._fills.append((body, fill[0]))
            (line,) = ax.plot([], [], color=color, alpha=alpha, linewidth=1.0, zorder=2)
            self._lines.append((body, line))
        if self._shoes:
            # A chain has dozens of pieces; one artist for all of them is fast.
            collections = extra("matplotlib.collections", "plot")
            face, edge = (BLACK, 0.5 * alpha), (BLACK, alpha)
            self._chain = collections.PolyCollection(
                [], facecolor=face, edgecolor=edge, linewidth=0.6, zorder=2
            )
            ax.add_collection(self._chain)
        cross: Any = {"marker": "+", "color": BLACK, "alpha": alpha, "markersize": 8, "zorder": 2.2}
        (self._center,) = ax.plot([], [], **cross)

    def show(self, sample: int) -> None:
        """Move the robot to a sample."""
        scene = self._scene
        for body, line in self._lines:
            line.set_data(*scene.outline(body, sample).T)
        for body, fill in self._fills:
            fill.set_xy(scene.outline(body, sample))
        if self._shoes:
            self._chain.set_verts([scene.outline(body, sample) for body in self._shoes])
        self._center.set_data(*scene.center_of_mass[sample][:, None])


def draw_ground(lanes: list[tuple[int, NDArray[np.float64]]], bottom: float, ax: Axes) -> None:
    """Draw the lanes; of two, the left one shows through behind the right one."""
    for lane, (x, y) in ((lane, profile.T) for lane, profile in lanes):
        far = lane == lanes[0][0] and len(lanes) > 1
        alpha = 1.0 if len(lanes) == 1 else 0.6
        ax.fill_between(x, y, bottom - 1.0, color=GROUND, alpha=alpha, linewidth=0.0, zorder=0)
        ax.plot(
            x,
            y,
            color=BLACK,
            linestyle="--" if far else "-",
            linewidth=0.8 if far else 1.2,
            label="left lane" if far else None,
            zorder=1,
        )


def draw_goal(goal: float, ax: Axes) -> None:
    """Mark the place that the rear end of the robot has to reach."""
    ax.axvline(goal, color=GREEN, linestyle=":", label="goal (rear end)")


# Of the width of the view: room round the robot, and for each row of dimensions below it.
_ROUND, _BELOW = 0.04, 0.04


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
    margin, row = _ROUND * (right - left), _BELOW * (right - left)
    room = (1 + _rows(plain["robot"]["outline"])) * row
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
    _draw_dimensions(ax, plain["robot"], arms, (bottom - 0.7 * row, row))
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
    (rear, front), found = end_discs(discs_in(robot["outline"])), []
    for carrier in scene.carriers[1:]:
        pivot = np.array((front if carrier.name.startswith("front") else rear)[:2])
        tip = 2.0 * carrier.poses[0, :2] - pivot
        radii = robot["flippers"]["root_radius"], robot["flippers"]["tip_radius"]
        across = np.array([pivot[1] - tip[1], tip[0] - pivot[0]])
        # Below a raised arm, above a lowered one.
        away = across if (across[1] < 0.0) == (tip[1] >= 0.0) else -across
        beside = tip + 1.4 * max(radii) * away / np.hypot(*away)
        found.append(_Arm(pivot, tip, beside))
    return found


def _rows(outline: dict[str, Any]) -> int:
    """Count the rows of dimensions: radii of discs between the ends, those of the ends, lengths."""
    discs = discs_in(outline)
    of_ends = {radius for _, _, radius in end_discs(discs)}
    return 2 + any(radius not in of_ends for _, _, radius in discs)


def _draw_dimensions(
    ax: Axes, robot: dict[str, Any], arms: list[_Arm], below: tuple[float, float]
) -> None:
    """Mark the axles, and draw their distances and radii; what is equal on several only once.

    `below` [m] are the level of the first row of labels and the height of a row.
    """
    discs = discs_in(robot["outline"])
    rear, front = end_discs(discs)
    of_arms = [point for arm in arms for point in (arm.pivot, arm.tip)]
    axles = np.array([*(disc[:2] for disc in discs), *of_arms])
    ax.plot(*axles.T, "o", color=BLACK, markersize=2.5, zorder=2.5)
    first, height = below
    *_, label, line = (first - row * height for row in range(_rows(robot["outline"])))
    # At one level, because it is measured along the chassis.
    ends = np.array(rear[:2]), np.array([front[0], rear[1]])
    span(ax, ends, np.array([rear[0], line]), "axle distance")
    middle, inwards = 0.5 * (rear[0] + front[0]), 0.1 * (front[0] - rear[0])
    drawn: set[float] = set()
    for disc in (rear, front, *discs):
        if disc[2] not in drawn:
            aside = inwards if disc[0] <= middle else -inwards
            level = label if disc in (rear, front) else first
            radius(ax, np.array(disc[:2]), disc[2], np.array([disc[0] + aside, level]))
        drawn.add(disc[2])
    for arm in arms[:1]:
        shift = arm.beside - arm.tip
        span(ax, (arm.pivot, arm.tip), arm.pivot + shift, "flipper")


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
