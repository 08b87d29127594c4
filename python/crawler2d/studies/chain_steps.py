"""How finely to step a chain of shoes: gaps, height and rates over time step and substeps."""

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
from crawler2d.studies.columns import aligned
from crawler2d.sweeps.rates import rate
from crawler2d.sweeps.sweep import sweep

if TYPE_CHECKING:
    from collections.abc import Sequence

__all__ = ["HEIGHTS", "STEPS", "ChainStep", "chain_steps", "chain_steps_text"]

STEPS = tuple((1e-3 * step, substeps) for step in (0.5, 1.0, 2.0) for substeps in (1, 2, 4))
"""Time step [s] and substeps."""
HEIGHTS = (0.11,)
"""[m] Heights of the steps; the chain of 22 shoes clears about half of the runs."""

_FRICTION = 0.9
# [s] Duration of the run on flat ground, and when its speed is steady.
_FLAT, _STEADY = 10.0, 3.0


@dataclass(frozen=True, slots=True, kw_only=True)
class ChainStep:
    """One time step and number of substeps."""

    time_step: float
    """[s]"""
    substeps: int
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
    steps: Sequence[tuple[float, int]] = STEPS,
) -> list[ChainStep]:
    """Run the Engineer's chain of 22 shoes on flat ground and steps, with the same draws.

    Parameters
    ----------
    heights : sequence of float
        [m] Heights of the steps.
    repeats, seed, threads : int
        See `sweep`.
    steps : sequence of (float, int)
        Time steps [s] and substeps.

    Returns
    -------
    list of ChainStep
        One for each of `steps`.
    """
    robot = engineer(flippers=None, track=SegmentalTrack(shoe_count=22))
    drive = Drive(speed=0.4)
    base = Scenario(robot, terrains.step(heights[0], friction=_FRICTION), drive=drive)
    table = sweep(
        base,
        {("solver.time_step", "solver.substeps"): list(steps), "terrain.height": list(heights)},
        repeats=repeats,
        seed=seed,
        wall_time=True,
        threads=threads,
    )
    level = Scenario(robot, terrains.flat(friction=_FRICTION), drive=drive, duration=_FLAT)
    rides = simulate_many(
        [
            level.replace({"solver.time_step": step, "solver.substeps": substeps})
            for step, substeps in steps
        ],
        threads=threads,
    )
    rates = rate(table)
    found = []
    for index, ((step, substeps), ride) in enumerate(zip(steps, rides, strict=True)):
        own = table.isel(time_step_substeps=index)
        cells = rates.isel(time_step_substeps=index)
        height = ride.position[ride.time > _STEADY, 1]
        figures = (cells[name].to_numpy().tolist() for name in ("rate", "low", "high"))
        found.append(
            ChainStep(
                time_step=step,
                substeps=substeps,
                flat_gap=ride.metrics["max_pin_gap"],
                gap=own["max_pin_gap"].max().item(),
                lowest=float(np.min(height)),
                highest=float(np.max(height)),
                cleared=tuple(zip(*figures, strict=True)),
                cost=own["wall_time"].sum().item() / own["time"].sum().item(),
            )
        )
    return found


def chain_steps_text(found: Sequence[ChainStep], heights: Sequence[float] = HEIGHTS) -> str:
    """Write one row per time step and number of substeps."""
    rows = [
        (
            f"{1e3 * row.time_step:g}",
            str(row.substeps),
            f"{1e6 * row.flat_gap:.1f}",
            f"{1e6 * row.gap:.0f}",
            f"{1e3 * row.lowest:.2f} to {1e3 * row.highest:.2f}",
            *(f"{share:.2f} ({low:.2f} to {high:.2f})" for share, low, high in row.cleared),
            f"{1e3 * row.cost:.0f}",
        )
        for row in found
    ]
    head = (
        *("step [ms]", "substeps", "gap, flat [um]", "gap, steps [um]", "height, flat [mm]"),
        *(f"cleared {1e3 * height:.0f} mm" for height in heights),
        "cost [ms/s]",
    )
    return aligned(head, rows)
