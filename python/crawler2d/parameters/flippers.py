"""Flippers: arms that pivot on the end axles of a robot, each with a track of its own."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Literal

from crawler2d.parameters.plain import Parameters
from crawler2d.parameters.track import Track

__all__ = ["Flippers"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Flippers(Parameters):
    """Arms of one form at one end of a robot or at both, one on either side of it.

    An arm pivots on the end axle, and a track runs round it from there to an axle at its tip. The
    motors of the robot's tracks drive it, at the speed of the robot's tracks over the chassis: the
    sprocket sits on the pivot, so that a belt also runs along an arm that turns. A motor of its own
    turns the arm to the commanded angle, as fast as its rate and its torque allow, and acts back on
    the chassis. Arms do not touch the chassis or each other. `Drive.gait` moves them.

    The mass figures of a `Robot` are those of the whole robot, arms included. `Robot.with_flippers`
    mounts arms on a robot and counts their masses, `Robot.without_flippers` takes both off again;
    the field `robot.flippers` alone, set to other arms or to None, leaves the whole as heavy as it
    was.

    Parameters
    ----------
    length : float
        [m] From the pivot to the axle at the tip.
    root_radius, tip_radius : float
        [m] Radius about the pivot and about the axle at the tip, to the grouser tips. The grousers
        are those of `robot.outline`. A line of wheels with a `wheel_radius` has that one instead.
    mass : float
        [kg] Of one arm with its track; part of `robot.mass`. It is spread evenly from the pivot to
        the axle at the tip.
    ends : {"front", "rear", "both"}
        Where they are.
    angle : float
        [rad] At time 0: 0 points away from the robot along its axis, upwards > 0.
    rate_limit : float
        [rad/s] Fastest turn over the chassis.
    torque_limit : float
        [N m] Largest torque of the motor of one arm; beyond it the arm gives way.
    track : Track, optional
        How their tracks are modelled: any model but a chain of shoes. Places of `HybridWheels` are
        counted from midway between the arm's axles. None takes the model of the robot's track, a
        belt with grousers where that is a chain, more small wheels all round where a tip needs
        them; it must be given where that has its wheels placed by hand.

    Examples
    --------
    >>> import crawler2d as c2d
    >>> arms = Flippers(
    ...     length=0.34,
    ...     root_radius=0.064,
    ...     tip_radius=0.037,
    ...     mass=0.775,
    ...     ends="both",
    ...     torque_limit=30.0,
    ... )
    >>> robot = c2d.robots.engineer(flippers=arms)
    >>> run = c2d.simulate(robot, c2d.terrains.step(0.2), drive=c2d.Drive(gait=c2d.Climb()))
    >>> str(run.outcome)
    'cleared'
    """

    place: ClassVar[str] = "robot.flippers"

    length: float
    root_radius: float
    tip_radius: float
    mass: float
    ends: Literal["front", "rear", "both"] = "front"
    angle: float = 0.0
    rate_limit: float = 1.0
    torque_limit: float
    track: Track | None = None
