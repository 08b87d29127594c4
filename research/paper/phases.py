"""Eq. (1) of the paper: the angles that gears start at, and how much these shake the robot."""

from __future__ import annotations

import math
from collections import Counter
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from crawler2d.common.bodies import BodyKind
from crawler2d.parameters.scenario import Scenario
from crawler2d.parameters.settings import Drive
from crawler2d.parameters.track import CircumferentialWheels, GearWheel, LineOfWheels
from crawler2d.presets import terrains
from crawler2d.presets.robots import engineer
from crawler2d.runs.batch import simulate_many
from research.paper.published import TABLE_1

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from crawler2d.parameters.robot import Robot
    from crawler2d.parameters.track import Track
    from crawler2d.runs.run import Run
    from research.paper.design import Work

__all__ = [
    "PHASED",
    "SHAKEN",
    "Phase",
    "Shaking",
    "gear_angles",
    "off_formula",
    "phases",
    "shaking",
]

PHASED: dict[str, Track] = {
    **{f"line of {count}": LineOfWheels(count, wheel=GearWheel()) for count in (2, 3, 4, 5, 9)},
    **{
        f"{count} all round": CircumferentialWheels(count, wheel_radius=0.02, wheel=GearWheel())
        for count in (16, 24)
    },
}
"""Gears whose angles are compared with the formula; those of the flippers are, too."""

SHAKEN = tuple((count, fraction) for count in (3, 5) for fraction in (0.0, 1.0 / 3.0, 0.5))
"""Wheels of a line and phase fraction: in step, as in eq. (1), at a half."""

# [s] When the speed is steady, and how long one looks at it: 17 grouser pitches at 0.4 m/s.
_STEADY, _LOOK = 3.0, 2.0
# [m] Corners that are as far from the axle lie this close to one circle.
_SAME = 1e-9


@dataclass(frozen=True, slots=True, kw_only=True)
class Phase:
    """The starting angles of the gears of one robot, beside eq. (1)."""

    model: str
    count: int
    """Gears of one side, with those of the flipper."""
    off: float
    """[rad] Largest difference from the formula."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Shaking:
    """How a line of gears shakes the robot on level ground at a steady speed."""

    count: int
    fraction: float
    """[-] Of the angle between two grousers, from wheel to wheel: a third in eq. (1)."""
    swing: float
    """[m] From the lowest to the highest position of the chassis."""
    rocking: float
    """[rad] From the smallest to the greatest angle of the chassis."""
    vibration: float
    """[m/s^2] Vertical acceleration over the whole run, root mean square."""


def phases(work: Work) -> list[Phase]:
    """Compare the starting angles of all gears with those of the formula."""
    robot = engineer().without_rotors()
    runs = _runs([robot.with_track(track) for track in PHASED.values()], work)
    return [
        Phase(
            model=model,
            count=len(found),
            off=max(off_formula(number, angle, pitch) for number, angle, pitch in found),
        )
        for model, run in zip(PHASED, runs, strict=True)
        for found in [gear_angles(run)]
    ]


def off_formula(number: int, angle: float, pitch: float) -> float:
    """[rad] Tell how far an angle is off eq. (1), x = theta / 3 n, up to whole grousers.

    Examples
    --------
    >>> round(off_formula(4, 0.1 + 1.0 / 3.0, 1.0), 3)
    0.1
    """
    turns = (angle - pitch / 3.0 * number) / pitch
    return abs(turns - round(turns)) * pitch


def gear_angles(run: Run) -> list[tuple[int, float, float]]:
    """Read the angles of all gears off their outlines, before anything has turned.

    Returns
    -------
    list of tuple of int, float and float
        For each gear its number n, counted from 1 at the rear on the chassis and on the flipper,
        and what `grouser_angle` gives.
    """
    found: list[tuple[int, float, float]] = []
    numbers: Counter[str] = Counter()
    columns = (run.bodies[name] for name in ("kind", "carrier", "outline"))
    for kind, carrier, outline in zip(*columns, strict=True):
        if kind == BodyKind.WHEEL and len(outline):
            numbers[carrier] += 1
            found.append((numbers[carrier], *grouser_angle(outline)))
    return found


def grouser_angle(outline: ArrayLike) -> tuple[float, float]:
    """Read the angle of a grouser off the outline of a gear, and theta of eq. (1).

    Parameters
    ----------
    outline : array_like, shape (n, 2)
        [m] Corners about the axle; those at the tips, two to a grouser, are the farthest.

    Returns
    -------
    tuple of 2 floats
        [rad] From the x axis to the middle of a grouser, up to whole grousers; and theta, from one
        grouser to the next.
    """
    corners = np.asarray(outline)
    far = np.hypot(*corners.T)
    tips = corners[far > far.max() - _SAME]
    grousers = len(tips) // 2
    angles = np.arctan2(tips[:, 1], tips[:, 0])
    middle = float(np.angle(np.mean(np.exp(1j * grousers * angles)))) / grousers
    return middle, 2.0 * math.pi / grousers


def shaking(work: Work) -> list[Shaking]:
    """Drive lines of gears over level ground."""
    tracks = [
        LineOfWheels(count, wheel=GearWheel(phase_fraction=fraction)) for count, fraction in SHAKEN
    ]
    robot = engineer(flippers=None).without_rotors()
    runs = _runs([robot.with_track(track) for track in tracks], work)
    found = []
    for (count, fraction), run in zip(SHAKEN, runs, strict=True):
        steady = run.time > _STEADY
        found.append(
            Shaking(
                count=count,
                fraction=fraction,
                swing=float(np.ptp(run.position[steady, 1])),
                rocking=float(np.ptp(run.chassis_angle[steady])),
                vibration=run.metrics["vertical_acceleration"],
            )
        )
    return found


def _runs(robots: list[Robot], work: Work) -> list[Run]:
    drive, ground = Drive(speed=TABLE_1.max_speed), terrains.flat()
    duration = _STEADY + _LOOK  # too short to reach the goal, where a run would end
    scenarios = [Scenario(robot, ground, drive=drive, duration=duration) for robot in robots]
    return simulate_many(scenarios, threads=work.threads, progress=False)
