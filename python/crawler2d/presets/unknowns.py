"""Ranges of the uncertain parameters of a robot and its floor, for `unknown` of sweeps.

They are constant but not known exactly, so they are sampled in an outer loop: each sample is a
possible robot on a possible floor, with its own rate.

>>> import crawler2d as c2d
>>> robot = c2d.robots.engineer(flippers=None)
>>> list(c2d.unknowns.of_robot(robot) | c2d.unknowns.of_ground())[:3]
['robot.center_of_mass[0]', 'robot.center_of_mass[1]', 'robot.drivetrain.max_torque']
"""

from __future__ import annotations

from collections.abc import Mapping

from crawler2d.common.bodies import BELLY_HEIGHTS
from crawler2d.errors import ScenarioError
from crawler2d.parameters.robot import Robot
from crawler2d.parameters.track import SegmentalTrack
from crawler2d.variation.distributions import (
    Distribution,
    LogUniform,
    Ranges,
    scaled,
    shifted,
    uniform,
)

__all__ = [
    "RUN_UP",
    "of_ground",
    "of_restitution",
    "of_robot",
]


def __dir__() -> list[str]:
    """List what is public, for completion."""
    return sorted(__all__)


Range = tuple[Distribution, str]

# [s] Time in which the rated torque accelerates a bare rotor to no-load speed. Gears do not change
# it, and it varies less than the inertia of motors of one power: of 38 types by maxon and
# Faulhaber, 20 to 330 W, eight in ten lie in this range, slotted rotors low, flat ones high. The
# rated torque is the one whose copper loss heats the winding to its limit, 14 % above the makers'
# figure for seven motors; k_t, R, inertia, speed and thermal resistances are from ekrimsk/MGDB
# (17337fa2). Five geared joints of the KUKA youBot have 0.03 to 0.06 s.
RUN_UP = (0.016, 0.1)

_X, _Y = "robot.center_of_mass[0]", "robot.center_of_mass[1]"
_MASS, _TORQUE = "robot.mass", "robot.drivetrain.max_torque"

ROTOR, ROTOR_OF_ARM = "robot.drivetrain.rotor_inertia", "robot.flippers.rotor_inertia"
_ARMS = "robot.flippers.torque_limit"
OF_ARMS = (_ARMS, ROTOR_OF_ARM)
"""Paths that a robot without flippers does not have."""

_OF_FILE = "the sum over the links of its file; 10 mm for parts added or removed"
_MOTORS = "the preset's is an estimate: half to twice"
_BY_ROUGH = "0.016 to 0.1 s times rated torque squared over power, both from ROUGH"

GENERAL: Mapping[str, Range] = {
    _X: (shifted(-0.1, 0.1, unit="robot.outline.axle_distance"), "a tenth of the axle distance"),
    _Y: (shifted(-0.05, 0.05, unit="robot.outline.axle_distance"), "a twentieth of it"),
    _TORQUE: (scaled(0.5, 2.0), "half to twice"),
    BELLY_HEIGHTS: (shifted(-0.1, 0.1, unit="robot.outline.front_radius"), "a tenth of the radius"),
}
"""General estimates, for robots that are not presets."""

RANGES: Mapping[str, Mapping[str, Range]] = {
    "engineer": {
        _X: (
            shifted(-0.04, 0.04),
            "the preset's is an estimate; its arm of 8.85 kg (eng.xacro) moves the whole by 40 mm"
            " as it reaches 96 mm either way",
        ),
        _Y: (
            shifted(-0.02, 0.02),
            "the preset's is an estimate; the arm raised or lowered by 48 mm moves the whole so",
        ),
        _TORQUE: (scaled(0.5, 2.0), _MOTORS),
        BELLY_HEIGHTS: (
            shifted(-0.014, 0.010),
            "the preset's is an estimate: 20 to 44 mm above level ground",
        ),
        ROTOR: (
            LogUniform(0.0036, 0.078),
            "0.016 s times torque over sprocket speed at the declared 1.39 m/s, to 0.1 s times that"
            " at the measured 0.4 m/s (paper, Table 1)",
        ),
        ROTOR_OF_ARM: (
            LogUniform(0.24, 6.0),
            "0.016 to 0.1 s times torque over rate, which are estimates: half to twice",
        ),
    },
    "absolem": {
        _MASS: (scaled(0.967, 1.034), "published twice: 38.7 kg (SubT) and 40 kg (ROUGH)"),
        _X: (shifted(-0.01, 0.01), _OF_FILE),
        _Y: (shifted(-0.01, 0.01), _OF_FILE),
        _TORQUE: (scaled(0.5, 2.0), "an estimate, or 30 N m rated (ROUGH): half to twice"),
        _ARMS: (scaled(0.66, 1.5), "published twice: 20 N m (SubT) and 30 N m rated (ROUGH)"),
        BELLY_HEIGHTS: (shifted(-0.005, 0.005), "its file has it; 5 mm for what hangs below"),
        ROTOR: (LogUniform(0.069, 0.43), _BY_ROUGH),
        ROTOR_OF_ARM: (
            LogUniform(0.069, 2.5),
            "0.016 s times torque squared over power (ROUGH), to 0.1 s times torque over rate"
            " (SubT)",
        ),
    },
    "marv": {
        _MASS: (scaled(0.862, 1.16), "published twice: 60.4 kg (SubT) and 70 kg (ROUGH)"),
        _X: (shifted(-0.01, 0.01), _OF_FILE),
        _Y: (
            shifted(-0.01, 0.03),
            f"{_OF_FILE}, and up to 30 mm higher, if the 9.6 kg"
            " that ROUGH has more are 0.2 m above the rest",
        ),
        _TORQUE: (scaled(0.5, 2.0), "an estimate, or 50 N m rated (ROUGH): half to twice"),
        _ARMS: (scaled(0.66, 1.5), "published twice: 120 N m (SubT) and 180 N m rated (ROUGH)"),
        BELLY_HEIGHTS: (shifted(-0.005, 0.005), "its file has it; 5 mm for what hangs below"),
        ROTOR: (LogUniform(0.10, 0.63), f"{_BY_ROUGH}; of two motors"),
        ROTOR_OF_ARM: (LogUniform(2.6, 16.0), _BY_ROUGH),
    },
    "gz_tracked_vehicle": {
        _X: (shifted(-0.01, 0.01), _OF_FILE),
        _Y: (shifted(-0.01, 0.01), _OF_FILE),
        _TORQUE: (scaled(0.5, 2.0), _MOTORS),
        BELLY_HEIGHTS: (shifted(-0.005, 0.005), "its file has it; 5 mm for what hangs below"),
    },
}
"""Ranges of the presets, by name."""


def of_restitution(robot: Robot) -> Ranges:
    """List the uncertain parameter of impacts: the coefficient of restitution.

    Parameters
    ----------
    robot : Robot
        The robot; one on chains has none, as their contacts have no restitution.

    Examples
    --------
    >>> import crawler2d as c2d
    >>> dict(of_restitution(c2d.robots.engineer()))
    {'solver.restitution': Uniform(low=0.0, high=1.0)}
    """
    if isinstance(robot.track, SegmentalTrack):
        return Ranges({})
    source = "between nothing and all, which no model of a robot states"
    return Ranges.with_sources({"solver.restitution": (uniform(0.0, 1.0), source)})


def of_robot(robot: Robot) -> Ranges:
    """List uncertain parameters of a robot: centre of mass, torque, rotors, ground clearance.

    For Absolem and MARV also mass and flipper torque, of which two values were published.

    Parameters
    ----------
    robot : Robot
        A preset, by its name, or any other robot.

    Returns
    -------
    Ranges
        For `unknown`; printing it shows each range and its source. Ranges of a preset are based on
        the sources in its docstring; those of other robots are general. The general rotor inertia
        is 0.016 to 0.1 s, the time in which the rated torque of eight in ten catalogue motors
        accelerates them, times the largest torque over the largest speed; an inertia that the robot
        states is taken as known. A preset after `Robot.without_rotors` has none.

    Raises
    ------
    ScenarioError
        If it is not a Robot, or breaks a rule.

    Examples
    --------
    >>> import crawler2d as c2d
    >>> of_robot(c2d.robots.absolem())["robot.center_of_mass[0]"]
    Shifted(low=-0.01, high=0.01)
    """
    if not isinstance(robot, Robot):
        raise ScenarioError("robot", robot, "must be a Robot")
    known = RANGES.get(robot.name)
    missing = [] if robot.belly is not None else [BELLY_HEIGHTS]
    if robot.flippers is None:
        missing += OF_ARMS
    if known is None:
        return Ranges.with_sources({**GENERAL, **_rotors(robot)}).without(missing)
    if robot.drivetrain.rotor_inertia == 0.0:
        missing.append(ROTOR)
    if robot.flippers is not None and robot.flippers.rotor_inertia == 0.0:
        missing.append(ROTOR_OF_ARM)
    return Ranges.with_sources(known).without(missing)


def of_ground() -> Ranges:
    """List the uncertain parameter of the ground: the friction of the floor.

    Returns
    -------
    Ranges
        For `unknown`. See `variability.of_contact` for the variation between patches of one floor.

    Examples
    --------
    >>> of_ground()
    Ranges
      terrain.friction: Uniform(low=0.5, high=1.0)
          public models of tracked robots: 0.5 (absolem.sdf:1018), 0.7 (tracked_vehicle_simple.sdf:121), 1 (marv.sdf:649)
    """  # noqa: E501
    source = (
        "public models of tracked robots: 0.5 (absolem.sdf:1018), 0.7"
        " (tracked_vehicle_simple.sdf:121), 1 (marv.sdf:649)"
    )
    return Ranges.with_sources({"terrain.friction": (uniform(0.5, 1.0), source)})


def _rotors(robot: Robot) -> dict[str, Range]:
    """Estimate the rotor inertia that a robot does not state, if its motors have torque."""
    robot.wheels()  # refuses a robot that breaks a rule
    drive, arms = robot.drivetrain, robot.flippers
    ratios = {}
    if drive.rotor_inertia == 0.0:
        belt_radius = robot.outline.rear_radius - robot.outline.grouser_height
        ratios[ROTOR] = drive.max_torque * belt_radius / drive.max_speed
    if arms is not None and arms.rotor_inertia == 0.0:
        ratios[ROTOR_OF_ARM] = arms.torque_limit / arms.rate_limit
    source = "0.016 to 0.1 s, as catalogue motors, times torque over speed"
    return {
        path: (LogUniform(*(time * ratio for time in RUN_UP)), source)
        for path, ratio in ratios.items()
        if ratio > 0.0
    }
