"""Scenarios of episodes to come."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence

import numpy as np

from crawler2d import _core
from crawler2d.envs.task import Task

__all__ = ["Supply"]

_TOGETHER = 32
"""So many scenarios are drawn at once, for that costs little more than one."""


class Supply:
    """Scenarios of episodes to come at N places, drawn in batches.

    Each place has those that its own generator gives, in the same order whatever the batches.
    """

    def __init__(self, task: Task, count: int) -> None:
        self._task, self._depth = task, -(-_TOGETHER // count)
        self._queues: list[deque[_core.PreparedScenario]] = [deque() for _ in range(count)]

    def forget(self, place: int) -> None:
        """Forget what was drawn for a place, which has another generator now."""
        self._queues[place].clear()

    def take(
        self, places: Sequence[int], generators: Sequence[np.random.Generator]
    ) -> list[_core.PreparedScenario]:
        """Return the next scenario of some places; `generators` are those of all."""
        if not all(self._queues[place] for place in places):
            empty = [place for place, queue in enumerate(self._queues) if not queue]
            order = [place for place in empty for _ in range(self._depth)]
            drawn = self._task.draw([generators[place] for place in order])
            for place, scenario in zip(order, drawn, strict=True):
                self._queues[place].append(scenario)
        return [self._queues[place].popleft() for place in places]
