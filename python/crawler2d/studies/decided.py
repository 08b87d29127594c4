"""What decides, as a data set: indices and boundaries by model and unknown."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from crawler2d.common.extras import extra
from crawler2d.runs.labelled import build_attributes
from crawler2d.studies.along import Range
from crawler2d.studies.boundary import SPOKEN, Crossing, Line
from crawler2d.studies.campaign import Campaign, Tally
from crawler2d.studies.design import RUN_TO_RUN, Design, rate_of
from crawler2d.studies.indices import COVERAGE, bounds, estimate
from crawler2d.sweeps.axes import field_attributes

if TYPE_CHECKING:
    import xarray
    from numpy.typing import NDArray

    from crawler2d.sweeps.found import Found

__all__ = ["Answer", "decided"]

_SPOKEN = {
    "first": "first-order index",
    "first_low": "its lower bound",
    "first_high": "its upper bound",
    "total": "total index",
    "total_low": "its lower bound",
    "total_high": "its upper bound",
    **SPOKEN,
    "range_low": "lower end of the range",
    "range_high": "upper end of the range",
    "own": "the scenario's own value",
    "tried": "value along the range",
    "tried_rate": "rate at that value",
    "count": "number of runs of the rate",
    "caveat": "why there are no indices",
    "outcome": "outcome of each run of the design",
}

_INDICES = ("first", "first_low", "first_high", "total", "total_low", "total_high")


@dataclass(frozen=True, slots=True)
class Answer:
    """What was found of one model.

    Attributes
    ----------
    matrices : list of Tally
        The runs of the design.
    lines : list of pair of Range and Line
        By unknown: its range, and the values that were tried along it, if it is a line.
    """

    matrices: list[Tally]
    lines: list[tuple[Range, Line | None]]


def decided(
    study: Campaign, design: Design, models: Sequence[Any], answers: Sequence[Answer], outcome: str
) -> Found:
    """Arrange what was found.

    Parameters
    ----------
    study, design
        What was done.
    models : sequence of str or number
        Labels.
    answers : sequence of Answer
        By model.
    outcome : str
        What the rates are rates of.

    Returns
    -------
    Found
        As `what_decides` says.
    """
    from crawler2d.sweeps.found import Found  # noqa: PLC0415 - needs xarray

    xr = extra("xarray", "analysis")
    names = [*design.factors.values(), *([RUN_TO_RUN] if design.is_varied else [])]
    units = [field_attributes([path]).get("units", "1") for path in design.factors]
    rest = [""] * (len(names) - len(units))  # what varies is no field
    whole = len(design.matrices)
    rates = [rate_of(each.matrices) for each in answers]
    told = [len(each.matrices) == whole for each in answers]
    seed, confidence = study.planner.seed, study.until.confidence
    indices = np.stack(
        [
            _indices(each.matrices, confidence, seed) if tells else np.full((6, len(names)), np.nan)
            for each, tells in zip(answers, told, strict=True)
        ],
        axis=1,
    )
    both = ("model", "unknown")
    found = xr.Dataset(
        {
            "rate": ("model", rates),
            "count": ("model", [sum(len(t.rows) for t in each.matrices[:2]) for each in answers]),
            "caveat": ("model", [_caveat(*each) for each in zip(rates, told, strict=True)]),
            **{name: (both, values) for name, values in zip(_INDICES, indices, strict=True)},
            "outcome": (
                ("model", "matrix", "sample"),
                [_outcomes(each.matrices, whole) for each in answers],
            ),
        },
        {
            "model": list(models),
            "unknown": names,
            "path": ("unknown", [*design.factors, *rest]),
            "unit": ("unknown", [*units, *rest]),
            "matrix": design.matrices,
        },
    )
    boundaries = _boundaries(xr, answers, models, list(design.factors.values()))
    gaps = {"rises": Crossing().rises, "monotone": Crossing().monotone}
    found = found.merge(boundaries.reindex(unknown=names, fill_value=gaps))
    for name, text in _SPOKEN.items():
        found[name].attrs["long_name"] = text
    found["rate"].attrs["long_name"] = f"rate of {outcome}"
    for name in ("rate", "count", "tried_rate", *_INDICES):
        found[name].attrs["units"] = "1"
    lines = [line for each in answers for _, line in each.lines if line is not None]
    tallies = [tally for line in lines for each in line.tallies.values() for tally in each]
    tallies += [tally for each in answers for tally in each.matrices]
    vary, unknown = study.planner.variation.text, design.unknowns.text
    return Found(found.data_vars, found.coords).assign_attrs(
        figure="what_decides",
        outcome=outcome,
        scenario=study.base.to_json(),
        vary=vary,
        unknown=unknown,
        population="; ".join(filter(None, [unknown, vary])),
        until=str(study.until),
        confidence_level=confidence,
        interval="Bayesian bootstrap",
        coverage=COVERAGE,
        samples=found.sizes["sample"],
        seed=seed,
        settings=study.settings,
        runs=sum(len(tally.rows) for tally in tallies),
        **build_attributes(),
    )


def _indices(matrices: Sequence[Tally], confidence: float, seed: int) -> NDArray[np.float64]:
    """Estimate the indices of a model, in the order of their columns."""
    f_a, f_b, *f_ab = (
        np.array([tally.counts(row) for row in tally.rows], dtype=float) for tally in matrices
    )
    swapped = np.array(f_ab)
    low, high = bounds(f_a, f_b, swapped, confidence, seed)
    own = estimate(f_a, f_b, swapped)
    parts = ((own.first, low.first, high.first), (own.total, low.total, high.total))
    return np.concatenate(parts)


def _caveat(rate: float, tells: bool) -> str:
    return "" if tells else f"cannot tell from a rate of {rate:.2f}"


def _outcomes(matrices: Sequence[Tally], whole: int) -> list[list[str]]:
    found = [[row.outcome for row in tally.rows] for tally in matrices]
    return found + [[""] * len(found[0])] * (whole - len(found))


def _boundaries(
    xr: Any, answers: Sequence[Answer], models: Sequence[Any], names: Sequence[str]
) -> xarray.Dataset:
    """Arrange crossings, ranges, and what was tried along them, by model and unknown."""
    lines = [[line for _, line in each.lines] for each in answers]
    crossings = [[Crossing() if ln is None else ln.crossing() for ln in row] for row in lines]
    rates = [[{} if ln is None else ln.rates() for ln in row] for row in lines]
    longest = max(len(each) for row in rates for each in row)
    tried = np.full((2, len(models), len(names), longest), math.nan)
    for place in np.ndindex(tried.shape[1:3]):
        own = rates[place[0]][place[1]]
        tried[(slice(None), *place, slice(len(own)))] = [list(own), list(own.values())]
    columns: dict[str, Any] = {
        name: [[getattr(each, name) for each in row] for row in crossings]
        for name in Crossing._fields
    }
    columns["range_low"] = [[along.first[0] for along, _ in each.lines] for each in answers]
    columns["range_high"] = [[along.first[1] for along, _ in each.lines] for each in answers]
    columns["own"] = [[along.own for along, _ in each.lines] for each in answers]
    both = ("model", "unknown")
    found: xarray.Dataset = xr.Dataset(
        {
            **{name: (both, values) for name, values in columns.items()},
            "tried": ((*both, "place"), tried[0]),
            "tried_rate": ((*both, "place"), tried[1]),
        },
        {"model": list(models), "unknown": list(names)},
    )
    return found
