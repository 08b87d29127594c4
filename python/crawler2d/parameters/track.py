"""Track models: one class for each family in the literature.

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
        [m] Radius of the wheel minus that of its root circle, which must be > 0. None takes the
        robot's grouser height, but at most a quarter of the radius.
    tip_thickness : float, optional
        [m] Thickness of a grouser at its tip. None takes the robot's, reduced in the same
        proportion as the height.
    base_thickness : float, optional
        [m] Thickness of a grouser at the root circle, at least that at the tip. Neighbours must not
        overlap there, and flanks must stay outside the circle. None takes the thickness at the tip:
        parallel flanks.
    phase_fraction : float
        [-] Wheel n, counted from 1 at the rear, starts turned by n times this fraction of the angle
        between two grousers: eq. (1) of the paper, which uses a third.

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
    """Evenly spaced driven wheels on the line between the end axles (LWA, Figures 1-3).

    Only for outlines of two discs.

    Parameters
    ----------
    count : int
        Wheels per side, including the two at the end axles; at least 2.
    wheel_radius : float, optional
        [m] Radius of every wheel. None takes that of the outline, interpolated linearly between
        unequal ends. With a radius of half the spacing the wheels touch; larger ones overlap,
        smaller ones leave gaps.
    wheel : RoundWheel or GearWheel
        The shape of each wheel.
    as_track : bool
        Whether the wheels model a track. False: no track runs round them, as on a wheeled robot or
        between the flippers of MARV, so ground between them is not inside a track.

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
        """Short description, for titles."""
        return f"{self.count} {self.wheel.kind} wheels in a line"


@dataclass(frozen=True, slots=True)
class CircumferentialWheels(Parameters, kind="circumferential", path="robot.track"):
    """Small driven wheels all round the outline, each touching it from inside (CWA, Figures 6, 7).

    The first wheel sits at the rear end of the lower run; the others follow in the direction of
    belt travel: up round the rear, then forward on top. Their centres lie on a path one wheel
    radius inside the outline. *Spaced* wheels have a given radius and divide that path into equal
    lengths, arcs included. *Tight* wheels are as large as their count allows: each touches both
    neighbours, so the straight distance between centres is exactly 2 radii.

    Parameters
    ----------
    count : int
        Wheels per side, at least 3. The radius of tight wheels must not exceed half the smallest
        radius of the outline; the Servosila Engineer needs at least 14 wheels for that.
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
        """Short description, for titles."""
        return f"{self.count} {self.wheel.kind} wheels all round"


@dataclass(frozen=True, slots=True)
class HybridWheels(Parameters, kind="hybrid", path="robot.track"):
    """Driven wheels of various sizes, placed by hand (Figure 8), with the same surface speed.

    Parameters
    ----------
    placements : array_like, shape (n, 3)
        [m] Centre x and y in the chassis frame and radius of each of 1 to 200 wheels, the rearmost
        first.
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
        """Short description, for titles."""
        wheels = "wheel" if len(self.placements) == 1 else "wheels"
        return f"{len(self.placements)} {self.wheel.kind} {wheels} placed by hand"


@dataclass(frozen=True, slots=True)
class BeltTrack(Parameters, kind="belt", path="robot.track"):
    """A taut smooth belt whose surface moves along the outline at track speed.

    The contact surface is closed, so no edge can get between wheels.
    """

    @property
    def description(self) -> str:
        """Short description, for titles."""
        return "smooth belt"


@dataclass(frozen=True, slots=True, kw_only=True)
class GrouserBeltTrack(Parameters, kind="grouser_belt", path="robot.track"):
    """A taut belt with travelling grousers, after Okada et al. (2020).

    The grousers move with the belt: rearwards along the ground, round the sprocket, and forwards on
    top. Belt and grousers are not separate bodies: the travel of the drive sets their position, and
    every contact acts on the drive through its lever arm. Round the ends the tips are faster than
    the belt; an edge met there lifts the robot by some hundredths of a millimetre. Height and
    thickness are those of `robot.outline`; both must be > 0.

    Parameters
    ----------
    grouser_count : int, optional
        Grousers per belt, evenly spaced, 1 to 200; they must fit on it side by side. None takes
        the whole number that comes closest to the outline's `grouser_pitch`: 22 for the Engineer.
    """

    grouser_count: int | None = None

    @property
    def description(self) -> str:
        """Short description, for titles."""
        return "belt with grousers"


@dataclass(frozen=True, slots=True, kw_only=True)
class SegmentalTrack(Parameters, kind="segmental", path="robot.track"):
    """A chain of rigid shoes linked by pins, on a guide or on wheels (section 2.3, Figures 9, 10).

    Every shoe is a body. The outer faces of the plates run along the grouser roots of the outline
    and the pins along the middle of the plates, so the robot stands as high as the real one.
    Grousers are those of `robot.outline`; a `grouser_height` of 0 means none.

    *Guide*: the plates slide without friction on a guide of the outline's shape. The drive pulls on
    the shoes round the rear end, and the chassis takes the reaction, as with a sprocket without
    teeth. Each shoe that goes round adds a pitch to its travel.

    *Sprocket*: the full mechanism, on an outline of two discs: at the rear a toothed wheel with its
    own speed, inertia and torque limit, at the front an idler, between them road wheels and return
    rollers. Only the flanks of the teeth drive the chain, by pushing on its pins beside the plates.
    The number of teeth is the one closest to the outline, and sets the sprocket's radius. The
    sprocket turns evenly, so the chain does not. Idler, road wheels and rollers roll with the
    surfaces they touch.

    In both, the front end sits on a tensioner, a spring with a damper, which takes up the small
    changes of length of the running polygon of shoes.

    A run records pin forces and gaps (`Run.track_tension`, `max_track_tension`, `max_pin_gap`), the
    poses of the shoes (`Run.shoe_poses`) and the slip between chain and sprocket
    (`max_sprocket_slip`); it may end as *detracked*.

    Parameters
    ----------
    shoe_count : int, optional
        Shoes per chain, 3 to 400; None takes the whole number that comes closest to the outline's
        `grouser_pitch`: 22 for the Engineer. A shoe must not be longer than the diameter of the
        smallest disc, half the axle distance or a straight run, even if the chain is a tenth longer
        than the belt it replaces; and it must weigh at least 1/3000 of the rest of the robot.
    mechanism : {"guide", "sprocket"}
        What carries and drives the chain.
    shoe_shape : {"rectangle", "trapezoid"}
        A flat plate with a grouser in the middle, or one body that tapers from the pins to the tip.
    plate_thickness : float, optional
        [m] Thickness of the plates, less than the smallest radius without grousers. None takes 1/16
        of the pitch, our assumption.
    pre_tension : float, optional
        [N] Force of the tensioner of one track. None takes 1/40 of the robot's weight, our
        assumption: much more would lift the robot over the corners of the polygon.
    tensioner_stiffness : float, optional
        [N/m] Stiffness of that tensioner. None: a travel of a tenth of the pitch takes up its whole
        force.
    tensioner_damping : float, optional
        [N s/m] Damping of that tensioner. None: critical damping for the mass of one track.
    pin_stiffness : float
        [N m/rad] Stiffness of the bushing of each pin of one track, such as the rubber bushings of
        live tracks: a spring that is relaxed when the two shoes are in line.
    pin_damping : float
        [N m s/rad] Damping of each bushing. The pin that closes the chain, its master link, has
        none.
    road_wheel_count : int, optional
        Wheels on the lower run of one track between sprocket and idler, 0 to 200. None takes enough
        for gaps of at most one pitch, as shoes sink into larger ones. Only with a sprocket.
    return_roller_count : int, optional
        Rollers under the upper run of one track, 0 to 200. None takes enough for gaps of at most
        two pitches. Only with a sprocket.

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
        """Short description, for titles."""
        return f"chain of shoes {'on a guide' if self.mechanism == 'guide' else 'round a sprocket'}"


@dataclass(frozen=True, slots=True, kw_only=True)
class ForceTrack(Parameters, kind="force", path="robot.track"):
    """No moving surface: the drive pushes the chassis along x of the chassis frame.

    The force follows the speed command and is limited like the traction of a track. It acts even in
    the air: a known flaw of this model, kept on purpose.

    Parameters
    ----------
    support : {"skids", "wheels"}
        What carries the robot: skids in the shape of the outline, or, for outlines of two discs, a
        line of round wheels that turn freely and independently.
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
        """Short description, for titles."""
        carrying = "skids" if self.support == "skids" else f"{self.wheel_count} free wheels"
        return f"{carrying} pushed by a force"


WheeledTrack = LineOfWheels | CircumferentialWheels | HybridWheels
"""Any track model of driven wheels."""

OpenTrack = WheeledTrack | BeltTrack | GrouserBeltTrack | SegmentalTrack | ForceTrack
"""Any track model that can be closed."""


@dataclass(frozen=True, slots=True)
class ClosedTrack(Parameters, kind="closed", path="robot.track"):
    """A belt round the bodies of another model, which removes its pockets.

    The belt is taut round the circumscribed circles of the bodies, on the chassis and on every arm,
    and has all of their mass and motor force. `BeltTrack` follows the robot's outline; this follows
    the model, such as an arm with smaller wheels, or wheels placed by hand. A belly inside it is
    covered.

    Parameters
    ----------
    of : track model
        The model whose bodies the belt encloses; not a closed track.
    surface : {"own", "smooth"}
        "own": grousers if the model has some, with the model's height and the outline's thickness
        and pitch, within the same circles, at most 200; none if that thickness is 0. "smooth":
        none.

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
        """Short description, for titles."""
        return f"belt closed round {self.of.description}"


Track = OpenTrack | ClosedTrack
"""Any track model."""
