"""Rows as an xarray data set: by cell, sample and repeat, or one after another."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from crawler2d.common.extras import extra
from crawler2d.common.units import METRICS
from crawler2d.results.row import Row
from crawler2d.sweeps.stops import stop_columns

if TYPE_CHECKING:
    import xarray
    from numpy.typing import NDArray

__all__ = ["Column", "dataset_of", "row_columns"]

Column = tuple["NDArray[Any]", dict[str, str]]
"""Values of all runs, shape (n,), and attributes."""


def row_columns(
    rows: Sequence[Row | None], *, trials: Sequence[str], with_times: bool
) -> dict[str, Column]:
    """Write rows as columns by name; a row that is None, a run that was not made, is empty.

    Every value depends on its own run only, so that tables can be joined.
    """
    columns: dict[str, Column] = {}
    columns["outcome"] = (np.array(["" if row is None else row.outcome for row in rows], str), {})
    why = [None if row is None else row.why() for row in rows]
    for name, (kind, unit, values) in stop_columns(why, trials).items():
        columns[name] = (np.array(values, kind), {"units": unit} if unit else {})
    for name in next((row.metrics for row in rows if row is not None and row.metrics), {}):
        figures = [math.nan if row is None else row.metrics.get(name, math.nan) for row in rows]
        columns[name] = (np.array(figures, float), {"units": METRICS.get(name, "")})
    if with_times:
        times = [math.nan if row is None else row.wall_time for row in rows]
        columns["wall_time"] = (np.array(times, float), {"units": "s"})
    # Python strings: in a NumPy array of strings, each would take the space of the longest.
    texts = {
        "error": ["" if row is None else str(row.error or "") for row in rows],
        "identity": ["" if row is None else row.identity for row in rows],
        "scenario": ["" if row is None else row.scenario for row in rows],
    }
    return columns | {name: (np.array(values, object), {}) for name, values in texts.items()}


def dataset_of(
    columns: Mapping[str, Column], dims: Mapping[str, int], coordinates: Mapping[str, Any]
) -> xarray.Dataset:
    """Give columns their dimensions, the last of which changes fastest."""
    xr = extra("xarray", "analysis")
    names, shape = list(dims), list(dims.values())
    variables = {
        name: (names, values.reshape(shape), attributes)
        for name, (values, attributes) in columns.items()
    }
    dataset: xarray.Dataset = xr.Dataset(variables, coords=coordinates)
    for key, variable in dataset.variables.items():
        variable.attrs.setdefault("long_name", str(key).replace("_", " "))
    return dataset
