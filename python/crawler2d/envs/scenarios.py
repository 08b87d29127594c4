"""Scenarios of the registered environments, and what varies between episodes."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from crawler2d.common.keywords import read_choice
from crawler2d.errors import ScenarioError
from crawler2d.parameters.scenario import Scenario
from crawler2d.parameters.settings import Drive
from crawler2d.parameters.terrain import Terrain
from crawler2d.presets import robots, terrains
from crawler2d.variation import variability
from crawler2d.variation.distributions import uniform

__all__ = ["read_scenario"]

_NAMES = ("flipper_climb", "step_field")

_DRIVE = Drive(speed=0.39)
"""[m/s] A little below the robot's limit, so that the speed can vary both ways."""

_DURATION = 10.0
"""[s] Twice the time of a robot that drives without pauses."""


def read_scenario(
    given: object, terrain: Terrain | None, randomize: Mapping[str, Any] | None
) -> tuple[Scenario, Mapping[str, Any] | None]:
    """Return the scenario of an environment and its distributions.

    Raises
    ------
    ScenarioError
        If it is neither a scenario nor the name of one, or its drive has commands of its own.
    """
    if isinstance(given, Scenario):
        scenario = given
    else:
        scenario, own = _named(read_choice(given, "scenario", _NAMES))
        if terrain is None and randomize is None:
            randomize = own
    if terrain is not None:
        scenario = scenario.replace({"terrain": terrain})
    for name in ("gait", "schedule"):
        value = getattr(scenario.drive, name)
        if value is not None:
            raise ScenarioError(f"drive.{name}", value, "must be None: the policy drives")
    if not scenario.drive.speed > 0.0:
        rule = "must be > 0 m/s: it is the speed of a full action"
        raise ScenarioError("drive.speed", scenario.drive.speed, rule)
    return scenario, randomize


def _named(name: str) -> tuple[Scenario, Mapping[str, Any]]:
    run_to_run = variability.of_start() | variability.of_contact()
    if name == "step_field":
        scenario = Scenario(
            robots.absolem(), terrains.random_stepfield(), drive=_DRIVE, duration=2 * _DURATION
        )
        return scenario, run_to_run | variability.of_field()
    scenario = Scenario(robots.absolem(), terrains.step(0.25), drive=_DRIVE, duration=_DURATION)
    heights = {"terrain.height": uniform(0.1, 0.4)}
    return scenario, run_to_run | heights
