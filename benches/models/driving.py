"""One run in an engine: the command of crawler2d, judged by one rule."""

from __future__ import annotations

import math
from typing import Any

from benches.models.engine import Engine, Scene, Touch
from benches.models.files import ModelFile
from benches.models.ground import boxes_of, profile_of
from benches.models.judge import Judge
from crawler2d.parameters.scenario import Scenario

__all__ = ["driven"]

_LOOK = 0.01  # [s] between two looks of the judge


def driven(engine: Engine, model: ModelFile, scenario: Scenario) -> dict[str, Any]:
    """Drive a model file through what a scenario says.

    The speed rises as in crawler2d, at `max_acceleration`.

    Parameters
    ----------
    engine : Engine
        In which.
    model : ModelFile
        What drives.
    scenario : Scenario
        Its ground, start, command and longest time.

    Returns
    -------
    dict
        How it ends, when [s], the last pose of the chassis frame [m, rad], the largest yaw and roll
        [rad], by how much the worst flipper bent [rad], and the contacts of a stop.
    """
    robot, ground = scenario.robot, scenario.terrain
    profile = profile_of(ground)
    scene = Scene(
        model=model,
        ground=boxes_of(profile),
        friction=ground.friction,  # type: ignore[union-attr] # lanes have no profile
        x=-scenario.start.approach - model.foremost,
        phase=scenario.start.track_phase,
        time_step=engine.time_step,
    )
    world = engine.world(scene)
    goal = float(profile[-2, 0]) + robot.outline.rear_radius
    judge = Judge(goal=goal, duration=scenario.duration)
    rear = (-0.5 * robot.outline.axle_distance, 0.0, 0.0)
    looks = max(1, round(_LOOK / engine.time_step))
    rise, top = robot.drivetrain.max_acceleration, scenario.drive.speed
    yaw = roll = bend = 0.0
    step, end, speed = 0, "", 0.0
    while not end:
        for _ in range(looks):
            step += 1
            if speed < top:
                speed = min(top, rise * step * engine.time_step)
                world.command(speed)
            world.advance()
        pose = world.pose()
        angles = pose.rpy
        roll, yaw = max(roll, abs(angles[0])), max(yaw, abs(angles[2]))
        bend = max(bend, world.bend())
        x = float(pose.at(rear)[0])
        end = judge.end(step * engine.time_step, x, angles)
        if not math.isfinite(x):
            end = "not a number"
    found = {
        "end": end,
        "time": round(step * engine.time_step, 3),
        "x": round(float(pose.place[0]), 4),
        "y": round(float(pose.place[2]), 4),
        "angle": round(-angles[1], 4),
        "yaw": round(yaw, 4),
        "roll": round(roll, 4),
        "bend": round(bend, 5),
        "touches": [_plain(touch) for touch in world.touches()] if end == "stopped" else [],
    }
    world.close()
    return found


def _plain(touch: Touch) -> dict[str, Any]:
    """Write a contact with as many digits as tell."""
    return {
        "link": touch.link,
        "point": [round(each, 4) for each in touch.point],
        "normal": [round(each, 3) for each in touch.normal],
        "force": round(touch.force, 1),
    }
