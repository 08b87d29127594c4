"""Random robots on wheels before random obstacles, none of which a study uses."""

from __future__ import annotations

import dataclasses
import math

import numpy as np

import crawler2d as c2d
from crawler2d.errors import ScenarioError
from crawler2d.parameters.scenario import Scenario
from crawler2d.parameters.settings import Solver
from crawler2d.parameters.terrain import Terrain
from crawler2d.parameters.track import Track

__all__ = ["MODELS", "drawn"]

MODELS = ("line", "row", "gears", "small wheels", "placed wheels", "free wheels")
"""Lines with gaps; rows that touch or overlap; gear wheels; small round wheels all round; wheels of
unlike radii; a force along the chassis on free wheels."""


def drawn(number: int) -> tuple[str, Scenario]:
    """Draw a robot and an obstacle that rapier holds; the same number gives the same ones.

    The models take turns. Masses are 5 to 80 kg, axle distances 0.25 to 0.8 m, radii 0.12 to 0.24
    of these; obstacles are steps, barriers and ridges of 0.2 to 1.2 radii, friction 0.4 to 1.0.
    """
    model = MODELS[number % len(MODELS)]
    rng = np.random.default_rng([24, number])
    while True:
        scenario = _scenario(model, rng)
        try:
            scenario.replace({"solver": Solver(engine="rapier")}).validate()
        except ScenarioError:
            continue  # the next draws
        return model, scenario


def _scenario(model: str, rng: np.random.Generator) -> Scenario:
    length = float(rng.uniform(0.25, 0.8))
    radius = float(rng.uniform(0.12, 0.24)) * length
    mass = float(rng.uniform(5.0, 80.0))
    robot = c2d.Robot.simple(mass, axle_distance=length, radius=radius)
    x, y = robot.center_of_mass
    x += float(rng.uniform(-0.1, 0.1)) * length
    y += float(rng.uniform(0.0, 0.1)) * length
    sharing = str(rng.choice(["track", "wheel"]))
    torque = float(rng.uniform(0.2, 2.0)) * mass * 9.81 * radius
    robot = dataclasses.replace(robot, center_of_mass=(x, y), track=_track(model, rng, robot))
    if rng.random() < 0.5:
        robot = dataclasses.replace(robot, belly=None)
    height = float(rng.uniform(0.2, 1.2)) * radius
    friction = float(rng.uniform(0.4, 1.0))
    grounds: dict[str, Terrain] = {
        "step": c2d.terrains.step(height, friction=friction),
        "barrier": c2d.terrains.barrier(height, 0.5 * length, friction=friction),
        "ridge": c2d.terrains.ridge(height, float(rng.uniform(1.0, 2.0)), friction=friction),
    }
    ground = grounds[str(rng.choice(list(grounds)))]
    return Scenario(
        robot,
        ground,
        drive=c2d.Drive(speed=float(rng.uniform(0.05, 0.4))),
        start=c2d.Start(approach=float(rng.uniform(0.05, 0.05 + 0.25 * length))),
    ).replace({"robot.drivetrain.torque_sharing": sharing, "robot.drivetrain.max_torque": torque})


def _track(model: str, rng: np.random.Generator, robot: c2d.Robot) -> Track:
    outline = robot.outline
    length, radius = outline.axle_distance, outline.front_radius
    touching = 1 + math.ceil(length / (2.0 * radius))
    if model == "line":
        return c2d.LineOfWheels(int(rng.integers(2, touching + 1)))
    if model == "row":
        return c2d.LineOfWheels(touching + int(rng.integers(0, 4)))
    if model == "gears":
        return c2d.LineOfWheels(
            int(rng.integers(2, touching + 3)),
            wheel=c2d.GearWheel(
                grouser_count=int(rng.integers(7, 13)), grouser_height=0.18 * radius
            ),
        )
    if model == "small wheels":
        around = 2.0 * (math.pi * radius + length)
        return c2d.CircumferentialWheels(max(int(around / radius * rng.uniform(1.0, 1.6)), 14))
    if model == "placed wheels":
        count = int(rng.integers(1, 4))
        small = float(rng.uniform(0.4, 0.7)) * radius
        between = np.linspace(-0.5, 0.5, count + 2)[1:-1] * length
        ends = [(-0.5 * length, 0.0, radius), (0.5 * length, 0.0, radius)]
        return c2d.HybridWheels(
            (ends[0], *((float(x), small - radius, small) for x in between), ends[1])
        )
    return c2d.ForceTrack(support="wheels")
