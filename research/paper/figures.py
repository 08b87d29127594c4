"""The paper's Figs. 1 to 14 drawn from the models; Figs. 4 and 5 from runs that stopped."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from crawler2d.common.extras import extra
from crawler2d.drawings.scene import BLACK, BLUE, ORANGE
from crawler2d.drawings.views import robot_alone
from crawler2d.parameters.scenario import Scenario
from crawler2d.parameters.track import SegmentalTrack, Track
from crawler2d.presets import terrains
from crawler2d.presets.robots import engineer
from research.paper.layouts import layouts
from research.paper.phases import grouser_angle

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from crawler2d.parameters.robot import Robot
    from research.paper.stuck import Stuck

__all__ = ["DRAWN", "NOT_DRAWN", "Drawn", "plot_layouts", "plot_stuck"]

_COLUMNS = 3


@dataclass(frozen=True, slots=True, kw_only=True)
class Drawn:
    """A figure of the paper that is drawn from a model."""

    number: int
    caption: str
    track: Track
    view: str = "robot"
    """"robot", "wheel" for its rearmost wheel alone, or "angle" for that with theta."""


def _drawn() -> tuple[Drawn, ...]:
    track = {name: layout.track for name, layout in layouts().items()}
    gears = track["line of 3 gears"]
    return (
        Drawn(number=1, caption="line of wheels that overlap", track=track["line of 5"]),
        Drawn(number=2, caption="line of wheels that touch", track=track["line of 4, touching"]),
        Drawn(number=3, caption="line of wheels with broad spaces", track=track["line of 3"]),
        Drawn(number=6, caption="small wheels, tightly packed", track=track["24 all round"]),
        Drawn(number=7, caption="small wheels with spaces", track=track["16 all round, spaced"]),
        Drawn(number=8, caption="wheels of varying sizes (b)", track=track["hybrid"]),
        Drawn(number=9, caption="chain of shoes on a guide", track=track["chain of 22 shoes"]),
        Drawn(
            number=10,
            caption="chain of shoes round a sprocket",
            track=SegmentalTrack(mechanism="sprocket"),
        ),
        Drawn(number=11, caption="single gear wheel", track=gears, view="wheel"),
        Drawn(
            number=12, caption="small gears all round", track=track["16 gears all round, spaced"]
        ),
        Drawn(number=13, caption="line of large gears", track=gears),
        Drawn(number=14, caption="the angle theta of eq. (1)", track=gears, view="angle"),
    )


DRAWN = _drawn()

NOT_DRAWN = {
    "4": "a run of the simulator; here a replay of a line of large wheels that seizes",
    "5": "a run of the simulator; here a replay of small wheels that seize",
    "8 (a)": "a photograph of another robot, the Talon; its model is that of (b)",
    "15 to 17, 19": "pictures of runs of the simulator; those of Table 2 are runs here",
    "18": "photographs of the real robot",
}
"""What the others show."""


def plot_layouts() -> Figure:
    """Draw the layouts of the figures, one panel each, without flippers.

    Returns
    -------
    Figure
        Not shown and not saved.

    Raises
    ------
    ImportError
        If matplotlib is missing; the message names the extra to install.
    """
    figures = extra("matplotlib.figure", "plot")
    rows = -(-len(DRAWN) // _COLUMNS)
    figure: Figure = figures.Figure(figsize=(4.6 * _COLUMNS, 2.7 * rows), layout="constrained")
    axes = figure.subplots(rows, _COLUMNS, squeeze=False)
    for ax, drawn in zip(axes.flat, DRAWN, strict=True):
        robot = engineer(flippers=None, track=drawn.track)
        if drawn.view == "robot":
            robot.plot(ax).legend().remove()
        else:
            _draw_wheel(ax, robot, with_angle=drawn.view == "angle")
        ax.set_title(f"Fig. {drawn.number}: {drawn.caption}", loc="left", fontsize="medium")
        ax.set(xlabel="", ylabel="")
    figure.suptitle("The paper's figures as models of the Engineer, in its chassis frame [m]")
    return figure


def plot_stuck(found: Sequence[Stuck]) -> Figure:
    """Draw the ends of the runs that stand for Figs. 4 and 5, one panel each."""
    figures = extra("matplotlib.figure", "plot")
    figure: Figure = figures.Figure(figsize=(6.5 * len(found), 4.2), layout="constrained")
    for ax, stuck in zip(figure.subplots(1, len(found), squeeze=False).flat, found, strict=True):
        run = stuck.run
        run.plot(ax, time=run.time[-1], trials=False)
        ax.set_title(f"Fig. {stuck.figure}: {stuck.model}, {stuck.where}", loc="left")
        x, y = run.position[-1]
        ax.set(xlim=(x - 0.35, x + 0.65), ylim=(y - 0.25, y + 0.4))
        ax.get_legend().remove()
    return figure


def _draw_wheel(ax: Axes, robot: Robot, *, with_angle: bool) -> None:
    """Draw the rearmost wheel alone; mark the angle between two of its grousers."""
    scene = robot_alone(Scenario(robot, terrains.flat()).to_json())
    x, radius = -0.5 * robot.outline.axle_distance, robot.outline.rear_radius
    wheel = scene.outline(0, 0) - (x, 0.0)
    ax.fill(*wheel.T, facecolor="none", edgecolor=BLACK, linewidth=1.2)
    ax.plot(0.0, 0.0, "o", color=BLACK, markersize=3.0)
    ax.set_aspect("equal")
    ax.set(xlim=(-2.0 * radius, 2.0 * radius), ylim=(-1.2 * radius, 1.2 * radius))
    if not with_angle:
        return
    first, theta = grouser_angle(wheel)
    arc = first + theta * np.linspace(0.0, 1.0, 41)
    for angle in (first, first + theta):
        ax.plot((0.0, radius * np.cos(angle)), (0.0, radius * np.sin(angle)), color=BLUE)
    ax.plot(0.5 * radius * np.cos(arc), 0.5 * radius * np.sin(arc), color=ORANGE)
    middle, reach = first + 0.5 * theta, 0.64 * radius
    x, y = reach * np.cos(middle), reach * np.sin(middle)
    ax.text(x, y, "\u03b8", color=ORANGE, fontsize=13, ha="center", va="center")
