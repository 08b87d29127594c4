"""The scene of a run: its robot and ground as they are drawn, at its samples or in between."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from crawler2d.common.bodies import TRACED
from crawler2d.drawings.scene import Scene

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from crawler2d.results.record import Record

__all__ = ["scene_of"]


def scene_of(run: Record, times: NDArray[np.float64] | None = None) -> Scene:
    """Collect what is drawn of a run.

    Parameters
    ----------
    run : Run
        A run with history.
    times : ndarray, shape (k,), optional
        [s] Instants between which samples are interpolated; None takes the samples of the run.
    """
    columns = {name: getattr(run, name) for name in TRACED}
    if times is not None:
        columns = {name: _between(run.time, column, times) for name, column in columns.items()}
    return Scene(run.scenario.to_json(), columns)


def _between(
    time: NDArray[np.float64], column: NDArray[np.float64], times: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Interpolate a column of the history; its angles count full turns."""
    values = column.reshape(time.size, -1)
    found = np.empty((times.size, values.shape[1]))
    for number, each in enumerate(values.T):
        found[:, number] = np.interp(times, time, each)
    return found.reshape(times.size, *column.shape[1:])
