"""Flippers: arms that pivot on the end axles, paired left and right, with their sources."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NoReturn

import numpy as np

from crawler2d.errors import ScenarioError
from crawler2d.model_tree import Array, Joint, Where
from crawler2d.parameters.flippers import Flippers
from crawler2d.parameters.track import BeltTrack, HybridWheels, LineOfWheels, Track
from crawler2d.reading.engines import (
    MARGIN,
    WEIGHT,
    report_losses,
    resistance,
    rotor_inertia,
    warn_ignored,
)
from crawler2d.reading.log import ReadLog, estimate, lines, list_names
from crawler2d.reading.running_gear import Pair, SideView, centers, is_belted, pair_runners
from crawler2d.reading.speeds import FASTEST
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
"""[-] Largest distance of a pivot from the end axle, relative to the axle distance."""

_ALIKE = 0.01
"""[-] Tolerated difference between the masses or limits of two arms, for scales and cables."""

_DIRECTIONS = 360
"""Directions in which shapes are compared with wheels; the error is 0.004 % of a length."""

_BEYOND = 0.2
"""[-] How far a shape that is left out may stick out of a flipper's wheels, relative to the largest
radius: such as the boxes that represent grousers or a sagging belt."""

_SAME_ANGLE = 1e-3
"""[rad] Tolerated difference between the angles of two arms, as files round them."""

_RATE = 1.0  # [rad/s] rate of MARV's flippers

_FULL_TURN = 2.0 * math.pi * (1.0 - 1e-3)
"""[rad] A range this large bounds no angle of a flipper; files round it."""

_LIGHTEST = 1.001e-5
"""[-] Smallest fraction of the robot's mass; the core refuses lighter ones as unsolvable."""

_NOTED = 1e-4  # [m] Tenths of a millimetre have decided whether a robot gets over an edge.


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class ArmPair:
    """The left and the right flipper at one end.

    Parameters
    ----------
    arms : tuple of Arm
        Two arms, or one with a joint that turns both.
    pivot : ndarray, shape (2,)
        [m] Pivot in the side view.
    pairs : tuple of Pair
        Wheels or drums, from the pivot to the tip.
    is_belt : bool
        Whether a plugin moves a belt round them.
    mass : float
        [kg] Mass of one flipper.
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
        """Its line and its joint, for errors and warnings."""
        return self.arms[0].joint.path

    def refuse(self, value: object, rule: str) -> NoReturn:
        """Raise an error: this pair breaks a rule."""
        raise ScenarioError(self.path, value, rule)


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class AtEnd:
    """A pair of flippers of a robot, at the front or rear.

    Parameters
    ----------
    pair : ArmPair
        The pair in the model.
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

    @property
    def motors(self) -> list[tuple[Joint, float]]:
        """Joints, each with the number of flippers that it turns."""
        arms = self.pair.arms
        return [(arm.joint, 2.0 / len(arms)) for arm in arms]


def arm_pairs(log: ReadLog, arms: list[Arm], view: SideView) -> list[ArmPair]:
    """Pair the flippers, and the runners of each.

    Raises
    ------
    ScenarioError
        If a flipper has no partner, has both wheels and drums, differs in mass from its partner, or
        has fixed shapes that stick out of the envelope of its wheels.
    """
    pairs = []
    waiting = list(arms)
    while waiting:
        arm = waiting.pop(0)
        if not arm.runners:
            rule = "must have drums, to carry a belt"
            raise ScenarioError(arm.joint.path, "moved boxes only", rule)
        together: tuple[Arm, ...] = (arm,)
        if len({runner.z > view.middle for runner in arm.runners}) == 1:  # it has one side only
            partner = _partner(arm, waiting, view.tolerance)
            waiting.remove(partner)
            together = (arm, partner)
        pairs.append(_pair(log, together, view))
    return pairs


def arms_at(
    log: ReadLog, arms: list[ArmPair], base: Base, view: SideView, *, radius: float
) -> dict[str, AtEnd]:
    """Return the flippers by end, the front first; the radius is that of the rear end [m]."""
    ends: dict[str, AtEnd] = {}
    for pair in arms:
        to_front, to_rear = (math.hypot(*(pair.pivot - end)) for end in (base.front, base.rear))
        end = "front" if to_front < to_rear else "rear"
        if end in ends:
            pair.refuse(f"two pairs at the {end}", "must be the only flippers at its end")
        ends[end] = _at_end(log, pair, base, view, is_front=end == "front", radius=radius)
        off = ends[end].off
        if off > view.tolerance:
            reason = f"pivots {1e3 * off:.3g} mm off the end axle, here on it"
            log.add_warning(f"joint[{pair.arms[0].joint.name}]", end, reason)
        elif off > _NOTED:
            text = f"the {end} flippers pivot {1e3 * off:.2g} mm off the end axle, here on it"
            log.notes.append(text)
        locked = [arm.joint.name for arm in pair.arms if arm.joint.is_locked]
        if locked:
            log.notes.append(f"{', '.join(locked)}: locked in the file, here flippers that turn")
    if len(ends) == 2:
        _refuse_unlike(log, ends["front"], ends["rear"], view.tolerance)
    return {end: ends[end] for end in ("front", "rear") if end in ends}


def flippers_of(log: ReadLog, by_end: dict[str, AtEnd], mass: float) -> Flippers | None:
    """Return the flippers with the sources of their figures, driven by an engine."""
    if not by_end:
        log.sources["robot.flippers"] = f"{log.at}: none"
        return None
    ends = list(by_end.values())
    first, pairs = ends[0], [end.pair for end in ends]
    arms = [arm for pair in pairs for arm in pair.arms]
    outer = [r for pair in pairs for each in (pair.pairs[0], pair.pairs[-1]) for r in each.both]
    runners = [runner for pair in pairs for each in pair.pairs for runner in each.both]
    of_radius = {
        name: lines([r.shape.size_at for pair in pairs for r in pair.pairs[index].both])
        for name, index in (("root_radius", 0), ("tip_radius", -1))
    }
    if not first.has_root:
        of_radius["root_radius"] = estimate("that of the tip: no wheel is at the pivot")
        reason = "is that of the tip: no wheel of theirs is at the pivot"
        log.add_warning("robot.flippers.root_radius", first.root_radius, reason)
    surfaces = [shape.size_at for runner in runners for shape in runner.surfaces]
    log.cite(
        "robot.flippers",
        length=lines([runner.pose_at for runner in outer]),
        **of_radius,
        mass=lines([link.mass_at for arm in arms for link in arm.links], "sum"),
        ends=lines([arm.joint.at for arm in arms]),
        angle=lines([arm.links[0].pose_at for arm in arms]),
        track=lines(surfaces, "sizes"),
        self_locking=f"{log.at}: none",
    )
    rate, torque = _limits(log, ends, mass)
    motors = [motor for end in ends for motor in end.motors]
    joints = [joint for joint, _ in motors]
    warn_ignored(log, joints)
    _warn_of_ranges(log, joints)
    lost = max(resistance(joint, rate, log.engine) / count for joint, count in motors)
    report_losses(log, joints, lost, torque)
    rotors = [joint.armature / count for joint, count in motors]
    own, least = sum(pair.mass for pair in pairs) / len(pairs), _LIGHTEST * mass
    if own < least:
        reason = (
            f"is too light to simulate: {least:.4g} kg is used, the least that a flipper can have"
        )
        log.add_warning("robot.flippers.mass", float(f"{own:.4g}"), reason)
    return Flippers(
        length=first.length,
        root_radius=first.root_radius,
        tip_radius=first.tip_radius,
        mass=max(own, least),
        ends="both" if len(ends) == 2 else ("front" if "front" in by_end else "rear"),
        angle=first.angle,
        rate_limit=rate,
        torque_limit=torque,
        rotor_inertia=rotor_inertia(log, "robot.flippers.rotor_inertia", rotors, joints),
        track=first.track,
    )


def _warn_of_ranges(log: ReadLog, joints: Sequence[Joint]) -> None:
    """Warn of the ranges of joints, as flippers turn to any angle."""
    narrow = [each for each in joints if 0.0 < each.upper - each.lower < _FULL_TURN]
    if narrow:
        names = list_names([joint.name for joint in narrow])
        path = f"{lines([joint.range_at for joint in narrow])}: range[{names}]"
        ranges = dict.fromkeys(f"{each.lower:.4g} to {each.upper:.4g} rad" for each in narrow)
        reason = "is not simulated: here flippers turn to any angle that is commanded"
        log.add_warning(path, list_names(list(ranges)), reason)


def _partner(arm: Arm, others: list[Arm], tolerance: float) -> Arm:
    for other in others:
        if np.abs(other.pivot[:2] - arm.pivot[:2]).max() <= tolerance:
            return other
    value = f"a pivot at x = {arm.pivot[0]:.4g} m, y = {arm.pivot[1]:.4g} m"
    within = f"within {1e3 * tolerance:g} mm; tolerance= allows more"
    raise ScenarioError(arm.joint.path, value, f"must have a partner on the other side, {within}")


def _pair(log: ReadLog, arms: tuple[Arm, ...], view: SideView) -> ArmPair:
    runners = [runner for arm in arms for runner in arm.runners]
    pivot = np.mean([arm.pivot[:2] for arm in arms], axis=0)
    pairs = pair_runners(runners, view)
    pairs.sort(key=lambda pair: math.hypot(pair.x - pivot[0], pair.y - pivot[1]))
    masses = [sum(link.mass for link in arm.links) for arm in arms]
    pair = ArmPair(
        arms=arms,
        pivot=pivot,
        pairs=tuple(pairs),
        is_belt=is_belted(runners, arms[0].joint.path),
        mass=sum(masses) / 2.0,
    )
    if not math.isclose(min(masses), max(masses), rel_tol=_ALIKE):
        value = " and ".join(f"{mass:.4g} kg" for mass in masses)
        log.add_warning(pair.path, value, "differ in mass left and right: the mean is used")
    for arm in arms:
        _leave_out_fixed(log, arm, view, is_belt=pair.is_belt)
    return pair


def _leave_out_fixed(log: ReadLog, arm: Arm, view: SideView, *, is_belt: bool) -> None:
    """Leave out fixed shapes of an arm; warn of those within reach."""
    largest, tolerance = max(runner.radius for runner in arm.runners), view.tolerance
    for _, shape in arm.shapes:
        flat = silhouette(shape, view)
        if any(_beyond(flat, (runner,)) <= tolerance for runner in arm.runners):
            continue
        beyond = _beyond(flat, arm.runners)
        tolerance = max(tolerance, BELT_TOLERANCE * largest) if is_belt else tolerance
        value = f"a {shape.kind} {1e3 * beyond:.3g} mm beyond it"
        if beyond > _BEYOND * largest + tolerance:
            rule = (
                "must lie within the envelope of its flipper's wheels: arms touch with wheels or"
                " belts only; make it smaller, or fix it to the chassis, whose shapes are the belly"
            )
            raise ScenarioError(shape.path, value, rule)
        if beyond > tolerance:
            reason = "left out, with what sticks out of the envelope of its flipper's wheels"
            log.add_warning(shape.path, value, reason)
        elif not is_belt:
            reason = "left out: within the envelope of its flipper's wheels, where edges reach it"
            log.add_warning(shape.path, shape.kind, f"{reason} only between two of them")


def _beyond(flat: Array, runners: Sequence[Runner]) -> float:
    """[m] Return how far points stick out of the convex envelope of some wheels."""
    angles = np.linspace(0.0, 2.0 * math.pi, _DIRECTIONS, endpoint=False)
    away = np.stack([np.cos(angles), np.sin(angles)])
    reach = np.max([np.array([r.x, r.y]) @ away + r.radius for r in runners], axis=0)
    return float(((flat @ away).max(axis=0) - reach).max())


def _at_end(
    log: ReadLog, pair: ArmPair, base: Base, view: SideView, *, is_front: bool, radius: float
) -> AtEnd:
    """Describe a pair of flippers as part of a robot.

    Parameters
    ----------
    log : ReadLog
        Takes notes and warnings.
    pair : ArmPair
        The flippers.
    base : Base
        The chassis frame.
    view : SideView
        The side view.
    is_front : bool
        Whether they are at the front.
    radius : float
        [m] Radius of the rear end of the chassis, the sprocket's, about which a flipper turns.

    Raises
    ------
    ScenarioError
        If its pivot is far from the end axle, or its belt does not run round the pivot.
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
    has_root = len(pair.pairs) > 1 and bool(from_pivot[0] <= view.tolerance)
    tip_place = np.array([tip.x, tip.y])
    if pair.is_belt:
        # Measured along the arm, as the tip of a steep arm is above its root.
        away = tip_place - pair.pivot
        along = away / max(math.hypot(*away), 1e-9)
        ends = belt_ends(list(pair.pairs), along=along, at=pair.at)
        if not has_root or {root, tip} != set(ends):
            pair.refuse("a belt beside the pivot", "must have a belt from the pivot to the tip")
    out = places[-1] - (places[0] if has_root else pivot)
    angle = math.atan2(out[1], sign * out[0])
    track: Track = BeltTrack()
    if not pair.is_belt:
        start = np.array([root.x, root.y]) if has_root else pair.pivot
        track = wheels_of(
            log,
            list(pair.pairs if is_front else reversed(pair.pairs)),
            # The frame of an arm is midway along it, x forward.
            Base(start, tip_place) if is_front else Base(tip_place, start),
            view,
            path="robot.flippers.track",
            run=sign * angle * radius,  # which a raised flipper adds to that of its track
            is_whole=has_root,
        )
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


def _refuse_unlike(log: ReadLog, front: AtEnd, rear: AtEnd, tolerance: float) -> None:
    """Refuse flippers at both ends that differ in shape; warn of a difference in mass or angle.

    Raises
    ------
    ScenarioError
        If they differ in shape, as a robot has one kind.
    """
    for name in ("length", "root_radius", "tip_radius"):
        first, second = getattr(front, name), getattr(rear, name)
        if abs(first - second) > tolerance:
            rule = f"must be the same at both ends, within {1e3 * tolerance:g} mm"
            rear.pair.refuse(f"{name} {second:.6g} and {first:.6g} m", rule)
    if abs(front.pair.mass - rear.pair.mass) > _ALIKE * front.pair.mass:
        value = f"{rear.pair.mass:.4g} and {front.pair.mass:.4g} kg"
        log.add_warning(
            rear.pair.path, value, "differ in mass from the front ones: the mean is used"
        )
    if abs(front.angle - rear.angle) > _SAME_ANGLE:
        value = f"{rear.angle:.4g} and {front.angle:.4g} rad"
        reason = "are at another angle than the front ones: the angle of those is used for both"
        log.add_warning(rear.pair.path, value, reason)
    if not _is_same(front.track, rear.track):
        rule = "must be the same at both ends and have evenly spaced wheels, or a belt"
        rear.pair.refuse(f"{rear.track!r} and {front.track!r}", rule)


def _is_same(front: Track, rear: Track) -> bool:
    """Whether flippers have one track model; wheels placed by hand are not mirrored."""
    if isinstance(front, LineOfWheels) and isinstance(rear, LineOfWheels):
        return front.count == rear.count and is_same_wheel(front.wheel, rear.wheel)
    return front == rear and not isinstance(front, HybridWheels)


def _limits(log: ReadLog, ends: list[AtEnd], mass: float) -> tuple[float, float]:
    """Return rate [rad/s] and torque [N m] of one flipper of a robot of a mass [kg]."""
    motors = [motor for end in ends for motor in end.motors]
    length = max(end.length for end in ends)
    rate, torque = _RATE, MARGIN * 0.5 * mass * WEIGHT * length / 2.0
    rates = [
        joint.velocity
        for joint, _ in motors
        if joint.velocity and joint.velocity <= FASTEST and not joint.is_locked
    ]
    rate_source = estimate("that of MARV: the file has no limit")
    if len(rates) == len(motors):
        rate = min(rates)
        rate_source = lines([joint.velocity_at for joint, _ in motors])
        _warn_of_unlike(log, "rate_limit", rates, "rad/s")
    log.sources["robot.flippers.rate_limit"] = rate_source
    torques = [
        joint.effort / count for joint, count in motors if joint.effort and not joint.is_locked
    ]
    torque_source = estimate(
        "1.6 times what lifts half of the robot with both tips: the file has no limit"
    )
    if len(torques) == len(motors):
        torque = min(torques)
        torque_source = lines([joint.effort_at for joint, _ in motors])
        _warn_of_unlike(log, "torque_limit", torques, "N m")
    log.sources["robot.flippers.torque_limit"] = torque_source
    return rate, torque


def _warn_of_unlike(log: ReadLog, name: str, limits: Sequence[float], unit: str) -> None:
    """Warn of limits of flippers that differ, as a robot has one kind."""
    if not math.isclose(min(limits), max(limits), rel_tol=_ALIKE):
        value = f"{min(limits):.4g} to {max(limits):.4g} {unit}"
        reason = "differs from flipper to flipper: the least is used"
        log.add_warning(f"robot.flippers.{name}", value, reason)
