"""Balance for the second judge, of the whole robot and of each drive, by a linear program."""

import math
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linprog  # type: ignore[import-untyped]

from tests.judges.geometry import Array, cross, right_of

Range = tuple[float, float]


@dataclass
class Bearing:
    """An averaged contact: forces on the robot, levers about its centre of mass."""

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
    pieces: tuple[int, ...] = ()
    """Of the ground inside the track, that it bears on: one of each belt at most."""
    kind: int = 0
    """As in the tables."""
    lane: int = 0
    samples: NDArray[np.int64] = field(default_factory=lambda: np.zeros(0, dtype=np.int64))
    """When it bore, as numbers of samples."""
    carrier: int = 0
    """0: the chassis; else one of its arms."""
    pivot_arm: Array | None = None
    """Of a contact of an arm: lever about its pivot."""

    @property
    def tangent(self) -> Array:
        return right_of(self.normal)

    @property
    def pin(self) -> float | None:
        """[-] Friction per normal force where it slides; None: free in its cone."""
        return -math.copysign(self.friction, self.surface_speed) if self.slides else None


@dataclass(frozen=True, kw_only=True)
class Hinge:
    """An arm on its pivot, whose motor has a limit; forces count in weights."""

    carrier: int
    weight_arm: float
    """[m] Lever of its weight about the pivot, times its share of the robot's."""
    torque: float
    """[m] Of its motor at most."""


@dataclass(frozen=True, kw_only=True)
class Balance:
    """Everything that has to balance, with forces in weights."""

    drives: int
    half_length: float
    """[m] Moments count over it."""
    push: Array | None = None
    """Direction in which one motor pushes the chassis itself, instead of turning surfaces."""
    push_arm: float = 0.0
    """[m] Lever of that push about the centre of mass."""
    hinges: tuple[Hinge, ...] = ()
    drive_radius: float = 0.0
    """[m] Of the sprocket on a pivot: an arm that turns about it runs its belt by as much."""

    def imbalance(
        self, contacts: list[Bearing], pins: list[float | None], motors: list[Range]
    ) -> float:
        """[-] Smallest residual for any choice of forces, as a fraction of the weight.

        A pin is the friction per normal force of a contact that slides; None leaves it free in its
        cone. Each motor has a range of forces.
        """
        n = len(contacts)
        # Unknown: normal forces, friction forces, motors, those of arms, what is missed by at most.
        first_hinge = 2 * n + len(motors)
        count = first_hinge + len(self.hinges) + 1
        rows = np.zeros((3 + self.drives + len(self.hinges), count))
        target = np.zeros(len(rows))
        target[1] = 1.0
        for k, hinge in enumerate(self.hinges):
            target[3 + self.drives + k] = hinge.weight_arm / self.half_length
            rows[3 + self.drives + k, first_hinge + k] = 1.0
        for i, contact in enumerate(contacts):
            for column, u in ((i, contact.normal), (n + i, contact.tangent)):
                rows[:2, column] = u
                rows[2, column] = cross(contact.arm, u) / self.half_length
                if contact.drive >= 0:
                    rows[3 + contact.drive, column] = u @ contact.motion
                for k, hinge in enumerate(self.hinges):
                    if contact.carrier == hinge.carrier and contact.pivot_arm is not None:
                        lever = cross(contact.pivot_arm, u) + self.drive_radius * u @ contact.motion
                        rows[3 + self.drives + k, column] = lever / self.half_length
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
        bounds += motors
        of_hinges = [hinge.torque / self.half_length for hinge in self.hinges]
        bounds += [*((-torque, torque) for torque in of_hinges), (0.0, None)]
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
