"""Lint: what is hardly meant in a model of a robot, by written rules."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

from crawler2d.audits import lint_bodies, lint_model, lint_robot
from crawler2d.audits.finding import SEVERITIES, Finding
from crawler2d.parameters.robot import Robot
from crawler2d.reading.reading import Reading

__all__ = ["lint"]

# Where a file says what a rule about the robot found: the first of these that it states.
_PLACES: dict[str, tuple[str, ...]] = {
    "size": ("robot.outline.axle_distance", "robot.outline.discs"),
    "mass": ("robot.mass",),
    "inertia": ("robot.moment_of_inertia",),
    "effort": ("robot.drivetrain.max_torque",),
    "no track": ("robot.track",),
}


def lint(
    robot: Robot, reading: Reading | None = None, doubts: Iterable[str] = ()
) -> tuple[Finding, ...]:
    """Find what is hardly meant in a robot, and in the file that it was read from.

    Parameters
    ----------
    robot : Robot
        The robot.
    reading : Reading, optional
        Where it was read from.
    doubts : iterable of str
        What the simulator doubted; see `Scenario.validate`.

    Returns
    -------
    tuple of Finding
        Errors first. Empty if no rule is broken.

    Examples
    --------
    >>> import crawler2d as c2d
    >>> lint(c2d.robots.engineer())
    ()
    >>> marv = c2d.robots.marv(track="public")
    >>> print(lint(marv)[0].what)
    no round shape between the end wheels of the chassis, where a track should be: 279 mm are bare
    """
    found = list(lint_robot.of_robot(robot))
    if reading is not None:
        found = [replace(each, where=_where(each, reading)) for each in found]
        found += [*lint_model.of_model(reading), *lint_bodies.of_bodies(reading)]
    found += [Finding(rule="doubt", severity="warning", what=doubt) for doubt in doubts]
    return tuple(sorted(found, key=lambda each: SEVERITIES.index(each.severity)))


def _where(finding: Finding, reading: Reading) -> str:
    sources = reading.sources
    return next((sources[path] for path in _PLACES.get(finding.rule, ()) if path in sources), "")
