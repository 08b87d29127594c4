"""Campaigns of runs: each cell is repeated until its rate is known well enough."""

from __future__ import annotations

import contextlib
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, field, replace
from os import PathLike
from typing import TYPE_CHECKING, Any, TypedDict

import numpy as np

from crawler2d.common.keywords import read_choice
from crawler2d.errors import ScenarioError, raise_first
from crawler2d.parameters.scenario import Scenario, check_scenario
from crawler2d.results.outcome import Outcome
from crawler2d.results.record import Row
from crawler2d.runs.branch import Trials, trial_names
from crawler2d.runs.dataset import build_attributes
from crawler2d.runs.progress import Progress, Reporter, reporter, thread_count
from crawler2d.sweeps.collect import Collector, RowsInterrupted
from crawler2d.sweeps.plan import Planner, World
from crawler2d.sweeps.sequential import Until, sequential
from crawler2d.sweeps.statistics import Interval
from crawler2d.variation.distributions import Distribution, Levels
from crawler2d.variation.draws import Variation

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = [
    "Campaign",
    "Cell",
    "Counts",
    "RateSampling",
    "Sampling",
    "Tally",
    "campaign",
    "counting",
    "is_cleared",
    "scaled_draws",
]


def scaled_draws(planner: Planner, factors: Mapping[str, float]) -> Planner:
    """Multiply the draws of some fields by factors.

    Parameters
    ----------
    planner : Planner
        Planner of the original draws.
    factors : mapping of str to float
        [-] By path of a field whose value in the scenario already includes the factor.

    Returns
    -------
    Planner
        The same planner if there are no factors.
    """
    if not factors:
        return planner
    return replace(
        planner,
        variation=_scale(planner.variation, factors),
        unknowns=_scale(planner.unknowns, factors),
    )


def _scale(variation: Variation, factors: Mapping[str, float]) -> Variation:
    scaled = {
        path: _ScaledDraws(each, factors[first])
        for path, each in variation.distributions.items()
        # Levels are relative to the field's own value, which already includes the factor.
        if (first := path.replace("[*]", "[0]")) in factors and not isinstance(each, Levels)
    }
    return replace(variation, distributions={**variation.distributions, **scaled})


@dataclass(frozen=True, slots=True)
class _ScaledDraws(Distribution):
    """A distribution times a factor that the field's own value already includes."""

    of: Distribution
    factor: float

    @property
    def is_whole(self) -> bool:
        """Whether all values are whole numbers."""
        return self.of.is_whole

    @property
    def is_relative(self) -> bool:
        """Whether values vary around the field's own value."""
        return self.of.is_relative

    def values(self, numbers: NDArray[np.float64], own: Any) -> NDArray[np.float64]:
        """Map numbers from 0 to 1 to values."""
        return self.factor * self.of.values(numbers, own / self.factor)

    def resolve(self, scenario: Scenario) -> Distribution:
        """Convert multiples of a length of the scenario to metres."""
        return replace(self, of=self.of.resolve(scenario))


class Sampling(TypedDict, total=False):
    """Keywords of every function of `crawler2d.studies`.

    vary, unknown : mapping of str to distribution
        What varies from run to run, and what is unknown: see `sweep`.
    samples : int
        Number of samples of the unknowns; the default is 20.
    seed : int
        Seed of the draws.
    trials : {"auto", "all"} or sequence of str
        Trials to make at every stop; see `simulate`.
    store : str or path-like
        File that keeps every run; see `sweep`.
    executor : concurrent.futures.Executor
        Where to simulate instead; see `sweep`.
    threads : int
        See `simulate_many`.
    progress : bool or callable
        See `simulate_many`; the total grows as cells need more runs.
    """

    vary: Mapping[str, Any] | None
    unknown: Mapping[str, Any] | None
    samples: int
    seed: int
    trials: Trials
    store: str | PathLike[str] | None
    executor: Executor | None
    threads: int | None
    progress: bool | Progress | None


class RateSampling(Sampling, total=False):
    """Keywords of a study of rates.

    until : Until
        Stopping rule of the cells.
    """

    until: Until


@dataclass(frozen=True, slots=True)
class Cell:
    """One setting to simulate.

    Attributes
    ----------
    names : tuple of str
        Values such as "height=0.1", for messages.
    scenario : Scenario
        The scenario without draws.
    factors : mapping of str to float
        [-] Factors by path, included in the scenario's own value and also applied to draws.
    """

    names: tuple[str, ...]
    scenario: Scenario
    factors: Mapping[str, float] = field(default_factory=dict)


Counts = Callable[[Row], bool]
"""Which runs are successes."""


def is_cleared(row: Row) -> bool:
    """Whether the whole robot passed the goal."""
    return row.outcome == Outcome.CLEARED


def counting(outcome: str) -> Counts:
    """Return a function that selects runs with an outcome, or "stopped" for any stop.

    Raises
    ------
    ScenarioError
        If the outcome is unknown.
    """
    read_choice(outcome, "outcome", [*map(str, Outcome), "stopped"])
    stops = {str(each) for each in Outcome if each.is_stop}
    counted = stops if outcome == "stopped" else {outcome}
    return lambda row: row.outcome in counted


@dataclass(slots=True)
class Tally:
    """The finished runs of one cell with one sample of the unknowns.

    Attributes
    ----------
    world : World
        The cell with its sample.
    until : Until
        The stopping rule.
    counts : callable
        Tells which runs are successes.
    others : sequence of callable
        Other outcomes: the rule then applies to the commonest of all.
    rows : list of Row
        One row per repeat.
    drawn : list of mapping of str to ndarray
        Values drawn for each batch of repeats, by path.
    planner : Planner, optional
        Planner of its repeats; None takes the study's.
    """

    world: World
    until: Until
    counts: Counts = is_cleared
    others: Sequence[Counts] = ()
    rows: list[Row] = field(default_factory=list)
    drawn: list[Mapping[str, NDArray[np.float64]]] = field(default_factory=list)
    planner: Planner | None = None

    @property
    def valid(self) -> list[Row]:
        """The runs with a result."""
        return [row for row in self.rows if row.error is None]

    @property
    def successes(self) -> int:
        """Number of successes."""
        return sum(map(self.counts, self.valid))

    @property
    def interval(self) -> Interval:
        """The rate with an interval that is valid for repeated checks."""
        return self.interval_of(self.counts)

    def interval_of(self, counts: Counts) -> Interval:
        """Return the rate of other runs with its interval."""
        valid = self.valid
        return sequential(sum(map(counts, valid)), len(valid), self.until.confidence)

    @property
    def commonest_outcome(self) -> str:
        """The commonest outcome."""
        return Counter(row.outcome for row in self.rows).most_common(1)[0][0]

    @property
    def commonest_failure(self) -> str:
        """The commonest outcome of failures; "" without any."""
        ends = Counter(row.outcome for row in self.valid if not self.counts(row))
        return ends.most_common(1)[0][0] if ends else ""

    @property
    def runs_needed(self) -> int:
        """Number of runs to simulate next: half as many again, to need few rounds."""
        count, valid = len(self.rows), self.valid
        commonest = max(sum(map(each, valid)) for each in (self.counts, *self.others))
        if count >= self.until.max_runs or self.until.is_done(commonest, len(valid)):
            return 0
        return min(max(self.until.min_runs - count, count // 2, 5), self.until.max_runs - count)


class Campaign:
    """All simulations of one study; see `campaign`.

    Attributes
    ----------
    base : Scenario
        The scenario that all cells share.
    until : Until
        Stopping rule of the cells.
    threshold : float, optional
        [-] Threshold of the study or its `until`.
    trials : tuple of str
        Trials at every stop.
    planner : Planner
        Planner of the repeats.
    settings : int
        Number of cells tried.
    """

    def __init__(
        self,
        base: Scenario,
        sampling: RateSampling,
        planner: Planner,
        collector: Collector,
        report: Reporter,
        *,
        threshold: float | None,
    ) -> None:
        self.base = base
        self.until = sampling["until"]
        self.threshold = threshold if self.until.threshold is None else self.until.threshold
        self.trials = trial_names(sampling.get("trials"))
        self.planner = planner
        self.settings = 0
        self._collector, self._report = collector, report

    def repeat(
        self,
        cells: Sequence[Cell],
        counts: Counts = is_cleared,
        others: Sequence[Counts] = (),
    ) -> list[list[Tally]]:
        """Simulate cells until the rate of each is known well enough.

        Parameters
        ----------
        cells : sequence of Cell
            Settings to simulate.
        counts : callable
            Tells which runs are successes.
        others : sequence of callable
            Other outcomes; see `Tally`.

        Returns
        -------
        list of list of Tally
            Tallies by cell and sample.

        Raises
        ------
        ScenarioError
            If a cell or a draw breaks a rule; nothing is simulated.
        """
        self.settings += len(cells)
        by_cell = []
        for each in cells:
            planner = scaled_draws(self.planner, each.factors)
            worlds = planner.worlds(each.scenario, each.names)
            by_cell.append([Tally(w, self.until, counts, others, planner=planner) for w in worlds])
        everyone = [tally for tallies in by_cell for tally in tallies]
        raise_first(tally.world.checked for tally in everyone)
        while due := [(tally, tally.runs_needed) for tally in everyone if tally.runs_needed]:
            self.simulate(due)
        return by_cell

    def simulate(self, due: Sequence[tuple[Tally, int]]) -> None:
        """Simulate a number of additional runs of each tally.

        Raises
        ------
        ScenarioError
            If a draw breaks a rule.
        """
        plans = []
        for tally, more in due:
            begin = len(tally.rows)
            planner = tally.planner or self.planner
            plans.append(planner.runs(tally.world, begin, begin + more))
        checked = [each for plan in plans for each in plan.checked]
        raise_first(checked)
        batch = self._collector.batch(checked)
        self._report.expect(len(checked))
        self._report(batch.done)
        rows = iter(self._collector.rows(batch, self._report))
        for (tally, _), plan in zip(due, plans, strict=True):
            tally.rows += [next(rows) for _ in plan.checked]
            tally.drawn.append(plan.drawn)

    def attributes(self, figure: str, tallies: Iterable[Tally]) -> dict[str, Any]:
        """Describe the study for the attributes of its data set; `figure` names its plot."""
        return {
            "figure": figure,
            "scenario": self.base.to_json(),
            "vary": self.planner.variation.text,
            "unknown": self.planner.unknowns.text,
            "settings": self.settings,
            "runs": sum(len(tally.rows) for tally in tallies),
            **build_attributes(),
        }


@contextlib.contextmanager
def campaign(
    base: Scenario,
    sampling: RateSampling | Sampling,
    swept: Sequence[str] = (),
    *,
    threshold: float | None = None,
    repeats: int | None = None,
) -> Iterator[Campaign]:
    """Open a study: store, progress bar and draws.

    Parameters
    ----------
    base : Scenario
        The scenario that all cells share.
    sampling : Sampling
        The keywords of the study.
    swept : sequence of str
        Paths set by the study.
    threshold : float, optional
        [-] Threshold of rates, unless `until` has one.
    repeats : int, optional
        Runs per cell of a study of measures, which has no `until`.

    Raises
    ------
    ScenarioError
        If a keyword breaks a rule.
    BatchInterrupted
        On Ctrl-C; a store keeps the finished runs.
    """
    check_scenario(base).validate()
    if repeats is None:
        until = Until(threshold=threshold)
    else:
        until = Until(min_runs=repeats, max_runs=repeats)
    given: RateSampling = {"until": until, **sampling}
    if not isinstance(given["until"], Until):
        raise ScenarioError("until", given["until"], "must be an Until")
    planner = Planner.read(
        base,
        swept,
        vary=sampling.get("vary"),
        unknown=sampling.get("unknown"),
        seed=sampling.get("seed", 0),
        samples=sampling.get("samples", 20),
    )
    # A model may have a drive of its own.
    if not {"drive", "drive.schedule", "drive.gait"}.intersection(swept):
        planner.check_effect([base], swept)
    store = sampling.get("store")
    try:
        with (
            Collector(
                trial_names(sampling.get("trials")),
                store=store,
                executor=sampling.get("executor"),
                threads=thread_count(sampling.get("threads")),
            ) as collector,
            reporter(sampling.get("progress", True), 0) as report,
        ):
            yield Campaign(base, given, planner, collector, report, threshold=threshold)
    except RowsInterrupted as interrupt:
        raise interrupt.as_batch(store) from None
