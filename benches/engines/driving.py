"""One run in an engine: the command of crawler2d, judged by one rule."""

from __future__ import annotations

import math
import time
from typing import Any

from benches.engines.engine import Engine, Scene
from benches.engines.ground import blocks_of, goal_of
from benches.engines.solid import solid_of
from benches.models.judge import Judge
from crawler2d.parameters.scenario import Scenario
from crawler2d.parameters.terrain import Lanes

__all__ = ["driven", "scene_of"]

_LOOK = 0.01  # [s] between two looks of the judge


def scene_of(scenario: Scenario) -> Scene:
    """Return what an engine builds: the robot level, its lowest wheel on the ground."""
    robot, ground = solid_of(scenario.robot), scenario.terrain
    phase = scenario.start.track_phase
    friction = (ground.left if isinstance(ground, Lanes) else ground).friction
    return Scene(
        robot=robot,
        ground=blocks_of(scenario),
        friction=friction,
        x=-scenario.start.approach - robot.foremost,
        z=-robot.lowest(phase),
        angle=0.0,
        phase=phase,
    )


def driven(engine: Engine, scenario: Scenario, scene: Scene | None = None) -> dict[str, Any]:
    """Drive through what a scenario says; the speed rises as in crawler2d.

    Parameters
    ----------
    engine : Engine
        In which.
    scenario : Scenario
        Robot, ground, command and longest time.
    scene : Scene, optional
        What is built, at rest, in place of what the scenario says.

    Returns
    -------
    dict
        How the run ends, when [s], the last pose of the chassis frame [m, rad], its heading in
        space among it, the largest yaw and roll [rad], and what a simulated second took [s].
    """
    outline, drivetrain = scenario.robot.outline, scenario.robot.drivetrain
    goal = goal_of(scenario) + outline.rear_radius
    judge = Judge(goal=goal, duration=scenario.duration)
    rear = (outline.ends[0][0], outline.ends[0][1], 0.0)
    step = engine.time_step
    looks = max(1, round(_LOOK / step))
    rise, top = drivetrain.max_acceleration, scenario.drive.speed
    begun = time.perf_counter()
    world = engine.world(scene or scene_of(scenario))
    count, end, yaw, roll = 0, "", 0.0, 0.0
    while not end:
        steps = range(count + 1, count + looks + 1)
        world.advance([min(top, rise * step * number) for number in steps])
        count += looks
        pose = world.pose()
        angles = pose.rpy
        roll, yaw = max(roll, abs(angles[0])), max(yaw, abs(angles[2]))
        x = float(pose.at((rear[0], 0.0, rear[1]))[0])
        end = judge.end(step * count, x, angles) if math.isfinite(x) else "not a number"
    world.close()
    return {
        "end": end,
        "time": round(step * count, 3),
        "x": round(float(pose.place[0]), 5),
        "y": round(float(pose.place[2]), 5),
        "angle": round(-angles[1], 5),
        "heading": round(angles[2], 5),
        "yaw": round(yaw, 4),
        "roll": round(roll, 4),
        "cost": round((time.perf_counter() - begun) / (step * count), 4),
    }
