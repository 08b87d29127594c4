"""Bullet, through PyBullet: multibodies, whose contacts an iterative solver satisfies."""

from __future__ import annotations

from importlib.metadata import version
from typing import Any

import numpy as np
import pybullet

from benches.models.engine import Scene, Touch, check
from benches.models.ground import Box
from crawler2d.model_tree import Pose

__all__ = ["Bullet"]

_ITERATIONS = 200
_FORCE = 1e4  # [N m] of every motor: files of wheels have no limit that they would reach
_NEAR = 0.002  # [m] gap up to which contacts are kept; Bullet's own 20 mm is more than a pocket


class Bullet:
    """Bullet with steps of a millisecond and 200 iterations.

    Its readers make a prism of 32 sides of every cylinder, unless that of URDF is told not to.

    Bullet multiplies the coefficients of two surfaces: that of the robot is 1, that of the ground
    the friction of the pair. Its readers give shapes a margin, by which edges are rounded.

    Parameters
    ----------
    time_step : float
        [s] Of the engine.
    is_round : bool
        Whether cylinders are cylinders; only URDF can have that.
    is_cone : bool
        Whether friction is limited as a vector; else in two directions, each for itself. The vector
        of a light wheel that slides may turn across, which leaves too little in the plane; with two
        limits it may get too much.
    """

    name = "Bullet"
    version = version("pybullet")

    def __init__(
        self, time_step: float = 1e-3, *, is_round: bool = True, is_cone: bool = True
    ) -> None:
        self.time_step = time_step
        self.is_round = is_round
        self.is_cone = is_cone

    def world(self, scene: Scene) -> BulletWorld:
        """Build a world."""
        return BulletWorld(scene, self.is_round, self.is_cone)


class BulletWorld:
    """A robot on its ground in Bullet."""

    def __init__(self, scene: Scene, is_round: bool, is_cone: bool) -> None:
        self._model = scene.model
        self._client = pybullet.connect(pybullet.DIRECT)
        self._call("setGravity", 0.0, 0.0, -9.81)
        self._call(
            "setPhysicsEngineParameter",
            fixedTimeStep=scene.time_step,
            numSolverIterations=_ITERATIONS,
            solverResidualThreshold=1e-7,
            contactBreakingThreshold=_NEAR,
            enableConeFriction=int(is_cone),
            deterministicOverlappingPairs=1,
        )
        self._ground = [self._box(box, scene.friction) for box in scene.ground]
        path = str(scene.model.path)
        flags = pybullet.URDF_USE_INERTIA_FROM_FILE
        if is_round:
            flags |= pybullet.URDF_USE_IMPLICIT_CYLINDER
        if path.endswith(".sdf"):
            (self._body,) = self._call("loadSDF", path)
        else:
            self._body = self._call("loadURDF", path, flags=flags)
        joints = range(self._call("getNumJoints", self._body))
        infos = [self._call("getJointInfo", self._body, joint) for joint in joints]
        self._links = {info[12].decode(): info[0] for info in infos}
        self._moving = [info[0] for info in infos if info[2] == pybullet.JOINT_REVOLUTE]
        for link in (-1, *joints):
            self._surface(self._body, link, 1.0)
        self._held = {self._links[name]: angle for name, angle in scene.model.held.items()}
        self._rates = {self._links[name]: rate for name, rate in scene.model.wheels.items()}
        self._place(scene)
        check(scene.model, self._mass(joints), self._axles())
        for joint, rate in self._rates.items():
            self._call("resetJointState", self._body, joint, rate * scene.phase)

    def _call(self, name: str, *arguments: Any, **more: Any) -> Any:
        return getattr(pybullet, name)(*arguments, physicsClientId=self._client, **more)

    def _surface(self, body: int, link: int, friction: float) -> None:
        self._call(
            "changeDynamics",
            body,
            link,
            lateralFriction=friction,
            spinningFriction=0.0,
            rollingFriction=0.0,
            restitution=0.0,
            linearDamping=0.0,
            angularDamping=0.0,
            jointDamping=0.0,
        )

    def _box(self, box: Box, friction: float) -> int:
        half = [0.5 * each for each in box.size]
        shape = self._call("createCollisionShape", pybullet.GEOM_BOX, halfExtents=half)
        body = int(self._call("createMultiBody", 0.0, shape, basePosition=box.center))
        self._surface(body, -1, friction)
        return body

    def _place(self, scene: Scene) -> None:
        """Hold what is not a wheel, and set the chassis frame on its place."""
        for joint in self._moving:
            if joint not in self._rates:
                angle = self._held.get(joint, 0.0)
                self._call("resetJointState", self._body, joint, angle)
                self._call(
                    "setJointMotorControl2",
                    self._body,
                    joint,
                    pybullet.POSITION_CONTROL,
                    targetPosition=angle,
                    force=_FORCE,
                )
        root = np.array([scene.x, 0.0, -scene.model.lowest]) - scene.model.origin
        offset, turned = self._call("getDynamicsInfo", self._body, -1)[3:5]
        self._offset = np.array(offset), turned
        middle = (root + offset).tolist()
        self._call("resetBasePositionAndOrientation", self._body, middle, turned)

    def _mass(self, joints: range) -> float:
        return float(sum(self._call("getDynamicsInfo", self._body, i)[0] for i in (-1, *joints)))

    def _axles(self) -> dict[str, list[float]]:
        frame = self.pose()
        return {
            name: (
                np.array(self._call("getLinkState", self._body, self._links[name])[4]) - frame.place
            ).tolist()
            for name in self._model.wheels
        }

    def command(self, speed: float) -> None:
        """Let the motors turn all wheels."""
        self._call(
            "setJointMotorControlArray",
            self._body,
            list(self._rates),
            pybullet.VELOCITY_CONTROL,
            targetVelocities=[speed * rate for rate in self._rates.values()],
            forces=[_FORCE] * len(self._rates),
        )

    def advance(self) -> None:
        """Take a step."""
        self._call("stepSimulation")

    def pose(self) -> Pose:
        """Return where the chassis frame is."""
        middle, turned = self._call("getBasePositionAndOrientation", self._body)
        offset, inner = self._offset
        back = pybullet.invertTransform(offset.tolist(), inner)
        place, turn = pybullet.multiplyTransforms(middle, turned, *back)
        axes = np.array(pybullet.getMatrixFromQuaternion(turn)).reshape(3, 3)
        root = Pose(place=np.array(place), turn=axes)
        return Pose(place=root.at(self._model.origin), turn=root.turn)

    def touches(self) -> list[Touch]:
        """Return the contacts with the ground."""
        names = {number: name for name, number in self._links.items()}
        found = []
        for ground in self._ground:
            for point in self._call("getContactPoints", self._body, ground):
                link = names.get(point[3], "root")
                found.append(Touch(link=link, point=point[5], normal=point[7], force=point[9]))
        return found

    def bend(self) -> float:
        """[rad] Return by how much the worst flipper is off its angle."""
        angles = [self._call("getJointState", self._body, joint)[0] for joint in self._held]
        return float(max((abs(a - b) for a, b in zip(angles, self._held.values(), strict=True))))

    def close(self) -> None:
        """Free what the world holds."""
        pybullet.disconnect(self._client)
