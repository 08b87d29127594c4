"""Where a rate passes one half: the boundary along one field of the scenario."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import TYPE_CHECKING, Any, Unpack

import numpy as np

from crawler2d.common.arrays import real_number, whole_number
from crawler2d.errors import ScenarioError
from crawler2d.parameters.paths import is_whole, read_path
from crawler2d.parameters.scenario import Scenario
from crawler2d.studies.campaign import Campaign, Cell, How, Tally, campaign
from crawler2d.studies.models import Models, read_models
from crawler2d.studies.tables import found_of
from crawler2d.sweeps.axes import field_attributes

if TYPE_CHECKING:
    from crawler2d.sweeps.found import Found

__all__ = ["critical"]


def critical(
    scenario: Scenario,
    path: str,
    between: tuple[float, float],
    *,
    models: Models | None = None,
    tolerance: float | None = None,
    points: int = 7,
    **how: Unpack[How],
) -> Found:
    """Find where the rate of clearing passes one half along one field, such as a friction.

    Both ends and points evenly between them are tried first, so that a rate that goes up and down
    is seen; then the first place where it passes one half is halved until it is known well enough.

    Parameters
    ----------
    scenario : Scenario
        What all runs share.
    path : str
        Of a number, such as ``terrain.friction``.
    between : tuple of 2 floats
        The ends, in units of the field.
    models : mapping of str to track or fields, optional
        As for `compare`; None takes the scenario's own robot.
    tolerance : float, optional
        Largest width of the bracket, above 0; None takes a hundredth of the whole.
    points : int
        How many values are tried first, 2 to 1000.
    **how
        See `crawler2d.studies`.

    Returns
    -------
    Found
        Dimensions `model`, the values that were tried for any model (`count` is 0 where a model was
        not), `sample` if there are unknowns, and `repeat`; the columns of `sweep`, `rate` and its
        interval; and for each model (and sample):

        - `bracket_low`, `bracket_high`: the rate passes one half between them; nan if nowhere;
        - `rises`: whether it rises there;
        - `monotone`: whether it passes one half no more than once among all values tried.

    Raises
    ------
    ScenarioError
        If the path is no number of the scenario, or an argument breaks a rule.

    Examples
    --------
    A slope is climbed where the friction exceeds its tangent:

    >>> import math
    >>> import crawler2d as c2d
    >>> slope = c2d.terrains.ramp(math.atan(0.5))
    >>> base = c2d.Scenario(c2d.robots.engineer(flippers=None), slope)
    >>> found = c2d.studies.critical(
    ...     base, "terrain.friction", (0.3, 0.8), points=3, progress=False
    ... )
    >>> abs(found["bracket_low"].item() - 0.5) < 0.02, found["monotone"].item()
    (True, True)
    """
    low, high = (real_number(each, f"between[{k}]") for k, each in enumerate(_pair(between)))
    if not low < high:
        raise ScenarioError("between", (low, high), "must be two numbers, the smaller first")
    width = (high - low) / 100.0 if tolerance is None else real_number(tolerance, "tolerance")
    if not width > 0.0:
        raise ScenarioError("tolerance", width, "must be above 0")
    count = whole_number(points, "points", 2, 1000)
    if type(read_path(scenario, path)) not in (int, float) or is_whole(scenario, path):
        rule = "must be the path of a number that is no whole number"
        raise ScenarioError("path", path, rule)
    fields = read_models(scenario, models)
    name = path.rpartition(".")[2].replace("[", "_").replace("]", "")
    swept = [path, *dict.fromkeys(key for each in fields.values() for key in each)]
    with campaign(scenario, how, swept, threshold=0.5) as study:
        tried: dict[Any, dict[float, list[Tally]]] = {}
        for label, own in fields.items():
            base = scenario.replace(own)
            line = _Line(study, base, path, (f"model={label}", name))
            line.add(np.linspace(low, high, count).tolist())
            line.narrow(width)
            tried[label] = line.tallies
        values = sorted({value for tallies in tried.values() for value in tallies})
        samples = len(next(iter(next(iter(tried.values())).values())))
        empty = _empty(tried)
        tallies = [
            tried[label].get(value, [empty] * samples) for label in fields for value in values
        ]
        dims = {"model": (list(fields), {}), name: (values, field_attributes([path]))}
        found = found_of(study, "critical", tallies, dims)
    return _with_brackets(found, tried, samples)


class _Line:
    """The values that were tried of one model."""

    def __init__(self, study: Campaign, base: Scenario, path: str, names: tuple[str, str]) -> None:
        self.tallies: dict[float, list[Tally]] = {}
        self._study, self._base, self._path, self._names = study, base, path, names

    def add(self, values: Sequence[float]) -> None:
        """Try values that have not been tried."""
        new = [value for value in values if value not in self.tallies]
        model, name = self._names
        cells = [
            Cell((model, f"{name}={value:g}"), self._base.replace({self._path: value}))
            for value in new
        ]
        self.tallies |= dict(zip(new, self._study.repeat(cells), strict=True))

    def narrow(self, width: float) -> None:
        """Halve the first bracket of every sample until it is no wider than this."""
        samples = len(next(iter(self.tallies.values())))
        while True:
            found = [bracket(self.tallies, sample) for sample in range(samples)]
            wide = {0.5 * (a + b) for a, b in found if b - a > width}
            if not wide:
                return
            self.add(sorted(wide))


def bracket(tallies: dict[float, list[Tally]], sample: int) -> tuple[float, float]:
    """Return the first two neighbours between which the rate passes one half; nan if nowhere."""
    ways = _ways(tallies, sample)
    for (low, before), (high, after) in pairwise(ways):
        if before != after:
            return low, high
    return math.nan, math.nan


def _ways(tallies: dict[float, list[Tally]], sample: int) -> list[tuple[float, bool]]:
    return [(value, tallies[value][sample].interval.rate >= 0.5) for value in sorted(tallies)]


def _empty(tried: dict[Any, dict[float, list[Tally]]]) -> Tally:
    """Make the tally of a value that a model was not tried at."""
    some = next(iter(next(iter(tried.values())).values()))[0]
    return Tally(some.world, some.until, some.counts)


def _with_brackets(found: Found, tried: dict[Any, dict[float, list[Tally]]], samples: int) -> Found:
    columns: dict[str, list[list[float | bool]]] = {
        name: [] for name in ("bracket_low", "bracket_high", "rises", "monotone")
    }
    for tallies in tried.values():
        rows = []
        for sample in range(samples):
            ways = [way for _, way in _ways(tallies, sample)]
            changes = sum(one != other for one, other in pairwise(ways))
            low, high = bracket(tallies, sample)
            rises = changes > 0 and not ways[0]
            rows.append((low, high, rises, changes <= 1))
        for column, values in zip(columns.values(), zip(*rows, strict=True), strict=True):
            column.append(list(values))
    dims = ("model", "sample") if "sample" in found["rate"].dims else ("model",)
    spoken = {
        "bracket_low": "the rate passes one half above this",
        "bracket_high": "the rate passes one half below this",
        "rises": "the rate rises there",
        "monotone": "the rate passes one half no more than once",
    }
    arrays = {name: np.array(values) for name, values in columns.items()}
    shaped = {name: a if len(dims) == 2 else a[:, 0] for name, a in arrays.items()}
    return found.assign({n: (dims, a, {"long_name": spoken[n]}) for n, a in shaped.items()})


def _pair(between: object) -> tuple[object, object]:
    if isinstance(between, (tuple, list)) and len(between) == 2:
        return between[0], between[1]
    raise ScenarioError("between", between, "must be two numbers, the smaller first")
