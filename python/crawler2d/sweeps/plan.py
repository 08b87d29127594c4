"""The scenario of every run of a sweep."""

from __future__ import annotations

import contextlib
import itertools
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from crawler2d import _core
from crawler2d.errors import ScenarioError
from crawler2d.parameters.paths import read_path
from crawler2d.parameters.scenario import Scenario
from crawler2d.sweeps.axes import Axis
from crawler2d.sweeps.draws import Variation, uniform_numbers

__all__ = ["Plan", "plan_runs"]


@dataclass(frozen=True, slots=True)
class Plan:
    """A planned run."""

    place: str
    """Cell and repeat, for messages."""
    scenario: Scenario
    drawn: Mapping[str, float]
    """By path."""
    checked: _core.Passed | ScenarioError

    @property
    def refused(self) -> ScenarioError | None:
        """The error if the scenario breaks a rule."""
        return self.checked if isinstance(self.checked, ScenarioError) else None

    @property
    def identity(self) -> str:
        """Identity of its scenario; empty if that breaks a rule."""
        return "" if isinstance(self.checked, ScenarioError) else self.checked.identity


def plan_runs(
    base: Scenario,
    axes: Sequence[Axis],
    variation: Variation,
    *,
    repeats: int,
    seed: int,
    like: _core.Passed | None = None,
) -> list[Plan]:
    """Make the scenario of every run: cell by cell, and the repeats of a cell in order.

    What a cell has in common with the one before it, the first with `like`, is not built again.

    Raises
    ------
    ScenarioError
        If a cell lacks a path; a scenario that breaks a rule gets a plan with its error.
    """
    streams = {path: uniform_numbers(path, seed, repeats) for path in variation.distributions}
    plans: list[Plan] = []
    last = like
    for points in itertools.product(*(axis.points() for axis in axes)):
        names = [point for point, _ in points]
        cell_place = f"cell[{', '.join(names)}]"
        with _named(cell_place):
            cell = base.replace({path: v for _, values in points for path, v in values.items()})
        whole = _checked(cell, cell_place, last)
        for repeat in range(repeats):
            place = f"cell[{', '.join([*names, f'repeat={repeat}'])}]"
            if isinstance(whole, ScenarioError):
                plans.append(Plan(place, cell, {}, whole))
                continue
            last = whole
            with _named(place):
                numbers = {path: float(stream[repeat]) for path, stream in streams.items()}
                drawn = variation.draw(cell, numbers)
                variant = cell.replace(drawn)
            checked = _checked(variant, place, whole)
            if isinstance(checked, ScenarioError) and variation.is_default:
                drawn = _legal(cell, drawn, whole)
                variant = cell.replace(drawn)
                checked = _checked(variant, place, whole)
            plans.append(Plan(place, variant, drawn, checked))
    return plans


def _legal(cell: Scenario, drawn: Mapping[str, float], whole: _core.Passed) -> dict[str, float]:
    """Drop the draws that break a rule; the cell's own values are known to be valid."""
    kept: dict[str, float] = {}
    for path, value in drawn.items():
        checked = _checked(cell.replace({**kept, path: value}), path, whole)
        is_broken = isinstance(checked, ScenarioError)
        kept[path] = read_path(cell, path) if is_broken else value
    return kept


@contextlib.contextmanager
def _named(place: str) -> Iterator[None]:
    """Prefix the path of an error with the place it is about."""
    try:
        yield
    except ScenarioError as error:
        raise ScenarioError(f"{place}.{error.path}", error.value, error.rule) from None


def _checked(
    scenario: Scenario, place: str, like: _core.Passed | None
) -> _core.Passed | ScenarioError:
    """Validate a scenario; warnings are left to the batch, which issues each once."""
    try:
        with _named(place):
            return _core.Passed(scenario.to_json(), like)
    except ScenarioError as error:
        return error
