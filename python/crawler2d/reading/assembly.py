"""Assemble a robot from a tree: pair the sides, sum masses, record every source."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, field, replace

import numpy as np

from crawler2d.common.bodies import Belly
from crawler2d.errors import ScenarioError
from crawler2d.model_tree import Array, Pose, Tree, Where
from crawler2d.parameters.outline import TrackOutline
from crawler2d.parameters.robot import Robot
from crawler2d.parameters.track import BeltTrack, LineOfWheels, Track
from crawler2d.reading.engines import combine_friction, drivetrain_of
from crawler2d.reading.flippers import ArmPair, AtEnd, arm_pairs, arms_at, flippers_of
from crawler2d.reading.log import ReadLog, estimate, lines, list_names
from crawler2d.reading.running_gear import (
    Pair,
    SideView,
    centers,
    is_belted,
    middle_of,
    pair_runners,
    running_gear_of,
    side_view,
)
from crawler2d.reading.surfaces import surfaces_of
from crawler2d.reading.tracks import (
    Base,
    bending_drums,
    beyond_belt,
    ends_among,
    hull,
    silhouette,
    wheels_of,
)
from crawler2d.reading.unused import warn_of_slip
from crawler2d.reading.wheels import Runner, RunningGear

__all__ = ["Assembly", "Silhouette", "assemble", "silhouettes"]

_LARGEST = 3.0  # [m] Tracked robots that climb obstacles are shorter.
_LONGEST = 100.0  # [m] Largest axle distance of a robot.
_SHOWN = 4  # names of links in a warning
_LEAST_MOVING = 0.001  # [kg] Smallest mass of a robot.
_MOVING_FRACTION = 0.01  # of the mass, for a moving surface without mass in the file
_CHORDS = 64  # per circle; at most 0.2 % of its radius inside it
_SIGN = {"front": 1.0, "rear": -1.0}


@dataclass(slots=True, kw_only=True)
class Assembly:
    """A robot under construction.

    Parameters
    ----------
    log : ReadLog
        The model, and the record of notes, warnings and sources.
    view : SideView
        The side view.
    base : Base
        The chassis frame in the side view.
    """

    log: ReadLog
    view: SideView = field(init=False)
    base: Base = field(init=False)

    def robot(self, forward: str | None, tolerance: float) -> Robot:
        """Build the robot.

        Raises
        ------
        ScenarioError
            If a side view cannot represent the model, or it breaks a rule of a robot.
        """
        log, tree = self.log, self.log.tree
        surfaces = surfaces_of(tree)
        log.warnings += surfaces.warnings
        view = side_view(tree, surfaces, forward, tolerance)
        log.notes.append(f"{view.reason}: {_axis_name(view.forward)} is forward")
        gear = running_gear_of(tree, view, surfaces)
        runners = gear.runners or [runner for arm in gear.arms for runner in arm.runners]
        self.view = view = replace(view, middle=middle_of(runners))
        castors = gear.remove_castors(view.middle, tolerance)
        self.warn_of_undriven(gear, castors)
        self.warn_of_coupled(gear)
        self.warn_of_held(gear)
        pairs = pair_runners(gear.runners, view)
        arms = arm_pairs(log, gear.arms, view)
        is_belt = is_belted(gear.runners, str(tree.at))
        if gear.bars and not is_belt:
            rule = "must have a drum at either end of a track"
            raise ScenarioError(str(tree.at), "moved boxes only", rule)
        bent = _outline_pairs(log, pairs, arms, castors, is_belt=is_belt)
        if is_belt:
            self.sort_boxes(gear, bent, is_moved=not surfaces.taken)
        rear, front = bent if len(bent) == 2 else ends_among(bent)
        self.base = base = Base(
            rear=np.array([rear.x, rear.y]),
            front=np.array([front.x, front.y]),
            is_level=len(bent) > 2,
        )
        if base.length <= tolerance:
            rule = "must have two wheels or drums on each side"
            raise ScenarioError(str(tree.at), base.length, rule)
        by_end = arms_at(log, arms, base, view, radius=rear.radius)
        track: Track = BeltTrack() if is_belt else LineOfWheels(2, as_track=False)
        if pairs and not is_belt:
            track = wheels_of(log, pairs, base, view)
        flipped = [(by_end[end], _SIGN[end]) for end in by_end]
        mass, center, inertia = _sum_links(tree, view, base, flipped)
        if not mass > 0.0:
            raise ScenarioError(str(tree.at), mass, "must have links with a mass > 0 kg")
        sum_at = lines([link.at for link in tree.links], "sum at angle 0" if by_end else "sum")
        mass_at = lines([link.mass_at for link in tree.links], "sum")
        log.cite("robot", name=str(tree.at), mass=mass_at)
        log.cite("robot", center_of_mass=sum_at, moment_of_inertia=sum_at)
        on_flippers = [pair for end in by_end.values() for pair in end.pair.pairs]
        driven = pairs or on_flippers
        outline = _outline_of(log, base, bent)
        # The estimate of Robot.simple: 1.6 times the torque that holds it on 45 degrees.
        simple = Robot.simple(mass, axle_distance=1.0, radius=rear.radius)
        lever = rear.radius - simple.outline.grouser_height
        torque = simple.drivetrain.max_torque * rear.radius / lever
        drivetrain = drivetrain_of(
            log,
            driven,
            on_flippers if pairs else [],
            [track, *(end.track for end in by_end.values())],
            radius=rear.radius,
            torque=torque,
        )
        flippers = flippers_of(log, by_end, mass)
        self.list_runners(pairs, by_end)
        return Robot(
            tree.name or "robot",
            mass=mass,
            center_of_mass=center,
            moment_of_inertia=inertia,
            track_mass=self.track_mass([] if is_belt else pairs, mass),
            outline=outline,
            belly=self.belly(gear, driven),
            flippers=flippers,
            gauge=self.gauge(driven),
            drivetrain=drivetrain,
            track=track,
        )

    @property
    def frame(self) -> Pose:
        """The chassis frame in that of the model: x forward, y to the left, z up."""
        view, base = self.view, self.base
        side = np.stack([view.forward, view.up], axis=1)  # from the side view to the model
        ahead = base.ahead
        turn = np.stack([side @ ahead, view.left, side @ (-ahead[1], ahead[0])], axis=1)
        place = side @ (0.5 * (base.front + base.rear)) + view.middle * view.left
        return Pose(place=place, turn=turn)

    def sort_boxes(self, gear: RunningGear, bent: list[Pair], *, is_moved: bool) -> None:
        """Treat shapes inside the belt as part of it, and shapes that stick out as belly.

        Raises
        ------
        ScenarioError
            If a moved shape sticks out where it may touch the ground.
        """
        if not is_moved:  # by the file: then shapes between the drums are not belly
            gear.bars += gear.shapes
            gear.shapes = []
        outlines = [silhouette(shape, self.view) for _, shape in gear.bars]
        for (link, shape), (out, low) in zip(gear.bars, beyond_belt(outlines, bent), strict=True):
            if is_moved and low > 0.0:
                rule = "must lie within the belt round the drums, except above its upper run"
                value = f"a moved shape {1e3 * low:.3g} mm beyond it"
                raise ScenarioError(shape.path, value, rule)
            if out > 0.0:
                gear.shapes.append((link, shape))
            if out > 0.0 and is_moved:
                reason = "sticks out of the belt round the drums: read as belly, which is fixed"
                self.log.add_warning(shape.path, f"{1e3 * out:.3g} mm", reason)

    def warn_of_undriven(self, gear: RunningGear, castors: list[Runner]) -> None:
        """Warn of wheels without a motor if others have one."""
        undriven = [runner for runner in gear.every_runner if runner.name in gear.passive]
        for wheels, reason in (
            (castors, "roll freely in the middle: read as skids of the belly, which slide"),
            (
                undriven,
                "roll freely while others are driven: read as driven, as by a track round all",
            ),
        ):
            if wheels:
                names = list_names([wheel.name for wheel in wheels], _SHOWN)
                self.log.add_warning(wheels[0].link.at, names, reason)

    def warn_of_coupled(self, gear: RunningGear) -> None:
        """Warn of couplings of wheels or flippers with other joints."""
        joints = {runner.joint.name for runner in gear.every_runner if runner.joint is not None}
        joints |= {arm.joint.name for arm in gear.arms}
        for each in self.log.tree.couplings:
            if joints.intersection(each.joints):
                self.log.add_warning(f"{each.at}: {each.name}", each.value, each.reason)

    def warn_of_held(self, gear: RunningGear) -> None:
        """Warn of wheels that springs or servos of their position keep from turning on."""
        joints = [runner.joint for runner in gear.every_runner if runner.joint is not None]
        sprung = [joint for joint in joints if joint.stiffness > 0.0]
        if sprung:
            names = list_names([joint.name for joint in sprung], _SHOWN)
            path = f"{sprung[0].dynamics_at}: stiffness[{names}]"
            value = f"{sprung[0].stiffness:.4g} N m/rad"
            reason = "is left out: in the file springs hold these wheels back"
            self.log.add_warning(path, value, reason)
        held = self.log.tree.held
        names_held = [joint.name for joint in joints if joint.name in held]
        if names_held:
            reason = "control the position of their wheels, which here are driven at a speed"
            self.log.add_warning(held[names_held[0]], list_names(names_held, _SHOWN), reason)

    def track_mass(self, pairs: list[Pair], mass: float) -> float:
        """[kg] Return the mass that moves at track speed: moment of inertia / radius squared.

        A body within a wheel's radius cannot have more than its mass there, which limits each
        wheel.
        """
        path, moving, is_excessive = "robot.track_mass", 0.0, False
        for wheel in (runner for pair in pairs for runner in pair.both):
            own = wheel.inertia / wheel.radius**2
            is_excessive |= own > wheel.mass * (1.0 + 1e-6)
            moving += min(own, wheel.mass)
        if not _LEAST_MOVING <= moving < mass:
            self.log.sources[path] = estimate("a hundredth of the mass: the file has none")
            return _MOVING_FRACTION * mass
        wheels = [runner.link.at for pair in pairs for runner in pair.both]
        self.log.sources[path] = lines(wheels, "moment of inertia by radius squared")
        if is_excessive:
            rule = "the mass of the wheels, as of hoops: their moments of inertia exceed it"
            self.log.sources[path] = estimate(rule)
            reason = "is limited to hoops: wheels state more inertia"
            self.log.add_warning(path, float(f"{moving:.4g}"), reason)
        return moving

    def belly(self, gear: RunningGear, driven: list[Pair]) -> Belly | None:
        """Return the belly, counter-clockwise; warn of one that touches level ground."""
        moving = list(dict.fromkeys(link.name for _, link, _ in gear.moving))
        if moving:
            text = f"{', '.join(moving)}: move by themselves, and touch nothing here"
            self.log.notes.append(text)
        flat = [self.base.of(silhouette(shape, self.view)) for _, shape in gear.shapes]
        corners = hull(np.concatenate(flat)) if flat else []
        if len(corners) < 3:
            self.log.sources["robot.belly"] = f"{self.log.at}: no collision shape on the chassis"
            return None
        self.log.sources["robot.belly"] = lines([shape.at for _, shape in gear.shapes], "hull")
        places = self.base.of(centers(driven))
        ground = min(float(y) - pair.radius for (_, y), pair in zip(places, driven, strict=True))
        lowest = min(float(y) for _, y in corners)
        if lowest <= ground + self.view.tolerance:
            reason = "rubs on level ground: a skid next to the wheels counts as belly"
            self.log.add_warning("robot.belly", lowest, reason)
        return tuple((float(x), float(y)) for x, y in corners)

    def gauge(self, pairs: list[Pair]) -> float:
        """[m] Return the lateral distance of the tracks; note wheels at other distances."""
        runners = [runner for pair in pairs for runner in pair.both]
        across = [abs(runner.z - self.view.middle) for runner in runners]
        usual = float(np.median(across))
        self.log.sources["robot.gauge"] = lines([each.pose_at for each in runners], "median")
        for runner, own in zip(runners, across, strict=True):
            if abs(own - usual) > self.view.tolerance:
                where = "inboard" if own < usual else "outboard"
                off = 1e3 * abs(own - usual)
                self.log.notes.append(f"{runner.name}: {off:.3g} mm {where} of the others")
        return 2.0 * usual

    def list_runners(self, pairs: list[Pair], by_end: dict[str, AtEnd]) -> None:
        """List all runners in the log: left before right, chassis before flippers."""
        log, middle = self.log, self.view.middle
        carriers = [("chassis", pairs)]
        carriers += [(f"{end} flipper", list(each.pair.pairs)) for end, each in by_end.items()]
        for pair in [pair for _, carried in carriers for pair in carried]:
            left, right = pair.left[0], pair.right[0]
            off = abs(left.z + right.z - 2.0 * middle)
            if off > self.view.tolerance:  # not visible in side view
                text = f"{left.name} and {right.name}: not mirrored across, by {1e3 * off:.3g} mm"
                log.notes.append(text)
        for side in ("left", "right"):
            for carrier, carried in carriers:
                runners = [runner for pair in carried for runner in getattr(pair, side)]
                log.rows += [(carrier, runner) for runner in sorted(runners, key=lambda r: r.x)]
        for _, runner in log.rows:
            name = runner.name.lower()
            is_left, is_right = "left" in name, "right" in name
            if is_left is not is_right and is_left is not (runner.z > middle):
                reason = "is on the other side than its name says: is forward right?"
                log.add_warning("forward", runner.name, reason)
                break


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Silhouette:
    """The outline of a collision shape in side view.

    Parameters
    ----------
    link : str
        Link of the shape.
    kind : str
        See `Shape`.
    outline : ndarray, shape (n, 2)
        [m] Its corners in the frame of the chassis, counter-clockwise; circles as polygons.
    at : Where
        Its line.
    """

    link: str
    kind: str
    outline: Array
    at: Where


def assemble(
    tree: Tree, *, forward: str | None, tolerance: float, engine: str, ground: float
) -> tuple[Robot, float, Assembly]:
    """Build the robot of a tree; return it with its friction on the ground and its assembly."""
    work = Assembly(log=ReadLog(tree=tree, engine=engine))
    robot = work.robot(forward, tolerance)
    runners = [runner for _, runner in work.log.rows]
    friction, source, places = combine_friction(runners, work.view, engine, ground)
    work.log.sources["friction"] = f"{source}: {lines(places)}" if places else source
    warn_of_slip(work.log, runners, work.view)
    return robot, friction, work


def silhouettes(tree: Tree, view: SideView, base: Base) -> tuple[Silhouette, ...]:
    """Return the outlines of all collision shapes, with all joints at zero."""
    return tuple(
        Silhouette(
            link=link.name,
            kind=shape.kind,
            outline=np.array(hull(base.of(silhouette(shape, view, _CHORDS)))).reshape(-1, 2),
            at=shape.at,
        )
        for link in tree.links
        for shape in link.shapes
    )


def _axis_name(direction: np.ndarray[tuple[int]]) -> str:
    axis = int(np.argmax(np.abs(direction)))
    return f"{'+' if direction[axis] > 0.0 else '-'}{'xyz'[axis]}"


def _outline_pairs(
    log: ReadLog,
    pairs: list[Pair],
    arms: list[ArmPair],
    castors: list[Runner],
    *,
    is_belt: bool,
) -> list[Pair]:
    """Return the pairs that define the outline, from rear to front; log their lines.

    These are the two outermost wheels, or the drums that a belt bends round; without either, the
    roots of flippers; for a robot with one wheel per side, that wheel and its castors.

    Raises
    ------
    ScenarioError
        If one end has no support, or something sticks out of a belt.
    """
    if is_belt:
        bent = bending_drums(pairs, at=log.at)
    elif len(pairs) == 1 and castors:
        # One wheel per side is not a track: the robot stands on it and on its castors.
        singles = [
            Pair(left=(each,), right=(each,), x=each.x, y=each.y, radius=each.radius)
            for each in castors
        ]
        bent = sorted([*pairs, *singles], key=lambda pair: pair.x)
        reason = "is no track: its outline is drawn round it and the free wheels in the middle"
        log.add_warning("robot.outline", "one wheel a side", reason)
    elif pairs:
        bent = [pairs[0], pairs[-1]]
    else:
        order = sorted(arms, key=lambda arm: float(arm.pivot[0]))
        if len(order) < 2:
            rule = "must have wheels on the chassis, or flippers at both ends"
            raise ScenarioError(str(log.at), "flippers at one end", rule)
        bent = [order[0].pairs[0], order[-1].pairs[0]]
        text = "the chassis has no wheels: it stands on the roots of its flippers"
        log.notes.append(text)
        log.sources["robot.track"] = estimate(f"{text}, which are no track")
    runners = [runner for pair in bent for runner in pair.both]
    places = [runner.pose_at for runner in runners]
    if len(bent) > 2:
        sizes = [runner.shape.size_at for runner in runners]
        log.sources["robot.outline.discs"] = lines([*places, *sizes])
    else:
        log.sources["robot.outline.axle_distance"] = lines(places)
        for name, pair in zip(("rear_radius", "front_radius"), bent, strict=True):
            log.sources[f"robot.outline.{name}"] = lines([r.shape.size_at for r in pair.both])
    if pairs:
        of_all = [s.size_at for pair in pairs for runner in pair.both for s in runner.surfaces]
        log.sources["robot.track"] = lines(of_all, "sizes")
    return bent


def _sum_links(
    tree: Tree, view: SideView, base: Base, arms: Iterable[tuple[AtEnd, float]]
) -> tuple[float, tuple[float, float], float]:
    """Sum all links, with the flippers at angle 0, as a robot requires.

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
    mass : float
        [kg] Mass of the robot.
    center : tuple of float, shape (2,)
        [m] Its centre of mass in the chassis frame.
    inertia : float
        [kg m^2] Moment of inertia about the centre of mass.
    """
    mass = np.array([link.mass for link in tree.links])
    places = base.of(view.of(np.array([link.center for link in tree.links]))[:, :2])
    number = {link.name: index for index, link in enumerate(tree.links)}
    for end, sign in arms:
        cos, sin = math.cos(-sign * end.angle), math.sin(-sign * end.angle)
        turn = np.array([[cos, -sin], [sin, cos]])
        for arm in end.pair.arms:
            pivot = base.of(arm.pivot[None, :2])[0]
            for index in (number[link.name] for link in arm.links):
                places[index] = pivot + turn @ (places[index] - pivot)
    whole = float(mass.sum())
    center = mass @ places / whole if whole > 0.0 else np.zeros(2)
    own = sum(view.about_left(link.inertia) for link in tree.links)
    swung = float(mass @ ((places - center) ** 2).sum(axis=1))
    return whole, (float(center[0]), float(center[1])), own + swung


def _outline_of(log: ReadLog, base: Base, bent: list[Pair]) -> TrackOutline:
    """Return the outline; no format has grousers."""
    radii = [pair.radius for pair in bent]
    grousers = {
        "grouser_height": 0.0,
        "grouser_pitch": 0.75 * min(radii),
        "grouser_thickness": 0.0,
    }
    for name in grousers:
        log.sources[f"robot.outline.{name}"] = estimate("the file has no grousers")
    if len(bent) == 2:
        rear, front = radii
        outline = TrackOutline(
            axle_distance=base.length, front_radius=front, rear_radius=rear, **grousers
        )
    else:
        outline = TrackOutline(discs=np.column_stack([base.of(centers(bent)), radii]), **grousers)
    length = outline.axle_distance
    whole = length + outline.rear_radius + outline.front_radius
    if whole > _LARGEST:
        power = math.ceil(math.log10(whole / _LARGEST))
        hint = f"is the file in metres? scale={10.0**-power:g} would correct that"
        path = "robot.outline.axle_distance"
        if length > _LONGEST:
            raise ScenarioError(path, length, f"must be <= {_LONGEST:g} m: {hint}")
        reason = f"is usually at most {_LARGEST:g} m with the wheels: {hint}"
        log.add_warning(path, length, reason)
    return outline
