"""A run as an xarray data set: dimensions, units, provenance."""

from __future__ import annotations

from typing import TYPE_CHECKING

from crawler2d._core import build_info
from crawler2d._extras import extra

if TYPE_CHECKING:
    import xarray

    from crawler2d.run import Run

__all__ = ["UNITS", "to_dataset"]

UNITS = {
    "time": "s",
    "position": "m",
    "velocity": "m/s",
    "chassis_angle": "rad",
    "angular_velocity": "rad/s",
    "commanded_speed": "m/s",
    "track_speed": "m/s",
    "track_position": "m",
    "slip_ratio": "1",
    "tractive_effort": "N",
    "drive_force": "N",
    "drive_speeds": "m/s",
    "drive_positions": "m",
    "drive_forces": "N",
}
"""Unit of every array of a run."""

_SECOND_DIMENSION = {
    "position": "axis",
    "velocity": "axis",
    "drive_speeds": "drive",
    "drive_positions": "drive",
    "drive_forces": "drive",
}


def to_dataset(run: Run) -> xarray.Dataset:
    """Copy the history of a run to a labelled data set; see `Run.to_xarray`."""
    xr = extra("xarray", "analysis")
    variables = {}
    for name, unit in UNITS.items():
        if name == "time":
            continue
        second = _SECOND_DIMENSION.get(name)
        dimensions = ("time",) if second is None else ("time", second)
        attributes = {"units": unit, "long_name": name.replace("_", " ")}
        variables[name] = (dimensions, getattr(run, name).copy(), attributes)
    dataset: xarray.Dataset = xr.Dataset(
        variables,
        coords={
            "time": ("time", run.time.copy(), {"units": "s", "long_name": "time"}),
            "axis": ["x", "y"],
        },
        attrs={
            "outcome": str(run.outcome),
            **run.metrics,
            "scenario": run.scenario.to_json(),
            "identity": run.scenario.identity,
            **{f"build_{name}": value for name, value in build_info().items()},
        },
    )
    return dataset
