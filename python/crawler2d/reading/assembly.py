"""From a neutral tree to a robot: sides paired, masses summed, every figure with its source."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, field, replace

import numpy as np

from crawler2d.errors import ScenarioError
from crawler2d.model_tree import Array, Link, Pose, Shape, Tree, Where
from crawler2d.parameters.robot import Robot, TrackOutline
from crawler2d.parameters.track import BeltTrack, LineOfWheels, Track
from crawler2d.reading.engines import combined, drivetrain_of
from crawler2d.reading.flippers import ArmPair, AtEnd, arm_pairs, arms_at, flippers_of
from crawler2d.reading.log import Telling, estimate, lines, named, place_of
from crawler2d.reading.running_gear import (
    Pair,
    SideView,
    centers,
    is_belted,
    middle_of,
    paired,
    running_gear_of,
    side_view,
)
from crawler2d.reading.surfaces import surfaces_of
from crawler2d.reading.tracks import (
    Base,
    belt_round,
    beyond_belt,
    ends_among,
    hull,
    silhouette,
    wheels_of,
)
from crawler2d.reading.wheels import Runner, RunningGear

__all__ = ["Assembly", "Silhouette", "assembled", "silhouettes"]

_LARGEST = 3.0  # [m] The largest tracked robots that climb obstacles are shorter.


def bent_round(
    told: Telling,
    pairs: list[Pair],
    arms: list[ArmPair],
    castors: list[Runner],
    *,
    is_belt: bool,
) -> list[Pair]:
    """Return what the outline is the hull of, from the rear to the front; note its lines.

    The two outermost wheels, or the drums that a belt bends round; without either, the roots of
    flippers; of a robot with one wheel a side, that and its castors.

    Raises
    ------
    ScenarioError
        If there is nothing to stand on at one end, or something reaches out of a belt.
    """
    if is_belt:
        bent = belt_round(pairs, at=told.at)
    elif len(pairs) == 1 and castors:
        # One wheel a side is no track: the robot stands on it and on what it trails.
        bent = sorted([*pairs, *map(_alone, castors)], key=lambda pair: pair.x)
        reason = "is no track: its outline is drawn round it and the free wheels in the middle"
        told.doubts.append(("robot.outline", "one wheel a side", reason))
    elif pairs:
        bent = [pairs[0], pairs[-1]]
    else:
        # Nothing runs between the flippers: the robot stands on their roots.
        order = sorted(arms, key=lambda arm: float(arm.pivot[0]))
        if len(order) < 2:
            rule = "must have wheels on the chassis, or flippers at both ends"
            raise ScenarioError(str(told.at), "flippers at one end", rule)
        bent = [order[0].pairs[0], order[-1].pairs[0]]
        text = "the chassis has no wheels: it stands on the roots of its flippers"
        told.notes.append(text)
        told.note("robot.track", estimate(f"{text}, which are no track"))
    runners = [runner for pair in bent for runner in pair.both]
    places = [place_of(runner) for runner in runners]
    if len(bent) > 2:
        sizes = [runner.shape.size_at for runner in runners]
        told.note("robot.outline.discs", lines([*places, *sizes]))
    else:
        told.note("robot.outline.axle_distance", lines(places))
        for name, pair in zip(("rear_radius", "front_radius"), bent, strict=True):
            told.note(f"robot.outline.{name}", lines([r.shape.size_at for r in pair.both]))
    if pairs:
        of_all = [s.size_at for pair in pairs for runner in pair.both for s in runner.surfaces]
        told.note("robot.track", lines(of_all, "sizes"))
    return bent


def _alone(castor: Runner) -> Pair:
    return Pair(left=(castor,), right=(castor,), x=castor.x, y=castor.y, radius=castor.radius)


def frame_of(told: Telling, bent: list[Pair], tolerance: float) -> tuple[Base, Pair]:
    """Return the chassis frame, and what is on the rear end axle.

    Raises
    ------
    ScenarioError
        If there is no distance between the two.
    """
    rear, front = bent if len(bent) == 2 else ends_among(bent)
    base = Base(
        rear=np.array([rear.x, rear.y]),
        front=np.array([front.x, front.y]),
        is_level=len(bent) > 2,
    )
    if base.length <= tolerance:
        rule = "must have two wheels or drums on each side"
        raise ScenarioError(str(told.at), base.length, rule)
    return base, rear


def outline_of(told: Telling, base: Base, bent: list[Pair]) -> TrackOutline:
    """Return the outline, without grousers, which no format has."""
    for name in ("grouser_height", "grouser_pitch", "grouser_thickness"):
        told.note(f"robot.outline.{name}", estimate("the file has no grousers"))
    radii = [pair.radius for pair in bent]
    grousers = {
        "grouser_height": 0.0,
        "grouser_pitch": 0.75 * min(radii),
        "grouser_thickness": 0.0,
    }
    if len(bent) == 2:
        rear, front = radii
        outline = TrackOutline(
            axle_distance=base.length, front_radius=front, rear_radius=rear, **grousers
        )
    else:
        places = base.of(centers(bent))
        outline = TrackOutline(discs=np.column_stack([places, radii]), **grousers)
    length = outline.axle_distance
    whole = length + outline.rear_radius + outline.front_radius
    if whole > _LARGEST:
        power = math.ceil(math.log10(whole / _LARGEST))
        reason = (
            f"is usually at most {_LARGEST:g} m with the wheels: is the file in metres?"
            f" scale={10.0**-power:g} reads it so much smaller"
        )
        told.doubts.append(("robot.outline.axle_distance", length, reason))
    return outline


Corners = tuple[tuple[float, float], ...]


def belly_of(shapes: list[tuple[Link, Shape]], view: SideView, base: Base) -> Corners | None:
    """Return the belly in the chassis frame, counter-clockwise; None if there is none."""
    if not shapes:
        return None
    flat = [base.of(silhouette(shape, view)) for _, shape in shapes]
    corners = hull(np.concatenate(flat))
    if len(corners) < 3:
        return None
    return tuple((float(x), float(y)) for x, y in corners)


@dataclass(frozen=True, slots=True, kw_only=True)
class Sum:
    """Several links as one, in the chassis frame.

    Parameters
    ----------
    mass : float
        [kg] Their mass.
    center : tuple of float, shape (2,)
        [m] Their centre of mass.
    inertia : float
        [kg m^2] About that.
    """

    mass: float
    center: tuple[float, float]
    inertia: float


def summed(tree: Tree, view: SideView, base: Base, arms: Iterable[tuple[AtEnd, float]]) -> Sum:
    """Sum all links, with the flippers turned to angle 0, as the figures of a robot have them.

    Parameters
    ----------
    tree : Tree
        The model.
    view : SideView
        Its side view.
    base : Base
        Its chassis frame.
    arms : iterable of (AtEnd, float)
        The flippers, and 1 at the front or -1 at the rear.

    Returns
    -------
    Sum
        Of the whole robot.
    """
    mass = np.array([link.mass for link in tree.links])
    places = base.of(view.of(np.array([link.center for link in tree.links]))[:, :2])
    number = {link.name: index for index, link in enumerate(tree.links)}
    for end, sign in arms:
        for arm in end.pair.arms:
            pivot = base.of(arm.pivot[None, :2])[0]
            turn = _rotation(-sign * end.angle)
            for link in arm.links:
                index = number[link.name]
                places[index] = pivot + turn @ (places[index] - pivot)
    whole = float(mass.sum())
    center = mass @ places / whole if whole > 0.0 else np.zeros(2)
    own = sum(view.about_left(link.inertia) for link in tree.links)
    swung = float(mass @ ((places - center) ** 2).sum(axis=1))
    return Sum(mass=whole, center=(float(center[0]), float(center[1])), inertia=own + swung)


def _rotation(angle: float) -> Array:
    cos, sin = math.cos(angle), math.sin(angle)
    return np.array([[cos, -sin], [sin, cos]])


def circulating(pairs: list[Pair]) -> tuple[float, bool]:
    """[kg] Return the mass that turns with the wheels: moment of inertia by radius squared.

    No body within a wheel's radius has more than its mass there, so no wheel counts for more; the
    second value says whether one would have.
    """
    total, is_excessive = 0.0, False
    for pair in pairs:
        for wheel in pair.both:
            own = wheel.inertia / wheel.radius**2
            is_excessive |= own > wheel.mass * (1.0 + 1e-6)
            total += min(own, wheel.mass)
    return total, is_excessive


_SHOWN = 4  # names of links in a doubt


_LEAST_MOVING = 0.001  # [kg] The least that a robot can have.


_MOVING_SHARE = 0.01  # of the mass, for a surface that moves without mass in its file


@dataclass(slots=True, kw_only=True)
class Assembly:
    """A robot in the making.

    Parameters
    ----------
    tree : Tree
        The model.
    tolerance : float
        [m] By how much the two sides may differ.
    engine : str
        By whose laws its motors work.
    told : Telling
        What is told about it.
    view : SideView
        The side view.
    middle : float
        [m] Where the middle plane lies across it.
    base : Base
        The chassis frame in the side view.
    """

    tree: Tree
    tolerance: float
    engine: str
    told: Telling
    view: SideView = field(init=False)
    middle: float = field(init=False)
    base: Base = field(init=False)

    def robot(self, forward: str | None) -> Robot:
        """Make the robot.

        Raises
        ------
        ScenarioError
            If the model has what a side view cannot hold, or breaks a rule of a robot.
        """
        tree, at, tolerance = self.tree, self.tree.at, self.tolerance
        surfaces = surfaces_of(tree)
        self.told.doubts += surfaces.doubts
        self.view = view = side_view(tree, surfaces, forward)
        self.told.notes.append(f"{view.reason}: {_named(view.forward)} is forward")
        gear = running_gear_of(tree, view, surfaces)
        runners = gear.runners + [r for arm in gear.arms for r in arm.runners]
        self.middle = middle = middle_of(gear.runners or runners)
        castors = gear.without_castors(middle, tolerance)
        self.doubt_passive(gear, castors)
        pairs = paired(gear.runners, middle=middle, tolerance=tolerance, at=at)
        arms = arm_pairs(self.told, gear.arms, view, middle=middle, tolerance=tolerance, at=at)
        is_belt = is_belted(gear.runners, str(at))
        if gear.bars and not is_belt:
            rule = "must have a drum at either end of a track"
            raise ScenarioError(str(at), "moved boxes only", rule)
        bent = bent_round(self.told, pairs, arms, castors, is_belt=is_belt)
        if is_belt:
            self.sort_boxes(gear, bent, is_moved=not surfaces.taken)
        base, rear = frame_of(self.told, bent, tolerance)
        self.base = base
        by_end = arms_at(self.told, arms, base, view, radius=rear.radius, tolerance=tolerance)
        track: Track = BeltTrack() if is_belt else LineOfWheels(2, as_track=False)
        if pairs and not is_belt:
            track = wheels_of(self.told, pairs, base, view)
        total = summed(tree, view, base, [(by_end[end], _SIGN[end]) for end in by_end])
        if not total.mass > 0.0:
            raise ScenarioError(str(at), total.mass, "must have links with a mass > 0 kg")
        self.told.note("robot.name", f"{at}")
        self.told.note("robot.mass", lines([link.mass_at for link in tree.links], "sum"))
        angle = " at angle 0" if by_end else ""
        of_links = lines([link.at for link in tree.links], f"sum{angle}")
        self.told.note("robot.center_of_mass", of_links)
        self.told.note("robot.moment_of_inertia", of_links)
        outline = outline_of(self.told, base, bent)
        driven = pairs or [pair for end in by_end.values() for pair in end.pair.pairs]
        torque = _holding_torque(total.mass, rear.radius)
        drivetrain = drivetrain_of(
            self.told,
            tree,
            driven,
            track,
            engine=self.engine,
            radius=rear.radius,
            torque=torque,
        )
        flippers = flippers_of(
            self.told, by_end, total.mass, engine=self.engine, is_mjcf=tree.format == "MJCF"
        )
        if flippers is not None and isinstance(flippers.track, BeltTrack):
            drivetrain = replace(drivetrain, torque_sharing="track")
        self.note_rows(pairs, by_end)
        return Robot(
            tree.name or "robot",
            mass=total.mass,
            center_of_mass=total.center,
            moment_of_inertia=total.inertia,
            track_mass=self.track_mass([] if is_belt else pairs, total.mass),
            outline=outline,
            belly=self.belly(gear, base, driven),
            flippers=flippers,
            gauge=self.gauge(pairs or driven),
            drivetrain=drivetrain,
            track=track,
        )

    @property
    def frame(self) -> Pose:
        """The chassis frame in that of the model: x forward, y to the left, z up."""
        view, base = self.view, self.base
        side = np.stack([view.forward, view.up], axis=1)  # turns the side view into the model
        ahead = base.ahead
        turn = np.stack([side @ ahead, view.left, side @ (-ahead[1], ahead[0])], axis=1)
        place = side @ (0.5 * (base.front + base.rear)) + self.middle * view.left
        return Pose(place=place, turn=turn)

    def sort_boxes(self, gear: RunningGear, bent: list[Pair], *, is_moved: bool) -> None:
        """Take what lies within the belt for a part of it, and what reaches out for the belly.

        Raises
        ------
        ScenarioError
            If something moves that reaches out where it may meet the ground.
        """
        if not is_moved:  # by the file: then what stands between the drums is no belly
            gear.bars += gear.shapes
            gear.shapes = []
        outlines = [silhouette(shape, self.view) for _, shape in gear.bars]
        for (link, shape), (out, low) in zip(gear.bars, beyond_belt(outlines, bent), strict=True):
            path = f"{shape.at}: collision[{shape.name}]"
            if is_moved and low > 0.0:
                rule = "must lie within the belt round the drums, but for its upper run"
                raise ScenarioError(path, f"a moved shape {1e3 * low:.3g} mm beyond it", rule)
            if out > 0.0:
                gear.shapes.append((link, shape))
            if out > 0.0 and is_moved:
                reason = "reaches out of the belt round the drums: read as belly, which stands"
                self.told.doubts.append((path, f"{1e3 * out:.3g} mm", reason))

    def doubt_passive(self, gear: RunningGear, castors: list[Runner]) -> None:
        """Doubt wheels without a motor, beside others that have one."""
        for wheels, reason in (
            (castors, "roll freely in the middle: read as skids of the belly, which slide"),
            (
                [r for r in gear.runners if r.name in gear.passive],
                "roll freely beside others that are driven: read as driven, as by a track round"
                " all",
            ),
        ):
            if wheels:
                names = named([wheel.name for wheel in wheels], _SHOWN)
                self.told.doubts.append((str(wheels[0].link.at), names, reason))

    def track_mass(self, pairs: list[Pair], mass: float) -> float:
        """[kg] Return what moves at track speed."""
        moving, is_excessive = circulating(pairs)
        if not _LEAST_MOVING <= moving < mass:
            self.told.note(
                "robot.track_mass", estimate("a hundredth of the mass: the file has none")
            )
            return _MOVING_SHARE * mass
        wheels = [runner.link.at for pair in pairs for runner in pair.both]
        self.told.note("robot.track_mass", lines(wheels, "moment of inertia by radius squared"))
        if is_excessive:
            rule = "the mass of the wheels, as of hoops: their moments of inertia exceed it"
            self.told.note("robot.track_mass", estimate(rule))
            self.told.doubts.append(
                (
                    "robot.track_mass",
                    float(f"{moving:.4g}"),
                    "is limited to hoops: wheels state more inertia",
                )
            )
        return moving

    def belly(
        self, gear: RunningGear, base: Base, driven: list[Pair]
    ) -> tuple[tuple[float, float], ...] | None:
        """Return the belly; doubt one that touches level ground, tell what it leaves out."""
        corners = belly_of(gear.shapes, self.view, base)
        moving = list(dict.fromkeys(link.name for _, link, _ in gear.moving))
        if moving:
            self.told.notes.append(
                f"{', '.join(moving)}: move by themselves, and touch nothing here"
            )
        if corners is None:
            self.told.note("robot.belly", f"{self.tree.at}: no collision shape on the chassis")
            return None
        self.told.note("robot.belly", lines([shape.at for _, shape in gear.shapes], "hull"))
        places = base.of(centers(driven))
        ground = min(float(y) - pair.radius for (_, y), pair in zip(places, driven, strict=True))
        lowest = min(y for _, y in corners)
        if lowest <= ground + self.tolerance:
            reason = "rubs on level ground: a skid beside the wheels counts as belly"
            self.told.doubts.append(("robot.belly", lowest, reason))
        return corners

    def gauge(self, pairs: list[Pair]) -> float:
        """[m] Return the lateral distance of the tracks; tell of wheels that stand apart."""
        runners = [runner for pair in pairs for runner in pair.both]
        across = [abs(runner.z - self.middle) for runner in runners]
        usual = float(np.median(across))
        self.told.note("robot.gauge", lines([place_of(runner) for runner in runners], "median"))
        for runner, own in zip(runners, across, strict=True):
            if abs(own - usual) > self.tolerance:
                where = "inboard" if own < usual else "outboard"
                off = 1e3 * abs(own - usual)
                self.told.notes.append(f"{runner.name}: {off:.3g} mm {where} of the others")
        return 2.0 * usual

    def note_rows(self, pairs: list[Pair], by_end: dict[str, AtEnd]) -> None:
        """List all wheels: left before right, chassis before flippers."""
        carriers = [("chassis", pairs)]
        carriers += [(f"{end} flipper", list(each.pair.pairs)) for end, each in by_end.items()]
        for _, each in carriers:
            for pair in each:
                self.note_aslant(pair)
        for side in ("left", "right"):
            for carrier, each in carriers:
                found = [runner for pair in each for runner in getattr(pair, side)]
                self.told.rows += [(carrier, runner) for runner in sorted(found, key=lambda r: r.x)]
        swapped = [r.name for _, r in self.told.rows if _is_swapped(r, self.middle)]
        if swapped:
            reason = "is on the other side than its name says: is forward right?"
            self.told.doubts.append(("forward", swapped[0], reason))

    def note_aslant(self, pair: Pair) -> None:
        """Tell of a pair that is not mirrored across: a side view does not see it."""
        left, right = pair.left[0], pair.right[0]
        off = abs(left.z + right.z - 2.0 * self.middle)
        if off > self.tolerance:
            text = f"{left.name} and {right.name}: not mirrored across, by {1e3 * off:.3g} mm"
            self.told.notes.append(text)


_SIGN = {"front": 1.0, "rear": -1.0}


def assembled(
    tree: Tree, *, forward: str | None, tolerance: float, engine: str, ground: float
) -> tuple[Robot, float, Assembly]:
    """Make a robot of a tree, with its friction on the ground and where that is from."""
    work = Assembly(tree=tree, tolerance=tolerance, engine=engine, told=Telling(at=tree.at))
    robot = work.robot(forward)
    runners = [runner for _, runner in work.told.rows]
    friction, source, places = combined(runners, work.view, engine, ground)
    at = f": {lines(places)}" if places else ""
    work.told.note("friction", f"{source}{at}")
    return robot, friction, work


def _is_swapped(runner: Runner, middle: float) -> bool:
    name = runner.name.lower()
    is_left, is_right = "left" in name, "right" in name
    return is_left is not is_right and is_left is not (runner.z > middle)


def _holding_torque(mass: float, radius: float) -> float:
    """[N m] Return the estimate of `Robot.simple`: 1.6 times what holds it on 45 degrees."""
    simple = Robot.simple(mass, axle_distance=1.0, radius=radius)
    height = simple.outline.grouser_height
    return simple.drivetrain.max_torque * radius / (radius - height)


def _named(direction: np.ndarray[tuple[int]]) -> str:
    axis = int(np.argmax(np.abs(direction)))
    return f"{'+' if direction[axis] > 0.0 else '-'}{'xyz'[axis]}"


_DRAWN_CHORDS = 64  # the same where it is looked at; 0.2 %


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Silhouette:
    """What is seen of a collision shape from the side.

    Parameters
    ----------
    link : str
        The link that it is a shape of.
    kind : str
        As in `Shape`.
    outline : ndarray, shape (n, 2)
        [m] Its corners in the frame of the chassis, counter-clockwise; circles as polygons.
    at : Where
        Its line.
    """

    link: str
    kind: str
    outline: Array
    at: Where


def silhouettes(tree: Tree, view: SideView, base: Base) -> tuple[Silhouette, ...]:
    """Return what is seen of every collision shape, with all joints at zero."""
    found = []
    for link in tree.links:
        for shape in link.shapes:
            corners = hull(base.of(silhouette(shape, view, _DRAWN_CHORDS)))
            outline = np.array(corners).reshape(-1, 2)
            found.append(Silhouette(link=link.name, kind=shape.kind, outline=outline, at=shape.at))
    return tuple(found)
