"""The task of `FlipperClimb` in Chipmunk as users would write it: belts are moving surfaces."""

from __future__ import annotations

import math
from typing import Any

import gymnasium
import numpy as np
import pymunk
from numpy.typing import NDArray

from benches.adapters.chipmunk import Plane
from crawler2d.parameters.robot import Robot

__all__ = ["ChipmunkClimb"]

_TIME_STEP, _ITERATIONS, _SLOP = 1e-3, 20, 1e-4
"""[s], [-], [m] Medium settings of the tuned engine in the other benchmarks."""


class ChipmunkClimb(gymnasium.Env[NDArray[np.float32], NDArray[np.float32]]):
    """A robot with flippers at a step, with the observation and action of our environment.

    Parameters
    ----------
    robot : Robot
        Masses and sizes; its tracks slide over their own surfaces, as belts do.
    height : float
        [m] Of the step.
    """

    def __init__(self, robot: Robot, height: float) -> None:
        self._robot, self._height = robot, height
        self.action_space = gymnasium.spaces.Box(-1.0, 1.0, (3,), np.float32)
        self.observation_space = gymnasium.spaces.Box(-100.0, 100.0, (7,), np.float32)

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[NDArray[np.float32], dict[str, Any]]:
        """Build the world."""
        super().reset(seed=seed, options=options)
        robot, flippers = self._robot, self._robot.flippers
        assert flippers is not None
        outline = robot.outline
        half, radius = outline.axle_distance / 2.0, outline.front_radius
        plane = Plane(_ITERATIONS, _SLOP, is_tight=True)
        friction, h = 0.9, self._height
        plane.ground([(-3.0, -1.0), (0.0, -1.0), (0.0, 0.0), (-3.0, 0.0)], friction)
        plane.ground([(0.0, -1.0), (4.0, -1.0), (4.0, h), (0.0, h)], friction)
        x = -half - radius - 0.1 + self.np_random.uniform(-0.1, 0.0)
        arms_mass = 2.0 * flippers.mass
        mass = robot.mass - 2.0 * arms_mass
        chassis = plane.body(mass, robot.moment_of_inertia * mass / robot.mass, (x, radius))
        chassis.center_of_gravity = robot.center_of_mass
        self._tracks = [pymunk.Segment(chassis, (-half, 0.0), (half, 0.0), radius)]
        self._motors, self._arms = [], []
        for side in (1.0, -1.0):
            angle = side * flippers.angle if side > 0 else math.pi - flippers.angle
            out = np.array([math.cos(angle), math.sin(angle)])
            pivot = np.array([x + side * half, radius])
            inertia = arms_mass * flippers.length**2 / 12.0
            arm = plane.body(arms_mass, inertia, pivot + 0.5 * flippers.length * out, angle)
            root, tip = (-flippers.length / 2.0, 0.0), (flippers.length / 2.0, 0.0)
            self._tracks.append(pymunk.Segment(arm, root, tip, flippers.tip_radius))
            plane.pin(chassis, arm, (side * half, 0.0), root)
            self._motors.append(plane.motor(chassis, arm, 2.0 * flippers.torque_limit))
            self._arms.append((arm, side, angle))
        for track in self._tracks:
            plane.shape(track, 2)
        self._plane, self._chassis, self._time = plane, chassis, 0.0
        self._advance = plane.steps(_TIME_STEP)
        return self._observation(), {}

    def step(
        self, action: NDArray[np.float32]
    ) -> tuple[NDArray[np.float32], float, bool, bool, dict[str, Any]]:
        """Drive on for 50 ms."""
        flippers = self._robot.flippers
        assert flippers is not None
        for track in self._tracks:
            track.surface_velocity = (float(0.39 * action[0]), 0.0)
        for motor, (_, side, _), given in zip(self._motors, self._arms, action[1:], strict=True):
            motor.rate = -side * flippers.rate_limit * float(given)
        before = self._chassis.position.x
        self._advance(50)
        self._time += 0.05
        x, pitch = self._chassis.position.x, self._chassis.angle
        cleared = x > self._robot.outline.axle_distance and abs(pitch) < 0.1
        tipped = abs(pitch) > math.pi / 2.0
        observation = self._observation()
        return observation, x - before, cleared or tipped, self._time >= 10.0, {}

    def _observation(self) -> NDArray[np.float32]:
        chassis = self._chassis
        angles = [side * (arm.angle - chassis.angle) for arm, side, _ in self._arms]
        torques = [motor.impulse / _TIME_STEP for motor in self._motors]
        track = self._tracks[0].surface_velocity[0]
        values = [chassis.angle, chassis.angular_velocity, track, *angles, *torques]
        return np.array(values, np.float32)
