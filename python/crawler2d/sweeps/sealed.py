"""A run as a row of a store: columns of text, and a checksum over all of them."""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Sequence
from typing import Any

from crawler2d._core import build_info
from crawler2d.errors import Crawler2dError, SimulationDiverged
from crawler2d.results.outcome import Outcome
from crawler2d.results.row import NO_RESULT, Row, diagnosis_json, read_diagnosis

__all__ = ["COLUMNS", "Kept", "OtherBuild", "sealed", "unsealed", "values_of"]

COLUMNS = (
    "identity, build, trials, outcome, metrics, diagnosis, wall_time, error, scenario, checksum"
)
"""In the order of the values of `values_of`."""

Kept = tuple[Row, str, tuple[str, ...]]
"""A run, its build and its trials."""

_OUTCOMES = frozenset({*map(str, Outcome), *NO_RESULT})
# What a run ends with every time, so that it is kept; nothing else is made of a name in a file.
_ERRORS: dict[str, type[Crawler2dError]] = {"SimulationDiverged": SimulationDiverged}
# What reading a text raises that is no such row.
_UNREADABLE = (AttributeError, LookupError, RecursionError, TypeError, ValueError)


def values_of(row: Row, build: str, trials: str) -> tuple[Any, ...]:
    """Return the values of a row, in the order of `COLUMNS`."""
    figures = {name: None if math.isnan(value) else value for name, value in row.metrics.items()}
    return sealed(
        (
            row.identity,
            build,
            trials,
            row.outcome,
            json.dumps(figures, separators=(",", ":")),
            None if row.diagnosis is None else diagnosis_json(row.diagnosis),
            None if math.isnan(row.wall_time) else row.wall_time,
            None if row.error is None else json.dumps([type(row.error).__name__, *row.error.args]),
            row.scenario,
        )
    )


def sealed(values: Sequence[Any]) -> tuple[Any, ...]:
    """Append their checksum to the values of a row."""
    # JSON keeps apart where a value ends and of which type it is; what it does not know, such as
    # the bytes of a damaged column, is in no sound row.
    text = json.dumps(values, default=repr)
    return (*values, hashlib.sha256(text.encode()).hexdigest())


class OtherBuild(ValueError):
    """A row is as it was written, by another build, but this one cannot read it."""


def unsealed(values: Sequence[Any]) -> Kept:
    """Return the run in a row, its build and its trials.

    Raises
    ------
    OtherBuild
        If it has outcomes or diagnoses of another build, which this one does not know.
    ValueError
        If the row is not as it was written; it says why.
    """
    if sealed(values[:-1]) != tuple(values):
        raise ValueError("its checksum is another")
    identity, build, trials, outcome, metrics, diagnosis, wall_time, error, scenario, _ = values
    # What is stored is the canonical text, so this holds for every build.
    if hashlib.sha256(str(scenario).encode()).hexdigest() != identity:
        raise ValueError("its scenario does not hash to its identity")
    try:
        if outcome not in _OUTCOMES or (error is None) == (outcome in NO_RESULT):
            with_error = "without" if error is None else "with"
            raise ValueError(f"{str(outcome)[:40]!r} is no outcome {with_error} an error")
        row = Row(
            identity,
            scenario,
            outcome,
            {name: _number(value) for name, value in json.loads(metrics).items()},
            None if diagnosis is None else read_diagnosis(diagnosis),
            _number(wall_time),
            None if error is None else _error(*json.loads(error)),
        )
        row.why()
        return row, str(build), tuple(map(str, json.loads(trials)))
    except _UNREADABLE as fault:
        kind = ValueError if build == build_info()["build_id"] else OtherBuild
        raise kind(f"it cannot be read ({type(fault).__name__}: {fault})") from fault


def _number(value: float | None) -> float:
    if value is None:
        return math.nan
    if type(value) not in {float, int}:
        raise TypeError(f"{value!r} is no number")
    return value


def _error(name: str, *arguments: Any) -> Crawler2dError:
    return _ERRORS[name](*arguments)
