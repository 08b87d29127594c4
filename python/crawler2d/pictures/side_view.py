"""The side view of a run: ground, robot, what bears and what is inside the track."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from crawler2d import _core
from crawler2d.common.extras import extra
from crawler2d.pictures.shapes import (
    SLIVER,
    carrier_of,
    carriers,
    closed,
    extent,
    inset,
    mass_center,
    outlines,
    placed,
    seen_lanes,
    shoes,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from numpy.typing import NDArray

    from crawler2d.results.record import Record

__all__ = ["side_view"]

# Okabe and Ito's palette: told apart by colour-blind readers.
_BLACK, _BLUE, _RED, _GREEN = "#222222", "#0072B2", "#D55E00", "#009E73"
_GROUND, _PURPLE, _GUIDE = "#D9D2C5", "#A3327B", "#AAAAAA"

# A contact force as large as the weight is drawn as long as this share of the axle distance, and a
# larger one of a robot that wedges itself in no longer.
_FORCE_LENGTH = 0.6
# The same of a surface that passes the ground at the commanded speed, or of the fastest beyond it.
_SPEED_LENGTH = 0.22
# They lie so far inside the ground, as a share of the axle distance, where they hide nothing.
_BELOW = 0.03
# Shorter arrows, as a share of the longest one there can be, would be mere dots.
_SHORTEST = 0.02


def side_view(run: Record, times: NDArray[np.float64], ax: Axes) -> None:
    """Draw ground, robot at some instants, path of the chassis origin, and what holds the robot.

    At the last of the instants the contacts are drawn, with their forces on the robot and the
    speeds of its surface over the ground, the taut belts round its wheels, and the ground and the
    edges inside those belts.

    Parameters
    ----------
    run : Record
        A run with history.
    times : ndarray, shape (k,)
        [s] When to draw the robot; the nearest samples are taken.
    ax : Axes
        Where to draw.
    """
    geometry = _core.geometry(run.scenario.to_json())
    lanes = seen_lanes(geometry)
    samples = np.unique([np.abs(run.time - t).argmin() for t in times])
    left, right, bottom, top = extent(run, geometry)
    _draw_ground(lanes, bottom, ax)
    for sample in samples:
        last = sample == samples[-1]
        _draw_robot(run, geometry, int(sample), ax, alpha=1.0 if last else 0.3)
    ax.plot(
        run.position[:, 0],
        run.position[:, 1],
        color=_BLUE,
        linewidth=1.2,
        label="path of the chassis origin",
        zorder=3,
    )
    shown = int(samples[-1])
    _draw_contacts(run, shown, ax)
    _draw_envelopes(run, geometry, shown, ax)
    _draw_intrusions(run, geometry, shown, ax)
    if left < geometry["goal"] < right:
        ax.axvline(geometry["goal"], color=_GREEN, linestyle=":", label="goal for the rear end")
    ax.set(xlim=(left, right), ylim=(bottom, top), xlabel="x [m]", ylabel="y [m]", aspect="equal")
    # A raised flipper may be behind the rear end, in the corner that is else free.
    corner: Literal["best", "upper left"] = "best" if geometry["flippers"] else "upper left"
    ax.legend(loc=corner, fontsize="small", framealpha=0.9)


def _draw_ground(lanes: list[tuple[int, NDArray[np.float64]]], bottom: float, ax: Axes) -> None:
    """Draw the lanes; of two, the left one shows through behind the right one."""
    for lane, (x, y) in ((lane, profile.T) for lane, profile in lanes):
        far = lane == lanes[0][0] and len(lanes) > 1
        alpha = 1.0 if len(lanes) == 1 else 0.6
        ax.fill_between(x, y, bottom - 1.0, color=_GROUND, alpha=alpha, linewidth=0.0, zorder=0)
        ax.plot(
            x,
            y,
            color=_BLACK,
            linestyle="--" if far else "-",
            linewidth=0.8 if far else 1.2,
            label="left lane" if far else None,
            zorder=1,
        )


def _draw_robot(
    run: Record, geometry: dict[str, Any], sample: int, ax: Axes, *, alpha: float
) -> None:
    if len(geometry["belly"]):  # first: the wheels lie before it
        x, y = closed(placed(run, sample, geometry["belly"])).T
        ax.fill(x, y, color=_GREEN, alpha=0.25 * alpha, linewidth=0.0, zorder=2)
        ax.plot(x, y, color=_GREEN, alpha=alpha, linewidth=1.0, zorder=2)
    for carrier in carriers(run, geometry):
        # What shoes run on is no more than a hint behind them, but for the sprocket.
        usual = _GUIDE if carrier.track.get("shoes") else _BLACK
        first = _BLACK if carrier.track.get("sprocket") else usual
        for k, outline in enumerate(outlines(carrier, sample)):
            color = usual if k else first
            ax.plot(*outline.T, color=color, alpha=alpha, linewidth=1.0, zorder=2)
    _draw_shoes(run, geometry, sample, ax, alpha=alpha)
    center = placed(run, sample, mass_center(run, geometry, sample)[None])
    ax.plot(*center.T, marker="+", color=_BLACK, alpha=alpha, markersize=8, zorder=2)


def _draw_shoes(
    run: Record, geometry: dict[str, Any], sample: int, ax: Axes, *, alpha: float
) -> None:
    """Fill the shoes; a chain has hundreds of them in all poses, and one artist a pose is fast."""
    pieces = shoes(run, geometry, sample)
    if not pieces:
        return
    collections = extra("matplotlib.collections", "plot")
    ax.add_collection(
        collections.PolyCollection(
            pieces,
            facecolor=(_BLACK, 0.5 * alpha),
            edgecolor=(_BLACK, alpha),
            linewidth=0.6,
            zorder=2,
        )
    )


def _draw_contacts(run: Record, sample: int, ax: Axes) -> None:
    """Arrows of the forces on the robot and of the speeds of its surface, at one sample."""
    contacts = run.contacts
    now = contacts["time"] == run.time[sample]
    if not now.any():
        return
    robot = run.scenario.robot
    places = np.column_stack([contacts["x"], contacts["y"]])[now]
    normal = np.column_stack([contacts["normal_x"], contacts["normal_y"]])[now]
    tangent = np.column_stack([normal[:, 1], -normal[:, 0]])
    speed = contacts["surface_speed"][now, None] * tangent
    below = places - _BELOW * robot.outline.axle_distance * normal
    usual, length = abs(run.scenario.drive.speed), _SPEED_LENGTH * robot.outline.axle_distance
    label = "surface over the ground, longest {:.2f} m/s"
    _draw_arrows(ax, below, speed, (usual, length), color=_BLUE, label=label)
    force = contacts["normal_force"][now, None] * normal
    force = force + contacts["friction_force"][now, None] * tangent
    usual = robot.mass * run.scenario.gravity
    length = _FORCE_LENGTH * robot.outline.axle_distance
    label = "contact forces, longest {:.0f} N"
    _draw_arrows(ax, places, force, (usual, length), color=_RED, label=label)


def _draw_arrows(
    ax: Axes,
    places: NDArray[np.float64],
    vectors: NDArray[np.float64],
    scale: tuple[float, float],
    *,
    color: str,
    label: str,
) -> None:
    """Arrows with their tails at some places.

    The scale is a usual size and the length [m] that it is drawn at, or the largest if beyond it.
    """
    usual, length = scale
    sizes = np.hypot(*vectors.T)
    most = max(usual, float(sizes.max()))
    drawn = sizes > _SHORTEST * most
    if not drawn.any():
        return
    ax.quiver(
        *places[drawn].T,
        *(length / most * vectors[drawn]).T,
        color=color,
        angles="xy",
        scale_units="xy",
        scale=1.0,
        width=0.004,
        label=label.format(sizes.max()),
        zorder=4,
    )


def _draw_envelopes(run: Record, geometry: dict[str, Any], sample: int, ax: Axes) -> None:
    """Draw the taut belts round the wheels, and fill what of the ground is inside them."""
    patches = extra("matplotlib.patches", "plot")
    depth = max(run.scenario.criteria.intrusion_depth, SLIVER)
    label: str | None = "taut belt round the wheels"
    for carrier in carriers(run, geometry):
        if carrier.track["hull"]:  # nothing gets inside a belt
            continue
        belt = carrier.track["envelope"]
        ax.plot(
            *closed(carrier.placed(sample, belt)).T,
            color=_PURPLE,
            linestyle="--",
            linewidth=0.9,
            label=label,
            zorder=2.5,
        )
        label = None  # once is enough
        inner = carrier.placed(sample, inset(belt, depth))
        for _, profile in seen_lanes(geometry):
            x, y = profile.T
            below = float(inner[:, 1].min()) - 1.0
            soil = ax.fill_between(x, y, below, color=_PURPLE, alpha=0.5, linewidth=0.0, zorder=2.6)
            soil.set_clip_path(patches.Polygon(inner, transform=ax.transData))


def _draw_intrusions(run: Record, geometry: dict[str, Any], sample: int, ax: Axes) -> None:
    """Mark the edges that are inside the track at one sample."""
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
    label = f"edge inside the track: {1e3 * depth:.1f} mm"
    # Not those in a chain: the edge is between two of its shoes.
    in_chain = geometry["shoes"] and not carrier_of(geometry, one)
    if one != other and not in_chain:
        label += f" between wheels {one} and {other}"
    ax.plot(
        run.edges["x"][edges],
        run.edges["y"][edges],
        linestyle="none",
        marker="D",
        markersize=6,
        markerfacecolor="white",
        markeredgecolor=_PURPLE,
        label=label,
        zorder=5,
    )
