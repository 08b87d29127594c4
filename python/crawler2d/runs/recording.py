"""What to keep of a run, and whether to ask about its stop."""

from __future__ import annotations

from typing import Literal

import numpy as np

from crawler2d.common.arrays import real_number
from crawler2d.errors import ScenarioError

__all__ = ["Recording", "recording", "yes_or_no"]

Recording = Literal["full", "summary"]


def recording(sample_interval: object, record: object) -> tuple[float, str]:
    """Check the two arguments that say what is kept."""
    if record not in ("full", "summary"):
        raise ScenarioError("record", record, "must be one of full, summary")
    return real_number(sample_interval, "sample_interval"), str(record)


def yes_or_no(value: object, path: str) -> bool:
    """Take a truth value, and nothing that merely counts as one."""
    if not isinstance(value, (bool, np.bool_)):
        raise ScenarioError(path, value, "must be True or False")
    return bool(value)
