"""Gaits: how a driver moves the flippers."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from crawler2d.parameters.plain import Parameters

__all__ = ["Climb", "Gait", "Hold"]


@dataclass(frozen=True, slots=True)
class Hold(Parameters):
    """Hold the flippers at an angle, which a schedule can change.

    Parameters
    ----------
    angle : float
        [rad] Relative to the chassis, upwards > 0; of the flippers at both ends.
    schedule : array_like, shape (n, 2), optional
        Increasing times [s], and the angles [rad] that apply from then on.

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

    The driver knows what an operator could see from a distance: the angle of the chassis, and
    whether the flippers bear on something beyond their roots. The front ones are held at
    `reach_angle` until they do; then they sweep down to `sweep_angle`. As soon as the chassis is
    raised by more than `level_angle`, the rear ones push down to `push_angle` and lift it from
    behind. When the chassis is level again and nothing bears on the rear ones, all go back: the
    front ones to `reach_angle`, the rear ones to their starting angle. The speed of the tracks is
    that of the `Drive`; the gait never reverses.

    Parameters
    ----------
    reach_angle : float
        [rad] Relative to the chassis, upwards > 0.
    sweep_angle, push_angle : float
        [rad] Relative to the horizontal, upwards > 0.
    level_angle : float
        [rad] Chassis angle above which the chassis counts as raised.
    """

    kind: ClassVar[str] = "climb"
    place: ClassVar[str] = "drive.gait"

    reach_angle: float = 0.8
    sweep_angle: float = 0.0
    push_angle: float = -0.8
    level_angle: float = 0.1


Gait = Hold | Climb
"""Any gait."""
