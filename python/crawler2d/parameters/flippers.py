"""Flippers: arms that pivot on the end axles of a robot, each with its own track."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Literal

from crawler2d.parameters.fields import Parameters
from crawler2d.parameters.track import Track

__all__ = ["Flippers", "reach_of"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Flippers(Parameters, path="robot.flippers"):
    """Identical arms at one end or both ends of a robot, one on each side.

    An arm pivots on the end axle. Its track runs round the pivot and an axle at the tip, and is
    driven by the motors of the robot's tracks, at the same speed relative to the chassis. The
    sprocket sits on the pivot, so turning the arm also moves its belt along the arm. A motor of its
    own turns the arm to the commanded angle within its rate and torque limits, and its torque
    reacts on the chassis. Arms do not touch the chassis or each other. `Drive.gait` moves them.

    The mass, centre of mass and moment of inertia of a `Robot` are those of the whole robot, arms
    included. `Robot.with_flippers` mounts arms and adds their mass, `Robot.without_flippers`
    removes both. Replacing or clearing the field `robot.flippers` alone leaves the mass of the
    robot unchanged.

    Parameters
    ----------
    length : float
        [m] Distance from the pivot to the axle at the tip.
    root_radius, tip_radius : float
        [m] Radii at the pivot and at the tip, measured to the grouser tips; they differ by less
        than the length. The grousers are those of `robot.outline`, lower than either radius. A line
        of wheels with a `wheel_radius` uses that radius instead.
    mass : float
        [kg] Mass of one arm with its track, spread evenly between pivot and tip axle. It is part of
        `robot.mass`, and at least a hundred-thousandth of it; all arms and tracks together must
        leave that much for the chassis.
    ends : {"front", "rear", "both"}
        The ends of the robot that have arms.
    angle : float
        [rad] Angle at time 0: 0 points away from the robot along its axis, upwards > 0.
    rate_limit : float
        [rad/s] Largest turning rate relative to the chassis.
    torque_limit : float
        [N m] Largest torque of the motor of one arm; under more load the arm gives way, unless its
        gear is self-locking.
    rotor_inertia : float
        [kg m^2] Rotor inertia of the motor of one arm, reflected to the pivot: that of the rotor
        times the square of the gear ratio; at most 100,000 times the moment of inertia of the
        robot. The rotor turns with the arm relative to the chassis.
    self_locking : bool
        Whether the gear cannot be back-driven, like a worm gear: then no load, whatever the torque
        limit, can turn an arm back or faster than its motor turns it; the limit still applies to
        what the motor drives. A gear that does not lock is assumed to be back-driven without loss.
    track : Track, optional
        The model of their tracks: any except a chain of shoes or a closed track, and a `ForceTrack`
        exactly when the robot's track is one. The placements of `HybridWheels` are measured from
        the midpoint between the arm's axles. None takes the robot's model, with two exceptions: a
        belt with grousers replaces a chain, and small wheels all round get more wheels where a tip
        needs them. If the robot's wheels are placed by hand, the model must be given.

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

    Worm gears keep a robot up on arms whose motors are too weak to lift it:

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
        The robot's arms.
    track : track model
        The robot's track, also that of arms without a model of their own.
    """
    if arms is None:
        return 0.0
    opened = getattr(track, "of", track)  # a closed track is a belt round the same wheels
    wheel = getattr(arms.track or opened, "wheel_radius", None) or 0.0
    return arms.length + max(arms.tip_radius, wheel)
