"""The side view of a run, in one engine or two, and its history over time."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from crawler2d.common.arrays import is_iterable, read_instants
from crawler2d.common.extras import extra
from crawler2d.drawings.canvas import check_axes, set_title
from crawler2d.drawings.palette import BLACK, BLUE, GREEN, ORANGE, PURPLE, RED, SKY, look_of
from crawler2d.drawings.scene import extent_of
from crawler2d.drawings.views import Outlines, draw_goal, draw_lines, scene_canvas
from crawler2d.errors import ScenarioError
from crawler2d.pictures.scenes import (
    Envelopes,
    draw_edges,
    draw_forces,
    draw_slip,
    ghost_lines,
    ghosts,
    scene_of,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from numpy.typing import ArrayLike, NDArray

    from crawler2d.drawings.scene import Scene
    from crawler2d.results.record import Record

__all__ = ["plot_both", "plot_history", "plot_instant", "plot_run"]

_GHOSTS = (SKY, ORANGE, GREEN, PURPLE)
"""Colours of the ends of trials."""

_MOST_POSES = 7
"""Largest number of poses of the robot in one side view."""

_PATH: Any = {"linestyle": "-", "linewidth": 1.2, "zorder": 3}


def plot_run(run: Record, ax: Axes | None, time: ArrayLike | None, *, trials: bool) -> Axes:
    """Draw ground and contacts, the robot at some instants, and the path of the chassis origin.

    At the last instant, also draw the contact forces on the robot, the slip velocities, the
    envelopes of its wheels, and the ground and edges inside them. If this is the end of the run,
    also draw the ends of the trials that freed the robot. See `Run.plot` for the parameters.
    """
    if time is None:
        times = _drawing_times(run)
    else:
        times = read_instants(time, "time", run.time, several=True)
    samples = np.unique([np.abs(run.time - t).argmin() for t in times])
    scene, shown = scene_of(run), int(samples[-1])
    left, right, bottom, top = scene.extent()
    freed = []
    if trials and shown == run.time.size - 1:
        freed = [ghost for ghost in ghosts(run) if ghost.freed and not ghost.from_the_start]
        reach = run.scenario.robot.outline.axle_distance
        ends = [float(ghost.frames[0, 0]) for ghost in freed]
        left = min([left, *(end - reach for end in ends)])
        right = max([right, *(end + reach for end in ends)])
    canvas = scene_canvas(scene, (left, right, bottom, top), ax)
    ax = canvas.ax
    for sample in samples[:-1]:
        Outlines(scene, ax, alpha=0.3).show(int(sample))
    ax.plot(*run.position.T, label="path of the chassis origin", color=BLUE, **_PATH)
    for number, ghost in enumerate(freed):
        look: Any = look_of(number, _GHOSTS) | {"marker": "", "linewidth": 1.0}
        label = f"end of the trial: {ghost.change}"
        draw_lines(ghost_lines(scene, ghost), ax, label, **look, alpha=0.8, zorder=1.5)
    _draw_sample(run, scene, shown, ax)
    draw_edges(run, scene, shown, ax)
    if left < scene.goal < right:
        draw_goal(scene.goal, ax)
    return canvas.caption(run.title, *filter(None, [run.reason]))


def plot_instant(run: Record, ax: Axes | None) -> Axes:
    """Draw ground, robot and contacts at the only sample of a run; see `Simulation.plot`."""
    scene = scene_of(run)
    left, right, _, _ = extent = scene.extent()
    canvas = scene_canvas(scene, extent, ax)
    _draw_sample(run, scene, 0, canvas.ax)
    if left < scene.goal < right:
        draw_goal(scene.goal, canvas.ax)
    return canvas.caption(f"{run.subject}: {run.time[0]:.2f} s")


def _draw_sample(run: Record, scene: Scene, sample: int, ax: Axes) -> None:
    """Draw the robot at a sample, the forces and slip of its contacts, and its envelopes."""
    Outlines(scene, ax).show(sample)
    draw_slip(run, sample, ax)
    draw_forces(run, sample, ax)
    Envelopes(scene, ax).show(sample)


def _drawing_times(run: Record) -> NDArray[np.float64]:
    """Choose instants separated by about one robot length of travel."""
    travelled = np.hypot(*np.diff(run.position, axis=0, prepend=run.position[:1]).T).cumsum()
    outline = run.scenario.robot.outline
    length = outline.axle_distance + outline.front_radius + outline.rear_radius
    count = int(np.clip(round(travelled[-1] / length), 1, _MOST_POSES - 1)) + 1
    samples = np.searchsorted(travelled, np.linspace(0.0, travelled[-1], count))
    samples[-1] = run.time.size - 1
    return run.time[samples]


def plot_both(
    runs: tuple[Record, Record],
    names: tuple[str, str],
    parted_at: float | None,
    ax: Axes | None,
    caption: str,
) -> Axes:
    """Draw both robots at the ends of their runs, with their paths; see `CrossCheck.plot`.

    The first is drawn in full, the second as coloured outlines; stopped robots have their forces.
    """
    first, second = (scene_of(run) for run in runs)
    corners = np.reshape([scene.extent() for scene in (first, second)], (-1, 2, 2))
    left, right, bottom, top = extent_of(*np.swapaxes(corners, 1, 2))
    canvas = scene_canvas(first, (left, right, bottom, top), ax)
    ax = canvas.ax
    Outlines(first, ax).show(runs[0].time.size - 1)
    look: Any = {"color": ORANGE, "linewidth": 1.0, "linestyle": "--", "zorder": 2.5}
    draw_lines(second.outlines(runs[1].time.size - 1), ax, f"robot in {names[1]}", **look)
    # The line that is drawn first is broader, so that it remains visible where both coincide.
    looks: Any = (
        ({"color": BLUE, "linewidth": 2.4}, {"color": RED, "width": 0.007}),
        ({"color": ORANGE, "linestyle": "--"}, {"color": PURPLE}),
    )
    for run, name, (path, arrows) in zip(runs, names, looks, strict=True):
        ax.plot(*run.position.T, label=f"path in {name}", **_PATH | path)
        if run.diagnosis is not None:
            draw_forces(run, run.time.size - 1, ax, where=f" in {name}", **arrows)
    if parted_at is not None:
        where = runs[0].position[np.searchsorted(runs[0].time, parted_at)]
        look = {"marker": "o", "color": BLACK, "linestyle": "none", "markersize": 5, "zorder": 3.5}
        ax.plot(*where[:, None], label=f"1 mm apart, {parted_at:.2f} s", **look)
    if left < first.goal < right:
        draw_goal(first.goal, ax)
    return canvas.caption(runs[0].subject, caption)


def plot_history(run: Record, axes: Sequence[Axes] | None) -> tuple[Axes, Axes, Axes]:
    """Draw a run over time; see `Run.plot_history`."""
    time = run.time  # raises an error without a history, before a figure is made
    if axes is None:
        pyplot = extra("matplotlib.pyplot", "plot")
        _, axes = pyplot.subplots(3, sharex=True, figsize=(8.0, 5.6), layout="constrained")
    if not is_iterable(axes) or len(axes := tuple(axes)) != 3:
        raise ScenarioError("axes", axes, "must be three Axes")
    angle, speed, force = (check_axes(ax, f"axes[{row}]") for row, ax in enumerate(axes))
    angle.plot(time, np.degrees(run.chassis_angle), "-", color=BLUE)
    angle.set_ylabel("chassis\nangle [deg]")
    speed.plot(time, run.track_speed, "-", color=BLUE, linewidth=2.5, label="track")
    speed.plot(time, run.velocity[:, 0], "-", color=ORANGE, label="chassis, along x")
    look: Any = {"color": BLACK, "linestyle": "--", "linewidth": 1.0}
    speed.plot(time, run.commanded_speed, **look, label="commanded")
    speed.set_ylabel("speed [m/s]")
    force.plot(time, run.drive_force, "-", color=RED)
    force.set(ylabel="drive\nforce [N]", xlabel="time [s]")
    stopped = run.events["kind"] == "stop"
    stops = np.column_stack([run.events["start"], run.events["end"]])[stopped]
    for ax in (angle, speed, force):
        ax.grid(alpha=0.3)
        ax.margins(x=0.0)
        for number, (start, end) in enumerate(stops):
            look = {"color": ORANGE, "alpha": 0.15, "linewidth": 0.0}
            ax.axvspan(start, end, label=None if number else "stopped", **look)
    # Above the strip, where it covers no line.
    above: Any = {"loc": "lower left", "bbox_to_anchor": (0.0, 1.0), "frameon": False}
    speed.legend(**above, fontsize="small", ncols=4, borderaxespad=0.0)
    set_title(angle, run.title)
    return angle, speed, force
