"""Whether a robot gets over, in crawler2d's engines and in Chipmunk at its usual steps."""

from __future__ import annotations

import warnings

import crawler2d as c2d
from benches.engines.driving import driven
from crawler2d.parameters.scenario import Scenario

__all__ = ["gets_over", "gets_over_in_chipmunk"]

_STEP, _ITERATIONS = 5e-4, 100  # [s]


def gets_over(scenario: Scenario) -> bool:
    """Say whether it does in the engine of the scenario."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", c2d.ScenarioWarning)
        run = c2d.simulate(scenario, record="summary", trials=None)
    return run.outcome is c2d.Outcome.CLEARED


def gets_over_in_chipmunk(scenario: Scenario) -> bool:
    """Say whether it does in Chipmunk.

    Raises
    ------
    ImportError
        If pymunk is missing.
    """
    from benches.engines.engine_pymunk import Pymunk  # noqa: PLC0415 - loads Chipmunk

    return bool(driven(Pymunk(_STEP, iterations=_ITERATIONS), scenario)["end"] == "cleared")
