"""Which candidate for a repair does best in the runs in which the robot seized."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from crawler2d.audits.candidates import Candidate
from crawler2d.audits.runs import column
from crawler2d.audits.verdicts import BELT, CLEARS, OWN
from crawler2d.parameters.scenario import Scenario
from crawler2d.results.outcome import Outcome
from crawler2d.runs.batch import simulate_many

if TYPE_CHECKING:
    import xarray

    from crawler2d.runs.progress import Progress

__all__ = ["best_of"]

_ROUNDS, _QUICK = (3, 6, 12, 24), (1, 3, 6, 12)
"""Runs that those have driven who are still in it, and if it is to be quick."""
_LEAST = 2
"""Candidates that stay in it until the end."""


def best_of(
    space: Sequence[Candidate],
    table: xarray.Dataset,
    obstacles: Sequence[str],
    *,
    is_quick: bool,
    threads: int | None,
    show: Progress | None,
) -> Candidate:
    """Choose among candidates by halving, in runs in which the robot seized and the belt cleared.

    All drive three of them, from as many obstacles as there are; the better half drives three
    more, half of these six more, and the last two up to 24. A stop costs more to simulate than all
    else, and most candidates that stop do so at once. Of those that clear 95 % the least changed
    is chosen, else the one that clears most. What wins so was also lucky: only fresh runs can
    confirm it.

    Parameters
    ----------
    space : sequence of Candidate
        All of them, the least changed first.
    table : xarray.Dataset
        The runs behind the verdicts.
    obstacles : sequence of str
        Those that seize, the worst first.
    is_quick : bool
        Whether half of these runs, and one in the first round, are enough.
    threads : int, optional
        See `simulate_many`.
    show : Progress, optional
        Counts the runs.
    """
    rounds = _QUICK if is_quick else _ROUNDS
    bases = _seized(table, obstacles)[: rounds[-1]]
    left, lost, done = list(space), np.zeros(len(space), dtype=int), 0
    places = {each.what: place for place, each in enumerate(space)}
    for end in rounds:
        some = bases[done:end]
        runs = simulate_many(
            [base.replace(_fields(each)) for each in left for base in some],
            record="summary",
            trials=None,
            threads=threads,
            progress=show or False,
        )
        fails = np.array([run.outcome != Outcome.CLEARED for run in runs], dtype=bool)
        lost[[places[each.what] for each in left]] += fails.reshape(len(left), -1).sum(axis=1)
        done = min(end, len(bases))
        order = sorted(left, key=lambda each: lost[places[each.what]])
        left = order[: max(_LEAST, -(-len(order) // 2))]
    allowed = (1.0 - CLEARS) * done
    return min(
        left,
        key=lambda each: (
            max(lost[places[each.what]] - allowed, 0.0),
            places[each.what],
        ),
    )


def _seized(table: xarray.Dataset, obstacles: Sequence[str]) -> list[Scenario]:
    """Return runs that seized where the belt cleared: one of each obstacle, then the next."""
    found = []
    for obstacle in obstacles:
        ends, of_belt, texts = (
            column(table, name, model=model, terrain=obstacle)
            for name, model in (("outcome", OWN), ("outcome", BELT), ("scenario", OWN))
        )
        telling = (ends == Outcome.SEIZED) & (of_belt == Outcome.CLEARED)
        found.append(texts[telling].tolist())
    mixed = [text for texts in itertools.zip_longest(*found) for text in texts if text is not None]
    return [Scenario.from_json(text) for text in mixed]


def _fields(candidate: Candidate) -> dict[str, Any]:
    """Return what a candidate replaces in a robot whose other figures were drawn."""
    robot = candidate.robot
    fields: dict[str, Any] = {"robot.track": robot.track}
    if robot.flippers is not None:
        fields["robot.flippers.track"] = robot.flippers.track
    return fields
