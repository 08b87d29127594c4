"""Chipmunk through pymunk: the same bodies in the plane, both sides as one."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
import pymunk

from benches.engines.engine import Scene
from crawler2d.model_tree import Array, Pose

__all__ = ["Pymunk"]

_GROUND, _ROBOT = 1, 2
_FILTERS = {
    _GROUND: pymunk.ShapeFilter(categories=_GROUND, mask=_ROBOT),
    _ROBOT: pymunk.ShapeFilter(categories=_ROBOT, mask=_GROUND),
}
_SLOP = 2e-5  # [m] Depth that is left alone; Chipmunk's own 0.1 is meant for pixels.
_BIAS = math.exp(-60.0)  # [-] of an overlap or a gap that is left after a second
_SIDES = 2.0


class Pymunk:
    """Chipmunk, which multiplies frictions: the robot's is 1.

    One motor a track is a motor on the first wheel, and gears from each wheel to the next.

    Parameters
    ----------
    time_step : float
        [s] Of a step.
    iterations, geared : int
        Of its solver, without and with gears.
    """

    version = f"pymunk {pymunk.version}"
    in_space = False

    def __init__(self, time_step: float = 5e-4, *, iterations: int = 60, geared: int = 300) -> None:
        self.time_step = time_step
        self.iterations = iterations
        self.geared = geared

    def world(self, scene: Scene) -> PymunkWorld:
        """Build a world."""
        is_coupled = scene.robot.is_coupled
        return PymunkWorld(scene, self.time_step, self.geared if is_coupled else self.iterations)


class PymunkWorld:
    """A robot on its ground in Chipmunk."""

    def __init__(self, scene: Scene, time_step: float, iterations: int) -> None:
        self._step = time_step
        self._space = pymunk.Space(threaded=False)
        self._space.gravity = (0.0, -9.81)
        self._space.iterations = iterations
        self._space.collision_slop = _SLOP
        self._space.collision_bias = _BIAS
        for block in scene.ground:
            (x, _, z), (length, _, height) = block.center, block.size
            corners = [
                (x + 0.5 * length * along, z + 0.5 * height * up)
                for along, up in ((-1, -1), (1, -1), (1, 1), (-1, 1))
            ]
            shape = pymunk.Poly(self._space.static_body, corners)
            self._add_shape(shape, _GROUND, scene.friction)
        chassis, *links = scene.robot.plain()
        self._center = np.array(chassis["center"])[[0, 2]]
        self._start, self._angle = np.array([scene.x, scene.z]), scene.angle
        self._chassis = self._body(chassis, 1.0, 0.0)
        self._motors: list[tuple[pymunk.SimpleMotor, float]] = []
        before: pymunk.Body | None = None
        for link in links:
            if not link["name"].startswith("left"):
                continue
            body = self._body(link, _SIDES, -scene.phase / link["radius"])
            at = np.array(link["axle"])[[0, 2]]
            pin = pymunk.PivotJoint(self._chassis, body, tuple(at - self._center), (0.0, 0.0))
            pin.error_bias = _BIAS
            self._space.add(pin)
            if before is None or not scene.robot.is_coupled:
                motor = pymunk.SimpleMotor(self._chassis, body, 0.0)
                motor.max_force = _SIDES * link["torque"]
                self._space.add(motor)
                self._motors.append((motor, link["radius"]))
            else:
                gear = pymunk.GearJoint(before, body, body.angle - before.angle, 1.0)
                gear.error_bias = _BIAS
                self._space.add(gear)
            before = body

    def _body(self, link: dict[str, Any], sides: float, angle: float) -> pymunk.Body:
        center = np.array(link["center"])[[0, 2]]
        body = pymunk.Body(sides * link["mass"], sides * link["inertia"][4])
        cos, sin = math.cos(self._angle), math.sin(self._angle)
        turned = np.array([[cos, -sin], [sin, cos]]) @ center
        body.position = tuple(self._start + turned)
        body.angle = self._angle + angle
        self._space.add(body)
        for data in link["shapes"]:
            place = np.array(data["place"])[[0, 2]] - center
            if data["kind"] == "cylinder":
                shape: pymunk.Shape = pymunk.Circle(body, data["radius"], tuple(place))
            else:
                shape = pymunk.Poly(body, (place + _corners(data)).tolist())
            self._add_shape(shape, _ROBOT, 1.0)
        return body

    def _add_shape(self, shape: pymunk.Shape, category: int, friction: float) -> None:
        shape.friction = friction
        shape.filter = _FILTERS[category]
        self._space.add(shape)

    def advance(self, speeds: Sequence[float]) -> None:
        """Take a step for each set-point."""
        for speed in speeds:
            for motor, radius in self._motors:
                motor.rate = speed / radius  # that of the chassis relative to the wheel
            self._space.step(self._step)

    def pose(self) -> Pose:
        """Return where the chassis frame is."""
        cos, sin = math.cos(self._chassis.angle), math.sin(self._chassis.angle)
        x, z = self._chassis.position
        x -= cos * self._center[0] - sin * self._center[1]
        z -= sin * self._center[0] + cos * self._center[1]
        turn = np.array([[cos, 0.0, -sin], [0.0, 1.0, 0.0], [sin, 0.0, cos]])
        return Pose(place=np.array([x, 0.0, z]), turn=turn)

    def close(self) -> None:
        """Free what the world holds."""


def _corners(box: dict[str, Any]) -> Array:
    """[m] Return the corners of a box in side view about its middle, shape (4, 2)."""
    turn = np.array(box["turn"]).reshape(3, 3)
    along = 0.5 * box["size"][0] * turn[[0, 2], 0]
    up = 0.5 * box["size"][2] * turn[[0, 2], 2]
    return np.array([-along - up, along - up, along + up, up - along])
