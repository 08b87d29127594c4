"""Runs that end unlike, in a third engine: Chipmunk, through pymunk."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from benches.agreement.drawing import drawn
from benches.engines.driving import driven
from benches.engines.telling import tell
from crawler2d.errors import ScenarioError
from crawler2d.parameters.scenario import Scenario

__all__ = ["THIRD", "ask", "in_chipmunk", "read_third"]

THIRD = Path(__file__).with_name("chipmunk.json")
_STEP, _ITERATIONS = 5e-5, 100  # [s]
"""A tenth of what benches/engines takes for fine: steps at which blows are settled there."""


def read_third(path: Path = THIRD) -> dict[str, str]:
    """Read how the runs ended, by the robot's number."""
    found: dict[str, str] = json.loads(path.read_text(encoding="utf-8")) if path.exists() else {}
    return found


def ask(pairs: Sequence[dict[str, Any]], path: Path = THIRD) -> None:
    """Make the runs of pairs that end unlike, but for those that are there.

    Raises
    ------
    ImportError
        If pymunk is missing.
    """
    found = read_third(path)
    for number in (pair["number"] for pair in pairs if "finer" in pair):
        if str(number) not in found:
            found[str(number)] = in_chipmunk(drawn(number)[1])
            path.write_text(json.dumps(found) + "\n", encoding="utf-8")
            tell(f"robot {number}: {found[str(number)]}")


def in_chipmunk(scenario: Scenario) -> str:
    """Say how a scenario ends in Chipmunk, finely.

    Raises
    ------
    ImportError
        If pymunk is missing.
    """
    from benches.engines.engine_pymunk import Pymunk  # noqa: PLC0415 - loads Chipmunk

    try:
        return str(driven(Pymunk(_STEP, iterations=_ITERATIONS), scenario)["end"])
    except ScenarioError:  # a ridge, which is not drawn there
        return "not held"
