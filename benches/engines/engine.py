"""What an engine must do for the comparison, and what it is given."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

from benches.engines.ground import TurnedBox
from benches.engines.solid import Solid
from crawler2d.model_tree import Pose

__all__ = ["Engine", "Scene", "World"]


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Scene:
    """What a world is built of.

    Parameters
    ----------
    robot : Solid
        The robot.
    ground : sequence of TurnedBox
        The ground.
    friction : float
        [-] Between robot and ground.
    x, z, angle : float
        [m], [rad] Of the chassis frame at time 0, nose up > 0.
    phase : float
        [m] By which the surface of every wheel has advanced at time 0.
    """

    robot: Solid
    ground: Sequence[TurnedBox]
    friction: float
    x: float
    z: float
    angle: float
    phase: float


class World(Protocol):
    """A robot on its ground."""

    def advance(self, speeds: Sequence[float]) -> None:
        """Take a step for each set-point of the speed of all surfaces [m/s]."""

    def pose(self) -> Pose:
        """Return where the chassis frame is."""

    def close(self) -> None:
        """Free what the world holds."""


class Engine(Protocol):
    """An engine at one setting.

    Parameters
    ----------
    version : str
        Of the engine, with its name.
    time_step : float
        [s] Of a step.
    in_space : bool
        Whether it has three dimensions; else the ground must be the same across.
    """

    version: str
    time_step: float
    in_space: bool

    def world(self, scene: Scene) -> World:
        """Build a world."""
