"""What drives the tracks: motors, gears, and how their speed is controlled."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Literal

from crawler2d.parameters.fields import Parameters

__all__ = ["PI", "Drivetrain"]


@dataclass(frozen=True, slots=True)
class PI(Parameters, kind="pi", path="robot.drivetrain.controller"):
    """A controller of the speed of each sprocket: proportional and integral.

    The torque is the gain times the error of the angular velocity, plus the integral gain times the
    sum of that error over time, within the torque that the motor has at its speed. While the motor
    is at that limit nothing is added to the sum, so it does not wind up. A gain alone is what
    physics engines call a velocity motor: `kv` of MuJoCo's velocity actuator, the damping of
    Isaac's drive.

    Parameters
    ----------
    gain : float
        [N m s/rad] Torque of one sprocket for an error of its angular velocity.
    integral : float
        [N m/rad] Torque of one sprocket for the sum of those errors, which is an angle.

    Examples
    --------
    On a slope, a gain alone lets the speed fall by the weight over the gain:

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
    """What drives the tracks, and within which limits.

    Parameters
    ----------
    max_speed : float
        [m/s] Largest track speed.
    max_acceleration, max_deceleration : float
        [m/s^2] Largest rates at which the commanded speed rises and falls in magnitude.
    max_torque : float
        [N m] Largest torque of one sprocket, acting at the belt radius. The robot has two.
    torque_sharing : {"track", "wheel"}
        "track": one motor per track; all its wheels keep one speed, and the sum of their traction
        is limited. "wheel": each of the N driven wheels of a model that has some, on flippers,
        too, has its own servo with 1/N of the torque, the rotor inertia and the controller's gains.
    rotor_inertia : float
        [kg m^2] Of the motor of one track, reflected to its sprocket: the rotor's own times the
        square of the gear's ratio, MuJoCo's `armature`; at most 100,000 times the moment of inertia
        of the robot. It turns with the drive over the chassis and holds the track's speed through a
        blow, which no torque limit can.
    no_load_speed : float, optional
        [m/s] Track speed at which the torque, which falls in a line from `max_torque` at rest, is
        used up, as that of a DC motor does. None: the motor has `max_torque` at any speed.
    torque_curve : array_like, shape (n, 2), optional
        In place of that line: 1 to 1000 increasing track speeds [m/s], from 0, and the torques
        [N m] of one sprocket there, which start with `max_torque` and do not rise; straight between
        them, and the last beyond. Against its motion a motor has the torque that it has at rest. To
        replace, sweep or draw ``"robot.drivetrain.max_torque"`` scales all of them.
    controller : PI, optional
        How motors correct the speed of their sprocket. None: they hold the commanded speed as long
        as their torque suffices.
    self_locking : bool
        Whether the gear cannot be back-driven, as a worm gear. The load then turns no motor back,
        and none faster than the commanded speed or, where the torque ends before that, its speed
        without load. At rest the gear holds with any torque, also where the motor is too weak or
        off. What drives is limited by `max_torque` as ever. A gear that does not lock is taken to
        turn back without loss, while `max_torque` is what is left after losses. Neither with a
        `controller` nor on a `ForceTrack`.

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

    Switched off on a slope, a robot rolls back, and with worm gears it stands:

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
