"""From a neutral tree to a robot: sides paired, masses summed, every figure with its source."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace

import numpy as np

from crawler2d.errors import ScenarioError
from crawler2d.parameters.flippers import Flippers
from crawler2d.parameters.robot import Robot, TrackOutline
from crawler2d.parameters.track import BeltTrack, LineOfWheels, Track
from crawler2d.reading.arms import ArmPair, AtEnd, arm_pairs, at_end, refuse_unlike
from crawler2d.reading.belly import belly_of
from crawler2d.reading.belts import belt_ends
from crawler2d.reading.drive import drivetrain_of, limits_of_arms
from crawler2d.reading.elements import Where
from crawler2d.reading.friction import combined
from crawler2d.reading.gear import Gear, Runner, gear_of
from crawler2d.reading.masses import circulating, summed
from crawler2d.reading.sides import Pair, middle_of, paired
from crawler2d.reading.sources import estimate, lines
from crawler2d.reading.tracks import Base, wheels_of
from crawler2d.reading.tree import Tree
from crawler2d.reading.view import SideView, side_view

__all__ = ["Assembly", "Doubt", "assembled"]

_LARGEST = 3.0  # [m] The largest tracked robots that climb obstacles are shorter.
_LEAST_MOVING = 0.001  # [kg] The least that a robot can have.
_MOVING_SHARE = 0.01  # of the mass, for a surface that moves without mass in its file

Doubt = tuple[str, object, str]
"""Path, value and reason of a `ScenarioWarning`."""


@dataclass(slots=True, kw_only=True)
class Assembly:
    """A robot in the making, with what is told about it.

    Parameters
    ----------
    tree : Tree
        The model.
    tolerance : float
        [m] By how much the two sides may differ.
    sources : dict of str to str
        By path.
    notes : list of str
        What was decided.
    doubts : list of Doubt
        What is hardly meant.
    rows : list of (str, Runner)
        All wheels and drums, each with its carrier, in the order of the table.
    view : SideView
        The side view.
    middle : float
        [m] Where the middle plane lies across it.
    """

    tree: Tree
    tolerance: float
    sources: dict[str, str] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)
    doubts: list[Doubt] = field(default_factory=list)
    rows: list[tuple[str, Runner]] = field(default_factory=list)
    view: SideView = field(init=False)
    middle: float = field(init=False)

    def note(self, path: str, source: str) -> None:
        """Keep the source of a figure."""
        self.sources[path] = source

    def robot(self, forward: str | None) -> Robot:
        """Make the robot.

        Raises
        ------
        ScenarioError
            If the model has what a side view cannot hold, or breaks a rule of a robot.
        """
        tree, at, tolerance = self.tree, self.tree.at, self.tolerance
        self.view = view = side_view(tree, forward)
        self.notes.append(f"{view.reason}: {_named(view.forward)} is forward")
        gear = gear_of(tree, view)
        runners = gear.runners + [r for arm in gear.arms for r in arm.runners]
        self.middle = middle = middle_of(gear.runners or runners)
        pairs = paired(gear.runners, middle=middle, tolerance=tolerance, at=at)
        arms = arm_pairs(gear.arms, view, middle=middle, tolerance=tolerance, at=at)
        is_belt = bool(pairs) and pairs[0].left[0].joint is None
        if len({runner.joint is None for runner in gear.runners}) > 1:
            raise ScenarioError(str(at), "wheels and drums", "must have one kind on the chassis")
        rear, front = self.ends(gear, pairs, arms, is_belt=is_belt)
        base = Base(np.array(rear[:2]), np.array(front[:2]))
        if base.length <= tolerance:
            raise ScenarioError(str(at), base.length, "must have two wheels or drums on each side")
        by_end = self.arms_at(arms, base)
        track: Track = BeltTrack() if is_belt else LineOfWheels(2, as_track=False)
        if pairs and not is_belt:
            track = wheels_of(pairs, base)
        total = summed(tree, view, base, [(by_end[end], _SIGN[end]) for end in by_end])
        if not total.mass > 0.0:
            raise ScenarioError(str(at), total.mass, "must have links with a mass > 0 kg")
        self.note("robot.name", f"{at}")
        self.note("robot.mass", lines([link.mass_at for link in tree.links], "sum"))
        angle = " at angle 0" if by_end else ""
        of_links = lines([link.at for link in tree.links], f"sum{angle}")
        self.note("robot.center_of_mass", of_links)
        self.note("robot.moment_of_inertia", of_links)
        outline = self.outline(base, rear[2], front[2])
        driven = pairs or [pair for end in by_end.values() for pair in end.pair.pairs]
        torque = _holding_torque(total.mass, max(rear[2], front[2]))
        drivetrain = drivetrain_of(tree, driven, track, torque=torque, note=self.note)
        flippers = self.flippers(by_end, total.mass)
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

    def ends(
        self, gear: Gear, pairs: list[Pair], arms: list[ArmPair], *, is_belt: bool
    ) -> tuple[tuple[float, float, float], tuple[float, float, float]]:
        """[m] Return x, y and radius of the rear and the front axle; note their lines."""
        names = "axle_distance", "rear_radius", "front_radius"
        if pairs:
            rear, front = pairs[0], pairs[-1]
            if is_belt:
                rear, front = belt_ends(pairs, gear.bars, at=self.tree.at)
            found = rear, front
        else:
            # Nothing runs between the flippers: the robot stands on their roots.
            order = sorted(arms, key=lambda arm: float(arm.pivot[0]))
            if len(order) < 2:
                rule = "must have wheels on the chassis, or flippers at both ends"
                raise ScenarioError(str(self.tree.at), "flippers at one end", rule)
            found = order[0].pairs[0], order[-1].pairs[0]
            text = "the chassis has no wheels: it stands on the roots of its flippers"
            self.notes.append(text)
            self.note("robot.track", estimate(f"{text}, which are no track"))
        rear, front = found
        both = [*rear.both, *front.both]
        places = [_place(runner) for runner in both]
        for name, where in zip(
            names,
            (places, [r.shape.size_at for r in rear.both], [r.shape.size_at for r in front.both]),
            strict=True,
        ):
            self.note(f"robot.outline.{name}", lines(where))
        if pairs:
            of_all = [runner.shape.size_at for pair in pairs for runner in pair.both]
            self.note("robot.track", lines(of_all, "radii"))
        return (rear.x, rear.y, rear.radius), (front.x, front.y, front.radius)

    def outline(self, base: Base, rear: float, front: float) -> TrackOutline:
        """Return the outline, without grousers, which no format has."""
        for name in ("grouser_height", "grouser_pitch", "grouser_thickness"):
            self.note(f"robot.outline.{name}", estimate("the file has no grousers"))
        if base.length + rear + front > _LARGEST:
            reason = f"is usually at most {_LARGEST:g} m with the wheels: is the file in metres?"
            self.doubts.append(("robot.outline.axle_distance", base.length, reason))
        return TrackOutline(
            axle_distance=base.length,
            front_radius=front,
            rear_radius=rear,
            grouser_height=0.0,
            grouser_pitch=0.75 * min(front, rear),
            grouser_thickness=0.0,
        )

    def arms_at(self, arms: list[ArmPair], base: Base) -> dict[str, AtEnd]:
        """Return the flippers by end, the front first."""
        found: dict[str, AtEnd] = {}
        for pair in arms:
            to_front, to_rear = (math.hypot(*(pair.pivot - end)) for end in (base.front, base.rear))
            end = "front" if to_front < to_rear else "rear"
            if end in found:
                pair.refuse(f"two pairs at the {end}", "must be the only flippers at its end")
            found[end] = at_end(pair, base, is_front=end == "front", tolerance=self.tolerance)
            if found[end].off > self.tolerance:
                reason = f"pivots {1e3 * found[end].off:.3g} mm off the end axle, here on it"
                self.doubts.append((f"joint[{pair.arms[0].joint.name}]", end, reason))
            locked = [arm.joint.name for arm in pair.arms if arm.joint.is_locked]
            if locked:
                self.notes.append(
                    f"{', '.join(locked)}: locked in the file, here flippers that turn"
                )
        if len(found) == 2:
            refuse_unlike(found["front"], found["rear"], self.tolerance)
        return {end: found[end] for end in ("front", "rear") if end in found}

    def flippers(self, by_end: dict[str, AtEnd], mass: float) -> Flippers | None:
        """Return the flippers with the sources of their figures."""
        if not by_end:
            self.note("robot.flippers", f"{self.tree.at}: none")
            return None
        ends = list(by_end.values())
        first, pairs = ends[0], [end.pair for end in ends]
        shown = [r for pair in pairs for each in (pair.pairs[0], pair.pairs[-1]) for r in each.both]
        joints = [arm.joint.at for pair in pairs for arm in pair.arms]
        self.note("robot.flippers.length", lines([_place(r) for r in shown]))
        for name, index in (("root_radius", 0), ("tip_radius", -1)):
            sizes = [r.shape.size_at for pair in pairs for r in pair.pairs[index].both]
            self.note(f"robot.flippers.{name}", lines(sizes))
        if not first.has_root:
            rule = "that of the tip: no wheel is at the pivot"
            self.note("robot.flippers.root_radius", estimate(rule))
        of_arms = [link for pair in pairs for arm in pair.arms for link in arm.links]
        self.note("robot.flippers.mass", lines([link.mass_at for link in of_arms], "sum"))
        self.note("robot.flippers.ends", lines(joints))
        self.note(
            "robot.flippers.angle", lines([arm.links[0].pose_at for p in pairs for arm in p.arms])
        )
        radii = [r.shape.size_at for pair in pairs for each in pair.pairs for r in each.both]
        self.note("robot.flippers.track", lines(radii, "radii"))
        rate, torque = limits_of_arms(ends, mass=mass, note=self.note)
        return Flippers(
            length=first.length,
            root_radius=first.root_radius,
            tip_radius=first.tip_radius,
            mass=first.pair.mass,
            ends="both" if len(ends) == 2 else ("front" if "front" in by_end else "rear"),
            angle=first.angle,
            rate_limit=rate,
            torque_limit=torque,
            track=first.track,
        )

    def track_mass(self, pairs: list[Pair], mass: float) -> float:
        """[kg] Return what moves at track speed."""
        moving, is_excessive = circulating(pairs)
        if not _LEAST_MOVING <= moving < mass:
            self.note("robot.track_mass", estimate("a hundredth of the mass: the file has none"))
            return _MOVING_SHARE * mass
        wheels = [runner.link.at for pair in pairs for runner in pair.both]
        self.note("robot.track_mass", lines(wheels, "moment of inertia by radius squared"))
        if is_excessive:
            rule = "the mass of the wheels, as of hoops: their moments of inertia exceed it"
            self.note("robot.track_mass", estimate(rule))
            self.doubts.append(
                ("robot.track_mass", moving, "is limited to hoops: wheels state more inertia")
            )
        return moving

    def belly(
        self, gear: Gear, base: Base, driven: list[Pair]
    ) -> tuple[tuple[float, float], ...] | None:
        """Return the belly; doubt one that touches level ground, tell what it leaves out."""
        corners = belly_of(gear.shapes, self.view, base)
        moving = list(dict.fromkeys(link.name for _, link, _ in gear.moving))
        if moving:
            self.notes.append(f"{', '.join(moving)}: move by themselves, and touch nothing here")
        if corners is None:
            self.note("robot.belly", f"{self.tree.at}: no collision shape on the chassis")
            return None
        self.note("robot.belly", lines([shape.at for _, shape in gear.shapes], "hull"))
        places = base.of(np.array([[pair.x, pair.y] for pair in driven]))
        ground = min(float(y) - pair.radius for (_, y), pair in zip(places, driven, strict=True))
        lowest = min(y for _, y in corners)
        if lowest <= ground + self.tolerance:
            reason = "rubs on level ground: a skid beside the wheels counts as belly"
            self.doubts.append(("robot.belly", lowest, reason))
        return corners

    def gauge(self, pairs: list[Pair]) -> float:
        """[m] Return the lateral distance of the tracks; tell of wheels that stand apart."""
        runners = [runner for pair in pairs for runner in pair.both]
        across = [abs(runner.z - self.middle) for runner in runners]
        usual = float(np.median(across))
        self.note("robot.gauge", lines([_place(runner) for runner in runners], "median"))
        for runner, own in zip(runners, across, strict=True):
            if abs(own - usual) > self.tolerance:
                where = "inboard" if own < usual else "outboard"
                off = 1e3 * abs(own - usual)
                self.notes.append(f"{runner.name}: {off:.3g} mm {where} of the others")
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
                self.rows += [(carrier, runner) for runner in sorted(found, key=lambda r: r.x)]
        swapped = [r.name for _, r in self.rows if _is_swapped(r, self.middle)]
        if swapped:
            reason = "is on the other side than its name says: is forward right?"
            self.doubts.append(("forward", swapped[0], reason))

    def note_aslant(self, pair: Pair) -> None:
        """Tell of a pair that is not mirrored across: a side view does not see it."""
        left, right = pair.left[0], pair.right[0]
        off = abs(left.z + right.z - 2.0 * self.middle)
        if off > self.tolerance:
            text = f"{left.name} and {right.name}: not mirrored across, by {1e3 * off:.3g} mm"
            self.notes.append(text)


_SIGN = {"front": 1.0, "rear": -1.0}


def assembled(
    tree: Tree, *, forward: str | None, tolerance: float, engine: str, ground: float
) -> tuple[Robot, float, Assembly]:
    """Make a robot of a tree, with its friction on the ground and where that is from."""
    work = Assembly(tree=tree, tolerance=tolerance)
    robot = work.robot(forward)
    runners = [runner for _, runner in work.rows]
    friction, source, places = combined(runners, work.view, engine, ground)
    at = f": {lines(places)}" if places else ""
    work.note("friction", f"{source}{at}")
    return robot, friction, work


def _place(runner: Runner) -> Where:
    """Return the line that says where a wheel or drum is."""
    return runner.link.pose_at if runner.joint is not None else runner.shape.pose_at


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
