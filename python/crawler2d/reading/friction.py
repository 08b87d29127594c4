"""Friction of tracks on the ground, by the rule by which an engine combines two surfaces."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

from crawler2d.errors import ScenarioError
from crawler2d.models.tree import Shape
from crawler2d.models.where import Where
from crawler2d.reading.parts import Runner
from crawler2d.reading.view import SideView

__all__ = ["ENGINES", "Engine", "combined"]

Engine = Literal["gz", "classic", "bullet", "mujoco", "isaac"]

_SAME = 1e-9  # [-] Coefficients are as written: no rounding lies between two that are meant equal.


@dataclass(frozen=True, slots=True, kw_only=True)
class Rule:
    """How an engine combines the coefficients of two surfaces.

    Parameters
    ----------
    of_two : callable
        What it makes of both.
    word : str
        What that is called.
    usual : float
        [-] The coefficient of a surface of which a file says nothing.
    """

    of_two: Callable[[float, float], float]
    word: str
    usual: float


ENGINES: dict[str, Rule] = {
    # The smaller: DefaultContactSurfaceHandler of DART, which gz-sim runs, and ODEPhysics::Collide
    # of Gazebo Classic. In SDFormat, mu is 1.
    "gz": Rule(of_two=min, word="min", usual=1.0),
    "classic": Rule(of_two=min, word="min", usual=1.0),
    # btManifoldResult::calculateCombinedFriction; URDF's lateral_friction is 0.5 in UrdfParser.
    "bullet": Rule(of_two=lambda a, b: min(a * b, 10.0), word="product", usual=0.5),
    # MuJoCo's documentation, Computation, Contact parameters: the larger, element by element,
    # unless one geom has the higher priority. The default of geom/friction is 1.
    "mujoco": Rule(of_two=max, word="max", usual=1.0),
    # PhysX, PxMaterial: the combine mode is eAVERAGE by default. Isaac's material has 0.5.
    "isaac": Rule(of_two=lambda a, b: 0.5 * (a + b), word="mean", usual=0.5),
}
"""The rules by engine."""


def combined(
    runners: list[Runner], view: SideView, engine: str, ground: float
) -> tuple[float, str, list[Where]]:
    """Combine the friction of every wheel with that of the ground.

    Parameters
    ----------
    runners : list of Runner
        All wheels and drums, at least one.
    view : SideView
        The side view, for the direction of the coefficients.
    engine : {"gz", "classic", "bullet", "mujoco", "isaac"}
        The engine.
    ground : float
        [-] Coefficient of the ground's own surface.

    Returns
    -------
    friction : float
        [-] Between tracks and ground.
    source : str
        How it came about.
    places : list of Where
        The lines that state it; empty if none does.

    Raises
    ------
    ScenarioError
        If it differs from wheel to wheel, or has no limit.
    """
    rule = ENGINES[engine]
    first: tuple[float, str] | None = None
    places = []
    for runner, shape in [(each, shape) for each in runners for shape in each.surfaces]:
        own, priority, where = _along(runner, shape, view, rule.usual)
        wins = engine == "mujoco" and priority > 0
        value = own if wins else rule.of_two(own, ground)
        of_own = f"{own:g}" if where else f"{own:g}, the engine's default,"
        word = "of higher priority" if wins else f"{rule.word} with {ground:g} of the ground"
        if first is None:
            first = value, f"{of_own} along the track, {word}"
        if abs(value - first[0]) > _SAME:
            path = f"{where or shape.at}: friction[{runner.name}]"
            raise ScenarioError(path, value, f"must be that of all wheels, {first[0]:g}")
        if where is not None:
            places.append(where)
    assert first is not None  # a model without wheels has been refused
    if not math.isfinite(first[0]):
        raise ScenarioError(f"{places[0]}: friction", first[0], "must have a limit")
    return (*first, places)


def _along(
    runner: Runner, shape: Shape, view: SideView, usual: float
) -> tuple[float, int, Where | None]:
    """Return the coefficient along the track, its priority, and its line.

    A controller of tracks turns the first direction along the track. Else it is fdir1, in the frame
    of the collision; without one, an engine may turn it anywhere, and the smaller holds.
    """
    found = shape.friction
    if found is None:
        return usual, 0, None
    if runner.joint is None:
        is_first = True
    elif found.direction is None:
        is_first = found.first <= found.second
    else:
        is_first = bool(abs(found.direction @ view.left) <= math.sqrt(0.5))
    if is_first:
        return found.first, found.priority, found.first_at
    return found.second, found.priority, found.second_at
