"""Runs of an audit that a page replays: one for each obstacle that seized, beside the belt's."""

from __future__ import annotations

import math
import warnings
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from crawler2d.audits.runs import TRIED, column
from crawler2d.audits.verdicts import BELT, OWN
from crawler2d.errors import ScenarioWarning
from crawler2d.parameters.scenario import Scenario
from crawler2d.results.outcome import Outcome
from crawler2d.runs.batch import simulate_many

if TYPE_CHECKING:
    from crawler2d.audits.audited import Audited
    from crawler2d.audits.verdicts import Verdict
    from crawler2d.runs.run import Run

__all__ = ["Replayed", "replayed"]

_INTERVAL = 0.04
"""[s] Between samples: 25 pictures a second, a quarter of the usual."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Replayed:
    """A run in which the robot seized, and that of the belt with the same draws.

    Parameters
    ----------
    verdict : Verdict
        Of the obstacle.
    sample, repeat : int
        Where the run stands in the table of the audit.
    of_robot, of_run : dict of str to float
        What was drawn for the robot and its floor, and for this run alone, by path.
    run : Run
        The robot's, with its history.
    belt : Run, optional
        The belt's; None for a robot that is on belts.
    """

    verdict: Verdict
    sample: int
    repeat: int
    of_robot: dict[str, float]
    of_run: dict[str, float]
    run: Run
    belt: Run | None


def replayed(audit: Audited, *, threads: int | None = None) -> list[Replayed]:
    """Simulate one run again for each obstacle on which the robot seized.

    It is one of those that are jammed where most are; if there are any, of those that the belt
    clears with the same draws; and of these the first of the fastest, which is the shortest.

    Parameters
    ----------
    audit : Audited
        The audit.
    threads : int, optional
        See `simulate_many`.
    """
    chosen = [(each, *_place(audit, each)) for each in audit.verdicts if each.where]
    models = [OWN] if audit.belt.robot == audit.robot else [OWN, BELT]
    texts = [
        str(column(audit.table, "scenario", model=model, terrain=verdict.obstacle)[sample, repeat])
        for verdict, sample, repeat in chosen
        for model in models
    ]
    scenarios = [Scenario.from_json(text) for text in texts]
    with warnings.catch_warnings():
        # What the core doubts is in the lint.
        warnings.simplefilter("ignore", ScenarioWarning)
        made = simulate_many(scenarios, threads=threads, sample_interval=_INTERVAL, trials=TRIED)
    runs = iter(made)
    return [
        Replayed(
            verdict=verdict,
            sample=sample,
            repeat=repeat,
            of_robot=_drawn(audit, "unknown_", verdict.obstacle, sample, repeat),
            of_run=_drawn(audit, "drawn_", verdict.obstacle, sample, repeat),
            run=next(runs),
            belt=next(runs) if BELT in models else None,
        )
        for verdict, sample, repeat in chosen
    ]


def _place(audit: Audited, verdict: Verdict) -> tuple[int, int]:
    """Return sample and repeat of the run that stands for the seizures on an obstacle."""
    own = {"model": OWN, "terrain": verdict.obstacle}
    there = column(audit.table, "outcome", **own) == Outcome.SEIZED
    there &= column(audit.table, "stop_bodies", **own) == verdict.where
    there &= column(audit.table, "stop_carrier", **own) == verdict.carrier
    belt = column(audit.table, "outcome", model=BELT, terrain=verdict.obstacle)
    telling = there & (belt == Outcome.CLEARED)
    speeds = audit.table["speed"].transpose("sample", "repeat").values
    places = np.argwhere(telling if telling.any() else there)
    sample, repeat = places[np.argmax(np.abs(speeds[tuple(places.T)]))].tolist()
    return sample, repeat


def _drawn(audit: Audited, kind: str, obstacle: str, sample: int, repeat: int) -> dict[str, float]:
    """Return what was drawn for a run, by path: the columns of one kind."""
    found = {}
    for name, variable in audit.table.data_vars.items():
        if str(name).startswith(kind):
            cell = column(audit.table, str(name), model=OWN, terrain=obstacle)
            value = float(cell[sample, repeat])
            if not math.isnan(value):  # this obstacle has no such field
                found[str(variable.attrs["path"])] = value
    return found
