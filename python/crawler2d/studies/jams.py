"""Heights and frictions at which a model can jam at all: computed, not sampled."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from crawler2d import _core
from crawler2d.common.arrays import real_number
from crawler2d.common.keywords import takes_keywords
from crawler2d.errors import ScenarioError
from crawler2d.parameters.fields import read_number_path
from crawler2d.parameters.scenario import Scenario
from crawler2d.runs.jams import on_belt
from crawler2d.studies.tables import Models, check_study, read_models, read_numbers
from crawler2d.sweeps.axes import field_attributes, short_names

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from crawler2d.sweeps.figure_dataset import FigureDataset

__all__ = ["jam_chart"]

_MOST = 1.5
"""[-] Default largest friction."""

_HEIGHTS = 200
"""Default number of heights."""

_INSIDE = 1e-6
"""[m] Shallower ground does not count as inside the track."""

_TEXTS = {
    "low": ("friction from which on it can jam", "1"),
    "high": ("friction up to which it can jam", "1"),
    "rear": ("body behind the ground inside the track, -1 if there is none", "1"),
    "front": ("body ahead of the ground inside the track, -1 if there is none", "1"),
    "depth": ("depth of the ground inside the track", "m"),
    "position": ("x of the chassis", "m"),
    "angle": ("angle of the chassis", "rad"),
    "belt_low": ("friction from which on a belt can jam", "1"),
    "belt_high": ("friction up to which a belt can jam", "1"),
}


@takes_keywords
def jam_chart(
    scenario: Scenario,
    *,
    models: Models | None = None,
    x: str = "terrain.height",
    values: Sequence[float] | None = None,
    most_friction: float = _MOST,
) -> FigureDataset:
    """Chart the heights and frictions at which each model can jam, and between which wheels.

    A pose on three contacts depends only on the geometry. The frictions at which forces carry the
    robot in it are intervals whose ends are zeros of polynomials, so the borders of a region are
    exact curves, computed at each height.

    Poses on one or two contacts, in which a robot leans or balances, are not included, and motors
    have no limits: see `crawler2d.jams`. A possible jam is not necessarily reached in a run.

    Parameters
    ----------
    scenario : Scenario
        Robot and ground; its friction is ignored.
    models : mapping of str to track or fields, optional
        See `compare`; None takes the scenario's own robot. Tracks of round wheels, or belts.
    x : str
        Path of the number along the first axis.
    values : sequence of float, optional
        Its values; None takes 200 heights up to twice the front radius.
    most_friction : float
        [-] Largest friction, above 0.

    Returns
    -------
    FigureDataset
        Dimensions `model`, the values of `x`, and `jam`, filled up with NaN, as the number of jams
        differs:

        - `low`, `high`: the range of friction of the jam;
        - `rear`, `front`: bodies on either side of the ground inside the track, -1 without any;
        - `depth` [m] of that ground; `position` [m] and `angle` [rad] of the chassis;
        - `belt_low`, `belt_high`, along `belt_jam`: the same for a belt round the model's bodies.

    Raises
    ------
    ScenarioError
        If `x` is not a number of the scenario, an argument breaks a rule, or a track model is not
        supported.

    Examples
    --------
    A step of 100 mm can jam four touching wheels up to a friction of 1.28, but a belt only up to
    0.75:

    >>> import crawler2d as c2d
    >>> robot = c2d.robots.engineer(flippers=None, track=c2d.LineOfWheels(4, wheel_radius=0.0608))
    >>> base = c2d.Scenario(robot, c2d.terrains.step(0.1))
    >>> chart = c2d.studies.jam_chart(base, values=[0.1])
    >>> between = (chart["rear"] == 1) & (chart["front"] == 2)
    >>> round(chart["high"].where(between).max().item(), 2)
    1.28
    >>> round(chart["belt_high"].max().item(), 2)
    0.75
    """
    check_study(scenario)
    read_number_path(scenario, x, "x")
    most = real_number(most_friction, "most_friction")
    if not 0.0 < most <= 100.0:
        raise ScenarioError("most_friction", most, "must be > 0 and <= 100")
    along = _values(scenario, x, values)
    labels = read_models(scenario, models, [x])
    own, belts = [], []
    for fields in labels.values():
        model = scenario.replace(fields)
        cells = [model.replace({x: value}) for value in along]
        own.append(_ranges(cells, most))
        on_belts = [on_belt(cell) for cell in cells]
        belts.append(own[-1] if on_belts == cells else _ranges(on_belts, most))
    return _dataset(list(labels), x, along, own, belts)


def _values(scenario: Scenario, x: str, values: Sequence[float] | None) -> list[float]:
    if values is None:
        if not x.endswith("height"):
            raise ScenarioError("values", values, f"must be given for {x}")
        most = 2.0 * scenario.robot.outline.front_radius
        return [most * (k + 1) / _HEIGHTS for k in range(_HEIGHTS)]
    given = read_numbers(values, "values")
    if sorted(set(given)) != given:
        raise ScenarioError("values", tuple(given), "must be one number or more, rising")
    return given


def _ranges(cells: Sequence[Scenario], most: float) -> list[dict[str, Any]]:
    """Compute the jams of each scenario at any friction: columns named as in the chart."""
    found: list[dict[str, Any]] = _core.jam_ranges([cell.to_json() for cell in cells], most)
    for cell in found:
        inside = zip(cell["between"], cell["depth"], strict=True)
        pairs = [sorted(two) if two and depth > _INSIDE else [-1, -1] for two, depth in inside]
        cell["rear"], cell["front"] = ([pair[end] for pair in pairs] for end in (0, 1))
        cell["position"] = cell["x"]
    return found


def _dataset(
    labels: Sequence[Any],
    x: str,
    along: Sequence[float],
    own: Sequence[Sequence[dict[str, Any]]],
    belts: Sequence[Sequence[dict[str, Any]]],
) -> FigureDataset:
    from crawler2d.sweeps.figure_dataset import FigureDataset  # noqa: PLC0415 - needs xarray

    name = short_names([x, *_TEXTS])[x]
    variables: dict[str, Any] = {}
    for column, (long_name, units) in _TEXTS.items():
        is_belt = column.startswith("belt_")
        dims = ("model", name, "belt_jam" if is_belt else "jam")
        array = _padded(belts if is_belt else own, column.removeprefix("belt_"))
        variables[column] = (dims, array, {"long_name": long_name, "units": units})
    coordinates = {
        "model": ("model", list(labels)),
        name: (name, list(along), field_attributes([x])),
    }
    return FigureDataset(variables, coordinates, {"figure": "jam_chart", "x": name})


def _padded(models: Sequence[Sequence[dict[str, Any]]], column: str) -> NDArray[np.float64]:
    """Stack a column of every cell, shape (models, values, jams), padded with NaN."""
    rows = [[np.asarray(cell[column], float) for cell in cells] for cells in models]
    most = max(len(row) for cells in rows for row in cells)
    padded = [
        [np.concatenate([row, np.full(most - len(row), np.nan)]) for row in cells] for cells in rows
    ]
    return np.array(padded)
