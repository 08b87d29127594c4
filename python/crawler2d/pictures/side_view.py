"""The side view of a run: ground, robot, contacts, and the ground inside the track."""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING, Any

import numpy as np

from crawler2d.drawings.canvas import Canvas
from crawler2d.drawings.outlines import Outlines, draw_goal, draw_ground
from crawler2d.drawings.palette import BLUE, GREEN, ORANGE, PURPLE, SKY
from crawler2d.pictures.arrows import draw_forces, draw_slip
from crawler2d.pictures.ghosts import ghost_lines, ghosts
from crawler2d.pictures.inside import Envelopes, draw_edges
from crawler2d.pictures.scenes import scene_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from numpy.typing import ArrayLike, NDArray

    from crawler2d.drawings.scene import Scene
    from crawler2d.pictures.ghosts import Ghost
    from crawler2d.results.record import Record

__all__ = ["plot_run"]

# Of the ends of trials.
_GHOSTS = (SKY, ORANGE, GREEN, PURPLE, "#7F7F7F")
# Most poses of the robot in one side view.
_MOST_DRAWINGS = 7


def plot_run(run: Record, ax: Axes | None, time: ArrayLike | None, *, trials: bool) -> Axes:
    """Draw the ground, the robot at some instants, the path of the chassis origin, and contacts.

    At the last of the instants it also draws the contact forces on the robot, the slip velocities,
    the envelopes of its wheels, and the ground and edges inside these; and, if it is the end of the
    run, where the trials ended that freed the robot. See `Run.plot` for the parameters.
    """
    times = _drawing_times(run) if time is None else np.atleast_1d(np.asarray(time, dtype=float))
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
    canvas = Canvas(ax, (left, right, bottom, top))
    ax = canvas.ax
    draw_ground(scene.lanes, bottom, ax)
    for sample in samples:
        Outlines(scene, ax, alpha=1.0 if sample == shown else 0.3).show(int(sample))
    path: Any = {"color": BLUE, "linewidth": 1.2, "zorder": 3}
    ax.plot(*run.position.T, label="path of the chassis origin", **path)
    _draw_ghosts(freed, scene, ax)
    draw_slip(run, shown, ax)
    draw_forces(run, shown, ax)
    Envelopes(run, scene, ax).show(shown)
    draw_edges(run, scene, shown, ax)
    if left < scene.goal < right:
        draw_goal(scene.goal, ax)
    return canvas.caption(run.title, *filter(None, [run.reason]))


def _draw_ghosts(freed: list[Ghost], scene: Scene, ax: Axes) -> None:
    """Draw where trials that freed the robot ended."""
    looks = itertools.cycle(itertools.product(("-", "--"), _GHOSTS))
    for ghost, (dashes, color) in zip(freed, looks, strict=False):
        label: str | None = f"end of the trial: {ghost.change}"
        for line in ghost_lines(scene, ghost):
            look: Any = {
                "color": color,
                "linestyle": dashes,
                "linewidth": 0.8,
                "alpha": 0.8,
                "zorder": 1.5,
            }
            ax.plot(*line.T, label=label, **look)
            label = None  # once is enough


def _drawing_times(run: Record) -> NDArray[np.float64]:
    """Choose instants about one robot length of travel apart."""
    travelled = np.hypot(*np.diff(run.position, axis=0, prepend=run.position[:1]).T).cumsum()
    outline = run.scenario.robot.outline
    length = outline.axle_distance + outline.front_radius + outline.rear_radius
    count = int(np.clip(round(travelled[-1] / length), 1, _MOST_DRAWINGS - 1)) + 1
    samples = np.searchsorted(travelled, np.linspace(0.0, travelled[-1], count))
    samples[-1] = run.time.size - 1
    return run.time[samples]
