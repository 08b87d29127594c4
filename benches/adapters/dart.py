"""DART, through dartpy: generalised coordinates, contacts as a linear complementarity problem.

Its collision detection is ODE's, as in gz-sim. It takes the smaller friction of two surfaces, the
ground's. Its usual solver, Dantzig's, does not limit friction by the normal force that it finds,
but by the one without friction; its Gauss-Seidel solver keeps Coulomb's law.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from importlib.metadata import version
from typing import Any

import dartpy
import numpy as np

from benches.adapters.ground import Box
from benches.adapters.space import Scene, Touch, World, check
from crawler2d.model_tree import Pose

_TOLERANCE = 1e-7
_ROBOT_FRICTION = 10.0  # [-] above that of any ground


@dataclass(frozen=True, slots=True, kw_only=True)
class Dart:
    """DART at a setting.

    Parameters
    ----------
    time_step : float
        [s] Of a step.
    sweeps : int
        Of its Gauss-Seidel solver at most; 0 takes Dantzig's.
    """

    time_step: float = 1e-3
    sweeps: int = 300

    version = f"DART {version('dartpy')}"
    in_space = True

    def world(self, scene: Scene) -> DartWorld:
        """Build a world."""
        return DartWorld(scene, self)


class DartWorld(World):
    """A robot on its ground in DART; motors that hold speeds do so exactly, flippers are locked."""

    def __init__(self, scene: Scene, setting: Dart) -> None:
        self._robot = robot = scene.robot
        kinds = dartpy.dynamics.ActuatorType
        self._world = dartpy.simulation.World()
        self._world.setTimeStep(setting.time_step)
        self._world.setGravity([0.0, 0.0, -9.81])
        solver = self._world.getConstraintSolver()
        solver.setCollisionDetector(dartpy.collision.OdeCollisionDetector())
        if setting.sweeps:
            solver.setBoxedLcpSolver(_gauss_seidel(setting.sweeps))
        for number, block in enumerate(scene.ground):
            self._world.addSkeleton(_block(block, number, scene.friction))
        with robot.path() as path:
            uri = f"file://{path}"
            if path.endswith(".sdf"):
                skeleton: Any = dartpy.utils.SdfParser.readSkeleton(uri)
            else:
                skeleton = dartpy.utils.DartLoader().parseSkeleton(uri)
        nodes = [skeleton.getBodyNode(number) for number in range(skeleton.getNumBodyNodes())]
        for node in nodes:
            for shape in node.getShapeNodes():
                shape.getDynamicsAspect().setFrictionCoeff(_ROBOT_FRICTION)
                shape.getDynamicsAspect().setRestitutionCoeff(0.0)
        self._root = nodes[0]
        joints = {node.getName(): node.getParentJoint() for node in nodes[1:]}
        wheels = {wheel.link for wheel in robot.wheels}
        for name, joint in joints.items():
            for degree in range(joint.getNumDofs()):
                joint.setDampingCoefficient(degree, 0.0)
                joint.setCoulombFriction(degree, 0.0)
            if joint.getNumDofs() and name not in wheels:
                joint.setPosition(0, robot.held.get(name, 0.0))
                joint.setActuatorType(kinds.LOCKED)
        self._motors = [(joints[wheel.link], wheel) for wheel in robot.wheels]
        for joint, wheel in self._motors:
            joint.setLimitEnforcement(False)
            joint.setActuatorType(kinds.VELOCITY if robot.holds_speed else kinds.SERVO)
            if not robot.holds_speed:
                joint.setForceLowerLimit(0, -wheel.torque)
                joint.setForceUpperLimit(0, wheel.torque)
        self._root.getParentJoint().setPositions([0.0, -scene.angle, 0.0, *scene.root()])
        axles = {
            wheel.link: joint.getChildBodyNode().getTransform().translation()
            for joint, wheel in self._motors
        }
        check(robot, skeleton.getMass(), axles, self.pose())
        for joint, wheel in self._motors:
            joint.setPosition(0, wheel.turn(scene.phase))
        self._world.addSkeleton(skeleton)

    def advance(self, speeds: Sequence[float]) -> None:
        """Take a step for each set-point."""
        for speed in speeds:
            for joint, wheel in self._motors:
                joint.setCommand(0, wheel.turn(speed))
            self._world.step(False)

    def pose(self) -> Pose:
        """Return the pose of the chassis frame."""
        at = self._root.getTransform()
        root = Pose(place=np.array(at.translation()), turn=np.array(at.rotation()))
        return Pose(place=root.at(self._robot.origin), turn=root.turn)

    def touches(self) -> list[Touch]:
        """Return the contacts with the ground."""
        touches = []
        for contact in self._world.getLastCollisionResult().getContacts():
            objects = contact.collisionObject1, contact.collisionObject2
            one, two = (each.getShapeFrame().getBodyNodePtr().getName() for each in objects)
            if one.startswith("ground") and two.startswith("ground"):
                continue
            sign, link = (-1.0, two) if one.startswith("ground") else (1.0, one)
            touches.append(
                Touch(
                    link=link,
                    point=tuple(np.array(contact.point).tolist()),
                    normal=tuple((sign * np.array(contact.normal)).tolist()),
                    force=abs(float(np.dot(contact.force, contact.normal))),
                )
            )
        return touches


def _gauss_seidel(sweeps: int) -> Any:
    solver = dartpy.constraint.NsgsFrictionSolver()
    options = solver.getOptions()
    options.maxSweeps, options.tolerance = sweeps, _TOLERANCE
    solver.setOptions(options)
    return solver


def _block(block: Box, number: int, friction: float) -> Any:
    skeleton = dartpy.dynamics.Skeleton(f"ground {number}")
    joint, node = skeleton.createWeldJointAndBodyNodePair()
    node.setName(f"ground {number}")
    shape = node.createShapeNode(dartpy.dynamics.BoxShape(list(block.size)))
    shape.createCollisionAspect()
    shape.createDynamicsAspect()
    shape.getDynamicsAspect().setFrictionCoeff(friction)
    place = dartpy.math.Isometry3()
    place.set_translation(list(block.center))
    cos, sin = np.cos(block.yaw), np.sin(block.yaw)
    place.set_rotation([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]])
    joint.setTransformFromParentBodyNode(place)
    return skeleton
