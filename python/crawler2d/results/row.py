"""What came of one run, in short: the row that sweeps, stores, batches and studies share."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from crawler2d.errors import Crawler2dError, ScenarioError, SimulationDiverged, own_error
from crawler2d.results.diagnosis import Diagnosis
from crawler2d.results.record import Record

__all__ = ["NO_RESULT", "Row", "diagnosis_json", "read_diagnosis"]

NO_RESULT = ("diverged", "refused", "failed")
"""Outcomes of runs without a result: non-finite state, broken rule, any other error."""


@dataclass(frozen=True, slots=True)
class Row:
    """One run.

    Attributes
    ----------
    identity : str
        Of its scenario; "" if that breaks a rule.
    scenario : str
        Its JSON text; "" if it breaks a rule.
    outcome : str
        How it ended, or one of `NO_RESULT`.
    metrics : mapping of str to float
        As in `Run.metrics`; empty without a result.
    diagnosis : mapping, optional
        Of a stop, as `Diagnosis.from_core` reads it.
    wall_time : float
        [s] Computing time on one thread; nan without a result.
    error : Crawler2dError, optional
        Why there is no result.
    """

    identity: str
    scenario: str
    outcome: str
    metrics: Mapping[str, float]
    diagnosis: Mapping[str, Any] | None = None
    wall_time: float = float("nan")
    error: Crawler2dError | None = None

    @classmethod
    def of_result(cls, identity: str, scenario: str, result: Mapping[str, Any]) -> Row:
        """Take what the core returned for a scenario."""
        error = result.get("error")
        if error is not None:
            return cls.of_error(own_error(error), identity, scenario)
        return cls(
            identity,
            scenario,
            str(result["outcome"]),
            result["metrics"],
            result["diagnosis"],
            result["wall_time"],
        )

    @classmethod
    def of_error(cls, error: Crawler2dError, identity: str = "", scenario: str = "") -> Row:
        """Take a run without a result."""
        diverged, refused, failed = NO_RESULT
        match error:
            case SimulationDiverged():
                outcome = diverged
            case ScenarioError():
                outcome = refused
            case _:  # out of memory, or a fault of the program
                outcome = failed
        return cls(identity, scenario, outcome, {}, error=error)

    @classmethod
    def of_record(cls, run: Record) -> Row:
        """Take a run that was simulated alone or in a batch."""
        try:
            text, identity = run.scenario.to_json(), run.scenario.identity
        except ScenarioError:
            text = identity = ""
        if run.error is not None:
            return cls.of_error(run.error, identity, text)
        why = None if run.diagnosis is None else run.diagnosis.to_plain()
        return cls(identity, text, str(run.outcome), run.metrics, why, run.wall_time)

    def why(self) -> Diagnosis | None:
        """Return the diagnosis of a stop."""
        return None if self.diagnosis is None else Diagnosis.from_core(self.diagnosis)


def diagnosis_json(diagnosis: Mapping[str, Any]) -> str:
    """Write a diagnosis as JSON, no bit lost."""
    return json.dumps(diagnosis, default=np.ndarray.tolist, separators=(",", ":"))


def read_diagnosis(text: str) -> dict[str, Any]:
    """Read what `diagnosis_json` wrote."""
    plain: dict[str, Any] = json.loads(text)
    plain["contacts"] = {name: np.array(column) for name, column in plain["contacts"].items()}
    plain["position"] = tuple(plain["position"])
    for tried in plain["trials"]:
        tried.update({name: tuple(tried[name]) for name in ("position", "flipper_angles")})
    for found in (plain, *plain["trials"]):
        if inside := found.get("intrusion"):
            inside.update({name: tuple(inside[name]) for name in ("edges", "bodies", "body_kinds")})
    if plain["mechanism"] == "bellied":
        # Builds that called it so counted ground that only the belly rests on.
        plain["mechanism"] = None
    return plain
