"""The runs of a sweep as an xarray dataset, by cell and repeat."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from crawler2d.common.extras import extra
from crawler2d.common.units import METRICS
from crawler2d.errors import ScenarioError, SimulationDiverged
from crawler2d.runs.run import Run
from crawler2d.sweeps.axes import Axis, coordinates, field_attributes, short_names
from crawler2d.sweeps.draws import Distribution
from crawler2d.sweeps.plan import Plan
from crawler2d.sweeps.stops import stop_columns

if TYPE_CHECKING:
    import xarray
    from numpy.typing import NDArray

__all__ = ["NO_RESULT", "to_table"]

NO_RESULT = ("diverged", "refused", "failed")
"""Outcomes of runs without a result: non-finite state, broken rule, any other error."""

_Variable = tuple[list[str], "NDArray[Any]", dict[str, str]]


def to_table(
    axes: Sequence[Axis],
    distributions: Mapping[str, Distribution],
    plans: Sequence[Plan],
    runs: Sequence[Run],
    *,
    seed: int,
    trials: Sequence[str],
    with_times: bool,
) -> xarray.Dataset:
    """Arrange the runs, which are in the order of their plans, in a table; see `sweep`.

    Every column has every dimension and depends on its own run only, so that tables can be joined.
    """
    xr = extra("xarray", "analysis")
    cells = [axis.name for axis in axes]
    sizes = [len(axis.values) for axis in axes]
    repeats = len(runs) // math.prod(sizes)

    def by_run(values: list[Any], kind: type, **attributes: str) -> _Variable:
        return [*cells, "repeat"], np.array(values, kind).reshape(*sizes, repeats), attributes

    variables = {"outcome": by_run([_outcome(run) for run in runs], str)}
    why = [run.diagnosis for run in runs]
    for name, (kind, unit, values) in stop_columns(why, trials).items():
        attributes = {"units": unit} if unit else {}
        variables[name] = by_run(values, kind, **attributes)
    for name in next((run.metrics for run in runs if run.error is None), {}):
        figures = [run.metrics.get(name, math.nan) for run in runs]
        variables[name] = by_run(figures, float, units=METRICS.get(name, ""))
    for path, name in short_names(list(distributions)).items():
        drawn = [plan.drawn.get(path, math.nan) for plan in plans]
        variables[f"drawn_{name}"] = by_run(drawn, float, **field_attributes([path]))
    if with_times:
        times = [run.wall_time if run.error is None else math.nan for run in runs]
        variables["wall_time"] = by_run(times, float, units="s")
    variables["seed"] = by_run([seed] * len(runs), np.int64 if seed < 2**63 else np.uint64)
    # Python strings: in a NumPy array of strings, each would take the space of the longest.
    errors = [plan.refused or run.error or "" for plan, run in zip(plans, runs, strict=True)]
    variables["error"] = by_run([str(error) for error in errors], object)
    texts = ["" if plan.refused else plan.scenario.to_json() for plan in plans]
    variables["identity"] = by_run([plan.identity for plan in plans], object)
    variables["scenario"] = by_run(texts, object)
    dataset: xarray.Dataset = xr.Dataset(
        variables, coords={**coordinates(axes), "repeat": np.arange(repeats)}
    )
    for key, variable in dataset.variables.items():
        variable.attrs.setdefault("long_name", str(key).replace("_", " "))
    return dataset


def _outcome(run: Run) -> str:
    diverged, refused, failed = NO_RESULT
    match run.error:
        case None:
            return str(run.outcome)
        case SimulationDiverged():
            return diverged
        case ScenarioError():
            return refused
        case _:  # out of memory, or a fault of the program
            return failed
