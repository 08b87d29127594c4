"""A cell: robot, ground and start, at a height at which some runs clear and some do not."""

from __future__ import annotations

import json
import os
import zlib
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import crawler2d as c2d
from benches.accuracy import grounds
from benches.accuracy.kinds import KINDS, Kind
from crawler2d.parameters.scenario import Scenario

FOLDER = Path(__file__).parent / "sets"

Setting = Mapping[str, Any]
"""Arguments of `Solver`."""


@dataclass(frozen=True, kw_only=True)
class Cell:
    """What all runs of a cell share."""

    name: str
    kind: str
    """Name in `KINDS`."""
    center_of_mass: tuple[float, float]
    """[m] Without flippers."""
    max_torque: float
    """[N m] Of one sprocket."""
    friction: float
    speed: float
    """[m/s]"""
    obstacle: Mapping[str, Any]
    """What `grounds.draw` made."""
    height: float
    """[m] Of the obstacle."""
    duration: float
    """[s] Longest simulated time."""
    hold_angle: float = 0.0
    """[rad] Of the flippers, for the gait that holds them."""
    found: Mapping[str, Any] = field(default_factory=dict)
    """How the height was found: rate, runs, setting, draws that had no such height."""

    @property
    def what(self) -> Kind:
        """The kind of robot."""
        return KINDS[self.kind]

    @property
    def seed(self) -> int:
        """Seed of its runs; the cells must not repeat each other's draws."""
        return 2 * zlib.crc32(f"{self.name} {self.friction}".encode())

    def scenario(self, setting: Setting) -> Scenario:
        """Make the scenario that the runs vary.

        Parameters
        ----------
        setting : mapping
            Arguments of `Solver`.
        """
        gaits = {None: None, "climb": c2d.Climb(), "hold": c2d.Hold(self.hold_angle)}
        return Scenario(
            self.what.robot(self.center_of_mass, self.max_torque),
            grounds.terrain(self.obstacle, self.height, self.friction),
            drive=c2d.Drive(speed=self.speed, gait=gaits[self.what.gait]),
            duration=self.duration,
            solver=c2d.Solver(**setting),
        )


def path_of(number: int) -> Path:
    """Where a set is kept; its number is the seed of its draws."""
    return FOLDER / f"{number}.json"


def read(path: Path) -> list[Cell]:
    """Read a set of cells; a file that is not there has none."""
    if not path.exists():
        return []
    rows = json.loads(path.read_text(encoding="utf-8"))
    return [Cell(**row | {"center_of_mass": tuple(row["center_of_mass"])}) for row in rows]


def write(path: Path, cells: Sequence[Cell]) -> None:
    """Write a set of cells, one line each; the file is whole at any time."""
    lines = ",\n".join(json.dumps(asdict(cell)) for cell in cells)
    path.parent.mkdir(parents=True, exist_ok=True)
    new = path.with_suffix(".new")
    new.write_text(f"[\n{lines}\n]\n", encoding="utf-8")
    os.replace(new, path)
