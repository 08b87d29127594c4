"""What becomes of each wheel of a file: it stays, moves, changes its size, goes, or is added."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

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


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Change:
    """What becomes of one wheel of the file.

    Parameters
    ----------
    joint : Joint
        On which it turns.
    links : tuple of str
        What turns with it, its own link first.
    fate : {"changed", "added", "removed"}
        An added one is a copy of this one, and changed besides.
    shift : ndarray, shape (3,)
        [m] By which it moves, in the frame of the model.
    size : float
        [-] Its radius, and the effort of its motor, by what they were.
    round_size : float
        [-] The radius of its round shapes by what it was: of gear wheels that of the root circle.
    share : float
        [-] Its mass by what it was: all wheels of a carrier keep theirs together, and their efforts
        likewise.
    grousers : tuple of Shape
        Boxes, in the frame of the model.
    """

    joint: Joint
    links: tuple[str, ...]
    fate: str
    shift: Array
    size: float = 1.0
    round_size: float = 1.0
    share: float = 1.0
    grousers: tuple[Shape, ...] = ()

    @property
    def link(self) -> str:
        """Its own link."""
        return self.links[0]

    @property
    def is_none(self) -> bool:
        """Whether its wheel stays as it is."""
        same = self.size == self.share == 1.0 and not self.shift.any() and not self.grousers
        return self.fate == "changed" and same

    def grousers_on(self, wheel: Pose) -> Iterator[tuple[Shape, Pose]]:
        """Yield the grousers, with their poses in the frame of the wheel's link as it has moved."""
        moved = Pose(place=wheel.place + self.shift, turn=wheel.turn)
        return ((shape, shape.pose.seen_from(moved)) for shape in self.grousers)

    @property
    def effort(self) -> float:
        """[-] What the limit of its motor is multiplied by."""
        return self.share * self.size

    @property
    def inertia(self) -> float:
        """[-] What its moments of inertia are multiplied by."""
        return self.share * self.size**2


def changes_of(reading: Reading, robot: Robot) -> list[Change]:
    """Plan how the wheels of a file become those of another robot.

    Wheels that are where the other robot has one of their size stay. Of the others on a carrier,
    each takes the place of the next one that is not taken; what is left over goes, and what is
    missing is copied from the nearest.

    Parameters
    ----------
    reading : Reading
        What was read.
    robot : Robot
        The same robot with other wheels.

    Returns
    -------
    list of Change
        One for each wheel of the file that does not stay as it is, and for each that is added.

    Raises
    ------
    ScenarioError
        If the other robot has other carriers, belts, or wheels where the file has none.
    """
    old, new = _carriers(reading.robot), _carriers(robot)
    if [each.end for each in old] != [each.end for each in new]:
        raise ScenarioError("robot.flippers", robot.flippers, "must be where the file has them")
    changes = []
    for was, now in zip(old, new, strict=True):
        if not _alike(was, now):
            changes += _Carrier(reading, was, now).changes()
    return changes


def _carriers(robot: Robot) -> list[Carrier]:
    text = Scenario(robot, Flat(), drive=Drive(speed=0.0)).to_json()
    plain: dict[str, Any] = json.loads(_core.canonical(text))["robot"]
    return carriers_of(plain, text)


def _alike(was: Carrier, now: Carrier) -> bool:
    if was.surface != "wheels" or now.surface != "wheels":
        return was.surface == now.surface
    return len(was.wheels) == len(now.wheels) and all(
        _off(first, second) <= _SAME and _same_outline(first, second)
        for first, second in zip(was.wheels, now.wheels, strict=True)
    )


def _off(first: Wheel, second: Wheel) -> float:
    return max(math.dist(first.center, second.center), abs(first.radius - second.radius))


def _same_outline(first: Wheel, second: Wheel) -> bool:
    if first.outline is None or second.outline is None:
        return first.outline is second.outline
    return first.outline.shape == second.outline.shape and bool(
        np.abs(first.outline - second.outline).max() <= _SAME
    )


class _Carrier:
    """The wheels of one carrier on their way to other places."""

    def __init__(self, reading: Reading, was: Carrier, now: Carrier) -> None:
        self.reading = reading
        self.was, self.now = was, now
        self.name = f"{was.end} flipper" if was.end else "chassis"
        self.hanging = subtrees(reading.tree)

    def changes(self) -> list[Change]:
        for carrier, whose in ((self.was, "of the file"), (self.now, "of the robot")):
            if carrier.surface != "wheels":
                rule = f"must be wheels, to take the place of others: those {whose} are not"
                raise ScenarioError(f"tracks of the {self.name}", carrier.surface, rule)
        fates = list(self.fates())
        changes = [change for side in _SIDES for change in self.on_side(side, fates)]
        return [change for change in changes if not change.is_none]

    def fates(self) -> Iterator[tuple[int, int | None, str]]:
        """Yield the wheel of the file, the one that it becomes, and how."""
        old, new = list(range(len(self.was.wheels))), list(range(len(self.now.wheels)))
        pairs = []
        for each in list(new):
            stays = [k for k in old if _off(self.was.wheels[k], self.now.wheels[each]) <= _SAME]
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
            center = self.now.wheels[each].center
            away = [math.dist(wheel.center, center) for wheel in self.was.wheels]
            yield int(np.argmin(away)), each, "added"

    def on_side(self, side: str, fates: list[tuple[int, int | None, str]]) -> Iterator[Change]:
        joints = self.joints(side)
        masses = {k: self.mass(joints[k]) for k in range(len(joints))}
        kept = sum(masses[old] for old, new, _ in fates if new is not None)
        share = sum(masses.values()) / kept if kept > 0.0 else 1.0
        share = share if abs(share - 1.0) > _SAME else 1.0
        for old, new, fate in fates:
            for joint in joints[old]:
                yield self.change(joint, old, new, fate, share)

    def change(self, joint: Joint, old: int, new: int | None, fate: str, share: float) -> Change:
        links = tuple(self.hanging[joint.child])
        if new is None:
            return Change(joint=joint, links=links, fate=fate, shift=np.zeros(3))
        was, now = self.was.wheels[old], self.now.wheels[new]
        (x, z), frame = now.center - was.center, self.reading.frame
        shift = frame.along((x, 0.0, z))
        size = now.radius / was.radius
        root, grousers = size, tuple[Shape, ...]()
        if now.outline is not None and not _same_outline(was, now):
            if was.outline is not None:
                raise ScenarioError(self.name, "gear wheels", "must be round in the file")
            root = grousers_of(now.outline)[0] / was.radius
            grousers = self.grousers(joint, now)
        return Change(
            joint=joint,
            links=links,
            fate=fate,
            shift=np.where(np.abs(shift) <= _SAME, 0.0, shift),
            size=size if abs(size - 1.0) * was.radius > _SAME else 1.0,
            round_size=root if abs(root - 1.0) * was.radius > _SAME else 1.0,
            share=share,
            grousers=grousers,
        )

    def joints(self, side: str) -> list[list[Joint]]:
        """Return the joints of the wheels that stand at each place, one or more side by side."""
        table, tree = self.reading.wheels, self.reading.tree
        here = (table["side"] == side) & (table["carrier"] == self.name)
        found: list[list[Joint]] = [[] for _ in self.was.wheels]
        for name in table["name"][here].tolist():
            joint = tree.joints[name]
            x, _, z = self.reading.frame.turn.T @ (joint.place - self.reading.frame.place)
            away = [math.dist(wheel.center, (x, z)) for wheel in self.was.wheels]
            found[int(np.argmin(away))].append(joint)
        if not all(found):
            rule = "must have wheels of its own in the file, to be changed there"
            raise ScenarioError(f"wheels of the {self.name}", "none", rule)
        return found

    def mass(self, joints: list[Joint]) -> float:
        links = self.reading.tree.by_name
        return sum(links[n].mass for joint in joints for n in self.hanging[joint.child])

    def grousers(self, joint: Joint, wheel: Wheel) -> tuple[Shape, ...]:
        """Return the grousers of a gear wheel, as wide as the wheel of the file that it is on."""
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
        assert wheel.outline is not None  # asked before
        made = gear_shapes(wheel.outline, solids, wheel.center, hulls=False)
        if made is None:
            rule = "must be as thick as the tip: grousers are added as boxes"
            raise ScenarioError("robot.track.wheel.base_thickness", "more", rule)
        return tuple(_moved(shape, frame) for shape in made[1:])


def _moved(shape: Shape, frame: Pose) -> Shape:
    """Return a shape that was given in the chassis frame in the frame of the model."""
    return Shape(name=shape.name, kind=shape.kind, pose=frame.then(shape.pose), size=shape.size)
