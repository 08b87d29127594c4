"""Rates of an outcome, with confidence intervals."""

from __future__ import annotations

import functools
import math
import warnings
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

import numpy as np

from crawler2d.common.arrays import is_iterable
from crawler2d.common.extras import extra
from crawler2d.common.keywords import read_choice, takes_keywords
from crawler2d.errors import ScenarioError, warn
from crawler2d.results.outcome import Outcome, rate_label
from crawler2d.results.record import Record
from crawler2d.sweeps.statistics import clustered, read_level

if TYPE_CHECKING:
    import xarray
    from numpy.typing import NDArray

    from crawler2d.sweeps.figure_dataset import FigureDataset

__all__ = ["BAND", "quantile_band", "rate", "rates_of"]

_STOPPED = "stopped"
"""Name for any outcome that is a stop."""

_SAMPLE, _REPEAT = "sample", "repeat"
"""Dimensions of the draws: samples of unknowns, and repeats."""

_POSE = {"final_x": 1e-3, "final_y": 1e-3, "final_angle": math.radians(0.1)}
"""[m], [rad] Final poses closer than this count as equal."""

_LONG_NAMES = {
    "low": "lower bound",
    "high": "upper bound",
    "count": "number of runs",
    "distinct": "number of distinct final poses",
    "band_median": "median of the rates over the unknowns",
    "band_low": "5th percentile of the rates over the unknowns",
    "band_high": "95th percentile of the rates over the unknowns",
}

BAND = {"band_low": 0.05, "band_median": 0.5, "band_high": 0.95}
"""[-] Quantiles of a band of rates."""

_FEW = 4
"""Warn if at least `_MANY` runs have this few distinct poses, or fewer."""
_MANY = 10


@takes_keywords
def rate(
    table: xarray.Dataset | Iterable[str | None],
    outcome: str = "cleared",
    dim: str | Iterable[str] = "repeat",
    *,
    confidence_level: float = 0.95,
) -> FigureDataset:
    """Estimate the rate of an outcome in every cell, with Wilson's interval.

    A rate is a fraction of repeats, over what varied between them. If `sweep` had unknowns, there
    is one rate per sample, and their spread is a band; they are averaged only if `dim` includes
    samples. Runs without a result (`diverged`, `refused`, `failed`) and missing runs of a joined
    table are not counted.

    Runs that are counted together and share a draw are correlated: the repeats of one sample, or
    the runs of one repeat in several cells. They form a cluster, and the interval is Wilson's for
    the effective number of independent runs, see `sweeps.statistics.clustered`.

    Parameters
    ----------
    table : xarray.Dataset or iterable of str or None
        Result of `sweep`, or a list of outcomes, with None for a run without a result.
    outcome : str
        Name of an `Outcome`, or "stopped" for any stop (`Outcome.is_stop`).
    dim : str or iterable of str
        The dimension or dimensions of the table to count over.
    confidence_level : float
        [-] Confidence level of the intervals, between 0 and 1. They assume a number of runs fixed
        in advance.

    Returns
    -------
    FigureDataset
        An `xarray.Dataset` whose `plot` draws it. Variables `rate`, `low`, `high` and `count`,
        without the dimension `dim`. Without runs the rate is NaN and the interval 0 to 1. A table
        with final poses also gives `distinct`, the number of poses that differ by more than about 1
        mm or 0.1 degree.

        With unknowns, these have the dimension `sample`; `band_low`, `band_median` and `band_high`
        are the 5 %, 50 % and 95 % quantiles of a cell's rates over the samples. A band includes the
        scatter from few repeats, which the interval of each rate shows.

        The attributes `varied` and `unknown` describe the populations, without which a rate says
        little. `scenario` and `build_...` are copied from the table.

    Raises
    ------
    ScenarioError
        If the outcome or dimension is unknown (the message suggests the nearest name), or another
        dimension of the table has the name of one of the variables.
    ImportError
        If xarray is missing; the message names the extra to install.

    Warns
    -----
    ScenarioWarning
        If there were no unknowns, and in some cell at least ten runs ended in four or fewer
        distinct poses: the variation hardly affected the robot, so the rate says little about other
        robots or floors.

    Examples
    --------
    >>> outcomes = ["cleared", "seized", "cleared", "stalled"]
    >>> found = rate(outcomes)
    >>> found["rate"].item(), round(found["low"].item(), 3), found["count"].item()
    (0.5, 0.15, 4)
    >>> rate(outcomes, "seized")["rate"].item(), rate(outcomes, "stopped")["rate"].item()
    (0.25, 0.5)
    """
    rates = rates_of(table, outcome, dim, confidence_level=confidence_level)
    if not rates.attrs["unknown"] and "distinct" in rates:
        _warn_of_few(rates)
    return rates


def rates_of(
    table: xarray.Dataset | Iterable[str | None],
    outcome: str = "cleared",
    dim: str | Iterable[str] = "repeat",
    *,
    confidence_level: float = 0.95,
) -> FigureDataset:
    """Estimate rates, see `rate`, without a warning."""
    xr = extra("xarray", "analysis")
    wanted = read_choice(outcome, "outcome", [*Outcome, _STOPPED])
    level = read_level(confidence_level, "confidence_level")
    counted = [str(each) for each in Outcome if each.is_stop] if wanted == _STOPPED else [wanted]
    if isinstance(table, xr.Dataset):
        runs = table
        if "outcome" not in runs:
            columns = ", ".join(map(str, runs.data_vars)) or "none"
            raise ScenarioError("table", columns, "must have a column outcome")
    else:
        runs = xr.Dataset({"outcome": ("repeat", np.array(_texts(table), dtype=str))})
    outcomes = runs["outcome"]
    given = dict.fromkeys(dim) if is_iterable(dim) and not isinstance(dim, str) else [dim]
    dims = [read_choice(each, "dim", [str(name) for name in outcomes.dims]) for each in given]
    with xr.set_options(keep_attrs=True):  # attributes of the coordinates
        valid = outcomes.isin([str(each) for each in Outcome])
        # A sum over no dimension leaves booleans.
        counts = valid.sum(dims).astype(int)
        own, together = _clusters(outcomes, dims)
        per_cluster = [each.sum(together).astype(int) for each in (outcomes.isin(counted), valid)]
        intervals = xr.apply_ufunc(
            functools.partial(clustered, confidence=level),
            *per_cluster,
            input_core_dims=[own, own],
            output_core_dims=[(), (), ()],
            vectorize=True,
        )
        variables = dict(zip(("rate", "low", "high"), intervals, strict=True), count=counts)
        if all(name in runs for name in _POSE):
            steps = [np.round(runs[name] / step) for name, step in _POSE.items()]
            core = [dims] * (1 + len(steps))
            variables["distinct"] = xr.apply_ufunc(
                _distinct, valid, *steps, input_core_dims=core, vectorize=True
            )
        if _SAMPLE in counts.dims:
            variables |= quantile_band(variables["rate"])
    for name, variable in variables.items():
        if name in counts.coords:
            rule = "must have no other dimension or coordinate of that name: rename it"
            raise ScenarioError("table", name, rule)
        variable.attrs = {"units": "1", "long_name": _LONG_NAMES.get(name, rate_label(wanted))}
    from crawler2d.sweeps.figure_dataset import FigureDataset  # noqa: PLC0415 - needs xarray

    return FigureDataset(
        variables,
        attrs={
            "figure": "rates",
            "outcome": wanted,
            "confidence_level": level,
            "interval": "Wilson",
            "varied": runs.attrs.get("vary", ""),
            "unknown": runs.attrs.get("unknown", ""),
            **{name: value for name, value in runs.attrs.items() if _says_origin(str(name))},
        },
    )


def _says_origin(attribute: str) -> bool:
    """Whether an attribute of a table states the origin of its runs: scenario or build."""
    return attribute == "scenario" or attribute.startswith("build_")


def _clusters(outcomes: xarray.DataArray, dims: Sequence[str]) -> tuple[list[str], list[str]]:
    """Split dimensions into those of clusters and those within; runs of one draw are a cluster."""
    drawn = [name for name in (_SAMPLE, _REPEAT) if name in outcomes.dims]
    if not drawn:
        return list(dims), []
    own = [name for name in drawn if name in dims][:1]
    return own, [name for name in dims if name not in own]


def quantile_band(rates: xarray.DataArray) -> dict[str, xarray.DataArray]:
    """Return the band of rates over the samples of the unknowns."""
    with warnings.catch_warnings():  # runs without a result have no band
        warnings.filterwarnings("ignore", "All-NaN slice", RuntimeWarning)
        band = rates.quantile(list(BAND.values()), _SAMPLE, skipna=True)
    parts = {name: band.sel(quantile=part, drop=True) for name, part in BAND.items()}
    spoken = {name: {"units": "1", "long_name": _LONG_NAMES[name]} for name in parts}
    return {name: part.assign_attrs(spoken[name]) for name, part in parts.items()}


def _warn_of_few(rates: xarray.Dataset) -> None:
    few = int(((rates["count"] >= _MANY) & (rates["distinct"] <= _FEW)).sum())
    if not few:
        return
    varied = rates.attrs["varied"]
    cause = f"what varied hardly moves the robot ({varied})" if varied else "nothing varied"
    reason = (
        f"should have more than {_FEW} distinct final poses in every cell: where {cause}, rates say"
        " little of other robots or floors (unknown= gives a band over uncertain parameters)"
    )
    few_text = f"{_FEW} or fewer in {few} of {rates['count'].size} cells"
    warn("table", few_text, reason)


def _distinct(valid: NDArray[np.bool_], *steps: NDArray[np.float64]) -> int:
    """Count the distinct poses, rounded to whole steps, of runs with a result."""
    values = (np.asarray(each)[np.asarray(valid)].tolist() for each in steps)  # one run is a scalar
    return len(set(zip(*values, strict=True)))


def _texts(outcomes: object) -> list[str]:
    is_text = isinstance(outcomes, str)
    if is_text or not is_iterable(outcomes) or getattr(outcomes, "ndim", 1) != 1:
        rule = "must be what sweep or table returned, or outcomes in a list"
        raise ScenarioError("table", outcomes, rule)
    names = list(Outcome)
    outcomes = list(outcomes)
    if any(isinstance(outcome, Record) for outcome in outcomes):
        raise ScenarioError("table", "runs", 'must be a table: write rate(table(runs), dim="run")')
    return [
        "" if outcome is None else read_choice(outcome, f"outcomes[{index}]", names)
        for index, outcome in enumerate(outcomes)
    ]
