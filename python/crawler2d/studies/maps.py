"""Maps of outcomes over two fields: a grid, refined where outcomes change."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Unpack

import numpy as np

from crawler2d.common.arrays import whole_number
from crawler2d.common.keywords import takes_keywords
from crawler2d.errors import ScenarioError
from crawler2d.parameters.fields import read_number_path
from crawler2d.parameters.scenario import Scenario
from crawler2d.results.outcome import rate_label
from crawler2d.studies.campaign import (
    Cell,
    Counts,
    RateSampling,
    Tally,
    campaign,
    counting,
    is_cleared,
)
from crawler2d.studies.tables import (
    Models,
    check_study,
    paths_of,
    rate_table,
    read_models,
    read_numbers,
)
from crawler2d.sweeps.axes import field_attributes, short_names
from crawler2d.sweeps.rates import BAND

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from crawler2d.sweeps.figure_dataset import FigureDataset

__all__ = ["Grid", "seizure_map"]

_AROUND = [(j, i) for j in (-1, 0, 1) for i in (-1, 0, 1) if (j, i) != (0, 0)]
"""Offsets to the neighbours of a cell."""


class Grid:
    """Cells by model, y and x; some of them are simulated.

    Parameters
    ----------
    shape : tuple of 3 ints
        Shape of the finest grid.
    simulate : callable
        Takes the indices of cells, returns the tallies of each by sample.
    classify : callable
        Takes the tallies of a cell, returns its rate, the number of its kind (0 if neighbours must
        not copy it), and whether the kind is certain.

    Attributes
    ----------
    rates, kinds, certain : ndarray, shape (models, y, x)
        [-] Results of `classify`. Cells that are not simulated take them from their neighbours, and
        are certain if all of these are; NaN where nothing is known yet.
    """

    def __init__(
        self,
        shape: tuple[int, int, int],
        simulate: Callable[[Sequence[tuple[int, ...]]], list[list[Tally]]],
        classify: Callable[[Sequence[Tally]], tuple[float, int, bool]],
    ) -> None:
        self.rates, self.kinds, self.certain = (np.full(shape, np.nan) for _ in range(3))
        self._tallies: dict[tuple[int, ...], list[Tally]] = {}
        self._simulate, self._classify = simulate, classify

    def refine(self, stride: int, *, whole: bool) -> None:
        """Simulate every `stride`-th cell: all, or those that neighbours do not decide."""
        part = np.s_[:, ::stride, ::stride]
        if whole:
            self._add(np.ones(self.kinds[part].shape, bool), stride)
            return
        # Cells not simulated before stay open, as they may get neighbours of another kind.
        while (due := self._open(stride) & ~self._agrees(stride)).any():
            self._add(due, stride)
        fill = np.isnan(self.kinds[part])
        around = _neighbours(self.rates[part])
        known = np.isfinite(around)
        mean = np.where(known, around, 0.0).sum(axis=0) / np.maximum(known.sum(axis=0), 1)
        self.rates[part][fill] = mean[fill]
        self.kinds[part][fill] = np.fmax.reduce(_neighbours(self.kinds[part]))[fill]
        self.certain[part][fill] = np.fmin.reduce(_neighbours(self.certain[part]))[fill]

    @property
    def tried(self) -> NDArray[np.bool_]:
        """Mask of the simulated cells, shape (models, y, x)."""
        tried = np.zeros(self.kinds.shape, bool)
        tried[tuple(np.array(list(self._tallies)).T)] = True
        return tried

    @property
    def tallies(self) -> list[list[Tally]]:
        """Tallies of all cells by sample; empty for cells that are not simulated."""
        some = next(iter(self._tallies.values()))
        none = [Tally(replace(t.world, own={}, sampled={}), t.until, t.counts) for t in some]
        return [self._tallies.get(place, none) for place in np.ndindex(self.kinds.shape)]

    def _open(self, stride: int) -> NDArray[np.bool_]:
        return ~self.tried[:, ::stride, ::stride]

    def _agrees(self, stride: int) -> NDArray[np.bool_]:
        """Whether a cell and its known neighbours are all of one certain kind."""
        own = self.kinds[:, ::stride, ::stride]
        around = np.concatenate([_neighbours(own), own[None]])
        low, high = np.fmin.reduce(around), np.fmax.reduce(around)
        agree: NDArray[np.bool_] = (low == high) & (low != 0.0)
        return agree

    def _add(self, due: NDArray[np.bool_], stride: int) -> None:
        places = [(m, stride * j, stride * i) for m, j, i in np.argwhere(due).tolist()]
        for place, tallies in zip(places, self._simulate(places), strict=True):
            self._tallies[place] = tallies
            self.rates[place], self.kinds[place], self.certain[place] = self._classify(tallies)


def _neighbours(grid: NDArray[np.float64]) -> NDArray[np.float64]:
    """Stack the values of the eight neighbours of every cell; NaN outside the grid."""
    _, rows, columns = grid.shape
    padded = np.pad(grid, ((0, 0), (1, 1), (1, 1)), constant_values=np.nan)
    return np.stack([padded[:, 1 + j : 1 + j + rows, 1 + i : 1 + i + columns] for j, i in _AROUND])


@takes_keywords
def seizure_map(
    scenario: Scenario,
    x: tuple[str, Sequence[float]],
    y: tuple[str, Sequence[float]],
    *,
    outcome: str = "seized",
    models: Models | None = None,
    refine: int = 1,
    **sampling: Unpack[RateSampling],
) -> FigureDataset:
    """Map outcomes and their rates over two fields, such as height and friction.

    A run clears, has the requested outcome, or ends otherwise. Every cell of the grid is simulated;
    then the grid is halved, and new cells are simulated unless all their neighbours certainly end
    in the same way. With unknowns only the commonest ends are compared, as more cells cannot narrow
    a band over the samples.

    Parameters
    ----------
    scenario : Scenario
        The scenario that all runs share.
    x, y : pair of str and sequence of float
        Path of a number and at least two ascending values, in units of the field.
    outcome : str
        Name of an `Outcome`, or "stopped" for any stop.
    models : mapping of str to track or fields, optional
        See `compare`; None takes the scenario's own robot.
    refine : int
        Number of times that the grid is halved, 0 to 6.
    **sampling
        See `crawler2d.studies`. Each cell is simulated until the rate of its commonest end is known
        to be above or below one half, or within 0.2, unless `until` says otherwise.

    Returns
    -------
    FigureDataset
        Dimensions `model`, y, x (by the last part of their paths), `sample` if there are unknowns,
        and `repeat`; the columns of `sweep`, `rate` of the outcome and its interval; and for each
        cell:

        - `ending`: the commonest end: "cleared", the outcome, or "otherwise"; for cells that were
          not simulated (`count` is 0), that of their neighbours;
        - `unsure`: whether it is uncertain that more than half of the runs end like this: the
          interval of their rate, or with unknowns the band over the samples, starts at one half or
          below; for cells that were not simulated, whether a neighbour is unsure;
        - `around`: for cells that were not simulated, the mean rate of their neighbours, else NaN.

        With unknowns, the commonest end is the one with the largest median over the samples. `plot`
        draws one model: ``found.sel(model="belt").plot()``.

    Raises
    ------
    ScenarioError
        If a path is not a number of the scenario, or an argument breaks a rule.

    Examples
    --------
    A belt slips on a slope with a tangent larger than the friction:

    >>> import crawler2d as c2d
    >>> base = c2d.Scenario(c2d.robots.engineer(flippers=None), c2d.terrains.ramp(0.3))
    >>> found = c2d.studies.seizure_map(
    ...     base,
    ...     ("terrain.friction", [0.2, 0.6]),
    ...     ("terrain.angle", [0.3, 0.5]),
    ...     outcome="slipping",
    ...     refine=0,
    ...     progress=False,
    ... )
    >>> found["rate"].sel(angle=0.5).values.tolist()
    [[1.0, 0.0]]
    >>> found["ending"].sel(angle=0.5).values.tolist()
    [['slipping', 'cleared']]
    """
    check_study(scenario)
    counts, ends = counting(outcome), _ends(outcome)
    halvings = whole_number(refine, "refine", 0, 6)
    (path_x, coarse_x), (path_y, coarse_y) = _axis(scenario, x, "x"), _axis(scenario, y, "y")
    if path_x == path_y:
        raise ScenarioError("y", path_y, "must differ from x")
    names = short_names([path_x, path_y])
    fields = read_models(scenario, models, [path_x, path_y])
    swept = [path_x, path_y, *paths_of(fields)]
    values_x, values_y = _halved(coarse_x, halvings), _halved(coarse_y, halvings)
    with campaign(scenario, sampling, swept, threshold=0.5) as study:
        bases = {label: scenario.replace(own) for label, own in fields.items()}

        def simulate(places: Sequence[tuple[int, ...]]) -> list[list[Tally]]:
            cells = []
            for model, j, i in places:
                label, at = list(bases)[model], {path_x: values_x[i], path_y: values_y[j]}
                text = [f"{names[path]}={value:g}" for path, value in at.items()]
                cells.append(Cell((f"model={label}", *text), bases[label].replace(at)))
            return study.repeat(cells, counts, others=list(ends.values()))

        def classify(tallies: Sequence[Tally]) -> tuple[float, int, bool]:
            number, certain = _commonest(tallies, list(ends.values()))
            rates = [tally.interval.rate for tally in tallies if tally.valid]
            rate = float(np.median(rates)) if rates else math.nan
            return rate, number + 1 if certain or len(tallies) > 1 else 0, certain

        grid = Grid((len(fields), len(values_y), len(values_x)), simulate, classify)
        for level in range(halvings + 1):
            grid.refine(2 ** (halvings - level), whole=level == 0)
        dims: dict[str, Any] = {
            "model": (list(fields), {}),
            names[path_y]: (values_y, field_attributes([path_y])),
            names[path_x]: (values_x, field_attributes([path_x])),
        }
        table = rate_table(study, "seizure_map", grid.tallies, dims)
    table["rate"].attrs["long_name"] = rate_label(outcome)
    return _with_ends(table, grid, tuple(dims), ends).assign_attrs(outcome=outcome)


def _ends(outcome: str) -> dict[str, Counts]:
    """Return the distinguished ends, by name."""
    named = {"cleared": is_cleared, outcome: counting(outcome)}
    return {**named, "otherwise": lambda row: not any(each(row) for each in named.values())}


def _commonest(tallies: Sequence[Tally], ends: Sequence[Counts]) -> tuple[int, bool]:
    """Return the commonest end of a cell, and whether most runs certainly end like this."""
    intervals = [[tally.interval_of(each) for tally in tallies] for each in ends]
    rates = [[each.rate for each in own if not math.isnan(each.rate)] for own in intervals]
    if not rates[0]:  # no run has a result
        return len(ends) - 1, False
    number = int(np.argmax([np.median(own) for own in rates]))
    if len(tallies) == 1:
        return number, intervals[number][0].low > 0.5
    return number, bool(np.quantile(rates[number], BAND["band_low"]) > 0.5)


def _with_ends(
    table: FigureDataset, grid: Grid, dims: tuple[str, ...], ends: Mapping[str, Counts]
) -> FigureDataset:
    names, tried = list(ends), grid.tried
    shape = tried.shape
    ending, unsure = np.empty(shape, object), np.zeros(shape, bool)
    for place, tallies in zip(np.ndindex(shape), grid.tallies, strict=True):
        number = int(grid.kinds[place]) - 1
        if tried[place]:
            number, _ = _commonest(tallies, list(ends.values()))
        ending[place], unsure[place] = names[number], not grid.certain[place]
    columns: Mapping[str, Any] = {
        "ending": (dims, ending.astype(str), {"long_name": "commonest end"}),
        "unsure": (dims, unsure, {"long_name": "uncertain that more than half agree"}),
        "around": (
            dims,
            np.where(tried, np.nan, grid.rates),
            {"units": "1", "long_name": "mean rate of the cells around one that was not simulated"},
        ),
    }
    return table.assign(columns)


def _axis(scenario: Scenario, given: object, place: str) -> tuple[str, list[float]]:
    """Read the path and the values of an axis."""
    if not (isinstance(given, (tuple, list)) and len(given) == 2 and isinstance(given[0], str)):
        raise ScenarioError(place, given, "must be a pair of a path and its values")
    path, listed = given
    read_number_path(scenario, path, f"{place}[0]")
    values = read_numbers(listed, f"{place}[1]")
    if len(values) < 2 or not (np.diff(values) > 0.0).all():
        raise ScenarioError(f"{place}[1]", listed, "must be at least two numbers, ascending")
    return path, values


def _halved(values: Sequence[float], times: int) -> list[float]:
    """Insert the midpoints of neighbours, several times."""
    grid = np.array(values)
    for _ in range(times):
        finer = np.empty(2 * grid.size - 1)
        finer[::2], finer[1::2] = grid, 0.5 * (grid[:-1] + grid[1:])
        grid = finer
    numbers: list[float] = grid.tolist()
    return numbers
