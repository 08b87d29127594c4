"""A robot on a chain of shoes, engine-neutral: two toothed ends, a hull, shoes on pins.

The pins of the straight runs lie one radius below and above the axles, a whole number of pitches
apart. Round an end they are the corners of a polygon with as many corners as the sprocket has
teeth. So the pitch follows from the counts and the axle distance, and the chain closes without
slack. Hull and discs leave it a clearance of one millimetre.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from benches.peers.motion import Array

TEETH = {22: 8, 36: 12, 44: 16}
"""Teeth of one sprocket, by the number of shoes."""
SPEED = 0.4
"""[m/s] Speed of the chain."""
TORQUE = 30.0
"""[N m] Limit of the only motor, at the rear sprocket."""
FRICTION = 0.9
"""[-] Between shoes and ground."""
HULL_FRICTION, DISC_FRICTION, TOOTH_FRICTION = 0.1, 0.3, 0.1
"""[-] Between shoes and the robot."""
DROP = 0.002
"""[m] Height from which the robot falls at the start."""

_AXLE_DISTANCE = 0.576
# [kg]
_HULL_MASS, _SPROCKET_MASS, _CHAIN_MASS = 13.0, 1.5, 3.96
# [kg m^2] Inertia of a box 0.6 m long, and of a disc.
_HULL_INERTIA, _SPROCKET_INERTIA = 0.4008, 0.0048
# [m]
_THICKNESS, _SLACK = 0.0146, 0.001
# [m] Depth below the pins at which the teeth begin and end, and the lugs end.
_TOOTH_ROOT, _TOOTH_TIP, _LUG_TIP = 0.0396, 0.0146, 0.0253
# [-] Widths, in pitches.
_TOOTH_BASE, _TOOTH_END, _LUG_BASE, _LUG_END = 0.333, 0.229, 0.292, 0.167


@dataclass(frozen=True)
class ChainRobot:
    """The robot with a number of shoes.

    Attributes
    ----------
    shoe_count : int
        Shoes of the chain.
    """

    shoe_count: int

    axle_distance = _AXLE_DISTANCE
    """[m]"""
    hull_mass, hull_inertia = _HULL_MASS, _HULL_INERTIA
    """[kg], [kg m^2]"""
    sprocket_mass, sprocket_inertia = _SPROCKET_MASS, _SPROCKET_INERTIA
    """[kg], [kg m^2] Of each sprocket."""
    chain_mass = _CHAIN_MASS
    """[kg]"""
    plate_thickness = _THICKNESS
    """[m]"""

    @property
    def tooth_count(self) -> int:
        """Number of teeth of one sprocket."""
        return TEETH[self.shoe_count]

    @property
    def pitch(self) -> float:
        """[m] Distance from pin to pin."""
        return 2.0 * _AXLE_DISTANCE / (self.shoe_count - self.tooth_count)

    @property
    def pin_radius(self) -> float:
        """[m] Distance from an axle to the pins round it."""
        return self.pitch / (2.0 * math.sin(math.pi / self.tooth_count))

    @property
    def radius(self) -> float:
        """[m] Distance from an axle to the ground."""
        return self.pin_radius + _THICKNESS / 2.0

    @property
    def mass(self) -> float:
        """[kg] Mass of the whole robot."""
        return _HULL_MASS + 2.0 * _SPROCKET_MASS + _CHAIN_MASS

    @property
    def shoe_mass(self) -> float:
        """[kg] Mass of one shoe."""
        return _CHAIN_MASS / self.shoe_count

    @property
    def shoe_inertia(self) -> float:
        """[kg m^2] Moment of inertia of a shoe, taken as a plate."""
        return self.shoe_mass * (self.pitch**2 + _THICKNESS**2) / 12.0

    @property
    def moment_of_inertia(self) -> float:
        """[kg m^2] Moment of inertia of the whole robot about its middle."""
        x, y, _ = self.shoes().T
        ends = 2.0 * (_SPROCKET_INERTIA + _SPROCKET_MASS * (_AXLE_DISTANCE / 2.0) ** 2)
        shoes = self.shoe_count * self.shoe_inertia + self.shoe_mass * float((x**2 + y**2).sum())
        return _HULL_INERTIA + ends + shoes

    @property
    def sprocket_speed(self) -> float:
        """[rad/s] Speed at which the teeth move the chain at the commanded speed."""
        return -SPEED * 2.0 * math.pi / (self.tooth_count * self.pitch)

    def pins(self) -> Array:
        """[m] Pins relative to the robot's middle, each at the rear end of a shoe; (shoes, 2)."""
        half, count = _AXLE_DISTANCE / 2.0, self.tooth_count // 2
        straight = (self.shoe_count - self.tooth_count) // 2
        lower = [(-half + i * self.pitch, -self.pin_radius) for i in range(straight)]
        turn = [-math.pi / 2.0 + math.pi * i / count for i in range(count)]
        front = [
            (half + self.pin_radius * math.cos(a), self.pin_radius * math.sin(a)) for a in turn
        ]
        ahead = np.array([*lower, *front])
        return np.concatenate([ahead, -ahead])

    def shoes(self) -> Array:
        """[m], [m], [rad] Poses relative to the middle of the robot, shape (shoes, 3)."""
        rear = self.pins()
        front = np.roll(rear, -1, axis=0)
        angle = np.arctan2(*(front - rear).T[::-1])
        return np.column_stack([(rear + front) / 2.0, angle])

    def plate(self) -> Array:
        """[m] Corners of a plate in the shoe's frame; 6 % short, so neighbours do not touch."""
        x, y = 0.47 * self.pitch, _THICKNESS / 2.0
        return np.array([(-x, -y), (x, -y), (x, y), (-x, y)])

    def lug(self) -> Array:
        """[m] Corners of the lug that goes between the teeth, in the shoe's frame."""
        base, tip = 0.5 * _LUG_BASE * self.pitch, 0.5 * _LUG_END * self.pitch
        low = _THICKNESS / 4.0
        return np.array([(base, low), (tip, _LUG_TIP), (-tip, _LUG_TIP), (-base, low)])

    def disc_radius(self) -> float:
        """[m] Radius of the disc that carries the plates round an end."""
        return self._apothem() - _THICKNESS / 2.0 - _SLACK

    def teeth(self) -> list[Array]:
        """[m] Corners of the teeth in the sprocket's frame, one tooth at each pin."""
        root, tip = self._apothem() - _TOOTH_ROOT, self._apothem() - _TOOTH_TIP
        base, end = 0.5 * _TOOTH_BASE * self.pitch, 0.5 * _TOOTH_END * self.pitch
        tooth = np.array([(root, -base), (tip, -end), (tip, end), (root, base)])
        turns = -math.pi / 2.0 + 2.0 * math.pi * np.arange(self.tooth_count) / self.tooth_count
        return [
            tooth @ np.array([(math.cos(a), math.sin(a)), (-math.sin(a), math.cos(a))])
            for a in turns
        ]

    def hull(self) -> Array:
        """[m] Corners of the hull that carries the straight runs, in the chassis frame."""
        y = self.pin_radius - _THICKNESS / 2.0 - _SLACK
        below = [(-0.258, -y + 0.015), (-0.208, -y), (0.208, -y), (0.258, -y + 0.015)]
        return np.array([*below, *((-a, -b) for a, b in below)])

    def _apothem(self) -> float:
        return self.pin_radius * math.cos(math.pi / self.tooth_count)
