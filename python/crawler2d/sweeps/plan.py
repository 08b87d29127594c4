"""From the design of a sweep to the scenario of every run."""

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
    """One run before it runs."""

    place: str
    """Cell and repeat, for messages."""
    scenario: Scenario
    drawn: Mapping[str, float]
    """By path."""
    refused: ScenarioError | None


def plan_runs(
    base: Scenario, axes: Sequence[Axis], variation: Variation, *, repeats: int, seed: int
) -> list[Plan]:
    """Make the scenario of every run: cell by cell, the repeats of a cell in order.

    Raises
    ------
    ScenarioError
        If a cell lacks a path; a scenario that breaks a rule is planned as refused.
    """
    streams = {path: uniform_numbers(path, seed, repeats) for path in variation.distributions}
    plans = []
    for points in itertools.product(*(axis.points() for axis in axes)):
        names = [point for point, _ in points]
        cell_place = f"cell[{', '.join(names)}]"
        with _named(cell_place):
            cell = base.replace({path: v for _, values in points for path, v in values.items()})
        refused = _refusal(cell, cell_place)
        for repeat in range(repeats):
            place = f"cell[{', '.join([*names, f'repeat={repeat}'])}]"
            if refused is not None:
                plans.append(Plan(place, cell, {}, refused))
                continue
            with _named(place):
                numbers = {path: float(stream[repeat]) for path, stream in streams.items()}
                drawn = variation.draw(cell, numbers)
                variant = cell.replace(drawn)
            broken = _refusal(variant, place)
            if broken is not None and variation.is_default:
                drawn, broken = _legal(cell, drawn), None
                variant = cell.replace(drawn)
            plans.append(Plan(place, variant, drawn, broken))
    return plans


def _legal(cell: Scenario, drawn: Mapping[str, float]) -> dict[str, float]:
    """Leave what breaks a rule at the cell's own value, which breaks none."""
    kept: dict[str, float] = {}
    for path, value in drawn.items():
        is_legal = _refusal(cell.replace({**kept, path: value}), path) is None
        kept[path] = value if is_legal else read_path(cell, path)
    return kept


@contextlib.contextmanager
def _named(place: str) -> Iterator[None]:
    """Let the path of an error begin with the place it is about."""
    try:
        yield
    except ScenarioError as error:
        raise ScenarioError(f"{place}.{error.path}", error.value, error.rule) from None


def _refusal(scenario: Scenario, place: str) -> ScenarioError | None:
    try:
        with _named(place):
            _core.canonical(scenario.to_json())  # doubts are told once, by what runs the batch
    except ScenarioError as error:
        return error
    return None
