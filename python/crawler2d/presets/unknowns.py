"""What is not known of a robot and its floor, for `unknown` of a sweep.

It is the same in every run, so it is sampled in an outer loop: each sample is a robot on a floor as
they may be, and has a rate of its own.

>>> import crawler2d as c2d
>>> robot = c2d.robots.engineer(flippers=None)
>>> list(c2d.unknowns.of_robot(robot) | c2d.unknowns.of_ground())[:3]
['robot.center_of_mass[0]', 'robot.center_of_mass[1]', 'robot.drivetrain.max_torque']
"""

from __future__ import annotations

from crawler2d.errors import ScenarioError
from crawler2d.parameters.robot import Robot
from crawler2d.parameters.track import SegmentalTrack
from crawler2d.presets.robots.ranges import (
    BELLY,
    GENERAL,
    OF_ARMS,
    RANGES,
    ROTOR,
    ROTOR_OF_ARM,
    RUN_UP,
    Range,
)
from crawler2d.variation.distributions import LogUniform, uniform
from crawler2d.variation.ranges import Ranges

__all__ = ["of_blows", "of_ground", "of_robot"]


def of_blows(robot: Robot) -> Ranges:
    """List what is not known of a blow on the ground: how much of it contacts give back.

    Parameters
    ----------
    robot : Robot
        Of a robot on chains there is nothing: those give nothing back.

    Examples
    --------
    >>> import crawler2d as c2d
    >>> dict(of_blows(c2d.robots.engineer()))
    {'solver.restitution': Uniform(low=0.0, high=1.0)}
    """
    path, source = "solver.restitution", "between nothing and all, which no model of a robot states"
    if isinstance(robot.track, SegmentalTrack):
        return Ranges({})
    return Ranges({path: uniform(0.0, 1.0)}, {path: source})


def of_robot(robot: Robot) -> Ranges:
    """List what is not known of a robot: centre of mass, torque, rotors, clearance of the belly.

    Of Absolem and MARV also the mass and the torque of the flippers, which were published twice.

    Parameters
    ----------
    robot : Robot
        A preset, by its name, or any other robot.

    Returns
    -------
    Ranges
        For `unknown`; printing it shows each range and where it comes from. Those of a preset rest
        on what its docstring says of its figures; those of another robot are general. The inertia
        of a rotor is then 0.016 to 0.1 s, in which the rated torque of eight in ten catalogue
        motors runs them up, times the largest torque over the largest speed; one that the robot
        states is taken as known.

    Raises
    ------
    ScenarioError
        If it is no Robot, or breaks a rule.

    Examples
    --------
    >>> import crawler2d as c2d
    >>> of_robot(c2d.robots.absolem())["robot.center_of_mass[0]"]
    Shifted(low=-0.01, high=0.01)
    """
    if not isinstance(robot, Robot):
        raise ScenarioError("robot", robot, "must be a Robot")
    known = RANGES.get(robot.name)
    ranges = {**GENERAL, **_rotors(robot)} if known is None else dict(known)
    if robot.belly is None:
        ranges.pop(BELLY, None)
    if robot.flippers is None:
        for path in OF_ARMS:
            ranges.pop(path, None)
    return Ranges(
        {path: distribution for path, (distribution, _) in ranges.items()},
        {path: source for path, (_, source) in ranges.items()},
    )


def of_ground() -> Ranges:
    """List what is not known of the ground: the friction of the floor.

    Returns
    -------
    Ranges
        For `unknown`. What varies from patch to patch of one floor is `variability.of_contact`.

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
    return Ranges({"terrain.friction": uniform(0.5, 1.0)}, {"terrain.friction": source})


def _rotors(robot: Robot) -> dict[str, Range]:
    """Estimate the inertia of rotors that the robot does not state, if their motors have torque."""
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
