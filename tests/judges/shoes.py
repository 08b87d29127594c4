"""Shoes of a chain for the second judge: their motion, and which of them pinch."""

import numpy as np
from numpy.typing import NDArray

from crawler2d.parameters.robot import Robot
from tests.judges.geometry import Array

# [rad] Two shoes on a straight run are less bent.
BENT = 0.05


def pieces_of_a_shoe(robot: Robot) -> int:
    """How many numbers a shoe has: a plate and a grouser have two, one body has one."""
    shape = getattr(robot.track, "shoe_shape", "")
    return 2 if shape == "rectangle" and robot.outline.grouser_height > 0.0 else 1


class Shoes:
    """The shoes of a run at chosen samples; each chain has `count` of them."""

    def __init__(self, poses: Array, chains: int) -> None:
        self.poses = poses
        self.count: int = poses.shape[1] // chains

    def beside(self, shoe: int, steps: int) -> int:
        """The shoe a number of places ahead in the same chain."""
        first = shoe - shoe % self.count
        return first + (shoe - first + steps) % self.count

    def motion(self, shoe: int, samples: NDArray[np.int64], points: Array) -> Array:
        """[-] Velocity of points of a shoe for a speed of the chain of 1, the chassis at rest.

        As the chain goes on, a shoe takes the place of the next one: on a run straight ahead, round
        an end about its axle. Its neighbours' places tell both.
        """
        behind, ahead = (self.poses[samples, self.beside(shoe, k)] for k in (-1, 1))
        first = shoe - shoe % self.count
        chain = self.poses[samples[0], first : first + self.count, :2]
        # Pins are a pitch apart; shoes are as far from each other where the chain is straight.
        pitch = np.hypot(*(np.roll(chain, -1, axis=0) - chain).T).max()
        turn = _wrapped(ahead[:, 2] - behind[:, 2])
        half = 0.5 * turn
        straight = abs(half) < 1e-6
        safe = np.where(straight, 1.0, half)
        share = np.where(straight, 1.0, safe / np.tan(safe)) / (2.0 * pitch)
        middle = 0.5 * (ahead[:, :2] + behind[:, :2])
        spokes = points - middle
        left = np.column_stack([-spokes[:, 1], spokes[:, 0]])
        way = ahead[:, :2] - behind[:, :2]
        return np.asarray(way * share[:, None] + left * (turn / (2.0 * pitch))[:, None])

    def closes(
        self, one: int, other: int, samples: NDArray[np.int64], chassis: Array, ahead: float
    ) -> bool:
        """Whether the gap between two shoes closes: bent apart at the end that goes ahead.

        `chassis` has x, y and angle at those samples.
        """
        if other not in (self.beside(one, 1), self.beside(one, -1)):
            return False
        a, b = self.poses[samples, one], self.poses[samples, other]
        bent = abs(_wrapped(a[:, 2] - b[:, 2])).mean() > BENT
        forward = np.column_stack([np.cos(chassis[:, 2]), np.sin(chassis[:, 2])])
        place = ((0.5 * (a + b)[:, :2] - chassis[:, :2]) * forward).sum(axis=1).mean()
        return bool(bent and ahead * place > 0.0)


def _wrapped(angle: Array) -> Array:
    return np.asarray((angle + np.pi) % (2.0 * np.pi) - np.pi)
