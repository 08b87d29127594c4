"""The paper's Tables 1 and 3: speed, highest obstacle, braking, acceleration, slope, computing."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from crawler2d.parameters.scenario import Scenario
from crawler2d.parameters.settings import Climb, Drive
from crawler2d.presets import terrains
from crawler2d.presets.robots import engineer
from crawler2d.studies.driving import acceleration, braking_distance, max_speed
from crawler2d.studies.obstacles import max_obstacle, max_slope
from crawler2d.studies.riding import real_time_factor
from research.paper.layouts import READINGS, layouts
from research.paper.published import TABLE_1, TABLE_3
from research.paper.settings import PRESET, SETTINGS, Setting

if TYPE_CHECKING:
    from crawler2d.sweeps.found import Found
    from research.paper.design import Work

__all__ = [
    "BESIDE_TABLE_3",
    "Computing",
    "Driving",
    "Height",
    "Slope",
    "computing",
    "driving",
    "highest_obstacles",
    "steepest_slopes",
]

_ROWS = {row.model for row in TABLE_3}
BESIDE_TABLE_3 = {reading.row: reading.layout for reading in READINGS if reading.row in _ROWS}
"""By row of Table 3, the layout that stands for it."""

_THICKNESS = 0.1
"""[m] Of the parallelepiped: that of the barrier in the fields. The paper gives none."""
_SPAN = 5.0
"""[s] Simulated for one measurement of computing time."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Driving:
    """How a layout drives on level ground, under the preset."""

    row: str
    """Of Table 3."""
    model: str
    full_speed: float
    """[m/s] At full command: the 1.39 m/s that the maker declares."""
    full_speed_limit: str
    """What limits it, found by doubling command, torque and friction."""
    speed: float
    """[m/s] Commanded the speed that the paper measured, 0.4 m/s."""
    speed_limit: str
    braking: float
    """[m] Braking distance from there."""
    braking_limit: str
    acceleration: float
    """[m/s^2] To there."""
    acceleration_limit: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Height:
    """The highest parallelepiped on level ground that a layout clears with its flippers."""

    setting: str
    row: str
    model: str
    paper: float
    """[m]"""
    highest: float
    """[m] Greatest height that at least half of the runs cleared; nan if there is none."""
    gaps: tuple[float, ...]
    """[m] Lower heights that fewer cleared."""
    limit: str
    """How most runs end on the next height."""
    repeats: int
    """Runs per height."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Slope:
    """The steepest slope that a layout climbs without its flippers, under the preset's motors."""

    friction: float
    row: str
    model: str
    closed_form: float
    """[rad] The angle whose tangent is the friction, where any robot slides."""
    steepest: float
    """[rad] Greatest angle that at least half of the runs climbed; nan if there is none."""
    declared: float
    """[-] Share that climbed the 35 degrees that the maker declares."""
    measured: float
    """[-] Share that climbed the 45 degrees that the paper measured."""
    limit: str
    """How most runs end on the next slope."""
    repeats: int


@dataclass(frozen=True, slots=True, kw_only=True)
class Computing:
    """Simulated time by processor time, on one thread of this machine."""

    row: str
    model: str
    paper: float
    """[-] Of Gazebo, on the paper's machine."""
    standing: float
    """[-] On level ground."""
    driving: float
    """[-] On level ground."""
    in_field: float
    """[-] Driving in a random step field."""
    moved: float
    """[m] How far it came there."""


def driving(work: Work) -> list[Driving]:
    """Measure speed, braking and acceleration of every row of Table 3."""
    base, models = _scenario(PRESET, terrains.flat(friction=PRESET.friction)), _models(PRESET)
    repeats, command = work.design.driving_repeats, TABLE_1.max_speed
    print("Table 3, driving", flush=True)
    how, count = work.sampling, work.counted
    full = count(max_speed(base, models=models, repeats=repeats, **how))
    slow = count(max_speed(base, models=models, speed=command, repeats=repeats, **how))
    up = count(acceleration(base, models=models, speed=command, repeats=repeats, **how))
    down = count(braking_distance(base, models=models, speed=command, repeats=repeats, **how))

    def of(found: Found, name: str, model: str) -> Any:
        return found[name].sel(model=model).item()

    return [
        Driving(
            row=row,
            model=model,
            full_speed=of(full, "speed", model),
            full_speed_limit=of(full, "limit", model),
            speed=of(slow, "speed", model),
            speed_limit=of(slow, "limit", model),
            braking=of(down, "braking_distance", model),
            braking_limit=of(down, "limit", model),
            acceleration=of(up, "acceleration", model),
            acceleration_limit=of(up, "limit", model),
        )
        for row, model in BESIDE_TABLE_3.items()
    ]


def highest_obstacles(work: Work) -> tuple[list[Height], dict[str, Found]]:
    """Find the highest parallelepiped, in every setting; returns the runs, too, by setting."""
    papers = {row.model: row.max_height for row in TABLE_3}
    heights, repeats = work.design.heights, work.design.height_repeats
    rows, tables = [], {}
    for setting in SETTINGS:
        print(f"Table 3, highest obstacle, {setting.name}", flush=True)
        block = terrains.barrier(heights[0], _THICKNESS, friction=setting.friction)
        found = work.counted(
            max_obstacle(
                _scenario(setting, block),
                models=_models(setting),
                heights=heights,
                **work.how(repeats),
            )
        )
        tables[setting.name] = found
        for row, model in BESIDE_TABLE_3.items():
            own = found.sel(model=model)
            highest = own["highest"].item()
            rates = zip(heights, own["rate"].to_numpy().tolist(), strict=True)
            rows.append(
                Height(
                    setting=setting.name,
                    row=row,
                    model=model,
                    paper=papers[row],
                    highest=highest,
                    gaps=tuple(h for h, rate in rates if h < highest and rate < 0.5),
                    limit=own["limit"].item(),
                    repeats=repeats,
                )
            )
    return rows, tables


def steepest_slopes(work: Work) -> list[Slope]:
    """Find the steepest slope with the preset's friction, and with the least that 45 degrees need.

    The flippers are left off, because raised by 0.8 rad they would touch the slope first.
    """
    rows = []
    declared, measured = TABLE_1.declared_max_slope, TABLE_1.max_slope
    for friction in (PRESET.friction, 1.0):
        print(f"Table 1, slopes, friction {friction:g}", flush=True)
        base = Scenario(
            engineer(flippers=None).without_rotors(),
            terrains.ramp(declared, friction=friction),
            drive=Drive(speed=TABLE_1.max_speed),
        )
        known = layouts()
        models = {name: {"robot": known[name].on(base.robot)} for name in BESIDE_TABLE_3.values()}
        how = work.how(work.design.slope_repeats)
        angles = work.design.angles
        found = work.counted(max_slope(base, models=models, angles=angles, **how))
        for row, model in BESIDE_TABLE_3.items():
            own = found.sel(model=model)
            rows.append(
                Slope(
                    friction=friction,
                    row=row,
                    model=model,
                    closed_form=math.atan(friction),
                    steepest=own["highest"].item(),
                    declared=own["rate"].sel(angle=declared).item(),
                    measured=own["rate"].sel(angle=measured).item(),
                    limit=own["limit"].item(),
                    repeats=work.design.slope_repeats,
                )
            )
    return rows


def computing(work: Work) -> list[Computing]:
    """Measure how fast the rows of Table 3 are simulated: standing, driving, in a field."""
    print("Table 3, real-time factor", flush=True)
    flat = _scenario(PRESET, terrains.flat(friction=PRESET.friction))
    field = flat.replace({"terrain": terrains.random_stepfield(friction=PRESET.friction)})
    level, rough = (
        real_time_factor(
            base,
            models=_models(PRESET),
            duration=_SPAN,
            repeats=work.design.computing_repeats,
            progress=work.progress,
        )
        for base in (flat, field)
    )
    papers = {row.model: row.real_time_factor for row in TABLE_3}
    rows = []
    for row, model in BESIDE_TABLE_3.items():
        own, there = level["factor"].sel(model=model), rough.sel(model=model, motion="driving")
        rows.append(
            Computing(
                row=row,
                model=model,
                paper=papers[row],
                standing=own.sel(motion="standing").item(),
                driving=own.sel(motion="driving").item(),
                in_field=there["factor"].item(),
                moved=there["moved"].item(),
            )
        )
    return rows


def _scenario(setting: Setting, ground: Any) -> Scenario:
    drive = Drive(speed=TABLE_1.max_speed, gait=Climb())
    return Scenario(setting.on(engineer().without_rotors()), ground, drive=drive)


def _models(setting: Setting) -> Mapping[str, Mapping[str, Any]]:
    known, robot = layouts(), engineer().without_rotors()
    return {name: {"robot": setting.on(known[name].on(robot))} for name in BESIDE_TABLE_3.values()}
