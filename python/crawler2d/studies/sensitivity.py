"""Sensitivity of an outcome to uncertain parameters: Sobol indices and boundaries."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Unpack

import numpy as np

from crawler2d.common.arrays import whole_number
from crawler2d.common.extras import extra
from crawler2d.common.keywords import takes_keywords
from crawler2d.errors import ScenarioError
from crawler2d.parameters.scenario import Scenario
from crawler2d.results.outcome import rate_label
from crawler2d.studies.boundary import (
    LONG_NAMES,
    Crossing,
    Line,
    Range,
    check_ends,
    line_over,
    range_of,
)
from crawler2d.studies.campaign import Campaign, RateSampling, Tally, campaign, counting
from crawler2d.studies.sobol import COVERAGE, RUN_TO_RUN, Design, bounds, estimate, rate_of
from crawler2d.studies.tables import Models, check_study, paths_of, read_models
from crawler2d.sweeps.axes import field_attributes
from crawler2d.variation.draws import Variation

if TYPE_CHECKING:
    import xarray
    from numpy.typing import NDArray

    from crawler2d.sweeps.figure_dataset import FigureDataset

__all__ = ["sensitivity"]

_LONG_NAMES = {
    "first": "first-order index",
    "first_low": "its lower bound",
    "first_high": "its upper bound",
    "total": "total index",
    "total_low": "its lower bound",
    "total_high": "its upper bound",
    **LONG_NAMES,
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
class ModelResult:
    """The runs of one model.

    Attributes
    ----------
    matrices : list of Tally
        The runs of the design.
    lines : list of pair of Range and Line
        By unknown: its range and the values tried along it, if it is a line.
    """

    matrices: list[Tally]
    lines: list[tuple[Range, Line | None]]


def sensitivity_table(
    study: Campaign,
    design: Design,
    models: Sequence[Any],
    results: Sequence[ModelResult],
    outcome: str,
) -> FigureDataset:
    """Arrange the results.

    Parameters
    ----------
    study, design
        The study and its design.
    models : sequence of str or number
        Labels of the models.
    results : sequence of ModelResult
        Results by model.
    outcome : str
        Outcome of the rates.

    Returns
    -------
    FigureDataset
        See `sensitivity`.
    """
    from crawler2d.sweeps.figure_dataset import FigureDataset  # noqa: PLC0415 - needs xarray

    xr = extra("xarray", "analysis")
    names = [*design.factors.values(), *([RUN_TO_RUN] if design.is_varied else [])]
    units = [field_attributes([path]).get("units", "1") for path in design.factors]
    rest = [""] * (len(names) - len(units))  # run-to-run variation is not a field
    whole = len(design.matrices)
    rates = [rate_of(each.matrices) for each in results]
    complete = [len(each.matrices) == whole for each in results]
    seed, confidence = study.planner.seed, study.until.confidence
    indices = np.stack(
        [
            _indices(each.matrices, confidence, seed)
            if is_complete
            else np.full((6, len(names)), np.nan)
            for each, is_complete in zip(results, complete, strict=True)
        ],
        axis=1,
    )
    both = ("model", "unknown")
    dataset = xr.Dataset(
        {
            "rate": ("model", rates),
            "count": ("model", [sum(len(t.rows) for t in each.matrices[:2]) for each in results]),
            "caveat": ("model", [_caveat(*each) for each in zip(rates, complete, strict=True)]),
            **{name: (both, values) for name, values in zip(_INDICES, indices, strict=True)},
            "outcome": (
                ("model", "matrix", "sample"),
                [_outcomes(each.matrices, whole) for each in results],
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
    boundaries = _boundaries(xr, results, models, list(design.factors.values()))
    gaps = {"rises": Crossing().rises, "monotone": Crossing().monotone}
    dataset = dataset.merge(boundaries.reindex(unknown=names, fill_value=gaps))
    for name, text in _LONG_NAMES.items():
        dataset[name].attrs["long_name"] = text
    dataset["rate"].attrs["long_name"] = rate_label(outcome)
    for name in ("rate", "count", "tried_rate", *_INDICES):
        dataset[name].attrs["units"] = "1"
    lines = [line for each in results for _, line in each.lines if line is not None]
    tallies = [tally for line in lines for each in line.tallies.values() for tally in each]
    tallies += [tally for each in results for tally in each.matrices]
    attributes = {**study.attributes("sensitivity", tallies), "unknown": design.unknowns.text}
    return FigureDataset(dataset.data_vars, dataset.coords).assign_attrs(
        outcome=outcome,
        population="; ".join(filter(None, [attributes["unknown"], attributes["vary"]])),
        until=str(study.until),
        confidence_level=confidence,
        interval="Bayesian bootstrap",
        coverage=COVERAGE,
        samples=dataset.sizes["sample"],
        seed=seed,
        **attributes,
    )


def _indices(matrices: Sequence[Tally], confidence: float, seed: int) -> NDArray[np.float64]:
    """Estimate the indices of a model, in the order of the columns."""
    f_a, f_b, *f_ab = (
        np.array([tally.counts(row) for row in tally.rows], dtype=float) for tally in matrices
    )
    swapped = np.array(f_ab)
    low, high = bounds(f_a, f_b, swapped, confidence, seed)
    own = estimate(f_a, f_b, swapped)
    parts = ((own.first, low.first, high.first), (own.total, low.total, high.total))
    return np.concatenate(parts)


def _caveat(rate: float, is_complete: bool) -> str:
    return "" if is_complete else f"cannot tell from a rate of {rate:.2f}"


def _outcomes(matrices: Sequence[Tally], whole: int) -> list[list[str]]:
    outcomes = [[row.outcome for row in tally.rows] for tally in matrices]
    return outcomes + [[""] * len(outcomes[0])] * (whole - len(outcomes))


def _boundaries(
    xr: Any, results: Sequence[ModelResult], models: Sequence[Any], names: Sequence[str]
) -> xarray.Dataset:
    """Arrange crossings, ranges and the values tried, by model and unknown."""
    lines = [[line for _, line in each.lines] for each in results]
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
    columns["range_low"] = [[along.first[0] for along, _ in each.lines] for each in results]
    columns["range_high"] = [[along.first[1] for along, _ in each.lines] for each in results]
    columns["own"] = [[along.own for along, _ in each.lines] for each in results]
    both = ("model", "unknown")
    dataset: xarray.Dataset = xr.Dataset(
        {
            **{name: (both, values) for name, values in columns.items()},
            "tried": ((*both, "place"), tried[0]),
            "tried_rate": ((*both, "place"), tried[1]),
        },
        {"model": list(models), "unknown": list(names)},
    )
    return dataset


_FEWEST, _MOST = 32, 2**16
"""Default number of points of a design."""


@takes_keywords
def sensitivity(
    scenario: Scenario,
    *,
    models: Models | None = None,
    outcome: str = "cleared",
    **sampling: Unpack[RateSampling],
) -> FigureDataset:
    """Find which uncertain parameters matter most for the outcome: a global sensitivity analysis.

    The outcome differs between runs because of the uncertain parameters of robot and floor, and
    because of the run-to-run variation. Sobol indices say how much of the variance comes from each
    uncertain parameter, and from all run-to-run variation together. They need separate runs: n + 2
    times `samples` for n such factors. Then each parameter is moved over its range, with all others
    as in the scenario, to find where the rate crosses one half.

    Parameters
    ----------
    scenario : Scenario
        The scenario that all runs share.
    models : mapping of str to track or fields, optional
        See `compare`; None takes the scenario's own robot.
    outcome : str
        Name of an `Outcome`, or "stopped" for any stop.
    **sampling
        See `crawler2d.studies`. `unknown` is required. `samples` is a power of two from 32 to
        65536; the default is 256. `until` applies to the rates along the ranges; its confidence
        also applies to the indices.

    Returns
    -------
    FigureDataset
        Dimensions `model`; `unknown`, by the last part of its path, and finally "run to run" if
        anything varies; `place`, the values tried of each; and `matrix` and `sample`, the points of
        the design: A, B, and A with one factor of B. For each model and unknown:

        - `first`: the fraction of the variance that would vanish if this one were known; `total`:
          the fraction that would remain if all others were known; with `..._low` and `..._high`.
          The difference is its interaction with the others. Estimates may be below 0;
        - `bracket_low`, `bracket_high`, `rises`, `monotone`: see `critical_value`, over the range
          of the distribution (1 to 99 % of an unbounded one); elements of a path with ``[*]`` move
          together, and values are those of the first; NaN also for whole numbers and "run to run";
        - `range_low`, `range_high`, `own`: ends of the range, and the scenario's own value;
        - `tried`, `tried_rate`: the values tried along the range, and the rate at each.

        For each model: `rate` over all variation and unknowns, from `count` runs; and `caveat`,
        empty if there are indices. These are NaN if the rate is not between 0.1 and 0.9, as too few
        runs then have the rarer outcome; the other runs are skipped. `outcome` is that of every run
        of the design, "" if skipped; a store keeps the runs.

        `plot` draws the indices of one model, and ``plot(show="boundary")`` the ranges.

    Raises
    ------
    ScenarioError
        If an argument, or a value in the range of an unknown, breaks a rule.
    SimulationDiverged
        If a run of the design has no result.
    ImportError
        If SciPy or xarray is missing; the message names the extra to install.

    References
    ----------
    Sobol, I. M. (2001). Global sensitivity indices for nonlinear mathematical models and their
    Monte Carlo estimates. Mathematics and Computers in Simulation 55, 271-280. The estimator is
    described in `crawler2d.studies.sobol`; the attribute `coverage` says how often intervals
    contained known indices.

    Examples
    --------
    Friction decides whether a belt climbs a slope; sufficiently strong motors do not matter:

    >>> import math
    >>> import crawler2d as c2d
    >>> robot = c2d.robots.engineer(flippers=None)
    >>> base = c2d.Scenario(robot, c2d.terrains.ramp(math.atan(0.7)))
    >>> unknown = {
    ...     "terrain.friction": c2d.uniform(0.5, 1.0),
    ...     "robot.drivetrain.max_torque": c2d.uniform(30.0, 40.0),
    ... }
    >>> until = c2d.Until(threshold=0.5, min_runs=5, max_runs=10)  # quick
    >>> found = c2d.studies.sensitivity(
    ...     base, unknown=unknown, samples=32, until=until, progress=False
    ... )
    >>> found["unknown"].values.tolist()
    ['friction', 'max_torque', 'run to run']
    >>> found["first"].values.round(1).tolist()
    [[1.0, 0.0, 0.0]]
    >>> round(found["bracket_low"].sel(unknown="friction").item(), 2)
    0.7
    """
    check_study(scenario)
    extra("scipy.stats", "sensitivity")  # fail before the runs if it is missing
    counts = counting(outcome)
    samples = _power_of_two(sampling.get("samples", 256))
    fields = read_models(scenario, models)
    swept = paths_of(fields)
    unknowns = _unknowns(scenario, sampling.pop("unknown", None), swept)
    sampling.pop("samples", None)
    with campaign(scenario, sampling, [*swept, *unknowns.distributions], threshold=0.5) as study:
        if len(unknowns.distributions) < 2 and not study.planner.variation.distributions:
            rule = "must have two paths or more where nothing varies from run to run"
            raise ScenarioError("unknown", unknowns.text, rule)
        design = Design(study, unknowns, samples, counts)
        cells = {label: scenario.replace(own) for label, own in fields.items()}
        ranges = {
            (label, name): range_of(unknowns, path, cell)
            for label, cell in cells.items()
            for path, name in design.factors.items()
        }
        for (label, name), along in ranges.items():
            if along.is_line:
                check_ends(study, along.at, along.first, (f"model={label}", name))
        results = []
        for label, cell in cells.items():
            matrices = design.run(cell, str(label))
            lines = []
            for name in design.factors.values():
                along = ranges[label, name]
                line = line_over(study, along, (f"model={label}", name), counts)
                lines.append((along, line))
            results.append(ModelResult(matrices, lines))
        return sensitivity_table(study, design, list(fields), results, outcome)


def _power_of_two(value: object) -> int:
    number = whole_number(value, "samples", _FEWEST, _MOST)
    if number & (number - 1):
        raise ScenarioError("samples", number, "must be a power of two")
    return number


def _unknowns(scenario: Scenario, given: object, swept: list[str]) -> Variation:
    if not given or not isinstance(given, Mapping):
        rule = "must be a mapping from paths to distributions, such as unknowns.of_ground()"
        raise ScenarioError("unknown", given, rule)
    return Variation.read(scenario, given, swept, "unknown")
