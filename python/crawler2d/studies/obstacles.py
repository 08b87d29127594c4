"""Highest obstacle, steepest slope, widest gap, and rates over a set of terrains."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, NamedTuple, Unpack

import numpy as np

from crawler2d.common.keywords import takes_keywords
from crawler2d.errors import ScenarioError
from crawler2d.parameters.fields import read_path
from crawler2d.parameters.scenario import Scenario
from crawler2d.parameters.terrain import Terrain
from crawler2d.results.outcome import Outcome
from crawler2d.results.record import NO_RESULT
from crawler2d.studies.campaign import Cell, RateSampling, Tally, campaign
from crawler2d.studies.tables import (
    Models,
    check_study,
    paths_of,
    rate_table,
    read_models,
    read_numbers,
    read_terrains,
    vary_fields,
)
from crawler2d.sweeps.axes import field_attributes

if TYPE_CHECKING:
    from crawler2d.sweeps.figure_dataset import FigureDataset

__all__ = ["max_gap", "max_obstacle", "max_slope", "success_rate"]

_NONE = "none up to here"
"""Limit of a model that clears everything tried."""


@takes_keywords
def max_obstacle(
    scenario: Scenario,
    *,
    models: Models | None = None,
    heights: Sequence[float] | None = None,
    **sampling: Unpack[RateSampling],
) -> FigureDataset:
    """Find the highest obstacle that each model clears.

    Every height is tried, because a lower one may fail and a higher one may not: wheels seize on
    edges that just fit between them.

    Parameters
    ----------
    scenario : Scenario
        Its terrain has a `height`, such as a step or a barrier.
    models : mapping of str to track or fields, optional
        See `compare`; None takes the scenario's own robot.
    heights : sequence of float, optional
        [m] Heights to try; None takes multiples of a sixth of the front radius, up to twice the
        radius.
    **sampling
        See `crawler2d.studies`. Each cell is simulated until its rate is known to be above or below
        one half, or within 0.2, unless `until` says otherwise.

    Returns
    -------
    FigureDataset
        Dimensions `model`, `height`, `sample` if there are unknowns, and `repeat`; `rate`, `low`,
        `high`, `count`, `side`, the columns of `sweep`, and:

        - `highest` [m]: the largest height with a rate of at least one half; NaN if there is none;
        - `certain` [m]: the largest one with an interval above one half;
        - `gaps`: the number of lower heights with a rate below one half;
        - `limit`: the commonest outcome at the next height; "none up to here" if there is none.

        The attribute `summary` describes it in words.

    Raises
    ------
    ScenarioError
        If the terrain has no such field, or an argument breaks a rule.

    Examples
    --------
    >>> import crawler2d as c2d
    >>> base = c2d.Scenario(c2d.robots.engineer(flippers=None), c2d.terrains.step(0.05))
    >>> models = {"belt": c2d.BeltTrack(), "skids": c2d.ForceTrack()}
    >>> found = c2d.studies.max_obstacle(
    ...     base, models=models, heights=[0.03, 0.06], progress=False
    ... )
    >>> found["highest"].values.tolist()
    [0.06, 0.03]
    >>> print(found.attrs["summary"])
    belt: height up to 0.06 m, the greatest tried
    skids: height up to 0.03 m, then mostly stalled
    """
    check_study(scenario)
    radius = scenario.robot.outline.front_radius
    given = [radius * k / 6.0 for k in range(1, 13)] if heights is None else heights
    return _find_greatest(scenario, "max_obstacle", ("terrain.height", given), models, sampling)


@takes_keywords
def max_slope(
    scenario: Scenario,
    *,
    models: Models | None = None,
    angles: Sequence[float] | None = None,
    **sampling: Unpack[RateSampling],
) -> FigureDataset:
    """Find the steepest slope that each model climbs; see `max_obstacle`.

    Parameters
    ----------
    scenario : Scenario
        Its terrain has an `angle`, such as a ramp.
    models, **sampling
        See `max_obstacle`.
    angles : sequence of float, optional
        [rad] Angles to try; None takes 5 to 60 degrees, 5 apart.
    """
    check_study(scenario)
    given = [math.radians(5.0 * k) for k in range(1, 13)] if angles is None else angles
    return _find_greatest(scenario, "max_slope", ("terrain.angle", given), models, sampling)


@takes_keywords
def max_gap(
    scenario: Scenario,
    *,
    models: Models | None = None,
    widths: Sequence[float] | None = None,
    **sampling: Unpack[RateSampling],
) -> FigureDataset:
    """Find the widest gap that each model crosses; see `max_obstacle`.

    Parameters
    ----------
    scenario : Scenario
        Its terrain has a `width`, such as a gap.
    models, **sampling
        See `max_obstacle`.
    widths : sequence of float, optional
        [m] Widths to try; None takes multiples of a tenth of the axle distance, up to all of it.
    """
    check_study(scenario)
    length = scenario.robot.outline.axle_distance
    given = [length * k / 10.0 for k in range(1, 11)] if widths is None else widths
    return _find_greatest(scenario, "max_gap", ("terrain.width", given), models, sampling)


def _find_greatest(
    scenario: Scenario,
    figure: str,
    over: tuple[str, Sequence[float]],
    models: Models | None,
    sampling: RateSampling,
) -> FigureDataset:
    path, values = over
    name = path.rpartition(".")[2]
    try:
        read_path(scenario, path)
    except ScenarioError:
        rule = f"must be a terrain with {'an' if name == 'angle' else 'a'} {name}"
        raise ScenarioError("terrain", scenario.terrain, rule) from None
    tried = sorted(set(read_numbers(values, f"{name}s")))
    fields = read_models(scenario, models, [path])
    with campaign(scenario, sampling, [path, *paths_of(fields)], threshold=0.5) as study:
        cells = [
            Cell((f"model={label}", f"{name}={value:g}"), scenario.replace({**own, path: value}))
            for label, own in fields.items()
            for value in tried
        ]
        tallies = study.repeat(cells)
        table = rate_table(
            study,
            figure,
            tallies,
            {"model": (list(fields), {}), name: (tried, field_attributes([path]))},
        )
    count = len(tried)
    rows = [
        [cell[sample] for cell in tallies[begin : begin + count]]
        for begin in range(0, len(tallies), count)
        for sample in range(len(tallies[begin]))
    ]
    limits = [_limits(row, tried) for row in rows]
    columns = zip(*limits, strict=True)
    dims = tuple(str(dim) for dim in table["rate"].dims if dim != name)
    shape = [table.sizes[dim] for dim in dims]
    units = field_attributes([path]).get("units", "1")
    attributes: Mapping[str, dict[str, str]] = {
        "highest": {"units": units, "long_name": f"greatest {name} with a rate of 0.5 or more"},
        "certain": {"units": units, "long_name": f"greatest {name} certainly above a rate of 0.5"},
        "gaps": {"units": "1", "long_name": f"lower {name}s with a rate below 0.5"},
        "limit": {"long_name": "how most runs end on the next"},
    }
    samples = len(limits) // len(fields)
    lines = [
        f"{label}: {_limits_text(limits[k * samples : (k + 1) * samples], name, units)}"
        for k, label in enumerate(fields)
    ]
    return table.assign(
        {
            key: (dims, np.reshape(column, shape), attributes[key])
            for key, column in zip(attributes, columns, strict=True)
        }
    ).assign_attrs(summary="\n".join(lines))


def _limits_text(limits: Sequence[_Limits], name: str, units: str) -> str:
    """Describe what a model clears, over all samples of the unknowns."""
    greatest = sorted({each.highest for each in limits if not math.isnan(each.highest)})
    if not greatest:
        text = f"no {name} that was tried"
    else:
        ends = dict.fromkeys((f"{greatest[0]:g}", f"{greatest[-1]:g}"))
        text = f"{name} up to {' to '.join(ends)} {units}"
        if none := sum(math.isnan(each.highest) for each in limits):
            text += f", but none in {none} of {len(limits)} samples"
    if any(each.gaps for each in limits):
        text += ", but not every lower one"
    ((limit, _),) = Counter(each.limit for each in limits).most_common(1)
    after = "the greatest tried" if limit == _NONE else f"then mostly {limit.replace('_', ' ')}"
    return f"{text}, {after}"


class _Limits(NamedTuple):
    """The limits of one model, see `max_obstacle`."""

    highest: float
    certain: float
    gaps: int
    limit: str


def _limits(row: Sequence[Tally], values: Sequence[float]) -> _Limits:
    intervals = [tally.interval for tally in row]
    cleared = [v for v, each in zip(values, intervals, strict=True) if each.rate >= 0.5]
    certain = [v for v, each in zip(values, intervals, strict=True) if each.low > 0.5]
    highest = max(cleared, default=math.nan)
    gaps = sum(value < highest for value in values) - sum(value < highest for value in cleared)
    beyond = [t for t, value in zip(row, values, strict=True) if not value <= highest]
    limit = (beyond[0].commonest_failure or beyond[0].commonest_outcome) if beyond else _NONE
    return _Limits(highest, max(certain, default=math.nan), gaps, limit)


@takes_keywords
def success_rate(
    scenario: Scenario,
    *,
    terrains: Mapping[str, Terrain] | None = None,
    models: Models | None = None,
    **sampling: Unpack[RateSampling],
) -> FigureDataset:
    """Find the rate at which each model clears each terrain, and how and where it fails.

    Parameters
    ----------
    scenario : Scenario
        The scenario that all runs share.
    terrains : mapping of str to terrain, optional
        Terrains by label; None takes the scenario's own.
    models : mapping of str to track or fields, optional
        See `compare`; None takes the scenario's own robot.
    **sampling
        See `crawler2d.studies`. Unless `vary` is given, every run on a random step field also has
        its own field. Each cell is simulated until its rate is known within 0.2, unless `until`
        says otherwise.

    Returns
    -------
    FigureDataset
        Dimensions `model`, `terrain`, `sample` if there are unknowns, and `repeat`; `rate` of
        clearing with its interval and `count`; the columns of `sweep` for each run (`outcome`,
        `stop_x` and `mechanism` show how and where it failed); and a column `ended_...` with the
        count of each outcome that occurred.

    Raises
    ------
    ScenarioError
        If `terrains` contains anything else, or an argument breaks a rule.

    Warns
    -----
    ScenarioWarning
        If random step fields differ only in their seed, and `vary` is not given.

    Examples
    --------
    >>> import crawler2d as c2d
    >>> base = c2d.Scenario(c2d.robots.engineer(flippers=None), c2d.terrains.flat())
    >>> grounds = {"step": c2d.terrains.step(0.06), "wall": c2d.terrains.step(0.3)}
    >>> found = c2d.studies.success_rate(base, terrains=grounds, progress=False)
    >>> found["rate"].sel(terrain="step").item(), found["ended_cleared"].values.tolist()
    (1.0, [[33, 0]])
    """
    check_study(scenario)
    grounds = read_terrains(scenario, terrains)
    fields = read_models(scenario, models, ["terrain"] if terrains is not None else [])
    if sampling.get("vary") is None and any(hasattr(ground, "seed") for ground in grounds.values()):
        sampling = {**sampling, "vary": vary_fields(grounds)}
    with campaign(scenario, sampling, ["terrain", *paths_of(fields)]) as study:
        cells = [
            Cell((f"model={label}", f"terrain={name}"), scenario.replace({"terrain": each, **own}))
            for label, own in fields.items()
            for name, each in grounds.items()
        ]
        tallies = study.repeat(cells)
        no_units: dict[str, str] = {}
        dims = {"model": (list(fields), no_units), "terrain": (list(grounds), no_units)}
        table = rate_table(study, "success_rate", tallies, dims)
    ends = [Counter(row.outcome for row in tally.rows) for each in tallies for tally in each]
    occurred = [each for each in (*map(str, Outcome), *NO_RESULT) if any(end[each] for end in ends)]
    shape, dimensions = table["rate"].shape, table["rate"].dims
    return table.assign(
        {
            f"ended_{name}": (
                dimensions,
                np.array([end[name] for end in ends]).reshape(shape),
                {"units": "1", "long_name": name.replace("_", " ")},
            )
            for name in occurred
        }
    )
