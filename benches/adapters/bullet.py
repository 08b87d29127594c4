"""Bullet, through PyBullet: multibodies, whose contacts an iterative solver satisfies.

Bullet multiplies the coefficients of friction of two surfaces: that of the robot is 1. Its readers
make a prism of 32 sides of every cylinder, except that of URDF if a flag asks for cylinders, and
give shapes a margin, by which edges are rounded.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from importlib.metadata import version
from typing import Any

import numpy as np
import pybullet

from benches.adapters.ground import Box
from benches.adapters.robots import AMPLE
from benches.adapters.space import Scene, Touch, World, check
from crawler2d.model_tree import Pose

_NEAR, _RESIDUAL = 0.002, 1e-7  # [m], [-]
_TOUCH = 1e-5  # [m] precision of a pose without overlap
_UP = 0.05  # [-] upward part, without which the robot would alternate between two upright faces


@dataclass(frozen=True, slots=True, kw_only=True)
class Bullet:
    """Bullet at a setting, by default a fine one.

    Parameters
    ----------
    time_step : float
        [s] Of a step.
    iterations : int
        Of its solver.
    is_default : bool
        Whether all else is as PyBullet has it: cylinders are prisms, contacts are kept up to 20 mm
        apart, and bodies are damped. Else contacts are kept up to 2 mm apart, and nothing is
        damped.
    is_round : bool
        Whether cylinders are cylinders; only URDF can have that.
    is_cone : bool
        Whether friction is limited as a vector; else in two directions, each by itself. The vector
        of a light wheel that slides may turn across, which leaves too little in the plane; with two
        limits it may get too much.
    """

    time_step: float = 1e-3
    iterations: int = 200
    is_default: bool = False
    is_round: bool = True
    is_cone: bool = True

    version = f"Bullet {version('pybullet')}"
    in_space = True

    def world(self, scene: Scene) -> BulletWorld:
        """Build a world."""
        return BulletWorld(scene, self)

    def clear(self, scene: Scene) -> Scene:
        """Return a scene whose robot is moved forward and up until it overlaps no ground."""
        world = self.world(scene)
        forward, up = world.resolve_overlap()
        world.close()
        return replace(scene, x=scene.x + forward, z=scene.z + up)


class BulletWorld(World):
    """A robot on its ground in Bullet."""

    def __init__(self, scene: Scene, setting: Bullet) -> None:
        self._robot = robot = scene.robot
        self._client = pybullet.connect(pybullet.DIRECT)
        self._is_default = setting.is_default
        self._call("setGravity", 0.0, 0.0, -9.81)
        more = {
            "contactBreakingThreshold": _NEAR,
            "solverResidualThreshold": _RESIDUAL,
            "enableConeFriction": int(setting.is_cone),
        }
        self._call(
            "setPhysicsEngineParameter",
            fixedTimeStep=setting.time_step,
            numSolverIterations=setting.iterations,
            deterministicOverlappingPairs=1,
            **({} if setting.is_default else more),
        )
        self._ground = [self._block(block, scene.friction) for block in scene.ground]
        flags = pybullet.URDF_USE_INERTIA_FROM_FILE
        if setting.is_round and not setting.is_default:
            flags |= pybullet.URDF_USE_IMPLICIT_CYLINDER
        with robot.path() as path:
            if path.endswith(".sdf"):
                (self._body,) = self._call("loadSDF", path)
            else:
                self._body = self._call("loadURDF", path, flags=flags)
        joints = range(self._call("getNumJoints", self._body))
        infos = [self._call("getJointInfo", self._body, joint) for joint in joints]
        self._links = {info[12].decode(): info[0] for info in infos}
        for link in (-1, *joints):
            self._surface(self._body, link, 1.0)
        self._held = {self._links[name]: angle for name, angle in robot.held.items()}
        self._wheels = [(self._links[wheel.link], wheel) for wheel in robot.wheels]
        self._hold([info[0] for info in infos if info[2] == pybullet.JOINT_REVOLUTE])
        self._place(scene)
        mass = sum(self._call("getDynamicsInfo", self._body, i)[0] for i in (-1, *joints))
        axles = {
            wheel.link: self._call("getLinkState", self._body, joint)[4]
            for joint, wheel in self._wheels
        }
        check(robot, mass, axles, self.pose())
        for joint, wheel in self._wheels:
            self._call("resetJointState", self._body, joint, wheel.turn(scene.phase))

    def _call(self, name: str, *arguments: Any, **more: Any) -> Any:
        return getattr(pybullet, name)(*arguments, physicsClientId=self._client, **more)

    def _surface(self, body: int, link: int, friction: float) -> None:
        zero = ("spinningFriction", "rollingFriction", "restitution")
        undamped = ("linearDamping", "angularDamping", "jointDamping")
        more = {} if self._is_default else dict.fromkeys((*zero, *undamped), 0.0)
        self._call("changeDynamics", body, link, lateralFriction=friction, **more)

    def _block(self, block: Box, friction: float) -> int:
        half = [0.5 * each for each in block.size]
        shape = self._call("createCollisionShape", pybullet.GEOM_BOX, halfExtents=half)
        turn = pybullet.getQuaternionFromEuler((0.0, 0.0, block.yaw))
        body = self._call(
            "createMultiBody", 0.0, shape, basePosition=block.center, baseOrientation=turn
        )
        self._surface(body, -1, friction)
        return int(body)

    def _hold(self, moving: Sequence[int]) -> None:
        """Hold all joints except those of wheels."""
        wheels = {joint for joint, _ in self._wheels}
        for joint in moving:
            if joint not in wheels:
                angle = self._held.get(joint, 0.0)
                self._call("resetJointState", self._body, joint, angle)
                self._call(
                    "setJointMotorControl2",
                    self._body,
                    joint,
                    pybullet.POSITION_CONTROL,
                    targetPosition=angle,
                    force=AMPLE,
                )

    def _place(self, scene: Scene) -> None:
        offset, inner = self._call("getDynamicsInfo", self._body, -1)[3:5]
        self._inverse = pybullet.invertTransform(offset, inner)
        root = scene.root()
        middle, turned = (root + offset).tolist(), inner
        if scene.angle != 0.0:
            tilt = pybullet.getQuaternionFromEuler((0.0, -scene.angle, 0.0))
            middle, turned = pybullet.multiplyTransforms(root.tolist(), tilt, offset, inner)
        self._call("resetBasePositionAndOrientation", self._body, middle, turned)

    def resolve_overlap(self) -> tuple[float, float]:
        """[m] Move the robot forward and up until it overlaps no ground; return the distance.

        It moves the shortest distance out of the deepest overlap, again and again.
        """
        (x, y, z), turn = self._call("getBasePositionAndOrientation", self._body)
        forward = up = 0.0
        while True:
            point = min(self._closest(), key=lambda each: each[8], default=None)
            if point is None or -point[8] < _TOUCH:
                return forward, up
            forward -= point[8] * point[7][0]
            up -= point[8] * (point[7][2] + _UP)
            place = x + forward, y, z + up
            self._call("resetBasePositionAndOrientation", self._body, place, turn)

    def _closest(self) -> Iterator[Any]:
        """Yield contacts of ground and robot; item 7 is the normal and item 8 the distance."""
        for block in self._ground:
            yield from self._call("getClosestPoints", self._body, block, 0.0)

    def advance(self, speeds: Sequence[float]) -> None:
        """Take a step for each set-point."""
        for speed in speeds:
            self._call(
                "setJointMotorControlArray",
                self._body,
                [joint for joint, _ in self._wheels],
                pybullet.VELOCITY_CONTROL,
                targetVelocities=[wheel.turn(speed) for _, wheel in self._wheels],
                forces=[wheel.torque for _, wheel in self._wheels],
            )
            self._call("stepSimulation")

    def pose(self) -> Pose:
        """Return the pose of the chassis frame."""
        at = self._call("getBasePositionAndOrientation", self._body)
        place, turn = pybullet.multiplyTransforms(*at, *self._inverse)
        axes = np.array(pybullet.getMatrixFromQuaternion(turn)).reshape(3, 3)
        root = Pose(place=np.array(place), turn=axes)
        return Pose(place=root.at(self._robot.origin), turn=axes)

    def touches(self) -> list[Touch]:
        """Return the contacts with the ground."""
        names = {number: name for name, number in self._links.items()}
        return [
            Touch(link=names.get(each[3], "root"), point=each[5], normal=each[7], force=each[9])
            for ground in self._ground
            for each in self._call("getContactPoints", self._body, ground)
        ]

    def bend(self) -> float:
        """[rad] Return the largest deviation of a flipper from its angle."""
        return max(
            (
                abs(self._call("getJointState", self._body, joint)[0] - angle)
                for joint, angle in self._held.items()
            ),
            default=0.0,
        )

    def close(self) -> None:
        """Free the resources of the world."""
        pybullet.disconnect(self._client)
