"""Draws of a field that a study multiplies, such as a friction twice as high."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from crawler2d.sweeps.plan import Planner
from crawler2d.variation.distributions import Distribution, Levels
from crawler2d.variation.draws import Variation

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from crawler2d.parameters.scenario import Scenario

__all__ = ["multiplied"]


def multiplied(planner: Planner, factors: Mapping[str, float]) -> Planner:
    """Multiply what is drawn of some fields: the same numbers give values times a factor.

    Parameters
    ----------
    planner : Planner
        Of the draws as they are.
    factors : mapping of str to float
        [-] By path of a field whose own value in the scenario has this factor already.

    Returns
    -------
    Planner
        The same if there are no factors.
    """
    if not factors:
        return planner
    return replace(
        planner,
        variation=_of(planner.variation, factors),
        unknowns=_of(planner.unknowns, factors),
    )


def _of(variation: Variation, factors: Mapping[str, float]) -> Variation:
    found = {
        path: _Multiplied(each, factors[path])
        # Levels are of the field's own value, which has the factor already.
        if path in factors and not isinstance(each, Levels)
        else each
        for path, each in variation.distributions.items()
    }
    return replace(variation, distributions=found)


@dataclass(frozen=True, slots=True)
class _Multiplied:
    """A distribution times a factor, which the field's own value holds already."""

    of: Distribution
    factor: float

    @property
    def is_whole(self) -> bool:
        """Whether it gives whole numbers."""
        return self.of.is_whole

    @property
    def is_relative(self) -> bool:
        """Whether it varies about the field's own value; else it replaces that."""
        return self.of.is_relative

    def values(self, numbers: NDArray[np.float64], own: Any) -> NDArray[np.float64]:
        """Map numbers from 0 to 1 to values."""
        return self.factor * self.of.values(numbers, own / self.factor)

    def on(self, scenario: Scenario) -> Distribution:
        """Return this distribution with every length that it takes from a scenario."""
        return replace(self, of=self.of.on(scenario))
