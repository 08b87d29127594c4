"""The draws of a sweep's repeats: distributions, and the same random numbers in every cell."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from crawler2d.common.arrays import frozen_scalar, real_number
from crawler2d.errors import ScenarioError
from crawler2d.parameters.paths import is_whole, read_path
from crawler2d.parameters.scenario import Scenario

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = [
    "Distribution",
    "Scaled",
    "Uniform",
    "UniformInt",
    "Variation",
    "scaled",
    "uniform",
    "uniform_int",
]

# A float64 from 0 to 1 can distinguish this many whole numbers.
_MOST = 2**53


@dataclass(frozen=True, slots=True)
class Uniform:
    """Any value from `low` to `high`, all equally likely.

    Parameters
    ----------
    low, high : float
        Bounds, in units of the field.

    Raises
    ------
    ScenarioError
        If they are not finite numbers with ``low <= high``.

    Examples
    --------
    >>> Uniform(0.05, 0.15).value(0.5, nominal=None)
    0.1
    """

    low: float
    high: float

    def __post_init__(self) -> None:
        """Check the bounds."""
        _order(self)

    def value(self, number: float, nominal: object) -> float:  # noqa: ARG002 - replaces it
        """Map a uniform number from 0 to 1 to a value; the field's own value is not used."""
        return _between(self, number)


@dataclass(frozen=True, slots=True)
class UniformInt:
    """Any whole number from `low` to `high`, both included, all equally likely.

    Parameters
    ----------
    low, high : int
        Bounds, for a field of whole numbers such as ``terrain.seed``.

    Raises
    ------
    ScenarioError
        If they are not whole numbers with ``low <= high``, less than 2^53 apart.

    Examples
    --------
    >>> UniformInt(1, 6).value(0.5, nominal=None)
    4
    """

    low: int
    high: int

    def __post_init__(self) -> None:
        """Check the bounds."""
        for name in ("low", "high"):
            number = frozen_scalar(getattr(self, name), whole=True)
            if type(number) is not int:
                raise ScenarioError(name, number, "must be a whole number")
            object.__setattr__(self, name, number)
        _in_order(self)
        if self.high - self.low >= _MOST:
            raise ScenarioError("high", self.high, f"must be < low + 2^53 = {self.low + _MOST}")

    def value(self, number: float, nominal: object) -> int:  # noqa: ARG002 - replaces it
        """Map a uniform number from 0 to 1 to a value; the field's own value is not used."""
        return self.low + int((self.high - self.low + 1) * number)


@dataclass(frozen=True, slots=True)
class Scaled:
    """The scenario's own value times a factor from `low` to `high`, all equally likely.

    Parameters
    ----------
    low, high : float
        [-] Bounds of the factor.

    Raises
    ------
    ScenarioError
        If they are not finite numbers with ``low <= high``.

    Examples
    --------
    >>> Scaled(0.98, 1.02).value(1.0, nominal=0.5)
    0.51
    """

    low: float
    high: float

    def __post_init__(self) -> None:
        """Check the bounds."""
        _order(self)

    def value(self, number: float, nominal: float) -> float:
        """Map a uniform number from 0 to 1 to a value."""
        return nominal * _between(self, number)


Distribution = Uniform | UniformInt | Scaled
"""Any distribution."""

uniform = Uniform
uniform_int = UniformInt
scaled = Scaled


def _order(bounds: Uniform | Scaled) -> None:
    for name in ("low", "high"):
        number = real_number(getattr(bounds, name), name)
        if not math.isfinite(number):
            raise ScenarioError(name, number, "must be finite")
        object.__setattr__(bounds, name, number)
    _in_order(bounds)


def _in_order(bounds: Distribution) -> None:
    if bounds.high < bounds.low:
        raise ScenarioError("high", bounds.high, f"must be >= low = {bounds.low}")


def _between(bounds: Uniform | Scaled, number: float) -> float:
    # Rounding could exceed the upper bound.
    return min(bounds.low + (bounds.high - bounds.low) * number, bounds.high)


def uniform_numbers(path: str, seed: int, repeats: int) -> NDArray[np.float64]:
    """Draw one number from 0 to 1 for each repeat, shape (repeats,).

    The number of a repeat depends only on path, seed and repeat, not on other paths, the cell or
    the number of repeats.
    """
    return np.random.default_rng((seed, *path.encode())).random(repeats)


_APPROACH, _PHASE = "start.approach", "start.track_phase"
_SPEED, _FRICTION = "drive.speed", "terrain.friction"


@dataclass(frozen=True, slots=True)
class Variation:
    """The distributions of a sweep, by path."""

    distributions: Mapping[str, Distribution]
    is_default: bool

    @classmethod
    def of(cls, scenario: Scenario, vary: object, swept: Collection[str]) -> Variation:
        """Read the argument `vary` of `sweep`; `swept` are the paths of its axes.

        Raises
        ------
        ScenarioError
            If it is not a mapping from paths to distributions, or overwrites an axis.
        """
        if vary is None:
            return cls(_default(scenario, swept), is_default=True)
        if not isinstance(vary, Mapping):
            raise ScenarioError("vary", vary, "must be a mapping from paths to distributions")
        for path, distribution in vary.items():
            if not isinstance(path, str):
                raise ScenarioError("vary", path, "must have dotted paths as keys")
            if not isinstance(distribution, Distribution):
                rule = "must be uniform(low, high), uniform_int(low, high) or scaled(low, high)"
                raise ScenarioError(f"vary[{path!r}]", distribution, rule)
            if not isinstance(distribution, Scaled) and path in swept:
                rule = "must not replace the values of `over`; scaled(low, high) varies about them"
                raise ScenarioError(f"vary[{path!r}]", distribution, rule)
        return cls(dict(vary), is_default=False)

    def draw(self, cell: Scenario, numbers: Mapping[str, float]) -> dict[str, float]:
        """Map the uniform numbers of one repeat to the values of a cell, by path.

        Raises
        ------
        ScenarioError
            If the cell lacks a path, or has no number there, or has a whole number to scale.
        """
        values = {}
        for path, distribution in self.distributions.items():
            if self.is_default and path == _FRICTION and not hasattr(cell.terrain, "friction"):
                continue
            nominal = read_path(cell, path)
            if not isinstance(distribution, UniformInt) and is_whole(cell, path):
                rule = "must be drawn with uniform_int(low, high), because it is a whole number"
                raise ScenarioError(path, distribution, rule)
            if isinstance(distribution, Scaled) and type(nominal) not in (int, float):
                raise ScenarioError(path, nominal, "must be a number, because it is to be scaled")
            values[path] = distribution.value(numbers[path], nominal)
        return values


def _default(scenario: Scenario, swept: Collection[str]) -> dict[str, Distribution]:
    outline = scenario.robot.outline
    spacing = 0.25 * outline.axle_distance
    nearest = max(scenario.start.approach - 0.5 * spacing, 0.0)
    start: dict[str, Distribution] = {
        _APPROACH: Uniform(nearest, nearest + spacing),
        _PHASE: Uniform(0.0, outline.grouser_pitch),
    }
    kept = {path: d for path, d in start.items() if path not in swept and "start" not in swept}
    return {**kept, _SPEED: Scaled(0.98, 1.02), _FRICTION: Scaled(0.98, 1.02)}
