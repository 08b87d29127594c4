"""Figures of a run: the side view, and plots over time."""

from __future__ import annotations

import textwrap
from typing import TYPE_CHECKING

import numpy as np

from crawler2d.common.extras import extra
from crawler2d.errors import ScenarioError
from crawler2d.pictures.side_view import side_view

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from numpy.typing import ArrayLike, NDArray

    from crawler2d.results.record import Record

__all__ = ["plot_run", "time_strips"]

# The palette of Okabe and Ito, readable for the colour-blind.
_BLACK, _ORANGE, _BLUE, _RED = "#222222", "#E69F00", "#0072B2", "#D55E00"
# Characters per line of the title.
_TITLE_WIDTH = 120
# Most poses of the robot in one side view.
_MOST_DRAWINGS = 7


def plot_run(
    run: Record,
    time: ArrayLike | None = None,
    axes: Axes | tuple[Axes, ...] | None = None,
    *,
    trials: bool = True,
) -> tuple[Axes, ...]:
    """Draw a run; see `Run.plot`."""
    times = _drawing_times(run) if time is None else np.atleast_1d(np.asarray(time, dtype=float))
    if axes is None:
        pyplot = extra("matplotlib.pyplot", "plot")
        figure = pyplot.figure(figsize=(9.0, 9.5), layout="constrained")
        grid = figure.add_gridspec(4, 1, height_ratios=(3.2, 1.0, 1.0, 1.0))
        side = figure.add_subplot(grid[0])
        angle = figure.add_subplot(grid[1])
        strips = (angle, *(figure.add_subplot(grid[row], sharex=angle) for row in (2, 3)))
        axes = (side, *strips)
    elif not isinstance(axes, (tuple, list, np.ndarray)):
        axes = (axes,)
    if len(axes) not in (1, 4):
        raise ScenarioError("axes", f"{len(axes)} axes", "must be one Axes or four")
    # A robot's name may hold a $, which must not start a formula.
    axes[0].set_title(_title(run), loc="left", fontsize="small", parse_math=False)
    side_view(run, times, axes[0], trials=trials)
    if len(axes) == 4:
        time_strips(run, tuple(axes[1:]))
    return tuple(axes)


def time_strips(run: Record, axes: tuple[Axes, ...]) -> None:
    """Draw chassis angle, track speed with its command, and drive force over time.

    Parameters
    ----------
    run : Record
        A run with history.
    axes : tuple of 3 Axes
        Where to draw.
    """
    angle, speed, force = axes
    angle.plot(run.time, np.degrees(run.chassis_angle), color=_BLUE)
    angle.set_ylabel("chassis\nangle [deg]")
    speed.plot(run.time, run.commanded_speed, color=_BLACK, linestyle="--", label="commanded")
    speed.plot(run.time, run.track_speed, color=_BLUE, label="track")
    speed.plot(run.time, run.velocity[:, 0], color=_ORANGE, label="chassis, along x")
    speed.set_ylabel("speed [m/s]")
    speed.legend(loc="best", fontsize="small", ncols=3)
    force.plot(run.time, run.drive_force, color=_RED)
    force.set(ylabel="drive\nforce [N]", xlabel="time [s]")
    stopped = run.events["kind"] == "stop"
    stops = np.column_stack([run.events["start"], run.events["end"]])[stopped]
    for ax in axes:
        ax.grid(alpha=0.3)
        ax.margins(x=0.0)
        for start, end in stops:
            ax.axvspan(start, end, color=_ORANGE, alpha=0.15, linewidth=0.0)
    if len(stops):
        angle.set_title("shaded: stops", loc="right", fontsize="small")


def _title(run: Record) -> str:
    if run.diagnosis is None:
        return run.title
    return f"{run.title}\n{textwrap.fill(str(run.diagnosis), _TITLE_WIDTH)}"


def _drawing_times(run: Record) -> NDArray[np.float64]:
    """Choose instants about one robot length of travel apart."""
    travelled = np.hypot(*np.diff(run.position, axis=0, prepend=run.position[:1]).T).cumsum()
    outline = run.scenario.robot.outline
    length = outline.axle_distance + outline.front_radius + outline.rear_radius
    count = int(np.clip(round(travelled[-1] / length), 1, _MOST_DRAWINGS - 1)) + 1
    samples = np.searchsorted(travelled, np.linspace(0.0, travelled[-1], count))
    samples[-1] = run.time.size - 1
    return run.time[samples]
