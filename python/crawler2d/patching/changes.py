"""The changes of each wheel of a file: none, moved, resized, removed or added."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from crawler2d import _core
from crawler2d.errors import ScenarioError
from crawler2d.model_tree import Array, Joint, Pose, Shape
from crawler2d.parameters.robot import Robot
from crawler2d.parameters.scenario import Scenario
from crawler2d.parameters.settings import Drive
from crawler2d.parameters.terrain import Flat
from crawler2d.reading.reading import Reading
from crawler2d.reading.wheels import subtrees
from crawler2d.writing.carriers import Carrier, Wheel, carriers_of
from crawler2d.writing.shapes import Solids, gear_shapes, grousers_of

__all__ = ["Change", "changes_of"]

_SAME = 1e-6  # [m] Files round to a micrometre.
_SIDES = ("left", "right")


@dataclass(frozen=True, slots=True, kw_only=True)
class Motor:
    """Factors of a wheel's motor, at the circumference of the wheel.

    Parameters
    ----------
    force, gain, rotor : float
        [-] Factors of its largest force, the gain of its servo, and the equivalent mass of its
        rotor.
    """

    force: float = 1.0
    gain: float = 1.0
    rotor: float = 1.0


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Change:
    """The change of one wheel of the file.

    Parameters
    ----------
    joint : Joint
        Joint of the wheel.
    links : tuple of str
        Links that turn with it, its own first.
    action : {"changed", "added", "removed"}
        An added wheel is a changed copy of this one.
    shift : ndarray, shape (3,)
        [m] Its displacement, in the frame of the model.
    size : float
        [-] Factor of its radius.
    round_size : float
        [-] Factor of the radius of its round shapes; for gear wheels, of the root circle.
    mass : float
        [-] Factor of its mass; the total over a carrier's wheels stays the same.
    motor : Motor
        Factors of its motor at the same radius; the totals of a side, including flippers, stay the
        same, even if not all wheels have motors.
    grousers : tuple of Shape
        Boxes, in the frame of the model.
    """

    joint: Joint
    links: tuple[str, ...]
    action: str
    shift: Array
    size: float = 1.0
    round_size: float = 1.0
    mass: float = 1.0
    motor: Motor = Motor()
    grousers: tuple[Shape, ...] = ()

    @property
    def link(self) -> str:
        """Its own link."""
        return self.links[0]

    @property
    def is_none(self) -> bool:
        """Whether its wheel stays unchanged."""
        same = (
            self.size == self.mass == 1.0
            and self.motor == Motor()
            and not self.shift.any()
            and not self.grousers
        )
        return self.action == "changed" and same

    def grousers_on(self, wheel: Pose) -> Iterator[tuple[Shape, Pose]]:
        """Yield the grousers, with their poses in the frame of the moved wheel's link."""
        moved = Pose(place=wheel.place + self.shift, turn=wheel.turn)
        return ((shape, shape.pose.seen_from(moved)) for shape in self.grousers)

    @property
    def effort(self) -> float:
        """[-] Factor of the limit of its motor."""
        return self.motor.force * self.size

    @property
    def gain(self) -> float:
        """[-] Factor of the gain of its motor."""
        return self.motor.gain * self.size**2

    @property
    def rotor(self) -> float:
        """[-] Factor of the moment of inertia of its motor's rotor."""
        return self.motor.rotor * self.size**2

    @property
    def inertia(self) -> float:
        """[-] Factor of its moments of inertia."""
        return self.mass * self.size**2


def changes_of(reading: Reading, robot: Robot) -> list[Change]:
    """Plan the changes from the wheels of a file to those of another robot.

    Wheels that match one of the other robot stay. The others on a carrier become, in order, the
    wheels still missing; surplus ones are removed, and missing ones are copied from the closest. As
    all wheels of a side share its torque, a different number on one carrier changes the motors on
    the others.

    Parameters
    ----------
    reading : Reading
        The reading of the file.
    robot : Robot
        The same robot with other wheels.

    Returns
    -------
    list of Change
        One for each changed, removed or added wheel.

    Raises
    ------
    ScenarioError
        If the other robot has different carriers, belts, or wheels on a carrier without any in the
        file.
    """
    old, new = _carriers(reading.robot), _carriers(robot)
    if [each.end for each in old] != [each.end for each in new]:
        raise ScenarioError("robot.flippers", robot.flippers, "must be where the file has them")
    pairs = list(zip(old, new, strict=True))
    changed = [pair for pair in pairs if not _is_same_carrier(*pair)]
    if not changed:
        return []
    carriers = [
        _CarrierChange(reading, *pair)
        for pair in pairs
        if pair in changed or _has_wheels(reading, pair[0])
    ]
    for each in carriers:
        each.refuse_belts()
    motors = {side: _motors_of(carriers, side, reading.tree.driven) for side in _SIDES}
    changes = [
        change
        for each in carriers
        for side in _SIDES
        for change in each.on_side(side, motors[side])
    ]
    return [change for change in changes if not change.is_none]


def _carriers(robot: Robot) -> list[Carrier]:
    text = Scenario(robot, Flat(), drive=Drive(speed=0.0)).to_json()
    return carriers_of(json.loads(_core.canonical(text))["robot"], text)


def _name_of(carrier: Carrier) -> str:
    """Return its name in the table of a reading."""
    return f"{carrier.end} flipper" if carrier.end else "chassis"


def _is_same_carrier(was: Carrier, now: Carrier) -> bool:
    if was.surface != now.surface or len(was.wheels) != len(now.wheels):
        return False
    return all(
        _deviation(first, second) <= _SAME and _has_same_outline(first, second)
        for first, second in zip(was.wheels, now.wheels, strict=True)
    )


def _has_wheels(reading: Reading, carrier: Carrier) -> bool:
    """Whether it has wheels in the file; a chassis without any stands on its flippers' wheels."""
    return carrier.surface == "wheels" and bool(
        (reading.wheels["carrier"] == _name_of(carrier)).any()
    )


def _deviation(first: Wheel, second: Wheel) -> float:
    """[m] Return the difference of two wheels in position or radius."""
    return max(math.dist(first.center, second.center), abs(first.radius - second.radius))


def _has_same_outline(first: Wheel, second: Wheel) -> bool:
    if first.outline is None or second.outline is None:
        return first.outline is second.outline
    return first.outline.shape == second.outline.shape and bool(
        np.abs(first.outline - second.outline).max() <= _SAME
    )


def _share(of_wheels: list[float], stay: list[int]) -> float:
    """[-] Return the factor that gives the remaining ones, with their copies, the total of all."""
    kept = sum(of_wheels[each] for each in stay)
    factor = sum(of_wheels) / kept if kept > 0.0 else 1.0
    return factor if abs(factor - 1.0) > _SAME else 1.0


def _motors_of(
    carriers: list[_CarrierChange], side: str, driven: Collection[str]
) -> dict[str, Motor]:
    """Return the factors of each motor of a side, by its joint."""
    groups = [group for each in carriers for group in each.joints(side)]
    radii = [wheel.radius for each in carriers for wheel in each.was.wheels]
    names = {joint.name for group in groups for joint in group}
    motors = names.intersection(driven) or names
    stay, first = [], 0
    for each in carriers:
        stay += [first + old for old, new, _ in each.actions() if new is not None]
        first += len(each.was.wheels)

    def share(value: Callable[[Joint], float], power: int) -> float:
        of_wheels = [
            sum(value(joint) for joint in group if joint.name in motors) / radius**power
            for group, radius in zip(groups, radii, strict=True)
        ]
        return _share(of_wheels, stay)

    gain = share(lambda joint: joint.gain or 0.0, 2)
    has_limits = any(joint.effort for group in groups for joint in group)
    force = share(lambda joint: joint.effort or 0.0, 1) if has_limits else gain
    rotor = share(lambda joint: joint.armature, 2)
    return dict.fromkeys(motors, Motor(force=force, gain=gain, rotor=rotor))


class _CarrierChange:
    """The changes of the wheels of one carrier."""

    def __init__(self, reading: Reading, was: Carrier, now: Carrier) -> None:
        self.reading = reading
        self.was, self.now = was, now
        self.name = _name_of(was)
        self.hanging = subtrees(reading.tree)

    def refuse_belts(self) -> None:
        for carrier, whose in ((self.was, "of the file"), (self.now, "of the robot")):
            if carrier.surface != "wheels":
                rule = f"must be wheels, to be replaced by others: those {whose} are not"
                raise ScenarioError(f"tracks of the {self.name}", carrier.surface, rule)

    def actions(self) -> Iterator[tuple[int, int | None, str]]:
        """Yield the wheel of the file, its replacement, and the action."""
        old, new = list(range(len(self.was.wheels))), list(range(len(self.now.wheels)))
        pairs = []
        for each in list(new):
            stays = [
                k for k in old if _deviation(self.was.wheels[k], self.now.wheels[each]) <= _SAME
            ]
            if stays:
                pairs.append((stays[0], each))
                old.remove(stays[0])
                new.remove(each)
        pairs += zip(old, new, strict=False)
        for first, second in sorted(pairs):
            yield first, second, "changed"
        for each in old[len(new) :]:
            yield each, None, "removed"
        for each in new[len(old) :]:
            yield self.closest(self.now.wheels[each].center), each, "added"

    def closest(self, center: Array | tuple[float, float]) -> int:
        """Return the wheel of the file that is closest to a point."""
        return int(np.argmin([math.dist(wheel.center, center) for wheel in self.was.wheels]))

    def on_side(self, side: str, motors: Mapping[str, Motor]) -> Iterator[Change]:
        """Yield the changes on a side, given the factors of motors by joint."""
        joints, links = self.joints(side), self.reading.tree.by_name
        masses = [
            sum(links[name].mass for joint in group for name in self.hanging[joint.child])
            for group in joints
        ]
        actions = list(self.actions())
        mass = _share(masses, [old for old, new, _ in actions if new is not None])
        for old, new, action in actions:
            for joint in joints[old]:
                motor = motors.get(joint.name, Motor())
                yield self.change(joint, old, new, action, mass=mass, motor=motor)

    def change(
        self, joint: Joint, old: int, new: int | None, action: str, *, mass: float, motor: Motor
    ) -> Change:
        links = tuple(self.hanging[joint.child])
        if new is None:
            return Change(joint=joint, links=links, action=action, shift=np.zeros(3))
        was, now = self.was.wheels[old], self.now.wheels[new]
        (x, z), frame = now.center - was.center, self.reading.frame
        shift = frame.along((x, 0.0, z))
        size = now.radius / was.radius
        root, grousers = size, tuple[Shape, ...]()
        if not _has_same_outline(was, now):
            if was.outline is not None or now.outline is None:
                raise ScenarioError(self.name, "gear wheels", "must be round in the file")
            root = grousers_of(now.outline)[0] / was.radius
            grousers = self.grousers(joint, now.outline, now.center)
        return Change(
            joint=joint,
            links=links,
            action=action,
            shift=np.where(np.abs(shift) <= _SAME, 0.0, shift),
            size=size if abs(size - 1.0) * was.radius > _SAME else 1.0,
            round_size=root if abs(root - 1.0) * was.radius > _SAME else 1.0,
            mass=mass,
            motor=motor,
            grousers=grousers,
        )

    def joints(self, side: str) -> list[list[Joint]]:
        """Return the joints of the wheels at each position, one or more side by side."""
        table, frame = self.reading.wheels, self.reading.frame
        here = (table["side"] == side) & (table["carrier"] == self.name)
        joints: list[list[Joint]] = [[] for _ in self.was.wheels]
        for name in table["name"][here].tolist():
            joint = self.reading.tree.joints[name]
            x, _, z = frame.turn.T @ (joint.place - frame.place)
            joints[self.closest((x, z))].append(joint)
        if not all(joints):
            rule = "must have wheels of its own in the file, to be changed there"
            raise ScenarioError(f"wheels of the {self.name}", "none", rule)
        return joints

    def grousers(self, joint: Joint, outline: Array, center: Array) -> tuple[Shape, ...]:
        """Return the grousers of a gear wheel, as wide as its wheel in the file."""
        frame, links = self.reading.frame, self.reading.tree.by_name
        shapes = [shape for name in self.hanging[joint.child] for shape in links[name].shapes]
        largest = max(shapes, key=lambda shape: shape.radius)
        across = frame.turn.T @ (largest.pose.place - frame.place)
        solids = Solids(
            name=f"{joint.child}_grouser",
            across=float(across[1]),
            width=largest.length or largest.radius,
            friction=0.0,
        )
        parts = gear_shapes(outline, solids, center, hulls=False)
        if parts is None:
            rule = "must be as thick as the tip: grousers are added as boxes"
            raise ScenarioError("robot.track.wheel.base_thickness", "more", rule)
        return tuple(
            Shape(name=each.name, kind=each.kind, pose=frame.then(each.pose), size=each.size)
            for each in parts[1:]
        )
