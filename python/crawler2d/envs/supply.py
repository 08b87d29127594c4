"""A supply of scenarios for future episodes."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence

import numpy as np

from crawler2d import _core
from crawler2d.envs.task import Task

__all__ = ["Supply"]

_TOGETHER = 32
"""Number of scenarios drawn at once, which costs little more than one."""


class Supply:
    """Scenarios of future episodes for N environments, drawn in batches.

    Each environment draws from its own generator, so batches do not change the sequence.
    """

    def __init__(self, task: Task, count: int) -> None:
        self._task, self._depth = task, -(-_TOGETHER // count)
        self._queues: list[deque[_core.PreparedScenario]] = [deque() for _ in range(count)]

    def forget(self, index: int) -> None:
        """Drop the scenarios of an environment whose generator has changed."""
        self._queues[index].clear()

    def take(
        self, indices: Sequence[int], generators: Sequence[np.random.Generator]
    ) -> list[_core.PreparedScenario]:
        """Return the next scenario for each index; `generators` are those of all environments."""
        if not all(self._queues[index] for index in indices):
            empty = [index for index, queue in enumerate(self._queues) if not queue]
            order = [index for index in empty for _ in range(self._depth)]
            drawn = self._task.draw([generators[index] for index in order])
            for index, scenario in zip(order, drawn, strict=True):
                self._queues[index].append(scenario)
        return [self._queues[index].popleft() for index in indices]
