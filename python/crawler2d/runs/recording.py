"""Arguments that say what to keep of a run."""

from __future__ import annotations

from typing import Literal

import numpy as np

from crawler2d.common.arrays import real_number
from crawler2d.errors import ScenarioError

__all__ = ["Recording", "recording", "yes_or_no"]

Recording = Literal["full", "summary"]


def recording(sample_interval: object, record: object) -> tuple[float, str]:
    """Check the arguments that say what to keep of a run."""
    if record not in ("full", "summary"):
        raise ScenarioError("record", record, "must be one of full, summary")
    return real_number(sample_interval, "sample_interval"), str(record)


def yes_or_no(value: object, path: str) -> bool:
    """Accept True or False only, nothing that is merely truthy."""
    if not isinstance(value, (bool, np.bool_)):
        raise ScenarioError(path, value, "must be True or False")
    return bool(value)
