"""The bodies of a robot: what they are, how they look and where they are."""

from __future__ import annotations

from enum import IntEnum
from typing import TYPE_CHECKING, Any

import numpy as np

from crawler2d import _core
from crawler2d.common.frozen import read_only
from crawler2d.common.table import Table

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

__all__ = ["TRACED", "BodyKind", "Lane", "bodies_of", "moved"]

TRACED = ("position", "chassis_angle", "drive_positions", "shoe_poses", "flipper_angles")
"""Columns of a run that the poses of all bodies follow from."""


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
    """On a belt or on a shoe."""
    SHOE = 5
    """The plate of a shoe, or all of a tapering shoe."""
    GUIDE = 6
    """What a chain of shoes slides on."""
    SPROCKET = 7
    IDLER = 8
    ROAD_WHEEL = 9
    ROLLER = 10
    """A return roller, under the upper run of a chain."""

    @property
    def is_in_chain(self) -> bool:
        """Whether shoes run round it."""
        return self >= BodyKind.GUIDE


class Lane(IntEnum):
    """Which part of the robot a stretch of ground is under: `lane` of all tables."""

    BOTH = 0
    """Under both tracks."""
    LEFT = 1
    RIGHT = 2
    MIDDLE = 3
    """Under the belly, where that has ground of its own."""


def bodies_of(text: str) -> Table:
    """List the bodies of the robot of a scenario in JSON; see `Run.bodies`."""
    columns = _core.geometry(text)["bodies"]
    outlines = np.empty(len(columns["outline"]), dtype=object)
    for row, outline in enumerate(columns["outline"]):
        outlines[row] = read_only(outline)
    return Table({**columns, "outline": outlines})


def moved(text: str, trace: Mapping[str, Any]) -> dict[str, NDArray[np.float64]]:
    """Compute the poses of all bodies at n samples of a run.

    Parameters
    ----------
    text : str
        The scenario in JSON.
    trace : mapping of str to ndarray
        Columns of the run, at least those that `TRACED` names.

    Returns
    -------
    dict
        `bodies`: [m, m, rad] of each of k bodies, shape (n, k, 3); `arms`: the same of the flippers
        at each end, midway between their axles; `travels`: [m] distance that the surface of each
        body has moved relative to its carrier, shape (n, k); `center_of_mass`: [m], shape (n, 2).
    """
    return _core.poses(text, dict(trace))
