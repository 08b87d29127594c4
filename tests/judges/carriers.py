"""Carriers of tracks for the second judge: the chassis and its arms at samples of a run."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

import crawler2d as c2d
from tests.judges.geometry import Array


def turned(local: Array, angle: Array) -> Array:
    """Vectors turned counter-clockwise."""
    c, s = np.cos(angle), np.sin(angle)
    x, y = local[..., 0], local[..., 1]
    return np.asarray(np.stack([c * x - s * y, s * x + c * y], axis=-1))


@dataclass(frozen=True)
class Arm:
    """Both arms at one end; lengths in m, masses in kg."""

    pivot: Array
    middle: Array
    """From the pivot to its middle where its angle is 0; there its mass is."""
    sign: float
    """-1: upwards is clockwise."""
    mass: float
    torque: float
    """[N m] That its motors have at most, or gears hold that lock themselves."""


def arms_of(robot: c2d.Robot) -> list[Arm]:
    """Those of a robot, the front first."""
    flippers = robot.flippers
    if flippers is None:
        return []
    half = 0.5 * robot.outline.axle_distance
    ends = {"front": (1.0,), "rear": (-1.0,), "both": (1.0, -1.0)}[flippers.ends]
    return [
        Arm(
            pivot=np.array([sign * half, 0.0]),
            middle=np.array([0.5 * sign * flippers.length, 0.0]),
            sign=sign,
            mass=2.0 * flippers.mass,
            torque=math.inf if flippers.self_locking else 2.0 * flippers.torque_limit,
        )
        for sign in ends
    ]


class Carriers:
    """Chassis and arms at samples of a run, each with its own frame."""

    def __init__(self, run: c2d.Run, samples: NDArray[np.bool_]) -> None:
        robot = run.scenario.robot
        self.arms = arms_of(robot)
        self.mass, self.center = robot.mass, np.array(robot.center_of_mass)
        pose = np.column_stack([run.position, run.chassis_angle, run.flipper_angles])[samples]
        self.poses = pose
        """Rows of x, y, chassis angle, and the angle of each arm."""
        self.mean = pose.mean(axis=0)

    def frame(self, carrier: int, poses: Array) -> tuple[Array, Array]:
        """[m], [rad] Origin and angle of the frame of a carrier for rows of poses."""
        poses = np.atleast_2d(poses)
        origin, angle = poses[:, :2], poses[:, 2]
        if carrier == 0:
            return origin, angle
        arm = self.arms[carrier - 1]
        own = angle + arm.sign * poses[:, 2 + carrier]
        return origin + turned(arm.pivot, angle) + turned(arm.middle, own), own

    def pivot(self, carrier: int, poses: Array) -> Array:
        """[m] Position of an arm's pivot on the chassis."""
        poses = np.atleast_2d(poses)
        return np.asarray(poses[:, :2] + turned(self.arms[carrier - 1].pivot, poses[:, 2]))

    def center_of_mass(self, poses: Array) -> Array:
        """[m] Centre of mass of the whole robot, which moves with the arms."""
        poses = np.atleast_2d(poses)
        center = poses[:, :2] + turned(self.center, poses[:, 2])
        for number, arm in enumerate(self.arms, 1):
            level = turned(arm.pivot + arm.middle, poses[:, 2]) + poses[:, :2]
            now, _ = self.frame(number, poses)
            center = center + arm.mass / self.mass * (now - level)
        return np.asarray(center)
