"""Speed and torque: from the limits of joints and plugins, or estimates where there are none."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

from crawler2d.models.tree import Joint, Tree
from crawler2d.models.where import Where
from crawler2d.parameters.drivetrain import PI, Drivetrain
from crawler2d.parameters.track import BeltTrack, LineOfWheels, Track
from crawler2d.reading.actuators import (
    ACTUATORS,
    FASTEST,
    resistance,
    rotor_inertia,
    tell_ignored,
    tell_lost,
)
from crawler2d.reading.plugins import wheel_torques
from crawler2d.reading.sides import Pair
from crawler2d.reading.sources import estimate, lines
from crawler2d.reading.telling import Telling

__all__ = ["drivetrain_of"]

_SPEED, _ACCELERATION, _DECELERATION = 1.0, 1.0, 4.0  # those of Robot.simple
WEIGHT, MARGIN = 9.81, 1.6  # [m/s^2] and the margin of Robot.simple

Note = Callable[[str, str], None]


def drivetrain_of(
    told: Telling,
    tree: Tree,
    pairs: list[Pair],
    track: Track,
    *,
    engine: str,
    radius: float,
    torque: float,
) -> Drivetrain:
    """Return speed and torque of the tracks.

    Parameters
    ----------
    told : Telling
        Takes the sources of the figures, and what the engine ignores.
    tree : Tree
        The model.
    pairs : list of Pair
        Wheels of the chassis, or of the flippers if it has none; drums have no joint.
    track : Track
        The model of the track of the chassis.
    engine : {"gz", "classic", "bullet", "mujoco", "isaac"}
        The engine that drives it.
    radius : float
        [m] Of the rear end, at which the torque of a robot acts.
    torque : float
        [N m] The estimate for a motor without limit.
    """
    note = told.note
    told.notes.append(ACTUATORS[engine].in_words(is_belt=isinstance(track, BeltTrack)))
    speed, source = _speed(tree, pairs)
    note("robot.drivetrain.max_speed", source)
    for name in ("max_acceleration", "max_deceleration"):
        note(f"robot.drivetrain.{name}", estimate("that of Robot.simple"))
    sides = [_wheels(tree, pairs, side, engine) for side in ("left", "right")]
    joints = [joint for side in sides for joint, _ in side]
    efforts = [joint.effort for joint in joints if joint.effort]
    sharing = "track"
    if joints and len(efforts) == len(joints):
        # Every wheel has its own motor; the robot's figure is that of one side.
        torque = 0.5 * sum(
            (joint.effort or 0.0) * radius / own for side in sides for joint, own in side
        )
        places = [joint.effort_at for joint in joints]
        note("robot.drivetrain.max_torque", lines(places, "sum of one side"))
        sharing = "wheel" if isinstance(track, LineOfWheels) and len(set(efforts)) == 1 else "track"
        note("robot.drivetrain.torque_sharing", lines([joint.at for joint in joints]))
    else:
        note("robot.drivetrain.max_torque", estimate("that of Robot.simple: the file has no limit"))
        note("robot.drivetrain.torque_sharing", estimate("one speed, as motors without limit hold"))
    tell_ignored(told, joints, engine=engine, is_mjcf=tree.format == "MJCF")
    lost = 0.5 * sum(
        resistance(joint, speed / own, engine) * radius / own
        for side in sides
        for joint, own in side
    )
    tell_lost(told, joints, lost, torque, engine=engine)
    for name in ("no_load_speed", "torque_curve", "self_locking"):
        note(f"robot.drivetrain.{name}", f"{tree.at}: none")
    # At the sprocket a wheel's rotor counts by the square of the ratio of their rates.
    rotors = [[joint.armature * (radius / own) ** 2 for joint, own in side] for side in sides]
    shares = [sum(side) for side in rotors]
    if sharing == "wheel":
        shares = [len(side) * rotor for side in rotors for rotor in side]
    path = "robot.drivetrain.rotor_inertia"
    controller = _controller(told, sides, engine=engine, radius=radius, at=tree.at)
    firm = torque if controller is None else controller.gain * speed / radius
    if firm < torque and len(efforts) == len(joints):
        where = f"{joints[0].gain_at}: gain[{joints[0].name}]"
        value = f"{firm:.3g} of {torque:.3g} N m of a side"
        told.doubts.append((where, value, "is too soft for the torque limit, even at full speed"))
    return Drivetrain(
        max_speed=speed,
        max_acceleration=_ACCELERATION,
        max_deceleration=_DECELERATION,
        max_torque=torque,
        torque_sharing="wheel" if sharing == "wheel" else "track",
        rotor_inertia=rotor_inertia(told, path, shares, joints, engine=engine, at=tree.at),
        controller=controller,
    )


def _controller(
    told: Telling,
    sides: Sequence[Sequence[tuple[Joint, float]]],
    *,
    engine: str,
    radius: float,
    at: Where,
) -> PI | None:
    """Return the controller of one side: the servos of its wheels, if the engine has such."""
    wheels = [wheel for side in sides for wheel in side]
    gains = [(joint.gain or 0.0) * (radius / own) ** 2 for joint, own in wheels]
    if not ACTUATORS[engine].has_gain or not gains or not min(gains) > 0.0:
        told.note("robot.drivetrain.controller", f"{at}: none")
        return None
    places = lines([joint.gain_at for joint, _ in wheels], "sum of one side")
    told.note("robot.drivetrain.controller", places)
    return PI(gain=0.5 * sum(gains))


def _wheels(tree: Tree, pairs: Sequence[Pair], side: str, engine: str) -> list[tuple[Joint, float]]:
    """Return the joints of one side with the radii [m] of their wheels; drums have none."""
    # The differential drives of Gazebo Classic limit their motors by themselves.
    torques = wheel_torques(tree.plugins) if engine == "classic" else {}
    found = []
    for runner in [each for pair in pairs for each in getattr(pair, side)]:
        joint = runner.joint
        if joint is not None and joint.name in torques:
            effort, where = torques[joint.name]
            joint = replace(joint, effort=effort, effort_at=where)
        if joint is not None:
            found.append((joint, runner.radius))
    return found


def _speed(tree: Tree, pairs: list[Pair]) -> tuple[float, str]:
    """[m/s] Return the largest speed of the track: the slowest of its wheels sets it."""
    found: list[tuple[float, Where]] = [
        (wheel.joint.velocity * wheel.radius, wheel.joint.velocity_at)
        for pair in pairs
        for wheel in pair.both
        if wheel.joint is not None and wheel.joint.velocity
    ]
    found += [
        (drum.shape.surface_speed, drum.shape.at)
        for pair in pairs
        for drum in pair.both
        if drum.joint is None and drum.shape.surface_speed
    ]
    for plugin in tree.plugins:
        if "track" in plugin.name.lower() or "diff" in plugin.name.lower():
            for text, where in plugin.values("max_velocity", "max_linear_velocity"):
                try:
                    found.append((float(text), where))
                except ValueError:
                    continue
    found = [(speed, where) for speed, where in found if 0.0 < speed <= FASTEST]
    if not found:
        return _SPEED, estimate("that of Robot.simple: the file has no limit")
    speed = min(speed for speed, _ in found)
    return speed, lines([where for each, where in found if each == speed])
