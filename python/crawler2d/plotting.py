"""Pictures of a run: the side view, and strips over time."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from crawler2d import _core
from crawler2d._extras import extra
from crawler2d.errors import ScenarioError

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from numpy.typing import ArrayLike, NDArray

    from crawler2d.run import Run

__all__ = ["plot_run", "side_view", "time_strips"]

# Okabe and Ito's palette: told apart by colour-blind readers.
_BLACK, _ORANGE, _BLUE, _RED, _GREEN = "#222222", "#E69F00", "#0072B2", "#D55E00", "#009E73"
_GROUND = "#D9D2C5"

# A contact force as large as the weight is drawn as long as this share of the axle distance, and a
# larger one of a robot that wedges itself in no longer.
_FORCE_LENGTH = 0.6
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
    """Draw ground, robot at some instants, path of the chassis origin, and how it ends.

    The end shows the contact forces of the last sample, and the edges inside the track: the taut
    belt round the wheels is drawn with them.

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
    left, right, bottom, top = _extent(run, profile, geometry)
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
    _draw_forces(run, ax)
    _draw_intrusions(run, geometry, ax)
    if left < geometry["goal"] < right:
        ax.axvline(geometry["goal"], color=_GREEN, linestyle=":", label="goal for the rear end")
    ax.set(xlim=(left, right), ylim=(bottom, top), xlabel="x [m]", ylabel="y [m]", aspect="equal")
    ax.set_title(run.title, loc="left", fontsize="medium")
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


def _drawing_times(run: Run) -> NDArray[np.float64]:
    """Choose instants that lie about one robot length of travel apart."""
    travelled = np.hypot(*np.diff(run.position, axis=0, prepend=run.position[:1]).T).cumsum()
    outline = run.scenario.robot.outline
    length = outline.axle_distance + outline.front_radius + outline.rear_radius
    count = int(np.clip(round(travelled[-1] / length), 1, _MOST_DRAWINGS - 1)) + 1
    samples = np.searchsorted(travelled, np.linspace(0.0, travelled[-1], count))
    samples[-1] = run.time.size - 1
    return run.time[samples]


def _extent(
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
        draw(_taut_belt(circles), _BLACK)
    else:
        for circle in circles:
            draw(_taut_belt(circle[None]), _BLACK)
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


def _taut_belt(circles: NDArray[np.float64]) -> NDArray[np.float64]:
    """[m] Outline of a belt around circles: the outermost point in every direction."""
    directions = np.linspace(0.0, 2.0 * np.pi, 181)
    normals = np.column_stack([np.cos(directions), np.sin(directions)])
    outermost = (normals @ circles[:, :2].T + circles[:, 2]).argmax(axis=1)
    belt: NDArray[np.float64] = circles[outermost, :2] + normals * circles[outermost, 2:]
    return belt


def _draw_forces(run: Run, ax: Axes) -> None:
    """Arrows of the contact forces on the robot at the last sample, tails on the contact."""
    contacts = run.contacts
    last = contacts["time"] == run.time[-1]
    if not last.any() or run.scenario.gravity <= 0.0:
        return
    normal = np.column_stack([contacts["normal_x"], contacts["normal_y"]])[last]
    tangent = np.column_stack([normal[:, 1], -normal[:, 0]])
    force = contacts["normal_force"][last, None] * normal
    force = force + contacts["friction_force"][last, None] * tangent
    robot = run.scenario.robot
    longest = max(robot.mass * run.scenario.gravity, float(np.hypot(*force.T).max()))
    scale = _FORCE_LENGTH * robot.outline.axle_distance / longest
    ax.quiver(
        contacts["x"][last],
        contacts["y"][last],
        *(scale * force).T,
        color=_RED,
        angles="xy",
        scale_units="xy",
        scale=1.0,
        width=0.004,
        label="contact forces at the end",
        zorder=4,
    )


def _draw_intrusions(run: Run, geometry: dict[str, Any], ax: Axes) -> None:
    """Mark the edges that are inside the track at the end, and the belt that they are inside of."""
    events = run.events
    inside = np.flatnonzero((events["kind"] == "intrusion") & (events["end"] == run.time[-1]))
    if not inside.size:
        return
    edges = events["edge"][inside]
    most_loaded = inside[events["force"][inside].argmax()]
    depth, (before, after) = events["depth"][most_loaded], events["bodies"][most_loaded]
    label = f"edge inside the track: {1e3 * depth:.1f} mm"
    if before != after:
        label += f" between wheels {before} and {after}"
    ax.plot(
        *_placed(run, -1, _taut_belt(geometry["circles"])).T,
        color=_RED,
        linestyle=":",
        linewidth=1.2,
        label="taut belt round the wheels",
        zorder=1.5,
    )
    ax.plot(
        run.edges["x"][edges],
        run.edges["y"][edges],
        linestyle="none",
        marker="D",
        markersize=6,
        markerfacecolor="white",
        markeredgecolor=_RED,
        label=label,
        zorder=5,
    )
