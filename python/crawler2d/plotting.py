"""Pictures of a run: the side view, and strips over time."""

from __future__ import annotations

import textwrap
from typing import TYPE_CHECKING, Any

import numpy as np

from crawler2d import _core
from crawler2d._extras import extra
from crawler2d.errors import ScenarioError

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from numpy.typing import ArrayLike, NDArray

    from crawler2d.run import Run

__all__ = ["extent", "inset", "plot_run", "side_view", "taut_belt", "time_strips"]

# Okabe and Ito's palette: told apart by colour-blind readers.
_BLACK, _ORANGE, _BLUE, _RED, _GREEN = "#222222", "#E69F00", "#0072B2", "#D55E00", "#009E73"
_GROUND, _PURPLE = "#D9D2C5", "#A3327B"

# A contact force as large as the weight is drawn as long as this share of the axle distance, and a
# larger one of a robot that wedges itself in no longer.
_FORCE_LENGTH = 0.6
# The same of a surface that passes the ground at the commanded speed, or of the fastest beyond it.
_SPEED_LENGTH = 0.22
# They lie so far inside the ground, as a share of the axle distance, where they hide nothing.
_BELOW = 0.03
# Shorter arrows, as a share of the longest one there can be, would be mere dots.
_SHORTEST = 0.02
# [m] Lines that coincide enclose slivers of rounding; an intrusion is deeper.
_SLIVER = 2e-5
# Characters of a line of the title.
_TITLE_WIDTH = 80
# Most drawings of the robot in one side view.
_MOST_DRAWINGS = 7


def plot_run(
    run: Run, time: ArrayLike | None = None, axes: Axes | tuple[Axes, ...] | None = None
) -> tuple[Axes, ...]:
    """Draw a run; see `Run.plot`."""
    times = _drawing_times(run) if time is None else np.atleast_1d(np.asarray(time, dtype=float))
    if axes is None:
        pyplot = extra("matplotlib.pyplot", "plot")
        figure = pyplot.figure(figsize=(9.0, 8.5), layout="constrained")
        grid = figure.add_gridspec(4, 1, height_ratios=(3.2, 1.0, 1.0, 1.0))
        side = figure.add_subplot(grid[0])
        angle = figure.add_subplot(grid[1])
        strips = (angle, *(figure.add_subplot(grid[row], sharex=angle) for row in (2, 3)))
        axes = (side, *strips)
    elif not isinstance(axes, (tuple, list, np.ndarray)):
        axes = (axes,)
    if len(axes) not in (1, 4):
        raise ScenarioError("axes", f"{len(axes)} axes", "must be one Axes or four")
    side_view(run, times, axes[0])
    if len(axes) == 4:
        time_strips(run, tuple(axes[1:]))
    return tuple(axes)


def side_view(run: Run, times: NDArray[np.float64], ax: Axes) -> None:
    """Draw ground, robot at some instants, path of the chassis origin, and what holds the robot.

    At the last of the instants the contacts are drawn, with their forces on the robot and the
    speeds of its surface over the ground, the taut belt round its wheels, and the ground and the
    edges inside that belt.

    Parameters
    ----------
    run : Run
        A run with history.
    times : ndarray, shape (k,)
        [s] When to draw the robot; the nearest samples are taken.
    ax : Axes
        Where to draw.
    """
    geometry = _core.geometry(run.scenario.to_json())
    profile = geometry["profile"]
    samples = np.unique([np.abs(run.time - t).argmin() for t in times])
    left, right, bottom, top = extent(run, profile, geometry)
    ax.fill_between(
        profile[:, 0], profile[:, 1], bottom - 1.0, color=_GROUND, linewidth=0.0, zorder=0
    )
    ax.plot(profile[:, 0], profile[:, 1], color=_BLACK, linewidth=1.2, zorder=1)
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
    if not geometry["hull"]:  # nothing gets inside a belt
        _draw_envelope(run, geometry, shown, ax)
    _draw_intrusions(run, shown, ax)
    if left < geometry["goal"] < right:
        ax.axvline(geometry["goal"], color=_GREEN, linestyle=":", label="goal for the rear end")
    ax.set(xlim=(left, right), ylim=(bottom, top), xlabel="x [m]", ylabel="y [m]", aspect="equal")
    ax.set_title(_title(run), loc="left", fontsize="medium")
    ax.legend(loc="upper left", fontsize="small", framealpha=0.9)


def time_strips(run: Run, axes: tuple[Axes, ...]) -> None:
    """Draw chassis angle, track speed with its command, and drive force over time.

    Parameters
    ----------
    run : Run
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


def _title(run: Run) -> str:
    diagnosis = getattr(run, "diagnosis", None)
    if diagnosis is None:
        return run.title
    return f"{run.title}\n{textwrap.fill(str(diagnosis), _TITLE_WIDTH)}"


def _drawing_times(run: Run) -> NDArray[np.float64]:
    """Choose instants that lie about one robot length of travel apart."""
    travelled = np.hypot(*np.diff(run.position, axis=0, prepend=run.position[:1]).T).cumsum()
    outline = run.scenario.robot.outline
    length = outline.axle_distance + outline.front_radius + outline.rear_radius
    count = int(np.clip(round(travelled[-1] / length), 1, _MOST_DRAWINGS - 1)) + 1
    samples = np.searchsorted(travelled, np.linspace(0.0, travelled[-1], count))
    samples[-1] = run.time.size - 1
    return run.time[samples]


def extent(
    run: Run, profile: NDArray[np.float64], geometry: dict[str, Any]
) -> tuple[float, float, float, float]:
    """[m] Left, right, bottom and top of what the run visits, with the obstacle's beginning."""
    circles = geometry["circles"]
    reach = float((np.hypot(circles[:, 0], circles[:, 1]) + circles[:, 2]).max()) + 0.05
    x, y = run.position.T
    left, right = float(x.min()) - reach, float(x.max()) + reach
    visited = profile[(profile[:, 0] > left) & (profile[:, 0] < right), 1]
    ground = np.concatenate([visited, np.interp([left, right], profile[:, 0], profile[:, 1])])
    bottom = min(float(ground.min()), float(y.min()) - float(circles[:, 2].max()))
    return left, right, bottom - 0.05, max(float(ground.max()), float(y.max()) + reach)


def _draw_robot(run: Run, geometry: dict[str, Any], sample: int, ax: Axes, *, alpha: float) -> None:
    def draw(outline: NDArray[np.float64], color: str, *, filled: bool = False) -> None:
        x, y = _placed(run, sample, outline).T
        if filled:
            ax.fill(x, y, color=color, alpha=0.25 * alpha, linewidth=0.0, zorder=2)
        ax.plot(x, y, color=color, alpha=alpha, linewidth=1.0, zorder=2)

    if len(geometry["belly"]):  # first: the wheels lie before it
        draw(_closed(geometry["belly"]), _GREEN, filled=True)
    circles = geometry["circles"]
    if geometry["gears"]:
        for gear in geometry["gears"]:
            draw(_turned(gear, run.drive_positions[sample]), _BLACK)
    elif geometry["hull"]:
        draw(taut_belt(circles), _BLACK)
    else:
        for circle in circles:
            draw(taut_belt(circle[None]), _BLACK)
    center = _placed(run, sample, np.array([run.scenario.robot.center_of_mass]))
    ax.plot(*center.T, marker="+", color=_BLACK, alpha=alpha, markersize=8, zorder=2)


def _placed(run: Run, sample: int, points: NDArray[np.float64]) -> NDArray[np.float64]:
    """[m] Points of the chassis frame, shape (n, 2), where they are at a sample."""
    placed: NDArray[np.float64] = points @ _rotation(run.chassis_angle[sample]).T
    placed += run.position[sample]
    return placed


def _rotation(angle: float) -> NDArray[np.float64]:
    cosine, sine = np.cos(angle), np.sin(angle)
    return np.array([[cosine, -sine], [sine, cosine]])


def _turned(gear: dict[str, Any], positions: NDArray[np.float64]) -> NDArray[np.float64]:
    """[m] Outline of a gear in the chassis frame, turned as far as its drive has run."""
    angle = 0.0 if gear["drive"] is None else -positions[gear["drive"]] / gear["radius"]
    outline: NDArray[np.float64] = gear["outline"] @ _rotation(angle).T + gear["center"]
    return _closed(outline)


def _closed(polygon: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.vstack([polygon, polygon[:1]])


def taut_belt(circles: NDArray[np.float64]) -> NDArray[np.float64]:
    """[m] Outline of a belt around circles: the outermost point in every direction."""
    directions = np.linspace(0.0, 2.0 * np.pi, 181)
    normals = np.column_stack([np.cos(directions), np.sin(directions)])
    outermost = (normals @ circles[:, :2].T + circles[:, 2]).argmax(axis=1)
    belt: NDArray[np.float64] = circles[outermost, :2] + normals * circles[outermost, 2:]
    return belt


def inset(belt: NDArray[np.float64], depth: float) -> NDArray[np.float64]:
    """[m] A closed convex line, moved inwards by a depth."""
    way = np.roll(belt, -1, axis=0) - belt
    belt = belt[np.hypot(*way.T) > 1e-9]  # without corners that coincide
    way = np.roll(belt, -1, axis=0) - belt
    x, y = belt.T
    counter_clockwise = np.sign((x * np.roll(y, -1) - y * np.roll(x, -1)).sum())
    inwards = counter_clockwise * np.column_stack([-way[:, 1], way[:, 0]])
    inwards /= np.hypot(*way.T)[:, None]
    inwards = inwards + np.roll(inwards, 1, axis=0)
    moved: NDArray[np.float64] = belt + depth * inwards / np.hypot(*inwards.T)[:, None]
    return moved


def _draw_contacts(run: Run, sample: int, ax: Axes) -> None:
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


def _draw_envelope(run: Run, geometry: dict[str, Any], sample: int, ax: Axes) -> None:
    """Draw the taut belt round the wheels, and fill what of the ground is inside it."""
    belt = geometry.get("envelope")
    belt = taut_belt(geometry["circles"]) if belt is None else belt
    ax.plot(
        *_closed(_placed(run, sample, belt)).T,
        color=_PURPLE,
        linestyle="--",
        linewidth=0.9,
        label="taut belt round the wheels",
        zorder=2.5,
    )
    depth = max(run.scenario.criteria.intrusion_depth, _SLIVER)
    inner = _placed(run, sample, inset(belt, depth))
    x, y = geometry["profile"].T
    soil = ax.fill_between(
        x, y, float(inner[:, 1].min()) - 1.0, color=_PURPLE, alpha=0.5, linewidth=0.0, zorder=2.6
    )
    patches = extra("matplotlib.patches", "plot")
    soil.set_clip_path(patches.Polygon(inner, transform=ax.transData))


def _draw_intrusions(run: Run, sample: int, ax: Axes) -> None:
    """Mark the edges that are inside the track at one sample."""
    events, time = run.events, run.time[sample]
    inside = events["kind"] == "intrusion"
    inside &= (events["start"] <= time) & (time <= events["end"])
    rows = np.flatnonzero(inside)
    if not rows.size:
        return
    edges = events["edge"][rows]
    most_loaded = rows[events["force"][rows].argmax()]
    depth, (one, other) = events["depth"][most_loaded], sorted(events["bodies"][most_loaded])
    label = f"edge inside the track: {1e3 * depth:.1f} mm"
    if one != other:
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
