"""Scenes of a run at any time, with contact forces, ground inside the track and ends of trials."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from crawler2d.common.bodies import POSE_COLUMNS, body_poses
from crawler2d.common.extras import extra
from crawler2d.drawings.palette import BLUE, RED, VIOLET
from crawler2d.drawings.scene import Look, Scene, close_line, place, relative
from crawler2d.results.diagnosis import trial_text
from crawler2d.results.outcome import TRIALS

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from numpy.typing import NDArray

    from crawler2d.drawings.scene import Carrier
    from crawler2d.results.findings import TrialResult
    from crawler2d.results.record import Record

__all__ = [
    "Envelopes",
    "Ghost",
    "draw_edges",
    "draw_forces",
    "draw_slip",
    "ghost_lines",
    "ghosts",
    "scene_of",
    "usual_force",
    "usual_speed",
]

# Arrow length of a contact force equal to the weight, as a fraction of the axle distance; larger
# forces, as of a wedged robot, shrink the scale so that the largest gets this length.
_FORCE_LENGTH = 0.6
# The same for slip velocities, relative to the commanded speed.
_SPEED_LENGTH = 0.22
# Slip arrows start this far below the surface, as a fraction of the axle distance, where they
# hide nothing.
_BELOW = 0.03
# Width of shafts of arrows, as a fraction of the width of the Axes.
_WIDTH = 0.004
# Arrows below this fraction of the longest would be mere dots, and are left out.
_SHORTEST = 0.02
# Percentile that sets the scale for a whole run: an impact lasts one sample, and at its scale all
# other arrows would be unreadable.
_USUAL = 98.0


def scene_of(run: Record, times: NDArray[np.float64] | None = None) -> Scene:
    """Collect what is drawn of a run.

    Parameters
    ----------
    run : Run
        A run with history.
    times : ndarray, shape (k,), optional
        [s] Instants between which samples are interpolated; None takes the samples of the run.
    """
    columns = {name: getattr(run, name) for name in POSE_COLUMNS}
    if times is not None:
        columns = {name: _interpolate(run.time, column, times) for name, column in columns.items()}
    return Scene(run.scenario.to_json(), columns)


def _interpolate(
    time: NDArray[np.float64], column: NDArray[np.float64], times: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Interpolate a column of the history, whose angles are not wrapped."""
    values = [np.interp(times, time, each) for each in column.reshape(time.size, -1).T]
    return np.array(values).T.reshape(times.size, *column.shape[1:])


def usual_force(run: Record) -> float:
    """[N] The contact force that sets the scale of all arrows of a run, at least its weight."""
    forces = np.hypot(run.contacts["normal_force"], run.contacts["friction_force"])
    return _usual(forces, _weight(run))


def usual_speed(run: Record) -> float:
    """[m/s] The slip that sets the scale of all arrows of a run, at least the commanded speed."""
    return _usual(np.abs(run.contacts["surface_speed"]), abs(run.scenario.drive.speed))


def _usual(sizes: NDArray[np.float64], typical: float) -> float:
    return max(typical, float(np.percentile(sizes, _USUAL))) if sizes.size else typical


def _weight(run: Record) -> float:
    return run.scenario.robot.mass * run.scenario.gravity


def draw_forces(
    run: Record,
    sample: int,
    ax: Axes,
    most: float | None = None,
    *,
    color: str = RED,
    width: float = _WIDTH,
    where: str = "",
) -> list[Any]:
    """Draw the contact forces on the robot.

    Parameters
    ----------
    run : Run
        A run with history.
    sample : int
        Index of the sample.
    ax : Axes
        Where to draw.
    most : float, optional
        [N] Force of the longest arrow; larger forces are drawn equally long. None takes the largest
        force, but at least the weight.
    color : str
        Colour of the arrows.
    width : float
        [-] Width of their shafts, as a fraction of the width of the Axes.
    where : str
        Text added in the legend, to distinguish them from other arrows.

    Returns
    -------
    list of Artist
        The arrows, if there are any.
    """
    contacts = run.contacts
    now, places, normal, tangent = _contacts(run, sample)
    force = contacts["normal_force"][now, None] * normal
    force = force + contacts["friction_force"][now, None] * tangent
    if most is None:
        most = _largest(force, _weight(run))
    length = _FORCE_LENGTH * run.scenario.robot.outline.axle_distance
    label = f"contact force{where}, up to {{:.0f}} N"
    return _draw_arrows(ax, places, force, (most, length), color=color, width=width, label=label)


def draw_slip(run: Record, sample: int, ax: Axes) -> list[Any]:
    """Draw the slip velocities of the robot's surface; see `draw_forces`."""
    distance = run.scenario.robot.outline.axle_distance
    now, places, normal, tangent = _contacts(run, sample)
    below = places - _BELOW * distance * normal
    speed = run.contacts["surface_speed"][now, None] * tangent
    scale = (_largest(speed, abs(run.scenario.drive.speed)), _SPEED_LENGTH * distance)
    return _draw_arrows(
        ax, below, speed, scale, color=BLUE, label="slip velocity, up to {:.2f} m/s"
    )


def _contacts(run: Record, sample: int) -> tuple[NDArray[Any], ...]:
    """Return the contacts of a sample: rows, positions [m], normals and tangents."""
    contacts = run.contacts
    now = np.flatnonzero(contacts["time"] == run.time[sample])
    places = np.column_stack([contacts["x"][now], contacts["y"][now]])
    normal = np.column_stack([contacts["normal_x"][now], contacts["normal_y"][now]])
    return now, places, normal, np.column_stack([normal[:, 1], -normal[:, 0]])


def _largest(vectors: NDArray[np.float64], typical: float) -> float:
    return max(typical, float(np.hypot(*vectors.T).max(initial=0.0)))


def _draw_arrows(
    ax: Axes,
    places: NDArray[np.float64],
    vectors: NDArray[np.float64],
    scale: tuple[float, float],
    *,
    color: str,
    width: float = _WIDTH,
    label: str,
) -> list[Any]:
    """Draw arrows from positions; `scale` has the largest size and its length [m]."""
    sizes, (most, length) = np.hypot(*vectors.T), scale
    drawn = sizes > _SHORTEST * most
    if not drawn.any():
        return []
    lengths = length / np.maximum(most, sizes[drawn])
    return [
        ax.quiver(
            *places[drawn].T,
            *(lengths[:, None] * vectors[drawn]).T,
            color=color,
            angles="xy",
            scale_units="xy",
            scale=1.0,
            width=width,
            label=label.format(sizes.max()),
            zorder=4,
        )
    ]


class Envelopes:
    """Artists for the envelopes of wheels and the ground inside them, at one sample at a time.

    Parameters
    ----------
    scene : Scene
        The robot with its poses.
    ax : Axes
        Where to draw.
    """

    def __init__(self, scene: Scene, ax: Axes) -> None:
        patches = extra("matplotlib.patches", "plot")
        label: str | None = "envelope (taut belt round the wheels)"
        bottom = min(float(profile[:, 1].min()) for _, profile in scene.lanes) - 1.0
        self._drawn: list[tuple[Carrier, Any, Any]] = []
        for carrier in scene.carriers:
            if carrier.closed:
                continue
            look: Any = {"color": VIOLET, "linestyle": "--", "linewidth": 0.9, "zorder": 2.5}
            (line,) = ax.plot([], [], label=label, **look)
            label = None  # a single entry in the legend
            clip = patches.Polygon(carrier.inner, transform=ax.transData)
            fill: Any = {"color": VIOLET, "alpha": 0.5, "linewidth": 0.0, "zorder": 2.6}
            for _, profile in scene.lanes:
                ax.fill_between(profile[:, 0], profile[:, 1], bottom, **fill).set_clip_path(clip)
            self._drawn.append((carrier, line, clip))

    def show(self, sample: int) -> None:
        """Move them to a sample."""
        for carrier, line, clip in self._drawn:
            pose = carrier.poses[sample]
            line.set_data(*place(close_line(carrier.envelope), pose).T)
            clip.set_xy(place(carrier.inner, pose))


def draw_edges(run: Record, scene: Scene, sample: int, ax: Axes) -> None:
    """Mark the edges inside the track at a sample, each at its deepest point."""
    events, time = run.events, run.time[sample]
    inside = events["kind"] == "intrusion"
    inside &= (events["start"] <= time) & (time <= events["end"])
    rows = np.flatnonzero(inside)
    if not rows.size:
        return
    points, depths = zip(*(_deepest(run, scene, sample, row) for row in rows.tolist()), strict=True)
    at = int(events["force"][rows].argmax())
    one, other = sorted(events["bodies"][rows[at]])
    if scene.kinds[one].is_in_chain:  # between two shoes, inside a belt round these
        depth = f"at most {1e3 * events['depth'][rows[at]]:.1f} mm"
    else:
        depth = f"{1e3 * depths[at]:.1f} mm"
        depth += "" if one == other else f", between wheels {one} and {other}"
    ax.plot(
        *np.transpose(points),
        linestyle="none",
        marker="D",
        markersize=6,
        markerfacecolor="white",
        markeredgecolor=VIOLET,
        label=f"edge inside the envelope: {depth}",
        zorder=5,
    )


def _deepest(run: Record, scene: Scene, sample: int, row: int) -> tuple[NDArray[np.float64], float]:
    """[m] Find the deepest point of the edge of an intrusion at a sample, and its depth."""
    lane, edge, bodies = (run.events[name][row] for name in ("lane", "edge", "bodies"))
    profile, edges = dict(scene.lanes)[lane], run.edges
    own = np.flatnonzero((edges["id"] == edge) & (edges["lane"] == lane))[0]
    # A rounded edge is an arc, which begins this far from where the sharp corner would be.
    reach = edges["radius"][own] * np.tan(0.5 * abs(edges["angle"][own]))
    away = np.hypot(profile[:, 0] - edges["x"][own], profile[:, 1] - edges["y"][own])
    points = profile[away <= (1.0 + 1e-6) * max(reach, away.min())]
    carrier = scene.carriers[scene.carrier_of(bodies[0])]
    frames = np.repeat(carrier.poses[[sample]], len(points), axis=0)
    here = relative(np.column_stack([points, np.zeros(len(points))]), frames)[:, :2]
    depths = _depth_inside(carrier.envelope, here)
    return points[depths.argmax()], float(depths.max())


def _depth_inside(polygon: NDArray[np.float64], points: NDArray[np.float64]) -> NDArray[np.float64]:
    """[m] Distances of points from the nearest side of a convex polygon, counter-clockwise."""
    sides = np.roll(polygon, -1, axis=0) - polygon
    lengths = np.hypot(*sides.T)
    long = lengths > 1e-9  # shorter sides have no direction
    sides, corners, lengths = sides[long], polygon[long], lengths[long]
    x, y = np.moveaxis(points[:, None] - corners, -1, 0)
    depths: NDArray[np.float64] = ((sides[:, 0] * y - sides[:, 1] * x) / lengths).min(axis=1)
    return depths


@dataclass(frozen=True, slots=True, kw_only=True)
class Ghost:
    """The robot at the end of a trial.

    Parameters
    ----------
    change, result, meaning : str
        Name of the change; the same with its result; explanation of the change.
    freed : bool
        Whether it freed the robot.
    from_the_start : bool
        Whether the robot drove from the start of its run, not from the stop.
    is_belt : bool
        Whether a belt ran round its bodies.
    frames : ndarray, shape (k, 3)
        [m, m, rad] Poses of its carriers, the chassis first.
    """

    change: str
    result: str
    meaning: str
    freed: bool
    from_the_start: bool
    is_belt: bool
    frames: NDArray[np.float64]


def ghosts(run: Record) -> list[Ghost]:
    """Collect the trials of a run that changed something."""
    why = run.diagnosis
    if why is None:
        return []
    texts = {tried: text for tried in why.trials if (text := trial_text(why, tried))}
    return [
        Ghost(
            change=text.partition(":")[0],
            result=text,
            meaning=TRIALS[tried.name],
            freed=tried.freed,
            from_the_start=tried.is_from_the_start,
            is_belt=tried.name.startswith(("closed", "belt")),
            frames=frames,
        )
        for (tried, text), frames in zip(texts.items(), _frames(run, list(texts)), strict=True)
    ]


def ghost_lines(scene: Scene, ghost: Ghost) -> Iterator[NDArray[np.float64]]:
    """[m] Yield the closed outlines of a ghost: its bodies except shoes, with a belt round them."""
    for carrier, frame in zip(scene.carriers, ghost.frames, strict=True):
        shoes = {body for body in carrier.bodies if scene.looks[body] == Look.SHOE}
        if shoes or (ghost.is_belt and not carrier.closed):
            yield place(close_line(carrier.envelope), frame)
        for row in carrier.bodies:
            if row not in shoes:
                (pose,) = relative(scene.poses[-1:, row], carrier.poses[-1:])
                outline = place(close_line(scene.bodies["outline"][row]), pose)
                yield place(outline, frame)


def _frames(run: Record, trials: list[TrialResult]) -> NDArray[np.float64]:
    """[m, m, rad] Poses of the carriers at the ends of n trials, shape (n, k, 3)."""
    chassis = np.array([(*tried.position, tried.chassis_angle) for tried in trials]).reshape(-1, 3)
    # Travel of the tracks does not move the carriers.
    last = {name: getattr(run, name)[-1:] for name in ("drive_positions", "shoe_poses")}
    columns = {
        "position": chassis[:, :2],
        "chassis_angle": chassis[:, 2],
        "flipper_angles": np.array([tried.flipper_angles for tried in trials]),
        **{name: np.repeat(values, len(trials), axis=0) for name, values in last.items()},
    }
    arms = body_poses(run.scenario.to_json(), columns)["arms"]
    return np.concatenate([chassis[:, None], arms], axis=1)
