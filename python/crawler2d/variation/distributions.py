"""Distributions of one number, and ranges of fields by path with their sources."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from crawler2d.common.arrays import read_scalar, real_number
from crawler2d.common.keywords import TakesKeywords
from crawler2d.errors import ScenarioError
from crawler2d.parameters.fields import read_path

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from crawler2d.parameters.scenario import Scenario

__all__ = [
    "Distribution",
    "Levels",
    "LogUniform",
    "Ranges",
    "Scaled",
    "Shifted",
    "Uniform",
    "UniformInt",
    "read_distribution",
    "scaled",
    "shifted",
    "uniform",
    "uniform_int",
]

# A float64 from 0 to 1 distinguishes this many whole numbers.
_MOST = 2**53


class Distribution(ABC):
    """Values of a field as a function of a number from 0 to 1."""

    __slots__ = ()

    @property
    def is_whole(self) -> bool:
        """Whether all values are whole numbers."""
        return False

    @property
    def is_relative(self) -> bool:
        """Whether values vary around the field's own value instead of replacing it."""
        return False

    @abstractmethod
    def values(self, numbers: NDArray[np.float64], own: Any) -> NDArray[np.float64]:
        """Map numbers from 0 to 1 to values of a field; `own` is its value in the scenario."""

    def resolve(self, scenario: Scenario) -> Distribution:  # noqa: ARG002 - others use it
        """Convert multiples of a length of the scenario to metres."""
        return self


@dataclass(frozen=True, slots=True)
class _Bounded(TakesKeywords, Distribution):
    """Base of distributions with finite, ordered bounds."""

    low: float
    high: float

    def __post_init__(self) -> None:
        """Check the bounds."""
        for name in ("low", "high"):
            number = real_number(getattr(self, name), name)
            if not math.isfinite(number):
                raise ScenarioError(name, number, "must be finite")
            object.__setattr__(self, name, number)
        _check_order(self)


@dataclass(frozen=True, slots=True)
class Uniform(_Bounded):
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
    >>> Uniform(0.05, 0.15).values(np.array([0.0, 0.5]), own=None).tolist()
    [0.05, 0.1]
    """

    def values(self, numbers: NDArray[np.float64], own: Any) -> NDArray[np.float64]:  # noqa: ARG002
        """Map numbers from 0 to 1 to values; the field's own value is not used."""
        return _between(self.low, self.high, numbers)


@dataclass(frozen=True, slots=True)
class LogUniform(_Bounded):
    """Any value from `low` to `high`, with a uniform logarithm: known up to a factor.

    Parameters
    ----------
    low, high : float
        Bounds, in units of the field, above 0.

    Raises
    ------
    ScenarioError
        If they are not finite numbers with ``0 < low <= high``.

    Examples
    --------
    >>> LogUniform(0.01, 1.0).values(np.array([0.0, 0.5, 1.0]), own=None).round(9).tolist()
    [0.01, 0.1, 1.0]
    """

    def __post_init__(self) -> None:
        """Check the bounds."""
        _Bounded.__post_init__(self)
        if self.low <= 0.0:
            raise ScenarioError("low", self.low, "must be > 0")

    def values(self, numbers: NDArray[np.float64], own: Any) -> NDArray[np.float64]:  # noqa: ARG002
        """Map numbers from 0 to 1 to values; the field's own value is not used."""
        logarithms = _between(math.log(self.low), math.log(self.high), numbers)
        return np.clip(np.exp(logarithms), self.low, self.high)  # against rounding


@dataclass(frozen=True, slots=True)
class UniformInt(TakesKeywords, Distribution):
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
    >>> UniformInt(1, 6).values(np.array([0.0, 0.5]), own=None).tolist()
    [1.0, 4.0]
    """

    low: int
    high: int

    def __post_init__(self) -> None:
        """Check the bounds."""
        for name in ("low", "high"):
            number = read_scalar(getattr(self, name), whole=True)
            if type(number) is not int:
                raise ScenarioError(name, number, "must be a whole number")
            object.__setattr__(self, name, number)
        _check_order(self)
        if self.high - self.low >= _MOST:
            raise ScenarioError("high", self.high, f"must be < low + 2^53 = {self.low + _MOST}")

    @property
    def is_whole(self) -> bool:
        """Whether all values are whole numbers."""
        return True

    def values(self, numbers: NDArray[np.float64], own: Any) -> NDArray[np.float64]:  # noqa: ARG002
        """Map numbers from 0 to 1 to values; the field's own value is not used."""
        steps = np.floor((self.high - self.low + 1) * numbers)
        return self.low + np.minimum(steps, self.high - self.low)  # at 1, the end of the range


@dataclass(frozen=True, slots=True)
class Scaled(_Bounded):
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
    >>> Scaled(0.98, 1.02).values(np.array([0.5, 1.0]), own=0.5).tolist()
    [0.5, 0.51]
    """

    @property
    def is_relative(self) -> bool:
        """Whether values vary about the field's own value."""
        return True

    def values(self, numbers: NDArray[np.float64], own: Any) -> NDArray[np.float64]:
        """Map numbers from 0 to 1 to values."""
        return float(own) * _between(self.low, self.high, numbers)


@dataclass(frozen=True, slots=True)
class Shifted(_Bounded):
    """The scenario's own value plus a shift from `low` to `high`, all equally likely.

    Parameters
    ----------
    low, high : float
        Bounds of the shift, in units of the field, or in units of a length of the scenario.
    unit : str, optional
        Path of that length, such as ``robot.outline.axle_distance``.
    minimum : float, optional
        Smallest value: a range that starts below it is shifted up.

    Raises
    ------
    ScenarioError
        If the bounds are not finite numbers with ``low <= high``.

    Examples
    --------
    The centre of mass 40 mm either way:

    >>> Shifted(-0.04, 0.04).values(np.array([0.0, 0.75]), own=0.01).round(3).tolist()
    [-0.03, 0.03]
    """

    unit: str | None = None
    minimum: float | None = None

    @property
    def is_relative(self) -> bool:
        """Whether values vary about the field's own value."""
        return True

    def values(self, numbers: NDArray[np.float64], own: Any) -> NDArray[np.float64]:
        """Map numbers from 0 to 1 to values."""
        low = own + self.low if self.minimum is None else max(own + self.low, self.minimum)
        return _between(low, low + (self.high - self.low), numbers)

    def resolve(self, scenario: Scenario) -> Shifted:
        """Take the length used as unit from the scenario."""
        if self.unit is None:
            return self
        length = read_path(scenario, self.unit)
        return replace(self, low=self.low * length, high=self.high * length, unit=None)

    def __repr__(self) -> str:
        """Write its constructor call, without arguments that are None."""
        fields = {"low": self.low, "high": self.high, "unit": self.unit, "minimum": self.minimum}
        arguments = [f"{name}={value!r}" for name, value in fields.items() if value is not None]
        return f"{type(self).__name__}({', '.join(arguments)})"


@dataclass(frozen=True, slots=True)
class Levels(Distribution):
    """The scenario's own value times one of several factors, which runs take in turn.

    Every factor gets the same number of runs, within one.

    Parameters
    ----------
    factors : tuple of float
        [-] One or more.
    spread : float
        [-] Each value varies uniformly by this fraction either way.
    along : str, optional
        Path of another field with levels, which shares its draws: slow runs last longer.

    Examples
    --------
    >>> Levels((0.1, 1.0), spread=0.02).values(np.array([0.0, 0.25, 0.75]), own=0.5).tolist()
    [0.049, 0.05, 0.5]
    """

    factors: tuple[float, ...]
    spread: float = 0.0
    along: str | None = None

    @property
    def is_relative(self) -> bool:
        """Whether values vary about the field's own value."""
        return True

    def cycle(self, numbers: NDArray[np.float64], first: int) -> NDArray[np.float64]:
        """Shift numbers from 0 to 1 so that run by run they select the next factor."""
        count = len(self.factors)
        return ((first + np.arange(numbers.size)) % count + numbers) / count

    def values(self, numbers: NDArray[np.float64], own: Any) -> NDArray[np.float64]:
        """Map numbers from 0 to 1 to values."""
        count = len(self.factors)
        level = np.minimum((count * numbers).astype(int), count - 1)
        within = count * numbers - level
        scatter = _between(1.0 - self.spread, 1.0 + self.spread, within)
        values: NDArray[np.float64] = float(own) * np.array(self.factors)[level] * scatter
        return values


@dataclass(frozen=True, slots=True)
class SciPyDistribution(Distribution):
    """A frozen distribution of SciPy: ``scipy.stats.norm(0.9, 0.05)``."""

    scipy: Any

    @property
    def is_whole(self) -> bool:
        """Whether all values are whole numbers."""
        return hasattr(self.scipy, "pmf")

    def values(self, numbers: NDArray[np.float64], own: Any) -> NDArray[np.float64]:  # noqa: ARG002
        """Map numbers from 0 to 1 to values: the quantiles."""
        values = np.asarray(self.scipy.ppf(numbers), dtype=np.float64)
        if self.is_whole:  # at 0 SciPy returns one less than the smallest value
            values = np.maximum(values, self.scipy.support()[0])
        return values

    def __repr__(self) -> str:
        """Write its constructor call."""
        keywords = [f"{name}={value!r}" for name, value in self.scipy.kwds.items()]
        return f"{self.scipy.dist.name}({', '.join([*map(repr, self.scipy.args), *keywords])})"


uniform = Uniform
uniform_int = UniformInt
scaled = Scaled
shifted = Shifted


def read_distribution(given: object, path: str) -> Distribution:
    """Read a distribution of this module or a frozen one of SciPy.

    Raises
    ------
    ScenarioError
        If it is neither; `path` names the argument.
    """
    if isinstance(given, Distribution):
        return given
    if all(hasattr(given, name) for name in ("ppf", "dist", "args", "kwds")):
        return SciPyDistribution(given)
    rule = (
        "must be uniform(low, high), uniform_int(low, high), scaled(low, high),"
        " shifted(low, high) or a frozen distribution of SciPy"
    )
    raise ScenarioError(path, given, rule)


def _check_order(bounds: _Bounded | UniformInt) -> None:
    if bounds.high < bounds.low:
        raise ScenarioError("high", bounds.high, f"must be >= low = {bounds.low}")


def _between(low: float, high: float, numbers: NDArray[np.float64]) -> NDArray[np.float64]:
    # Against rounding beyond the upper bound.
    return np.minimum(low + (high - low) * numbers, high)


class Ranges(Mapping[str, Distribution]):
    """What varies or is unknown: a distribution for each path, and its source.

    It can be passed as `vary` and `unknown`, like a plain mapping. ``|`` joins two, or one and a
    plain mapping; if both have a path, the right one wins.

    Parameters
    ----------
    distributions : mapping of str to distribution
        Distributions by path.
    sources : mapping of str to str, optional
        Source of each range, by path.
    optional : collection of str
        Paths that are ignored if they are swept or missing in the scenario; draws that break a rule
        are dropped, and the run keeps its own value.

    Examples
    --------
    >>> from crawler2d.variation.distributions import shifted, uniform
    >>> ranges = Ranges({"terrain.friction": uniform(0.5, 1.0)}, {"terrain.friction": "a guess"})
    >>> list(ranges | {"robot.mass": shifted(-1.0, 1.0)})
    ['terrain.friction', 'robot.mass']
    """

    def __init__(
        self,
        distributions: Mapping[str, Any],
        sources: Mapping[str, str] | None = None,
        optional: Collection[str] = (),
    ) -> None:
        self._distributions = {
            path: read_distribution(given, f"[{path!r}]") for path, given in distributions.items()
        }
        self.sources = dict(sources or {})
        self.optional = frozenset(optional)

    @classmethod
    def with_sources(
        cls, ranges: Mapping[str, tuple[Distribution, str]], *, optional: bool = False
    ) -> Ranges:
        """Make ranges from pairs of distribution and source; all paths may be optional."""
        sources = {path: source for path, (_, source) in ranges.items()}
        distributions = {path: distribution for path, (distribution, _) in ranges.items()}
        return cls(distributions, sources, distributions if optional else ())

    def without(self, paths: Collection[str]) -> Ranges:
        """Leave out some paths, if present."""
        return Ranges(
            {path: distribution for path, distribution in self.items() if path not in paths},
            {path: source for path, source in self.sources.items() if path not in paths},
            self.optional.difference(paths),
        )

    def __getitem__(self, path: str) -> Distribution:
        """Return the distribution of a path."""
        return self._distributions[path]

    def __iter__(self) -> Iterator[str]:
        """Iterate over the paths in order."""
        return iter(self._distributions)

    def __len__(self) -> int:
        """Count the paths."""
        return len(self._distributions)

    def __or__(self, other: object) -> Ranges:
        """Join with another, which wins if both have a path."""
        if not isinstance(other, Mapping):
            return NotImplemented
        right = other if isinstance(other, Ranges) else Ranges(other)
        left = self.without(right)
        return Ranges(
            {**self, **right}, left.sources | right.sources, left.optional | right.optional
        )

    def __ror__(self, other: object) -> Ranges:
        """Join with a plain mapping on the left."""
        return Ranges(other) | self if isinstance(other, Mapping) else NotImplemented

    def __repr__(self) -> str:
        """Show the distribution and source of each path."""
        lines = ["Ranges"]
        for path, distribution in self.items():
            lines.append(f"  {path}: {distribution}")
            if path in self.sources:
                lines.append(f"      {self.sources[path]}")
        return "\n".join(lines)
