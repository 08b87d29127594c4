"""Flippers: what turns about the end axles, at one end or both, and where its figures are from."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NoReturn

import numpy as np

from crawler2d.errors import ScenarioError
from crawler2d.model_tree import Array, Where
from crawler2d.parameters.flippers import Flippers
from crawler2d.parameters.track import BeltTrack, HybridWheels, LineOfWheels, Track
from crawler2d.reading.engines import (
    FASTEST,
    MARGIN,
    WEIGHT,
    Note,
    resistance,
    rotor_inertia,
    tell_ignored,
    tell_lost,
)
from crawler2d.reading.log import Telling, estimate, lines, place_of
from crawler2d.reading.running_gear import Pair, SideView, centers, is_belted, paired
from crawler2d.reading.tracks import (
    BELT_TOLERANCE,
    Base,
    belt_ends,
    is_same_wheel,
    silhouette,
    wheels_of,
)
from crawler2d.reading.wheels import Arm, Runner

__all__ = ["ArmPair", "AtEnd", "arm_pairs", "arms_at", "flippers_of"]

_NEAR = 0.05
"""[-] How far a pivot may be from the end axle, as a share of the axle distance."""

_ALIKE = 0.01
"""[-] By how much the masses of two arms may differ, as a share: scales and cables."""

_DIRECTIONS = 360
"""In which shapes are held against wheels; 0.004 % of a length lies between two of them."""

_BEYOND = 0.2
"""[-] How far a shape that is left out may stand out of a flipper's wheels, as a share of the
largest radius: such as the boxes that stand for grousers or for a sagging belt."""

_SAME_ANGLE = 1e-3
"""[rad] By how much the angles of two arms may differ: files round them."""


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class ArmPair:
    """The left and the right flipper at one end.

    Parameters
    ----------
    arms : tuple of Arm
        Two, or one whose joint turns both.
    pivot : ndarray, shape (2,)
        [m] In the side view.
    pairs : tuple of Pair
        Wheels or drums, from the pivot to the tip.
    is_belt : bool
        Whether a plugin moves a belt round them.
    mass : float
        [kg] Of one flipper.
    """

    arms: tuple[Arm, ...]
    pivot: Array
    pairs: tuple[Pair, ...]
    is_belt: bool
    mass: float

    @property
    def at(self) -> Where:
        """Line of its joint."""
        return self.arms[0].joint.at

    @property
    def path(self) -> str:
        """Its line and its joint, for errors and doubts."""
        return f"{self.at}: joint[{self.arms[0].joint.name}]"

    def refuse(self, value: object, rule: str) -> NoReturn:
        """Raise the error that this pair breaks a rule."""
        raise ScenarioError(self.path, value, rule)


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class AtEnd:
    """A pair of flippers as a robot has them, at the front or at the rear.

    Parameters
    ----------
    pair : ArmPair
        What it was made from.
    length, root_radius, tip_radius, angle : float
        [m] and [rad] As in `Flippers`.
    off : float
        [m] Distance of its pivot from the end axle.
    track : Track
        Model of its track.
    has_root : bool
        Whether a wheel or drum is at the pivot; without one, its radius is that of the tip.
    """

    pair: ArmPair
    length: float
    root_radius: float
    tip_radius: float
    angle: float
    off: float
    track: Track
    has_root: bool


def arm_pairs(
    told: Telling,
    arms: list[Arm],
    view: SideView,
    *,
    middle: float,
    tolerance: float,
    at: Where,
) -> list[ArmPair]:
    """Pair the flippers, and what each carries.

    Raises
    ------
    ScenarioError
        If a flipper has no partner, has wheels and drums, differs in mass from its partner, or has
        shapes that neither turn nor are moved and reach out of the envelope of its wheels.
    """
    pairs = []
    waiting = list(arms)
    while waiting:
        arm = waiting.pop(0)
        if not arm.runners:
            path = f"{arm.joint.at}: joint[{arm.joint.name}]"
            raise ScenarioError(path, "moved boxes only", "must have drums, to carry a belt")
        together: tuple[Arm, ...] = (arm,)
        if len({runner.z > middle for runner in arm.runners}) == 1:  # it has one side only
            partner = _partner(arm, waiting, tolerance)
            waiting.remove(partner)
            together = (arm, partner)
        pairs.append(_pair(told, together, view, middle=middle, tolerance=tolerance, at=at))
    return pairs


def _partner(arm: Arm, others: list[Arm], tolerance: float) -> Arm:
    for other in others:
        if np.abs(other.pivot[:2] - arm.pivot[:2]).max() <= tolerance:
            return other
    path = f"{arm.joint.at}: joint[{arm.joint.name}]"
    value = f"a pivot at x = {arm.pivot[0]:.4g} m, y = {arm.pivot[1]:.4g} m"
    within = f"within {1e3 * tolerance:g} mm: tolerance= may say more"
    rule = f"must have a partner on the other side, {within}"
    raise ScenarioError(path, value, rule)


def _pair(
    told: Telling,
    arms: tuple[Arm, ...],
    view: SideView,
    *,
    middle: float,
    tolerance: float,
    at: Where,
) -> ArmPair:
    runners = [runner for arm in arms for runner in arm.runners]
    found = paired(runners, middle=middle, tolerance=tolerance, at=at)
    pivot = np.mean([arm.pivot[:2] for arm in arms], axis=0)
    found.sort(key=lambda pair: math.hypot(pair.x - pivot[0], pair.y - pivot[1]))
    masses = [sum(link.mass for link in arm.links) for arm in arms]
    pair = ArmPair(
        arms=arms,
        pivot=pivot,
        pairs=tuple(found),
        is_belt=is_belted(runners, f"{arms[0].joint.at}: joint[{arms[0].joint.name}]"),
        mass=sum(masses) / 2.0,
    )
    if max(masses) - min(masses) > _ALIKE * max(masses):
        value = " and ".join(f"{mass:.4g} kg" for mass in masses)
        told.doubts.append((pair.path, value, "differ in mass left and right: the mean is used"))
    for arm in arms:
        _leave_out_bare(told, arm, view, tolerance, is_belt=pair.is_belt)
    return pair


def _leave_out_bare(
    told: Telling, arm: Arm, view: SideView, tolerance: float, *, is_belt: bool
) -> None:
    """Leave out shapes of an arm that do not move: doubt those that something may touch."""
    for _, shape in arm.shapes:
        flat = silhouette(shape, view)
        if any(_beyond(flat, (runner,)) <= tolerance for runner in arm.runners):
            continue
        path = f"{shape.at}: collision[{shape.name}]"
        beyond, largest = _beyond(flat, arm.runners), max(runner.radius for runner in arm.runners)
        tolerance = max(tolerance, BELT_TOLERANCE * largest) if is_belt else tolerance
        if beyond > _BEYOND * largest + tolerance:
            rule = (
                "must lie within the envelope of its flipper's wheels: arms touch with wheels or"
                " belts only; make it smaller, or fix it to the chassis, whose shapes are the belly"
            )
            raise ScenarioError(path, f"a {shape.kind} {1e3 * beyond:.3g} mm beyond it", rule)
        if beyond > tolerance:
            reason = "left out, with what stands out of the envelope of its flipper's wheels"
            told.doubts.append((path, f"a {shape.kind} {1e3 * beyond:.3g} mm beyond it", reason))
        elif not is_belt:
            reason = "left out: within the envelope of its flipper's wheels, where edges reach it"
            told.doubts.append((path, shape.kind, f"{reason} only between two of them"))


def _beyond(flat: Array, runners: Sequence[Runner]) -> float:
    """[m] Return how far points reach out of the convex envelope of some wheels."""
    angles = np.linspace(0.0, 2.0 * math.pi, _DIRECTIONS, endpoint=False)
    away = np.stack([np.cos(angles), np.sin(angles)])
    reach = np.max([np.array([r.x, r.y]) @ away + r.radius for r in runners], axis=0)
    return float(((flat @ away).max(axis=0) - reach).max())


def at_end(
    told: Telling,
    pair: ArmPair,
    base: Base,
    view: SideView,
    *,
    is_front: bool,
    radius: float,
    tolerance: float,
) -> AtEnd:
    """Describe a pair of flippers as a robot has them.

    Parameters
    ----------
    told : Telling
        Takes what is to be told about gear wheels.
    pair : ArmPair
        The flippers.
    base : Base
        The chassis frame.
    view : SideView
        The side view.
    is_front : bool
        Whether they are at the front.
    radius : float
        [m] Of the rear end of the chassis: that of the sprocket, about which a flipper turns.
    tolerance : float
        [m] By how much the two sides may differ.

    Raises
    ------
    ScenarioError
        If it pivots far from the end axle, or its belt does not run round the pivot.
    """
    sign = 1.0 if is_front else -1.0
    off = math.hypot(*(pair.pivot - (base.front if is_front else base.rear)))
    if off > _NEAR * base.length:
        rule = f"must pivot within {_NEAR:.0%} of the axle distance from an end axle"
        pair.refuse(f"{1e3 * off:.4g} mm from it", rule)
    root, tip = pair.pairs[0], pair.pairs[-1]
    places = base.of(centers(pair.pairs))
    pivot = base.of(pair.pivot[None, :])[0]
    from_pivot = np.hypot(*(places - pivot).T)
    has_root = len(pair.pairs) > 1 and bool(from_pivot[0] <= tolerance)
    if pair.is_belt:
        # Along the arm: a steep one has its tip above its root.
        away = np.array([tip.x, tip.y]) - pair.pivot
        along = away / max(math.hypot(*away), 1e-9)
        ends = belt_ends(list(pair.pairs), along=along, at=pair.at)
        if not has_root or {root, tip} != set(ends):
            pair.refuse("a belt beside the pivot", "must have a belt from the pivot to the tip")
    out = places[-1] - (places[0] if has_root else pivot)
    angle = math.atan2(out[1], sign * out[0])
    track: Track = BeltTrack()
    if not pair.is_belt:
        run = sign * angle * radius  # which a raised flipper adds to that of its track
        track = _wheels(told, pair, view, is_front=is_front, has_root=has_root, run=run)
    return AtEnd(
        pair=pair,
        length=math.hypot(*out),
        root_radius=root.radius if has_root else tip.radius,
        tip_radius=tip.radius,
        angle=angle,
        off=off,
        track=track,
        has_root=has_root,
    )


def _wheels(
    told: Telling, pair: ArmPair, view: SideView, *, is_front: bool, has_root: bool, run: float
) -> LineOfWheels | HybridWheels:
    """Return the wheels of an arm in its frame, which is midway along it, x forward."""
    tip = np.array([pair.pairs[-1].x, pair.pairs[-1].y])
    pivot = np.array([pair.pairs[0].x, pair.pairs[0].y]) if has_root else pair.pivot
    order = list(pair.pairs if is_front else reversed(pair.pairs))
    frame = Base(pivot, tip) if is_front else Base(tip, pivot)
    path = "robot.flippers.track"
    return wheels_of(told, order, frame, view, path=path, run=run, is_whole=has_root)


def refuse_unlike(told: Telling, front: AtEnd, rear: AtEnd, tolerance: float) -> None:
    """Refuse flippers at both ends that differ in shape: a robot has one kind.

    Where they differ in mass or angle only, that is doubted.

    Raises
    ------
    ScenarioError
        If they differ.
    """
    for name, allowed in (
        ("length", tolerance),
        ("root_radius", tolerance),
        ("tip_radius", tolerance),
    ):
        pair = getattr(front, name), getattr(rear, name)
        if abs(pair[0] - pair[1]) > allowed:
            rule = f"must be alike at both ends, within {allowed:g}"
            rear.pair.refuse(f"{name} {pair[1]:.6g} and {pair[0]:.6g}", rule)
    if abs(front.pair.mass - rear.pair.mass) > _ALIKE * front.pair.mass:
        value = f"{rear.pair.mass:.4g} and {front.pair.mass:.4g} kg"
        reason = "differ in mass from the front ones: the mean is used"
        told.doubts.append((rear.pair.path, value, reason))
    if abs(front.angle - rear.angle) > _SAME_ANGLE:
        value = f"{rear.angle:.4g} and {front.angle:.4g} rad"
        reason = "stand at another angle than the front ones: that of those is used for both"
        told.doubts.append((rear.pair.path, value, reason))
    if not _is_same(front.track, rear.track):
        rule = "must be alike at both ends and have evenly spaced wheels, or a belt"
        rear.pair.refuse(f"{rear.track!r} and {front.track!r}", rule)


def _is_same(front: Track, rear: Track) -> bool:
    """Whether flippers have one track model; wheels placed by hand are not mirrored."""
    if isinstance(front, LineOfWheels) and isinstance(rear, LineOfWheels):
        return front.count == rear.count and is_same_wheel(front.wheel, rear.wheel)
    return front == rear and not isinstance(front, HybridWheels)


_RATE = 1.0  # [rad/s] that of MARV's flippers


_LIGHTEST = 1.001e-5
"""[-] Of the mass of the robot; the core refuses lighter ones, which no solver could hold."""

_TOLD = 1e-4  # [m] At an edge, tenths of a millimetre have decided whether a robot gets over it.


def arms_at(
    told: Telling,
    arms: list[ArmPair],
    base: Base,
    view: SideView,
    *,
    radius: float,
    tolerance: float,
) -> dict[str, AtEnd]:
    """Return the flippers by end, the front first; the radius is that of the rear end [m]."""
    found: dict[str, AtEnd] = {}
    for pair in arms:
        to_front, to_rear = (math.hypot(*(pair.pivot - end)) for end in (base.front, base.rear))
        end = "front" if to_front < to_rear else "rear"
        if end in found:
            pair.refuse(f"two pairs at the {end}", "must be the only flippers at its end")
        found[end] = at_end(
            told, pair, base, view, is_front=end == "front", radius=radius, tolerance=tolerance
        )
        if found[end].off > tolerance:
            reason = f"pivots {1e3 * found[end].off:.3g} mm off the end axle, here on it"
            told.doubts.append((f"joint[{pair.arms[0].joint.name}]", end, reason))
        elif found[end].off > _TOLD:
            off = f"{1e3 * found[end].off:.2g} mm off the end axle, here on it"
            told.notes.append(f"the {end} flippers pivot {off}")
        locked = [arm.joint.name for arm in pair.arms if arm.joint.is_locked]
        if locked:
            told.notes.append(f"{', '.join(locked)}: locked in the file, here flippers that turn")
    if len(found) == 2:
        refuse_unlike(told, found["front"], found["rear"], tolerance)
    return {end: found[end] for end in ("front", "rear") if end in found}


def flippers_of(
    told: Telling, by_end: dict[str, AtEnd], mass: float, *, engine: str, is_mjcf: bool
) -> Flippers | None:
    """Return the flippers with the sources of their figures, driven by an engine."""
    if not by_end:
        told.note("robot.flippers", f"{told.at}: none")
        return None
    ends = list(by_end.values())
    first, pairs = ends[0], [end.pair for end in ends]
    shown = [r for pair in pairs for each in (pair.pairs[0], pair.pairs[-1]) for r in each.both]
    joints = [arm.joint.at for pair in pairs for arm in pair.arms]
    told.note("robot.flippers.length", lines([place_of(r) for r in shown]))
    for name, index in (("root_radius", 0), ("tip_radius", -1)):
        sizes = [r.shape.size_at for pair in pairs for r in pair.pairs[index].both]
        told.note(f"robot.flippers.{name}", lines(sizes))
    if not first.has_root:
        rule = "that of the tip: no wheel is at the pivot"
        told.note("robot.flippers.root_radius", estimate(rule))
        reason = "is that of the tip: no wheel of theirs is at the pivot"
        told.doubts.append(("robot.flippers.root_radius", first.root_radius, reason))
    of_arms = [link for pair in pairs for arm in pair.arms for link in arm.links]
    told.note("robot.flippers.mass", lines([link.mass_at for link in of_arms], "sum"))
    told.note("robot.flippers.ends", lines(joints))
    told.note(
        "robot.flippers.angle", lines([arm.links[0].pose_at for p in pairs for arm in p.arms])
    )
    runners = [runner for pair in pairs for each in pair.pairs for runner in each.both]
    of_all = [shape.size_at for runner in runners for shape in runner.surfaces]
    told.note("robot.flippers.track", lines(of_all, "sizes"))
    told.note("robot.flippers.self_locking", f"{told.at}: none")
    rate, torque = _limits(ends, mass=mass, note=told.note)
    motors = [(arm.joint, share) for end in ends for arm, share in _arms(end)]
    turning = [joint for joint, _ in motors]
    tell_ignored(told, turning, engine=engine, is_mjcf=is_mjcf)
    lost = max(resistance(joint, rate, engine) / share for joint, share in motors)
    tell_lost(told, turning, lost, torque, engine=engine)
    rotors = [joint.armature / share for joint, share in motors]
    path = "robot.flippers.rotor_inertia"
    return Flippers(
        length=first.length,
        root_radius=first.root_radius,
        tip_radius=first.tip_radius,
        mass=_mass(told, ends, mass),
        ends="both" if len(ends) == 2 else ("front" if "front" in by_end else "rear"),
        angle=first.angle,
        rate_limit=rate,
        torque_limit=torque,
        rotor_inertia=rotor_inertia(told, path, rotors, turning, engine=engine, at=told.at),
        track=first.track,
    )


def _mass(told: Telling, ends: list[AtEnd], whole: float) -> float:
    """[kg] Return the mass of one flipper: the mean, and no less than a robot can have."""
    mass = sum(end.pair.mass for end in ends) / len(ends)
    least = _LIGHTEST * whole
    if mass >= least:
        return mass
    reason = f"is too light to be moved: {least:.4g} kg is used, the least that a flipper can have"
    told.doubts.append(("robot.flippers.mass", float(f"{mass:.4g}"), reason))
    return least


def _arms(end: AtEnd) -> list[tuple[Arm, float]]:
    """Return the arms at one end, and how many flippers the joint of each turns."""
    arms = end.pair.arms
    return [(arm, 2.0 / len(arms)) for arm in arms]


def _limits(ends: list[AtEnd], *, mass: float, note: Note) -> tuple[float, float]:
    """Return rate [rad/s] and torque [N m] of one flipper."""
    joints = [arm.joint for end in ends for arm, _ in _arms(end)]
    shares = [share for end in ends for _, share in _arms(end)]
    length = max(end.length for end in ends)
    rate, torque = _RATE, MARGIN * 0.5 * mass * WEIGHT * length / 2.0
    rates = [
        joint.velocity
        for joint in joints
        if joint.velocity and joint.velocity <= FASTEST and not joint.is_locked
    ]
    if len(rates) == len(joints):
        rate = min(rates)
        note("robot.flippers.rate_limit", lines([joint.velocity_at for joint in joints]))
    else:
        note("robot.flippers.rate_limit", estimate("that of MARV: the file has no limit"))
    efforts = [joint.effort for joint in joints if joint.effort and not joint.is_locked]
    if len(efforts) == len(joints):
        torque = min(effort / share for effort, share in zip(efforts, shares, strict=True))
        note("robot.flippers.torque_limit", lines([joint.effort_at for joint in joints]))
    else:
        rule = "1.6 times what lifts half of the robot with both tips: the file has no limit"
        note("robot.flippers.torque_limit", estimate(rule))
    return rate, torque
