"""What to keep of a run."""

from __future__ import annotations

from typing import Literal

from crawler2d._arrays import real_number
from crawler2d.errors import ScenarioError

__all__ = ["Recording", "recording"]

Recording = Literal["full", "summary"]


def recording(sample_interval: object, record: object) -> tuple[float, str]:
    """Check the two arguments that say what is kept."""
    if record not in ("full", "summary"):
        raise ScenarioError("record", record, "must be one of full, summary")
    return real_number(sample_interval, "sample_interval"), str(record)
