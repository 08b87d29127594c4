"""The runs of a Saltelli design: what is not known and what varies, drawn from the same points."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from crawler2d.errors import raise_first
from crawler2d.parameters.scenario import Scenario
from crawler2d.studies.campaign import Campaign, Counts, Tally
from crawler2d.studies.halving import Fresh
from crawler2d.studies.indices import points
from crawler2d.sweeps.axes import short_names
from crawler2d.variation.draws import Variation

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["RUN_TO_RUN", "Design", "rate_of"]

RUN_TO_RUN = "run to run"
"""All that varies from run to run, as one factor."""

_TELLING = (0.1, 0.9)
"""[-] Rates outside of which too few runs have the rarer outcome to tell what decides."""


class Design:
    """The points that all models share, and the runs at them.

    Parameters
    ----------
    study : Campaign
        What simulates; it has no unknowns of its own.
    unknowns : Variation
        What is not known: each path is a factor.
    samples : int
        Points in A, a power of two.
    counts : callable
        Which runs have the outcome.

    Attributes
    ----------
    unknowns : Variation
        What is not known.
    factors : dict of str to str
        Names of the unknowns by path.
    is_varied : bool
        Whether there is a factor of what varies from run to run, the last one.
    matrices : list of str
        Names of the sets of points: A, B, then A with each factor from B.
    """

    def __init__(self, study: Campaign, unknowns: Variation, samples: int, counts: Counts) -> None:
        self._study, self._samples, self._counts = study, samples, counts
        self.unknowns = unknowns
        self.factors = short_names(list(unknowns.distributions))
        varied = list(study.planner.variation.distributions)
        self.is_varied = bool(varied)
        names = [*self.factors.values(), *([RUN_TO_RUN] if varied else [])]
        self.matrices = ["A", "B", *(f"A, {name} of B" for name in names)]
        sizes = [1] * len(self.factors) + ([len(varied)] if varied else [])
        self._points = points(samples, sizes, study.planner.seed)

    def run(self, cell: Scenario, label: str) -> list[Tally]:
        """Simulate A, then B, then the rest, for as long as the rate is one that tells.

        Returns
        -------
        list of Tally
            One a matrix that was simulated.

        Raises
        ------
        ScenarioError
            If a draw breaks a rule; nothing of its matrix has been simulated.
        SimulationDiverged
            If a run has no result.
        """
        found: list[Tally] = []
        for matrices in ([0], [1], range(2, len(self.matrices))):
            new = [self._planned(cell, label, matrix) for matrix in matrices]
            self._study.settings += len(new)
            self._study.simulate([(tally, self._samples) for tally in new])
            raise_first(row.error for tally in new for row in tally.rows)
            found += new
            if not _TELLING[0] <= rate_of(found) <= _TELLING[1]:
                break
        return found

    def _planned(self, cell: Scenario, label: str, matrix: int) -> Tally:
        study = self._study
        (world,) = study.planner.worlds(cell, (f"model={label}", f"matrix={self.matrices[matrix]}"))
        columns = self._points[matrix].T
        planner = Fresh(
            _given(study.planner.variation, columns[len(self.factors) :]),
            _given(self.unknowns, columns[: len(self.factors)]),
            study.planner.seed,
            self._samples,
        )
        return Tally(world, study.until, self._counts, planner=planner)


def rate_of(matrices: list[Tally]) -> float:
    """Return the rate at A and B; the other points are not independent of these."""
    return float(np.mean([tally.successes / len(tally.rows) for tally in matrices[:2]]))


@dataclass(frozen=True, slots=True)
class _Given(Variation):
    """Draws from numbers that are given, instead of random ones."""

    given: Mapping[str, NDArray[np.float64]] = field(default_factory=dict)

    def numbers(
        self,
        seed: int,  # noqa: ARG002 - of random ones
        count: int,
        *,
        kind: str = "",  # noqa: ARG002
        first: int = 0,  # noqa: ARG002
    ) -> dict[str, NDArray[np.float64]]:
        """Return the first numbers of every path."""
        return {path: each[:count] for path, each in self.given.items()}


def _given(variation: Variation, columns: NDArray[np.float64]) -> _Given:
    numbers = dict(zip(variation.distributions, columns, strict=True))
    return _Given(variation.distributions, variation.gives_way, variation.text, numbers)
