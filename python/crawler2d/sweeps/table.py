"""Runs that were not planned as a sweep, as a data set: of a batch, of Ctrl-C, of a store."""

from __future__ import annotations

from collections.abc import Iterable
from os import PathLike
from typing import TYPE_CHECKING

import numpy as np

from crawler2d.common.extras import extra
from crawler2d.errors import ScenarioError
from crawler2d.results.row import Row
from crawler2d.runs.labelled import build_attributes
from crawler2d.runs.run import Run
from crawler2d.sweeps.dataset import dataset_of, row_columns
from crawler2d.sweeps.store import stored_rows

if TYPE_CHECKING:
    import xarray

__all__ = ["table"]


def table(runs: Iterable[Run] | str | PathLike[str]) -> xarray.Dataset:
    """Arrange runs in a table, one row each.

    Parameters
    ----------
    runs : iterable of Run, str or path-like
        What `simulate_many` returned, or the `runs` of a `BatchInterrupted`; or the path of a
        store, also while a sweep writes into it.

    Returns
    -------
    xarray.Dataset
        The dimension `run`, and the columns of `sweep`. A run that was not finished is `failed`,
        and `error` says so. Of a store, `build` and `trials` say what computed a run, and what was
        to be tried.

    Raises
    ------
    ScenarioError
        If something is no Run.
    StoreError
        If the path is that of no store, or it is damaged.
    ImportError
        If xarray is missing; the message names the extra to install.

    Examples
    --------
    >>> import crawler2d as c2d
    >>> base = c2d.Scenario(c2d.robots.engineer(flippers=None), c2d.terrains.step(0.03))
    >>> runs = c2d.simulate_many([base, base.replace({"terrain.height": 0.2})], record="summary")
    >>> found = c2d.table(runs)
    >>> found.outcome.values.tolist(), dict(found.sizes)
    (['cleared', 'tipped_over'], {'run': 2})
    >>> c2d.rate(found, dim="run")["rate"].item()
    0.5
    """
    extra("xarray", "analysis")
    made_by: dict[str, list[str]] = {}
    if isinstance(runs, (str, PathLike)):
        stored = list(stored_rows(runs))
        rows = [row for row, _, _ in stored]
        tried = [trial for _, _, trials in stored for trial in trials]
        made_by["build"] = [build for _, build, _ in stored]
        made_by["trials"] = [", ".join(trials) for _, _, trials in stored]
    else:
        rows, tried = [], []
        for index, run in enumerate(runs):
            if not isinstance(run, Run):
                raise ScenarioError(f"runs[{index}]", run, "must be a Run")
            rows.append(Row.of_record(run))
            if run.diagnosis is not None:
                tried += [trial.name for trial in run.diagnosis.trials]
    columns = row_columns(rows, trials=tuple(dict.fromkeys(tried)), with_times=True)
    columns |= {name: (np.array(texts, object), {}) for name, texts in made_by.items()}
    found = dataset_of(columns, {"run": len(rows)}, {"run": np.arange(len(rows))})
    return found.assign_attrs(build_attributes())
