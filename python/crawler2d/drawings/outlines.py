"""Ground and robot as artists of matplotlib; the robot can be moved to another sample."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from crawler2d.common.extras import extra
from crawler2d.drawings.palette import BLACK, GRAY, GREEN, GROUND
from crawler2d.drawings.scene import Look

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from numpy.typing import NDArray

    from crawler2d.drawings.scene import Scene

__all__ = ["Outlines", "draw_goal", "draw_ground"]

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
