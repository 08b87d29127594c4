"""In which range the unknown figures of each preset lie, and why."""

from __future__ import annotations

from collections.abc import Mapping

from crawler2d.variation.distributions import Distribution, scaled, shifted

__all__ = ["GENERAL", "RANGES"]

Range = tuple[Distribution, str]

_X, _Y = "robot.center_of_mass[0]", "robot.center_of_mass[1]"
_TORQUE, _BELLY = "robot.drivetrain.max_torque", "robot.belly[*][1]"

_OF_FILE = "the sum over the links of its file; 10 mm for what is mounted or left off"
_MOTORS = "the preset's is an estimate: half to twice"

GENERAL: Mapping[str, Range] = {
    _X: (shifted(-0.1, 0.1, of="robot.outline.axle_distance"), "a tenth of the axle distance"),
    _Y: (shifted(-0.05, 0.05, of="robot.outline.axle_distance"), "a twentieth of it"),
    _TORQUE: (scaled(0.5, 2.0), "half to twice"),
    _BELLY: (shifted(-0.1, 0.1, of="robot.outline.front_radius"), "a tenth of the radius"),
}
"""Of a robot that is no preset: general estimates."""

RANGES: Mapping[str, Mapping[str, Range]] = {
    "engineer": {
        _X: (
            shifted(-0.04, 0.04),
            "the preset's is an estimate; its arm of 8.85 kg (eng.xacro) moves the whole by 40 mm"
            " as it reaches 96 mm either way",
        ),
        _Y: (
            shifted(-0.02, 0.02),
            "the preset's is an estimate; the arm raised or lowered by 48 mm moves the whole so",
        ),
        _TORQUE: (scaled(0.5, 2.0), _MOTORS),
        _BELLY: (
            shifted(-0.014, 0.010),
            "the preset's is an estimate: 20 to 44 mm above level ground",
        ),
    },
    "absolem": {
        _X: (shifted(-0.01, 0.01), _OF_FILE),
        _Y: (shifted(-0.01, 0.01), _OF_FILE),
        _TORQUE: (scaled(0.5, 2.0), _MOTORS),
        _BELLY: (shifted(-0.005, 0.005), "its file has it; 5 mm for what hangs below"),
    },
    "marv": {
        _X: (shifted(-0.01, 0.01), _OF_FILE),
        _Y: (shifted(-0.01, 0.01), _OF_FILE),
        _TORQUE: (scaled(0.5, 2.0), _MOTORS),
        _BELLY: (shifted(-0.005, 0.005), "its file has it; 5 mm for what hangs below"),
    },
    "gz_tracked_vehicle": {
        _X: (shifted(-0.01, 0.01), _OF_FILE),
        _Y: (shifted(-0.01, 0.01), _OF_FILE),
        _TORQUE: (scaled(0.5, 2.0), _MOTORS),
        _BELLY: (shifted(-0.005, 0.005), "its file has it; 5 mm for what hangs below"),
    },
}
"""Of the presets, by name."""
