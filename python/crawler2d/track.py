"""How a track is modelled: one class a family of the literature, one robot behind them."""

from __future__ import annotations

from dataclasses import KW_ONLY, dataclass
from typing import ClassVar, Literal

from crawler2d._json import Parameters

__all__ = ["BeltTrack", "ForceTrack", "LineOfWheels", "RoundWheel", "Track"]


@dataclass(frozen=True, slots=True)
class RoundWheel(Parameters):
    """A wheel that is a disc, without grousers."""

    kind: ClassVar[str] = "round"
    place: ClassVar[str] = "robot.track.wheel"


@dataclass(frozen=True, slots=True)
class LineOfWheels(Parameters):
    """Driven wheels on the straight line between the end axles, evenly spaced (LWA).

    Parameters
    ----------
    count : int
        Wheels a side, the two at the end axles included; at least 2.
    wheel_radius : float, optional
        [m] Radius of every wheel. None takes the outline's, linear between unequal ends. With half
        the spacing the wheels touch, with more they overlap, with less slots stay open.
    wheel : RoundWheel
        The shape of each wheel.

    Examples
    --------
    >>> LineOfWheels(4, wheel_radius=0.0608).count
    4
    """

    kind: ClassVar[str] = "line"
    place: ClassVar[str] = "robot.track"

    count: int
    _: KW_ONLY
    wheel_radius: float | None = None
    wheel: RoundWheel = RoundWheel()


@dataclass(frozen=True, slots=True)
class BeltTrack(Parameters):
    """A taut smooth belt: its surface moves along the outline at track speed.

    The contact surface is closed, so that no edge can get between wheels.
    """

    kind: ClassVar[str] = "belt"
    place: ClassVar[str] = "robot.track"


@dataclass(frozen=True, slots=True, kw_only=True)
class ForceTrack(Parameters):
    """No moving surface: the drive pushes the chassis along its axis at axle height.

    The force follows the speed command, is limited like the traction of a track, and acts in the
    air too: that is the model's flaw, kept as it is.

    Parameters
    ----------
    support : {"skids"}
        What carries the robot: skids of the outline's shape.
    skid_friction : float
        [-] Friction of the skids; the smaller of this and the terrain's friction acts.
    """

    kind: ClassVar[str] = "force"
    place: ClassVar[str] = "robot.track"

    support: Literal["skids"] = "skids"
    skid_friction: float = 0.0


Track = LineOfWheels | BeltTrack | ForceTrack
"""Every track model."""
