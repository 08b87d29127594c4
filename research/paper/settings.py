"""Motors and friction under which the paper is repeated: it states neither."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from crawler2d.parameters.track import CircumferentialWheels, HybridWheels, LineOfWheels

if TYPE_CHECKING:
    from crawler2d.parameters.robot import Robot

__all__ = ["PRESET", "PUBLIC", "SETTINGS", "STRONG", "Setting"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Setting:
    """What the motors can do, and how the ground grips."""

    name: str
    max_torque: float
    """[N m] Of one sprocket; of one wheel if each has its own motor."""
    friction: float
    """[-] Between track and ground."""
    reason: str
    """Where it comes from."""
    a_wheel: bool = False
    """Whether every wheel has a motor of its own; a track without wheels has one sprocket."""
    rotor_inertia: float | None = None
    """[kg m^2] Of the motor of one track, at its sprocket; None takes the robot's."""

    def on(self, robot: Robot) -> Robot:
        """Give a robot these motors."""
        sharing, torque = "track", self.max_torque
        if self.a_wheel and _has_driven_wheels(robot):
            # The core gives each of the N wheels of a side 1/N of the torque of a sprocket.
            sides = robot.wheels()["side"].tolist()
            sharing, torque = "wheel", torque * sides.count("left")
        inertia = self.rotor_inertia
        drivetrain = replace(
            robot.drivetrain,
            max_torque=torque,
            torque_sharing=sharing,  # type: ignore[arg-type] # a plain str to mypy
            rotor_inertia=robot.drivetrain.rotor_inertia if inertia is None else inertia,
        )
        return replace(robot, drivetrain=drivetrain)


PRESET = Setting(
    name="preset",
    max_torque=6.0,
    friction=0.9,
    reason="the preset without rotors; both figures are estimates (6 N m holds the 45 degrees of"
    " Table 1 with a margin of 1.6)",
)
STRONG = Setting(
    name="strong motors",
    max_torque=60.0,
    friction=0.9,
    reason="ten times the torque: motors that hold their speed",
)
PUBLIC = Setting(
    name="public simulation",
    max_torque=100.0,
    friction=1.0,
    a_wheel=True,
    reason="the public simulation model: an effort of 100 N m a wheel, and the smaller of its"
    " friction, 100, and the ground's, 1.0 by default",
)
SETTINGS = (PRESET, STRONG, PUBLIC)


def _has_driven_wheels(robot: Robot) -> bool:
    return isinstance(robot.track, (LineOfWheels, CircumferentialWheels, HybridWheels))
