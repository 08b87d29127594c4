"""The words and metrics that a page shows of a run."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from crawler2d.common.units import METRICS

if TYPE_CHECKING:
    from crawler2d.results.record import Record

__all__ = ["all_figures", "figures", "sentence", "verdict"]

# metric, label, factor from the metric's unit, unit shown, decimals
_FIGURES = (
    ("time", "simulated time", 1.0, "s", 2),
    ("time_to_clear", "cleared after", 1.0, "s", 2),
    ("distance", "distance", 1.0, "m", 3),
    ("track_distance", "track travel", 1.0, "m", 3),
    ("max_angle", "largest angle, nose up", math.degrees(1.0), "°", 1),
    ("min_angle", "largest angle, nose down", -math.degrees(1.0), "°", 1),
    ("drive_work", "motor work", 1.0, "J", 1),
    ("stopped_time", "time in stops", 1.0, "s", 2),
    ("intrusion_depth", "intrusion depth at the end", 1e3, "mm", 1),
    ("intrusion_force", "intrusion force at the end", 1.0, "N", 0),
)
# Shown only if not zero.
_RARE = {"time_to_clear", "stopped_time", "intrusion_depth", "intrusion_force", "min_angle"}


def sentence(run: Record) -> str:
    """Say why the robot did not clear, or why there is no result; see `Run.reason`."""
    return run.reason


def verdict(run: Record) -> str:
    """Name the outcome; empty if there is none."""
    return "" if run.outcome is None else str(run.outcome).replace("_", " ")


def figures(run: Record) -> list[tuple[str, str]]:
    """Choose the metrics of most interest: label, and value with unit."""
    chosen = []
    for name, label, scale, unit, digits in _FIGURES:
        value = run.metrics.get(name, 0.0)
        shown = f"{scale * value:z.{digits}f}"
        if name in _RARE and (not math.isfinite(value) or float(shown) == 0.0):
            continue
        chosen.append((label, f"{shown}{'' if unit == '°' else ' '}{unit}"))
    return chosen


def all_figures(run: Record) -> list[tuple[str, str]]:
    """List every metric by its own name, in its own unit."""
    return [(name, f"{value:.6g} {METRICS.get(name, '')}") for name, value in run.metrics.items()]
