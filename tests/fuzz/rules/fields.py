"""What a valid scenario is, from its documentation: types, ranges and names of its fields.

Nothing here calls the package. Rules that join fields are in `parts`, those of built robots in
`robots`, those of ground in `grounds`.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

from tests.fuzz.rules.verdict import Verdict

Json = Any

NOT_FINITE = ("NaN", "Infinity", "-Infinity")
SMALLEST_NORMAL = 2.2250738585072014e-308
DEEPEST = 12
"""Levels of objects and lists in a text."""

# What a field may hold. `optional` may be null, what is `left_out` may be missing.


@dataclass(frozen=True)
class Number:
    low: float
    high: float
    above: bool = False
    optional: bool = False
    left_out: bool = False

    def is_far_inside(self, number: float) -> bool:
        """Whether it is far from any limit and from 0."""
        low, high = self.low, self.high
        far = abs(number) > 1e-280 and low < number < high
        return far and number - low > 1e-5 * abs(low) and high - number > 1e-5 * abs(high)


@dataclass(frozen=True)
class Whole:
    low: int
    high: int
    optional: bool = False
    left_out: bool = False


@dataclass(frozen=True)
class Flag:
    optional: bool = False
    left_out: bool = False


@dataclass(frozen=True)
class Text:
    most: int
    optional: bool = False
    left_out: bool = False


@dataclass(frozen=True)
class Name:
    names: tuple[str, ...]
    optional: bool = False
    left_out: bool = False


@dataclass(frozen=True)
class Rows:
    """Rows with these columns; one column is a number instead of a row, `least` None one row."""

    columns: tuple[Number, ...]
    least: int | None
    most: int
    optional: bool = False
    left_out: bool = False


@dataclass(frozen=True)
class Part:
    """An object of one of several kinds; "" has no kind."""

    kinds: str
    optional: bool = False
    left_out: bool = False


Field = Number | Whole | Flag | Text | Name | Rows | Part

SIZE, SIZE_OR_ZERO = Number(1e-4, 100.0), Number(0.0, 100.0)
COORDINATE = Number(-100.0, 100.0)
MASS, TORQUE = Number(1e-12, 1e12), Number(0.0, 1e17)
ROTOR = Number(0.0, 1e16, left_out=True)
ANGLE, TIME = Number(-6.3, 6.3), Number(0.0, 1e5)
SHARE, SHARE_OR_ZERO = Number(0.0, 1.0, above=True), Number(0.0, 1.0)
HEIGHT, LENGTH = Number(0.0, 100.0, above=True), Number(1e-4, 1e4)
FRICTION, ROUNDED = Number(0.0, 100.0), Number(0.0, 10.0)
YAW = Number(-1.396263, 1.396263)
ANYWHERE = Number(-1e7, 1e7)
PART_OF_WHEEL = Number(0.0, 100.0, above=True, optional=True)
SPEED = Number(0.0, 100.0, above=True)
DISC = (COORDINATE, COORDINATE, SIZE)
EDGES = {"edge_radius": ROUNDED, "friction": FRICTION}


def some(number: Number) -> Number:
    """The same, or null."""
    return Number(number.low, number.high, number.above, optional=True)


KINDS: dict[str, dict[str, dict[str, Field]]] = {
    "scenario": {
        "": {
            "schema": Whole(2, 2),
            "robot": Part("robot"),
            "terrain": Part("terrain"),
            "drive": Part("drive"),
            "start": Part("start"),
            "goal": some(ANYWHERE),
            "gravity": Number(0.0, 1e3),
            "duration": TIME,
            "solver": Part("solver"),
            "criteria": Part("criteria"),
        }
    },
    "robot": {
        "": {
            "name": Text(1000),
            "mass": MASS,
            "center_of_mass": Rows((COORDINATE, COORDINATE), None, 2),
            "moment_of_inertia": Number(1e-20, 1e16),
            "track_mass": MASS,
            "outline": Part("outline"),
            "belly": Rows((COORDINATE, COORDINATE), 3, 64, optional=True),
            "flippers": Part("flippers", optional=True),
            "gauge": SIZE,
            "drivetrain": Part("drivetrain"),
            "track": Part("track"),
        }
    },
    "outline": {
        "": {
            "axle_distance": SIZE,
            "front_radius": SIZE,
            "rear_radius": SIZE,
            "discs": Rows(DISC, 2, 64),
            "grouser_height": SIZE_OR_ZERO,
            "grouser_pitch": SIZE,
            "grouser_thickness": SIZE_OR_ZERO,
        }
    },
    "flippers": {
        "": {
            "length": SIZE,
            "root_radius": SIZE,
            "tip_radius": SIZE,
            "mass": MASS,
            "ends": Name(("front", "rear", "both")),
            "angle": ANGLE,
            "rate_limit": Number(0.0, 100.0, above=True),
            "torque_limit": TORQUE,
            "rotor_inertia": ROTOR,
            "self_locking": Flag(left_out=True),
            "track": Part("track", optional=True),
        }
    },
    "drivetrain": {
        "": {
            "max_speed": SPEED,
            "max_acceleration": Number(0.0, 1e6, above=True),
            "max_deceleration": Number(0.0, 1e6, above=True),
            "max_torque": TORQUE,
            "torque_sharing": Name(("track", "wheel")),
            "rotor_inertia": ROTOR,
            "no_load_speed": Number(0.0, 100.0, above=True, optional=True, left_out=True),
            "torque_curve": Rows((Number(0.0, 100.0), TORQUE), 1, 1000, True, True),
            "controller": Part("controller", optional=True, left_out=True),
            "self_locking": Flag(left_out=True),
        }
    },
    "controller": {
        "pi": {"gain": Number(0.0, 1e17, above=True), "integral": Number(0.0, 1e17)},
    },
    "track": {
        "line": {
            "count": Whole(2, 200),
            "wheel_radius": some(SIZE),
            "wheel": Part("wheel"),
            "as_track": Flag(),
        },
        "circumferential": {
            "count": Whole(3, 200),
            "wheel_radius": some(SIZE),
            "wheel": Part("wheel"),
        },
        "hybrid": {"placements": Rows(DISC, 1, 200), "wheel": Part("wheel")},
        "belt": {},
        "grouser_belt": {"grouser_count": Whole(1, 200, optional=True)},
        "segmental": {
            "shoe_count": Whole(3, 400, optional=True),
            "mechanism": Name(("guide", "sprocket")),
            "shoe_shape": Name(("rectangle", "trapezoid")),
            "plate_thickness": some(SIZE),
            "pre_tension": Number(0.0, 1e15, above=True, optional=True),
            "tensioner_stiffness": Number(0.0, 1e22, above=True, optional=True),
            "tensioner_damping": Number(0.0, 1e17, optional=True),
            "pin_stiffness": Number(0.0, 1e22, left_out=True),
            "pin_damping": Number(0.0, 1e17, left_out=True),
            "road_wheel_count": Whole(0, 200, optional=True),
            "return_roller_count": Whole(0, 200, optional=True),
        },
        "force": {
            "support": Name(("skids", "wheels")),
            "skid_friction": FRICTION,
            "wheel_count": Whole(2, 200),
        },
        "closed": {"of": Part("track"), "surface": Name(("own", "smooth"))},
    },
    "wheel": {
        "round": {},
        "gear": {
            "grouser_count": Whole(3, 200, optional=True),
            "grouser_height": PART_OF_WHEEL,
            "tip_thickness": PART_OF_WHEEL,
            "base_thickness": PART_OF_WHEEL,
            "phase_fraction": SHARE_OR_ZERO,
        },
    },
    "terrain": {
        "flat": {"length": LENGTH, "friction": FRICTION},
        "step": {"height": HEIGHT, **EDGES},
        "ramp": {"angle": Number(-1.553343, 1.553343), "length": LENGTH, **EDGES},
        "barrier": {"height": HEIGHT, "thickness": LENGTH, **EDGES},
        "ridge": {"height": HEIGHT, "edge_angle": Number(0.01, 3.13), **EDGES},
        "gap": {"width": LENGTH, "depth": HEIGHT, **EDGES},
        "stairs": {"count": Whole(1, 1000), "rise": HEIGHT, "run": LENGTH, **EDGES},
        "half_round": {"radius": SIZE, "friction": FRICTION},
        "diagonal_barrier": {"yaw": YAW, "height": HEIGHT, "thickness": LENGTH, **EDGES},
        "random_stepfield": {
            "seed": Whole(0, 2**32 - 1),
            "pattern": Name(("flat", "hill", "diagonal")),
            "posts": Whole(1, 1000),
            "post": LENGTH,
            "rise": HEIGHT,
            "levels": Whole(1, 1000),
            "barrier_height": Number(0.0, 100.0),
            "barrier_thickness": LENGTH,
            "barrier_yaw": YAW,
            **EDGES,
        },
        "points": {
            "points": Rows((ANYWHERE, ANYWHERE), 2, 200_000),
            "goal": ANYWHERE,
            "segment_friction": Rows((FRICTION,), 0, 200_000, True, True),
            **EDGES,
        },
        "lanes": {
            "left": Part("terrain"),
            "right": Part("terrain"),
            "middle": Part("terrain", optional=True),
        },
    },
    "drive": {
        "": {
            "speed": Number(-100.0, 100.0),
            "schedule": Rows((TIME, Number(-100.0, 100.0)), 0, 10_000, optional=True),
            "gait": Part("gait", optional=True),
        }
    },
    "gait": {
        "hold": {
            "angle": ANGLE,
            "schedule": Rows((TIME, ANGLE), 0, 10_000, optional=True),
            "front": Number(-6.3, 6.3, optional=True, left_out=True),
            "rear": Number(-6.3, 6.3, optional=True, left_out=True),
        },
        "climb": {
            "reach_angle": ANGLE,
            "sweep_angle": ANGLE,
            "push_angle": ANGLE,
            "level_angle": Number(0.0, 1.5, above=True),
        },
    },
    "start": {
        "": {
            "approach": Number(0.0, 1e4),
            "track_phase": Number(-1e4, 1e4),
            "angle": Number(-1.5, 1.5),
        }
    },
    "solver": {
        "": {
            "engine": Name(("own", "rapier"), left_out=True),
            "contact": Name(("own", "reference")),
            "accuracy": Number(1e-10, 1e-2, optional=True),
            "time_step": Number(1e-5, 1.0 / 30.0, optional=True),
            "iterations": Whole(1, 1000, optional=True),
            "contact_frequency": Number(1.0, 1e5),
            "contact_damping_ratio": Number(0.0, 100.0, above=True),
            "max_push_speed": Number(0.0, 100.0, above=True),
            "prediction_distance": Number(1e-5, 0.1),
            "restitution": Number(0.0, 1.0, left_out=True),
        }
    },
    "criteria": {
        "": {
            "stop_window": Number(0.01, 1e4),
            "stop_pitches": Number(0.0, 1e3),
            "stop_progress": SHARE,
            "stationary_distance": Number(0.0, 1.0, above=True),
            "stationary_windows": Whole(1, 1000),
            "clear_time": Number(0.0, 1e4),
            "clear_angle": Number(0.0, 3.15, above=True),
            "tip_over_angle": Number(0.0, 3.15, above=True),
            "intrusion_depth": Number(0.0, 0.1),
            "intrusion_load": SHARE,
            "belly_load": SHARE,
            "sliding_speed": SHARE,
            "torque_limit": SHARE,
            "cycling_distance": Number(0.0, 10.0, above=True),
            "imbalance": SHARE,
            "mean_imbalance": SHARE,
            "creep_from": SHARE_OR_ZERO,
            "creep_to": SHARE_OR_ZERO,
            "escape_distance": Number(0.0, 10.0, above=True),
            "escape_time": Number(0.01, 60.0),
        }
    },
}

ENDS = ("axle_distance", "front_radius", "rear_radius")
"""What an outline may have in place of discs."""


class Reader:
    """Reads the fields of a scenario; broken rules are in its verdict, by path."""

    def __init__(self, verdict: Verdict) -> None:
        self.verdict = verdict
        self.unknown: list[tuple[str, str]] = []
        """Rule and path of fields that are too many; the others are read all the same."""

    def whole_text(self, value: Json, path: str = "", depth: int = 0) -> None:
        """Check every value against the rules for all JSON, whatever its field."""
        if isinstance(value, (dict, list)):
            if depth >= DEEPEST:
                self.verdict.need("a text nests 12 levels", "scenario", kept=False)
                return
            items: Iterator[tuple[str, Json]] = (
                ((f"{path}.{name}".removeprefix("."), each) for name, each in value.items())
                if isinstance(value, dict)
                else ((f"{path}[{i}]", each) for i, each in enumerate(value))
            )
            for inner, each in items:
                self.whole_text(each, inner, depth + 1)
        elif isinstance(value, str):
            if not value.isascii():
                valid = not any("\ud800" <= each <= "\udfff" for each in value)
                self.verdict.need("texts are Unicode", path or "scenario", valid)
        elif isinstance(value, int) and not isinstance(value, bool) and value.bit_length() > 1023:
            self.verdict.need("numbers fit in float64", path or "scenario", fits(value))

    def part(self, path: str, value: Json, name: str) -> None:
        """Read an object."""
        if not isinstance(value, dict):
            self.verdict.need(f"{name} is an object", path or "scenario", kept=False)
            return
        kinds = KINDS[name]
        if "" in kinds:
            fields, known = kinds[""], set()
        else:
            kind: Json = value.get("kind")
            is_kind = isinstance(kind, str) and kind in kinds
            if not self.verdict.need(f"{name} has a known kind", joined(path, "kind"), is_kind):
                return
            fields, known = kinds[kind], {"kind"}
        if name == "outline":
            fields = self._ends_or_discs(path, value, fields)
        for field_name, what in fields.items():
            inner = joined(path, field_name)
            rule = f"{name}.{field_name}" if "" in kinds else f"{name}.{kind}.{field_name}"
            if field_name in value:
                self.field(inner, value[field_name], what, rule)
            elif what.left_out:
                self.field(inner, None, replace(what, optional=True), rule)
            else:
                self.verdict.need(f"{rule} is given", inner, kept=False)
        for unknown in value.keys() - fields.keys() - known:
            self.unknown.append((f"{name} has no other field", joined(path, unknown)))

    def _ends_or_discs(self, path: str, value: Json, fields: dict[str, Field]) -> dict[str, Field]:
        """An outline has discs, or axle distance and two radii."""
        ends = [name for name in ENDS if name in value]
        if ends and "discs" in value:
            for name in ends:
                self.verdict.need("discs or ends", joined(path, name), kept=False)
            return fields
        unused = {"discs"} if ends else set(ENDS)
        return {name: what for name, what in fields.items() if name not in unused}

    def field(self, path: str, value: Json, what: Field, rule: str) -> None:
        """Read the value of a field."""
        need = self.verdict.need
        if isinstance(what, Number) and self.verdict.limits is not None:
            self._limits(path, what, rule, self.verdict.limits)
        if value is None:
            need(f"{rule} is not null", path, what.optional)
        elif isinstance(what, Number):
            self._number(path, value, what, rule)
        elif isinstance(what, Whole):
            if need(f"{rule} is whole", path, type(value) is int):
                self.verdict.at_least(f"{rule} not below", path, value, what.low)
                self.verdict.at_most(f"{rule} not above", path, value, what.high)
        elif isinstance(what, Flag):
            need(f"{rule} is a flag", path, isinstance(value, bool))
        elif isinstance(what, Name):
            need(f"{rule} is a known name", path, isinstance(value, str) and value in what.names)
        elif isinstance(what, Text):
            if need(f"{rule} is a text", path, isinstance(value, str)):
                self.verdict.at_most(f"{rule} not longer", path, len(value), what.most)
        elif isinstance(what, Rows):
            self._rows(path, value, what, rule)
        else:
            self.part(path, value, what.kinds)

    def _limits(
        self, path: str, what: Number, rule: str, limits: list[tuple[str, str, float]]
    ) -> None:
        """Record the limits of a number, also if the field is null."""
        ends = [(f"{rule} not below", what.low), (f"{rule} not above", what.high)]
        limits += [(name, path, limit) for name, limit in ends]

    def _number(self, path: str, value: Json, what: Number, rule: str) -> None:
        if isinstance(value, float) and not math.isfinite(value):
            value = "NaN"  # written as a text
        if isinstance(value, str) and value in NOT_FINITE:
            self.verdict.need(f"{rule} is finite", path, kept=False)
            return
        is_number = isinstance(value, (int, float)) and not isinstance(value, bool)
        if not self.verdict.need(f"{rule} is a number", path, is_number) or not fits(value):
            return
        number = float(value)
        if what.is_far_inside(number) and self.verdict.limits is None:
            return
        low = self.verdict.at_least(f"{rule} not below", path, number, what.low, more=what.above)
        if low and self.verdict.at_most(f"{rule} not above", path, number, what.high):
            subnormal = 0.0 < abs(number) < SMALLEST_NORMAL
            self.verdict.need("no number is subnormal", path, not subnormal)

    def _rows(self, path: str, value: Json, what: Rows, rule: str) -> None:
        if not self.verdict.need(f"{rule} is a list", path, isinstance(value, list)):
            return
        columns = len(what.columns)
        if what.least is None:
            self._row(path, value, what, rule)
            return
        if not self.verdict.at_most(f"{rule} not longer", path, len(value), what.most):
            return
        if what.least > 0:
            self.verdict.at_least(f"{rule} not shorter", path, len(value), what.least)
        for i, row in enumerate(value):
            if columns == 1:
                self._number(f"{path}[{i}]", row, what.columns[0], f"{rule}[]")
            else:
                self._row(f"{path}[{i}]", row, what, rule)

    def _row(self, path: str, row: Json, what: Rows, rule: str) -> None:
        is_row = isinstance(row, list) and len(row) == len(what.columns)
        if self.verdict.need(f"{rule} has rows", path, is_row):
            for k, (cell, column) in enumerate(zip(row, what.columns, strict=True)):
                self._number(f"{path}[{k}]", cell, column, f"{rule}[{k}]")


def fits(number: float) -> bool:
    """Whether float64 holds a number, rounded."""
    try:
        return math.isfinite(float(number))
    except OverflowError:
        return False


def joined(path: str, name: str) -> str:
    """The path of a field of the object at a path."""
    return f"{path}.{name}" if path else name
