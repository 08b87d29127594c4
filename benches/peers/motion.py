"""The result of an engine: poses over time."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

# [s] Interval at which paths are compared.
_RASTER = 0.02


class Motion(NamedTuple):
    """The recorded motion of all bodies.

    Attributes
    ----------
    time : ndarray, shape (n,)
        [s] Time of each sample.
    poses : ndarray, shape (n, bodies, 3)
        [m], [m], [rad] Position and angle of each body.
    penetration : float
        [m] Deepest overlap with the ground that the engine itself reports, also between samples; 0
        if it reports none.
    """

    time: Array
    poses: Array
    penetration: float = 0.0

    @classmethod
    def of(cls, time: Any, poses: Any, penetration: float = 0.0) -> Motion:
        """Gather samples."""
        return cls(np.asarray(time, float), np.asarray(poses, float), penetration)

    def path(self) -> Array:
        """[m] Chassis x, y at equal time intervals, shape (m, 2)."""
        raster = np.arange(0.0, self.time[-1], _RASTER)
        chassis = self.poses[:, 0]
        return np.stack([np.interp(raster, self.time, chassis[:, i]) for i in (0, 1)], axis=1)

    def distance(self, other: Motion) -> float:
        """[m] Largest distance between the two paths at equal times."""
        a, b = self.path(), other.path()
        shared = min(len(a), len(b))
        return float(np.linalg.norm(a[:shared] - b[:shared], axis=1).max())
