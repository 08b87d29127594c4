"""How a track is modelled: one class a family of the literature, one robot behind them.

The paper, whose figures and sections are named here, is "Gear Wheels based Simulation of Crawlers
for Mobile Robot Servosila Engineer".
"""

from __future__ import annotations

from dataclasses import KW_ONLY, dataclass
from typing import ClassVar, Literal

from crawler2d.parameters.plain import Parameters

__all__ = [
    "BeltTrack",
    "CircumferentialWheels",
    "ForceTrack",
    "GearWheel",
    "GrouserBeltTrack",
    "HybridWheels",
    "LineOfWheels",
    "RoundWheel",
    "SegmentalTrack",
    "Track",
    "Wheel",
]


@dataclass(frozen=True, slots=True)
class RoundWheel(Parameters):
    """A wheel that is a disc, without grousers."""

    kind: ClassVar[str] = "round"
    place: ClassVar[str] = "robot.track.wheel"


@dataclass(frozen=True, slots=True, kw_only=True)
class GearWheel(Parameters):
    """A wheel with grousers: a root circle, and trapezoids whose corners reach the wheel's radius.

    What is None follows from the robot's outline. The paper gives the grousers of large wheels
    only; the rules for small ones are ours.

    Parameters
    ----------
    grouser_count : int, optional
        Grousers round the wheel, 3 to 200. None takes the whole number that comes nearest to the
        robot's grouser pitch on the root circle, or 8 where that is fewer than 6.
    grouser_height : float, optional
        [m] Radius of the wheel less that of its root circle. None takes the robot's, at most a
        quarter of the radius.
    tip_thickness : float, optional
        [m] Thickness of a grouser at its tip. None takes the robot's, reduced in proportion where
        the height is.
    base_thickness : float, optional
        [m] Thickness of a grouser at the root circle, at least that of the tip, and no more than
        keeps its flanks outside that circle. None is that of the tip: parallel flanks.
    phase_fraction : float
        [-] Wheel n, counted from 1 at the rear, starts turned by this share of n times the angle
        between two grousers: eq. (1) of the paper, where it is a third.

    Examples
    --------
    >>> LineOfWheels(3, wheel=GearWheel(grouser_count=12)).wheel.grouser_count
    12
    """

    kind: ClassVar[str] = "gear"
    place: ClassVar[str] = "robot.track.wheel"

    grouser_count: int | None = None
    grouser_height: float | None = None
    tip_thickness: float | None = None
    base_thickness: float | None = None
    phase_fraction: float = 1.0 / 3.0


Wheel = RoundWheel | GearWheel
"""Every wheel."""


@dataclass(frozen=True, slots=True)
class LineOfWheels(Parameters):
    """Driven wheels on the straight line between the end axles, evenly spaced (LWA, Figs. 1 to 3).

    Parameters
    ----------
    count : int
        Wheels a side, the two at the end axles included; at least 2.
    wheel_radius : float, optional
        [m] Radius of every wheel. None takes the outline's, linear between unequal ends. With half
        the spacing the wheels touch, with more they overlap, with less slots stay open.
    wheel : RoundWheel or GearWheel
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
    wheel: Wheel = RoundWheel()


@dataclass(frozen=True, slots=True)
class CircumferentialWheels(Parameters):
    """Small driven wheels all round the outline, each touching it from inside (CWA, Figs. 6, 7).

    The first wheel sits at the rear end of the lower run, the others follow in the direction of
    belt travel: up round the rear, then forwards on top. Their centres move on a path of their own,
    inside the outline by the radius. *Spaced* wheels, of a given radius, divide that path into
    equal lengths, arcs included. *Tight* ones are as large as their count lets them be: each
    touches both its neighbours, so that straight distances are exactly 2 radii.

    Parameters
    ----------
    count : int
        Wheels a side, at least 3. Tight wheels must not have to exceed half the smaller radius of
        the outline, which takes 14 on the Servosila Engineer: fewer are refused.
    wheel_radius : float, optional
        [m] Radius of every wheel, below the smaller radius of the outline. None packs them tightly.
    wheel : RoundWheel or GearWheel
        The shape of each wheel.

    Examples
    --------
    >>> CircumferentialWheels(24, wheel=GearWheel()).count
    24
    """

    kind: ClassVar[str] = "circumferential"
    place: ClassVar[str] = "robot.track"

    count: int
    _: KW_ONLY
    wheel_radius: float | None = None
    wheel: Wheel = RoundWheel()


@dataclass(frozen=True, slots=True)
class HybridWheels(Parameters):
    """Driven wheels of varying sizes, placed by hand (Fig. 8). All run at one surface speed.

    Parameters
    ----------
    placements : array_like, shape (n, 3)
        [m] Centre x and y in the chassis frame and radius of each wheel, the rearmost first.
    wheel : RoundWheel or GearWheel
        The shape of each wheel.

    Raises
    ------
    ScenarioError
        If `placements` holds no real numbers, is masked or has another shape.

    Examples
    --------
    >>> HybridWheels([(-0.18, 0, 0.064), (0, -0.03, 0.034), (0.18, 0, 0.064)]).placements[1]
    (0.0, -0.03, 0.034)
    """

    kind: ClassVar[str] = "hybrid"
    place: ClassVar[str] = "robot.track"

    placements: tuple[tuple[float, float, float], ...]
    _: KW_ONLY
    wheel: Wheel = RoundWheel()


@dataclass(frozen=True, slots=True)
class BeltTrack(Parameters):
    """A taut smooth belt: its surface moves along the outline at track speed.

    The contact surface is closed, so that no edge can get between wheels.
    """

    kind: ClassVar[str] = "belt"
    place: ClassVar[str] = "robot.track"


@dataclass(frozen=True, slots=True, kw_only=True)
class GrouserBeltTrack(Parameters):
    """A taut belt with grousers that travel along it, after Okada et al. (2020).

    On the ground the grousers run rearwards with the belt, round the sprockets they turn with it,
    on top they come back. Belt and grousers have no bodies of their own: they are where the drive
    has run to, so that every contact pulls on the drive by its lever. The tips round the sprockets
    are faster than the belt; a corner that comes down there lifts the robot by some hundredths of a
    millimetre. Height and thickness are those of `robot.outline`, and both must be above 0.

    Parameters
    ----------
    grouser_count : int, optional
        Grousers of one belt, evenly spaced; None takes the whole number that comes nearest to the
        outline's `grouser_pitch`: 22 for the Engineer.
    """

    kind: ClassVar[str] = "grouser_belt"
    place: ClassVar[str] = "robot.track"

    grouser_count: int | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class SegmentalTrack(Parameters):
    """A chain of rigid shoes linked by pins, on a guide or on wheels (section 2.3, Figs. 9, 10).

    Every shoe is a body. The outer faces of the plates run along the roots of the outline, the pins
    in the middle of the plates, so that the robot stands as high as the built one. Grousers are
    those of `robot.outline`, with a `grouser_height` of 0 there are none.

    *Guide*: the plates slide on a guide of the outline's shape without friction. The drive pulls on
    the shoes round its rear end, with the same forces back on the chassis: a sprocket without
    teeth, which counts its shoes.

    *Sprocket*: the mechanism that one sees. A toothed wheel with a spin, an inertia and a torque
    limit of its own at the rear, an idler at the front, road wheels and return rollers on the runs
    between them. Nothing but the flanks of the teeth moves the chain, by its pins. The sprocket has
    the number of teeth that comes nearest to the outline, and the radius that these need; it turns
    evenly, and so the chain does not. Its teeth take the pins beside the plates. Wheels turn with
    what they touch.

    In both, the front end sits on a spring and a damper, the tensioner, which takes up what the
    polygon of the shoes needs more or less as it runs.

    A run has the forces and gaps of the pins (`Run.track_tension`, `max_track_tension`,
    `max_pin_gap`), the places of its shoes (`Run.shoe_poses`), what the chain runs ahead of its
    sprocket or behind (`max_sprocket_slip`), and may end as *detracked*.

    Parameters
    ----------
    shoe_count : int, optional
        Shoes of one chain, 3 to 400; None takes the whole number that comes nearest to the
        outline's `grouser_pitch`: 22 for the Engineer. A shoe must be no longer than the smaller
        end is thick, than half the distance of the axles, nor than a straight run, and weigh at
        least a three-thousandth of the rest of the robot.
    mechanism : {"guide", "sprocket"}
        What the chain runs on and what drives it.
    shoe_shape : {"rectangle", "trapezoid"}
        A flat plate with a grouser on its middle, or one body that tapers from the pins to the tip.
    plate_thickness : float, optional
        [m] Thickness of the plates. None takes a sixteenth of the pitch, our assumption.
    pre_tension : float, optional
        [N] Force of the tensioner of one track. None takes a fortieth of the robot's weight, our
        assumption: much more lifts the robot over the corners of the polygon.
    tensioner_stiffness : float, optional
        [N/m] Stiffness of that tensioner. None lets a tenth of the pitch take all its force.
    tensioner_damping : float, optional
        [N s/m] Its damping. None is critical for the mass of one track.
    road_wheel_count : int, optional
        Wheels on the lower run of one track between sprocket and idler, 0 to 200. None takes as
        many as leave at most a pitch between them: shoes sink where more is free. Only with a
        sprocket.
    return_roller_count : int, optional
        Rollers under the upper run of one track, 0 to 200. None takes as many as leave at most two
        pitches between them. Only with a sprocket.

    Examples
    --------
    >>> import crawler2d as c2d
    >>> robot = c2d.robots.engineer(flippers=None, track=c2d.SegmentalTrack(shoe_count=36))
    >>> run = c2d.simulate(c2d.Scenario(robot, c2d.terrains.flat(), duration=1.0))
    >>> run.metrics["max_pin_gap"] < 1e-4
    True
    >>> c2d.SegmentalTrack(mechanism="sprocket", road_wheel_count=5).shoe_shape
    'rectangle'
    """

    kind: ClassVar[str] = "segmental"
    place: ClassVar[str] = "robot.track"

    shoe_count: int | None = None
    mechanism: Literal["guide", "sprocket"] = "guide"
    shoe_shape: Literal["rectangle", "trapezoid"] = "rectangle"
    plate_thickness: float | None = None
    pre_tension: float | None = None
    tensioner_stiffness: float | None = None
    tensioner_damping: float | None = None
    road_wheel_count: int | None = None
    return_roller_count: int | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class ForceTrack(Parameters):
    """No moving surface: the drive pushes the chassis along its axis at axle height.

    The force follows the speed command, is limited like the traction of a track, and acts in the
    air too: that is the model's flaw, kept as it is.

    Parameters
    ----------
    support : {"skids", "wheels"}
        What carries the robot: skids of the outline's shape, or a line of round wheels that turn
        freely, each by itself.
    skid_friction : float
        [-] Friction of the skids; the smaller of this and the terrain's friction acts.
    wheel_count : int
        Free wheels a side, the two at the end axles included; at least 2.
    """

    kind: ClassVar[str] = "force"
    place: ClassVar[str] = "robot.track"

    support: Literal["skids", "wheels"] = "skids"
    skid_friction: float = 0.0
    wheel_count: int = 5


Track = (
    LineOfWheels
    | CircumferentialWheels
    | HybridWheels
    | BeltTrack
    | GrouserBeltTrack
    | SegmentalTrack
    | ForceTrack
)
"""Every track model."""
