"""MuJoCo, a 3D engine held in the plane.

The chassis slides along x and z and turns about y; each wheel is a hinge on it, so that pins cannot
open. Round parts are spheres in the plane, grousers are prisms, the ground is boxes. A motor is a
velocity servo with a gain so high that only its torque limit matters; `implicitfast` integrates it.

The defaults are MuJoCo's own: contacts with a time constant of 20 ms, and a friction pyramid. The
tuned setting has a time constant of 2 ms (MuJoCo itself never goes below two time steps), an
impedance of 0.99 to 0.999 within 0.1 mm, and the elliptic cone with an `impratio` of 10, which keep
sticking contacts from creeping. Newton's method is MuJoCo's default; the iterations are its limit.
"""

from collections.abc import Sequence
from typing import Any

import mujoco
import numpy as np
from mujoco.batch import Batch

from benches.adapters.planar import Body, Scene, Setting, Started, SteppedEngine
from benches.shared.measuring import seconds

# [N m s/rad] 10 N m at an error of 0.01 rad/s.
_SERVO_GAIN = 1000.0
# [m] Half widths of the prisms and of the ground, across the plane.
_HALF_WIDTH, _GROUND_HALF_WIDTH = 0.02, 0.5
# About -y, so that x to z is counter-clockwise, like x to y in the plane.
_AXIS = (0.0, -1.0, 0.0)


class MuJoCo(SteppedEngine):
    """MuJoCo's convex contact solver in generalised coordinates."""

    name = "MuJoCo"
    version = mujoco.__version__
    defaults = Setting(2e-3, iterations=100, tuned=False)
    grid: Sequence[Setting] = [
        Setting(dt * 1e-3, iterations=iterations)
        for dt in (8.0, 4.0, 2.0, 1.0, 0.5)
        for iterations in (3, 10, 100)
    ]
    finest = Setting(0.25e-3, iterations=100)
    next_finest = Setting(0.5e-3, iterations=100)

    def start(self, scene: Scene, setting: Setting) -> Started:
        """Build a world."""
        model, data = build(scene, setting)
        angles = np.zeros(len(scene.bodies))

        def advance(count: int) -> None:
            mujoco.mj_step(model, data, nstep=count)

        def poses() -> Any:
            mujoco.mj_kinematics(model, data)
            pitch = data.qpos[2]
            angles[0], angles[1:] = pitch, pitch + data.qpos[3:]
            return np.column_stack([data.xpos[1:, [0, 2]], angles])

        return advance, poses

    def batch_time(self, variants: Sequence[Scene], setting: Setting, threads: int) -> float:
        """[s] Time worlds of equal size on several threads."""
        models, data = zip(*(build(scene, setting) for scene in variants), strict=True)
        batch = Batch(models[0], nsim=len(models), nthread=threads)
        batch.set_models(list(models))
        batch.bind("ctrl")[:] = [each.ctrl for each in data]
        steps = setting.steps(variants[0].duration)
        return seconds(lambda: batch.step(nstep=steps))


def build(scene: Scene, setting: Setting) -> tuple[mujoco.MjModel, mujoco.MjData]:
    """Compile the scene, with the motors commanded."""
    spec = mujoco.MjSpec()
    spec.compiler.degree = False
    option = spec.option
    option.timestep, option.iterations = setting.time_step, setting.iterations
    option.gravity = (0.0, 0.0, -9.81)
    # A diverging run must be visible, not restart.
    option.disableflags |= mujoco.mjtDisableBit.mjDSBL_AUTORESET
    option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    if setting.tuned:
        option.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
        option.impratio = 10.0
    for box in scene.boxes:
        low, high = box.min(axis=0), box.max(axis=0)
        (x, z), (width, height) = (low + high) / 2.0, (high - low) / 2.0
        geom = spec.worldbody.add_geom(
            type=mujoco.mjtGeom.mjGEOM_BOX,
            pos=(x, 0.0, z),
            size=(width, _GROUND_HALF_WIDTH, height),
            contype=0,
            conaffinity=1,
        )
        _finish(geom, scene, setting)
    frame = scene.bodies[0]
    chassis = _body(spec.worldbody, frame, (frame.x, frame.y))
    for axis in ((1.0, 0.0, 0.0), (0.0, 0.0, 1.0)):
        chassis.add_joint(type=mujoco.mjtJoint.mjJNT_SLIDE, axis=axis)
    chassis.add_joint(type=mujoco.mjtJoint.mjJNT_HINGE, axis=_AXIS)
    _shapes(spec, chassis, frame, scene, setting)
    for index, joint in enumerate(scene.joints):
        body = scene.bodies[joint.b]
        wheel = _body(chassis, body, joint.pa)
        wheel.add_joint(name=f"pin{index}", type=mujoco.mjtJoint.mjJNT_HINGE, axis=_AXIS)
        _shapes(spec, wheel, body, scene, setting)
        motor = spec.add_actuator(
            target=f"pin{index}",
            trntype=mujoco.mjtTrn.mjTRN_JOINT,
            forcelimited=True,
            forcerange=(-joint.torque, joint.torque),
        )
        motor.set_to_velocity(_SERVO_GAIN)
    model = spec.compile()
    data = mujoco.MjData(model)
    data.ctrl[:] = [joint.speed for joint in scene.joints]
    return model, data


def _body(parent: mujoco.MjsBody, body: Body, at: tuple[float, float]) -> mujoco.MjsBody:
    return parent.add_body(
        pos=(at[0], 0.0, at[1]),
        mass=body.mass,
        inertia=(body.inertia,) * 3,
        ipos=(0.0, 0.0, 0.0),
        explicitinertial=True,
    )


def _shapes(
    spec: mujoco.MjSpec, parent: mujoco.MjsBody, body: Body, scene: Scene, setting: Setting
) -> None:
    geoms = []
    if body.radius > 0.0:
        sphere = mujoco.mjtGeom.mjGEOM_SPHERE
        geoms.append(parent.add_geom(type=sphere, size=(body.radius, 0.0, 0.0)))
    for polygon in body.polygons:
        name = f"mesh{len(spec.meshes)}"
        corners = [(x, y, z) for y in (-_HALF_WIDTH, _HALF_WIDTH) for x, z in polygon]
        spec.add_mesh(name=name, uservert=np.ravel(corners))
        geoms.append(parent.add_geom(type=mujoco.mjtGeom.mjGEOM_MESH, meshname=name))
    for geom in geoms:
        geom.contype, geom.conaffinity = 1, 0
        _finish(geom, scene, setting)


def _finish(geom: mujoco.MjsGeom, scene: Scene, setting: Setting) -> None:
    geom.friction = (scene.friction, 0.0, 0.0)
    geom.condim = 3
    if setting.tuned:
        geom.solref = (0.002, 1.0)
        geom.solimp = (0.99, 0.999, 1e-4, 0.5, 2.0)
