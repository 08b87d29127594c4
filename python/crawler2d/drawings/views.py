"""Side views of a robot and of a scenario, as artists of matplotlib."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from crawler2d import _core
from crawler2d.common.bodies import discs_in, end_discs
from crawler2d.common.extras import extra
from crawler2d.drawings.canvas import Canvas, draw_height, draw_length, draw_radius
from crawler2d.drawings.palette import BLACK, GRAY, GREEN, GROUND
from crawler2d.drawings.scene import STYLES, Extent, Look, Scene, close_line, extent_of

if TYPE_CHECKING:
    from collections.abc import Iterable

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

__all__ = [
    "Outlines",
    "draw_goal",
    "draw_lines",
    "draw_robot",
    "draw_scenario",
    "scene_canvas",
]

_ROUND, _BELOW = 0.04, 0.04
"""[-] Margin round a robot, and for each row of dimensions below it, relative to its width."""


class Outlines:
    """The robot of a scene in Axes, at one sample at a time.

    Parameters
    ----------
    scene : Scene
        The robot with its poses.
    ax : Axes
        Where to draw.
    alpha : float
        Opacity.
    inside : bool
        Whether to draw also the wheels inside belts.
    """

    def __init__(self, scene: Scene, ax: Axes, *, alpha: float = 1.0, inside: bool = False) -> None:
        self._scene = scene
        self._lines: list[tuple[int, Any]] = []
        self._fills: list[tuple[int, Any]] = []
        looks = scene.looks if inside else scene.seen
        self._shoes = [body for body, look in looks.items() if look == Look.SHOE]
        for body, look in looks.items():
            color, fill, width = STYLES[look].color, STYLES[look].fill, STYLES[look].width
            if look == Look.SHOE:
                continue
            if fill:
                (area,) = ax.fill([], [], color=color, alpha=fill * alpha, linewidth=0.0, zorder=2)
                self._fills.append((body, area))
            line_look: Any = {"color": color, "linestyle": "-", "linewidth": width}
            (line,) = ax.plot([], [], alpha=alpha, zorder=2, **line_look)
            self._lines.append((body, line))
        if self._shoes:
            # A chain has dozens of pieces; one artist for all of them is fast.
            style = STYLES[Look.SHOE]
            self._chain = extra("matplotlib.collections", "plot").PolyCollection(
                [],
                facecolor=(style.color, style.fill * alpha),
                edgecolor=(style.color, alpha),
                linewidth=style.width,
                zorder=2,
            )
            ax.add_collection(self._chain)
        cross: Any = {"marker": "+", "color": BLACK, "alpha": alpha, "markersize": 8, "zorder": 2.2}
        (self._center,) = ax.plot([], [], **cross)

    def show(self, sample: int) -> None:
        """Move the robot to a sample."""
        scene = self._scene
        for body, line in self._lines:
            line.set_data(*scene.outline(body, sample).T)
        for body, area in self._fills:
            area.set_xy(scene.outline(body, sample))
        if self._shoes:
            self._chain.set_verts([scene.outline(body, sample) for body in self._shoes])
        self._center.set_data(*scene.center_of_mass[sample][:, None])


def scene_canvas(
    scene: Scene, extent: Extent, ax: Axes | None, figure: Figure | None = None
) -> Canvas:
    """Make Axes for an extent of a scene, with its ground; see `Canvas`.

    If there are two lanes, the left one is visible through the right one.
    """
    canvas = Canvas(ax, extent, figure)
    is_far = has_two = len(scene.lanes) > 1
    alpha = 0.6 if is_far else 1.0
    bottom = min(extent[2], *(float(profile[:, 1].min()) for _, profile in scene.lanes)) - 1.0
    for _, profile in scene.lanes:
        fill: Any = {"color": GROUND, "alpha": alpha, "linewidth": 0.0, "zorder": 0}
        canvas.ax.fill_between(profile[:, 0], profile[:, 1], bottom, **fill)
        look: Any = {"linestyle": "-", "linewidth": 1.2}
        if is_far:
            look = {"linestyle": "--", "linewidth": 0.8, "label": "ground of the left track"}
        elif has_two:
            look["label"] = "ground of the right track"
        canvas.ax.plot(*profile.T, color=BLACK, zorder=1, **look)
        is_far = False
    return canvas


def draw_goal(goal: float, ax: Axes) -> None:
    """Mark the position that the rear end of the robot has to reach."""
    ax.axvline(goal, color=GREEN, linestyle=":", label="goal (rear end)")


def draw_lines(
    lines: Iterable[NDArray[np.float64]], ax: Axes, label: str | None, **look: Any
) -> None:
    """Draw lines [m] with a single entry in the legend."""
    for line in lines:
        ax.plot(*line.T, label=label, **look)
        label = None


def draw_scenario(text: str, title: str, ax: Axes | None) -> Axes:
    """Draw a scenario; see `Scenario.plot`.

    Parameters
    ----------
    text : str
        The scenario in JSON.
    title : str
        The text above it.
    ax : Axes or None
        Where to draw; None makes a figure.
    """
    scene = Scene.at_start(text)
    extent = scene.course()
    canvas = scene_canvas(scene, extent, ax)
    Outlines(scene, canvas.ax).show(0)
    _draw_relief(scene, extent[:2], canvas.ax)
    _explain_cross(canvas.ax)
    draw_goal(scene.goal, canvas.ax)
    return canvas.caption(title)


def _draw_relief(scene: Scene, sides: tuple[float, float], ax: Axes) -> None:
    """Draw the largest rise or fall of the ground, measured from where the robot stands."""
    start = float(scene.carriers[0].poses[0, 0])
    base = float(np.interp(start, *scene.lanes[-1][1].T))
    extremes = []
    for x, y in (surface.T for surface in scene.surfaces(*sides)):
        first = int(np.abs(y - base).argmax())
        level = int((np.abs(y[first:] - y[first]) > 1e-9).argmax()) or len(y) - first
        extremes.append((float(y[first]), 0.5 * float(x[first] + x[first + level - 1])))
    top, place = max(extremes, key=lambda each: abs(each[0] - base))
    if abs(top - base) > 1e-6:
        draw_height(ax, place, (base, top))


def _explain_cross(ax: Axes) -> None:
    ax.plot([], [], "+", color=BLACK, markersize=8, label="centre of mass")


class _Arm(NamedTuple):
    """[m] Axles of a flipper, and the start of its dimension line, on the free side of its tip."""

    pivot: NDArray[np.float64]
    tip: NDArray[np.float64]
    start: NDArray[np.float64]


def draw_robot(text: str, title: str, ax: Axes | None) -> Axes:
    """Draw a robot; see `Robot.plot`.

    Parameters
    ----------
    text : str
        A scenario in JSON with the robot on level ground.
    title : str
        The text above it.
    ax : Axes or None
        Where to draw; None makes a figure.
    """
    scenario = json.loads(text)
    robot = scenario["robot"]
    scene, outline = Scene.of_robot(text), _outline(scenario)
    left, right, bottom, top = scene.robot_extent()
    width = right - left
    discs, arms = discs_in(robot["outline"]), _arms(scene, robot)
    # Rows of labels below: radii of inner discs, if they differ from those of the ends; radii of
    # the ends; lengths.
    of_ends = {radius for _, _, radius in end_discs(discs)}
    rows = 2 + any(radius not in of_ends for _, _, radius in discs)
    corners = [(left, bottom - (1 + rows) * _BELOW * width), (right, top)]
    left, right, below, top = extent_of(np.array([*corners, *(each.start for each in arms)]))
    margin = _ROUND * width
    canvas = Canvas(ax, (left - margin, right + margin, below - margin, top + margin))
    ax = canvas.ax
    Outlines(scene, ax, inside=True).show(0)
    # Wheels of other sizes, or with gaps between them, differ from the outline of the real track.
    if not any(_is_same(each, outline) for each in scene.outlines(0)):
        line: Any = {"color": GRAY, "linewidth": 0.8, "linestyle": "--", "zorder": 1.9}
        ax.plot(*outline.T, **line, label="track as built")
    levels = bottom - _BELOW * width * (0.7 + np.arange(rows))
    _draw_dimensions(ax, discs, arms, levels.tolist())
    if Look.BELLY in scene.looks.values():
        color, fill = STYLES[Look.BELLY].color, STYLES[Look.BELLY].fill
        ax.fill([], [], facecolor=(color, fill), edgecolor=color, label="belly")
    _explain_cross(ax)
    return canvas.caption(title)


def _outline(scenario: dict[str, Any]) -> NDArray[np.float64]:
    """[m] Return the closed outline of the track as built, that of a belt."""
    drivetrain = {**scenario["robot"]["drivetrain"], "torque_sharing": "track"}
    belt = {"track": {"kind": "belt"}, "drivetrain": drivetrain, "flippers": None}
    robot = {**scenario["robot"], **belt}
    geometry = _core.geometry(json.dumps({**scenario, "robot": robot}))
    return close_line(geometry["carriers"][0]["envelope"])


def _is_same(one: NDArray[np.float64], other: NDArray[np.float64]) -> bool:
    return one.shape == other.shape and bool(np.allclose(one, other))


def _arms(scene: Scene, robot: dict[str, Any]) -> list[_Arm]:
    """Find the flippers at each end, the front first."""
    (rear, front), arms = end_discs(discs_in(robot["outline"])), []
    for carrier in scene.carriers[1:]:
        pivot = np.array((front if carrier.name.startswith("front") else rear)[:2])
        tip = 2.0 * carrier.poses[0, :2] - pivot
        radius = max(robot["flippers"]["root_radius"], robot["flippers"]["tip_radius"])
        across = np.array([pivot[1] - tip[1], tip[0] - pivot[0]])
        # Below a raised arm, above a lowered one.
        away = across if (across[1] < 0.0) == (tip[1] >= 0.0) else -across
        arms.append(_Arm(pivot, tip, tip + 1.4 * radius * away / np.hypot(*away)))
    return arms


def _draw_dimensions(ax: Axes, discs: Any, arms: list[_Arm], levels: list[float]) -> None:
    """Mark the axles, and draw their distances and radii, equal ones only once.

    `levels` [m] are the heights of the rows of labels, from above.
    """
    rear, front = end_discs(discs)
    of_arms = [point for arm in arms for point in (arm.pivot, arm.tip)]
    axles = np.array([*(disc[:2] for disc in discs), *of_arms])
    ax.plot(*axles.T, "o", color=BLACK, markersize=2.5, zorder=2.5)
    first, (*_, label, line) = levels[0], levels
    # Horizontal, because it is measured along the chassis.
    ends = np.array(rear[:2]), np.array([front[0], rear[1]])
    draw_length(ax, ends, np.array([rear[0], line]), "axle distance")
    middle, inwards = 0.5 * (rear[0] + front[0]), 0.1 * (front[0] - rear[0])
    drawn: set[float] = set()
    for disc in (rear, front, *discs):
        if disc[2] not in drawn:
            aside = inwards if disc[0] <= middle else -inwards
            level = label if disc in (rear, front) else first
            draw_radius(ax, np.array(disc[:2]), disc[2], np.array([disc[0] + aside, level]))
        drawn.add(disc[2])
    for arm in arms[:1]:
        draw_length(ax, (arm.pivot, arm.tip), arm.pivot + arm.start - arm.tip, "flipper")
