"""The tables of the seizure study, made from the sweeps: each row is a dataclass."""

from __future__ import annotations

import csv
import dataclasses
import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from crawler2d.sweeps.rates import rates_of

if TYPE_CHECKING:
    from pathlib import Path

    import xarray

__all__ = [
    "Cell",
    "Climb",
    "Phase",
    "Ride",
    "cells",
    "climbs",
    "phases",
    "rides",
    "write_csv",
]


@dataclass(frozen=True, slots=True, kw_only=True)
class Cell:
    """One model on one obstacle of one height, all repeats together."""

    robot: str
    obstacle: str
    model: str
    height: float
    """[m]"""
    cleared: int
    count: int
    rate: float
    low: float
    """[-] Lower bound of Wilson's 95 % interval."""
    high: float
    poses: int
    """Distinct final poses, to 1 mm and 0.1 degree; if few, the runs were not independent."""
    others: str
    """Outcomes of the runs that did not clear, with their number."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Climb:
    """The greatest height of an obstacle that a model clears."""

    obstacle: str
    model: str
    highest: float
    """[m] Greatest height cleared in at least half of the runs; nan if there is none."""
    gaps: tuple[float, ...]
    """[m] Smaller heights cleared in less than half of the runs."""
    tested: float
    """[m] Greatest height tried."""
    simulated_time: float
    """[s] Simulated time of all runs."""
    computing_time: float
    """[s] Computing time of all runs on one thread."""
    max_penetration: float
    """[m] Largest penetration in all runs."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Ride:
    """One model on flat ground, the mean of its runs."""

    model: str
    over_reading: float
    """[-] Odometry error: track distance over path length, minus 1."""
    vertical_acceleration: float
    """[m/s^2] Root mean square."""
    angular_velocity: float
    """[rad/s] Root mean square."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Phase:
    """One line of gear wheels on flat ground, the mean of its runs."""

    count: int
    phase_fraction: float
    vertical_acceleration: float
    """[m/s^2] Root mean square."""
    angular_velocity: float
    """[rad/s] Root mean square."""


def cells(table: xarray.Dataset, obstacle: str, robot: str = "preset") -> list[Cell]:
    """Count the outcomes of a sweep over track and height.

    Parameters
    ----------
    table : xarray.Dataset
        With the dimensions track, height and repeat.
    obstacle, robot : str
        Names of the obstacle and of the robot.
    """
    rates = rates_of(table)
    found = []
    for model in table["track"].to_numpy():
        for height in table["height"].to_numpy():
            place = {"track": model, "height": height}
            endings = Counter(table["outcome"].sel(place).to_numpy().tolist())
            cleared = endings.pop("cleared", 0)
            own = rates.sel(place)
            found.append(
                Cell(
                    robot=robot,
                    obstacle=obstacle,
                    model=str(model),
                    height=float(height),
                    cleared=cleared,
                    count=own["count"].item(),
                    rate=own["rate"].item(),
                    low=own["low"].item(),
                    high=own["high"].item(),
                    poses=own["distinct"].item(),
                    others=", ".join(f"{n} {name}" for name, n in endings.most_common()),
                )
            )
    return found


def climbs(table: xarray.Dataset, obstacle: str) -> list[Climb]:
    """Summarise a sweep over track and height, one row per model."""
    often = rates_of(table)["rate"] >= 0.5
    heights = table["height"].to_numpy()
    found = []
    for model in table["track"].to_numpy():
        own = table.sel(track=model)
        cleared = often.sel(track=model).to_numpy()
        highest = heights[cleared].max() if cleared.any() else math.nan
        found.append(
            Climb(
                obstacle=obstacle,
                model=str(model),
                highest=float(highest),
                gaps=tuple(heights[~cleared & (heights < highest)].tolist()),
                tested=float(heights.max()),
                simulated_time=own["time"].sum().item(),
                computing_time=own["wall_time"].sum().item(),
                max_penetration=own["max_penetration"].max().item(),
            )
        )
    return found


def rides(table: xarray.Dataset) -> list[Ride]:
    """Average a sweep over track on flat ground."""
    over_reading = (table["track_distance"] / table["path_length"] - 1.0).mean("repeat")
    return [
        Ride(
            model=str(model),
            over_reading=over_reading.sel(track=model).item(),
            **_shaking(table.sel(track=model)),
        )
        for model in table["track"].to_numpy()
    ]


def phases(table: xarray.Dataset) -> list[Phase]:
    """Average a sweep over robot_track_count and phase_fraction on flat ground."""
    return [
        Phase(
            count=int(count),
            phase_fraction=float(fraction),
            **_shaking(table.sel(robot_track_count=count, phase_fraction=fraction)),
        )
        for count in table["robot_track_count"].to_numpy()
        for fraction in table["phase_fraction"].to_numpy()
    ]


def _shaking(runs: xarray.Dataset) -> dict[str, float]:
    names = ("vertical_acceleration", "angular_velocity")
    return {name: runs[name].mean().item() for name in names}


def write_csv(path: Path, rows: Sequence[Any]) -> None:
    """Write rows of one dataclass, with the names of its fields as the header."""
    names = [column.name for column in dataclasses.fields(rows[0])]
    with path.open("w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(names)
        writer.writerows([_plain(getattr(row, name)) for name in names] for row in rows)


def _plain(value: object) -> object:
    return " ".join(map(str, value)) if isinstance(value, tuple) else value
