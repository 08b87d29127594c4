"""One pair of runs a robot, kept in a file as they end."""

from __future__ import annotations

import json
import warnings
from pathlib import Path
from typing import Any

import crawler2d as c2d
from benches.agreement.drawing import drawn
from benches.engines.telling import tell
from crawler2d.parameters.scenario import Scenario
from crawler2d.parameters.settings import Solver
from crawler2d.results.findings import Balance
from crawler2d.runs.run import Run

__all__ = ["RESULTS", "finer", "read", "run"]

RESULTS = Path(__file__).with_name("results.jsonl")
_TOLD = 10  # robots between two lines of progress
_FINER = {
    "own": Solver(accuracy=1e-8),
    "fixed": Solver(time_step=5e-5),
    "rapier": Solver(engine="rapier", time_step=3.125e-5),
}
"""A thirtieth of the default accuracy, short fixed steps, and a quarter of the default step."""


def read(path: Path) -> list[dict[str, Any]]:
    """Read the pairs that were made."""
    if not path.exists():
        return []
    return [json.loads(line) for line in path.read_text(encoding="utf-8").splitlines()]


def run(robots: int, path: Path) -> None:
    """Make the pairs that a file does not have yet."""
    done = len(read(path))
    with path.open("a", encoding="utf-8") as file:
        for number in range(done, robots):
            file.write(json.dumps(_pair(number)) + "\n")
            file.flush()
            if number % _TOLD == _TOLD - 1:
                tell(f"{number + 1} of {robots} robots")


def _pair(number: int) -> dict[str, Any]:
    """Make a pair; one that ends unlike is made again, finer."""
    model, scenario = drawn(number)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", c2d.ScenarioWarning)
        check = c2d.simulate(scenario, record="summary", trials=None).cross_check()
        pair: dict[str, Any] = {
            "number": number,
            "model": model,
            "ends": [_end(check.run), _end(check.other)],
            "apart": check.distance,
            "turn": check.turn,
            "parted_at": check.parted_at,
            "balances": [_held(balance) for balance in check.balances],
        }
        if len({end["gets_over"] for end in pair["ends"]}) == 2:
            pair["finer"] = finer(scenario)
    return pair


def _end(run: Run) -> dict[str, Any]:
    return {
        "outcome": str(run.outcome),
        "gets_over": run.outcome is c2d.Outcome.CLEARED,
        "stops": run.diagnosis is not None,
        "penetration": run.metrics["max_penetration"],
    }


def finer(scenario: Scenario) -> dict[str, str]:
    """Say how a scenario ends in each engine, finer."""
    solved = {name: scenario.replace({"solver": solver}) for name, solver in _FINER.items()}
    return {
        name: str(c2d.simulate(each, record="summary", trials=None).outcome)
        for name, each in solved.items()
    }


def _held(balance: Balance | None) -> bool | None:
    return None if balance is None else balance.holds
