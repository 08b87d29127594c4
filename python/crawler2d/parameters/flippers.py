"""Flippers: arms that pivot on the end axles of a robot, each with its own track."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Literal

from crawler2d.parameters.fields import Parameters
from crawler2d.parameters.track import Track

__all__ = ["Flippers", "reach_of"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Flippers(Parameters, path="robot.flippers"):
    """Identical arms at one end of a robot or at both, one on each side.

    An arm pivots on the end axle, and a track runs round it from there to an axle at its tip. It is
    driven by the motors of the robot's tracks, at the same speed over the chassis. The sprocket
    sits on the pivot, so that the belt also runs along an arm that turns. A motor of its own turns
    the arm to the commanded angle, as fast as its rate and torque limits allow, and its torque
    reacts on the chassis. Arms do not touch the chassis or each other. `Drive.gait` moves them.

    The mass, centre of mass and moment of inertia of a `Robot` are those of the whole robot, arms
    included. `Robot.with_flippers` mounts arms and adds their mass, `Robot.without_flippers` takes
    arms and mass off again. Replacing or clearing the field `robot.flippers` alone leaves the mass
    of the robot unchanged.

    Parameters
    ----------
    length : float
        [m] Distance from the pivot to the axle at the tip.
    root_radius, tip_radius : float
        [m] Radii at the pivot and at the tip, measured to the grouser tips; they differ by less
        than the length. The grousers are those of `robot.outline`, less high than either radius.
        A line of wheels with a `wheel_radius` has that radius instead.
    mass : float
        [kg] Of one arm with its track; part of `robot.mass`, of which it is at least a
        hundred-thousandth. All arms and tracks together leave as much for the chassis. It is
        spread evenly between pivot and tip axle.
    ends : {"front", "rear", "both"}
        The ends of the robot that have arms.
    angle : float
        [rad] At time 0. 0 points away from the robot along its axis, upwards > 0.
    rate_limit : float
        [rad/s] Largest turning rate relative to the chassis.
    torque_limit : float
        [N m] Largest torque of the motor of one arm; under more load the arm gives way, unless its
        gear locks itself.
    rotor_inertia : float
        [kg m^2] Of the motor of one arm, reflected to the pivot: the rotor's own times the square
        of the gear's ratio; at most 100,000 times the moment of inertia of the robot. It turns with
        the arm over the chassis.
    self_locking : bool
        Whether the gear cannot be back-driven, as a worm gear: then no load turns an arm back, or
        on faster than its motor turns it, whatever the torque limit; that limits what turns the
        arm. A gear that does not lock is taken to turn back without loss.
    track : Track, optional
        How their tracks are modelled: any model but a chain of shoes or a closed one, and a
        `ForceTrack` exactly if that of the robot is one. The placements of
        `HybridWheels` are measured from midway between the arm's axles. None takes the model of the
        robot's track, with two exceptions: for a chain it takes a belt with grousers, and for small
        wheels all round it adds wheels where a tip needs more. If the robot's wheels are placed by
        hand, the model must be given.

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

    Worm gears hold a robot on arms whose motors are too weak to lift it:

    >>> from dataclasses import replace
    >>> for locks in (False, True):
    ...     weak = replace(arms, angle=-0.4, torque_limit=1.0, self_locking=locks)
    ...     scenario = c2d.Scenario(
    ...         c2d.robots.engineer(flippers=weak),
    ...         c2d.terrains.flat(),
    ...         drive=c2d.Drive(speed=0.0, gait=c2d.Hold(-0.4)),
    ...     )
    ...     simulation = c2d.Simulation(scenario)
    ...     simulation.advance(2.0)
    ...     print(round(simulation.state().flipper_angles[0], 2))
    -0.08
    -0.4
    """

    omitted_defaults: ClassVar[tuple[str, ...]] = ("rotor_inertia", "self_locking")

    length: float
    root_radius: float
    tip_radius: float
    mass: float
    ends: Literal["front", "rear", "both"] = "front"
    angle: float = 0.0
    rate_limit: float = 1.0
    torque_limit: float
    rotor_inertia: float = 0.0
    self_locking: bool = False
    track: Track | None = None


def reach_of(arms: Flippers | None, track: Track) -> float:
    """[m] Return how far arms reach from their pivots; 0 without arms.

    Parameters
    ----------
    arms : Flippers or None
        Those of a robot.
    track : track model
        That of the robot, which arms without one of their own have, too.
    """
    if arms is None:
        return 0.0
    opened = getattr(track, "of", track)  # a closed track is a belt round the same wheels
    wheel = getattr(arms.track or opened, "wheel_radius", None) or 0.0
    return arms.length + max(arms.tip_radius, wheel)
