"""Sixty scenes of every track model on every kind of obstacle, some of them drawn."""

import math
import random

import crawler2d as c2d
from crawler2d.parameters.scenario import Scenario
from crawler2d.parameters.terrain import Terrain
from tests.shared import GEAR, PLACEMENTS, ROBOT, with_flippers

ROBOTS = {
    "force": ROBOT.with_track(c2d.ForceTrack()),
    "line of wheels": ROBOT.with_track(c2d.LineOfWheels(5)),
    "circumferential wheels": ROBOT.with_track(c2d.CircumferentialWheels(24, wheel_radius=0.015)),
    "hybrid": ROBOT.with_track(c2d.HybridWheels(PLACEMENTS)),
    "gear wheels": ROBOT.with_track(c2d.LineOfWheels(4, wheel=GEAR)),
    "chain on a guide": ROBOT.with_track(c2d.SegmentalTrack(shoe_count=30)),
    "chain round a sprocket": ROBOT.with_track(
        c2d.SegmentalTrack(mechanism="sprocket", shoe_count=30)
    ),
    "belt": ROBOT.with_track(c2d.BeltTrack()),
    "belt with grousers": ROBOT.with_track(c2d.GrouserBeltTrack(grouser_count=20)),
    "flippers": with_flippers(c2d.BeltTrack()),
}


def _rough(draw: random.Random) -> Terrain:
    """A walk of slopes and low walls between level ends."""
    x, y, points = 0.0, 0.0, [(-20.0, 0.0), (0.0, 0.0)]
    for _ in range(12):
        if draw.random() < 0.4:
            y = max(-0.05, min(0.05, y + draw.uniform(-0.04, 0.04)))
            points.append((x, y))
        x += draw.uniform(0.05, 0.3)
        points.append((x, y))
    return c2d.terrains.from_points([*points, (x + 20.0, y)], goal=x)


def grounds(draw: random.Random) -> dict[str, Terrain]:
    """Six obstacles whose measures are drawn."""
    edge = draw.choice((0.0, 0.002, 0.005))
    t = c2d.terrains
    return {
        "step": t.step(draw.uniform(0.02, 0.08), edge_radius=edge),
        "barrier": t.barrier(
            draw.uniform(0.03, 0.08), draw.uniform(0.02, 0.1), edge_radius=edge, friction=0.7
        ),
        "step field": t.random_stepfield(
            draw.randrange(1000), posts=8, rise=draw.uniform(0.01, 0.03), edge_radius=edge
        ),
        "gap": t.gap(draw.uniform(0.05, 0.2), edge_radius=edge),
        "stairs": t.stairs(
            count=3, rise=draw.uniform(0.03, 0.06), run=draw.uniform(0.1, 0.3), edge_radius=edge
        ),
        "rough": _rough(draw),
    }


def scenes(seed: int) -> dict[tuple[str, str], Scenario]:
    """One scene for each model and obstacle; a fifth have other friction."""
    found = {}
    for name, robot in ROBOTS.items():
        for ground, terrain in grounds(random.Random(f"{seed}:{name}")).items():
            draw = random.Random(f"{seed}:{name}:{ground}")
            fields = {"start.angle": draw.choice((0.0, 0.0, 0.0, math.radians(2.0)))}
            if draw.random() < 0.2:
                fields["terrain.friction"] = draw.uniform(0.3, 1.2)
            found[name, ground] = Scenario(robot, terrain).replace(fields)
    return found
