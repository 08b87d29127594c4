"""Bodies of a robot: kinds, outlines and poses; discs of its tracks; its belly."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from enum import IntEnum
from typing import TYPE_CHECKING, Any

import numpy as np

from crawler2d import _core
from crawler2d.common.arrays import Table, freeze_array

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = [
    "BELLY_HEIGHTS",
    "POSE_COLUMNS",
    "Belly",
    "BodyKind",
    "Disc",
    "Lane",
    "belly_corners",
    "belly_polygons",
    "bodies_of",
    "body_poses",
    "discs_in",
    "end_discs",
    "is_centered_pair",
    "two_discs",
]

Disc = tuple[float, float, float]
"""[m] Centre (x, y) in the chassis frame, and radius."""


def end_discs(discs: Sequence[Disc]) -> tuple[Disc, Disc]:
    """Find the rearmost and the foremost disc; the higher one if two reach equally far.

    Examples
    --------
    >>> end_discs([(0.3, 0.1, 0.04), (-0.2, 0.0, 0.06), (0.2, 0.0, 0.06)])
    ((-0.2, 0.0, 0.06), (0.3, 0.1, 0.04))
    """
    if is_centered_pair(discs):
        return discs[0], discs[1]  # even if one encloses the other, which is refused later
    rear = max(discs, key=lambda disc: (disc[2] - disc[0], disc[1]))
    front = max(discs, key=lambda disc: (disc[2] + disc[0], disc[1]))
    return rear, front


def two_discs(axle_distance: float, rear: float, front: float) -> tuple[Disc, Disc]:
    """Place two discs of given radii [m] with the chassis frame midway between them."""
    half = 0.5 * axle_distance
    return (-half, 0.0, rear), (half, 0.0, front)


def discs_in(outline: Mapping[str, Any]) -> Sequence[Disc]:
    """Read the discs of an outline in JSON."""
    if "discs" in outline:
        return [(x, y, radius) for x, y, radius in outline["discs"]]
    distance, rear, front = (
        outline[name] for name in ("axle_distance", "rear_radius", "front_radius")
    )
    return two_discs(distance, rear, front)


def is_centered_pair(discs: Sequence[Disc]) -> bool:
    """Whether two discs are placed as by `two_discs`, so distance and radii define them."""
    if len(discs) != 2:
        return False
    (rear, rear_y, _), (front, front_y, _) = discs
    return rear < 0.0 and front == -rear and rear_y == 0.0 and front_y == 0.0


Belly = tuple[tuple[float, float], ...]
"""[m] The underside of the chassis: a convex polygon in its frame, counter-clockwise."""

BELLY_HEIGHTS = "robot.belly[*][1]"
"""Path of the heights of all corners of a belly."""


def belly_polygons(belly: Any) -> list[NDArray[np.float64]]:
    """[m] List the convex polygons of a belly, from a robot or JSON; empty for None."""
    return [] if belly is None else [np.array(belly, dtype=np.float64)]


def belly_corners(belly: Any) -> NDArray[np.float64]:
    """[m] Return all corners of a belly, shape (n, 2).

    Examples
    --------
    >>> belly_corners(((-0.1, 0.0), (0.1, 0.0), (0.0, 0.1)))[:, 1].tolist()
    [0.0, 0.0, 0.1]
    >>> belly_corners(None).shape
    (0, 2)
    """
    return np.vstack([np.empty((0, 2)), *belly_polygons(belly)])


POSE_COLUMNS = ("position", "chassis_angle", "drive_positions", "shoe_poses", "flipper_angles")
"""Columns of a run that determine the poses of all bodies."""


class BodyKind(IntEnum):
    """What a body represents: `kind` of `Run.bodies`, `body_kind` of the contacts.

    Examples
    --------
    >>> BodyKind(4).name, BodyKind.GROUSER == 4
    ('GROUSER', True)
    """

    WHEEL = 0
    BELT = 1
    SKID = 2
    BELLY = 3
    GROUSER = 4
    """A grouser of a belt or shoe."""
    SHOE = 5
    """The plate of a shoe, or a whole tapering shoe."""
    GUIDE = 6
    """The rail that a chain of shoes slides on."""
    SPROCKET = 7
    IDLER = 8
    ROAD_WHEEL = 9
    ROLLER = 10
    """A return roller, under the upper run of a chain."""

    @property
    def is_in_chain(self) -> bool:
        """Whether shoes run around it."""
        return self >= BodyKind.GUIDE


class Lane(IntEnum):
    """The part of the robot above a stretch of ground: `lane` of all tables."""

    BOTH = 0
    """Under both tracks."""
    LEFT = 1
    RIGHT = 2
    MIDDLE = 3
    """Under the belly, if it has separate ground."""


def bodies_of(text: str) -> Table:
    """List the bodies of the robot of a scenario in JSON; see `Run.bodies`."""
    columns = _core.geometry(text)["bodies"]
    outlines = np.empty(len(columns["outline"]), dtype=object)
    for row, outline in enumerate(columns["outline"]):
        outlines[row] = freeze_array(outline)
    return Table({**columns, "outline": outlines})


def body_poses(text: str, trace: Mapping[str, Any]) -> dict[str, NDArray[np.float64]]:
    """Compute the poses of all bodies at n samples of a run.

    Parameters
    ----------
    text : str
        The scenario in JSON.
    trace : mapping of str to ndarray
        Columns of the run, at least those in `POSE_COLUMNS`.

    Returns
    -------
    dict
        `bodies`: [m, m, rad] of each of k bodies, shape (n, k, 3); `arms`: the same of the flippers
        at each end, midway between their axles; `travels`: [m] distance that the surface of each
        body has moved relative to its carrier, shape (n, k); `center_of_mass`: [m], shape (n, 2).
    """
    return _core.poses(text, dict(trace))
