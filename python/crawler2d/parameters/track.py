"""How a track is modelled: one class for each family of the literature.

Figures, sections and equations are those of the paper "Gear Wheels based Simulation of Crawlers for
Mobile Robot Servosila Engineer".
"""

from __future__ import annotations

from dataclasses import KW_ONLY, dataclass
from typing import ClassVar, Literal

from crawler2d.parameters.fields import Parameters

__all__ = [
    "BeltTrack",
    "CircumferentialWheels",
    "ClosedTrack",
    "ForceTrack",
    "GearWheel",
    "GrouserBeltTrack",
    "HybridWheels",
    "LineOfWheels",
    "RoundWheel",
    "SegmentalTrack",
    "Track",
    "Wheel",
    "WheeledTrack",
]


@dataclass(frozen=True, slots=True)
class RoundWheel(Parameters, kind="round", path="robot.track.wheel"):
    """A wheel that is a disc, without grousers."""


@dataclass(frozen=True, slots=True, kw_only=True)
class GearWheel(Parameters, kind="gear", path="robot.track.wheel"):
    """A wheel with grousers: a root circle, and trapezoids whose corners reach the wheel's radius.

    Fields that are None follow from the robot's outline. The paper gives grousers for large wheels
    only; the rules for small ones are ours.

    Parameters
    ----------
    grouser_count : int, optional
        Grousers on the wheel, 3 to 200. None takes the whole number that comes closest to the
        robot's grouser pitch on the root circle, or 8 if that number is less than 6.
    grouser_height : float, optional
        [m] Radius of the wheel less that of its root circle, which must be left. None takes the
        robot's grouser height, but at most a quarter of the radius.
    tip_thickness : float, optional
        [m] Thickness of a grouser at its tip. None takes the robot's, reduced in the same
        proportion as the height.
    base_thickness : float, optional
        [m] Thickness of a grouser at the root circle, at least that at the tip. Neighbours must not
        overlap there, and flanks must stay outside that circle. None takes the thickness at the
        tip: parallel flanks.
    phase_fraction : float
        [-] Wheel n, counted from 1 at the rear, starts turned by n times this share of the angle
        between two grousers: eq. (1) of the paper, where it is a third.

    Examples
    --------
    >>> LineOfWheels(3, wheel=GearWheel(grouser_count=12)).wheel.grouser_count
    12
    """

    grouser_count: int | None = None
    grouser_height: float | None = None
    tip_thickness: float | None = None
    base_thickness: float | None = None
    phase_fraction: float = 1.0 / 3.0


Wheel = RoundWheel | GearWheel
"""Any wheel."""


@dataclass(frozen=True, slots=True)
class LineOfWheels(Parameters, kind="line", path="robot.track"):
    """Driven wheels on the straight line between the end axles, evenly spaced (LWA, Figures 1-3).

    An outline of more than two discs is refused.

    Parameters
    ----------
    count : int
        Wheels per side, including the two at the end axles; at least 2.
    wheel_radius : float, optional
        [m] Radius of every wheel. None takes the outline's, linear between unequal ends. At half
        the spacing the wheels touch; larger ones overlap, smaller ones leave gaps.
    wheel : RoundWheel or GearWheel
        The shape of each wheel.
    as_track : bool
        Whether the wheels stand for a track. False: nothing runs round them, as on a wheeled robot
        or between the flippers of MARV, and no ground between them is inside a track.

    Examples
    --------
    >>> LineOfWheels(4, wheel_radius=0.0608).count
    4
    """

    count: int
    _: KW_ONLY
    wheel_radius: float | None = None
    wheel: Wheel = RoundWheel()
    as_track: bool = True

    @property
    def description(self) -> str:
        """What it is, for titles."""
        return f"{self.count} {self.wheel.kind} wheels in a line"


@dataclass(frozen=True, slots=True)
class CircumferentialWheels(Parameters, kind="circumferential", path="robot.track"):
    """Small driven wheels all round the outline, each touching it from inside (CWA, Figures 6, 7).

    The first wheel sits at the rear end of the lower run; the others follow in the direction of
    belt travel: up round the rear, then forward on top. Their centres lie inside the outline, at
    the distance of the radius. *Spaced* wheels, of a given radius, divide that path into equal
    lengths, arcs included. *Tight* wheels are as large as their count allows: each touches both
    neighbours, so that the straight distance between centres is exactly 2 radii.

    Parameters
    ----------
    count : int
        Wheels per side, at least 3. The radius of tight wheels must not exceed half the smallest
        radius of the outline; on the Servosila Engineer that takes at least 14 wheels.
    wheel_radius : float, optional
        [m] Radius of every wheel, less than the smallest radius of the outline. None: tight wheels.
    wheel : RoundWheel or GearWheel
        The shape of each wheel.

    Examples
    --------
    >>> CircumferentialWheels(24, wheel=GearWheel()).count
    24
    """

    count: int
    _: KW_ONLY
    wheel_radius: float | None = None
    wheel: Wheel = RoundWheel()

    @property
    def description(self) -> str:
        """What it is, for titles."""
        return f"{self.count} {self.wheel.kind} wheels all round"


@dataclass(frozen=True, slots=True)
class HybridWheels(Parameters, kind="hybrid", path="robot.track"):
    """Driven wheels of various sizes, placed by hand (Figure 8), all with one surface speed.

    Parameters
    ----------
    placements : array_like, shape (n, 3)
        [m] Centre x and y in the chassis frame and radius of each wheel, the rearmost first; 1 to
        200 wheels.
    wheel : RoundWheel or GearWheel
        The shape of each wheel.

    Raises
    ------
    ScenarioError
        If `placements` does not hold real numbers, is masked or has another shape.

    Examples
    --------
    >>> HybridWheels([(-0.18, 0, 0.064), (0, -0.03, 0.034), (0.18, 0, 0.064)]).placements[1]
    (0.0, -0.03, 0.034)
    """

    placements: tuple[tuple[float, float, float], ...]
    _: KW_ONLY
    wheel: Wheel = RoundWheel()

    @property
    def description(self) -> str:
        """What it is, for titles."""
        wheels = "wheel" if len(self.placements) == 1 else "wheels"
        return f"{len(self.placements)} {self.wheel.kind} {wheels} placed by hand"


@dataclass(frozen=True, slots=True)
class BeltTrack(Parameters, kind="belt", path="robot.track"):
    """A taut smooth belt: its surface moves along the outline at track speed.

    The contact surface is closed: no edge can get between wheels.
    """

    @property
    def description(self) -> str:
        """What it is, for titles."""
        return "smooth belt"


@dataclass(frozen=True, slots=True, kw_only=True)
class GrouserBeltTrack(Parameters, kind="grouser_belt", path="robot.track"):
    """A taut belt with grousers that travel along it, after Okada et al. (2020).

    The grousers run rearwards with the belt along the ground, turn with it round the sprockets and
    come back on top. Belt and grousers are not bodies of their own: their place follows from the
    travel of the drive, and every contact acts on the drive through its lever arm. Round the
    sprockets the tips are faster than the belt; an edge met there lifts the robot by some
    hundredths of a millimetre. Height and thickness are those of `robot.outline`; both must be > 0.

    Parameters
    ----------
    grouser_count : int, optional
        Grousers per belt, evenly spaced, 1 to 200; they must fit on it side by side. None takes
        the whole number that comes closest to the outline's `grouser_pitch`: 22 for the Engineer.
    """

    grouser_count: int | None = None

    @property
    def description(self) -> str:
        """What it is, for titles."""
        return "belt with grousers"


@dataclass(frozen=True, slots=True, kw_only=True)
class SegmentalTrack(Parameters, kind="segmental", path="robot.track"):
    """A chain of rigid shoes linked by pins, on a guide or on wheels (section 2.3, Figures 9, 10).

    Every shoe is a body. The outer faces of the plates run along the roots of the outline and the
    pins along the middle of the plates, so that the robot stands as high as the real one. Grousers
    are those of `robot.outline`; with a `grouser_height` of 0 there are none.

    *Guide*: the plates slide without friction on a guide of the outline's shape. The drive pulls on
    the shoes round the rear end, and the chassis takes the reaction: a sprocket without teeth, to
    whose travel each shoe adds a pitch as it goes round.

    *Sprocket*: the full mechanism, on an outline of two discs. At the rear a toothed wheel with its
    own speed, inertia and torque limit, at the front an idler, between them road wheels and return
    rollers. The chain is driven only by the flanks of the teeth, which act on its pins. The
    sprocket has the number of teeth that comes closest to the outline, and the radius that follows;
    it turns evenly, so the chain does not. The teeth take the pins beside the plates. Idler, road
    wheels and rollers turn with what they touch.

    In both, the front end sits on a tensioner, a spring with a damper, which follows the small
    changes of length that the polygon of shoes needs as it runs.

    A run has the forces and gaps of the pins (`Run.track_tension`, `max_track_tension`,
    `max_pin_gap`), the poses of the shoes (`Run.shoe_poses`), the slip between chain and sprocket
    (`max_sprocket_slip`), and may end as *detracked*.

    Parameters
    ----------
    shoe_count : int, optional
        Shoes per chain, 3 to 400; None takes the whole number that comes closest to the outline's
        `grouser_pitch`: 22 for the Engineer. A shoe must not be longer than the diameter of the
        smallest disc, half the axle distance or a straight run, also if the chain is a tenth longer
        than the belt in its place; and it must weigh at least 1/3000 of the rest of the robot.
    mechanism : {"guide", "sprocket"}
        What the chain runs on and what drives it.
    shoe_shape : {"rectangle", "trapezoid"}
        A flat plate with a grouser in the middle, or one body that tapers from the pins to the tip.
    plate_thickness : float, optional
        [m] Thickness of the plates, less than the smallest radius without its grousers. None takes
        1/16 of the pitch, our assumption.
    pre_tension : float, optional
        [N] Force of the tensioner of one track. None takes 1/40 of the robot's weight, our
        assumption: much more would lift the robot over the corners of the polygon.
    tensioner_stiffness : float, optional
        [N/m] Stiffness of that tensioner. None: a tenth of the pitch takes up its whole force.
    tensioner_damping : float, optional
        [N s/m] Damping of that tensioner. None: critical damping for the mass of one track.
    pin_stiffness : float
        [N m/rad] Stiffness of the bushing of each pin of one track, such as those of rubber in live
        tracks: a spring that is at rest where the shoes of the pin are in line.
    pin_damping : float
        [N m s/rad] Its damping. The pin that closes the chain, its master link, has no bushing.
    road_wheel_count : int, optional
        Wheels on the lower run of one track between sprocket and idler, 0 to 200. None takes enough
        to leave gaps of at most one pitch: shoes sink into larger gaps. Only with a sprocket.
    return_roller_count : int, optional
        Rollers under the upper run of one track, 0 to 200. None takes enough to leave gaps of at
        most two pitches. Only with a sprocket.

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

    omitted_defaults: ClassVar[tuple[str, ...]] = ("pin_stiffness", "pin_damping")

    shoe_count: int | None = None
    mechanism: Literal["guide", "sprocket"] = "guide"
    shoe_shape: Literal["rectangle", "trapezoid"] = "rectangle"
    plate_thickness: float | None = None
    pre_tension: float | None = None
    tensioner_stiffness: float | None = None
    tensioner_damping: float | None = None
    pin_stiffness: float = 0.0
    pin_damping: float = 0.0
    road_wheel_count: int | None = None
    return_roller_count: int | None = None

    @property
    def description(self) -> str:
        """What it is, for titles."""
        return f"chain of shoes {'on a guide' if self.mechanism == 'guide' else 'round a sprocket'}"


@dataclass(frozen=True, slots=True, kw_only=True)
class ForceTrack(Parameters, kind="force", path="robot.track"):
    """No moving surface: the drive pushes the chassis along its axis, x of the chassis frame.

    The force follows the speed command and is limited like the traction of a track. It acts in the
    air, too: a known flaw of this model, kept on purpose.

    Parameters
    ----------
    support : {"skids", "wheels"}
        What carries the robot: skids in the shape of the outline, or a line of round wheels that
        turn freely and independently, for an outline of two discs only.
    skid_friction : float
        [-] Friction of the skids; the smaller of this and the terrain's friction applies.
    wheel_count : int
        Free wheels per side, including the two at the end axles; at least 2.
    """

    support: Literal["skids", "wheels"] = "skids"
    skid_friction: float = 0.0
    wheel_count: int = 5

    @property
    def description(self) -> str:
        """What it is, for titles."""
        carrying = "skids" if self.support == "skids" else f"{self.wheel_count} free wheels"
        return f"{carrying} pushed by a force"


WheeledTrack = LineOfWheels | CircumferentialWheels | HybridWheels
"""Any track model of driven wheels."""

OpenTrack = WheeledTrack | BeltTrack | GrouserBeltTrack | SegmentalTrack | ForceTrack
"""Any track model that can be closed."""


@dataclass(frozen=True, slots=True)
class ClosedTrack(Parameters, kind="closed", path="robot.track"):
    """A belt closed round the bodies of another model: what that model would be without pockets.

    It is taut round the circumscribed circles of the bodies, on the chassis and on every arm, and
    has all of their mass and motor force. Where `BeltTrack` follows the robot's outline, this
    follows the model: on an arm of smaller wheels, or round wheels placed by hand. A belly that
    lies inside it is covered.

    Parameters
    ----------
    of : track model
        The model round whose bodies it runs; not a closed one.
    surface : {"own", "smooth"}
        "own": grousers where the model has some, as high as the model's, as thick and as far apart
        as the outline's, within the same circles, at most 200; none if that thickness is 0.
        "smooth": none.

    Examples
    --------
    >>> import crawler2d as c2d
    >>> wheels = c2d.LineOfWheels(4)
    >>> robot = c2d.robots.engineer(flippers=None, track=wheels)
    >>> str(c2d.simulate(robot, c2d.terrains.step(0.08)).outcome)
    'seized'
    >>> closed = robot.with_track(c2d.ClosedTrack(wheels))
    >>> str(c2d.simulate(closed, c2d.terrains.step(0.08)).outcome)
    'cleared'
    """

    of: OpenTrack
    _: KW_ONLY
    surface: Literal["own", "smooth"] = "own"

    @property
    def description(self) -> str:
        """What it is, for titles."""
        return f"belt closed round {self.of.description}"


Track = OpenTrack | ClosedTrack
"""Any track model."""
