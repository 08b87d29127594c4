"""Whether a robot gets over, in crawler2d's engines and in Chipmunk at its usual steps."""

from __future__ import annotations

import warnings
from collections.abc import Iterable, Mapping

import crawler2d as c2d
from benches.engines.driving import driven
from crawler2d.parameters.scenario import Scenario
from crawler2d.parameters.settings import Solver

__all__ = ["counts", "who_gets_over"]

_STEP, _ITERATIONS = 5e-4, 100  # [s]


def who_gets_over(
    scenarios: Iterable[Scenario], solvers: Mapping[str, Solver]
) -> dict[str, list[bool]]:
    """Say which of the scenarios it does with each solver, and in Chipmunk.

    Raises
    ------
    ImportError
        If pymunk is missing.
    """
    gets: dict[str, list[bool]] = {name: [] for name in (*solvers, "Chipmunk")}
    for scenario in scenarios:
        for name, solver in solvers.items():
            gets[name].append(_gets_over(scenario.replace({"solver": solver})))
        gets["Chipmunk"].append(_gets_over_in_chipmunk(scenario))
    return gets


def counts(gets_over: Mapping[str, list[bool]]) -> list[str]:
    """Write how many do, by solver."""
    return [f"{sum(each)} of {len(each)}" for each in gets_over.values()]


def _gets_over(scenario: Scenario) -> bool:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", c2d.ScenarioWarning)
        run = c2d.simulate(scenario, record="summary", trials=None)
    return run.outcome is c2d.Outcome.CLEARED


def _gets_over_in_chipmunk(scenario: Scenario) -> bool:
    from benches.engines.engine_pymunk import Pymunk  # noqa: PLC0415 - loads Chipmunk

    return bool(driven(Pymunk(_STEP, iterations=_ITERATIONS), scenario)["end"] == "cleared")
