"""The scenario of every run of a sweep: cell by cell, sample by sample, repeat by repeat."""

from __future__ import annotations

import contextlib
import itertools
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from crawler2d import _core
from crawler2d.errors import ScenarioError
from crawler2d.parameters.paths import excluded, read_path
from crawler2d.parameters.scenario import Scenario
from crawler2d.variation.draws import Drawn, Variation

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from crawler2d.sweeps.axes import Axis

__all__ = ["Plan", "plan_runs"]

Checked = _core.Passed | ScenarioError
"""A scenario that can be run, or the rule that it breaks."""

_UNKNOWN = "unknown "
"""What makes the numbers of the unknowns others than those of the repeats."""


@dataclass(frozen=True, slots=True)
class Plan:
    """The planned runs of one cell with one sample of the unknowns.

    Attributes
    ----------
    labels : tuple of str
        Cell and sample, for messages.
    checked : list of Checked
        One a repeat.
    drawn : mapping of str to ndarray, shape (repeats,)
        By path of `vary`; empty if the cell breaks a rule.
    sampled : mapping of str to float
        By path of `unknown`.
    """

    labels: tuple[str, ...]
    checked: list[Checked]
    drawn: Mapping[str, NDArray[np.float64]]
    sampled: Mapping[str, float]

    def place(self, repeat: int) -> str:
        """Name one of its runs, for messages."""
        return _place([*self.labels, f"repeat={repeat}"])


def plan_runs(
    base: Scenario,
    axes: Sequence[Axis],
    variation: Variation,
    unknowns: Variation,
    *,
    repeats: int,
    samples: int,
    seed: int,
    like: _core.Passed | None = None,
) -> list[Plan]:
    """Make the scenario of every run: cell by cell, the samples of a cell in order.

    What a cell has in common with the one before it, the first with `like`, is not built again.

    Raises
    ------
    ScenarioError
        If a cell lacks a path; a scenario that breaks a rule stands in its plan as its error.
    """
    numbers = variation.numbers(seed, repeats)
    outer = unknowns.numbers(seed, samples, kind=_UNKNOWN)
    plans: list[Plan] = []
    last = like
    for points in itertools.product(*(axis.points() for axis in axes)):
        names = [point for point, _ in points]
        with _named(_place(names)):
            fields = {path: v for _, values in points for path, v in values.items()}
            cell = base.replace(fields)
            whole = _opened(cell, _place(names), last)
            if isinstance(whole, _core.Passed):
                last = whole
            sampled = unknowns.draw(cell, outer) if unknowns.distributions else None
            wholes = _varied(cell, whole, sampled, samples)
        for sample, world in enumerate(wholes):
            labels = (*names, f"sample={sample}") if sampled else tuple(names)
            place = _place(labels)
            own = {path: float(v[sample]) for path, v in sampled.values.items()} if sampled else {}
            shown = {path: float(v[sample]) for path, v in sampled.shown.items()} if sampled else {}
            if isinstance(world, ScenarioError):
                refused = world if world is whole else _moved(world, place)
                plans.append(Plan(labels, [refused] * repeats, {}, shown))
                continue
            with _named(place):
                drawn = variation.draw(cell, numbers, own)
                runs = _varied(cell, world, drawn, repeats)
                kept = _dropped(cell, world, drawn, runs, own=own, gives_way=variation.gives_way)
            plan = Plan(labels, runs, kept, shown)
            for repeat, run in enumerate(runs):
                if isinstance(run, ScenarioError):
                    runs[repeat] = _moved(run, plan.place(repeat))
            plans.append(plan)
    return plans


def _varied(cell: Scenario, whole: Checked, drawn: Drawn | None, count: int) -> list[Checked]:
    """Set what was drawn in a checked scenario; one that breaks a rule is an error."""
    if drawn is None or not drawn.values or isinstance(whole, ScenarioError):
        return [whole] * count
    if any(excluded(cell, path) for path in drawn.values):
        # The fields that exclude these are taken off first, whatever value it is that comes.
        taken = cell.replace({path: float(v[0]) for path, v in drawn.values.items()})
        whole = _opened(taken, "", None)
        if isinstance(whole, ScenarioError):
            return [whole] * count
    return whole.varied(drawn.fields, drawn.rows)


def _dropped(
    cell: Scenario,
    whole: _core.Passed,
    drawn: Drawn,
    runs: list[Checked],
    *,
    own: Mapping[str, float],
    gives_way: Collection[str],
) -> dict[str, NDArray[np.float64]]:
    """Drop the draws that break a rule and may be dropped: those runs keep their own values.

    Returns what was drawn, by path, with these own values; `runs` is changed.
    """
    shown = {path: values.copy() for path, values in drawn.shown.items()}
    may = [path in gives_way for path in drawn.values]
    if not any(may):
        return shown
    fields, rows = drawn.fields, drawn.rows
    for repeat, run in enumerate(runs):
        if not isinstance(run, ScenarioError):
            continue
        row = np.array([own.get(path, read_path(cell, path)) for path in drawn.values], dtype=float)
        for column, path in enumerate(drawn.values):
            trial = row.copy()
            trial[column] = rows[repeat, column]
            (checked,) = whole.varied(fields, trial[None, :])
            if isinstance(checked, _core.Passed) or not may[column]:
                row = trial
            elif path in shown:
                shown[path][repeat] = row[column]
        (runs[repeat],) = whole.varied(fields, row[None, :])
    return shown


def _place(names: Sequence[str]) -> str:
    return f"cell[{', '.join(names)}]" if names else "cell"


def _moved(error: ScenarioError, place: str) -> ScenarioError:
    """Prefix the path of an error with the place it is about."""
    return ScenarioError(f"{place}.{error.path}", error.value, error.rule)


@contextlib.contextmanager
def _named(place: str) -> Iterator[None]:
    """Prefix the path of an error with the place it is about."""
    try:
        yield
    except ScenarioError as error:
        raise _moved(error, place) from None


def _opened(scenario: Scenario, place: str, like: _core.Passed | None) -> Checked:
    """Validate a scenario; warnings are left to the batch, which issues each once."""
    try:
        return _core.Passed(scenario.to_json(), like)
    except ScenarioError as error:
        return _moved(error, place) if place else error
