"""The standard obstacles of an audit: scaled to the robot, so that large and small ones compare."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

from crawler2d.errors import ScenarioError
from crawler2d.parameters.robot import Robot, TrackOutline
from crawler2d.parameters.terrain import (
    Barrier,
    DiagonalBarrier,
    Gap,
    Lane,
    RandomStepfield,
    Ridge,
    Stairs,
    Step,
    Terrain,
)

__all__ = ["read_obstacles", "standard_obstacles"]

_STEPS = (0.5, 0.8, 1.1)  # radii
_HIGH = 1.5  # radii: too high for a belt without flippers whose centre of mass is not low
_KNIVES = (0.4, 0.8)


def standard_obstacles(robot: Robot, friction: float) -> dict[str, Terrain]:
    """Return the standard obstacles of a robot, by what they are.

    Every length is a multiple of R, the height of the front axle above the lowest point of the
    outline, which is the radius of equal ends, or of L, the axle distance:

    - steps of 0.5, 0.8 and 1.1 R, with flippers also of 1.5 R;
    - a kerb, 0.8 R high, whose edge is rounded by 0.3 R;
    - a barrier, 0.8 R high and R thick, and the same at a yaw of 30 degrees;
    - knife edges of 0.4 and 0.8 R, 0.1 R thick, which fit between wheels;
    - ridges, 0.8 R high with an edge of 60 degrees and 0.5 R with one of 120;
    - three stairs of 0.8 R on 2 R, a slope of 22 degrees, which a friction of 0.5 still holds;
    - a gap of 0.3 L, which a belt bridges with its centre of mass anywhere in the middle third;
    - a random step field, eight posts of 1.5 R long with four levels of 0.25 R, of which every run
      has its own.

    The highest are about as high as a closed track of these proportions climbs (a rigid belt with
    its centre of mass in the middle, at axle height, climbs 1.3 to 1.7 R), so that where wheels
    stop, a belt has a chance. The clearance of the belly sets none of them: the lower run of a belt
    covers the belly, and over a thin obstacle it is the belt that bears.

    Parameters
    ----------
    robot : Robot
        The robot.
    friction : float
        [-] Of all of them.

    Returns
    -------
    dict of str to terrain
        By what it is, with its measures in mm.

    Examples
    --------
    >>> import crawler2d as c2d
    >>> found = standard_obstacles(c2d.robots.engineer(flippers=None), friction=0.8)
    >>> len(found), list(found)[:3], found["knife edge 51 mm"].thickness
    (13, ['step 32 mm', 'step 51 mm', 'step 70 mm'], 0.0064)
    """
    radius, axles = _front_axle_height(robot.outline), robot.outline.axle_distance
    heights = _STEPS if robot.flippers is None else (*_STEPS, _HIGH)
    high = 0.8 * radius
    found: dict[str, Lane | DiagonalBarrier | RandomStepfield] = {
        f"step {_mm(part * radius)}": Step(part * radius) for part in heights
    }
    found[f"rounded kerb {_mm(high)}"] = Step(high, edge_radius=0.3 * radius)
    found[f"barrier {_mm(high)}"] = Barrier(high, radius)
    found[f"diagonal barrier {_mm(high)}"] = DiagonalBarrier(
        math.radians(30.0), height=high, thickness=radius
    )
    for part in _KNIVES:
        found[f"knife edge {_mm(part * radius)}"] = Barrier(part * radius, 0.1 * radius)
    found[f"sharp ridge {_mm(high)}"] = Ridge(high, math.radians(60.0))
    found[f"blunt ridge {_mm(0.5 * radius)}"] = Ridge(0.5 * radius, math.radians(120.0))
    found[f"stairs of {_mm(high)}"] = Stairs(count=3, rise=high, run=2.0 * radius)
    found[f"gap {_mm(0.3 * axles)}"] = Gap(0.3 * axles, depth=2.0 * radius)
    found["step field"] = RandomStepfield(posts=8, post=1.5 * radius, rise=0.25 * radius)
    return {name: replace(ground, friction=friction) for name, ground in found.items()}


def read_obstacles(obstacles: object) -> dict[str, Terrain]:
    """Read the argument `obstacles`: a mapping from labels to terrains.

    Raises
    ------
    ScenarioError
        If it is none, or empty.
    """
    if not isinstance(obstacles, Mapping) or not obstacles:
        raise ScenarioError("obstacles", obstacles, "must be a mapping from labels to terrains")
    for label, ground in obstacles.items():
        if not isinstance(label, str):
            raise ScenarioError("obstacles", label, "must have strings as labels")
        if not isinstance(ground, Terrain):
            raise ScenarioError(f"obstacles[{label!r}]", ground, "must be a terrain")
    return dict(obstacles)


def _front_axle_height(outline: TrackOutline) -> float:
    """[m] Return how high an edge is that meets the front end at its axle: belts climb about that.

    The radius of the front end says less: an idler that is raised is small.
    """
    _, (_, y, _) = outline.ends
    return y - min(y - radius for _, y, radius in outline.discs)


def _mm(length: float) -> str:
    return f"{1e3 * length:.0f} mm"
