"""Find where a rate crosses one half along a field or the range of an unknown."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import pairwise
from typing import TYPE_CHECKING, Any, NamedTuple, Unpack

import numpy as np

from crawler2d.common.arrays import read_range, real_number, whole_number
from crawler2d.common.keywords import takes_keywords
from crawler2d.errors import ScenarioError, raise_first
from crawler2d.parameters.fields import is_whole, read_number_path, read_path
from crawler2d.parameters.scenario import Scenario
from crawler2d.studies.campaign import (
    Campaign,
    Cell,
    Counts,
    RateSampling,
    Tally,
    campaign,
    is_cleared,
)
from crawler2d.studies.tables import Models, check_study, paths_of, rate_table, read_models
from crawler2d.sweeps.axes import field_attributes, short_names
from crawler2d.variation.draws import Variation

if TYPE_CHECKING:
    from crawler2d.sweeps.figure_dataset import FigureDataset

__all__ = [
    "LONG_NAMES",
    "POINTS",
    "Crossing",
    "Line",
    "Range",
    "check_ends",
    "critical_value",
    "line_over",
    "range_of",
]

POINTS = 7
"""Number of initial values."""

LONG_NAMES = {
    "bracket_low": "the rate passes one half above this",
    "bracket_high": "the rate passes one half below this",
    "rises": "the rate rises there",
    "monotone": "the rate passes one half no more than once",
}
"""Long names of the columns of a `Crossing`."""


@takes_keywords
def critical_value(
    scenario: Scenario,
    path: str,
    between: tuple[float, float],
    *,
    models: Models | None = None,
    tolerance: float | None = None,
    points: int = POINTS,
    **sampling: Unpack[RateSampling],
) -> FigureDataset:
    """Find where the rate of clearing crosses one half along one field, such as friction.

    Tries evenly spaced values with both ends first, to detect a rate that is not monotone; then
    halves the first interval that contains a crossing until it is narrow enough.

    Parameters
    ----------
    scenario : Scenario
        The scenario that all runs share.
    path : str
        Path of a number, such as ``terrain.friction``.
    between : tuple of 2 floats
        The ends, in units of the field.
    models : mapping of str to track or fields, optional
        See `compare`; None takes the scenario's own robot.
    tolerance : float, optional
        Largest width of the bracket, above 0; None takes a hundredth of the range.
    points : int
        Number of initial values, 2 to 1000.
    **sampling
        See `crawler2d.studies`.

    Returns
    -------
    FigureDataset
        Dimensions `model`, the values tried for any model (`count` is 0 for the others), `sample`
        if there are unknowns, and `repeat`; the columns of `sweep`, `rate` and its interval; and
        for each model (and sample):

        - `bracket_low`, `bracket_high`: the rate crosses one half between them; NaN if nowhere;
        - `rises`: whether it rises there;
        - `monotone`: whether it crosses one half at most once among all values tried.

    Raises
    ------
    ScenarioError
        If the path is not a number of the scenario, or an argument breaks a rule.

    Examples
    --------
    A robot climbs a slope if the friction exceeds its tangent:

    >>> import math
    >>> import crawler2d as c2d
    >>> slope = c2d.terrains.ramp(math.atan(0.5))
    >>> base = c2d.Scenario(c2d.robots.engineer(flippers=None), slope)
    >>> found = c2d.studies.critical_value(
    ...     base, "terrain.friction", (0.3, 0.8), points=3, progress=False
    ... )
    >>> abs(found["bracket_low"].item() - 0.5) < 0.02, found["monotone"].item()
    (True, True)
    """
    check_study(scenario)
    low, high = read_range(between, "between")
    width = (high - low) / 100.0 if tolerance is None else real_number(tolerance, "tolerance")
    if not width > 0.0:
        raise ScenarioError("tolerance", width, "must be > 0")
    count = whole_number(points, "points", 2, 1000)
    read_number_path(scenario, path, "path")
    fields = read_models(scenario, models, [path])
    name = short_names([path])[path]
    with campaign(scenario, sampling, [path, *paths_of(fields)], threshold=0.5) as study:
        lines: list[Line] = []
        for label, own in fields.items():
            at, names = partial(_with_value, scenario.replace(own), path), (f"model={label}", name)
            check_ends(study, at, (low, high), names)
            lines.append(Line(study, names, at))
        for line in lines:
            line.add(np.linspace(low, high, count).tolist())
            line.narrow(width)
        values = sorted({value for line in lines for value in line.tallies})
        samples = lines[0].samples
        # Not every value is tried of every model.
        some = lines[0].tallies[values[0]][0]
        none = replace(some.world, own={}, sampled={})
        empty = [Tally(none, some.until, some.counts)] * samples
        tallies = [line.tallies.get(value, empty) for line in lines for value in values]
        dims = {"model": (list(fields), {}), name: (values, field_attributes([path]))}
        table = rate_table(study, "critical_value", tallies, dims)
    return _with_crossings(table, lines)


class Crossing(NamedTuple):
    """The first crossing of one half among the values tried.

    Attributes
    ----------
    bracket_low, bracket_high : float
        The two neighbours on either side; NaN if there is no crossing.
    rises : bool
        Whether it rises there.
    monotone : bool
        Whether the rate crosses one half at most once.
    """

    bracket_low: float = math.nan
    bracket_high: float = math.nan
    rises: bool = False
    monotone: bool = True


class Line:
    """The values of a field tried with one model.

    Parameters
    ----------
    study : Campaign
        The campaign that simulates.
    names : pair of str
        Model and field, for messages.
    at : callable
        Returns the scenario at a value.
    counts : callable
        Tells which runs are successes.

    Attributes
    ----------
    tallies : dict of float to list of Tally
        Tallies by value and sample.
    """

    def __init__(
        self,
        study: Campaign,
        names: tuple[str, str],
        at: Callable[[float], Scenario],
        counts: Counts = is_cleared,
    ) -> None:
        self.tallies: dict[float, list[Tally]] = {}
        self._study, self._names, self._at, self._counts = study, names, at, counts

    @property
    def samples(self) -> int:
        """Number of samples of the unknowns at every value."""
        return len(next(iter(self.tallies.values())))

    def add(self, values: Sequence[float]) -> None:
        """Try new values."""
        new = [value for value in values if value not in self.tallies]
        model, name = self._names
        cells = [Cell((model, f"{name}={value:g}"), self._at(value)) for value in new]
        self.tallies |= dict(zip(new, self._study.repeat(cells, self._counts), strict=True))

    def narrow(self, width: float) -> None:
        """Halve the first bracket of every sample until it is no wider than this."""
        while True:
            crossings = [self.crossing(sample) for sample in range(self.samples)]
            wide = {
                0.5 * (each.bracket_low + each.bracket_high)
                for each in crossings
                if each.bracket_high - each.bracket_low > width
            }
            if wide <= self.tallies.keys():  # no float is between, or it has no result
                return
            self.add(sorted(wide))

    def rates(self, sample: int = 0) -> dict[float, float]:
        """Return the rate at each value, in order."""
        return {value: self.tallies[value][sample].interval.rate for value in sorted(self.tallies)}

    def crossing(self, sample: int = 0) -> Crossing:
        """Find where the rate crosses one half; skip values without a result."""
        rates = self.rates(sample).items()
        above = [(value, rate >= 0.5) for value, rate in rates if not math.isnan(rate)]
        changes = [
            (low, high, rises) for (low, was), (high, rises) in pairwise(above) if was != rises
        ]
        return Crossing(*changes[0], monotone=len(changes) == 1) if changes else Crossing()


def _with_value(base: Scenario, path: str, value: float) -> Scenario:
    return base.replace({path: value})


def _with_crossings(table: FigureDataset, lines: Sequence[Line]) -> FigureDataset:
    crossings = [[line.crossing(sample) for sample in range(line.samples)] for line in lines]
    dims = ("model", "sample") if "sample" in table["rate"].dims else ("model",)
    shape = [table.sizes[dim] for dim in dims]
    columns: Mapping[str, Any] = {
        name: np.array([[getattr(each, name) for each in row] for row in crossings])
        for name in Crossing._fields
    }
    return table.assign(
        {
            name: (dims, values.reshape(shape), {"long_name": LONG_NAMES[name]})
            for name, values in columns.items()
        }
    )


_TAIL = 0.01
"""[-] Tail of an unbounded distribution that is excluded from its range at each end."""

_NARROW = 0.01
"""[-] Width of a bracket, as a fraction of the range."""


@dataclass(frozen=True, slots=True)
class Range:
    """The range of one unknown.

    Attributes
    ----------
    cell : Scenario
        The scenario with its own values.
    ends : mapping of str to pair of float
        Ends of the range, by path of a field.
    """

    cell: Scenario
    ends: Mapping[str, tuple[float, float]]

    @property
    def own(self) -> float:
        """The scenario's own value of the first field."""
        return float(read_path(self.cell, next(iter(self.ends))))

    @property
    def first(self) -> tuple[float, float]:
        """The ends of the first field; the others move in proportion."""
        return next(iter(self.ends.values()))

    @property
    def is_line(self) -> bool:
        """Whether a boundary can exist: not for whole numbers or a single value."""
        low, high = self.first
        return low < high and not any(is_whole(self.cell, field) for field in self.ends)

    def at(self, value: float) -> Scenario:
        """Return the scenario with this value of the first field."""
        low, high = self.first
        fraction = (value - low) / (high - low)
        moved = {
            field: value if ends == self.first else ends[0] + fraction * (ends[1] - ends[0])
            for field, ends in self.ends.items()
        }
        return self.cell.replace(moved)


def range_of(unknowns: Variation, path: str, cell: Scenario) -> Range:
    """Take the ends of a distribution, with the first field ascending.

    Parameters
    ----------
    unknowns : Variation
        The unknowns.
    path : str
        Path of one of them.
    cell : Scenario
        Scenario with the nominal values.

    Examples
    --------
    >>> import crawler2d as c2d
    >>> base = c2d.Scenario(c2d.robots.engineer(flippers=None), c2d.terrains.step(0.05))
    >>> unknowns = Variation.read(base, {"robot.mass": c2d.scaled(0.5, 2.0)}, [])
    >>> range_of(unknowns, "robot.mass", base).first
    (10.6, 42.4)
    """
    alone = replace(unknowns, distributions={path: unknowns.distributions[path]})
    drawn = alone.draw(cell, {path: np.array([0.0, 1.0])})
    if not all(np.isfinite(values).all() for values in drawn.values.values()):
        drawn = alone.draw(cell, {path: np.array([_TAIL, 1.0 - _TAIL])})
    low, high = drawn.shown[path]
    order = (0, 1) if low <= high else (1, 0)
    ends = {f: (float(v[order[0]]), float(v[order[1]])) for f, v in drawn.values.items()}
    return Range(cell, ends)


def check_ends(
    study: Campaign,
    at: Callable[[float], Scenario],
    ends: tuple[float, float],
    names: tuple[str, str],
) -> None:
    """Refuse an end of a line that breaks a rule, before any run."""
    model, name = names
    for value in ends:
        worlds = study.planner.worlds(at(value), (model, f"{name}={value:g}"))
        raise_first(world.checked for world in worlds)


def line_over(study: Campaign, over: Range, names: tuple[str, str], counts: Counts) -> Line | None:
    """Find where the rate crosses one half over a range; None if it is not continuous."""
    if not over.is_line:
        return None
    low, high = over.first
    line = Line(study, names, over.at, counts)
    line.add(np.linspace(low, high, POINTS).tolist())
    line.narrow(_NARROW * (high - low))
    return line
