"""The tables of the paper that introduced gear wheels, for comparison with ours.

The paper is "Gear Wheels based Simulation of Crawlers for Mobile Robot Servosila Engineer".
Nothing here enters a simulation.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

__all__ = [
    "CWA_GEAR",
    "CWA_ROUND",
    "LWA_GEAR",
    "LWA_ROUND",
    "REAL_ROBOT",
    "TABLE_1",
    "TABLE_2",
    "TABLE_3",
    "Performance",
    "RealRobot",
    "Success",
]

REAL_ROBOT = "real robot"
CWA_ROUND = "CWA, small standard fixed wheels"
LWA_ROUND = "LWA, large standard fixed wheels"
CWA_GEAR = "CWA, small gear wheels"
LWA_GEAR = "LWA, large gear wheels"

_REVOLUTION_A_MINUTE = 2.0 * math.pi / 60.0


@dataclass(frozen=True, slots=True, kw_only=True)
class RealRobot:
    """Table 1: measured on the robot, or declared by its maker."""

    max_speed: float
    """[m/s] The paper assumes that it is limited by a low-level controller."""
    declared_max_speed: float
    """[m/s]"""
    max_turn_rate: float
    """[rad/s]"""
    max_slope: float
    """[rad]"""
    declared_max_slope: float
    """[rad]"""
    stopping_distance: float
    """[m] From full speed."""


TABLE_1 = RealRobot(
    max_speed=0.4,
    declared_max_speed=1.39,
    max_turn_rate=8.5 * _REVOLUTION_A_MINUTE,
    max_slope=math.radians(45.0),
    declared_max_slope=math.radians(35.0),
    stopping_distance=0.01,
)


@dataclass(frozen=True, slots=True, kw_only=True)
class Success:
    """A row of Table 2: the share of 20 runs that crossed a random step environment (RSE)."""

    obstacle: str
    cwa: float
    lwa: float
    gear: float


TABLE_2 = (
    Success(obstacle="random RSE", cwa=0.0, lwa=0.15, gear=1.0),
    Success(obstacle="horizontal barrier", cwa=0.0, lwa=0.10, gear=1.0),
    Success(obstacle="diagonal barrier", cwa=0.0, lwa=0.0, gear=0.40),
)


@dataclass(frozen=True, slots=True, kw_only=True)
class Performance:
    """A row of Table 3."""

    model: str
    max_speed: float
    """[m/s]"""
    max_height: float
    """[m] Height of a parallelepiped on flat ground; this robot has flippers."""
    max_turn_rate: float
    """[rad/s] Turning about the vertical, which a side view does not have."""
    braking_distance: float
    """[m]"""
    acceleration: float
    """[m/s^2]"""
    real_time_factor: float
    """[-] Real-time factor of Gazebo."""


TABLE_3 = tuple(
    Performance(
        model=model,
        max_speed=speed,
        max_height=height,
        max_turn_rate=turns * _REVOLUTION_A_MINUTE,
        braking_distance=braking,
        acceleration=acceleration,
        real_time_factor=factor,
    )
    for model, speed, height, turns, braking, acceleration, factor in (
        (REAL_ROBOT, 0.4, 0.20, 8.5, 0.02, 0.2, 1.0),
        (CWA_ROUND, 0.5, 0.10, 4.0, 1.0, 0.1, 0.2),
        (LWA_ROUND, 0.4, 0.15, 2.0, 1.0, 0.1, 0.65),
        (CWA_GEAR, 0.4, 0.20, 2.0, 0.5, 0.1, 0.18),
        (LWA_GEAR, 0.4, 0.20, 4.0, 0.3, 0.2, 0.65),
    )
)
