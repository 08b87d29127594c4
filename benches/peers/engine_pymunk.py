"""Chipmunk through pymunk.

Chipmunk's lengths are meant to be pixels: its slop of 0.1 would let a robot sink by 0.1 m. The
defaults here are its own for a metre of 100 pixels, which only scales the slop. The tuned setting
has a slop of 0.1 mm, and lets overlap and pin gaps decay by 1/e in 17 ms instead of 160 ms. The
rest depends on steps and iterations, which the search varies. Chipmunk multiplies friction, so the
robot's is 1. It warm-starts and has no substeps.
"""

from __future__ import annotations

import math
import time
from collections.abc import Sequence

import pymunk

from benches.peers.engine import Setting
from benches.peers.motion import Motion
from benches.peers.scenes import Body, Scene

_GROUND, _ROBOT = 1, 2
_FILTERS = {
    _GROUND: pymunk.ShapeFilter(categories=_GROUND, mask=_ROBOT),
    _ROBOT: pymunk.ShapeFilter(categories=_ROBOT, mask=_GROUND),
}


class Pymunk:
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

    def wall_time(self, scene: Scene, setting: Setting, duration: float) -> float:
        """[s] Time a run."""
        space, _ = build(scene, setting)
        step, dt = space.step, setting.time_step
        start = time.perf_counter()
        for _ in range(setting.steps(duration)):
            step(dt)
        return time.perf_counter() - start

    def record(self, scene: Scene, setting: Setting, duration: float, interval: float) -> Motion:
        """Run and sample all poses."""
        space, bodies = build(scene, setting)
        stride, dt = setting.stride(interval), setting.time_step
        times, poses = [], []
        for step in range(setting.steps(duration) + 1):
            if step > 0:
                space.step(dt)
            if step % stride == 0:
                times.append(step * dt)
                poses.append([(*body.position, body.angle) for body in bodies])
        return Motion.of(times, poses)


def build(scene: Scene, setting: Setting) -> tuple[pymunk.Space, list[pymunk.Body]]:
    """Build the world of a scene; the chassis is the first body."""
    space = pymunk.Space(threaded=False)
    space.gravity = (0.0, -9.81)
    space.iterations = setting.iterations
    space.collision_slop = 1e-4 if setting.tuned else 1e-3
    if setting.tuned:
        space.collision_bias = math.exp(-60.0)
    for box in scene.boxes:
        _finish(pymunk.Poly(space.static_body, box.tolist()), _GROUND, scene.friction, space)
    bodies = [_body(body, space) for body in scene.bodies]
    for joint in scene.joints:
        a, b = bodies[joint.a], bodies[joint.b]
        pin = pymunk.PivotJoint(a, b, joint.pa, joint.pb)
        if setting.tuned:
            pin.error_bias = math.exp(-60.0)
        # Chipmunk's rate is that of a relative to b.
        motor = pymunk.SimpleMotor(a, b, -joint.speed)
        motor.max_force = joint.torque
        space.add(pin, motor)
    return space, bodies


def _body(data: Body, space: pymunk.Space) -> pymunk.Body:
    body = pymunk.Body(data.mass, data.inertia)
    body.position = (data.x, data.y)
    body.angle = data.angle
    space.add(body)
    if data.radius > 0.0:
        _finish(pymunk.Circle(body, data.radius), _ROBOT, 1.0, space)
    for polygon in data.polygons:
        _finish(pymunk.Poly(body, polygon.tolist()), _ROBOT, 1.0, space)
    return body


def _finish(shape: pymunk.Shape, category: int, friction: float, space: pymunk.Space) -> None:
    shape.friction = friction
    shape.filter = _FILTERS[category]
    space.add(shape)
