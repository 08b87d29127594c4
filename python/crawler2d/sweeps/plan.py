"""The scenarios of all runs of a sweep: by cell, sample of the unknowns, and repeat."""

from __future__ import annotations

import contextlib
import itertools
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from crawler2d import _core
from crawler2d.common.arrays import whole_number
from crawler2d.errors import ScenarioError
from crawler2d.parameters.fields import excluded, read_path
from crawler2d.parameters.scenario import Scenario
from crawler2d.variation.draws import Draws, Variation

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from crawler2d.sweeps.axes import Axis

__all__ = ["Checked", "Plan", "Planner", "World", "plan_runs"]

Checked = _core.PreparedScenario | ScenarioError
"""A valid scenario, or the error of the rule that it breaks."""

_UNKNOWN = "unknown "
"""Kind of the draws of unknowns, separate from those of repeats."""

_SCHEDULED = {"drive.speed": "drive", "drive.gait.angle": "drive.gait"}
"""Commands that a schedule overrides, and the object with the schedule."""


@dataclass(frozen=True, slots=True)
class World:
    """A cell with one sample of the unknowns.

    Attributes
    ----------
    labels : tuple of str
        Labels of cell and sample, for messages.
    cell : Scenario
        The cell without the sample.
    checked : Checked
        The cell with the sample.
    own : mapping of str to float
        Values of the sample, by path of a field.
    sampled : mapping of str to float
        Values of the sample, by path of `unknown`.
    sample : int, optional
        Number of the sample; None without unknowns.
    """

    labels: tuple[str, ...]
    cell: Scenario
    checked: Checked
    own: Mapping[str, float]
    sampled: Mapping[str, float]
    sample: int | None = None


@dataclass(frozen=True, slots=True)
class Plan:
    """The planned runs of a world.

    Attributes
    ----------
    world : World
        The world of all of them.
    begin : int
        The first repeat.
    checked : list of Checked
        One scenario per repeat.
    drawn : mapping of str to ndarray, shape (repeats,)
        Drawn values by path of `vary`; empty if the world breaks a rule.
    """

    world: World
    begin: int
    checked: list[Checked]
    drawn: Mapping[str, NDArray[np.float64]]

    def path(self, index: int) -> str:
        """Return the path of a run, for errors."""
        return _cell_path([*self.world.labels, f"repeat={self.begin + index}"])


@dataclass(frozen=True, slots=True)
class Planner:
    """Makes the scenarios of runs: equal draws for equal seed, path, sample and repeat.

    All cells share their draws, so their runs can be compared in pairs. Different samples have
    different draws, so their runs are independent.

    Attributes
    ----------
    variation, unknowns : Variation
        Distributions for every repeat and every sample.
    seed : int
        Seed of the draws.
    samples : int
        Number of samples of the unknowns; ignored if there are none.
    """

    variation: Variation
    unknowns: Variation
    seed: int
    samples: int = 1

    @classmethod
    def read(
        cls,
        scenario: Scenario,
        swept: Sequence[str],
        *,
        vary: object,
        unknown: object,
        seed: int,
        samples: int,
    ) -> Planner:
        """Read the arguments of these names; the sweep sets the paths `swept`.

        Raises
        ------
        ScenarioError
            If an argument breaks a rule.
        """
        given = {} if unknown is None else unknown
        unknowns = Variation.read(scenario, given, swept, "unknown")
        return cls(
            Variation.read(scenario, vary, [*swept, *unknowns.distributions]),
            unknowns,
            whole_number(seed, "seed", 0, 2**64 - 1),
            whole_number(samples, "samples", 1, 10**5),
        )

    def check_effect(self, cells: Sequence[Scenario], swept: Sequence[str]) -> None:
        """Refuse to sweep or draw a command that a schedule overrides from the start in every cell.

        Raises
        ------
        ScenarioError
            If there is one: all its rows would be equal.
        """
        of_both = (self.variation, self.unknowns)
        drawn = {path for each in of_both for path in each.distributions.keys() - each.optional}
        for path, of in _SCHEDULED.items():
            schedules = [getattr(read_path(cell, of), "schedule", None) for cell in cells]
            is_set = bool(cells) and all(each and each[0][0] <= 0.0 for each in schedules)
            if is_set and path in {*swept, *drawn}:
                rule = f"must not be swept or drawn where {of}.schedule begins at 0 s and sets it"
                raise ScenarioError(path, schedules[0], rule)

    def worlds(
        self, cell: Scenario, names: Sequence[str], like: _core.PreparedScenario | None = None
    ) -> list[World]:
        """Set every sample of the unknowns in a cell; reuse the parts shared with `like`.

        Raises
        ------
        ScenarioError
            If the cell lacks a path.
        """
        place = _cell_path(names)
        whole = _validate(cell, place, like)
        if not self.unknowns.distributions:
            return [World(tuple(names), cell, whole, {}, {})]
        with _prefixed(place):
            numbers = self.unknowns.numbers(self.seed, self.samples, kind=_UNKNOWN)
            drawn = self.unknowns.draw(cell, numbers)
            variants = _apply_draws(cell, whole, drawn, self.samples)
        worlds = []
        for sample, each in enumerate(variants):
            labels = (*names, f"sample={sample}")
            if isinstance(each, ScenarioError) and each is not whole:
                variants[sample] = _prefix(each, _cell_path(labels))
            own = {path: float(values[sample]) for path, values in drawn.values.items()}
            shown = {path: float(values[sample]) for path, values in drawn.shown.items()}
            worlds.append(World(labels, cell, variants[sample], own, shown, sample))
        return worlds

    def runs(self, world: World, begin: int, end: int) -> Plan:
        """Draw some repeats of a world.

        Raises
        ------
        ScenarioError
            If the cell lacks a path. Scenarios that break a rule appear in the plan as errors.
        """
        kind = "" if world.sample is None else f"sample {world.sample} "
        numbers = self.variation.numbers(self.seed, end, kind=kind, first=world.sample or 0)
        with _prefixed(_cell_path(world.labels)):
            some = {path: each[begin:] for path, each in numbers.items()}
            runs, drawn = self.draw(world, some, end - begin)
        plan = Plan(world, begin, runs, drawn)
        for index, run in enumerate(runs):
            if isinstance(run, ScenarioError) and run is not world.checked:
                runs[index] = _prefix(run, plan.path(index))
        return plan

    def draw(
        self, world: World, numbers: Mapping[str, NDArray[np.float64]], count: int
    ) -> tuple[list[Checked], dict[str, NDArray[np.float64]]]:
        """Vary a world by numbers from 0 to 1 for each path.

        Return the scenarios and the drawn values, by path.

        Raises
        ------
        ScenarioError
            If the cell lacks a path. Scenarios that break a rule appear in the list as errors.
        """
        whole = world.checked
        if isinstance(whole, ScenarioError):
            return [whole] * count, {}
        drawn = self.variation.draw(world.cell, numbers, world.own)
        runs = _apply_draws(world.cell, whole, drawn, count)
        return runs, _drop_invalid(world, whole, drawn, runs, self.variation.optional)


def plan_runs(
    base: Scenario,
    axes: Sequence[Axis],
    planner: Planner,
    *,
    repeats: int,
    like: _core.PreparedScenario | None = None,
) -> list[Plan]:
    """Plan every run: cell by cell, the samples of a cell in order.

    Each cell reuses parts shared with the previous one, the first those of `like`.

    Raises
    ------
    ScenarioError
        If a cell lacks a path, or a path has no effect in any cell. Scenarios that break a rule
        appear in their plan as errors.
    """
    plans: list[Plan] = []
    cells: list[Scenario] = []
    for points in itertools.product(*(axis.points() for axis in axes)):
        names = [point for point, _ in points]
        with _prefixed(_cell_path(names)):
            cell = base.replace({path: v for _, values in points for path, v in values.items()})
        worlds = planner.worlds(cell, names, like)
        if any(isinstance(each.checked, _core.PreparedScenario) for each in worlds):
            cells.append(cell)
        like = next(
            (w.checked for w in worlds if isinstance(w.checked, _core.PreparedScenario)), like
        )
        plans += [planner.runs(world, 0, repeats) for world in worlds]
    planner.check_effect(cells, [path for axis in axes for path in axis.paths])
    return plans


def _apply_draws(cell: Scenario, whole: Checked, drawn: Draws, count: int) -> list[Checked]:
    """Set drawn values in a checked scenario; return an error if it breaks a rule."""
    if not drawn.values or isinstance(whole, ScenarioError):
        return [whole] * count
    if any(excluded(cell, path) for path in drawn.values):
        # Clear the fields that exclude these first.
        taken = cell.replace({path: float(v[0]) for path, v in drawn.values.items()})
        whole = _validate(taken, "", None)
        if isinstance(whole, ScenarioError):
            return [whole] * count
    return whole.varied(drawn.fields, drawn.rows)


def _drop_invalid(
    world: World,
    whole: _core.PreparedScenario,
    drawn: Draws,
    runs: list[Checked],
    optional: Collection[str],
) -> dict[str, NDArray[np.float64]]:
    """Drop draws of optional paths that break a rule; their runs keep the original values.

    Return the values by path; changes `runs`.
    """
    shown = {path: values.copy() for path, values in drawn.shown.items()}
    is_optional = np.array([path in optional for path in drawn.values], dtype=bool)
    if not is_optional.any():
        return shown
    fields, rows = drawn.fields, drawn.rows
    for repeat, run in enumerate(runs):
        if not isinstance(run, ScenarioError):
            continue
        held = [world.own.get(path, read_path(world.cell, path)) for path in drawn.values]
        row = np.where(is_optional, np.array(held, dtype=float), rows[repeat])
        for column, path in enumerate(drawn.values):
            if not is_optional[column]:
                continue
            trial = row.copy()
            trial[column] = rows[repeat, column]
            (checked,) = whole.varied(fields, trial[None, :])
            if isinstance(checked, _core.PreparedScenario):
                row = trial
            elif path in shown:
                shown[path][repeat] = row[column]
        (runs[repeat],) = whole.varied(fields, row[None, :])
    return shown


def _cell_path(names: Sequence[str]) -> str:
    return f"cell[{', '.join(names)}]" if names else "cell"


def _prefix(error: ScenarioError, place: str) -> ScenarioError:
    """Prefix the path of an error."""
    return ScenarioError(f"{place}.{error.path}", error.value, error.rule)


@contextlib.contextmanager
def _prefixed(place: str) -> Iterator[None]:
    """Prefix the path of errors raised inside."""
    try:
        yield
    except ScenarioError as error:
        raise _prefix(error, place) from None


def _validate(scenario: Scenario, place: str, like: _core.PreparedScenario | None) -> Checked:
    """Validate a scenario without warnings: the batch issues each of them once."""
    try:
        return _core.PreparedScenario(scenario.to_json(), like)
    except ScenarioError as error:
        return _prefix(error, place) if place else error
