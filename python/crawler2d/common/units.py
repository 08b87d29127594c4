"""Units of the fields of a scenario and of the metrics of a run."""

from __future__ import annotations

import textwrap

from crawler2d import _core

__all__ = ["FIELDS", "METRICS", "RENAMED_METRICS", "table_of_metrics", "unit_of"]

_FIELDS_BY_UNIT = {
    "m": (
        "accuracy approach axle_distance barrier_height barrier_thickness base_thickness belly"
        " center_of_mass cycling_distance depth discs edge_radius escape_distance front_radius"
        " gauge goal grouser_height grouser_pitch grouser_thickness height intrusion_depth"
        " length placements plate_thickness points post prediction_distance radius rear_radius"
        " rise root_radius run stationary_distance thickness tip_radius tip_thickness"
        " track_phase wheel_radius width"
    ),
    "s": "clear_time duration escape_time stop_window time_step",
    "rad": (
        "angle barrier_yaw clear_angle edge_angle level_angle push_angle reach_angle sweep_angle"
        " tip_over_angle yaw"
    ),
    "rad/s": "rate_limit",
    "kg": "mass track_mass",
    "kg m^2": "moment_of_inertia rotor_inertia",
    "m/s": "max_push_speed max_speed no_load_speed speed",
    "m/s^2": "gravity max_acceleration max_deceleration",
    "N": "pre_tension",
    "N/m": "tensioner_stiffness",
    "N s/m": "tensioner_damping",
    "N m": "max_torque",
    "N m s/rad": "gain pin_damping",
    "N m/rad": "integral pin_stiffness",
    "Hz": "contact_frequency",
    "1": (
        "belly_load contact_damping_ratio count creep_from creep_to friction grouser_count"
        " imbalance intrusion_load iterations levels mean_imbalance phase_fraction posts"
        " restitution return_roller_count road_wheel_count seed shoe_count skid_friction"
        " segment_friction sliding_speed stationary_windows stop_pitches stop_progress torque_limit"
        " wheel_count"
    ),
}

FIELDS = {name: unit for unit, names in _FIELDS_BY_UNIT.items() for name in names.split()}
"""Unit of every number of a scenario, by the name of its field."""

_FIELDS_BY_PLACE = {
    "robot.flippers.torque_limit": "N m",
    "drive.gait.front": "rad",
    "drive.gait.rear": "rad",
}

_COLUMNS = {
    "drive.schedule": ("s", "m/s"),
    "drive.gait.schedule": ("s", "rad"),
    "robot.drivetrain.torque_curve": ("m/s", "N m"),
}
"""Units by column, for arrays whose columns differ."""


def unit_of(path: str) -> str | None:
    """Look up the unit of the field or element at a path; None if it is not a number."""
    field, *indices = path.replace("]", "").split("[")
    if field in _COLUMNS:
        return _COLUMNS[field][int(indices[1])] if len(indices) == 2 else None
    return _FIELDS_BY_PLACE.get(field, FIELDS.get(field.rpartition(".")[2]))


METRICS = {name: unit for name, unit, _ in _core.metrics()}
"""Unit of every metric of a run."""

RENAMED_METRICS = _core.renamed_metrics()
"""Map former names of metrics to current ones."""


def table_of_metrics() -> str:
    """Write name, unit and meaning of every metric as a table for a docstring."""
    rule = f"{'=' * 23}  {'=' * 5}  {'=' * 63}"
    rows = [rule, f"{'name':23}  {'unit':5}  meaning", rule]
    for name, unit, meaning in _core.metrics():
        first, *more = textwrap.wrap(meaning, 63)
        rows.append(f"{f'`{name}`':23}  {unit.replace('1', '-'):5}  {first}")
        rows += [f"{'':32}{line}" for line in more]
    return "\n".join([*rows, rule])
