"""Plots over time: chassis angle, track speed with its command, and drive force."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from crawler2d.common.extras import extra
from crawler2d.drawings.canvas import checked_axes, set_title
from crawler2d.drawings.palette import BLACK, BLUE, ORANGE, RED
from crawler2d.errors import ScenarioError

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from crawler2d.results.record import Record

__all__ = ["plot_history"]


def plot_history(run: Record, axes: Sequence[Axes] | None) -> tuple[Axes, Axes, Axes]:
    """Draw a run over time; see `Run.plot_history`."""
    time = run.time  # without a history this says so, before there is a figure
    if axes is None:
        pyplot = extra("matplotlib.pyplot", "plot")
        _, axes = pyplot.subplots(3, sharex=True, figsize=(8.0, 5.6), layout="constrained")
    angle, speed, force = _three(axes)
    angle.plot(time, np.degrees(run.chassis_angle), color=BLUE)
    angle.set_ylabel("chassis\nangle [deg]")
    speed.plot(time, run.commanded_speed, color=BLACK, linestyle="--", label="commanded")
    speed.plot(time, run.track_speed, color=BLUE, label="track")
    speed.plot(time, run.velocity[:, 0], color=ORANGE, label="chassis, along x")
    speed.set_ylabel("speed [m/s]")
    force.plot(time, run.drive_force, color=RED)
    force.set(ylabel="drive\nforce [N]", xlabel="time [s]")
    stopped = run.events["kind"] == "stop"
    stops = np.column_stack([run.events["start"], run.events["end"]])[stopped]
    for ax in (angle, speed, force):
        ax.grid(alpha=0.3)
        ax.margins(x=0.0)
        for number, (start, end) in enumerate(stops):
            look: Any = {"color": ORANGE, "alpha": 0.15, "linewidth": 0.0}
            ax.axvspan(start, end, label=None if number else "stopped", **look)
    speed.margins(y=0.25)  # room for the legend
    speed.legend(loc="best", fontsize="small", ncols=4)
    set_title(angle, run.title)
    return angle, speed, force


def _three(axes: Sequence[Axes]) -> tuple[Axes, Axes, Axes]:
    if not isinstance(axes, (tuple, list, np.ndarray)) or len(axes) != 3:
        raise ScenarioError("axes", axes, "must be three Axes")
    angle, speed, force = (checked_axes(ax, f"axes[{row}]") for row, ax in enumerate(axes))
    return angle, speed, force
