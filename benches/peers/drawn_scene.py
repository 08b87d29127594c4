"""A scene for other engines, changed as a scenario differs from the scene's own form."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from benches.peers.scenes import Draw, Scene
from crawler2d.parameters.scenario import Scenario

__all__ = ["scene_of"]


def scene_of(nominal: Scene, base: Scenario, drawn: Scenario) -> Scene:
    """Change a scene as a drawn scenario differs from the scene's own form.

    Centre of mass, torque, clearance of the belly, approach, speed, friction and height of the step
    may differ.
    """
    chassis, *wheels = nominal.bodies
    mass = sum(body.mass for body in nominal.bodies)
    center = np.subtract(drawn.robot.center_of_mass, base.robot.center_of_mass)
    moved = center * mass / chassis.mass  # of the chassis, so that of all moves by `center`
    polygons = tuple(polygon - moved for polygon in chassis.polygons)
    if base.robot.belly is not None and drawn.robot.belly is not None:
        raised = np.subtract(drawn.robot.belly, base.robot.belly)
        polygons = tuple(polygon + raised.mean(axis=0) for polygon in polygons)
    # The nominal centre of all is that of the chassis.
    offset, arms = moved - center, [np.subtract(joint.pa, center) for joint in nominal.joints]
    of_wheels = sum(w.inertia + w.mass * float(a @ a) for w, a in zip(wheels, arms, strict=True))
    inertia = drawn.robot.moment_of_inertia - of_wheels - chassis.mass * float(offset @ offset)
    body = replace(
        chassis,
        x=chassis.x + float(moved[0]),
        y=chassis.y + float(moved[1]),
        inertia=inertia,
        polygons=polygons,
    )
    ratio = drawn.robot.drivetrain.max_torque / base.robot.drivetrain.max_torque
    joints = tuple(
        replace(
            joint,
            pa=(joint.pa[0] - float(moved[0]), joint.pa[1] - float(moved[1])),
            torque=joint.torque * ratio,
        )
        for joint in nominal.joints
    )
    low, high = nominal.boxes
    top = high.copy()
    top[high[:, 1] > 0.0, 1] = drawn.terrain.points[2][1]  # type: ignore[union-attr]
    draw = Draw(
        drawn.start.approach - base.start.approach,
        drawn.drive.speed / base.drive.speed,
        drawn.terrain.friction / nominal.friction,  # type: ignore[union-attr]
    )
    changed = replace(nominal, bodies=(body, *wheels), joints=joints, boxes=(low, top))
    return changed.vary(draw)
