"""Where something is and how it is turned, in a frame."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

__all__ = ["Array", "Pose", "from_quaternion", "from_rpy", "unit"]

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Pose:
    """A frame seen from another one.

    Parameters
    ----------
    place : ndarray, shape (3,)
        [m] Its origin.
    turn : ndarray, shape (3, 3)
        [-] Its axes, as columns.

    Examples
    --------
    >>> import math
    >>> ahead = Pose(place=np.array([1.0, 0.0, 0.0]))
    >>> ahead.then(from_rpy((0.0, 0.0, math.pi / 2))).at((1.0, 0.0, 0.0)).round(9).tolist()
    [1.0, 1.0, 0.0]
    """

    place: Array = field(default_factory=lambda: np.zeros(3))
    turn: Array = field(default_factory=lambda: np.eye(3))

    def then(self, inner: Pose) -> Pose:
        """Return what is given in this frame, seen from where this one is."""
        return Pose(place=self.at(inner.place), turn=self.turn @ inner.turn)

    def seen_from(self, frame: Pose) -> Pose:
        """Return this frame, seen from another one that is given in the same frame."""
        return Pose(place=frame.turn.T @ (self.place - frame.place), turn=frame.turn.T @ self.turn)

    @property
    def rpy(self) -> tuple[float, float, float]:
        """[rad] Roll about x, then pitch about y, then yaw about z, all of them fixed axes."""
        turn = self.turn
        level = math.hypot(turn[0, 0], turn[1, 0])
        pitch = math.atan2(-turn[2, 0], level)
        if level < 1e-9:  # x points up or down: roll and yaw turn about one axis
            return math.atan2(-turn[1, 2], turn[1, 1]), pitch, 0.0
        roll = math.atan2(turn[2, 1], turn[2, 2])
        return roll, pitch, math.atan2(turn[1, 0], turn[0, 0])

    @property
    def quaternion(self) -> tuple[float, float, float, float]:
        """[-] The turn as a quaternion, its real part first."""
        cr, cp, cy = (math.cos(0.5 * angle) for angle in self.rpy)
        sr, sp, sy = (math.sin(0.5 * angle) for angle in self.rpy)
        return (
            cr * cp * cy + sr * sp * sy,
            sr * cp * cy - cr * sp * sy,
            cr * sp * cy + sr * cp * sy,
            cr * cp * sy - sr * sp * cy,
        )

    def at(self, point: Sequence[float] | Array) -> Array:
        """[m] Return a point of this frame, shape (3,), or several, shape (n, 3)."""
        moved: Array = np.asarray(point, dtype=float) @ self.turn.T + self.place
        return moved

    def along(self, direction: Sequence[float] | Array) -> Array:
        """Return a direction of this frame."""
        turned: Array = self.turn @ np.asarray(direction, dtype=float)
        return turned


def from_rpy(angles: Sequence[float], place: Sequence[float] = (0.0, 0.0, 0.0)) -> Pose:
    """Turn by roll about x, then pitch about y, then yaw about z [rad], all of them fixed axes."""
    (cr, sr), (cp, sp), (cy, sy) = ((math.cos(a), math.sin(a)) for a in angles)
    turn = np.array(
        [
            [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
            [-sp, cp * sr, cp * cr],
        ]
    )
    return Pose(place=np.array(place, dtype=float), turn=turn)


def from_quaternion(wxyz: Sequence[float], place: Sequence[float] = (0.0, 0.0, 0.0)) -> Pose:
    """Turn by a quaternion of any length but 0, its real part first."""
    w, x, y, z = np.asarray(wxyz, dtype=float) / math.hypot(*wxyz)
    turn = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )
    return Pose(place=np.array(place, dtype=float), turn=turn)


def unit(vector: Sequence[float] | Array) -> Array | None:
    """Return the direction of a vector; None if it has none."""
    length = math.hypot(*vector)
    return None if length < 1e-9 else np.asarray(vector, dtype=float) / length
