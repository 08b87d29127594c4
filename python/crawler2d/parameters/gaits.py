"""Gaits: how a driver moves the flippers."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from crawler2d.parameters.plain import Parameters

__all__ = ["Climb", "Gait", "Hold"]


@dataclass(frozen=True, slots=True)
class Hold(Parameters):
    """Hold the flippers at an angle, at others from given times on.

    Parameters
    ----------
    angle : float
        [rad] Over the chassis, upwards > 0; of the flippers at both ends.
    schedule : array_like, shape (n, 2), optional
        Times [s], rising, and the angles [rad] that hold from then on.

    Examples
    --------
    >>> import crawler2d as c2d
    >>> c2d.Drive(gait=Hold(0.8, [(3.0, 0.0)])).gait.schedule
    ((3.0, 0.0),)
    """

    kind: ClassVar[str] = "hold"
    place: ClassVar[str] = "drive.gait"

    angle: float = 0.0
    schedule: tuple[tuple[float, float], ...] | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Climb(Parameters):
    """Reach up with the flippers to meet an obstacle, sweep down to lift the chassis over it.

    The driver knows what one at a distance could know: the angle of the chassis, and whether
    flippers bear on something beyond their roots. Those at the front are held at `reach_angle`
    until they do; then they sweep down to `sweep_angle`. As soon as the chassis is raised, by more
    than `level_angle`, those at the rear push down to `push_angle` and lift it from behind. When it
    is level again and nothing bears on those at the rear, all go back: the front ones reach up,
    the rear ones to where they start. The speed of the tracks is that of the `Drive`, and nothing
    is rocked to and fro.

    Parameters
    ----------
    reach_angle : float
        [rad] Over the chassis, upwards > 0.
    sweep_angle, push_angle : float
        [rad] Over level ground, upwards > 0.
    level_angle : float
        [rad] Of the chassis.
    """

    kind: ClassVar[str] = "climb"
    place: ClassVar[str] = "drive.gait"

    reach_angle: float = 0.8
    sweep_angle: float = 0.0
    push_angle: float = -0.8
    level_angle: float = 0.1


Gait = Hold | Climb
"""Every gait."""
