"""The Engineer with flippers: the highest step for each track model, and what limits it."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from crawler2d.parameters.scenario import Scenario
from crawler2d.parameters.settings import Climb, Drive
from crawler2d.presets import terrains
from crawler2d.presets.robots import engineer
from crawler2d.sweeps.rates import rates_of
from crawler2d.sweeps.sweep import sweep
from research.columns import aligned
from research.models import StudyModel, study_models
from research.paper.published import TABLE_3

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    import xarray

    from crawler2d.parameters.robot import Robot

__all__ = ["HEIGHTS", "HighestStep", "flipper_robots", "highest_steps", "highest_steps_text"]

HEIGHTS = tuple(0.02 * step for step in range(2, 21))
"""[m] Heights of the steps."""

_FRICTION = 0.9
# Models whose wheels have a size or place given for the robot's outline.
_WITHOUT = ("hybrid", "hybrid gears", "line of 4, touching", "16 all round, spaced")


@dataclass(frozen=True, slots=True, kw_only=True)
class HighestStep:
    """The highest step that a robot clears with one track model."""

    robot: str
    model: str
    height: float
    """[m] The highest step cleared by at least half of the runs; 0 if there is none."""
    gaps: int
    """Number of lower steps cleared by fewer runs."""
    limit: str
    """How most of the other runs end at the next step."""
    paper: float | None
    """[m] What the paper reports for its models of this kind; None if it has none."""


def flipper_robots() -> dict[str, Robot]:
    """List the robots: without flippers, with front flippers, driven backwards, with both.

    They have no rotors, as in the published tables.
    """
    built = engineer()
    arms = built.flippers
    if arms is None:
        raise AssertionError("the preset has flippers")
    robots = {
        "no flippers": engineer(flippers=None),
        "in front": built,
        "behind": engineer(flippers=replace(arms, ends="rear")),
        "both ends": engineer(flippers=replace(arms, ends="both")),
    }
    return {name: robot.without_rotors() for name, robot in robots.items()}


def highest_steps(
    heights: Sequence[float] = HEIGHTS,
    *,
    repeats: int = 6,
    seed: int = 0,
    threads: int | None = None,
    models: Mapping[str, StudyModel] | None = None,
) -> list[HighestStep]:
    """Run every robot with every track model over steps, with the gait `Climb`.

    Parameters
    ----------
    heights : sequence of float
        [m] Heights of the steps, ascending.
    repeats, seed, threads : int
        See `sweep`.
    models : mapping of str to StudyModel, optional
        The models; by default those of the study that flippers can have.

    Returns
    -------
    list of HighestStep
        One per robot and model.
    """
    if models is None:
        known = study_models(engineer().outline.axle_distance)
        models = {name: model for name, model in known.items() if name not in _WITHOUT}
    found = []
    for name, robot in flipper_robots().items():
        drive = Drive(speed=0.4, gait=None if robot.flippers is None else Climb())
        base = Scenario(robot, terrains.step(heights[0], friction=_FRICTION), drive=drive)
        over: dict[Any, Any] = {
            "robot.track": {label: model.track for label, model in models.items()},
            "terrain.height": list(heights),
        }
        table = sweep(base, over, repeats=repeats, seed=seed, threads=threads, on_error="record")
        rates = rates_of(table)["rate"]
        for label, model in models.items():
            shares = rates.sel(track=label).to_numpy()
            found.append(_highest(name, label, model, (heights, shares, table.sel(track=label))))
    return found


def _highest(
    robot: str,
    label: str,
    model: StudyModel,
    climbs: tuple[Sequence[float], np.ndarray[Any, Any], xarray.Dataset],
) -> HighestStep:
    heights, shares, table = climbs
    cleared = np.flatnonzero(shares >= 0.5)
    last = int(cleared[-1]) if cleared.size else -1
    limit = "none up to here"
    if last + 1 < len(heights):
        above = table.isel(height=last + 1)
        ends = zip(
            above["outcome"].to_numpy().tolist(),
            above["mechanism"].to_numpy().tolist(),
            strict=True,
        )
        said = Counter(
            " ".join(filter(None, (outcome, mechanism)))
            for outcome, mechanism in ends
            if outcome != "cleared"
        )
        limit = said.most_common(1)[0][0].replace("_", " ")
    return HighestStep(
        robot=robot,
        model=label,
        height=heights[last] if cleared.size else 0.0,
        gaps=last + 1 - cleared.size,
        limit=limit,
        paper=next((row.max_height for row in TABLE_3 if row.model == model.row), None),
    )


def highest_steps_text(found: Sequence[HighestStep]) -> str:
    """Write one row per model and one column per robot, with what limits each."""
    robots = list(dict.fromkeys(row.robot for row in found))
    rows = []
    for model in dict.fromkeys(row.model for row in found):
        own = {row.robot: row for row in found if row.model == model}
        paper = next(iter(own.values())).paper
        cells = (
            f"{100 * own[r].height:.0f}{'*' * bool(own[r].gaps)} {own[r].limit}" for r in robots
        )
        rows.append((model, "-" if paper is None else f"{100 * paper:.0f}", *cells))
    head = ("highest step [cm], then what limits it", "paper", *robots)
    note = "* fewer than half of the runs clear some lower step; the paper's real robot: 20 cm"
    return f"{aligned(head, rows)}\n{note}"
