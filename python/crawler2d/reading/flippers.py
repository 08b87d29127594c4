"""The flippers of a robot, with the sources of their figures."""

from __future__ import annotations

import math

from crawler2d.parameters.flippers import Flippers
from crawler2d.reading.actuators import (
    FASTEST,
    resistance,
    rotor_inertia,
    tell_ignored,
    tell_lost,
)
from crawler2d.reading.arms import ArmPair, AtEnd, at_end, refuse_unlike
from crawler2d.reading.drive import MARGIN, WEIGHT, Note
from crawler2d.reading.parts import Arm
from crawler2d.reading.sources import estimate, lines
from crawler2d.reading.telling import Telling, place_of
from crawler2d.reading.tracks import Base
from crawler2d.reading.view import SideView

__all__ = ["arms_at", "flippers_of"]

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
