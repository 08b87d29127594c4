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

from crawler2d.common.arrays import whole_number
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
        variation=_scale(planner.variation, factors),
        unknowns=_scale(planner.unknowns, factors),
    )


def _scale(variation: Variation, factors: Mapping[str, float]) -> Variation:
    scaled = {
        path: _ScaledDraws(each, factors[first])
        for path, each in variation.distributions.items()
        # Levels are relative to the field's own value, which has the factor already.
        if (first := path.replace("[*]", "[0]")) in factors and not isinstance(each, Levels)
    }
    return replace(variation, distributions={**variation.distributions, **scaled})


@dataclass(frozen=True, slots=True)
class _ScaledDraws(Distribution):
    """A distribution times a factor, which the field's own value holds already."""

    of: Distribution
    factor: float

    @property
    def is_whole(self) -> bool:
        """Whether all values are whole numbers."""
        return self.of.is_whole

    @property
    def is_relative(self) -> bool:
        """Whether values vary about the field's own value."""
        return self.of.is_relative

    def values(self, numbers: NDArray[np.float64], own: Any) -> NDArray[np.float64]:
        """Map numbers from 0 to 1 to values."""
        return self.factor * self.of.values(numbers, own / self.factor)

    def resolve(self, scenario: Scenario) -> Distribution:
        """Replace what is given as a multiple of a length of the scenario."""
        return replace(self, of=self.of.resolve(scenario))


class Sampling(TypedDict, total=False):
    """The keywords that every function of `crawler2d.studies` takes.

    vary, unknown : mapping of str to distribution
        What differs from run to run, and what is not known: see `sweep`.
    samples : int
        Of the unknowns, 20 unless given.
    seed : int
        Of the draws.
    trials : {"auto", "all"} or sequence of str
        What to try at every stop; see `simulate`.
    store : str or path-like
        A file that keeps every run; see `sweep`.
    executor : concurrent.futures.Executor
        Where to simulate instead; see `sweep`.
    threads : int
        See `simulate_many`.
    progress : bool or callable
        See `simulate_many`; the number of all runs grows as cells need more.
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
    """The keywords of a study of rates.

    until : Until
        When a cell has been simulated often enough.
    """

    until: Until


@dataclass(frozen=True, slots=True)
class Cell:
    """One setting that is tried.

    Attributes
    ----------
    names : tuple of str
        Such as "height=0.1", for messages.
    scenario : Scenario
        Without draws.
    factors : mapping of str to float
        [-] By path: the factor of the scenario's own value, which draws get, too.
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
    """Count the runs with an outcome, or "stopped" for any stop, as `rate` does.

    Raises
    ------
    ScenarioError
        If there is no such outcome.
    """
    read_choice(outcome, "outcome", [*map(str, Outcome), "stopped"])
    stops = {str(each) for each in Outcome if each.is_stop}
    counted = stops if outcome == "stopped" else {outcome}
    return lambda row: row.outcome in counted


@dataclass(slots=True)
class Tally:
    """The runs so far of one cell with one sample of the unknowns.

    Attributes
    ----------
    world : World
        What is simulated.
    until : Until
        When there are enough.
    counts : callable
        Which runs are successes.
    others : sequence of callable
        Other outcomes: it is enough if the rate of the commonest one of all is known.
    rows : list of Row
        One a repeat.
    drawn : list of mapping of str to ndarray
        What was drawn for each batch of repeats, by path.
    planner : Planner, optional
        Draws its repeats; None takes the study's.
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
        """Number of runs that count."""
        return sum(map(self.counts, self.valid))

    @property
    def interval(self) -> Interval:
        """The rate with its interval, which holds however often one looked."""
        return self.interval_of(self.counts)

    def interval_of(self, counts: Counts) -> Interval:
        """Return the rate of other runs than successes, with its interval."""
        valid = self.valid
        return sequential(sum(map(counts, valid)), len(valid), self.until.confidence)

    @property
    def commonest_outcome(self) -> str:
        """How most runs ended."""
        return Counter(row.outcome for row in self.rows).most_common(1)[0][0]

    @property
    def commonest_failure(self) -> str:
        """How most runs that do not count ended; "" if all count."""
        ends = Counter(row.outcome for row in self.valid if not self.counts(row))
        return ends.most_common(1)[0][0] if ends else ""

    @property
    def runs_needed(self) -> int:
        """Number of runs to simulate next: half as many again, so that few rounds are needed."""
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
        What all cells share.
    until : Until
        When a cell has been simulated often enough.
    threshold : float, optional
        [-] The rate that the study, or its `until`, compares with.
    trials : tuple of str
        What is tried at every stop.
    planner : Planner
        Draws the repeats.
    settings : int
        How many cells have been tried.
    """

    def __init__(
        self,
        base: Scenario,
        how: RateSampling,
        planner: Planner,
        collector: Collector,
        report: Reporter,
        *,
        threshold: float | None,
    ) -> None:
        self.base = base
        self.until = how["until"]
        self.threshold = threshold if self.until.threshold is None else self.until.threshold
        self.trials = trial_names(how.get("trials"))
        self.planner = planner
        self.settings = 0
        self._collector, self._report = collector, report

    def repeat(
        self,
        cells: Sequence[Cell],
        counts: Counts = is_cleared,
        others: Sequence[Counts] = (),
    ) -> list[list[Tally]]:
        """Simulate cells until each is known well enough.

        Parameters
        ----------
        cells : sequence of Cell
            The settings.
        counts : callable
            Which runs are successes.
        others : sequence of callable
            Other outcomes; see `Tally`.

        Returns
        -------
        list of list of Tally
            By cell and sample.

        Raises
        ------
        ScenarioError
            If a cell or a draw breaks a rule; its cells have not been simulated.
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
        """Simulate a number of further runs of each tally.

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
        """Describe the study, for the attributes of its data set; `figure` is what it plots."""
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
    how: RateSampling | Sampling,
    swept: Sequence[str] = (),
    *,
    threshold: float | None = None,
    repeats: int | None = None,
) -> Iterator[Campaign]:
    """Open what a study needs: its store, its progress bar, its draws.

    Parameters
    ----------
    base : Scenario
        What all cells share.
    how : Sampling
        The keywords of the study.
    swept : sequence of str
        Paths that the study sets itself.
    threshold : float, optional
        [-] Where a rate decides, unless `until` has another threshold.
    repeats : int, optional
        Runs of every cell, of a study that measures: then there is no `until`.

    Raises
    ------
    ScenarioError
        If a keyword breaks a rule.
    BatchInterrupted
        On Ctrl-C; a store keeps what was finished.
    """
    check_scenario(base).validate()
    if repeats is None:
        until = Until(threshold=threshold)
    else:
        count = whole_number(repeats, "repeats", 1, 10**6)
        until = Until(min_runs=count, max_runs=count)
    given: RateSampling = {"until": until, **how}
    if not isinstance(given["until"], Until):
        raise ScenarioError("until", given["until"], "must be an Until")
    planner = Planner.read(
        base,
        swept,
        vary=how.get("vary"),
        unknown=how.get("unknown"),
        seed=how.get("seed", 0),
        samples=how.get("samples", 20),
    )
    store = how.get("store")
    try:
        with (
            Collector(
                trial_names(how.get("trials")),
                store=store,
                executor=how.get("executor"),
                threads=thread_count(how.get("threads")),
            ) as collector,
            reporter(how.get("progress", True), 0) as report,
        ):
            yield Campaign(base, given, planner, collector, report, threshold=threshold)
    except RowsInterrupted as interrupt:
        raise interrupt.as_batch(store) from None
