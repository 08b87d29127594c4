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
from crawler2d.presets.robots.ranges import ARMS, BELLY, GENERAL, RANGES
from crawler2d.variation.distributions import uniform
from crawler2d.variation.ranges import Ranges

__all__ = ["of_ground", "of_robot"]


def of_robot(robot: Robot) -> Ranges:
    """List what is not known of a robot: centre of mass, torque, clearance of the belly.

    Of Absolem and MARV also the mass and the torque of the flippers, which were published twice.

    Parameters
    ----------
    robot : Robot
        A preset, by its name, or any other robot.

    Returns
    -------
    Ranges
        For `unknown`; printing it shows each range and where it comes from. Those of a preset rest
        on what its docstring says of its figures; those of another robot are general.

    Raises
    ------
    ScenarioError
        If it is no Robot.

    Examples
    --------
    >>> import crawler2d as c2d
    >>> of_robot(c2d.robots.absolem())["robot.center_of_mass[0]"]
    Shifted(low=-0.01, high=0.01)
    """
    if not isinstance(robot, Robot):
        raise ScenarioError("robot", robot, "must be a Robot")
    ranges = dict(RANGES.get(robot.name, GENERAL))
    if robot.belly is None:
        ranges.pop(BELLY, None)
    if robot.flippers is None:
        ranges.pop(ARMS, None)
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
