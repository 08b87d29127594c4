"""How often an outcome occurred, with its confidence interval."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from crawler2d.common.extras import extra
from crawler2d.errors import ScenarioError
from crawler2d.results.outcome import Outcome
from crawler2d.sweeps.statistics import wilson

if TYPE_CHECKING:
    import xarray
    from numpy.typing import NDArray

__all__ = ["rate"]

_STOPPED = "stopped"
"""Any outcome that is a stop."""

_POSE = {"final_x": 1e-3, "final_y": 1e-3, "final_angle": math.radians(0.1)}
"""[m], [rad] Final poses closer than this count as one."""

_SPOKEN = {
    "low": "lower bound",
    "high": "upper bound",
    "count": "number of runs",
    "distinct": "number of distinct final poses",
}


def rate(
    table: xarray.Dataset | Iterable[str | None],
    outcome: str = "cleared",
    dim: str | Iterable[str] = "repeat",
) -> xarray.Dataset:
    """Estimate the rate of an outcome in every cell, with Wilson's 95 % interval.

    Runs without a result (`diverged`, `refused`, `failed`) are not counted, nor are the missing
    runs of a joined table.

    Parameters
    ----------
    table : xarray.Dataset or iterable of str or None
        The table that `sweep` returned; or outcomes, with None for a run without a result.
    outcome : str
        Name of an `Outcome`, or "stopped" for any stop (`Outcome.is_stop`).
    dim : str or iterable of str
        The dimension or dimensions of the table to count over.

    Returns
    -------
    xarray.Dataset
        Variables `rate`, `low`, `high` and `count`, without the dimension `dim`. Without runs the
        rate is nan and the interval 0 to 1. A table with final poses also gives `distinct`, how
        many of them differ by more than about 1 mm or 0.1 degree: if they are few, the runs were
        not independent samples, and the interval is too narrow.

    Raises
    ------
    ScenarioError
        If there is no such outcome or dimension; the message suggests the nearest name. If another
        dimension of the table has the name of one of the variables.
    ImportError
        If xarray is missing; the message names the extra to install.

    Examples
    --------
    >>> outcomes = ["cleared", "seized", "cleared", "stalled"]
    >>> found = rate(outcomes)
    >>> found["rate"].item(), round(found["low"].item(), 3), found["count"].item()
    (0.5, 0.15, 4)
    >>> rate(outcomes, "seized")["rate"].item(), rate(outcomes, "stopped")["rate"].item()
    (0.25, 0.5)
    """
    xr = extra("xarray", "analysis")
    wanted = _name(outcome, "outcome", [*Outcome, _STOPPED])
    counted = [str(each) for each in Outcome if each.is_stop] if wanted == _STOPPED else [wanted]
    if isinstance(table, xr.Dataset):
        runs = table
        _name("outcome", "table", [str(name) for name in runs.data_vars])
    else:
        runs = xr.Dataset({"outcome": ("repeat", np.array(_texts(table), dtype=str))})
    outcomes = runs["outcome"]
    given = dim if isinstance(dim, Iterable) and not isinstance(dim, str) else [dim]
    dims = [_name(each, "dim", [str(name) for name in outcomes.dims]) for each in given]
    with xr.set_options(keep_attrs=True):  # those of the coordinates
        made = outcomes.isin([str(each) for each in Outcome])
        counts = made.sum(dims)
        successes = outcomes.isin(counted).sum(dims)
        intervals = xr.apply_ufunc(
            np.vectorize(wilson), successes, counts, output_core_dims=[(), (), ()]
        )
        variables = dict(zip(("rate", "low", "high"), intervals, strict=True), count=counts)
        if all(name in runs for name in _POSE):
            steps = [np.round(runs[name] / step) for name, step in _POSE.items()]
            core = [dims] * (1 + len(steps))
            variables["distinct"] = xr.apply_ufunc(
                _distinct, made, *steps, input_core_dims=core, vectorize=True
            )
    for name, variable in variables.items():
        if name in counts.coords:
            rule = "must have no other dimension or coordinate of that name: rename it"
            raise ScenarioError("table", name, rule)
        variable.attrs = {"units": "1", "long_name": _SPOKEN.get(name, f"rate of {wanted}")}
    found: xarray.Dataset = xr.Dataset(variables, attrs={"outcome": wanted, "confidence": 0.95})
    return found


def _distinct(made: NDArray[np.bool_], *steps: NDArray[np.float64]) -> int:
    """Count distinct poses, rounded to whole steps, of the runs with a result."""
    return len(set(zip(*(each[made].tolist() for each in steps), strict=True)))


def _texts(outcomes: Iterable[Any]) -> list[str]:
    names = list(Outcome)
    return [
        "" if outcome is None else _name(outcome, f"outcomes[{index}]", names)
        for index, outcome in enumerate(outcomes)
    ]


def _name(value: object, path: str, names: Sequence[str]) -> str:
    """Return a name from a list, or raise and suggest the nearest."""
    if isinstance(value, str) and value in names:
        return str(value)
    import difflib  # noqa: PLC0415 - only a failure needs it

    nearest = difflib.get_close_matches(str(value), names, n=1)
    hint = f" (did you mean {nearest[0]}?)" if nearest else ""
    raise ScenarioError(path, value, f"must be one of {', '.join(names)}{hint}")
