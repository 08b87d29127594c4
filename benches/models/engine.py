"""What an engine in three dimensions must do for the comparison."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from benches.models.files import ModelFile
from benches.models.ground import Box
from crawler2d.model_tree import Pose

__all__ = ["Engine", "Scene", "Touch", "World", "check"]


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Scene:
    """What a world is built of.

    Parameters
    ----------
    model : ModelFile
        The robot.
    ground : list of Box
        The ground.
    friction : float
        [-] Between robot and ground.
    x : float
        [m] Of the chassis frame at time 0; the wheels touch the ground, the chassis is level.
    phase : float
        [m] By which the surface of every wheel has advanced at time 0.
    time_step : float
        [s] Of the engine.
    """

    model: ModelFile
    ground: list[Box]
    friction: float
    x: float
    phase: float
    time_step: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Touch:
    """A contact with the ground.

    Parameters
    ----------
    link : str
        Of the robot.
    point, normal : tuple of float, shape (3,)
        [m] Where, and the direction in which the ground pushes.
    force : float
        [N] Along the normal; nan where an engine does not say.
    """

    link: str
    point: tuple[float, float, float]
    normal: tuple[float, float, float]
    force: float


class World(Protocol):
    """A robot on its ground."""

    def command(self, speed: float) -> None:
        """Let the motors turn all wheels so that their surfaces run at a speed [m/s]."""

    def advance(self) -> None:
        """Take a step."""

    def pose(self) -> Pose:
        """Return where the chassis frame is."""

    def touches(self) -> list[Touch]:
        """Return the contacts with the ground."""

    def bend(self) -> float:
        """[rad] Return by how much the worst flipper is off its angle."""

    def close(self) -> None:
        """Free what the world holds."""


class Engine(Protocol):
    """An engine.

    Parameters
    ----------
    name, version : str
        Of the engine.
    time_step : float
        [s] Chosen beforehand.
    """

    name: str
    version: str
    time_step: float

    def world(self, scene: Scene) -> World:
        """Build a world."""


def check(model: ModelFile, mass: float, axles: dict[str, list[float]]) -> None:
    """Compare what an engine has loaded with what crawler2d read.

    Parameters
    ----------
    model : ModelFile
        What was read.
    mass : float
        [kg] Of the robot in the engine.
    axles : mapping of str to list of float
        [m] Axles in the engine, flippers held, in the chassis frame.

    Raises
    ------
    ValueError
        If they differ by more than single precision does: the engine reads the file differently.
    """
    if abs(mass - model.mass) > 1e-5 * model.mass:
        raise ValueError(f"{model.path.name}: {mass:g} kg were loaded, {model.mass:g} were read")
    for name, axle in model.axles.items():
        # Where along its axle the frame of a wheel lies is free.
        off = max(abs(axle[0] - axles[name][0]), abs(axle[2] - axles[name][2]))
        if off > 1e-5:
            raise ValueError(f"{model.path.name}: {name} is {1e3 * off:.2f} mm off")
