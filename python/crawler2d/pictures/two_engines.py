"""The same scenario moved by two engines, in one side view."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from crawler2d.drawings.canvas import Canvas
from crawler2d.drawings.outlines import Outlines, draw_goal, draw_ground
from crawler2d.drawings.palette import BLACK, BLUE, ORANGE, PURPLE, RED
from crawler2d.pictures.arrows import draw_forces
from crawler2d.pictures.scenes import scene_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from crawler2d.results.record import Record

__all__ = ["plot_both"]


def plot_both(
    runs: tuple[Record, Record],
    names: tuple[str, str],
    parted_at: float | None,
    ax: Axes | None,
    caption: str,
) -> Axes:
    """Draw both robots where they ended, with their paths; see `CrossCheck.plot`.

    The first is drawn in full, the second by its outlines in a colour; of stops the forces, too.
    """
    first, second = (scene_of(run) for run in runs)
    extents = np.array([scene.extent() for scene in (first, second)])
    left, bottom = extents[:, [0, 2]].min(axis=0)
    right, top = extents[:, [1, 3]].max(axis=0)
    canvas = Canvas(ax, (left, right, bottom, top))
    ax = canvas.ax
    draw_ground(first.lanes, bottom, ax)
    Outlines(first, ax).show(runs[0].time.size - 1)
    label: str | None = f"robot in {names[1]}"
    for body, _ in second.parts(hidden=False):
        line = second.outline(body, runs[1].time.size - 1)
        look: Any = {"color": ORANGE, "linewidth": 1.0, "linestyle": "--", "zorder": 2.5}
        ax.plot(*line.T, label=label, **look)
        label = None  # once is enough
    looks = ((BLUE, RED, "-"), (ORANGE, PURPLE, "--"))
    for run, name, (color, arrows, style) in zip(runs, names, looks, strict=True):
        look = {"color": color, "linestyle": style, "linewidth": 1.2, "zorder": 3}
        ax.plot(*run.position.T, label=f"path in {name}", **look)
        if run.diagnosis is not None:
            draw_forces(run, run.time.size - 1, ax, color=arrows, where=f" in {name}")
    if parted_at is not None:
        where = runs[0].position[np.searchsorted(runs[0].time, parted_at)]
        look = {"marker": "o", "color": BLACK, "linestyle": "none", "markersize": 5, "zorder": 3.5}
        ax.plot(*where[:, None], label=f"1 mm apart, {parted_at:.2f} s", **look)
    if left < first.goal < right:
        draw_goal(first.goal, ax)
    return canvas.caption(runs[0].subject, caption)
