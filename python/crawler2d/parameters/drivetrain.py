"""What drives the tracks: motors, gears, and how their speed is controlled."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Literal

from crawler2d.parameters.fields import Parameters

__all__ = ["PI", "Drivetrain"]


@dataclass(frozen=True, slots=True)
class PI(Parameters, kind="pi", path="robot.drivetrain.controller"):
    """Proportional-integral control of the speed of each sprocket.

    The torque is the gain times the error of the angular velocity, plus the integral gain times the
    integral of that error over time, limited to the torque that the motor has at its speed. At that
    limit the integral stops growing (no windup). A gain alone is what physics engines call a
    velocity motor: `kv` of MuJoCo's velocity actuator, the damping of Isaac's drive.

    Parameters
    ----------
    gain : float
        [N m s/rad] Torque of one sprocket per error of its angular velocity.
    integral : float
        [N m/rad] Torque of one sprocket per integral of that error, an angle.

    Examples
    --------
    On a slope, with a gain alone the speed drops in proportion to the load:

    >>> from dataclasses import replace
    >>> import crawler2d as c2d
    >>> robot = c2d.robots.engineer().without_flippers()
    >>> for controller in (PI(gain=1.0), PI(gain=1.0, integral=20.0)):
    ...     drivetrain = replace(robot.drivetrain, controller=controller)
    ...     scenario = c2d.Scenario(
    ...         replace(robot, drivetrain=drivetrain),
    ...         c2d.terrains.ramp(0.2),
    ...         drive=c2d.Drive(speed=0.4),
    ...     )
    ...     simulation = c2d.Simulation(scenario)
    ...     simulation.advance(4.0)
    ...     print(round(simulation.state().track_speed, 2))
    0.35
    0.4
    """

    gain: float
    integral: float = 0.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Drivetrain(Parameters, path="robot.drivetrain"):
    """The motors and gears that drive the tracks, and their limits.

    Parameters
    ----------
    max_speed : float
        [m/s] Largest track speed.
    max_acceleration, max_deceleration : float
        [m/s^2] Largest rates at which the commanded speed rises and falls in magnitude.
    max_torque : float
        [N m] Largest torque of one sprocket, acting at the belt radius. The robot has two.
    torque_sharing : {"track", "wheel"}
        "track": one motor per track; all its wheels turn at one surface speed, and their total
        traction is limited. "wheel": for models with driven wheels: each of the N driven wheels,
        including those on flippers, has its own servo with 1/N of the torque, the rotor inertia and
        the controller's gains.
    rotor_inertia : float
        [kg m^2] Rotor inertia of the motor of one track, reflected to its sprocket: that of the
        rotor times the square of the gear ratio, MuJoCo's `armature`; at most 100,000 times the
        moment of inertia of the robot. The rotor turns with the drive relative to the chassis and
        keeps the track moving through an impact, which no torque limit can.
    no_load_speed : float, optional
        [m/s] Track speed at which the torque has fallen to 0, linearly from `max_torque` at rest,
        as in a DC motor. None: the motor has `max_torque` at any speed.
    torque_curve : array_like, shape (n, 2), optional
        Replaces that line: 1 to 1000 increasing track speeds [m/s], starting at 0, and the torque
        [N m] of one sprocket at each. Torques start at `max_torque` and never rise; they are
        interpolated linearly, and the last one applies beyond. A motor that is driven backwards has
        its torque at rest. Replacing, sweeping or drawing ``"robot.drivetrain.max_torque"`` scales
        all torques.
    controller : PI, optional
        How motors control the speed of their sprocket. None: they hold the commanded speed as long
        as their torque suffices.
    self_locking : bool
        Whether the gear cannot be back-driven, like a worm gear. Then the load can neither turn a
        motor back nor make it overrun the commanded speed or, if that is lower, its no-load speed.
        At rest the gear holds against any torque, even if the motor is too weak or off.
        `max_torque` still limits what the motor drives. A gear that does not lock is assumed to be
        back-driven without loss, while `max_torque` is what is left after losses. Not with a
        `controller` or on a `ForceTrack`.

    Examples
    --------
    A rotor carries a robot over the edge that stops it without one:

    >>> from dataclasses import replace
    >>> import crawler2d as c2d
    >>> robot = c2d.robots.engineer(track=c2d.LineOfWheels(count=5)).without_flippers()
    >>> edge = c2d.terrains.barrier(0.03, thickness=0.002, friction=0.5)
    >>> for inertia in (0.0, 0.04):
    ...     drivetrain = replace(robot.drivetrain, rotor_inertia=inertia)
    ...     driven = replace(robot, drivetrain=drivetrain)
    ...     print(c2d.simulate(driven, edge, drive=c2d.Drive(speed=0.4)).outcome)
    seized
    cleared

    Switched off on a slope, a robot rolls back; with worm gears it stays put:

    >>> slope = c2d.terrains.from_points([(-20.0, -5.0), (20.0, 5.0)], goal=3.0)
    >>> start = c2d.Start(angle=0.245)
    >>> for locks in (False, True):
    ...     off = replace(robot.drivetrain, max_torque=0.0, self_locking=locks)
    ...     scenario = c2d.Scenario(replace(robot, drivetrain=off), slope, start=start)
    ...     simulation = c2d.Simulation(scenario)
    ...     simulation.advance(0.5)
    ...     before = simulation.state().position[0]
    ...     simulation.advance(1.0)
    ...     print(round(before - simulation.state().position[0], 1))
    1.3
    0.0
    """

    exclusive: ClassVar[tuple[str, ...]] = ("no_load_speed", "torque_curve")
    proportional: ClassVar[dict[str, str]] = {"max_torque": "torque_curve"}
    omitted_defaults: ClassVar[tuple[str, ...]] = (
        "rotor_inertia",
        "no_load_speed",
        "torque_curve",
        "controller",
        "self_locking",
    )

    max_speed: float
    max_acceleration: float
    max_deceleration: float
    max_torque: float
    torque_sharing: Literal["track", "wheel"] = "track"
    rotor_inertia: float = 0.0
    no_load_speed: float | None = None
    torque_curve: tuple[tuple[float, float], ...] | None = None
    controller: PI | None = None
    self_locking: bool = False
