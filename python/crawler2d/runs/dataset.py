"""A run as an xarray data set: dimensions, units, provenance."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from crawler2d._core import build_info
from crawler2d.common.extras import extra

if TYPE_CHECKING:
    import xarray

    from crawler2d.results.record import Record

__all__ = ["UNITS", "build_attributes", "to_dataset"]

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
    "track_tension": "N",
    "shoe_poses": "m, m, rad",
    "flipper_angles": "rad",
    "flipper_torques": "N m",
}
"""Unit of every array of a run."""

_DIMENSIONS = {
    "position": ("axis",),
    "velocity": ("axis",),
    "drive_speeds": ("drive",),
    "drive_positions": ("drive",),
    "drive_forces": ("drive",),
    "shoe_poses": ("shoe", "pose"),
    "flipper_angles": ("flipper",),
    "flipper_torques": ("flipper",),
}


def build_attributes(build: Mapping[str, Any] | None = None) -> dict[str, str | int]:
    """Return the build of a core (None: this one) as attributes of a data set."""
    return {f"build_{name}": value for name, value in (build or build_info()).items()}


def to_dataset(run: Record) -> xarray.Dataset:
    """Copy the history of a run to a labelled data set; see `Run.to_xarray`."""
    xr = extra("xarray", "analysis")
    variables = {}
    for name, unit in UNITS.items():
        values = getattr(run, name)
        if name == "time" or not values.size:  # shoe_poses is empty for tracks without shoes
            continue
        dimensions = ("time", *_DIMENSIONS.get(name, ()))
        attributes = {"units": unit, "long_name": name.replace("_", " ")}
        variables[name] = (dimensions, values.copy(), attributes)
    labels = {"axis": ["x", "y"], "pose": ["x", "y", "angle"]}
    used = {dimension for dimensions, *_ in variables.values() for dimension in dimensions}
    dataset: xarray.Dataset = xr.Dataset(
        variables,
        coords={
            "time": ("time", run.time.copy(), {"units": "s", "long_name": "time"}),
            **{name: label for name, label in labels.items() if name in used},
        },
        attrs={
            "outcome": str(run.outcome),
            **run.metrics,
            "scenario": run.scenario.to_json(),
            "identity": run.scenario.identity,
            **build_attributes(run.build),
        },
    )
    return dataset
