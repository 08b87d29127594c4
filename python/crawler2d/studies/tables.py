"""The runs of a study as a data set: rates by cell, and every run behind them."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from crawler2d.runs.labelled import build_attributes
from crawler2d.sweeps.axes import field_attributes, short_names
from crawler2d.sweeps.dataset import Column, dataset_of, row_columns
from crawler2d.sweeps.rates import banded

if TYPE_CHECKING:
    from crawler2d.studies.campaign import Campaign, Tally
    from crawler2d.sweeps.found import Found

__all__ = ["found_of"]

_SPOKEN = {
    "rate": "rate",
    "low": "lower bound",
    "high": "upper bound",
    "count": "number of runs",
    "side": "certainly below (-1) or above (1) the threshold",
}


def found_of(
    campaign: Campaign,
    figure: str,
    tallies: Sequence[Sequence[Tally]],
    dims: Mapping[str, tuple[Sequence[Any], Mapping[str, str]]],
) -> Found:
    """Arrange what a study found.

    Parameters
    ----------
    campaign : Campaign
        The study.
    figure : str
        What `Found.plot` draws.
    tallies : sequence of sequence of Tally
        By cell and sample; the last dimension of the cells changes fastest.
    dims : mapping of str to pair
        Labels and attributes of each dimension of the cells.

    Returns
    -------
    Found
        With `rate`, `low`, `high`, `count`, `side` for each cell (and `sample` of unknowns, with a
        band over them, as of `rate`), and the columns of `sweep` for each run; `repeat` is
        as long as the longest cell, and where a cell has fewer runs, its `outcome` is "".
    """
    from crawler2d.sweeps.found import Found  # noqa: PLC0415 - needs xarray

    flat = [tally for each in tallies for tally in each]
    longest = max((len(tally.rows) for tally in flat), default=0)
    rows = [row for t in flat for row in (*t.rows, *[None] * (longest - len(t.rows)))]
    columns = row_columns(rows, trials=campaign.trials, with_times=True)
    columns |= _drawn(campaign, flat, longest)
    sizes = {name: len(labels) for name, (labels, _) in dims.items()}
    coordinates: dict[str, Any] = {
        name: (name, np.array(labels), dict(attributes))
        for name, (labels, attributes) in dims.items()
    }
    unknowns = campaign.planner.unknowns.distributions
    if unknowns:
        sizes["sample"] = campaign.planner.samples
        coordinates["sample"] = np.arange(campaign.planner.samples)
    whole = dataset_of(
        columns, {**sizes, "repeat": longest}, {**coordinates, "repeat": np.arange(longest)}
    )
    intervals = [tally.interval for tally in flat]
    by_cell: dict[str, Column] = {
        "rate": (np.array([each.rate for each in intervals]), {}),
        "low": (np.array([each.low for each in intervals]), {}),
        "high": (np.array([each.high for each in intervals]), {}),
        "count": (np.array([len(tally.made) for tally in flat]), {}),
        "side": (np.array([tally.side for tally in flat]), {}),
    }
    for path, name in short_names(list(unknowns)).items():
        values = np.array([tally.world.sampled.get(path, math.nan) for tally in flat])
        by_cell[f"unknown_{name}"] = (values, field_attributes([path]))
    rates = dataset_of(by_cell, sizes, coordinates)
    for name, text in _SPOKEN.items():
        rates[name].attrs = {"units": "1", "long_name": text}
    if unknowns:
        rates = rates.assign(banded(rates["rate"]))
    until = campaign.until
    merged = whole.merge(rates)
    return Found(merged.data_vars, merged.coords).assign_attrs(
        figure=figure,
        scenario=campaign.base.to_json(),
        vary=campaign.planner.variation.text,
        unknown=campaign.planner.unknowns.text,
        until=str(until),
        confidence_level=until.confidence,
        interval="sequential",
        settings=campaign.settings,
        runs=sum(len(tally.rows) for tally in flat),
        **build_attributes(),
    )


def _drawn(campaign: Campaign, flat: Sequence[Tally], longest: int) -> dict[str, Column]:
    columns: dict[str, Column] = {}
    for path, name in short_names(list(campaign.planner.variation.distributions)).items():
        parts = []
        for tally in flat:
            own = [drawn[path] for drawn in tally.drawn if path in drawn]
            values = np.concatenate(own) if own else np.empty(0)
            parts.append(np.pad(values, (0, longest - values.size), constant_values=math.nan))
        columns[f"drawn_{name}"] = (np.concatenate(parts), field_attributes([path]))
    return columns
