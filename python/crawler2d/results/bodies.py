"""The bodies of a robot: what they are called, how they look and where they are."""

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

    from crawler2d.parameters.scenario import Scenario

__all__ = ["BodyKind", "Lane", "bodies_of", "moved"]


class BodyKind(IntEnum):
    """What a body stands for: `kind` of `Run.bodies`, `body_kind` of the contacts.

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
    """Of a belt or of a shoe."""
    SHOE = 5
    """Its plate, or all of a tapering one."""
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
    """What a stretch of ground lies under: `lane` of all tables."""

    BOTH = 0
    """Under both tracks."""
    LEFT = 1
    RIGHT = 2
    MIDDLE = 3
    """Under the belly, where that has ground of its own."""


def bodies_of(scenario: Scenario) -> Table:
    """List the bodies of a scenario's robot; see `Run.bodies`."""
    columns = _core.geometry(scenario.to_json())["bodies"]
    outlines = np.empty(len(columns["outline"]), dtype=object)
    for row, outline in enumerate(columns["outline"]):
        outlines[row] = read_only(outline)
    return Table({**columns, "outline": outlines})


def moved(scenario: Scenario, trace: Mapping[str, Any]) -> dict[str, NDArray[np.float64]]:
    """Find where everything was at the n samples of a run of a scenario.

    Returns
    -------
    dict
        `bodies`: [m, m, rad] of each of k bodies, shape (n, k, 3); `arms`: the same of the flippers
        at each end, midway between their axles; `travels`: [m] how far the surface of each body has
        run over what carries it, shape (n, k); `center_of_mass`: [m] of all that moves, (n, 2).
    """
    return _core.poses(scenario.to_json(), dict(trace))
