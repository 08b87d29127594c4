"""A robot for the second judge: its bodies by number, and their drives.

Numbers are those of docs/conventions.md: the track of the chassis, the arms in front, those behind,
the belly; on two lanes all of the left first. Pictures give the places.
"""

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

import crawler2d as c2d
from crawler2d import _core
from crawler2d.parameters.scenario import Scenario
from crawler2d.parameters.terrain import Lanes
from tests.judges.geometry import Array, Hull
from tests.judges.shoes import pieces_of_a_shoe

NO_CENTER = (0.0, 0.0)


@dataclass(frozen=True, kw_only=True)
class Body:
    """The meaning of a number in the contact table."""

    carrier: int
    """0: the chassis; from 1 on its arms, the front first."""
    lane: int
    """As in the tables; that of the belly only they know."""
    drive: int
    """-1: none moves its surface."""
    form: str
    """How its surface moves: "round", "gear", "grouser", "shoe" or "fixed"."""
    center: tuple[float, float] = NO_CENTER
    radius: float = 0.0
    """[m] Of a gear, in the frame of its carrier."""
    shoe: int = -1
    friction: float = math.inf
    """[-] Its own; the ground may have less."""


@dataclass(frozen=True, kw_only=True)
class Loop:
    """The bodies of one carrier on one lane, round which a taut belt would run."""

    carrier: int
    lane: int
    tips: Array
    roots: Array
    """Circles of the carrier's frame, rows of x, y, radius."""
    bodies: tuple[int, ...]
    """The body of each circle."""
    drive: int
    """That of what runs round bodies without a drive of their own, such as the shoes of a chain."""


def shapes_of(geometry: dict[str, Any]) -> list[dict[str, Any]]:
    """Shapes of each carrier with the outlines [m] of its gear wheels, and numbers of grousers."""
    bodies = geometry["bodies"]
    is_gear = (bodies["kind"] == c2d.BodyKind.WHEEL) & np.isnan(bodies["radius"])
    return [
        {
            **carrier,
            "gears": [bodies["outline"][body] for body in carrier["bodies"] if is_gear[body]],
            "grousers": len(carrier["circuit"]["grousers"]) if carrier["circuit"] else 0,
            "over": height_of_grousers(bodies, carrier),
        }
        for carrier in geometry["carriers"]
    ]


def height_of_grousers(bodies: Any, carrier: dict[str, Any]) -> float:
    """[m] Height of a carrier's grousers above the line of its belt."""
    circuit = carrier["circuit"]
    if not circuit or not len(circuit["grousers"]):
        return 0.0
    return float(bodies["outline"][circuit["grousers"][0]][:, 1].max())


class Anatomy:
    """The bodies and drives of one robot on one ground."""

    def __init__(self, scenario: Scenario) -> None:
        robot = scenario.robot
        self.robot, self.track = robot, robot.track
        self.terrain = scenario.terrain
        self.lanes = _core.geometry(scenario.to_json())["lanes"]
        """What they are under, and their profiles."""
        # Where both tracks meet the same ground bodies are numbered once.
        level = replace(scenario, terrain=c2d.terrains.flat(), goal=None)
        lumped = _core.geometry(level.to_json())
        self.is_chain = robot.track.kind == "segmental"
        is_closed = robot.track.kind == "closed"
        self.with_own_motors = robot.drivetrain.torque_sharing == "wheel" and not is_closed
        self.drive_radius: float = lumped["drive_radius"]
        self.bodies: list[Body] = []
        self.loops: list[Loop] = []
        self.motors = 1
        self.free = 0
        chassis, *arms = shapes_of(lumped)
        self._chassis(chassis)
        for number, shapes in enumerate(arms, 1):
            self._arm(number, shapes)
        self.is_split = any(label == 1 for label, _ in self.lanes)
        belt_radius = robot.outline.rear_radius - robot.outline.grouser_height
        force = 2.0 * robot.drivetrain.max_torque / belt_radius
        # Beside a chain each track of an arm has a motor as strong as the chain's.
        self.limit = force / (1 if self.is_chain else self.motors)
        if self.is_split:
            self._split()
        self.drives = self.motors + self.free

    def _chassis(self, shapes: dict[str, Any]) -> None:
        track = self.track
        if isinstance(track, c2d.ForceTrack):
            wheels = track.support == "wheels"
            count = len(shapes["circles"]) if wheels else 1
            self.free = count if wheels else 0
            skids = math.inf if wheels else track.skid_friction
            drives = [1 + i if wheels else -1 for i in range(count)]
            form = "round" if wheels else "fixed"
            for drive in drives:
                body = Body(carrier=0, lane=0, drive=drive, form=form, friction=skids)
                self.bodies.append(body)
            self._loop(0, shapes, 0.0, -1)
        elif isinstance(track, c2d.SegmentalTrack):
            each = pieces_of_a_shoe(self.robot)
            for number in range(int(shapes["bodies"][0])):
                shoe = Body(carrier=0, lane=0, drive=0, form="shoe", shoe=number // each)
                self.bodies.append(shoe)
            # The bodies inside a chain stand or turn freely; only a guide has friction.
            friction = math.inf if track.mechanism == "guide" else 0.0
            inside = Body(carrier=0, lane=0, drive=-1, form="fixed", friction=friction)
            self.bodies += [inside] * len(set(shapes["bodies"]))
            self._loop(0, shapes, self._over_the_gear(track, shapes), 0)
        else:
            self.motors = self._driven(0, shapes, 0)

    def _over_the_gear(self, track: c2d.SegmentalTrack, shapes: dict[str, Any]) -> float:
        """[m] Height from guide or wheels to the tips of the grousers."""
        outline = self.robot.outline
        if track.mechanism == "guide":
            return outline.rear_radius - float(shapes["circles"][0, 2])
        plate = track.plate_thickness
        if plate is None:
            half = 0.5 * outline.axle_distance
            ends = [[-half, 0.0, outline.rear_radius], [half, 0.0, outline.front_radius]]
            count = sum(1 for body in self.bodies if body.form == "shoe")
            count //= pieces_of_a_shoe(self.robot)
            plate = Hull(np.array(ends), outline.grouser_height).way_round.total / count / 16.0
        return float(plate) + outline.grouser_height

    def _arm(self, number: int, shapes: dict[str, Any]) -> None:
        assert self.robot.flippers is not None
        track = self.robot.flippers.track
        assert (self.track if track is None else track).kind != "force"
        if self.with_own_motors or self.is_chain:
            self.motors += self._driven(number, shapes, self.motors)
        else:
            self._driven(number, shapes, 0)

    def _driven(self, carrier: int, shapes: dict[str, Any], first: int) -> int:
        """Wheels or a belt on drives from a number on, and the number of these drives."""
        each = self.with_own_motors and not shapes["closed"]
        gears = shapes["gears"]
        count = len(set(shapes["bodies"]))
        for i in range(count):
            body = Body(carrier=carrier, lane=0, drive=first + i * each, form="round")
            if gears:
                *center, radius = shapes["circles"][i].tolist()
                body = replace(body, form="gear", center=tuple(center), radius=radius)
            self.bodies.append(body)
        grouser = Body(carrier=carrier, lane=0, drive=first, form="grouser")
        self.bodies += [grouser] * shapes["grousers"]
        self._loop(carrier, shapes, shapes["over"], first)
        return count if each else 1

    def _loop(self, carrier: int, shapes: dict[str, Any], over: float, drive: int) -> None:
        tips, roots = np.array(shapes["circles"]), np.array(shapes["circles"])
        tips[:, 2] += over
        for row, gear in zip(roots, shapes["gears"], strict=bool(shapes["gears"])):
            row[2] = np.hypot(*gear.T).min()
        bodies = tuple(int(body) for body in shapes["bodies"])
        loop = Loop(carrier=carrier, lane=0, tips=tips, roots=roots, bodies=bodies, drive=drive)
        self.loops.append(loop)

    def _split(self) -> None:
        """Both tracks side by side, each with half of the force."""
        count, motors = len(self.bodies), self.motors
        shoes = 1 + max((body.shoe for body in self.bodies), default=-1)
        assert self.free == 0

        def drive(number: int, side: int) -> int:
            if number < 0:
                return -1
            return 2 * number + side if self.is_chain else number + side * motors

        def shoe(number: int, side: int) -> int:
            return number if number < 0 else number + side * shoes

        both = (0, 1)
        self.loops = [
            replace(
                loop,
                lane=1 + side,
                drive=drive(loop.drive, side),
                bodies=tuple(body + side * count for body in loop.bodies),
            )
            for side in both
            for loop in self.loops
        ]
        self.bodies = [
            replace(body, lane=1 + side, drive=drive(body.drive, side), shoe=shoe(body.shoe, side))
            for side in both
            for body in self.bodies
        ]
        if self.track.kind != "force":  # a force pushes the whole robot
            self.motors *= 2
            self.limit *= 0.5

    def ground_friction(self, lane: int) -> float:
        """[-] Friction of the ground there; lanes have their own if they are distinguished."""
        terrain = self.terrain
        if not isinstance(terrain, Lanes):
            return float(terrain.friction)
        left, right = terrain.left.friction, terrain.right.friction
        middle = max(left, right) if terrain.middle is None else terrain.middle.friction
        return {0: left, 1: left, 2: right, 3: middle}[lane]

    def line_of(self, body: Body) -> Array:
        """The circles round which the line of this grouser's belt runs."""
        loop = next(x for x in self.loops if (x.carrier, x.lane) == (body.carrier, body.lane))
        return loop.roots
