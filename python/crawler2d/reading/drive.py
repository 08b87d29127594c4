"""Speed and torque: from the limits of joints and plugins, or estimates where there are none."""

from __future__ import annotations

from collections.abc import Callable

from crawler2d.models.tree import Tree
from crawler2d.models.where import Where
from crawler2d.parameters.drivetrain import Drivetrain
from crawler2d.parameters.track import LineOfWheels, Track
from crawler2d.reading.sides import Pair
from crawler2d.reading.sources import estimate, lines

__all__ = ["drivetrain_of"]

_SPEED, _ACCELERATION, _DECELERATION = 1.0, 1.0, 4.0  # those of Robot.simple
FASTEST = 100.0  # [rad/s] and [m/s] Larger figures are meant as no limit.
WEIGHT, MARGIN = 9.81, 1.6  # [m/s^2] and the margin of Robot.simple

Note = Callable[[str, str], None]


def drivetrain_of(
    tree: Tree, pairs: list[Pair], track: Track, *, radius: float, torque: float, note: Note
) -> Drivetrain:
    """Return speed and torque of the tracks.

    Parameters
    ----------
    tree : Tree
        The model.
    pairs : list of Pair
        Wheels of the chassis, or of the flippers if it has none; drums have no joint.
    track : Track
        The model of the track of the chassis.
    radius : float
        [m] Of the rear end, at which the torque of a robot acts.
    torque : float
        [N m] The estimate for a motor without limit.
    note : callable
        Takes path and source of a figure.
    """
    speed, source = _speed(tree, pairs)
    note("robot.drivetrain.max_speed", source)
    for name in ("max_acceleration", "max_deceleration"):
        note(f"robot.drivetrain.{name}", estimate("that of Robot.simple"))
    wheels = [wheel for pair in pairs for wheel in pair.both if wheel.joint is not None]
    efforts = [wheel.joint.effort for wheel in wheels if wheel.joint and wheel.joint.effort]
    sharing = "track"
    if wheels and len(efforts) == len(wheels):
        # Every wheel has its own motor; the robot's figure is that of one side.
        torque = 0.5 * sum(
            effort * radius / wheel.radius for effort, wheel in zip(efforts, wheels, strict=True)
        )
        note(
            "robot.drivetrain.max_torque",
            lines([w.joint.effort_at for w in wheels if w.joint], "sum of one side"),
        )
        sharing = "wheel" if isinstance(track, LineOfWheels) and len(set(efforts)) == 1 else "track"
        note("robot.drivetrain.torque_sharing", lines([w.joint.at for w in wheels if w.joint]))
    else:
        note("robot.drivetrain.max_torque", estimate("that of Robot.simple: the file has no limit"))
        note("robot.drivetrain.torque_sharing", estimate("one speed, as motors without limit hold"))
    return Drivetrain(
        max_speed=speed,
        max_acceleration=_ACCELERATION,
        max_deceleration=_DECELERATION,
        max_torque=torque,
        torque_sharing="wheel" if sharing == "wheel" else "track",
    )


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
