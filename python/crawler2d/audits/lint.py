"""Lint: probable mistakes in a model of a robot, by written rules; one row for each rule broken."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace

import numpy as np

from crawler2d.model_tree import Joint, Link, Where
from crawler2d.parameters.robot import Robot
from crawler2d.parameters.track import ForceTrack, HybridWheels, LineOfWheels
from crawler2d.reading.loading import size_of
from crawler2d.reading.log import lines, list_names
from crawler2d.reading.reading import Reading
from crawler2d.reading.wheels import farthest

__all__ = [
    "RULES",
    "SEVERITIES",
    "Finding",
    "body_findings",
    "lint",
    "model_findings",
    "robot_findings",
    "wheel_links",
]

SEVERITIES = ("error", "warning", "note")
"""An error: another robot is simulated; a warning: hardly meant; a note: to be known."""

RULES = {
    "size": "The robot is as long as tracked robots are.",
    "mass": "The robot is neither as light as a balloon nor as heavy as steel.",
    "inertia": "Bodies have moments of inertia that a body of their size can have.",
    "placeholder": "Three equal moments of inertia belong to balls and cubes.",
    "no track": "A round shape stands wherever a track should be.",
    "effort": "Motors have a limit of effort, and the tracks push with no more than floors take.",
    "not driven": "Every wheel has a motor.",
    "friction": "Wheels and tracks have a friction that surfaces have.",
    "balance": "The centre of mass of a wheel is on its axle.",
    "sides": "Left and right are alike.",
    "overlap": "Wheels of one side do not push each other apart.",
    "doubt": "Nothing is doubted by the reader or by the simulator.",
}
"""Every rule, as what a model that keeps it is like; ``docs/conventions.md`` says when it fires."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Finding:
    """One thing that lint found.

    Parameters
    ----------
    rule : str
        Name of the rule, as in ``docs/conventions.md``.
    severity : {"error", "warning", "note"}
        With an error another robot is simulated than is meant, a warning is hardly meant, a note is
        to be known.
    what : str
        What was found, with its figures.
    where : str
        File and lines; "" for a robot that was not read from a file.
    """

    rule: str
    severity: str
    what: str
    where: str = ""


_SHORTEST, _LONGEST = 0.1, 3.0
"""[m] Tracked robots that climb obstacles lie between; files in centimetres or inches do not."""

_LIGHTEST, _HEAVIEST = 30.0, 8000.0
"""[kg/m^3] Mass by the space between the tracks: hollow robots have 100 to 1000, steel 7850."""

_STRONGEST = 5.0
"""[-] Tractive effort by weight: no floor takes more than the friction times the weight."""

_GRAVITY = 9.81


def robot_findings(robot: Robot) -> Iterator[Finding]:
    """Find what a robot has that no robot has.

    Parameters
    ----------
    robot : Robot
        Any robot.

    Examples
    --------
    >>> import crawler2d as c2d
    >>> robot = c2d.Robot.simple(20.0, axle_distance=4.0, radius=0.6)
    >>> [(found.rule, found.severity) for found in robot_findings(robot)]
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


_STICKIEST = 2.0
"""[-] Rubber tracks on concrete have up to 1; more is meant to stop sliding, not measured."""

_OFF_AXLE = 0.1
"""[-] Share of its radius by which the centre of mass of a wheel may lie off its axle."""

_SAME = 1e-6
"""[m] Last digit of the files: sides that differ by less are equal."""


def model_findings(reading: Reading) -> Iterator[Finding]:
    """Find what a file says that is hardly meant.

    Parameters
    ----------
    reading : Reading
        What was read.
    """
    yield from _friction(reading)
    yield from _effort(reading)
    yield from _driven(reading)
    yield from _sides(reading)
    yield from _balance(reading)
    for doubt in reading.doubts:
        line = re.search(re.escape(reading.tree.file) + r"[^:]*:[0-9]+", doubt)
        where = line[0] if line else reading.tree.file
        yield Finding(rule="doubt", severity="warning", what=doubt, where=where)


def wheel_links(reading: Reading) -> list[tuple[Link, Joint]]:
    """Return the links of all wheels with the joints that they turn on; drums have none."""
    joints = reading.tree.joints
    named = set(reading.wheels["name"].tolist())  # that of a drum has its shape, too
    return [(link, joints[link.name]) for link in reading.tree.links if link.name in named]


def _carrying(reading: Reading) -> list[Link]:
    """Return the links of wheels and drums."""
    shown = set(reading.wheels["line"].tolist())
    return [link for link in reading.tree.links if link.at.line in shown]


def _friction(reading: Reading) -> Iterator[Finding]:
    """Take the coefficients as they are written: an engine may combine them to less."""
    found = [
        (coefficient, at)
        for link in _carrying(reading)
        for shape in link.shapes
        if shape.friction is not None
        for coefficient, at in (
            (shape.friction.first, shape.friction.first_at),
            (shape.friction.second, shape.friction.second_at),
        )
        if coefficient > _STICKIEST
    ]
    if not found:
        return
    largest = max(coefficient for coefficient, _ in found)
    what = (
        f"friction of {largest:g}; tracks have 0.3 to 1. By the rule of {reading.engine} it counts"
        f" as {reading.friction:g} on a floor, other engines may take it as it is"
    )
    severity = "error" if reading.friction > _STICKIEST else "warning"
    where = lines([at for _, at in found])
    yield Finding(rule="friction", severity=severity, what=what, where=where)


def _effort(reading: Reading) -> Iterator[Finding]:
    wheels = [joint for _, joint in wheel_links(reading)]
    without = [joint for joint in wheels if not joint.effort or not math.isfinite(joint.effort)]
    if not without:
        return
    torque = reading.robot.drivetrain.max_torque
    what = (
        f"{len(without)} of {len(wheels)} wheels have no effort limit: their motors hold the speed"
        f" under any load; here they have {torque:.3g} N m a track, an estimate"
    )
    where = lines([joint.effort_at for joint in without])
    yield Finding(rule="effort", severity="warning", what=what, where=where)


def _driven(reading: Reading) -> Iterator[Finding]:
    """Tell of wheels for which the file names no motor: something outside must turn them."""
    wheels = [joint for _, joint in wheel_links(reading)]
    idle = [joint for joint in wheels if joint.name not in reading.tree.driven]
    if not idle:
        return
    names = list_names([joint.child for joint in idle])
    what = (
        f"the file names no motor for {len(idle)} of {len(wheels)} wheels ({names}); here all are"
        " driven, as by a controller outside it: those that nothing turns drag"
    )
    where = lines([joint.at for joint in idle])
    yield Finding(rule="not driven", severity="note", what=what, where=where)


def _sides(reading: Reading) -> Iterator[Finding]:
    """Compare left and right, wheel by wheel in the order of the table."""
    table = reading.wheels
    left, right = (table["side"] == side for side in ("left", "right"))
    if left.sum() != right.sum():  # double wheels: the reader has paired them
        return
    off = {
        name: np.abs(table[name][left] - table[name][right])
        for name in ("x", "y", "radius", "mass")
    }
    worst = max(float(off[name].max()) for name in ("x", "y", "radius"))
    heavier = float((off["mass"] / np.maximum(table["mass"][left], 1e-9)).max())
    if worst <= _SAME and heavier <= _SAME:
        return
    index = int(np.argmax(off["x"] + off["y"] + off["radius"] + off["mass"]))
    what = (
        f"left and right differ by up to {1e3 * worst:.3g} mm and {heavier:.2g} of a wheel's mass,"
        f" most at {table['name'][left][index]}; here both have the mean"
    )
    where = f"{reading.tree.file}:{table['line'][left][index]}, {table['line'][right][index]}"
    yield Finding(rule="sides", severity="note", what=what, where=where)


def _balance(reading: Reading) -> Iterator[Finding]:
    """Find wheels that are out of balance: what turns with them is swung round the axle."""
    radii = dict(
        zip(reading.wheels["name"].tolist(), reading.wheels["radius"].tolist(), strict=True)
    )
    off = [
        (math.hypot(*np.cross(joint.axis, link.center - joint.place)), link)
        for link, joint in wheel_links(reading)
    ]
    found = [(away, link) for away, link in off if away > _OFF_AXLE * radii[link.name]]
    if found:
        most = max(away for away, _ in found)
        names = list_names([link.name for _, link in found])
        what = (
            f"{names}: their centres of mass are off their axles by up to {1e3 * most:.3g} mm: such"
            " wheels shake a robot as they turn; here they are in balance"
        )
        where = lines([link.mass_at for _, link in found])
        yield Finding(rule="balance", severity="warning", what=what, where=where)


_SLACK = 1.05
"""[-] Files round inertias: a body may be that much larger than its shapes."""

_MATTERS = 0.01
"""[-] A share of the robot's mass: links below it move nothing."""

_ON_SELF = re.compile(r"<self_collide>\s*(1|true)\s*<", re.IGNORECASE)
_LINK = re.compile(r"<link\s+name\s*=\s*[\"']([^\"']*)[\"'].*?</link>", re.DOTALL)
_FILTERED = re.compile(r"contype|conaffinity|<exclude")


def body_findings(reading: Reading) -> Iterator[Finding]:
    """Find links whose inertia no body has, and wheels that overlap.

    Parameters
    ----------
    reading : Reading
        What was read.
    """
    links = [link for link in reading.tree.links if link.mass > 0.0 and link.inertia.any()]
    whole = size_of(reading.tree)
    mass = reading.robot.mass
    broken = [link for link in links if _breaks_triangle(link)]
    what = "the largest principal moment of inertia exceeds the sum of the others: no body has that"
    yield from _told(broken, "inertia", what, mass)
    reached = [(link, _reach(link) if link.shapes else whole) for link in links]
    too_large = [link for link, reach in reached if _gyration(link) > _SLACK * reach]
    what = "the radius of gyration is larger than the body: such a link turns too slowly"
    yield from _told(too_large, "inertia", what, mass)
    alike = [link for link in links if _is_ball(link) and link not in too_large]
    what = "three equal moments of inertia, which only a ball or a cube has: placeholders?"
    yield from _told(alike, "placeholder", what, mass)
    yield from _overlaps(reading)


def _told(links: list[Link], rule: str, what: str, mass: float) -> Iterator[Finding]:
    """Tell of links at once, the heaviest first, and of those that move nothing apart."""
    order = sorted(links, key=lambda link: -link.mass)
    heavy = [link for link in order if link.mass >= _MATTERS * mass]
    light = [link for link in order if link.mass < _MATTERS * mass]
    for each, severity in (
        (heavy, "warning" if rule == "placeholder" else "error"),
        (light, "note"),
    ):
        if each:
            told = f"{list_names([link.name for link in each])}: {what}"
            where = lines([link.at for link in each])
            yield Finding(rule=rule, severity=severity, what=told, where=where)


def _moments(link: Link) -> np.ndarray[tuple[int]]:
    moments: np.ndarray[tuple[int]] = np.linalg.eigvalsh(link.inertia)
    return moments


def _breaks_triangle(link: Link) -> bool:
    low, middle, high = _moments(link)
    return bool(high > (low + middle) * 1.01)


def _gyration(link: Link) -> float:
    """[m] Return the radius of gyration about the axis that has the largest."""
    return math.sqrt(float(_moments(link)[-1]) / link.mass)


def _is_ball(link: Link) -> bool:
    low, _, high = _moments(link)
    if high - low > 1e-6 * high or any(shape.kind == "sphere" for shape in link.shapes):
        return False
    cubes = [shape for shape in link.shapes if shape.kind == "box" and np.ptp(shape.size) < 1e-9]
    return not cubes


def _reach(link: Link) -> float:
    """[m] Return how far the shapes of a link reach from its centre of mass."""
    return max(farthest(shape, link.center) for shape in link.shapes)


def _overlaps(reading: Reading) -> Iterator[Finding]:
    """Find wheels of one side that lie inside each other, and whether an engine lets them touch."""
    places: list[Where] = []
    count, deepest = 0, 0.0
    names: set[str] = set()
    rows = [
        (shape.pose.place, shape.radius, shape.length, joint.axis, link)
        for link, joint in wheel_links(reading)
        for shape in link.shapes
        if shape.radius > 0.0
    ]
    for index, (place, radius, length, axis, link) in enumerate(rows):
        for other, its_radius, its_length, _, its_link in rows[index + 1 :]:
            apart = other - place
            across = abs(float(apart @ axis))
            if its_link is link or across >= 0.5 * (length + its_length):
                continue
            depth = radius + its_radius - float(np.linalg.norm(apart - (apart @ axis) * axis))
            if depth > 1e-6:
                count, deepest = count + 1, max(deepest, depth)
                places += [link.at, its_link.at]
                names |= {link.name, its_link.name}
    if not count:
        return
    severity, engine = _on_self(reading, names)
    what = f"{count} pairs of wheels overlap, by up to {1e3 * deepest:.0f} mm: {engine}"
    yield Finding(rule="overlap", severity=severity, what=what, where=lines(places))


def _on_self(reading: Reading, names: set[str]) -> tuple[str, str]:
    """Tell whether wheels of a model that overlap would collide with each other."""
    if reading.tree.format.startswith("SDF"):
        links = {match[1] for match in _LINK.finditer(reading.text) if _ON_SELF.search(match[0])}
        if _ON_SELF.search(_LINK.sub("", reading.text)) or links & names:
            return "error", "self_collide is on, so they push each other apart"
        return "note", "self_collide is off, so they pass through each other"
    if reading.tree.format == "MJCF":
        if _FILTERED.search(reading.text):
            return "note", "the file filters some contacts; are those of these wheels among them?"
        return "error", "MuJoCo lets children of one body collide: exclude these contacts"
    return "note", "switch self-collision off where the file is loaded, or they push each other"


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
    found = list(robot_findings(robot))
    if reading is not None:
        found = [replace(each, where=_where(each, reading)) for each in found]
        found += [*model_findings(reading), *body_findings(reading)]
    found += [Finding(rule="doubt", severity="warning", what=doubt) for doubt in doubts]
    return tuple(sorted(found, key=lambda each: SEVERITIES.index(each.severity)))


def _where(finding: Finding, reading: Reading) -> str:
    sources = reading.sources
    return next((sources[path] for path in _PLACES.get(finding.rule, ()) if path in sources), "")
