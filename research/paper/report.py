"""Tables 1 and 3, eq. (1), claims and figures of the paper beside ours, in Markdown."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

from research.columns import in_mm, mm, percent
from research.markdown import markdown_table
from research.paper import published
from research.paper.figures import DRAWN, NOT_DRAWN

if TYPE_CHECKING:
    from research.paper.claim import Claim
    from research.paper.performance import Computing, Driving, Height, Slope
    from research.paper.phases import Phase, Shaking
    from research.paper.stuck import Stuck

__all__ = [
    "checks_text",
    "claims_text",
    "computing_text",
    "equation_text",
    "figures_text",
    "heights_text",
    "table_1_text",
    "table_3_text",
]

_RPM = 60.0 / (2.0 * math.pi)


def table_1_text(slopes: Sequence[Slope], rows: Sequence[Driving]) -> str:
    """Set the paper's Table 1 beside ours."""
    robot = published.TABLE_1
    stand_in = next(row for row in rows if row.row == published.REAL_ROBOT)
    figures = [
        (
            "max. speed [m/s]",
            f"{robot.max_speed:g}",
            f"{robot.declared_max_speed:g}",
            f"{stand_in.full_speed:.2f}, limited by {stand_in.full_speed_limit}",
        ),
        (
            "max. turn rate [rpm]",
            f"{_RPM * robot.max_turn_rate:.1f}",
            "-",
            "a side view has no turning",
        ),
        (
            "max. slope [deg]",
            f"{_deg(robot.max_slope)}",
            f"{_deg(robot.declared_max_slope)}",
            "see below: at most the arc tangent of the friction",
        ),
        (
            "stopping distance [m]",
            f"{robot.stopping_distance:g}",
            "-",
            f"{stand_in.braking:.3f} from 0.4 m/s, limited by {stand_in.braking_limit}",
        ),
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
    """Set speed, braking and acceleration of the paper's Table 3 beside ours, row by row."""
    theirs = {row.model: row for row in published.TABLE_3}
    driven = [
        (
            row.row,
            row.model,
            f"{theirs[row.row].max_speed:g}",
            f"{row.speed:.3f} ({row.full_speed:.2f})",
            f"{theirs[row.row].braking_distance:g}",
            f"{row.braking:.3f}",
            f"{theirs[row.row].acceleration:g}",
            f"{row.acceleration:.3f}",
            f"{_RPM * theirs[row.row].max_turn_rate:.1f}",
        )
        for row in rows
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
    """Set the highest obstacles of the paper's Table 3 beside ours."""
    settings = list(dict.fromkeys(height.setting for height in heights))
    climbed = []
    for row in dict.fromkeys(height.row for height in heights):
        own = {each.setting: each for each in heights if each.row == row}
        first = own[settings[0]]
        climbed.append((first.model, mm(first.paper), *(_height(own[s]) for s in settings)))
    return (
        "Highest parallelepiped [mm] on level ground, 100 mm thick, with flippers and the gait"
        f" `Climb`: the greatest height that half of {heights[0].repeats} runs cleared, in"
        " brackets lower ones that they did not; then how most runs end on the next."
        f"\n\n{markdown_table(('layout', 'paper', *settings), climbed)}"
    )


def computing_text(factors: Sequence[Computing]) -> str:
    """Set the real-time factors of the paper's Table 3 beside ours."""
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


def equation_text(phases: Sequence[Phase], shaken: Sequence[Shaking]) -> str:
    """Tell how the gears' starting angles compare with eq. (1), and how much they shake."""
    count = 2 * sum(phase.count for phase in phases)
    off = max(phase.off for phase in phases)
    table = [
        (
            str(row.count),
            f"{row.fraction:.3f}",
            f"{1e3 * row.swing:.2f}",
            f"{math.degrees(row.rocking):.2f}",
            f"{row.vibration:.2f}",
        )
        for row in shaken
    ]
    head = ("gears", "phase fraction", "swing [mm]", "rocking [deg]", "vibration [m/s^2]")
    return "\n\n".join(
        (
            f"The starting angles of {count} gears, of {len(phases)} robots with their flippers,"
            f" are those of eq. (1) within {off:.0e} rad (up to whole grousers).",
            "Lines of gears on level ground at 0.4 m/s, no flippers: how far the chassis goes up"
            " and down and to and fro, and its vertical acceleration, root mean square.",
            markdown_table(head, table),
        )
    )


def claims_text(claims: Sequence[Claim]) -> str:
    """List the claims with their verdicts."""
    rows = [
        (str(number), claim.text, f"**{claim.verdict}**") for number, claim in enumerate(claims, 1)
    ]
    return markdown_table(("", "claim", "verdict"), rows)


def checks_text(claims: Sequence[Claim]) -> str:
    """List the experiment and the checks behind each verdict."""
    verdicts = {True: "yes", False: "no", None: "not shown"}
    rows = []
    for number, claim in enumerate(claims, 1):
        rows.append((str(number), f"section {claim.section}: {claim.experiment}", "", ""))
        rows += [
            (str(number), check.what, verdicts[check.holds], check.found) for check in claim.checks
        ]
    head = ("claim", "experiment, then what it must show", "shown", "found")
    return f"Counts are runs that cleared of all.\n\n{markdown_table(head, rows)}"


def figures_text(stuck: Sequence[Stuck], folder: str) -> str:
    """List the figures: what is drawn, what is replayed from a folder, what can be neither."""
    rows = [(str(each.number), each.caption, "drawn") for each in DRAWN]
    replayed = {str(each.figure): f"replayed in `{folder}/{each.file}`" for each in stuck}
    rows += [(number, what, replayed.get(number, "")) for number, what in NOT_DRAWN.items()]
    said = [
        f"Fig. {each.figure}, {each.model}, {each.where}: {each.run.diagnosis}" for each in stuck
    ]
    table = markdown_table(
        ("figure", "what it shows", "here"),
        sorted(rows, key=lambda row: int(row[0].split()[0])),
    )
    return "\n\n".join((table, *said))


def _height(row: Height) -> str:
    if math.isnan(row.highest):
        return f"none; {row.limit.replace('_', ' ')}"
    gaps = f" (not {in_mm(row.gaps)})" if row.gaps else ""
    return f"{mm(row.highest)}{gaps}; {row.limit.replace('_', ' ')}"


def _deg(angle: float) -> str:
    return f"{math.degrees(angle):.0f}"
