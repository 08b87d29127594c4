"""Models and terrains of a study, and its results as a data set of rates or measures."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from crawler2d.common.arrays import is_iterable, real_number
from crawler2d.common.extras import extra
from crawler2d.errors import ScenarioError, warn
from crawler2d.parameters.scenario import Scenario, check_scenario
from crawler2d.parameters.terrain import RandomStepfield, Terrain
from crawler2d.sweeps.axes import Label, read_labels
from crawler2d.sweeps.rates import quantile_band
from crawler2d.sweeps.sweep import Variant, variants
from crawler2d.sweeps.tabulate import Column, dataset_of, draw_columns, row_columns
from crawler2d.variation.variability import of_contact, of_field, of_start

if TYPE_CHECKING:
    import xarray
    from numpy.typing import NDArray

    from crawler2d.studies.campaign import Campaign, Tally
    from crawler2d.sweeps.figure_dataset import FigureDataset
    from crawler2d.variation.distributions import Ranges

__all__ = [
    "Dims",
    "Measure",
    "Models",
    "check_study",
    "measure_table",
    "paths_of",
    "rate_table",
    "read_models",
    "read_numbers",
    "read_terrains",
    "refuse_own",
    "summary",
    "vary_fields",
]

Models = Mapping[Any, Variant] | Sequence[Variant]
"""Models by label, or a sequence of models; see `compare`."""


def check_study(scenario: object) -> None:
    """Check that xarray is installed and the argument is a scenario, before any run.

    Raises
    ------
    ScenarioError
        If it is not a `Scenario`.
    ImportError
        If xarray is missing; the message names the extra to install.
    """
    check_scenario(scenario)
    extra("xarray", "analysis")


def read_models(
    scenario: Scenario, models: Models | None, own: Sequence[str] = ()
) -> dict[Any, Mapping[str, Any]]:
    """Return the fields that each model replaces, by label; None means the scenario's own track.

    Raises
    ------
    ScenarioError
        If it is anything else, or a model replaces one of the study's `own` paths.
    """
    if models is None:
        return {scenario.robot.track.description: {}}
    fields = variants(models)
    refuse_own(fields, own, "models")
    return fields


def refuse_own(fields: Mapping[Any, Mapping[str, Any]], own: Sequence[str], place: str) -> None:
    """Refuse models that replace fields set by the study.

    Raises
    ------
    ScenarioError
        For the first such field; `place` names the argument.
    """
    for label, model in fields.items():
        for path in own:
            if path in model:
                rule = f"must not have {path}, which the study sets"
                raise ScenarioError(f"{place}[{label!r}]", model[path], rule)


def read_terrains(scenario: Scenario, terrains: object) -> dict[Label, Terrain]:
    """Return terrains by label; None means the scenario's own."""
    if terrains is None:
        return {scenario.terrain.kind: scenario.terrain}
    by_label = read_labels(terrains, "terrains")
    for label, terrain in by_label.items():
        if not isinstance(terrain, Terrain):
            # Items of a list have labels from their values, not indices.
            path = f"terrains[{label!r}]" if isinstance(terrains, Mapping) else "terrains"
            raise ScenarioError(path, terrain, "must be a terrain")
    return by_label


def vary_fields(terrains: Mapping[Label, Terrain]) -> Ranges:
    """Return the variation, with the seed of terrains that have one.

    Warns
    -----
    ScenarioWarning
        If terrains differ only in their seed, which is drawn.
    """
    labels: dict[Terrain, list[str]] = {}
    for label, terrain in terrains.items():
        if isinstance(terrain, RandomStepfield):
            labels.setdefault(replace(terrain, seed=0), []).append(str(label))
    for alike in labels.values():
        if len(alike) > 1:
            reason = (
                "should differ in more than their seed, which is drawn anew for every run; with"
                " vary= each keeps its own"
            )
            warn("terrains", ", ".join(alike), reason)
    return of_start() | of_contact() | of_field()


def read_numbers(values: object, place: str) -> list[float]:
    """Read an argument that takes one or more numbers.

    Raises
    ------
    ScenarioError
        If it is anything else.
    """
    listed = list(values) if is_iterable(values) and not isinstance(values, str) else []
    if not listed:
        raise ScenarioError(place, values, "must be one number or more, in a list")
    return [real_number(value, f"{place}[{k}]") for k, value in enumerate(listed)]


def paths_of(fields: Mapping[Any, Mapping[str, Any]]) -> list[str]:
    """List all paths that models replace, each once."""
    return list(dict.fromkeys(path for own in fields.values() for path in own))


Dims = Mapping[str, tuple[Sequence[Any], Mapping[str, str]]]
"""Labels and attributes of each dimension of the cells of a study."""

_LONG_NAMES = {
    "rate": "rate of clearing",
    "low": "lower bound",
    "high": "upper bound",
    "count": "number of runs",
    "side": "certainly below (-1) or above (1) the threshold",
}


def rate_table(
    campaign: Campaign,
    figure: str,
    tallies: Sequence[Sequence[Tally]],
    dims: Dims,
) -> FigureDataset:
    """Arrange the rates of a study.

    Parameters
    ----------
    campaign : Campaign
        The study.
    figure : str
        Name of the plot of `FigureDataset.plot`.
    tallies : sequence of sequence of Tally
        By cell and sample; the last dimension of the cells changes fastest.
    dims : mapping of str to pair
        Labels and attributes of each dimension of the cells.

    Returns
    -------
    FigureDataset
        With `rate`, `low`, `high`, `count`, `side` for each cell (and each `sample` of unknowns,
        with their band, see `rate`), and the columns of `sweep` for each run; `repeat` is as long
        as the longest cell, and the `outcome` of missing runs is "".
    """
    from crawler2d.sweeps.figure_dataset import FigureDataset  # noqa: PLC0415 - needs xarray

    flat = [tally for each in tallies for tally in each]
    sizes, coordinates = _frame(campaign, dims)
    runs = _runs(campaign, flat, sizes, coordinates)
    intervals = [tally.interval for tally in flat]
    by_cell: dict[str, Column] = {
        "rate": (np.array([each.rate for each in intervals]), {}),
        "low": (np.array([each.low for each in intervals]), {}),
        "high": (np.array([each.high for each in intervals]), {}),
        "count": (np.array([len(tally.valid) for tally in flat]), {}),
        "side": (np.array([each.side(campaign.threshold) for each in intervals]), {}),
    }
    by_cell |= _sampled(campaign, flat)
    rates = dataset_of(by_cell, sizes, coordinates)
    for name, text in _LONG_NAMES.items():
        rates[name].attrs = {"units": "1", "long_name": text}
    if "sample" in sizes:
        rates = rates.assign(quantile_band(rates["rate"]))
    until = campaign.until
    merged = runs.merge(rates)
    return FigureDataset(merged.data_vars, merged.coords).assign_attrs(
        **campaign.attributes(figure, flat),
        until=str(until),
        confidence_level=until.confidence,
        interval="sequential",
    )


@dataclass(frozen=True, slots=True, eq=False)
class Measure:
    """A quantity measured in every repeat of every cell and sample.

    Attributes
    ----------
    dims : tuple of str
        Dimensions of the cells.
    values : ndarray, shape (..., samples, repeats)
        Values; NaN if there is none.
    units, long_name : str
        Unit and description.
    """

    dims: tuple[str, ...]
    values: NDArray[np.float64]
    units: str
    long_name: str


def measure_table(
    campaign: Campaign,
    figure: str,
    tallies: Sequence[Sequence[Tally]],
    dims: Dims,
    measures: Mapping[str, Measure],
) -> FigureDataset:
    """Arrange the measures of a study with a fixed number of repeats.

    Parameters
    ----------
    campaign, figure, tallies, dims
        See `rate_table`.
    measures : mapping of str to Measure
        Measures by name, different from columns of `sweep`; `FigureDataset.plot` draws the first.

    Returns
    -------
    FigureDataset
        The columns of `sweep` for each run; and for a measure such as `speed`: `speed_each` of
        every repeat, their median `speed`, and their minimum `speed_low` and maximum `speed_high`,
        all three NaN if a repeat has no value; with unknowns, a band of the medians over the
        samples, NaN if a sample has none: `speed_band_low`, `speed_band_median` and
        `speed_band_high`.
    """
    from crawler2d.sweeps.figure_dataset import FigureDataset  # noqa: PLC0415 - needs xarray

    flat = [tally for each in tallies for tally in each]
    sizes, coordinates = _frame(campaign, dims)
    table = _runs(campaign, flat, sizes, coordinates)
    table = table.merge(dataset_of(_sampled(campaign, flat), sizes, coordinates))
    for name, measure in measures.items():
        table = table.assign(summary(name, _each(measure, table)))
    return FigureDataset(table.data_vars, table.coords).assign_attrs(
        **campaign.attributes(figure, flat),
        repeats=campaign.until.max_runs,
        measure=next(iter(measures)),
    )


def summary(name: str, each: xarray.DataArray) -> dict[str, xarray.DataArray]:
    """Summarise a measure over its dimension `repeat`, and `sample` if present.

    Parameters
    ----------
    name : str
        Name of the measure.
    each : DataArray
        Value of every repeat, with `units` and `long_name`.

    Returns
    -------
    dict of str to DataArray
        See `measure_table`.
    """
    parts = {
        f"{name}_each": (each, "of each repeat"),
        name: (each.median("repeat", skipna=False), "median over the repeats"),
        f"{name}_low": (each.min("repeat", skipna=False), "lowest of the repeats"),
        f"{name}_high": (each.max("repeat", skipna=False), "highest of the repeats"),
    }
    if "sample" in each.dims:
        known = parts[name][0].notnull().all("sample")
        for part, values in quantile_band(parts[name][0]).items():
            text = str(values.attrs["long_name"]).replace("rates", "medians")
            parts[f"{name}_{part}"] = (values.where(known), text)
    units, long_name = each.attrs["units"], each.attrs["long_name"]
    return {
        key: values.assign_attrs(
            units=units, long_name=long_name if key == name else f"{long_name}, {text}"
        )
        for key, (values, text) in parts.items()
    }


def _each(measure: Measure, runs: xarray.Dataset) -> xarray.DataArray:
    """Give the values of a measure their dimensions in the table of runs."""
    names = [*measure.dims, *(dim for dim in ("sample", "repeat") if dim in runs.sizes)]
    others = {dim: 0 for dim in runs["outcome"].dims if dim not in names}
    like = runs["outcome"].isel(others, drop=True).transpose(*names)
    each = like.copy(data=measure.values.reshape(like.shape))
    return each.assign_attrs(units=measure.units, long_name=measure.long_name)


def _frame(campaign: Campaign, dims: Dims) -> tuple[dict[str, int], dict[str, Any]]:
    """Return sizes and coordinates of cells and, with unknowns, samples."""
    sizes = {name: len(labels) for name, (labels, _) in dims.items()}
    coordinates: dict[str, Any] = {
        name: (name, np.array(labels), dict(attributes))
        for name, (labels, attributes) in dims.items()
    }
    if campaign.planner.unknowns.distributions:
        sizes["sample"] = campaign.planner.samples
        coordinates["sample"] = np.arange(campaign.planner.samples)
    return sizes, coordinates


def _runs(
    campaign: Campaign,
    flat: Sequence[Tally],
    sizes: Mapping[str, int],
    coordinates: Mapping[str, Any],
) -> xarray.Dataset:
    """Arrange every run; `repeat` is as long as the longest cell."""
    longest = max((len(tally.rows) for tally in flat), default=0)
    rows = [row for t in flat for row in (*t.rows, *[None] * (longest - len(t.rows)))]
    columns = row_columns(rows, trials=campaign.trials, with_times=True)
    columns |= draw_columns(
        "drawn",
        campaign.planner.variation,
        lambda path: np.concatenate([_drawn(tally, path, longest) for tally in flat]),
    )
    return dataset_of(
        columns, {**sizes, "repeat": longest}, {**coordinates, "repeat": np.arange(longest)}
    )


def _drawn(tally: Tally, path: str, longest: int) -> NDArray[np.float64]:
    """Join the draws of all batches of a tally, padded with NaN."""
    batches = [drawn[path] for drawn in tally.drawn if path in drawn]
    values = np.concatenate(batches) if batches else np.empty(0)
    return np.pad(values, (0, longest - values.size), constant_values=math.nan)


def _sampled(campaign: Campaign, flat: Sequence[Tally]) -> dict[str, Column]:
    return draw_columns(
        "unknown",
        campaign.planner.unknowns,
        lambda path: np.array([tally.world.sampled.get(path, math.nan) for tally in flat]),
    )
