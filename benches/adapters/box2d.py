"""Box2D v3 through pyb2d3.

Box2D's tolerances are meant for parts of about a metre: its slop is 5 mm, and it searches for
contacts up to 20 mm ahead. The tuned setting makes its unit of length a decimetre, which reduces
both to a tenth, and stiffens contacts from 30 to 240 Hz at a damping ratio of 10. Box2D itself
limits that to a quarter of the substep rate.

Its joints are springs of 60 per unit of time, and the package has no way to set that: wheels on
pins of 60 Hz give way by more than a millimetre at any time step. So the tuned setting has a time
unit of 20 ms, which makes them 3 kHz (again limited to a quarter of the substep rate), and gives
gravity, speeds and torques in that unit.

Box2D mixes friction by the geometric mean, so both materials have the scene's. No body sleeps.
Single precision.
"""

from collections.abc import Sequence
from importlib.metadata import version

import pyb2d3

from benches.adapters.planar import Body, Scene, Setting, Started, SteppedEngine

# [s] Time unit of a tuned world.
_TUNED_UNIT = 0.02

_GROUND, _ROBOT = 1, 2
_FILTERS = {
    _GROUND: pyb2d3.make_filter(category_bits=_GROUND, mask_bits=_ROBOT),
    _ROBOT: pyb2d3.make_filter(category_bits=_ROBOT, mask_bits=_GROUND),
}


class Box2D(SteppedEngine):
    """Box2D's soft step."""

    name = "Box2D v3"
    version = f"pyb2d3 {version('pyb2d3')}"
    defaults = Setting(1 / 60, substeps=4, tuned=False)
    grid: Sequence[Setting] = [
        Setting(dt * 1e-3, substeps=substeps)
        for dt in (8.0, 4.0, 2.0, 1.0, 0.5)
        for substeps in (1, 2, 4, 8)
    ]
    finest = Setting(0.25e-3, substeps=8)
    next_finest = Setting(0.5e-3, substeps=4)

    def start(self, scene: Scene, setting: Setting) -> Started:
        """Build a world."""
        world, bodies = _build(scene, setting)
        step, dt, substeps = world.step, setting.time_step / _unit(setting), setting.substeps

        def advance(count: int) -> None:
            for _ in range(count):
                step(dt, substeps)

        return advance, lambda: [(*body.position, body.angle) for body in bodies]


def _build(scene: Scene, setting: Setting) -> tuple[pyb2d3.World, list[pyb2d3.Body]]:
    # Global to the process: worlds with different settings cannot exist at the same time.
    pyb2d3.set_length_units_per_meter(0.1 if setting.tuned else 1.0)
    unit = _unit(setting)
    world = pyb2d3.World(gravity=(0.0, -9.81 * unit**2))
    if setting.tuned:
        world.set_contact_tuning(240.0 * unit, 10.0, 3.0 * unit)
    ground = world.create_static_body()
    of_ground = _shape(_GROUND, scene.friction)
    for box in scene.boxes:
        ground.create_polygon_shape(of_ground, pyb2d3.polygon(box.tolist()))
    bodies = [_body(body, world, scene.friction) for body in scene.bodies]
    for joint in scene.joints:
        world.create_revolute_joint(
            body_a=bodies[joint.a],
            body_b=bodies[joint.b],
            local_anchor_a=joint.pa,
            local_anchor_b=joint.pb,
            enable_motor=True,
            motor_speed=joint.speed * unit,
            max_motor_torque=joint.torque * unit**2,
        )
    return world, bodies


def _unit(setting: Setting) -> float:
    """[s] Time unit."""
    return _TUNED_UNIT if setting.tuned else 1.0


def _body(data: Body, world: pyb2d3.World, friction: float) -> pyb2d3.Body:
    body = world.create_dynamic_body(
        position=(data.x, data.y), rotation=data.angle, enable_sleep=False
    )
    shape = _shape(_ROBOT, friction)
    if data.radius > 0.0:
        body.create_circle_shape(shape, pyb2d3.circle(center=(0.0, 0.0), radius=data.radius))
    for polygon in data.polygons:
        body.create_polygon_shape(shape, pyb2d3.polygon(polygon.tolist()))
    mass = pyb2d3.MassData()
    mass.mass, mass.center, mass.rotational_inertia = data.mass, (0.0, 0.0), data.inertia
    body.mass_data = mass
    return body


def _shape(category: int, friction: float) -> pyb2d3.ShapeDef:
    material = pyb2d3.surface_material(friction=friction, restitution=0.0)
    return pyb2d3.shape_def(density=0.0, material=material, filter=_FILTERS[category])
