"""The ground inside the track: envelopes of wheels, what is within them, and the edges there."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from crawler2d.common.extras import extra
from crawler2d.drawings.palette import VIOLET
from crawler2d.drawings.plane import SLIVER, closed, inset, placed

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from numpy.typing import NDArray

    from crawler2d.drawings.scene import Carrier, Scene
    from crawler2d.results.record import Record

__all__ = ["Envelopes", "draw_edges"]


class Envelopes:
    """The envelopes of wheels, and the ground inside them, at one sample at a time.

    Parameters
    ----------
    run : Run
        Whose criteria say how deep ground has to be inside.
    scene : Scene
        Its robot and where it is.
    ax : Axes
        Where to draw.
    """

    def __init__(self, run: Record, scene: Scene, ax: Axes) -> None:
        patches = extra("matplotlib.patches", "plot")
        depth = max(run.scenario.criteria.intrusion_depth, SLIVER)
        label: str | None = "envelope (taut belt round the wheels)"
        bottom = min(float(profile[:, 1].min()) for _, profile in scene.lanes) - 1.0
        self._drawn: list[tuple[Carrier, NDArray[np.float64], Any, Any]] = []
        for carrier in scene.carriers:
            if carrier.closed:
                continue
            look: Any = {"color": VIOLET, "linestyle": "--", "linewidth": 0.9, "zorder": 2.5}
            (line,) = ax.plot([], [], label=label, **look)
            label = None  # once is enough
            inner = inset(carrier.envelope, depth)
            clip = patches.Polygon(inner, transform=ax.transData)
            fill: Any = {"color": VIOLET, "alpha": 0.5, "linewidth": 0.0, "zorder": 2.6}
            for _, profile in scene.lanes:
                x, y = profile.T
                ax.fill_between(x, y, bottom, **fill).set_clip_path(clip)
            self._drawn.append((carrier, inner, line, clip))

    def show(self, sample: int) -> None:
        """Move them to a sample."""
        for carrier, inner, line, clip in self._drawn:
            pose = carrier.poses[sample]
            line.set_data(*placed(closed(carrier.envelope), pose).T)
            clip.set_xy(placed(inner, pose))


def draw_edges(run: Record, scene: Scene, sample: int, ax: Axes) -> None:
    """Mark the edges inside the track at one sample."""
    events, time = run.events, run.time[sample]
    inside = events["kind"] == "intrusion"
    inside &= (events["start"] <= time) & (time <= events["end"])
    rows = np.flatnonzero(inside)
    if not rows.size:
        return
    ids, lanes = run.edges["id"], run.edges["lane"]
    edges = [
        np.flatnonzero((ids == events["edge"][row]) & (lanes == events["lane"][row]))[0]
        for row in rows
    ]
    most_loaded = rows[events["force"][rows].argmax()]
    depth, (one, other) = events["depth"][most_loaded], sorted(events["bodies"][most_loaded])
    label = f"edge inside the envelope: {1e3 * depth:.1f} mm"
    # In a chain the edge is between two shoes, not between wheels.
    if one != other and not scene.kinds[one].is_in_chain:
        label += f", between wheels {one} and {other}"
    ax.plot(
        run.edges["x"][edges],
        run.edges["y"][edges],
        linestyle="none",
        marker="D",
        markersize=6,
        markerfacecolor="white",
        markeredgecolor=VIOLET,
        label=label,
        zorder=5,
    )
