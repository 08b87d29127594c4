"""The tables of the seizure study as text for a terminal."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Mapping, Sequence
from typing import TYPE_CHECKING

from crawler2d._core import build_info
from research.columns import aligned, in_mm, mm
from research.paper import published

if TYPE_CHECKING:
    from research.models import StudyModel
    from research.public_model import Post
    from research.sweeps import Study
    from research.tables import Cell, Climb, Phase, Ride

__all__ = [
    "beside_the_paper",
    "climbs_text",
    "header",
    "phases_text",
    "posts_text",
    "rates_text",
    "rides_text",
    "robots_text",
]

_RPM = 60.0 / (2.0 * math.pi)


def header(study: Study) -> str:
    """Say what is simulated, what is estimated and what is drawn."""
    base, design = study.base, study.design
    robot, outline = base.robot, base.robot.outline
    clearance = outline.rear_radius + min((y for _, y in robot.belly or ()), default=math.inf)
    build = ", ".join(f"{name} {value}" for name, value in build_info().items())
    obstacles = "; ".join(f"{name} {in_mm(h)} mm" for name, h in design.heights.items())
    return (
        f"Engineer without flippers, {len(study.models)} track models: {obstacles}\n"
        f"barrier 100 mm thick, knife edge 10 mm; {design.repeats} repeats, seed {study.seed}\n"
        f"build: {build}\n"
        f"estimates: mass {robot.mass} kg, centre of mass {robot.center_of_mass} m, "
        f"belly clearance {1e3 * clearance:.0f} mm,\n"
        f"  torque {robot.drivetrain.max_torque} N m per sprocket, "
        f"track mass {robot.track_mass} kg, "
        f"friction {getattr(base.terrain, 'friction', math.nan)}, speed {base.drive.speed} m/s\n"
        "drawn for each repeat, the same for every model: approach over a quarter of the axle\n"
        "  distance, track phase over a grouser pitch, speed and friction within 2 %"
    )


def rates_text(cells: Iterable[Cell]) -> str:
    """Write how often each model cleared."""
    rows = [
        (
            cell.model,
            cell.obstacle,
            mm(cell.height),
            f"{cell.cleared}/{cell.count}",
            f"{100 * cell.low:.0f} to {100 * cell.high:.0f} %",
            str(cell.poses),
            cell.others,
        )
        for cell in cells
    ]
    head = ("model", "obstacle", "[mm]", "cleared", "95 % interval", "poses", "other outcomes")
    return aligned(head, rows, left=(1, 6))


def climbs_text(models: Mapping[str, StudyModel], climbs: Sequence[Climb]) -> str:
    """Write the greatest height that each model clears, one row per model."""
    obstacles = list(dict.fromkeys(climb.obstacle for climb in climbs))
    rows = []
    for name, model in models.items():
        own = {climb.obstacle: climb for climb in climbs if climb.model == name}
        rows.append(
            (
                name,
                model.source,
                *(_highest(own[obstacle]) for obstacle in obstacles),
                _factor(own.values()),
                f"{1e3 * max(climb.max_penetration for climb in own.values()):.2f}",
            )
        )
    head = ("model", "paper", *obstacles, "RTF", "penetration")
    return (
        "Greatest height [mm] cleared in at least half of the runs (in brackets: smaller heights\n"
        "that were not; +: the greatest height tried), real-time factor on one thread, largest\n"
        "penetration of all runs [mm]\n\n"
    ) + aligned(head, rows, left=range(1, 2 + len(obstacles)))


def robots_text(cells: Sequence[Cell]) -> str:
    """Write how other estimates of the robot change the table."""
    robots = list(dict.fromkeys(cell.robot for cell in cells))
    names = dict.fromkeys(cell.model for cell in cells)
    heights = in_mm(dict.fromkeys(cell.height for cell in cells))
    rows = [
        (
            name,
            *(
                " ".join(str(c.cleared) for c in cells if (c.model, c.robot) == (name, robot))
                for robot in robots
            ),
        )
        for name in names
    ]
    count = cells[0].count
    return (f"Other robots: how many of {count} runs cleared a step of {heights} mm\n\n") + aligned(
        ("model", *robots), rows
    )


def rides_text(rides: Iterable[Ride]) -> str:
    """Write odometry error and vibration on flat ground."""
    rows = [
        (
            ride.model,
            f"{round(100 * ride.over_reading, 2) + 0.0:.2f}",
            f"{ride.vertical_acceleration:.2f}",
            f"{ride.angular_velocity:.3f}",
        )
        for ride in rides
    ]
    head = ("model", "odometry [%]", "acceleration [m/s^2]", "angle rate [rad/s]")
    return (
        "Flat ground: how much too far odometry reads, and vibration (root mean square of the\n"
        "vertical acceleration and of the rate of the chassis angle)\n\n"
    ) + aligned(head, rows)


def phases_text(phases: Sequence[Phase]) -> str:
    """Write the vibration of lines of gear wheels over their phases."""
    counts = list(dict.fromkeys(phase.count for phase in phases))
    by_place = {(phase.count, phase.phase_fraction): phase for phase in phases}
    rows = [
        (
            f"{fraction:.3f}",
            *(f"{by_place[count, fraction].vertical_acceleration:.2f}" for count in counts),
            *(f"{by_place[count, fraction].angular_velocity:.3f}" for count in counts),
        )
        for fraction in dict.fromkeys(phase.phase_fraction for phase in phases)
    ]
    head = ("phase", *(f"{n} [m/s^2]" for n in counts), *(f"{n} [rad/s]" for n in counts))
    return (
        "Lines of gear wheels on flat ground: vibration over the phase fraction of eq. (1), which\n"
        "is 0.333 in the paper\n\n"
    ) + aligned(head, rows)


def posts_text(posts: Iterable[Post]) -> str:
    """Write when the post was between two wheels of the public model."""
    rows = [
        (
            mm(post.height),
            "yes" if post.belly else "no",
            ", ".join(filter(None, (post.outcome, post.mechanism))),
            post.bodies,
            f"{post.start:.2f} to {post.end:.2f}",
            f"{1e3 * post.depth:.1f}",
            f"{post.force:.0f}",
        )
        for post in posts
    ]
    head = ("post [mm]", "belly", "outcome", "between", "time [s]", "depth [mm]", "force [N]")
    return (
        "The public wheel model, three wheels per side with gaps of 26 mm, against a post 20 mm\n"
        "thick: the time spans in which it was between two wheels\n\n"
    ) + aligned(head, rows, left=(1, 2, 3))


def beside_the_paper(models: Mapping[str, StudyModel], climbs: Sequence[Climb]) -> str:
    """Write the paper's Tables 2 and 3, with our models below the rows of their kind."""
    success = [
        (row.obstacle, *(f"{100 * share:.0f}" for share in (row.cwa, row.lwa, row.gear)))
        for row in published.TABLE_2
    ]
    rows: list[tuple[str, ...]] = []
    for theirs in published.TABLE_3:
        rows.append(
            (
                theirs.model,
                mm(theirs.max_height),
                *("", ""),
                f"{theirs.real_time_factor:g}",
                f"{theirs.max_speed:g}",
                f"{theirs.braking_distance:g}",
                f"{theirs.acceleration:g}",
                f"{_RPM * theirs.max_turn_rate:.1f}",
            )
        )
        for name in (name for name, model in models.items() if model.row == theirs.model):
            own = {climb.obstacle: climb for climb in climbs if climb.model == name}
            heights = (_highest(own[place]) for place in ("barrier", "step", "knife edge"))
            rows.append((f"    ours: {name}", *heights, _factor(own.values()), *("", "", "", "")))
    return "\n\n".join(
        (
            "The paper's Table 2, successful runs of 20 [%]",
            aligned(("obstacle", "CWA", "LWA", "gear wheels"), success),
            "The paper's Table 3, with ours below. Only the order of the heights can be compared:\n"
            "the paper's 150 and 200 mm are those of a robot with flippers. A side view has no\n"
            "turning. Heights in mm, speed in m/s, braking in m, acceleration in m/s^2, turning\n"
            "in revolutions per minute.",
            aligned(
                (
                    *("model", "barrier", "step", "knife edge"),
                    *("RTF", "speed", "braking", "acceleration", "turning"),
                ),
                rows,
                left=(1, 2, 3),
            ),
        )
    )


def _highest(climb: Climb) -> str:
    if math.isnan(climb.highest):
        return "none"
    more = "+" if climb.highest == climb.tested else ""
    gaps = f" (not {in_mm(climb.gaps)})" if climb.gaps else ""
    return f"{mm(climb.highest)}{more}{gaps}"


def _factor(climbs: Collection[Climb]) -> str:
    """Write the real-time factor on one thread."""
    simulated = sum(climb.simulated_time for climb in climbs)
    return f"{simulated / sum(climb.computing_time for climb in climbs):.0f}"
