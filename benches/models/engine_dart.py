"""DART, through dartpy: generalised coordinates, contacts as a linear complementarity problem."""

from __future__ import annotations

from importlib.metadata import version
from typing import Any

import dartpy
import numpy as np

from benches.models.engine import Scene, Touch, check
from benches.models.ground import Box
from crawler2d.model_tree import Pose

__all__ = ["Dart", "fixed_box", "gauss_seidel"]

_SWEEPS, _TOLERANCE = 300, 1e-7


class Dart:
    """DART with ODE's collision detection, as gz-sim has it.

    DART takes the smaller coefficient of two surfaces: that of the robot is 1, that of the ground
    the friction of the pair. Its usual solver, Dantzig's, does not limit friction by the normal
    force that it finds, but by the one without friction; its Gauss-Seidel solver keeps Coulomb's
    law. Wheels turn at given speeds, and flippers are locked.

    Parameters
    ----------
    time_step : float
        [s] Of the engine.
    is_coulomb : bool
        Whether the Gauss-Seidel solver finds the forces; else Dantzig's does.
    """

    name = "DART"
    version = version("dartpy")

    def __init__(self, time_step: float = 5e-4, *, is_coulomb: bool = True) -> None:
        self.time_step = time_step
        self.is_coulomb = is_coulomb

    def world(self, scene: Scene) -> DartWorld:
        """Build a world."""
        return DartWorld(scene, self.is_coulomb)


class DartWorld:
    """A robot on its ground in DART."""

    def __init__(self, scene: Scene, is_coulomb: bool) -> None:
        self._model = scene.model
        dynamics = dartpy.dynamics
        self._world = dartpy.simulation.World()
        self._world.setTimeStep(scene.time_step)
        self._world.setGravity([0.0, 0.0, -9.81])
        solver = self._world.getConstraintSolver()
        solver.setCollisionDetector(dartpy.collision.OdeCollisionDetector())
        if is_coulomb:
            solver.setBoxedLcpSolver(gauss_seidel(_SWEEPS))
        for number, box in enumerate(scene.ground):
            self._world.addSkeleton(fixed_box(box, number, scene.friction))
        uri = f"file://{scene.model.path}"
        if uri.endswith(".sdf"):
            skeleton = dartpy.utils.SdfParser.readSkeleton(uri)
        else:
            skeleton = dartpy.utils.DartLoader().parseSkeleton(uri)
        self._robot: Any = skeleton
        nodes = [skeleton.getBodyNode(number) for number in range(skeleton.getNumBodyNodes())]
        for node in nodes:
            for shape in node.getShapeNodes():
                shape.getDynamicsAspect().setFrictionCoeff(1.0)
                shape.getDynamicsAspect().setRestitutionCoeff(0.0)
        self._root = nodes[0]
        joints = {node.getName(): node.getParentJoint() for node in nodes[1:]}
        for name, joint in joints.items():
            for degree in range(joint.getNumDofs()):
                joint.setDampingCoefficient(degree, 0.0)
                joint.setCoulombFriction(degree, 0.0)
            if joint.getNumDofs() and name not in scene.model.wheels:
                joint.setPosition(0, scene.model.held.get(name, 0.0))
                joint.setActuatorType(dynamics.ActuatorType.LOCKED)
        self._wheels = {joints[name]: rate for name, rate in scene.model.wheels.items()}
        for joint in self._wheels:
            joint.setLimitEnforcement(False)
            joint.setActuatorType(dynamics.ActuatorType.VELOCITY)
        root = np.array([scene.x, 0.0, -scene.model.lowest]) - scene.model.origin
        free = self._root.getParentJoint()
        free.setPositions([0.0, 0.0, 0.0, *root])
        frame = self.pose()
        axles = {
            name: (joints[name].getChildBodyNode().getTransform().translation() - frame.place)
            for name in scene.model.wheels
        }
        check(scene.model, skeleton.getMass(), {name: axles[name].tolist() for name in axles})
        for joint, rate in self._wheels.items():
            joint.setPosition(0, rate * scene.phase)
        self._world.addSkeleton(skeleton)

    def command(self, speed: float) -> None:
        """Let the motors turn all wheels."""
        for joint, rate in self._wheels.items():
            joint.setCommand(0, speed * rate)

    def advance(self) -> None:
        """Take a step."""
        self._world.step(False)  # commands stay

    def pose(self) -> Pose:
        """Return where the chassis frame is."""
        at = self._root.getTransform()
        root = Pose(place=np.array(at.translation()), turn=np.array(at.rotation()))
        return Pose(place=root.at(self._model.origin), turn=root.turn)

    def touches(self) -> list[Touch]:
        """Return the contacts with the ground."""
        found = []
        for contact in self._world.getLastCollisionResult().getContacts():
            names = [
                getattr(contact, f"collisionObject{number}").getShapeFrame().getBodyNodePtr()
                for number in (1, 2)
            ]
            one, two = (node.getName() for node in names)
            if one.startswith("ground") and two.startswith("ground"):
                continue
            sign, link = (-1.0, two) if one.startswith("ground") else (1.0, one)
            normal = sign * np.array(contact.normal)
            found.append(
                Touch(
                    link=link,
                    point=tuple(np.array(contact.point).tolist()),
                    normal=tuple(normal.tolist()),
                    force=abs(float(np.dot(contact.force, contact.normal))),
                )
            )
        return found

    def bend(self) -> float:
        """[rad] Return by how much the worst flipper is off its angle: locked joints are not."""
        return 0.0

    def close(self) -> None:
        """Free what the world holds."""


def gauss_seidel(sweeps: int) -> Any:
    """Return the solver that keeps Coulomb's law, with this many sweeps at most."""
    solver = dartpy.constraint.NsgsFrictionSolver()
    options = solver.getOptions()
    options.maxSweeps, options.tolerance = sweeps, _TOLERANCE
    solver.setOptions(options)
    return solver


def fixed_box(box: Box, number: int, friction: float, yaw: float = 0.0) -> Any:
    """Return a piece of ground, turned by `yaw` [rad] seen from above."""
    skeleton = dartpy.dynamics.Skeleton(f"ground {number}")
    joint, node = skeleton.createWeldJointAndBodyNodePair()
    node.setName(f"ground {number}")
    shape = node.createShapeNode(dartpy.dynamics.BoxShape(list(box.size)))
    shape.createCollisionAspect()
    shape.createDynamicsAspect()
    shape.getDynamicsAspect().setFrictionCoeff(friction)
    place = dartpy.math.Isometry3()
    place.set_translation(list(box.center))
    cos, sin = np.cos(yaw), np.sin(yaw)
    place.set_rotation([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]])
    joint.setTransformFromParentBodyNode(place)
    return skeleton
