"""Which candidates get over runs in which the robot seized: the others are not searched among."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from crawler2d.audits.candidates import Candidate
from crawler2d.audits.runs import column
from crawler2d.audits.verdicts import BELT, OWN
from crawler2d.parameters.scenario import Scenario
from crawler2d.results.outcome import Outcome
from crawler2d.runs.batch import simulate_many

if TYPE_CHECKING:
    import xarray

__all__ = ["screened"]

_RUNS = 3  # of which a candidate clears the most


def screened(
    space: Sequence[Candidate], table: xarray.Dataset, obstacle: str, threads: int | None
) -> list[Candidate]:
    """Keep the candidates that clear most of three runs in which the robot seized.

    A stop costs more to simulate than all else, and most candidates that stop do so at once.

    Parameters
    ----------
    space : sequence of Candidate
        All of them.
    table : xarray.Dataset
        The runs behind the verdicts.
    obstacle : str
        The one on which it seizes most.
    threads : int, optional
        See `simulate_many`.
    """
    seized = column(table, "outcome", model=OWN, terrain=obstacle) == Outcome.SEIZED
    cleared = column(table, "outcome", model=BELT, terrain=obstacle) == Outcome.CLEARED
    texts = column(table, "scenario", model=OWN, terrain=obstacle)[seized & cleared][:_RUNS]
    bases = [Scenario.from_json(text) for text in texts.tolist()]
    variants = [base.replace(_fields(each)) for each in space for base in bases]
    runs = simulate_many(variants, record="summary", threads=threads, progress=False)
    passed = [run.outcome == Outcome.CLEARED for run in runs]
    count = len(bases)
    return [
        each
        for index, each in enumerate(space)
        if 2 * sum(passed[index * count : (index + 1) * count]) > count
    ]


def _fields(candidate: Candidate) -> dict[str, Any]:
    """Return what a candidate replaces in a robot whose other figures were drawn."""
    robot = candidate.robot
    fields: dict[str, Any] = {"robot.track": robot.track}
    if robot.flippers is not None:
        fields["robot.flippers.track"] = robot.flippers.track
    return fields
