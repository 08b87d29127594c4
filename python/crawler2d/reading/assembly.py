"""From a neutral tree to a robot: sides paired, masses summed, every figure with its source."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from crawler2d.errors import ScenarioError
from crawler2d.models.poses import Pose
from crawler2d.models.tree import Tree
from crawler2d.parameters.robot import Robot
from crawler2d.parameters.track import BeltTrack, LineOfWheels, Track
from crawler2d.reading.arms import AtEnd, arm_pairs
from crawler2d.reading.axles import bent_round, frame_of, outline_of
from crawler2d.reading.belly import belly_of
from crawler2d.reading.belts import beyond_belt
from crawler2d.reading.drive import drivetrain_of
from crawler2d.reading.flippers import arms_at, flippers_of
from crawler2d.reading.friction import combined
from crawler2d.reading.masses import circulating, summed
from crawler2d.reading.parts import Runner, RunningGear
from crawler2d.reading.running_gear import running_gear_of
from crawler2d.reading.sides import Pair, centers, is_belted, middle_of, paired
from crawler2d.reading.silhouettes import silhouette
from crawler2d.reading.sources import estimate, lines
from crawler2d.reading.surfaces import surfaces_of
from crawler2d.reading.telling import Telling, named, place_of
from crawler2d.reading.tracks import Base, wheels_of
from crawler2d.reading.view import SideView, side_view

__all__ = ["Assembly", "assembled"]

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
