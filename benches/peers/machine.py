"""The machine on which a result was measured."""

from __future__ import annotations

import datetime
import os
import platform
from collections.abc import Mapping
from pathlib import Path
from typing import Any


def describe(versions: Mapping[str, str]) -> dict[str, Any]:
    """Name the processor, its load, the interpreter and the measured versions."""
    return {
        "date": datetime.datetime.now(datetime.UTC).date().isoformat(),
        "processor": _processor(),
        "cores": os.cpu_count(),
        "load": os.getloadavg()[0] if hasattr(os, "getloadavg") else None,
        "system": f"{platform.system()} {platform.machine()}",
        "python": platform.python_version(),
        "versions": dict(versions),
    }


def sentence(machine: Mapping[str, Any], wall: float) -> str:
    """Write what `describe` found, and how long [s] the measurement took, for a report."""
    versions = ", ".join(f"{name} ({version})" for name, version in machine["versions"].items())
    load = "unknown" if machine["load"] is None else f"{machine['load']:.1f}"
    return (
        f"Measured on {machine['date']} in {wall / 60.0:.0f} minutes: {machine['processor']},"
        f" {machine['cores']} cores, load {load} at the beginning, {machine['system']},"
        f" Python {machine['python']}. Versions: {versions}."
    )


def _processor() -> str:
    info = Path("/proc/cpuinfo")
    if info.exists():
        for line in info.read_text(encoding="utf-8").splitlines():
            if line.startswith("model name"):
                return line.split(":", 1)[1].strip()
    return platform.processor() or "unknown"
