"""How often an outcome occurred, with its confidence interval."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from crawler2d._extras import extra
from crawler2d._sweep_table import NO_RESULT
from crawler2d.errors import ScenarioError
from crawler2d.outcome import Outcome
from crawler2d.statistics import wilson

if TYPE_CHECKING:
    import xarray

__all__ = ["rate"]

_STOPPED = "stopped"
"""Any outcome that is a stop."""


def rate(
    table: xarray.Dataset | Iterable[str | None], outcome: str = "cleared", dim: str = "repeat"
) -> xarray.Dataset:
    """Estimate the rate of an outcome in every cell, with Wilson's 95 % interval.

    Runs without a result (`diverged`, `refused`) are not counted.

    Parameters
    ----------
    table : xarray.Dataset or iterable of str or None
        What `sweep` returned; or outcomes, None for a run without a result.
    outcome : str
        Name of an `Outcome`, or "stopped" for all that are stops: cycling, seized, hung_up,
        stalled and slipping.
    dim : str
        The dimension of a table that is counted over.

    Returns
    -------
    xarray.Dataset
        Variables `rate`, `low`, `high` and `count`, without the dimension `dim`. Of no runs the
        rate is nan and the interval 0 to 1.

    Raises
    ------
    ScenarioError
        If there is no such outcome or dimension; the message has the nearest name.
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
        _name("outcome", "table", [str(name) for name in table.data_vars])
        outcomes = table["outcome"]
        _name(dim, "dim", [str(name) for name in outcomes.dims])
    else:
        outcomes = xr.DataArray(np.array(_texts(table), dtype=str), dims=dim)
    with xr.set_options(keep_attrs=True):  # of the coordinates
        counts = (~outcomes.isin(NO_RESULT)).sum(dim)
        successes = outcomes.isin(counted).sum(dim)
        intervals = xr.apply_ufunc(
            np.vectorize(wilson), successes, counts, output_core_dims=[(), (), ()]
        )
    found: xarray.Dataset = xr.Dataset(
        dict(zip(("rate", "low", "high"), intervals, strict=True), count=counts),
        attrs={"outcome": wanted, "confidence": 0.95},
    )
    spoken = (f"rate of {wanted}", "lower bound", "upper bound", "number of runs")
    for variable, name in zip(found.data_vars.values(), spoken, strict=True):
        variable.attrs = {"units": "1", "long_name": name}
    return found


def _texts(outcomes: Iterable[Any]) -> list[str]:
    names = list(Outcome)
    return [
        NO_RESULT[0] if outcome is None else _name(outcome, f"outcomes[{index}]", names)
        for index, outcome in enumerate(outcomes)
    ]


def _name(value: object, path: str, names: Sequence[str]) -> str:
    """Return a name that is one of a list, or tell the nearest."""
    if isinstance(value, str) and value in names:
        return str(value)
    import difflib  # noqa: PLC0415 - only a failure needs it

    nearest = difflib.get_close_matches(str(value), names, n=1)
    hint = f" (did you mean {nearest[0]}?)" if nearest else ""
    raise ScenarioError(path, value, f"must be one of {', '.join(names)}{hint}")
