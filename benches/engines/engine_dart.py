"""DART, through dartpy: generalised coordinates, contacts as a linear complementarity problem."""

from __future__ import annotations

import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from typing import Any

import dartpy
import numpy as np

from benches.engines.engine import Scene
from benches.models.engine_dart import fixed_box, gauss_seidel
from crawler2d.model_tree import Pose

__all__ = ["FINE", "GZ", "Dart", "Setting"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Setting:
    """How DART is set; its collision detection is ODE's, as in gz-sim.

    Parameters
    ----------
    time_step : float
        [s] Of a step.
    sweeps : int
        Of its Gauss-Seidel solver, which keeps Coulomb's law; 0 takes Dantzig's, its usual one.
    """

    time_step: float
    sweeps: int


GZ = Setting(time_step=1e-3, sweeps=0)
FINE = Setting(time_step=1e-3, sweeps=300)

_ABOVE = 10.0  # [-] friction of the robot


class Dart:
    """DART, which takes the smaller friction of two surfaces: the ground's.

    Parameters
    ----------
    setting : Setting
        How it is set.
    """

    version = f"DART {version('dartpy')}"
    in_space = True

    def __init__(self, setting: Setting) -> None:
        self.setting = setting
        self.time_step = setting.time_step

    def world(self, scene: Scene) -> DartWorld:
        """Build a world."""
        return DartWorld(scene, self.setting)


class DartWorld:
    """A robot on its ground in DART."""

    def __init__(self, scene: Scene, setting: Setting) -> None:
        self._world = dartpy.simulation.World()
        self._world.setTimeStep(setting.time_step)
        self._world.setGravity([0.0, 0.0, -9.81])
        solver = self._world.getConstraintSolver()
        solver.setCollisionDetector(dartpy.collision.OdeCollisionDetector())
        if setting.sweeps:
            solver.setBoxedLcpSolver(gauss_seidel(setting.sweeps))
        for number, block in enumerate(scene.ground):
            self._world.addSkeleton(fixed_box(block, number, scene.friction, block.yaw))
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "robot.urdf"
            path.write_text(scene.robot.urdf(), encoding="utf-8")
            skeleton: Any = dartpy.utils.DartLoader().parseSkeleton(f"file://{path}")
        nodes = [skeleton.getBodyNode(number) for number in range(skeleton.getNumBodyNodes())]
        for node in nodes:
            for shape in node.getShapeNodes():
                shape.getDynamicsAspect().setFrictionCoeff(_ABOVE)
                shape.getDynamicsAspect().setRestitutionCoeff(0.0)
        self._root = nodes[0]
        joints = {node.getName(): node.getParentJoint() for node in nodes[1:]}
        self._motors = [(joints[wheel.link], wheel) for wheel in scene.robot.wheels]
        for joint, wheel in self._motors:
            joint.setLimitEnforcement(False)
            joint.setDampingCoefficient(0, 0.0)
            joint.setCoulombFriction(0, 0.0)
            joint.setActuatorType(dartpy.dynamics.ActuatorType.SERVO)
            joint.setForceLowerLimit(0, -wheel.torque)
            joint.setForceUpperLimit(0, wheel.torque)
            joint.setPosition(0, scene.phase / wheel.radius)
        self._root.getParentJoint().setPositions([0.0, -scene.angle, 0.0, scene.x, 0.0, scene.z])
        self._world.addSkeleton(skeleton)
        if abs(skeleton.getMass() - scene.robot.mass) > 1e-5 * scene.robot.mass:
            raise ValueError(
                f"{skeleton.getMass():g} kg were loaded, the robot has {scene.robot.mass:g}"
            )

    def advance(self, speeds: Sequence[float]) -> None:
        """Take a step for each set-point."""
        for speed in speeds:
            for joint, wheel in self._motors:
                joint.setCommand(0, speed / wheel.radius)
            self._world.step(False)

    def pose(self) -> Pose:
        """Return where the chassis frame is."""
        at = self._root.getTransform()
        return Pose(place=np.array(at.translation()), turn=np.array(at.rotation()))

    def close(self) -> None:
        """Free what the world holds."""
