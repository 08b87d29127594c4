"""Arrows of the contacts of a sample: forces on the robot, and slip velocities."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from crawler2d.drawings.palette import BLUE, RED

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from numpy.typing import NDArray

    from crawler2d.results.record import Record

__all__ = ["draw_forces", "draw_slip", "usual_size"]

# Arrow length of a contact force equal to the weight, as a share of the axle distance; larger
# forces, as of a wedged robot, shrink the scale so that the largest gets this length.
_FORCE_LENGTH = 0.6
# The same for slip velocities, with the commanded speed in place of the weight.
_SPEED_LENGTH = 0.22
# These start this far below the surface, as a share of the axle distance, where they hide nothing.
_BELOW = 0.03
# Arrows below this share of the longest would be mere dots, and are left out.
_SHORTEST = 0.02
# Percentile that sets the scale for a whole run: an impact lasts one sample, and at its scale all
# other arrows would be unreadable.
_USUAL = 98.0


def usual_size(sizes: NDArray[np.float64], typical: float) -> float:
    """Choose the size that all arrows of a run are scaled by, at least a typical one."""
    return max(typical, float(np.percentile(sizes, _USUAL))) if sizes.size else typical


def draw_forces(
    run: Record,
    sample: int,
    ax: Axes,
    most: float | None = None,
    *,
    color: str = RED,
    where: str = "",
) -> list[Any]:
    """Draw the contact forces on the robot.

    Parameters
    ----------
    run : Run
        A run with history.
    sample : int
        Which one.
    ax : Axes
        Where to draw.
    most : float, optional
        [N] Force of the longest arrow, also of larger ones; None takes the largest, but at least
        the weight.
    color : str
        Of the arrows.
    where : str
        What the legend adds to tell them from others.

    Returns
    -------
    list of Artist
        The arrows, if there are any.
    """
    robot, contacts = run.scenario.robot, run.contacts
    now, places, normal, tangent = _contacts(run, sample)
    force = contacts["normal_force"][now, None] * normal
    force = force + contacts["friction_force"][now, None] * tangent
    if most is None:
        most = _largest(force, robot.mass * run.scenario.gravity)
    length = _FORCE_LENGTH * robot.outline.axle_distance
    label = f"contact force{where}, up to {{:.0f}} N"
    return _draw(ax, places, force, (most, length), color=color, label=label)


def draw_slip(run: Record, sample: int, ax: Axes) -> list[Any]:
    """Draw the slip velocities of the robot's surface; see `draw_forces`."""
    distance = run.scenario.robot.outline.axle_distance
    now, places, normal, tangent = _contacts(run, sample)
    below = places - _BELOW * distance * normal
    speed = run.contacts["surface_speed"][now, None] * tangent
    scale = (_largest(speed, abs(run.scenario.drive.speed)), _SPEED_LENGTH * distance)
    return _draw(ax, below, speed, scale, color=BLUE, label="slip velocity, up to {:.2f} m/s")


def _contacts(run: Record, sample: int) -> tuple[NDArray[Any], ...]:
    """Find the rows of the contacts of a sample, their places [m], normals and tangents."""
    contacts = run.contacts
    now = np.flatnonzero(contacts["time"] == run.time[sample])
    places = np.column_stack([contacts["x"][now], contacts["y"][now]])
    normal = np.column_stack([contacts["normal_x"][now], contacts["normal_y"][now]])
    return now, places, normal, np.column_stack([normal[:, 1], -normal[:, 0]])


def _largest(vectors: NDArray[np.float64], typical: float) -> float:
    return max(typical, float(np.hypot(*vectors.T).max(initial=0.0)))


def _draw(
    ax: Axes,
    places: NDArray[np.float64],
    vectors: NDArray[np.float64],
    scale: tuple[float, float],
    *,
    color: str,
    label: str,
) -> list[Any]:
    """Draw arrows from the places; `scale` is the largest size and its length [m]."""
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
            width=0.004,
            label=label.format(sizes.max()),
            zorder=4,
        )
    ]
