"""The side view of a run: ground, robot, contacts, and the ground inside the track."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from crawler2d.common.extras import extra
from crawler2d.pictures.ghosts import ghost_lines, ghosts
from crawler2d.pictures.shapes import SLIVER, Scene, closed, inset, placed
from crawler2d.results.bodies import BodyKind

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from numpy.typing import NDArray

    from crawler2d.results.record import Record

__all__ = ["side_view"]

# The palette of Okabe and Ito, readable for the colour-blind.
_BLACK, _BLUE, _RED, _GREEN = "#222222", "#0072B2", "#D55E00", "#009E73"
_GROUND, _PURPLE, _GUIDE = "#D9D2C5", "#A3327B", "#AAAAAA"
# Of the ends of trials.
_GHOSTS = ("#56B4E9", "#E69F00", "#009E73", "#CC79A7", "#7F7F7F")

# Arrow length of a contact force equal to the weight, as a share of the axle distance; larger
# forces, as of a wedged robot, shrink the scale so that the largest gets this length.
_FORCE_LENGTH = 0.6
# The same for slip velocities, with the commanded speed in place of the weight.
_SPEED_LENGTH = 0.22
# These start this far below the surface, as a share of the axle distance, where they hide nothing.
_BELOW = 0.03
# Arrows below this share of the longest would be mere dots, and are left out.
_SHORTEST = 0.02


def side_view(run: Record, times: NDArray[np.float64], ax: Axes, *, trials: bool = True) -> None:
    """Draw the ground, the robot at some instants, the path of the chassis origin, and contacts.

    At the last of the instants it also draws the contact forces on the robot, the slip velocities,
    the envelopes of its wheels, and the ground and edges inside these; and, if it is the end of the
    run, where the trials ended that freed the robot.

    Parameters
    ----------
    run : Run
        A run with history.
    times : ndarray, shape (k,)
        [s] When to draw the robot; the nearest samples are used.
    ax : Axes
        Where to draw.
    trials : bool
        Whether to draw the ends of trials.
    """
    scene = Scene(run)
    samples = np.unique([np.abs(run.time - t).argmin() for t in times])
    left, right, bottom, top = scene.extent()
    _draw_ground(scene.lanes, bottom, ax)
    for sample in samples:
        last = sample == samples[-1]
        _draw_robot(scene, int(sample), ax, alpha=1.0 if last else 0.3)
    ax.plot(
        run.position[:, 0],
        run.position[:, 1],
        color=_BLUE,
        linewidth=1.2,
        label="path of the chassis origin",
        zorder=3,
    )
    shown = int(samples[-1])
    if trials and shown == run.time.size - 1:
        left, right = _draw_ghosts(run, scene, ax, (left, right))
    _draw_contacts(run, shown, ax)
    depth = max(run.scenario.criteria.intrusion_depth, SLIVER)
    _draw_envelopes(scene, shown, ax, depth=depth)
    _draw_intrusions(run, scene, shown, ax)
    if left < scene.goal < right:
        ax.axvline(scene.goal, color=_GREEN, linestyle=":", label="goal (rear end)")
    ax.set(xlim=(left, right), ylim=(bottom, top), xlabel="x [m]", ylabel="y [m]", aspect="equal")
    # Below the picture, where it hides nothing.
    ax.legend(loc="upper center", bbox_to_anchor=(0.5, -0.18), fontsize="small", ncols=2)


def _draw_ghosts(
    run: Record, scene: Scene, ax: Axes, sides: tuple[float, float]
) -> tuple[float, float]:
    """Draw where trials that freed the robot ended; return how far the picture has to reach."""
    length = run.scenario.robot.outline.axle_distance
    left, right = sides
    freed = [each for each in ghosts(run) if each.freed]
    for ghost, color in zip(freed, _GHOSTS, strict=False):
        for number, line in enumerate(ghost_lines(scene, ghost)):
            ax.plot(
                *line.T,
                color=color,
                linewidth=0.8,
                alpha=0.8,
                label=f"end of the trial: {ghost.change}" if number == 0 else None,
                zorder=1.5,
            )
        x = float(ghost.frames[0, 0])
        left, right = min(left, x - length), max(right, x + length)
    return left, right


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


def _draw_robot(scene: Scene, sample: int, ax: Axes, *, alpha: float) -> None:
    """Draw the bodies of each carrier, shoes last; bodies that never touch ground are left out."""
    shoes = []
    bodies = np.concatenate([carrier.bodies for carrier in scene.carriers])
    # The belly is drawn last, over the wheels.
    for body in sorted(bodies, key=lambda body: scene.kinds[body] != BodyKind.BELLY):
        line, kind = scene.outline(body, sample), scene.kinds[body]
        if scene.is_shoe(body):
            shoes.append(line)
        elif kind == BodyKind.BELLY:
            ax.fill(*line.T, color=_GREEN, alpha=0.25 * alpha, linewidth=0.0, zorder=2)
            ax.plot(*line.T, color=_GREEN, alpha=alpha, linewidth=1.0, zorder=2)
        elif scene.bodies["body"][body] >= 0:
            # What shoes run on is drawn faintly behind them, except for the sprocket.
            is_hint = kind.is_in_chain and kind != BodyKind.SPROCKET
            color = _GUIDE if is_hint else _BLACK
            ax.plot(*line.T, color=color, alpha=alpha, linewidth=1.0, zorder=2)
    if shoes:
        # A chain has hundreds of pieces in all poses; one artist per pose is fast.
        collections = extra("matplotlib.collections", "plot")
        ax.add_collection(
            collections.PolyCollection(
                shoes,
                facecolor=(_BLACK, 0.5 * alpha),
                edgecolor=(_BLACK, alpha),
                linewidth=0.6,
                zorder=2,
            )
        )
    center = scene.center_of_mass[sample]
    ax.plot(*center[:, None], marker="+", color=_BLACK, alpha=alpha, markersize=8, zorder=2)


def _draw_contacts(run: Record, sample: int, ax: Axes) -> None:
    """Draw arrows of the contact forces on the robot and of the slip velocities, at one sample."""
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
    label = "slip velocity, up to {:.2f} m/s"
    _draw_arrows(ax, below, speed, (usual, length), color=_BLUE, label=label)
    force = contacts["normal_force"][now, None] * normal
    force = force + contacts["friction_force"][now, None] * tangent
    usual = robot.mass * run.scenario.gravity
    length = _FORCE_LENGTH * robot.outline.axle_distance
    label = "contact force, up to {:.0f} N"
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
    """Draw arrows with their tails at the places.

    `scale` is a typical size and its length [m] in the plot; the largest takes its place if larger.
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


def _draw_envelopes(scene: Scene, sample: int, ax: Axes, *, depth: float) -> None:
    """Draw the envelopes of the wheels, and fill the ground inside them."""
    patches = extra("matplotlib.patches", "plot")
    label: str | None = "envelope (taut belt round the wheels)"
    for carrier in scene.carriers:
        if carrier.closed:
            continue
        pose = carrier.poses[sample]
        ax.plot(
            *placed(closed(carrier.envelope), pose).T,
            color=_PURPLE,
            linestyle="--",
            linewidth=0.9,
            label=label,
            zorder=2.5,
        )
        label = None  # once is enough
        inner = placed(inset(carrier.envelope, depth), pose)
        for _, profile in scene.lanes:
            x, y = profile.T
            below = float(inner[:, 1].min()) - 1.0
            soil = ax.fill_between(x, y, below, color=_PURPLE, alpha=0.5, linewidth=0.0, zorder=2.6)
            soil.set_clip_path(patches.Polygon(inner, transform=ax.transData))


def _draw_intrusions(run: Record, scene: Scene, sample: int, ax: Axes) -> None:
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
        markeredgecolor=_PURPLE,
        label=label,
        zorder=5,
    )
