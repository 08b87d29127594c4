"""The chain in pymunk: shoes on pivot joints, teeth that push lugs, a hull and discs as guides.

One sprocket has the motor, the other turns freely. Plates meet ground, hull and discs, lugs meet
teeth; shoes do not meet each other. Chipmunk's slop and decay are those of `engine_pymunk`.
"""

from __future__ import annotations

import math
import time
from collections.abc import Iterable
from typing import NamedTuple

import numpy as np
import pymunk

from benches.peers import chain_robot
from benches.peers.chain_robot import ChainRobot
from benches.peers.engine import Setting
from benches.peers.motion import Array

_GROUND, _PLATE, _CARRIER, _TOOTH, _LUG = 1, 2, 4, 8, 16
_MEETS = {
    _GROUND: _PLATE,
    _PLATE: _GROUND | _CARRIER,
    _CARRIER: _PLATE,
    _TOOTH: _LUG,
    _LUG: _TOOTH,
}


class World(NamedTuple):
    """A space, its chassis and its shoes."""

    space: pymunk.Space
    chassis: pymunk.Body
    shoes: list[pymunk.Body]

    def chassis_pose(self) -> tuple[float, float, float]:
        """Read the pose of the chassis [m], [m], [rad]."""
        return (*self.chassis.position, self.chassis.angle)

    def shoe_poses(self) -> Array:
        """Read the poses of the shoes [m], [m], [rad], shape (shoes, 3)."""
        return np.array([(*shoe.position, shoe.angle) for shoe in self.shoes])

    def advance(self, steps: int, time_step: float) -> float:
        """[s] Advance, and return the wall time."""
        step = self.space.step
        start = time.perf_counter()
        for _ in range(steps):
            step(time_step)
        return time.perf_counter() - start


def build(robot: ChainRobot, ground: Iterable[Array], setting: Setting, shift: float) -> World:
    """Build robot and ground; the robot starts `shift` [m] further back."""
    space = pymunk.Space(threaded=False)
    space.gravity = (0.0, -9.81)
    space.iterations = setting.iterations
    space.collision_slop = 1e-4 if setting.tuned else 1e-3
    if setting.tuned:
        space.collision_bias = math.exp(-60.0)
    for box in ground:
        _add(pymunk.Poly(space.static_body, box.tolist()), space, _GROUND, chain_robot.FRICTION)
    center = np.array([-shift, robot.radius + chain_robot.DROP])
    chassis = _body(space, robot.hull_mass, robot.hull_inertia, center)
    _add(pymunk.Poly(chassis, robot.hull().tolist()), space, _CARRIER, chain_robot.HULL_FRICTION)
    half = robot.axle_distance / 2.0
    for x, is_driven in ((-half, True), (half, False)):
        at = center + np.array([x, 0.0])
        sprocket = _body(space, robot.sprocket_mass, robot.sprocket_inertia, at)
        disc = pymunk.Circle(sprocket, robot.disc_radius())
        _add(disc, space, _CARRIER, chain_robot.DISC_FRICTION)
        for tooth in robot.teeth():
            _add(pymunk.Poly(sprocket, tooth.tolist()), space, _TOOTH, chain_robot.TOOTH_FRICTION)
        _pin(pymunk.PivotJoint(chassis, sprocket, (x, 0.0), (0.0, 0.0)), space, setting)
        if is_driven:
            # Chipmunk's rate is that of a relative to b.
            motor = pymunk.SimpleMotor(chassis, sprocket, -robot.sprocket_speed)
            motor.max_force = chain_robot.TORQUE
            space.add(motor)
    shoes = []
    for x, y, angle in robot.shoes():
        shoe = _body(space, robot.shoe_mass, robot.shoe_inertia, center + np.array([x, y]))
        shoe.angle = angle
        _add(pymunk.Poly(shoe, robot.plate().tolist()), space, _PLATE, 1.0)
        _add(pymunk.Poly(shoe, robot.lug().tolist()), space, _LUG, 1.0)
        shoes.append(shoe)
    ends = (robot.pitch / 2.0, 0.0), (-robot.pitch / 2.0, 0.0)
    for shoe, following in zip(shoes, [*shoes[1:], shoes[0]], strict=True):
        _pin(pymunk.PivotJoint(shoe, following, *ends), space, setting)
    return World(space, chassis, shoes)


def _body(space: pymunk.Space, mass: float, inertia: float, at: Array) -> pymunk.Body:
    body = pymunk.Body(mass, inertia)
    body.position = (float(at[0]), float(at[1]))
    space.add(body)
    return body


def _pin(pin: pymunk.PivotJoint, space: pymunk.Space, setting: Setting) -> None:
    if setting.tuned:
        pin.error_bias = math.exp(-60.0)
    space.add(pin)


def _add(shape: pymunk.Shape, space: pymunk.Space, kind: int, friction: float) -> None:
    shape.friction = friction
    shape.filter = pymunk.ShapeFilter(categories=kind, mask=_MEETS[kind])
    space.add(shape)
