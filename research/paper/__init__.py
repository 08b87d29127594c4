"""The paper that introduced gear wheels: its tables, and when one of our rates agrees with it.

The paper is "Gear Wheels based Simulation of Crawlers for Mobile Robot Servosila Engineer"; `python
-m research paper` reproduces it. Nothing here enters a simulation.
"""

import math
from dataclasses import dataclass
from typing import NamedTuple

import crawler2d as c2d

RPM = 2.0 * math.pi / 60.0
"""[rad/s] One revolution a minute."""

REAL_ROBOT = "real robot"
CWA_ROUND = "CWA, small standard fixed wheels"
LWA_ROUND = "LWA, large standard fixed wheels"
CWA_GEAR = "CWA, small gear wheels"
LWA_GEAR = "LWA, large gear wheels"
GEAR_MODEL = "model with gear wheels"
"""The last column of the paper's Table 2."""
GEAR_MODEL_OTHERWISE = "model with gear wheels, read otherwise"
"""The same column, because the text does not say which of two models with gear wheels it means."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RealRobot:
    """Table 1: values measured on the robot, or declared by its maker."""

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
    """[m] Stopping distance from full speed."""


TABLE_1 = RealRobot(
    max_speed=0.4,
    declared_max_speed=1.39,
    max_turn_rate=8.5 * RPM,
    max_slope=math.radians(45.0),
    declared_max_slope=math.radians(35.0),
    stopping_distance=0.01,
)


class Success(NamedTuple):
    """A row of Table 2: the fraction of 20 runs that crossed a random step environment (RSE)."""

    obstacle: str
    cwa: float
    lwa: float
    gear: float

    @property
    def columns(self) -> dict[str, float]:
        """The fractions by column, with both readings of the gear wheels."""
        gears = dict.fromkeys((GEAR_MODEL, GEAR_MODEL_OTHERWISE), self.gear)
        return {CWA_ROUND: self.cwa, LWA_ROUND: self.lwa, **gears}


TABLE_2 = (
    Success("random RSE", 0.0, 0.15, 1.0),
    Success("horizontal barrier", 0.0, 0.10, 1.0),
    Success("diagonal barrier", 0.0, 0.0, 0.40),
)


class Performance(NamedTuple):
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


TABLE_3 = (
    Performance(REAL_ROBOT, 0.4, 0.20, 8.5 * RPM, 0.02, 0.2, 1.0),
    Performance(CWA_ROUND, 0.5, 0.10, 4.0 * RPM, 1.0, 0.1, 0.2),
    Performance(LWA_ROUND, 0.4, 0.15, 2.0 * RPM, 1.0, 0.1, 0.65),
    Performance(CWA_GEAR, 0.4, 0.20, 2.0 * RPM, 0.5, 0.1, 0.18),
    Performance(LWA_GEAR, 0.4, 0.20, 4.0 * RPM, 0.3, 0.2, 0.65),
)

PAPER_RUNS = 20
"""Runs behind each percentage of the paper's Table 2."""

WITHIN = 0.15
"""[-] Rates that differ by no more than this agree: three of the paper's 20 runs."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Agreement:
    """The difference between one of our rates and one of the paper."""

    difference: float
    """[-] Our rate minus the paper's."""
    low: float
    """[-] Bounds of Newcombe's 95 % interval for binomial rates."""
    high: float
    verdict: str
    """"agrees" within `WITHIN`; else "differs", or "open" if the interval holds 0."""


def agreement(successes: int, count: int, share: float, runs: int = PAPER_RUNS) -> Agreement:
    """Compare one of our rates with a percentage of the paper.

    The verdict is about the observed rates. With 20 runs on one side, no interval is ever within
    `WITHIN`: 0 of 20 against 0 of 100 gives -0.16 to 0.04.

    Parameters
    ----------
    successes, count : int
        Ours.
    share : float
        [-] The paper's, a whole number of its runs.
    runs : int
        How many runs the paper made.

    Raises
    ------
    ValueError
        If the share is impossible with this number of runs, or we have no runs.

    Examples
    --------
    >>> agreement(90, 100, 1.0).verdict, agreement(50, 100, 1.0).verdict
    ('agrees', 'differs')
    >>> agreement(3, 5, 0.4).verdict
    'open'
    """
    theirs = round(share * runs)
    if abs(theirs - share * runs) > 1e-9 * runs:
        raise ValueError(f"share must be a whole number of {runs} runs, got {share}")
    difference, low, high = c2d.newcombe(successes, count, theirs, runs)
    # Rates are ratios of small integers: 0.15 is not an exact binary fraction.
    if abs(difference) <= WITHIN + 1e-12:
        verdict = "agrees"
    else:
        verdict = "open" if low <= 0.0 <= high else "differs"
    return Agreement(difference=difference, low=low, high=high, verdict=verdict)
