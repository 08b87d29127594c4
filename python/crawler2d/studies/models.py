"""Models that a study compares: what each replaces in the scenario."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from crawler2d.parameters.scenario import Scenario
from crawler2d.sweeps.compare import Variant, variants

__all__ = ["Models", "read_models"]

Models = Mapping[Any, Variant] | Sequence[Variant]
"""By label, or objects that label themselves; see `compare`."""


def read_models(scenario: Scenario, models: Models | None) -> dict[Any, Mapping[str, Any]]:
    """Return the fields that each model replaces, by label; None is the scenario's own track."""
    if models is None:
        return {scenario.robot.track.in_words: {}}
    return variants(models)
