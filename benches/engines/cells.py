"""What is driven over what, and how the runs of a cell differ."""

from __future__ import annotations

import json
import os
import zlib
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path

import numpy as np

from benches.engines.robots import robot_of
from crawler2d.parameters.robot import Robot
from crawler2d.parameters.scenario import Scenario
from crawler2d.parameters.settings import Drive, Start
from crawler2d.parameters.terrain import (
    Barrier,
    DiagonalBarrier,
    Flat,
    Lanes,
    RandomStepfield,
    Step,
    Terrain,
)

__all__ = ["CELLS", "GROUNDS", "STARTS", "Cell", "read", "write"]

CELLS = Path(__file__).with_name("cells.json")
STARTS = 16
"""Runs of a cell that are predicted; an engine may have fewer."""

GROUNDS = ("step", "knife edge", "oblique edge", "one-sided edge", "step field")
"""The last three are not the same across the robot."""

_THICK = 0.01  # [m] of edges
_YAW = 0.35  # [rad] of oblique ones
_SPEED = 0.2  # [m/s]
_LENGTHS = 5.5  # axle distances at that speed: twice the longest way
_FIELD = 2.0  # [m] more for a step field, which is half as long
_SEEDS = 1000
_HEIGHT, _FRICTION = 0.03, 0.05  # [-] by which they vary, either way


@dataclass(frozen=True, slots=True, kw_only=True)
class Cell:
    """What the runs of a cell share.

    Parameters
    ----------
    group : {"plane", "space", "paper"}
        Whether the ground is the same across the robot; "paper" has the settings of the public
        simulation model.
    robot, model, drive : str
        See `robots`.
    ground : str
        One of `GROUNDS`.
    height : float
        [m] Of the obstacle, or of one level of a step field.
    friction : float
        [-] Between robot and ground.
    """

    group: str
    robot: str
    model: str
    drive: str
    ground: str
    height: float
    friction: float

    @property
    def label(self) -> str:
        """Its name."""
        where = f"{self.ground} of {1e3 * self.height:.4g} mm, friction {self.friction:.4g}"
        return f"{self.robot}; {self.model}; {self.drive}; {where}"

    @property
    def is_even(self) -> bool:
        """Whether its ground is the same across the robot."""
        return self.ground in GROUNDS[:2]

    @property
    def is_coupled(self) -> bool:
        """Whether the limit of one motor a track counts: it has less than makes wheels slip."""
        return self.drive == "6 N m, track"

    def built(self) -> Robot:
        """Return its robot."""
        return robot_of(self.robot, self.model, self.drive)

    def scenarios(self, count: int = STARTS) -> list[Scenario]:
        """Return its first runs.

        They differ in approach (a quarter of the axle distance), phase of the wheels (a turn),
        height (3 % either way) and friction (5 %); every step field is another one.
        """
        robot = self.built()
        length = robot.outline.axle_distance
        way = _LENGTHS * length + (_FIELD if self.ground == "step field" else 0.0)
        draw = np.random.default_rng(zlib.crc32(self.label.encode())).uniform
        found = []
        for _ in range(count):
            far = length * draw(0.075, 0.325)
            along = draw(0.0, 2.0 * np.pi * robot.outline.front_radius)
            height = self.height * draw(1.0 - _HEIGHT, 1.0 + _HEIGHT)
            friction = self.friction * draw(1.0 - _FRICTION, 1.0 + _FRICTION)
            ground = terrain_of(self.ground, height, friction)
            if isinstance(ground, RandomStepfield):
                ground = replace(ground, seed=int(draw(0.0, _SEEDS)))
            found.append(
                Scenario(
                    robot,
                    ground,
                    drive=Drive(speed=_SPEED),
                    start=Start(approach=float(far), track_phase=float(along)),
                    duration=round(way / _SPEED, 2),
                )
            )
        return found


def terrain_of(ground: str, height: float, friction: float) -> Terrain:
    """Return a ground by its name; on one that is not the same across, roll and yaw are held."""
    match ground:
        case "step":
            return Step(height, friction=friction)
        case "knife edge":
            return Barrier(height, _THICK, friction=friction)
        case "oblique edge":
            return DiagonalBarrier(_YAW, height=height, thickness=_THICK, friction=friction)
        case "one-sided edge":
            edge = Barrier(height, _THICK, friction=friction)
            return Lanes(left=edge, right=Flat(length=_THICK, friction=friction))
        case "step field":
            return RandomStepfield(rise=height, friction=friction)
    raise ValueError(f"{ground}: must be one of {', '.join(GROUNDS)}")


def read(path: Path = CELLS) -> list[Cell]:
    """Read cells."""
    return [Cell(**row) for row in json.loads(path.read_text(encoding="utf-8"))]


def write(cells: Sequence[Cell], path: Path = CELLS) -> None:
    """Write cells, one line each; the file is whole at any time."""
    lines = ",\n".join(json.dumps(asdict(cell)) for cell in cells)
    new = path.with_suffix(".new")
    new.write_text(f"[\n{lines}\n]\n", encoding="utf-8")
    os.replace(new, path)
