"""Text of an audit for terminal, page and reports: sentences, rows and figures."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np

from crawler2d.audits.record import bodies_per_side, names_of
from crawler2d.audits.runs import round_speeds
from crawler2d.audits.verdicts import CLEARS, SEIZES, least_samples
from crawler2d.common.units import unit_of
from crawler2d.parameters.robot import Robot
from crawler2d.parameters.track import WheeledTrack
from crawler2d.results.record import NO_RESULT
from crawler2d.variation.distributions import (
    Distribution,
    Levels,
    LogUniform,
    Scaled,
    Shifted,
    Uniform,
    UniformInt,
    read_distribution,
)

if TYPE_CHECKING:
    import xarray
    from numpy.typing import NDArray

    from crawler2d.audits.record import AuditRecord, AuditSetup
    from crawler2d.audits.repairs import Repair, RepairSearch
    from crawler2d.audits.sampling import Assumption
    from crawler2d.audits.verdicts import Proportion, Verdict

__all__ = [
    "JAM_HEAD",
    "VERDICT_HEAD",
    "comparison",
    "conclusion",
    "confirmation",
    "holding_friction",
    "jam_row",
    "missing_results",
    "percent",
    "population",
    "range_of",
    "rate",
    "repair_sentence",
    "reservation",
    "robot_sentence",
    "run_count",
    "search_sentence",
    "seizure",
    "span",
    "subject",
    "unit_after",
    "verdict_line",
    "verdict_row",
    "wheel_names",
    "wheels_per_side",
    "worst_rates",
]

VERDICT_HEAD = ("obstacle", "runs", "clears", "seizes", "belt clears", "most often", "verdict")
NOT_DRIVEN = "-"
"""Shown instead of a rate if the belt did not drive because the robot clears the obstacle."""

_UPRIGHT = 100.0
"""[-] Friction, beyond any surface, above which a wall is vertical up to rounding."""

JAM_HEAD = ("obstacle", "between wheels", "runs", "slow to fast", "friction", "freed there by")

_SHORT = {"closed track": "belt", "closed track, clear of the ground": "belt set clear"}


def subject(audit: AuditSetup) -> str:
    """Describe the audited robot."""
    return audit.robot.description if audit.reading is None else audit.reading.description


def robot_sentence(audit: AuditSetup) -> str:
    """Describe mass, size and centre of mass of the robot."""
    robot = audit.robot
    outline = robot.outline
    x, y = robot.center_of_mass
    return (
        f"{robot.mass:.4g} kg, axle distance {1e3 * outline.axle_distance:.0f} mm, radius"
        f" {1e3 * outline.front_radius:.0f} mm; centre of mass {_side(x, 'ahead of', 'behind')} the"
        f" middle and {_side(y, 'above', 'below')} the axles"
    )


def population(audit: AuditSetup) -> str:
    """Describe the number of runs behind the rates, and their speeds."""
    samples, repeats = audit.call.samples, audit.call.repeats
    each = "1 run" if repeats == 1 else f"{repeats} runs"
    many = f"{samples} {_what_differs(audit)}, {each} each" if audit.unknown else each
    levels = audit.vary.get("drive.speed")
    factors = levels.factors if isinstance(levels, Levels) else (1.0,)
    speeds = audit.drive.speed * np.array(factors)
    text = f"at most {many}, {_speeds_and_sizes(speeds, audit)}; 95 % intervals"
    least = least_samples()
    if (samples if audit.unknown else repeats) < least:
        text += f'; "does not seize" takes {least} or more'
    return text


def _what_differs(audit: AuditSetup) -> str:
    """Name what differs between samples: robots, floors, or both."""
    on_floors = {path.startswith("terrain.") for path in audit.unknown}
    if on_floors == {True}:
        return "samples of the floor"
    return "samples of robot and floor" if True in on_floors else "samples of the robot"


def _speeds_and_sizes(levels: NDArray[np.float64], audit: AuditSetup) -> str:
    """Describe speeds [m/s] and obstacle sizes of the runs."""
    *slow, fast = (f"{speed:g}" for speed in np.unique(round_speeds(levels)).tolist())
    speeds = f"{', '.join(slow)} and {fast} m/s in turn" if slow else f"{fast} m/s"
    drawn = audit.vary.get("drive.speed")
    if audit.drive.schedule:
        speeds = "the speeds of its schedule"
    elif drawn is not None and not isinstance(drawn, Levels):
        about = range_of("drive.speed", drawn)
        speeds = f"{speeds}, {about}" if isinstance(drawn, Scaled | Shifted) else about
    sizes = audit.vary.get("terrain.height")
    if not isinstance(sizes, Scaled):
        return f"at {speeds}"
    return f"at {speeds}, obstacle sizes times {sizes.low:g} to {sizes.high:g}"


def missing_results(audit: AuditRecord) -> str:
    """Count runs without a result; "" if all have one."""
    count = int(np.isin(audit.table["outcome"].values, NO_RESULT).sum())
    text = f"{count} of {run_count(audit.table)} runs have no result: see `error` in the table"
    return text if count else ""


def verdict_row(each: Verdict) -> tuple[str, ...]:
    """Write a verdict with the columns `VERDICT_HEAD`."""
    return (
        each.obstacle,
        str(each.cleared.runs),
        rate(each.cleared),
        rate(each.seized),
        percent(each.belt_cleared.rate) if each.belt_outcome else NOT_DRIVEN,
        each.outcome.replace("_", " "),
        each.result,
    )


def verdict_line(each: Verdict) -> str:
    """Write a verdict in one line of a report."""
    own = "no run has a result"
    if each.cleared.runs:
        own = f"clears {rate(each.cleared)}, seizes {rate(each.seized)}"
    belt = "belt not simulated"
    if each.belt_outcome:
        has_result = each.belt_cleared.runs > 0
        belt = f"belt clears {percent(each.belt_cleared.rate)}" if has_result else "belt: no result"
    return f"{each.obstacle}: {each.result}; {own}, {belt}"


def run_count(table: xarray.Dataset) -> int:
    """Count the finished runs of a table."""
    return int((table["outcome"] != "").sum())


def jam_row(each: Verdict) -> tuple[str, ...]:
    """Describe where it jams and what frees it, with the columns `JAM_HEAD`."""
    at = "" if math.isnan(each.friction[0]) else span(each.friction, ".2f").replace(" to ", "-")
    freed = [
        f"{_SHORT.get(trial.trial, trial.trial)}: {trial.freed}"
        for trial in each.freed
        if trial.freed
    ]
    place = f"{each.jam_wheels} of the {each.carrier}"
    speeds = "/".join(f"{100 * rate.rate:.0f}" for rate in each.seized_at.values()) + " %"
    return each.obstacle, place, "/".join(map(str, each.jam_counts)), speeds, at, ", ".join(freed)


def wheel_names(audit: AuditRecord) -> str:
    """Return the file's names of the wheels of a jam; "" if there are none."""
    names = names_of(audit.robot, audit.reading)
    bodies = {
        int(body)
        for each in audit.verdicts
        if each.jam_wheels
        for body in each.jam_wheels.split("-")
    }
    count = bodies_per_side(audit.robot)
    left: list[str] = []
    right: list[str] = []
    for body in sorted(bodies & names.keys()):
        (left if body < count else right).append(f"{body} is {names[body]}")
    parts = (("in the file, on the left", left), ("on the right", right))
    return "; ".join(f"{side}, wheel {', '.join(called)}" for side, called in parts if called)


def reservation(audit: AuditSetup) -> str:
    """Warn that the model is probably not the intended robot; "" without an error of lint."""
    rules = list(dict.fromkeys(each.rule for each in audit.lint if each.severity == "error"))
    if not rules:
        return ""
    source = "robot as it is given" if audit.reading is None else "file as it is read"
    return (
        f"Lint has errors ({', '.join(rules)}): the verdict holds for the {source}, which is"
        " probably not the robot that is meant."
    )


def conclusion(audit: AuditRecord) -> list[str]:
    """Write the conclusion: whether it is void, where the robot seizes, and what is not certain."""
    sentences = [reservation(audit)] if reservation(audit) else []
    seized = [each for each in audit.verdicts if each.result == "seizes"]
    others = [
        f"{each.obstacle} ({each.seized_alone_count} of {each.jam_counts[1]})"
        for each in audit.verdicts
        if each.result != "seizes" and each.seized.low > SEIZES
    ]
    count = len(audit.verdicts)
    if not _has_wheels_for_tracks(audit.robot):
        sentences.append(
            "It has no wheels in place of a track, so no edge can jam between them: where it fails,"
            " it fails for another reason."
        )
    if seized:
        text = f"It seizes on {len(seized)} of {count} obstacles where the belt clears"
        sentences.append(f"{text}: {', '.join(map(_seizing, seized))}.")
    else:
        clears = sum(each.cleared.rate >= CLEARS for each in audit.verdicts)
        own = f"it clears {clears} of {count} obstacles in at least 95 % of its runs"
        failing = [each for each in audit.verdicts if each.cleared.rate < CLEARS]
        also = sum(each.belt_cleared.rate >= CLEARS for each in failing)
        belt = f"; of the other {len(failing)} the belt clears {also}" if failing else ""
        sentences.append(f"It was not found to seize where the belt clears; {own}{belt}.")
    sentences += list(_under_assumptions(audit.assumed))
    if others:
        text = (
            "It also seizes where the belt clears less than 95 % of its runs (in brackets, how many"
            " of the seized runs the belt clears with the same draws)"
        )
        sentences.append(f"{text}: {', '.join(others)}.")
    behind = [
        f"{each.obstacle} ({percent(each.cleared.rate)}, belt {percent(each.belt_cleared.rate)})"
        for each in audit.verdicts
        if each.result != "seizes" and each.clears_less
    ]
    if behind:
        text = "It clears less often than the belt where it was not found to seize"
        sentences.append(f"{text}: {', '.join(behind)}.")
    unsure = [each.obstacle for each in audit.verdicts if each.result == "not certain"]
    if unsure:
        sentences.append(f"Not certain, for want of runs: {', '.join(unsure)}.")
    return sentences


def _under_assumptions(assumed: Sequence[Assumption]) -> Iterator[str]:
    """Describe the seizures under each assumption, and which verdicts depend on it."""
    heads = {
        "rotor": "With a real drive, which holds its speed and has rotor inertia",
        "restitution": "With bouncing contacts",
    }
    for name, head in heads.items():
        own = [each for each in assumed if each.assumption == name]
        if own:
            runs = ", ".join(f"{each.obstacle} in {each.seized} of {each.runs}" for each in own)
            loose = [each.obstacle for each in own if not each.seizes]
            verdicts = f"the verdict{'s' * (len(loose) > 1)} on {', '.join(loose)}"
            effect = f"{verdicts} may depend" if loose else "no verdict depends"
            drawn = ", ".join(
                f"{_path_text(path)} {range_of(path, each)}" for path, each in own[0].drawn.items()
            )
            yield f"{head} ({drawn}), it seizes on: {runs}; {effect} on that."


def _path_text(path: str) -> str:
    """Write a path in words.

    Examples
    --------
    >>> _path_text("robot.flippers.rotor_inertia"), _path_text("robot.drivetrain.rotor_inertia")
    ('rotor inertia of a flipper', 'rotor inertia of a track')
    """
    place, _, field = path.rpartition(".")
    of = {"robot.flippers": " of a flipper", "robot.drivetrain": " of a track"}.get(place, "")
    return field.replace("_", " ") + of


def _has_wheels_for_tracks(robot: Robot) -> bool:
    """Whether wheels replace a track, on the chassis or on flippers."""
    arms = robot.flippers
    tracks = [robot.track, *([] if arms is None else [arms.track or robot.track])]
    return any(
        isinstance(each, WheeledTrack) and getattr(each, "as_track", True) for each in tracks
    )


def _seizing(verdict: Verdict) -> str:
    """Name an obstacle that seizes; if the belt clears less than 95 %, with the comparison."""
    if verdict.belt_cleared.rate >= CLEARS:
        return verdict.obstacle
    of_all = f"{verdict.seized_alone_count} of {verdict.jam_counts[1]} seized runs"
    belt = f"the belt clears {of_all}, and {percent(verdict.belt_cleared.rate)} of all"
    return f"{verdict.obstacle} ({belt})"


def seizure(verdict: Verdict, names: Sequence[str] = ()) -> str:
    """Describe a seizure on an obstacle, and the belt there, in a sentence."""
    called = f" ({', '.join(names)})" if names else ""
    return (
        f"seizes on {verdict.obstacle} in {rate(verdict.seized)} of the runs, most often between"
        f" wheels {verdict.jam_wheels} of the {verdict.carrier}{called}; the belt clears"
        f" {verdict.seized_alone_count} of {verdict.jam_counts[1]} seized runs, and"
        f" {percent(verdict.belt_cleared.rate)} of all"
    )


def search_sentence(search: RepairSearch, audit: AuditSetup) -> str:
    """Describe the result of the search for repairs, and its runs."""
    runs = f"in new runs {_speeds_and_sizes(search.table['speed'].values, audit)}"
    if any(each.confirmed for each in search.repairs):
        return f"the best of {search.candidate_count} candidates, {runs}"
    return f"none of {search.candidate_count} candidates was confirmed {runs}"


def worst_rates(repair: Repair) -> tuple[Proportion, Proportion, str]:
    """Return the worst rates of a repair: clearing where the belt does, seizing, and where.

    No comparison is the worst case: the belt clears none of the fresh runs. The worst rate of
    seizing is over all speeds or at one of them.
    """
    cleared = min(repair.cleared_given_belt.values(), key=lambda each: (each.runs > 0, each.rate))
    rates = list(repair.seized.items())
    for obstacle, at in repair.seized_at.items():
        rates += [(f"{obstacle} at {speed:g} m/s", each) for speed, each in at.items()]
    driven = [(where, each) for where, each in rates if each.runs]
    name, seized = max(driven, key=lambda item: (item[1].low, item[1].rate))
    return cleared, seized, name if seized.rate > 0.0 else ""


def repair_sentence(repair: Repair) -> str:
    """Describe a repair and its result."""
    _, seized, name = worst_rates(repair)
    where = f", on {name}" if name else ""
    return (
        f"{confirmation(repair)}: {repair.description}; {comparison(repair)}; seizes at worst in"
        f" {rate(seized)}{where}; {wheels_per_side(repair)}; simulated {repair.speed:.2g} times as"
        " fast"
    )


def comparison(repair: Repair) -> str:
    """Compare a repair with the belt where the robot seized, if the belt clears there."""
    cleared, _, _ = worst_rates(repair)
    if cleared.runs:
        return f"clears at worst {rate(cleared)} of the runs that the belt clears where it seized"
    alone = [name for name, each in repair.cleared_given_belt.items() if not each.runs]
    return f"the belt clears none of the new runs on {', '.join(alone)} (0 to compare with)"


def wheels_per_side(repair: Repair) -> str:
    """Describe the wheels of a side, or its belt."""
    return f"{repair.wheels} wheels a side" if repair.wheels else "belt"


def confirmation(repair: Repair) -> str:
    """Say whether fresh runs confirm a repair."""
    return "confirmed" if repair.confirmed else "not confirmed"


def range_of(path: str, distribution: Distribution) -> str:
    """Write the range of a distribution in words, with the unit of its field."""
    own = unit_after(path)
    match distribution:
        case Uniform(low, high) | LogUniform(low, high):
            return f"{low:g} to {high:g}{own}"
        case UniformInt(low, high):
            return f"{low} to {high}"
        case Scaled(low, high):
            return f"times {low:g} to {high:g}"
        case Levels(factors):
            return f"times {', '.join(f'{each:.3g}' for each in factors)} in turn"
        case Shifted():
            of = str(distribution.unit or "").rpartition(".")[2].replace("_", " ")
            unit = f" of the {of}" if of else own
            return f"{distribution.low:+g} to {distribution.high:+g}{unit}"
    return str(read_distribution(distribution, path))  # SciPy's have no text of their own


def unit_after(path: str) -> str:
    """Return the unit of a field, after a space; "" if it has none."""
    unit = unit_of(path)
    return "" if unit in (None, "1") else f" {unit}"


def holding_friction(frictions: Sequence[float]) -> str:
    """Describe the friction at which pockets hold by their walls alone.

    Examples
    --------
    >>> holding_friction([0.84, 1.535]), holding_friction([0.84, 0.84])
    ('at a friction below 0.84 to 1.53', 'at a friction below 0.84')
    >>> holding_friction([1.0, math.inf]), holding_friction([3e7])
    ('at a friction below 1.00 or at any friction', 'at any friction')
    """
    steep = [each for each in frictions if each >= _UPRIGHT]
    others = [each for each in frictions if each < _UPRIGHT]
    parts = [f"at a friction below {span(others, '.2f')}"] if others else []
    return " or ".join(parts + ["at any friction"] * bool(steep))


def _side(length: float, positive: str, negative: str) -> str:
    return f"{1e3 * abs(length):.0f} mm {positive if length >= 0.0 else negative}"


def span(values: Sequence[float], digits: str) -> str:
    """Write the smallest and the largest number."""
    low, high = (format(bound, digits) for bound in (min(values), max(values)))
    return low if low == high else f"{low} to {high}"


def percent(rate: float) -> str:
    """Write a rate in percent."""
    return "no result" if math.isnan(rate) else f"{100 * rate:.0f} %"


def rate(of: Proportion) -> str:
    """Write a rate with its interval, in percent."""
    interval = f" ({100 * of.low:.0f}-{100 * of.high:.0f})" if of.runs else ""
    return f"{percent(of.rate)}{interval}"
