"""What a worker of an executor does: scenarios as texts in, results as plain data out, no state."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from crawler2d import _core
from crawler2d.errors import InternalError

__all__ = ["simulate_chunk"]


def simulate_chunk(
    texts: Sequence[str], trials: Sequence[str], build: str
) -> list[dict[str, Any] | None]:
    """Simulate a few valid scenarios on one thread; None is a run that was interrupted.

    Raises
    ------
    InternalError
        If the worker has another build of the core, whose bits may differ.
    """
    own = str(_core.build_info()["build_id"])
    if own != build:
        raise InternalError(f"a worker has another build of crawler2d ({own}, not {build})")
    results: list[dict[str, Any] | None] = [None] * len(texts)

    def take(finished: list[tuple[int, dict[str, Any]]]) -> None:
        for place, result in finished:
            results[place] = result

    passed = [_core.Passed(text) for text in texts]
    _core.simulate_many(passed, 1, 0.01, "row", list(trials), take)
    return results
