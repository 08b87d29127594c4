"""The paper's Tables 1 and 3: speed, highest obstacle, braking, acceleration, slope, computing."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import crawler2d as c2d
from crawler2d.sweeps.figure_dataset import FigureDataset
from research.models import study_robot
from research.paper import REAL_ROBOT, RPM, TABLE_1, TABLE_3
from research.paper.design import PRESET, READINGS, SETTINGS, Work, climb, models_of
from research.tables import gaps, group_by, markdown_table, mm, percent

_PAPER = {row.model: row for row in TABLE_3}
ROWS = {reading.row: reading.layout for reading in READINGS if reading.row in _PAPER}
"""The layout for each row of Table 3."""

_THICKNESS = 0.1
"""[m] Thickness of the parallelepiped: that of barriers in fields, as the paper has none."""
_SPAN = 5.0
"""[s] Simulated time of one measurement of computing time."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Driving:
    """Driving of a layout on level ground, with the preset."""

    row: str
    """Row of Table 3."""
    model: str
    full_speed: float
    """[m/s] Speed with the command of 1.39 m/s, which the maker declares."""
    full_speed_limit: str
    """Its limit, found by doubling command, torque and friction."""
    speed: float
    """[m/s] Speed with a command of 0.4 m/s, which the paper measured."""
    speed_limit: str
    braking: float
    """[m] Braking distance from there."""
    braking_limit: str
    acceleration: float
    """[m/s^2] Acceleration to that speed."""
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
    """Outcome of most runs at the next height."""
    repeats: int
    """Runs per height."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Slope:
    """The steepest slope that a layout climbs without flippers, with the preset's motors."""

    friction: float
    row: str
    model: str
    closed_form: float
    """[rad] The angle whose tangent is the friction, where any robot slides."""
    steepest: float
    """[rad] Greatest angle that at least half of the runs climbed; nan if there is none."""
    declared: float
    """[-] Fraction that climbed the 35 degrees that the maker declares."""
    measured: float
    """[-] Fraction that climbed the 45 degrees that the paper measured."""
    limit: str
    """Outcome of most runs on the next slope."""
    repeats: int


@dataclass(frozen=True, slots=True, kw_only=True)
class Computing:
    """Ratio of simulated time to processor time, on one thread of this machine."""

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
    """[m] Distance that it drove there."""


def driving(work: Work) -> list[Driving]:
    """Measure speed, braking and acceleration of every row of Table 3."""
    print("Table 3, driving", flush=True)
    base = climb(c2d.terrains.flat(friction=PRESET.friction))
    models, repeats = models_of(ROWS.values()), work.design.driving_repeats
    options: Any = {"models": models, "repeats": repeats, **work.sampling}
    command: Any = {"speed": TABLE_1.max_speed, **options}
    studies = {
        "full_speed": ("speed", c2d.studies.max_speed(base, **options)),
        "speed": ("speed", c2d.studies.max_speed(base, **command)),
        "acceleration": ("acceleration", c2d.studies.acceleration(base, **command)),
        "braking": ("braking_distance", c2d.studies.braking_distance(base, **command)),
    }
    rows = []
    for row, model in ROWS.items():
        values: dict[str, Any] = {}
        for name, (variable, runs) in studies.items():
            own = runs.sel(model=model)
            values |= {name: own[variable].item(), f"{name}_limit": own["limit"].item()}
        rows.append(Driving(row=row, model=model, **values))
    for _, runs in studies.values():
        work.count(runs)
    return rows


def highest_obstacles(work: Work) -> tuple[list[Height], dict[str, FigureDataset]]:
    """Find the highest parallelepiped in every setting; also return the runs by setting."""
    heights, repeats = work.design.heights, work.design.height_repeats
    rows, tables = [], {}
    for setting in SETTINGS:
        print(f"Table 3, highest obstacle, {setting.name}", flush=True)
        block = c2d.terrains.barrier(heights[0], _THICKNESS, friction=setting.friction)
        base = climb(block, setting)
        models, options = models_of(ROWS.values(), setting), work.sampling_of(repeats)
        runs = work.count(c2d.studies.max_obstacle(base, models=models, heights=heights, **options))
        tables[setting.name] = runs
        for row, model in ROWS.items():
            own = runs.sel(model=model)
            highest = own["highest"].item()
            rates = zip(heights, own["rate"].to_numpy().tolist(), strict=True)
            rows.append(
                Height(
                    setting=setting.name,
                    row=row,
                    model=model,
                    paper=_PAPER[row].max_height,
                    highest=highest,
                    gaps=tuple(h for h, rate in rates if h < highest and rate < 0.5),
                    limit=own["limit"].item(),
                    repeats=repeats,
                )
            )
    return rows, tables


def steepest_slopes(work: Work) -> list[Slope]:
    """Find the steepest slope with the preset's friction, and with the least needed for 45 degrees.

    The flippers are left off, because raised by 0.8 rad they would touch the slope first.
    """
    rows = []
    declared, measured = TABLE_1.declared_max_slope, TABLE_1.max_slope
    repeats, models = work.design.slope_repeats, models_of(ROWS.values(), flippers=False)
    for friction in (PRESET.friction, 1.0):
        print(f"Table 1, slopes, friction {friction:g}", flush=True)
        ground = c2d.terrains.ramp(declared, friction=friction)
        base = c2d.Scenario(study_robot(), ground, drive=c2d.Drive(speed=TABLE_1.max_speed))
        angles, options = work.design.angles, work.sampling_of(repeats)
        runs = work.count(c2d.studies.max_slope(base, models=models, angles=angles, **options))
        for row, model in ROWS.items():
            own = runs.sel(model=model)
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
                    repeats=repeats,
                )
            )
    return rows


def computing(work: Work) -> list[Computing]:
    """Measure the real-time factor of the rows of Table 3: standing, driving, and in a field."""
    print("Table 3, real-time factor", flush=True)
    models = models_of(ROWS.values())
    level, rough = (
        measure_factors(work, climb(ground), models)
        for ground in (
            c2d.terrains.flat(friction=PRESET.friction),
            c2d.terrains.random_stepfield(friction=PRESET.friction),
        )
    )
    factor, field = level["factor"], rough.sel(motion="driving")
    return [
        Computing(
            row=row,
            model=model,
            paper=_PAPER[row].real_time_factor,
            standing=factor.sel(model=model, motion="standing").item(),
            driving=factor.sel(model=model, motion="driving").item(),
            in_field=field["factor"].sel(model=model).item(),
            moved=field["moved"].sel(model=model).item(),
        )
        for row, model in ROWS.items()
    ]


def measure_factors(work: Work, base: c2d.Scenario, models: Any) -> FigureDataset:
    """Measure real-time factors on one thread of this machine."""
    return c2d.studies.real_time_factor(
        base,
        models=models,
        duration=_SPAN,
        repeats=work.design.computing_repeats,
        progress=work.progress,
    )


def table_1_text(slopes: Sequence[Slope], rows: Sequence[Driving]) -> str:
    """Compare the paper's Table 1 with ours."""
    robot, stand_in = TABLE_1, next(row for row in rows if row.row == REAL_ROBOT)
    speed = f"{stand_in.full_speed:.2f}, limited by {stand_in.full_speed_limit}"
    turning = "a side view has no turning"
    slope = "see below: at most the arc tangent of the friction"
    braking = f"{stand_in.braking:.3f} from 0.4 m/s, limited by {stand_in.braking_limit}"
    figures = [
        ("max. speed [m/s]", f"{robot.max_speed:g}", f"{robot.declared_max_speed:g}", speed),
        ("max. turn rate [rpm]", f"{robot.max_turn_rate / RPM:.1f}", "-", turning),
        ("max. slope [deg]", _deg(robot.max_slope), _deg(robot.declared_max_slope), slope),
        ("stopping distance [m]", f"{robot.stopping_distance:g}", "-", braking),
    ]
    table = [
        (
            f"{row.friction:g}",
            row.model,
            f"{math.degrees(row.closed_form):.1f}",
            "none" if math.isnan(row.steepest) else _deg(row.steepest),
            percent(row.declared),
            percent(row.measured),
            row.limit.replace("_", " "),
        )
        for row in slopes
    ]
    head = ("friction", "layout", "arc tangent", "steepest tried", "35 deg", "45 deg", "then")
    return "\n\n".join(
        (
            markdown_table(("", "real robot", "declared", f"ours: {stand_in.model}"), figures),
            f"Slopes without flippers, {slopes[0].repeats} runs each: the steepest [deg] that half"
            " of the runs climbed, and the shares [%] that climbed 35 and 45 degrees.",
            markdown_table(head, table),
        )
    )


def table_3_text(rows: Sequence[Driving]) -> str:
    """Compare speed, braking and acceleration in the paper's Table 3 with ours, row by row."""
    driven = [
        (
            row.row,
            row.model,
            f"{theirs.max_speed:g}",
            f"{row.speed:.3f} ({row.full_speed:.2f})",
            f"{theirs.braking_distance:g}",
            f"{row.braking:.3f}",
            f"{theirs.acceleration:g}",
            f"{row.acceleration:.3f}",
            f"{theirs.max_turn_rate / RPM:.1f}",
        )
        for row in rows
        for theirs in [_PAPER[row.row]]
    ]
    limits = {limit for row in rows for limit in (row.speed_limit, row.full_speed_limit)}
    inputs = {limit for row in rows for limit in (row.braking_limit, row.acceleration_limit)}
    head = (
        *("row of the paper", "layout", "speed, paper", "ours", "braking, paper", "ours"),
        *("acceleration, paper", "ours", "turning [rpm], paper"),
    )
    return (
        "Speed [m/s], commanded 0.4 m/s and in brackets at full command; braking distance [m] from"
        " 0.4 m/s; acceleration [m/s^2]. Acceleration and deceleration of a drivetrain are *inputs*"
        " of our robots: 0.2 and 4 m/s^2 were taken from the row of the real robot, so these two"
        " columns show only that every layout can follow. What limits speed, found by doubling:"
        f" {', '.join(sorted(limits))}; acceleration and braking: {', '.join(sorted(inputs))}. A"
        " side view has no turning: the paper's rates stand alone."
        f"\n\n{markdown_table(head, driven)}"
    )


def heights_text(heights: Sequence[Height]) -> str:
    """Compare the highest obstacles of the paper's Table 3 with ours."""
    climbed = [
        (own[0].model, mm(own[0].paper), *map(_height, own))
        for own in group_by(heights, "row").values()
    ]
    head = ("layout", "paper", *group_by(heights, "setting"))
    return (
        "Highest parallelepiped [mm] on level ground, 100 mm thick, with flippers and the gait"
        f" `Climb`: the greatest height that half of {heights[0].repeats} runs cleared, in"
        " brackets lower ones that they did not; then how most runs end on the next."
        f"\n\n{markdown_table(head, climbed)}"
    )


def computing_text(factors: Sequence[Computing]) -> str:
    """Compare the real-time factors of the paper's Table 3 with ours."""
    costs = [
        (
            row.row,
            row.model,
            f"{row.paper:g}",
            f"{row.standing:.0f}",
            f"{row.driving:.0f}",
            f"{row.in_field:.0f} ({row.moved:.2f})",
        )
        for row in factors
    ]
    head = ("row of the paper", "layout", "paper", "standing", "driving", "in a field")
    return (
        "The paper's real-time factor is that of Gazebo, in three dimensions, on its machine; ours"
        " is simulated time by processor time of one thread of this machine, in side view:"
        " standing and driving on level ground, and driving in a random step field (in brackets"
        " how far it came there [m]). Only ratios within a column can be compared."
        f"\n\n{markdown_table(head, costs)}"
    )


def _deg(angle: float) -> str:
    return f"{math.degrees(angle):.0f}"


def _height(row: Height) -> str:
    if math.isnan(row.highest):
        return f"none; {row.limit.replace('_', ' ')}"
    return f"{mm(row.highest)}{gaps(row.gaps)}; {row.limit.replace('_', ' ')}"
