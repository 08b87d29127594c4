"""Balance of the second judge: of the whole robot and of each drive, by a linear program."""

import math
from dataclasses import dataclass

import numpy as np
from scipy.optimize import linprog  # type: ignore[import-untyped]

from judge_geometry import Array, cross, right_of

Range = tuple[float, float]


@dataclass
class Bearing:
    """A contact in the mean: forces on the robot, levers about its centre of mass."""

    body: int
    drive: int
    """-1: none moves its surface."""
    point: Array
    arm: Array
    normal: Array
    motion: Array
    """Velocity of the surface over the chassis for a surface speed of 1 of its drive."""
    friction: float
    normal_force: float = 0.0
    friction_force: float = 0.0
    surface_speed: float = 0.0
    slides: bool = False
    piece: int = -1

    @property
    def tangent(self) -> Array:
        return right_of(self.normal)

    @property
    def pin(self) -> float | None:
        """[-] Friction per normal force where it slides; None: free in its cone."""
        return -math.copysign(self.friction, self.surface_speed) if self.slides else None


@dataclass(frozen=True, kw_only=True)
class Balance:
    """What has to be in balance; forces count in weights."""

    drives: int
    half_length: float
    """[m] Moments count over it."""
    push: Array | None = None
    """Direction in which one motor pushes the chassis itself, instead of turning surfaces."""
    push_arm: float = 0.0
    """[m] Lever of that push about the centre of mass."""

    def imbalance(
        self, contacts: list[Bearing], pins: list[float | None], motors: list[Range]
    ) -> float:
        """[-] Least share of the weight that no choice of forces balances.

        A pin is the friction per normal force of a contact that slides; None leaves it free in its
        cone. Each motor has a range of forces.
        """
        n = len(contacts)
        # Unknown: normal forces, friction forces, motors, and what is missed by at most.
        count = 2 * n + len(motors) + 1
        rows = np.zeros((3 + self.drives, count))
        target = np.zeros(3 + self.drives)
        target[1] = 1.0
        for i, contact in enumerate(contacts):
            for column, u in ((i, contact.normal), (n + i, contact.tangent)):
                rows[:2, column] = u
                rows[2, column] = cross(contact.arm, u) / self.half_length
                if contact.drive >= 0:
                    rows[3 + contact.drive, column] = u @ contact.motion
        for j in range(len(motors)):
            if self.push is None:
                rows[3 + j, 2 * n + j] = 1.0
            else:
                rows[:2, 2 * n + j] = self.push
                rows[2, 2 * n + j] = self.push_arm / self.half_length
        upper = np.vstack([rows, -rows])
        upper[:, -1] = -1.0
        cone, equal = [], []
        for i, (contact, pin) in enumerate(zip(contacts, pins, strict=True)):
            for sign in (1.0, -1.0) if pin is None else ():
                row = np.zeros(count)
                row[i], row[n + i] = -contact.friction, sign
                cone.append(row)
            if pin is not None:
                row = np.zeros(count)
                row[i], row[n + i] = -pin, 1.0
                equal.append(row)
        bounds: list[tuple[float | None, float | None]] = [(0.0, None)] * n + [(None, None)] * n
        bounds += [*motors, (0.0, None)]
        goal = np.zeros(count)
        goal[-1] = 1.0
        result = linprog(
            goal,
            A_ub=np.vstack([upper, *cone]),
            b_ub=np.concatenate([target, -target, np.zeros(len(cone))]),
            A_eq=np.vstack(equal) if equal else None,
            b_eq=np.zeros(len(equal)) if equal else None,
            bounds=bounds,
            method="highs",
        )
        assert result.status == 0, result.message
        return float(result.fun)
