"""Bullet, through PyBullet: a multibody from URDF, whose contacts an iterative solver satisfies."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np
import pybullet

from benches.engines.engine import Scene
from benches.engines.ground import TurnedBox
from crawler2d.model_tree import Pose

__all__ = ["FINE", "PYBULLET", "Bullet", "Setting"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Setting:
    """How Bullet is set.

    Parameters
    ----------
    time_step : float
        [s] Of a step.
    iterations : int
        Of its solver.
    is_default : bool
        Whether all else is as PyBullet has it: cylinders are prisms of 32 sides, contacts are kept
        up to 20 mm apart, and bodies are damped. Else cylinders are round, contacts are kept up to
        2 mm apart, and nothing is damped.
    """

    time_step: float
    iterations: int
    is_default: bool


PYBULLET = Setting(time_step=1.0 / 240.0, iterations=50, is_default=True)
FINE = Setting(time_step=1e-3, iterations=200, is_default=False)

_NEAR, _RESIDUAL = 0.002, 1e-7  # [m], [-]
_TOUCH = 1e-5  # [m] to which heights are right
_UP = 0.05  # [-] besides, or between two upright faces it would go to and fro for ever


class Bullet:
    """Bullet, which multiplies frictions: the robot's is 1.

    Parameters
    ----------
    setting : Setting
        How it is set.
    """

    version = f"Bullet {version('pybullet')}"
    in_space = True

    def __init__(self, setting: Setting) -> None:
        self.setting = setting
        self.time_step = setting.time_step

    def world(self, scene: Scene) -> BulletWorld:
        """Build a world."""
        return BulletWorld(scene, self.setting)

    def clear(self, scene: Scene) -> Scene:
        """Return a scene whose robot is moved forward and up until no ground is inside it."""
        world = BulletWorld(scene, self.setting)
        forward, up = world.let_out()
        world.close()
        return replace(scene, x=scene.x + forward, z=scene.z + up)


class BulletWorld:
    """A robot on its ground in Bullet."""

    def __init__(self, scene: Scene, setting: Setting) -> None:
        self._client = pybullet.connect(pybullet.DIRECT)
        self._is_default = setting.is_default
        self._call("setGravity", 0.0, 0.0, -9.81)
        more = (
            {}
            if setting.is_default
            else {
                "contactBreakingThreshold": _NEAR,
                "solverResidualThreshold": _RESIDUAL,
            }
        )
        self._call(
            "setPhysicsEngineParameter",
            fixedTimeStep=setting.time_step,
            numSolverIterations=setting.iterations,
            deterministicOverlappingPairs=1,
            **more,
        )
        self._ground = [self._block(block, scene.friction) for block in scene.ground]
        flags = pybullet.URDF_USE_INERTIA_FROM_FILE
        if not setting.is_default:
            flags |= pybullet.URDF_USE_IMPLICIT_CYLINDER
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "robot.urdf"
            path.write_text(scene.robot.urdf(), encoding="utf-8")
            self._body = self._call("loadURDF", str(path), flags=flags)
        count = self._call("getNumJoints", self._body)
        links = {
            self._call("getJointInfo", self._body, joint)[12].decode(): joint
            for joint in range(count)
        }
        for link in (-1, *range(count)):
            self._surface(self._body, link, 1.0)
        self._wheels = [(links[wheel.link], wheel) for wheel in scene.robot.wheels]
        self._joints = [joint for joint, _ in self._wheels]
        self._torques = [wheel.torque for _, wheel in self._wheels]
        offset, inner = self._call("getDynamicsInfo", self._body, -1)[3:5]
        self._inverse = pybullet.invertTransform(offset, inner)
        tilt = pybullet.getQuaternionFromEuler((0.0, -scene.angle, 0.0))
        middle, turned = pybullet.multiplyTransforms((scene.x, 0.0, scene.z), tilt, offset, inner)
        self._call("resetBasePositionAndOrientation", self._body, middle, turned)
        for joint, wheel in self._wheels:
            self._call("resetJointState", self._body, joint, scene.phase / wheel.radius)
        loaded = sum(self._call("getDynamicsInfo", self._body, i)[0] for i in (-1, *range(count)))
        if abs(loaded - scene.robot.mass) > 1e-5 * scene.robot.mass:
            raise ValueError(f"{loaded:g} kg were loaded, the robot has {scene.robot.mass:g}")

    def _call(self, name: str, *arguments: Any, **more: Any) -> Any:
        return getattr(pybullet, name)(*arguments, physicsClientId=self._client, **more)

    def _surface(self, body: int, link: int, friction: float) -> None:
        damping = (
            {}
            if self._is_default
            else {
                "linearDamping": 0.0,
                "angularDamping": 0.0,
                "jointDamping": 0.0,
            }
        )
        self._call("changeDynamics", body, link, lateralFriction=friction, **damping)

    def _block(self, block: TurnedBox, friction: float) -> int:
        half = [0.5 * each for each in block.size]
        shape = self._call("createCollisionShape", pybullet.GEOM_BOX, halfExtents=half)
        turn = pybullet.getQuaternionFromEuler((0.0, 0.0, block.yaw))
        body = self._call(
            "createMultiBody", 0.0, shape, basePosition=block.center, baseOrientation=turn
        )
        self._surface(body, -1, friction)
        return int(body)

    def let_out(self) -> tuple[float, float]:
        """[m] Move the robot forward and up until no ground is inside it; return how far.

        It goes the shortest way out of whatever is deepest, again and again.
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
        """Yield where ground and robot touch, the 7th being the normal and the 8th the distance."""
        for block in self._ground:
            yield from self._call("getClosestPoints", self._body, block, 0.0)

    def advance(self, speeds: Sequence[float]) -> None:
        """Take a step for each set-point."""
        for speed in speeds:
            self._call(
                "setJointMotorControlArray",
                self._body,
                self._joints,
                pybullet.VELOCITY_CONTROL,
                targetVelocities=[speed / wheel.radius for _, wheel in self._wheels],
                forces=self._torques,
            )
            self._call("stepSimulation")

    def pose(self) -> Pose:
        """Return where the chassis frame is."""
        at = self._call("getBasePositionAndOrientation", self._body)
        place, turn = pybullet.multiplyTransforms(*at, *self._inverse)
        axes = np.array(pybullet.getMatrixFromQuaternion(turn)).reshape(3, 3)
        return Pose(place=np.array(place), turn=axes)

    def close(self) -> None:
        """Free what the world holds."""
        pybullet.disconnect(self._client)
