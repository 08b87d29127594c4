"""Rules of lint that need no file: size, mass, torque, inertia, stretches without a track."""

from __future__ import annotations

import math
from collections.abc import Iterator

from crawler2d.audits.finding import Finding
from crawler2d.parameters.robot import Robot
from crawler2d.parameters.track import ForceTrack, HybridWheels, LineOfWheels

__all__ = ["of_robot"]

_SHORTEST, _LONGEST = 0.1, 3.0
"""[m] Tracked robots that climb obstacles lie between; files in centimetres or inches do not."""

_LIGHTEST, _HEAVIEST = 30.0, 8000.0
"""[kg/m^3] Mass by the space between the tracks: hollow robots have 100 to 1000, steel 7850."""

_STRONGEST = 5.0
"""[-] Tractive effort by weight: no floor takes more than the friction times the weight."""

_GRAVITY = 9.81


def of_robot(robot: Robot) -> Iterator[Finding]:
    """Find what a robot has that no robot has.

    Parameters
    ----------
    robot : Robot
        Any robot.

    Examples
    --------
    >>> import crawler2d as c2d
    >>> robot = c2d.Robot.simple(20.0, axle_distance=4.0, radius=0.6)
    >>> [(found.rule, found.severity) for found in of_robot(robot)]
    [('size', 'error'), ('mass', 'warning')]
    """
    outline = robot.outline
    length = outline.axle_distance + outline.front_radius + outline.rear_radius
    height = 2.0 * max(outline.front_radius, outline.rear_radius)
    if not _SHORTEST <= length <= _LONGEST:
        what = f"{length:.3g} m long without flippers; tracked robots have 0.1 to 3 m"
        if length > _LONGEST and _SHORTEST <= 0.1 * length <= _LONGEST:
            what += ": is it ten times too large? scale=0.1 reads it so"
        yield Finding(rule="size", severity="error", what=what)
    space = length * height * (robot.gauge + outline.front_radius)
    if not _LIGHTEST <= robot.mass / space <= _HEAVIEST:
        what = (
            f"{robot.mass:.4g} kg in {space:.3g} m^3 are {robot.mass / space:.3g} kg/m^3;"
            f" robots have {_LIGHTEST:g} to {_HEAVIEST:g}"
        )
        yield Finding(rule="mass", severity="warning", what=what)
    yield from _inertia(robot, length, height)
    yield from _torque(robot)
    yield from _bare(robot)
    if isinstance(robot.track, ForceTrack) and robot.track.support == "wheels":
        what = "the wheels turn freely and a force pushes the chassis: nothing drives them"
        yield Finding(rule="not driven", severity="error", what=what)


def _inertia(robot: Robot, length: float, height: float) -> Iterator[Finding]:
    """Compare the radius of gyration with the farthest that any part can be from the middle."""
    arms = 0.0 if robot.flippers is None else robot.flippers.length + robot.flippers.tip_radius
    corners = [abs(y) for _, y in robot.belly or ()] + [0.5 * height]
    farthest = math.hypot(0.5 * length + arms, max(corners))
    gyration = math.sqrt(robot.moment_of_inertia / robot.mass)
    if gyration > farthest:
        what = (
            f"a moment of inertia of {robot.moment_of_inertia:.3g} kg m^2 puts the mass"
            f" {gyration:.3g} m from its centre, but no part is farther than {farthest:.3g} m:"
            " it pitches too slowly"
        )
        yield Finding(rule="inertia", severity="error", what=what)


def _torque(robot: Robot) -> Iterator[Finding]:
    outline, most = robot.outline, robot.drivetrain.max_torque
    effort = 2.0 * most / (min(outline.front_radius, outline.rear_radius) - outline.grouser_height)
    ratio = effort / (robot.mass * _GRAVITY)
    if ratio > _STRONGEST:
        what = (
            f"{most:.3g} N m a track push with {ratio:.0f} times the weight: as good as no limit,"
            " so a jam ends only where the friction gives way"
        )
        yield Finding(rule="effort", severity="warning", what=what)


def _bare(robot: Robot) -> Iterator[Finding]:
    """Tell of stretches that no wheel and no belt carries."""
    track = robot.track
    if isinstance(track, LineOfWheels) and not track.as_track:
        bare = robot.outline.axle_distance - robot.outline.front_radius - robot.outline.rear_radius
        what = (
            "no round shape between the end wheels of the chassis, where a track should be:"
            f" {1e3 * bare:.0f} mm are bare"
        )
        yield Finding(rule="no track", severity="error", what=what)
    arms = robot.flippers
    own = None if arms is None else (arms.track or track)
    if arms is not None and isinstance(own, HybridWheels) and len(own.placements) == 1:
        what = (
            f"one wheel a flipper: the {1e3 * arms.length:.0f} mm from its pivot to that wheel"
            " are bare, where a track should be"
        )
        yield Finding(rule="no track", severity="error", what=what)
