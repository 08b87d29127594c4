"""How finely to step a chain of shoes: gaps, height and rates over accuracies."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from crawler2d.parameters.scenario import Scenario
from crawler2d.parameters.settings import Drive
from crawler2d.parameters.track import SegmentalTrack
from crawler2d.presets import terrains
from crawler2d.presets.robots import engineer
from crawler2d.runs.batch import simulate_many
from crawler2d.sweeps.rates import rates_of
from crawler2d.sweeps.sweep import sweep
from research.columns import aligned

if TYPE_CHECKING:
    from collections.abc import Sequence

__all__ = ["ACCURACIES", "HEIGHTS", "ChainStep", "chain_steps", "chain_steps_text"]

ACCURACIES = (1e-7, 3e-7, 1e-6, 3e-6, 1e-5)
"""[m] Of the solver."""
HEIGHTS = (0.11,)
"""[m] Heights of the steps; the chain of 22 shoes clears about a third of the runs."""

_FRICTION = 0.9
# [s] Duration of the run on flat ground, and when its speed is steady.
_FLAT, _STEADY = 10.0, 3.0


@dataclass(frozen=True, slots=True, kw_only=True)
class ChainStep:
    """How the chain does with one accuracy of the solver."""

    accuracy: float
    """[m]"""
    step: float
    """[s] Mean length of a step, over all runs over the steps."""
    flat_gap: float
    """[m] Largest gap of a pin on flat ground."""
    gap: float
    """[m] Largest gap of a pin in all runs over the steps."""
    lowest: float
    """[m] Lowest and highest position of the chassis frame on flat ground."""
    highest: float
    cleared: tuple[tuple[float, float, float], ...]
    """[-] Rate of clearing with Wilson's 95 % interval, for each height."""
    cost: float
    """[s] Wall time per simulated second, all runs over the steps together."""


def chain_steps(
    heights: Sequence[float] = HEIGHTS,
    *,
    repeats: int = 40,
    seed: int = 0,
    threads: int | None = None,
    accuracies: Sequence[float] = ACCURACIES,
) -> list[ChainStep]:
    """Run the Engineer's chain of 22 shoes on flat ground and steps, with the same draws.

    Parameters
    ----------
    heights : sequence of float
        [m] Heights of the steps.
    repeats, seed, threads : int
        See `sweep`.
    accuracies : sequence of float
        [m] Of the solver.

    Returns
    -------
    list of ChainStep
        One for each of `accuracies`.
    """
    robot = engineer(flippers=None, track=SegmentalTrack(shoe_count=22)).without_rotors()
    drive = Drive(speed=0.4)
    base = Scenario(robot, terrains.step(heights[0], friction=_FRICTION), drive=drive)
    table = sweep(
        base,
        {"solver.accuracy": list(accuracies), "terrain.height": list(heights)},
        repeats=repeats,
        seed=seed,
        wall_time=True,
        threads=threads,
    )
    level = Scenario(robot, terrains.flat(friction=_FRICTION), drive=drive, duration=_FLAT)
    rides = simulate_many(
        [level.replace({"solver.accuracy": accuracy}) for accuracy in accuracies], threads=threads
    )
    rates = rates_of(table)
    found = []
    for accuracy, ride in zip(accuracies, rides, strict=True):
        own, cells = table.sel(accuracy=accuracy), rates.sel(accuracy=accuracy)
        simulated = own["time"].sum().item()
        height = ride.position[ride.time > _STEADY, 1]
        figures = (cells[name].to_numpy().tolist() for name in ("rate", "low", "high"))
        found.append(
            ChainStep(
                accuracy=accuracy,
                step=simulated / own["steps"].sum().item(),
                flat_gap=ride.metrics["max_pin_gap"],
                gap=own["max_pin_gap"].max().item(),
                lowest=float(np.min(height)),
                highest=float(np.max(height)),
                cleared=tuple(zip(*figures, strict=True)),
                cost=own["wall_time"].sum().item() / simulated,
            )
        )
    return found


def chain_steps_text(found: Sequence[ChainStep], heights: Sequence[float] = HEIGHTS) -> str:
    """Write one row per accuracy."""
    rows = [
        (
            f"{1e6 * row.accuracy:g}",
            f"{1e3 * row.step:.2f}",
            f"{1e6 * row.flat_gap:.1f}",
            f"{1e6 * row.gap:.0f}",
            f"{1e3 * row.lowest:.2f} to {1e3 * row.highest:.2f}",
            *(f"{share:.2f} ({low:.2f} to {high:.2f})" for share, low, high in row.cleared),
            f"{1e3 * row.cost:.0f}",
        )
        for row in found
    ]
    head = (
        *("accuracy [um]", "step [ms]", "gap, flat [um]", "gap, steps [um]", "height, flat [mm]"),
        *(f"cleared {1e3 * height:.0f} mm" for height in heights),
        "cost [ms/s]",
    )
    return aligned(head, rows)
