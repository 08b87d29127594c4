"""Distributions of one number, and ranges of fields by path with where each range comes from."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from crawler2d.common.arrays import frozen_scalar, real_number
from crawler2d.common.keywords import TakesKeywords
from crawler2d.errors import ScenarioError
from crawler2d.parameters.fields import read_path

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from crawler2d.parameters.scenario import Scenario

__all__ = [
    "Distribution",
    "Frozen",
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

# A float64 from 0 to 1 can distinguish this many whole numbers.
_MOST = 2**53


class Distribution(Protocol):
    """Any distribution."""

    @property
    def is_whole(self) -> bool:
        """Whether it gives whole numbers."""

    @property
    def is_relative(self) -> bool:
        """Whether it varies about the field's own value; else it replaces that."""

    def values(self, numbers: NDArray[np.float64], own: Any) -> NDArray[np.float64]:
        """Map numbers from 0 to 1 to values of a field, whose own value is `own`."""

    def on(self, scenario: Scenario) -> Distribution:
        """Return this distribution with every length that it takes from a scenario."""


@dataclass(frozen=True, slots=True)
class _Bounded(TakesKeywords):
    """Bounds in order, both of them finite."""

    low: float
    high: float

    def __post_init__(self) -> None:
        """Check the bounds."""
        for name in ("low", "high"):
            number = real_number(getattr(self, name), name)
            if not math.isfinite(number):
                raise ScenarioError(name, number, "must be finite")
            object.__setattr__(self, name, number)
        _in_order(self)

    @property
    def is_whole(self) -> bool:
        """Whether it gives whole numbers."""
        return False

    @property
    def is_relative(self) -> bool:
        """Whether it varies about the field's own value."""
        return True

    def on(self, scenario: Scenario) -> Distribution:  # noqa: ARG002 - others do
        """Take nothing from the scenario."""
        return self  # type: ignore[return-value] # what derives from this has values


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

    @property
    def is_relative(self) -> bool:
        """Whether it varies about the field's own value."""
        return False

    def values(self, numbers: NDArray[np.float64], own: Any) -> NDArray[np.float64]:  # noqa: ARG002
        """Map numbers from 0 to 1 to values; the field's own value is not used."""
        return _between(self.low, self.high, numbers)


@dataclass(frozen=True, slots=True)
class LogUniform(_Bounded):
    """Any value from `low` to `high`, equally likely in every octave: known but for a factor.

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

    @property
    def is_relative(self) -> bool:
        """Whether it varies about the field's own value."""
        return False

    def values(self, numbers: NDArray[np.float64], own: Any) -> NDArray[np.float64]:  # noqa: ARG002
        """Map numbers from 0 to 1 to values; the field's own value is not used."""
        logarithms = _between(math.log(self.low), math.log(self.high), numbers)
        return np.clip(np.exp(logarithms), self.low, self.high)  # which rounding could pass


@dataclass(frozen=True, slots=True)
class UniformInt(TakesKeywords):
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
            number = frozen_scalar(getattr(self, name), whole=True)
            if type(number) is not int:
                raise ScenarioError(name, number, "must be a whole number")
            object.__setattr__(self, name, number)
        _in_order(self)
        if self.high - self.low >= _MOST:
            raise ScenarioError("high", self.high, f"must be < low + 2^53 = {self.low + _MOST}")

    @property
    def is_whole(self) -> bool:
        """Whether it gives whole numbers."""
        return True

    @property
    def is_relative(self) -> bool:
        """Whether it varies about the field's own value."""
        return False

    def values(self, numbers: NDArray[np.float64], own: Any) -> NDArray[np.float64]:  # noqa: ARG002
        """Map numbers from 0 to 1 to values; the field's own value is not used."""
        return self.low + np.floor((self.high - self.low + 1) * numbers)

    def on(self, scenario: Scenario) -> UniformInt:  # noqa: ARG002 - others do
        """Take nothing from the scenario."""
        return self


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

    def values(self, numbers: NDArray[np.float64], own: Any) -> NDArray[np.float64]:
        """Map numbers from 0 to 1 to values."""
        return float(own) * _between(self.low, self.high, numbers)


@dataclass(frozen=True, slots=True)
class Shifted(_Bounded):
    """The scenario's own value plus a shift from `low` to `high`, all equally likely.

    Parameters
    ----------
    low, high : float
        Bounds of the shift, in units of the field, or as shares of the length `of`.
    of : str, optional
        Path of a length of the scenario: the bounds are multiples of it.
    least : float, optional
        Smallest value: a range that begins below it is moved up.

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

    of: str | None = None
    least: float | None = None

    def values(self, numbers: NDArray[np.float64], own: Any) -> NDArray[np.float64]:
        """Map numbers from 0 to 1 to values."""
        low = own + self.low if self.least is None else max(own + self.low, self.least)
        return _between(low, low + (self.high - self.low), numbers)

    def on(self, scenario: Scenario) -> Shifted:
        """Take the length `of` from the scenario."""
        if self.of is None:
            return self
        length = read_path(scenario, self.of)
        return replace(self, low=self.low * length, high=self.high * length, of=None)

    def __repr__(self) -> str:
        """Write the call that makes it, without what is not given."""
        given = {"low": self.low, "high": self.high, "of": self.of, "least": self.least}
        figures = [f"{name}={value!r}" for name, value in given.items() if value is not None]
        return f"{type(self).__name__}({', '.join(figures)})"


@dataclass(frozen=True, slots=True)
class Levels:
    """The scenario's own value times each of some factors in turn: run by run the next one.

    So every factor has the same number of runs, give or take one.

    Parameters
    ----------
    factors : tuple of float
        [-] One or more.
    spread : float
        [-] Each value varies by this share either way, all equally likely.
    along : str, optional
        Path of another field of levels, whose draws these are, too: what is slow takes long.

    Examples
    --------
    >>> Levels((0.1, 1.0), spread=0.02).values(np.array([0.0, 0.25, 0.75]), own=0.5).tolist()
    [0.049, 0.05, 0.5]
    """

    factors: tuple[float, ...]
    spread: float = 0.0
    along: str | None = None

    @property
    def is_whole(self) -> bool:
        """Whether it gives whole numbers."""
        return False

    @property
    def is_relative(self) -> bool:
        """Whether it varies about the field's own value."""
        return True

    def in_turn(self, numbers: NDArray[np.float64], first: int) -> NDArray[np.float64]:
        """Move numbers from 0 to 1 so that they take the factors in turn, from the first run on."""
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

    def on(self, scenario: Scenario) -> Levels:  # noqa: ARG002 - others do
        """Take nothing from the scenario."""
        return self


@dataclass(frozen=True, slots=True)
class Frozen:
    """A frozen distribution of SciPy: ``scipy.stats.norm(0.9, 0.05)``."""

    scipy: Any

    @property
    def is_whole(self) -> bool:
        """Whether it gives whole numbers."""
        return hasattr(self.scipy, "pmf")

    @property
    def is_relative(self) -> bool:
        """Whether it varies about the field's own value."""
        return False

    def values(self, numbers: NDArray[np.float64], own: Any) -> NDArray[np.float64]:  # noqa: ARG002
        """Map numbers from 0 to 1 to values: the quantiles."""
        return np.asarray(self.scipy.ppf(numbers), dtype=np.float64)

    def on(self, scenario: Scenario) -> Frozen:  # noqa: ARG002 - others do
        """Take nothing from the scenario."""
        return self

    def __repr__(self) -> str:
        """Write the call that makes it, with the names of its figures."""
        figures = [*map(repr, self.scipy.args), *(f"{k}={v!r}" for k, v in self.scipy.kwds.items())]
        return f"{self.scipy.dist.name}({', '.join(figures)})"


uniform = Uniform
uniform_int = UniformInt
scaled = Scaled
shifted = Shifted


def read_distribution(given: object, place: str) -> Distribution:
    """Take a distribution of this module, or a frozen one of SciPy.

    Raises
    ------
    ScenarioError
        If it is neither; `place` names the argument.
    """
    if isinstance(given, (Uniform, LogUniform, UniformInt, Scaled, Shifted, Levels, Frozen)):
        return given
    if all(hasattr(given, name) for name in ("ppf", "dist", "args", "kwds")):
        return Frozen(given)
    rule = (
        "must be uniform(low, high), uniform_int(low, high), scaled(low, high),"
        " shifted(low, high) or a frozen distribution of SciPy"
    )
    raise ScenarioError(place, given, rule)


def _in_order(bounds: _Bounded | UniformInt) -> None:
    if bounds.high < bounds.low:
        raise ScenarioError("high", bounds.high, f"must be >= low = {bounds.low}")


def _between(low: float, high: float, numbers: NDArray[np.float64]) -> NDArray[np.float64]:
    # Rounding could exceed the upper bound.
    return np.minimum(low + (high - low) * numbers, high)


class Ranges(Mapping[str, Distribution]):
    """What varies, or is not known: a distribution for each path, and its source.

    It takes the place of a plain mapping in `vary` and `unknown`. Two are joined with ``|``, also
    with a plain mapping; of equal paths the right one counts.

    Parameters
    ----------
    distributions : mapping of str to distribution
        By path.
    sources : mapping of str to str, optional
        Where each range comes from, by path.
    gives_way : collection of str
        Paths that are left out where they are swept, and where the scenario has none; a draw that
        breaks a rule is dropped, and the run keeps its own value.

    Examples
    --------
    >>> from crawler2d.variation.distributions import shifted, uniform
    >>> found = Ranges({"terrain.friction": uniform(0.5, 1.0)}, {"terrain.friction": "a guess"})
    >>> list(found | {"robot.mass": shifted(-1.0, 1.0)})
    ['terrain.friction', 'robot.mass']
    """

    def __init__(
        self,
        distributions: Mapping[str, Any],
        sources: Mapping[str, str] | None = None,
        gives_way: Collection[str] = (),
    ) -> None:
        self._distributions = {
            path: read_distribution(given, f"[{path!r}]") for path, given in distributions.items()
        }
        self.sources = dict(sources or {})
        self.gives_way = frozenset(gives_way)

    def __getitem__(self, path: str) -> Distribution:
        """Return the distribution of a path."""
        return self._distributions[path]

    def __iter__(self) -> Iterator[str]:
        """Go through the paths in order."""
        return iter(self._distributions)

    def __len__(self) -> int:
        """Count the paths."""
        return len(self._distributions)

    def __or__(self, other: object) -> Ranges:
        """Join with more, which count where both have a path."""
        if not isinstance(other, Mapping):
            return NotImplemented
        return _joined(self, other)

    def __ror__(self, other: object) -> Ranges:
        """Join with what stands before, whose paths these replace."""
        if not isinstance(other, Mapping):
            return NotImplemented
        return _joined(other, self)

    def __repr__(self) -> str:
        """Show a line for each path: its distribution, and where that comes from."""
        lines = [
            f"  {path}: {distribution}" + _indented(self.sources.get(path))
            for path, distribution in self.items()
        ]
        return "\n".join(["Ranges", *lines])


def _indented(source: str | None) -> str:
    return "" if source is None else f"\n      {source}"


def _joined(first: Mapping[str, Any], second: Mapping[str, Any]) -> Ranges:
    sources = {**getattr(first, "sources", {})}
    for path in second:
        sources.pop(path, None)
    sources.update(getattr(second, "sources", {}))
    kept: frozenset[str] = getattr(first, "gives_way", frozenset())
    added: frozenset[str] = getattr(second, "gives_way", frozenset())
    return Ranges({**first, **second}, sources, (kept - set(second)) | added)
