"""The obstacles of the study: how they are drawn, and the terrain of one at a given height."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

import crawler2d as c2d
from crawler2d.parameters.terrain import Terrain

ONE_LANE = ("step", "barrier", "knife edge", "stairs")
TWO_LANES = ("two steps", "diagonal barrier", "step field")

# Their names, and those of their heights.
_TERRAINS = {
    "step": ("step", "height"),
    "barrier": ("barrier", "height"),
    "knife edge": ("knife_edge", "height"),
    "stairs": ("stairs", "rise"),
    "diagonal barrier": ("diagonal_barrier", "height"),
}

# Share of the drawn obstacles with rounded edges.
_ROUNDED = 0.3


def draw(kind: str, random: np.random.Generator) -> dict[str, Any]:
    """Draw everything about an obstacle but its height and friction.

    Parameters
    ----------
    kind : str
        One of `ONE_LANE` or `TWO_LANES`.
    random : numpy.random.Generator
        Source of the numbers.

    Returns
    -------
    dict
        Plain numbers, for a file; lengths [m], angles [rad].
    """

    def between(low: float, high: float, digits: int = 3) -> float:
        return round(float(random.uniform(low, high)), digits)

    drawn: dict[str, Any] = {"kind": kind}
    match kind:
        case "step":
            pass
        case "barrier":
            drawn |= {"thickness": between(0.05, 0.3)}
        case "knife edge":
            drawn |= {"thickness": between(0.002, 0.01)}
        case "stairs":
            drawn |= {"count": int(random.integers(2, 5)), "run": between(0.15, 0.35)}
        case "two steps":
            drawn |= {"lower": between(0.3, 0.9, 2)}
        case "diagonal barrier":
            drawn |= {"yaw": between(0.2, 1.0, 2), "thickness": between(0.05, 0.3)}
        case "step field":
            drawn |= {"seed": int(random.integers(2**32)), "posts": 8, "levels": 4}
        case _:
            raise ValueError(f"kind must be one of {ONE_LANE + TWO_LANES}, got {kind!r}")
    if kind in ("step", "barrier", "stairs") and random.random() < _ROUNDED:
        drawn["edge_radius"] = between(0.001, 0.005)
    return drawn


def terrain(obstacle: Mapping[str, Any], height: float, friction: float) -> Terrain:
    """Make the terrain.

    Parameters
    ----------
    obstacle : mapping
        As `draw` makes it.
    height : float
        [m] Of the step, the barrier, each stair, the higher of two steps, or the highest post of a
        step field.
    friction : float
        [-] Coulomb friction.
    """
    kind = obstacle["kind"]
    fields = {name: value for name, value in obstacle.items() if name != "kind"}
    if kind == "two steps":
        heights = (height, fields["lower"] * height)
        return c2d.terrains.lanes(*(c2d.terrains.step(h, friction=friction) for h in heights))
    if kind == "step field":
        rise = height / fields["levels"]
        return c2d.terrains.random_stepfield(rise=rise, friction=friction, **fields)
    name, path = _TERRAINS[kind]
    make: Callable[..., Terrain] = getattr(c2d.terrains, name)
    return make(**{path: height}, friction=friction, **fields)


def length(obstacle: Mapping[str, Any]) -> float:
    """[m] About how far the obstacle reaches."""
    match obstacle["kind"]:
        case "stairs":
            return float((obstacle["count"] - 1) * obstacle["run"])
        case "diagonal barrier":
            # The Engineer's tracks are 0.2 m apart.
            return float(0.2 * np.tan(obstacle["yaw"]) + obstacle["thickness"])
        case "step field":
            return float(obstacle["posts"] * 0.1)
        case _:
            return float(obstacle.get("thickness", 0.0))
