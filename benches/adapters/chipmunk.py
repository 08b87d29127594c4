"""Chipmunk through pymunk: plane scenes, robots from space in side view, and chains of shoes.

Chipmunk's lengths are meant to be pixels: its slop of 0.1 would let a robot sink by 0.1 m. The
defaults of `Pymunk` are Chipmunk's for a metre of 100 pixels, which only scales the slop. The tuned
setting has a slop of 0.1 mm, and lets overlap and pin gaps decay by 1/e in 17 ms instead of 160 ms.
Everything else depends on steps and iterations, which the search varies. Chipmunk multiplies
friction, so the robot's is 1. It warm-starts and has no substeps.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import pymunk

from benches.adapters import planar, space
from benches.adapters.planar import Array, Setting
from crawler2d.model_tree import Pose, from_rpy

if TYPE_CHECKING:
    from benches.peers.chains import ChainRobot


_BIAS = math.exp(-60.0)  # [-] of an overlap or a gap that is left after a second
_GROUND, _ROBOT = 1, 2
_MEETS = {_GROUND: _ROBOT, _ROBOT: _GROUND}


class Plane:
    """A space with its ground, to which bodies, pins and motors are added.

    Parameters
    ----------
    iterations : int
        Of the solver.
    slop : float
        [m] Depth up to which contacts are left alone.
    is_tight : bool
        Whether overlaps and gaps decay fast; else as by default.
    meets : mapping of int to int
        Which kinds of shapes a kind meets, as bits.
    """

    def __init__(
        self, iterations: int, slop: float, *, is_tight: bool, meets: Mapping[int, int] = _MEETS
    ) -> None:
        self.space = pymunk.Space(threaded=False)
        self.space.gravity = (0.0, -9.81)
        self.space.iterations = iterations
        self.space.collision_slop = slop
        if is_tight:
            self.space.collision_bias = _BIAS
        self._is_tight, self._meets = is_tight, meets

    @classmethod
    def at(cls, setting: Setting, meets: Mapping[int, int] = _MEETS) -> Plane:
        """Return a plane at a setting."""
        slop = 1e-4 if setting.tuned else 1e-3
        return cls(setting.iterations, slop, is_tight=setting.tuned, meets=meets)

    def ground(self, corners: Any, friction: float) -> None:
        """Add a convex piece of ground."""
        self.shape(pymunk.Poly(self.space.static_body, corners), _GROUND, friction)

    def body(
        self, mass: float, inertia: float, place: Iterable[float], angle: float = 0.0
    ) -> pymunk.Body:
        """Add a body."""
        body = pymunk.Body(mass, inertia)
        x, y = map(float, place)
        body.position = (x, y)
        body.angle = angle
        self.space.add(body)
        return body

    def shape(self, shape: pymunk.Shape, kind: int, friction: float = 1.0) -> None:
        """Add a shape of a body."""
        shape.friction = friction
        shape.filter = pymunk.ShapeFilter(categories=kind, mask=self._meets[kind])
        self.space.add(shape)

    def pin(self, a: pymunk.Body, b: pymunk.Body, pa: Any, pb: Any = (0.0, 0.0)) -> None:
        """Add a pin through a point of each body."""
        self._add_joint(pymunk.PivotJoint(a, b, tuple(pa), pb))

    def gear(self, a: pymunk.Body, b: pymunk.Body) -> None:
        """Let two bodies turn equally."""
        self._add_joint(pymunk.GearJoint(a, b, b.angle - a.angle, 1.0))

    def _add_joint(self, joint: pymunk.Constraint) -> None:
        if self._is_tight:
            joint.error_bias = _BIAS
        self.space.add(joint)

    def motor(
        self, a: pymunk.Body, b: pymunk.Body, torque: float, speed: float = 0.0
    ) -> pymunk.SimpleMotor:
        """Add a motor that turns b relative to a."""
        motor = pymunk.SimpleMotor(a, b, -speed)  # Chipmunk's rate is that of a relative to b
        motor.max_force = torque
        self.space.add(motor)
        return motor

    def steps(self, time_step: float) -> Callable[[int], None]:
        """Return a function that takes a number of steps."""
        step = self.space.step

        def advance(count: int) -> None:
            for _ in range(count):
                step(time_step)

        return advance


class Pymunk(planar.SteppedEngine):
    """Chipmunk's 2D dynamics."""

    name = "pymunk"
    version = pymunk.version
    defaults = Setting(1 / 60, iterations=10, tuned=False)
    grid: Sequence[Setting] = [
        Setting(dt * 1e-3, iterations=iterations)
        for dt in (8.0, 4.0, 2.0, 1.0, 0.5, 0.25)
        for iterations in (5, 10, 20, 40, 80)
    ]
    finest = Setting(0.25e-3, iterations=80)
    next_finest = Setting(0.5e-3, iterations=40)

    def start(self, scene: planar.Scene, setting: Setting) -> planar.Started:
        """Build a world."""
        plane, bodies = build(scene, setting)
        advance = plane.steps(setting.time_step)
        return advance, lambda: [(*body.position, body.angle) for body in bodies]


def build(scene: planar.Scene, setting: Setting) -> tuple[Plane, list[pymunk.Body]]:
    """Build the world of a scene; the chassis is the first body."""
    plane = Plane.at(setting)
    for box in scene.boxes:
        plane.ground(box.tolist(), scene.friction)
    bodies = []
    for data in scene.bodies:
        body = plane.body(data.mass, data.inertia, (data.x, data.y), data.angle)
        if data.radius > 0.0:
            plane.shape(pymunk.Circle(body, data.radius), _ROBOT)
        for polygon in data.polygons:
            plane.shape(pymunk.Poly(body, polygon.tolist()), _ROBOT)
        bodies.append(body)
    for joint in scene.joints:
        a, b = bodies[joint.a], bodies[joint.b]
        plane.pin(a, b, joint.pa, joint.pb)
        plane.motor(a, b, joint.torque, joint.speed)
    return plane, bodies


_SLOP = 2e-5  # [m]
_SIDES = 2.0


@dataclass(frozen=True, kw_only=True)
class Chipmunk:
    """Chipmunk for robots from space: the same bodies in the plane, both sides as one.

    One motor a track is a motor on the first wheel, and gears from each wheel to the next.

    Parameters
    ----------
    time_step : float
        [s] Of a step.
    iterations, geared : int
        Of its solver, without and with gears.
    """

    time_step: float = 5e-4
    iterations: int = 60
    geared: int = 300

    version = f"pymunk {pymunk.version}"
    in_space = False

    def world(self, scene: space.Scene) -> ChipmunkWorld:
        """Build a world."""
        return ChipmunkWorld(scene, self)


class ChipmunkWorld(space.World):
    """A robot on its ground in Chipmunk."""

    def __init__(self, scene: space.Scene, setting: Chipmunk) -> None:
        is_coupled = scene.robot.is_coupled
        iterations = setting.geared if is_coupled else setting.iterations
        self._plane = plane = Plane(iterations, _SLOP, is_tight=True)
        self._step = plane.steps(setting.time_step)
        for block in scene.ground:
            (x, _, z), (length, _, height) = block.center, block.size
            corners = [
                (x + 0.5 * length * along, z + 0.5 * height * up)
                for along, up in ((-1, -1), (1, -1), (1, 1), (-1, 1))
            ]
            plane.ground(corners, scene.friction)
        chassis, *links = scene.robot.bodies
        self._center = np.array(chassis["center"])[[0, 2]]
        self._chassis = self._body(scene, chassis, 1.0, 0.0)
        self._motors: list[tuple[pymunk.SimpleMotor, float]] = []
        before: pymunk.Body | None = None
        for link in links:
            if not link["name"].startswith("left"):
                continue
            body = self._body(scene, link, _SIDES, -scene.phase / link["radius"])
            plane.pin(self._chassis, body, np.array(link["axle"])[[0, 2]] - self._center)
            if before is None or not is_coupled:
                motor = plane.motor(self._chassis, body, _SIDES * link["torque"])
                self._motors.append((motor, link["radius"]))
            else:
                plane.gear(before, body)
            before = body

    def _body(
        self, scene: space.Scene, link: dict[str, Any], sides: float, angle: float
    ) -> pymunk.Body:
        center = np.array(link["center"])[[0, 2]]
        cos, sin = math.cos(scene.angle), math.sin(scene.angle)
        place = np.array([scene.x, scene.z]) + np.array([[cos, -sin], [sin, cos]]) @ center
        mass, inertia = sides * link["mass"], sides * link["inertia"][4]
        body = self._plane.body(mass, inertia, place, scene.angle + angle)
        for data in link["shapes"]:
            place = np.array(data["place"])[[0, 2]] - center
            if data["kind"] == "cylinder":
                self._plane.shape(pymunk.Circle(body, data["radius"], tuple(place)), _ROBOT)
            else:
                self._plane.shape(pymunk.Poly(body, (place + _corners(data)).tolist()), _ROBOT)
        return body

    def advance(self, speeds: Sequence[float]) -> None:
        """Take a step for each set-point."""
        for speed in speeds:
            for motor, radius in self._motors:
                motor.rate = speed / radius  # that of the chassis relative to the wheel
            self._step(1)

    def pose(self) -> Pose:
        """Return the pose of the chassis frame."""
        cos, sin = math.cos(self._chassis.angle), math.sin(self._chassis.angle)
        x, z = self._chassis.position
        x -= cos * self._center[0] - sin * self._center[1]
        z -= sin * self._center[0] + cos * self._center[1]
        return from_rpy((0.0, -self._chassis.angle, 0.0), (x, 0.0, z))


def _corners(box: dict[str, Any]) -> Array:
    """[m] Return the corners of a box in side view about its middle, shape (4, 2)."""
    turn = np.array(box["turn"]).reshape(3, 3)
    along = 0.5 * box["size"][0] * turn[[0, 2], 0]
    up = 0.5 * box["size"][2] * turn[[0, 2], 2]
    return np.array([-along - up, along - up, along + up, up - along])


_PLATE, _CARRIER, _TOOTH, _LUG = 2, 4, 8, 16
_CHAIN_MEETS = {
    _GROUND: _PLATE,
    _PLATE: _GROUND | _CARRIER,
    _CARRIER: _PLATE,
    _TOOTH: _LUG,
    _LUG: _TOOTH,
}


@dataclass(frozen=True)
class Chain:
    """A robot on a chain of shoes: its step function, chassis and shoes."""

    advance: Callable[[int], None]
    chassis: pymunk.Body
    shoes: list[pymunk.Body]

    def position(self) -> tuple[float, float]:
        """[m] Return the position of the chassis."""
        x, y = self.chassis.position
        return x, y

    def shoe_poses(self) -> Array:
        """Return the poses of the shoes [m], [m], [rad], shape (shoes, 3)."""
        return np.array([(*shoe.position, shoe.angle) for shoe in self.shoes])


def build_chain(
    robot: ChainRobot, ground: Iterable[Array], setting: Setting, shift: float
) -> Chain:
    """Build shoes on pivot joints, teeth that push lugs, a hull and discs as guides.

    One sprocket has the motor, the other turns freely. Plates meet ground, hull and discs, lugs
    meet teeth; shoes do not meet each other. The robot starts `shift` [m] further back.
    """
    plane = Plane.at(setting, _CHAIN_MEETS)
    for box in ground:
        plane.ground(box.tolist(), robot.friction)
    center = np.array([-shift, robot.radius + robot.drop])
    chassis = plane.body(robot.hull_mass, robot.hull_inertia, center)
    plane.shape(pymunk.Poly(chassis, robot.hull().tolist()), _CARRIER, robot.hull_friction)
    half = robot.axle_distance / 2.0
    for x, is_driven in ((-half, True), (half, False)):
        at = center + np.array([x, 0.0])
        sprocket = plane.body(robot.sprocket_mass, robot.sprocket_inertia, at)
        plane.shape(pymunk.Circle(sprocket, robot.disc_radius()), _CARRIER, robot.disc_friction)
        for tooth in robot.teeth():
            plane.shape(pymunk.Poly(sprocket, tooth.tolist()), _TOOTH, robot.tooth_friction)
        plane.pin(chassis, sprocket, (x, 0.0))
        if is_driven:
            plane.motor(chassis, sprocket, robot.torque, robot.sprocket_speed)
    shoes = []
    for x, y, angle in robot.shoes():
        at = center + np.array([x, y])
        shoe = plane.body(robot.shoe_mass, robot.shoe_inertia, at, angle)
        plane.shape(pymunk.Poly(shoe, robot.plate().tolist()), _PLATE)
        plane.shape(pymunk.Poly(shoe, robot.lug().tolist()), _LUG)
        shoes.append(shoe)
    ends = (robot.pitch / 2.0, 0.0), (-robot.pitch / 2.0, 0.0)
    for shoe, following in zip(shoes, [*shoes[1:], shoes[0]], strict=True):
        plane.pin(shoe, following, *ends)
    return Chain(plane.steps(setting.time_step), chassis, shoes)
