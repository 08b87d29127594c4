"""Lint: find probable mistakes in a model of a robot by a table of rules."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from crawler2d.audits.drives import opposed, other_radius
from crawler2d.common.bodies import belly_corners
from crawler2d.model_tree import Joint, Link, Where
from crawler2d.parameters.flippers import reach_of
from crawler2d.parameters.robot import Robot
from crawler2d.parameters.track import ForceTrack, HybridWheels, LineOfWheels
from crawler2d.reading.engines import ENGINES
from crawler2d.reading.loading import size_of
from crawler2d.reading.log import lines, list_names
from crawler2d.reading.parts import wheel_torques
from crawler2d.reading.reading import Reading
from crawler2d.reading.wheels import farthest, subtrees

__all__ = ["RULES", "SEVERITIES", "Finding", "lint"]

SEVERITIES = ("error", "warning", "note")
"""Severities: not the intended robot, probably a mistake, information."""

_SHORTEST, _LONGEST = 0.1, 3.0
"""[m] Range of tracked robots that climb obstacles; files in centimetres or inches are outside."""

_LIGHTEST, _HEAVIEST = 30.0, 8000.0
"""[kg/m^3] Mass per bounding volume: hollow robots have 100 to 1000, steel 7850."""

_STRONGEST = 5.0
"""[-] Tractive effort per weight: no floor takes more than friction times weight."""

_GRAVITY = 9.81

_STICKIEST = 2.0
"""[-] Rubber tracks on concrete have up to 1; higher values are not measured but stop sliding."""

_OFF_AXLE = 0.1
"""[-] Largest distance of a wheel's centre of mass from its axle, as a fraction of its radius."""

_SAME = 1e-6
"""[m] Last digit of files: sides that differ by less are equal."""

_SLACK = 1.05
"""[-] Tolerance for rounded inertias: a body may be this much larger than its shapes."""

_MATTERS = 0.01
"""[-] Fraction of the robot's mass below which a link has no effect."""

_ON_SELF = re.compile(r"<self_collide>\s*(1|true)\s*<", re.IGNORECASE)
_LINK = re.compile(r"<link\s+name\s*=\s*[\"']([^\"']*)[\"'].*?</link>", re.DOTALL)
_FILTERED = re.compile(r"contype|conaffinity|<exclude")


@dataclass(frozen=True, slots=True, kw_only=True)
class Finding:
    """One break of a rule.

    Parameters
    ----------
    rule : str
        Name of the rule, as in ``docs/conventions.md``.
    severity : {"error", "warning", "note"}
        An error: the model is not the intended robot; a warning: probably a mistake; a note:
        information.
    message : str
        The finding, with its figures.
    where : str
        File and lines; "" for a robot without a file.
    """

    rule: str
    severity: str
    message: str
    where: str = ""


class _Break(NamedTuple):
    """What breaks a rule, and where; by default with the severity of the rule."""

    message: str
    where: str = ""
    severity: str = ""


@dataclass(frozen=True, slots=True)
class Rule:
    """A rule about robots or model files, with the functions that find violations.

    Parameters
    ----------
    name : str
        Name as in ``docs/conventions.md``, which says when it fires.
    severity : str
        Severity of a violation without its own.
    text : str
        The rule as a sentence.
    robot, file : callable, optional
        Find violations of a robot, and those that only a file shows.
    stated : tuple of str
        Figures that may locate the violation in the file: the first one that it states.
    """

    name: str
    severity: str
    text: str
    robot: Callable[[Robot], Iterator[_Break]] | None = None
    file: Callable[[Reading], Iterator[_Break]] | None = None
    stated: tuple[str, ...] = ()

    def findings(self, robot: Robot, reading: Reading | None) -> Iterator[Finding]:
        """Yield the violations of this rule."""
        sources = {} if reading is None else reading.sources
        where = next((sources[path] for path in self.stated if path in sources), "")
        for each in self.robot(robot) if self.robot else ():
            yield self._finding(each._replace(where=where))
        yield from map(self._finding, self.file(reading) if self.file and reading else ())

    def _finding(self, broken: _Break) -> Finding:
        severity = broken.severity or self.severity
        return Finding(
            rule=self.name, severity=severity, message=broken.message, where=broken.where
        )


def lint(
    robot: Robot, reading: Reading | None = None, warnings: Iterable[str] = ()
) -> tuple[Finding, ...]:
    """Find probable mistakes in a robot and its model file.

    Parameters
    ----------
    robot : Robot
        The robot.
    reading : Reading, optional
        The reading of its file.
    warnings : iterable of str
        Warnings of the simulator; see `Scenario.validate`.

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
    >>> print(lint(marv)[0].message)
    no round shape between the end wheels of the chassis, where a track should be: 279 mm are bare
    >>> robot = c2d.Robot.simple(20.0, axle_distance=4.0, radius=0.6)
    >>> [(found.rule, found.severity) for found in lint(robot)]
    [('size', 'error'), ('mass', 'warning')]
    """
    found = [each for rule in RULES for each in rule.findings(robot, reading)]
    found += [Finding(rule="other", severity="warning", message=warning) for warning in warnings]
    return tuple(sorted(found, key=lambda each: SEVERITIES.index(each.severity)))


def _size(robot: Robot) -> Iterator[_Break]:
    length, _ = _length_and_height(robot)
    if not _SHORTEST <= length <= _LONGEST:
        message = f"{length:.3g} m long without flippers; tracked robots have 0.1 to 3 m"
        if length > _LONGEST and _SHORTEST <= 0.1 * length <= _LONGEST:
            message += "; if it is ten times too large, pass scale=0.1"
        yield _Break(message)


def _mass(robot: Robot) -> Iterator[_Break]:
    length, height = _length_and_height(robot)
    space = length * height * (robot.gauge + robot.outline.front_radius)
    density = robot.mass / space
    if not _LIGHTEST <= density <= _HEAVIEST:
        yield _Break(
            f"{robot.mass:.4g} kg in {space:.3g} m^3 are {density:.3g} kg/m^3;"
            f" robots have {_LIGHTEST:g} to {_HEAVIEST:g}"
        )


def _length_and_height(robot: Robot) -> tuple[float, float]:
    """[m, m] Measure the chassis with its tracks, without flippers."""
    outline = robot.outline
    length = outline.axle_distance + outline.front_radius + outline.rear_radius
    return length, 2.0 * max(outline.front_radius, outline.rear_radius)


def _gyration_of_robot(robot: Robot) -> Iterator[_Break]:
    """Compare the radius of gyration with the distance of the farthest part from the middle."""
    length, height = _length_and_height(robot)
    arms = reach_of(robot.flippers, robot.track)
    tallest = np.abs(belly_corners(robot.belly)[:, 1]).max(initial=0.5 * height)
    farthest = math.hypot(0.5 * length + arms, tallest)
    gyration = math.sqrt(robot.moment_of_inertia / robot.mass)
    if gyration > farthest:
        yield _Break(
            f"a moment of inertia of {robot.moment_of_inertia:.3g} kg m^2 puts the mass"
            f" {gyration:.3g} m from its centre, but no part is farther than {farthest:.3g} m:"
            " it pitches too slowly"
        )


def _torque(robot: Robot) -> Iterator[_Break]:
    outline, most = robot.outline, robot.drivetrain.max_torque
    effort = 2.0 * most / (min(outline.front_radius, outline.rear_radius) - outline.grouser_height)
    ratio = effort / (robot.mass * _GRAVITY)
    if ratio > _STRONGEST:
        yield _Break(
            f"{most:.3g} N m per track push with {ratio:.0f} times the weight: as good as no limit,"
            " so only slip ends a jam"
        )


def _bare_stretches(robot: Robot) -> Iterator[_Break]:
    """Find stretches without a wheel or belt."""
    track = robot.track
    if isinstance(track, LineOfWheels) and not track.as_track:
        bare = robot.outline.axle_distance - robot.outline.front_radius - robot.outline.rear_radius
        yield _Break(
            "no round shape between the end wheels of the chassis, where a track should be:"
            f" {1e3 * bare:.0f} mm are bare"
        )
    arms = robot.flippers
    own = None if arms is None else (arms.track or track)
    if arms is not None and isinstance(own, HybridWheels) and len(own.placements) == 1:
        yield _Break(
            f"one wheel per flipper: the {1e3 * arms.length:.0f} mm from its pivot to that wheel"
            " are bare, where a track should be"
        )


def _pushed(robot: Robot) -> Iterator[_Break]:
    if isinstance(robot.track, ForceTrack) and robot.track.support == "wheels":
        yield _Break("nothing drives the wheels: they turn freely, and a force pushes the chassis")


def _impossible_inertia(reading: Reading) -> Iterator[_Break]:
    message = (
        "the largest principal moment of inertia exceeds the sum of the others: no body has that"
    )
    broken = [link for link in _solid_links(reading) if _breaks_triangle(link)]
    yield from _of_links(reading, broken, message)
    message = "the radius of gyration is larger than the body: such a link turns too slowly"
    yield from _of_links(reading, _too_spread(reading), message)


def _placeholder(reading: Reading) -> Iterator[_Break]:
    others = _too_spread(reading)
    alike = [link for link in _solid_links(reading) if _is_ball(link) and link not in others]
    message = "three equal moments of inertia, which only a ball or a cube has: placeholders?"
    yield from _of_links(reading, alike, message)


def _solid_links(reading: Reading) -> list[Link]:
    return [link for link in reading.tree.links if link.mass > 0.0 and link.inertia.any()]


def _of_links(reading: Reading, links: list[Link], message: str) -> Iterator[_Break]:
    """Report links together, the heaviest first, and separately those without effect."""
    order = sorted(links, key=lambda link: -link.mass)
    least = _MATTERS * reading.robot.mass
    heavy = [link for link in order if link.mass >= least]
    light = [link for link in order if link.mass < least]
    for each, severity in ((heavy, ""), (light, "note")):
        if each:
            names = list_names([link.name for link in each])
            yield _Break(f"{names}: {message}", lines([link.at for link in each]), severity)


def _moments(link: Link) -> np.ndarray[tuple[int]]:
    moments: np.ndarray[tuple[int]] = np.linalg.eigvalsh(link.inertia)
    return moments


def _breaks_triangle(link: Link) -> bool:
    low, middle, high = _moments(link)
    return bool(high > (low + middle) * 1.01)


def _too_spread(reading: Reading) -> list[Link]:
    """List links with a radius of gyration larger than the reach of their shapes."""
    whole = size_of(reading.tree)
    found = []
    for link in _solid_links(reading):
        reach = max((farthest(shape, link.center) for shape in link.shapes), default=whole)
        if math.sqrt(float(_moments(link)[-1]) / link.mass) > _SLACK * reach:
            found.append(link)
    return found


def _is_ball(link: Link) -> bool:
    low, _, high = _moments(link)
    if high - low > 1e-6 * high or any(shape.kind == "sphere" for shape in link.shapes):
        return False
    cubes = [shape for shape in link.shapes if shape.kind == "box" and np.ptp(shape.size) < 1e-9]
    return not cubes


def _wheel_links(reading: Reading) -> list[tuple[Link, Joint]]:
    """List the links of all wheels with their joints; drums have none."""
    joints = reading.tree.joints
    names = set(reading.wheels["name"].tolist())  # the name of a drum includes its shape
    return [(link, joints[link.name]) for link in reading.tree.links if link.name in names]


def _touching_links(reading: Reading) -> Iterator[Link]:
    """Yield the links of all wheels, with links fixed to them, and of all drums."""
    names, hanging = set(reading.wheels["name"].tolist()), subtrees(reading.tree)
    turning = {each for name in names & hanging.keys() for each in hanging[name]}
    for link in reading.tree.links:
        if link.name in turning or any(f"{link.name}/{s.name}" in names for s in link.shapes):
            yield link


def _friction(reading: Reading) -> Iterator[_Break]:
    """Check the stated coefficients, which an engine may combine to less."""
    found = [
        (coefficient, at)
        for link in _touching_links(reading)
        for friction in (shape.friction for shape in link.shapes)
        if friction is not None
        for coefficient, at in (
            (friction.first, friction.first_at),
            (friction.second, friction.second_at),
        )
        if coefficient > _STICKIEST
    ]
    if found:
        largest = max(coefficient for coefficient, _ in found)
        message = (
            f"friction of {largest:g}; tracks have 0.3 to 1. By the rules of {reading.engine}"
            f" {reading.friction:g} counts along the tracks on a floor, other engines may use it as"
            " it is"
        )
        severity = "error" if reading.friction > _STICKIEST else "warning"
        yield _Break(message, lines([at for _, at in found]), severity)


def _no_effort_limit(reading: Reading) -> Iterator[_Break]:
    every, driven = [joint for _, joint in _wheel_links(reading)], reading.tree.driven
    wheels = [joint for joint in every if joint.name in driven] or every
    # Differential drives of Gazebo Classic have their own motor limits.
    limited = wheel_torques(reading.tree.plugins) if reading.engine == "classic" else {}
    without = [
        joint
        for joint in wheels
        if joint.name not in limited and not (joint.effort and math.isfinite(joint.effort))
    ]
    if without:
        torque = reading.robot.drivetrain.max_torque
        is_estimate = "robot.drivetrain.max_torque" in reading.sources.estimates
        found = "no effort limit: their motors hold the speed under any load"
        if reading.engine == "gz" and all(joint.effort == 0.0 for joint in without):
            found = "an effort limit of 0: their motors turn nothing in gz-sim"
        message = (
            f"{len(without)} of {len(wheels)} wheels have {found}; here they have {torque:.3g} N m"
            f" per track, {'an estimate' if is_estimate else 'those of the others'}"
        )
        yield _Break(message, lines([joint.effort_at for joint in without]))


def _no_speed(reading: Reading) -> Iterator[_Break]:
    """Find wheels that may not turn, in engines that keep to their limit of speed."""
    laws, wheels = ENGINES[reading.engine], [joint for _, joint in _wheel_links(reading)]
    still = [joint for joint in wheels if joint.velocity == 0.0]
    if still and "velocity" not in laws.ignored:
        speed = reading.robot.drivetrain.max_speed
        is_estimate = "robot.drivetrain.max_speed" in reading.sources.estimates
        message = (
            f"{len(still)} of {len(wheels)} wheels have a speed limit of 0: they do not turn in"
            f" {laws.name}; here they drive at {speed:.3g} m/s,"
            f" {'an estimate' if is_estimate else 'as the others do'}"
        )
        yield _Break(message, lines([joint.velocity_at for joint in still]))


def _no_motor(reading: Reading) -> Iterator[_Break]:
    """Find wheels without a motor in the file: something external must turn them."""
    wheels = [joint for _, joint in _wheel_links(reading)]
    idle = [joint for joint in wheels if joint.name not in reading.tree.driven]
    if idle:
        names = list_names([joint.child for joint in idle])
        message = (
            f"the file names no motor for {len(idle)} of {len(wheels)} wheels ({names}); here all"
            " are driven, as by an external controller; wheels that nothing turns would drag"
        )
        yield _Break(message, lines([joint.at for joint in idle]), "note")


def _massless(reading: Reading) -> Iterator[_Break]:
    """Find wheels, and a chassis, without mass, including everything fixed to them."""
    tree = reading.tree
    masses: dict[str, float] = {}  # of everything that moves as one, by its first link
    first: dict[str, str] = {}
    for link in tree.links:  # parents precede children
        joint = tree.joints.get(link.name)
        is_fixed = joint is not None and joint.is_locked
        first[link.name] = first[joint.parent] if joint is not None and is_fixed else link.name
        masses[first[link.name]] = masses.get(first[link.name], 0.0) + link.mass
    wheels = [link for link, _ in _wheel_links(reading)]
    for links, what in ((wheels, "{0} wheels have"), (tree.links[:1], "the chassis has")):
        found = [link for link in links if masses[first[link.name]] == 0.0]
        if found:
            names = list_names([link.name for link in found])
            message = (
                f"{what.format(len(found))} no mass ({names}): is an <inertial> missing? Here"
                f" {'it weighs' if links is not wheels else 'they weigh'} nothing"
            )
            yield _Break(message, lines([link.at for link in found]))


def _balance(reading: Reading) -> Iterator[_Break]:
    """Find unbalanced wheels."""
    table = reading.wheels
    radii = dict(zip(table["name"].tolist(), table["radius"].tolist(), strict=True))
    off = [
        (math.hypot(*np.cross(joint.axis, link.center - joint.place)), link)
        for link, joint in _wheel_links(reading)
    ]
    found = [(away, link) for away, link in off if away > _OFF_AXLE * radii[link.name]]
    if found:
        most = max(away for away, _ in found)
        names = list_names([link.name for _, link in found])
        message = (
            f"{names}: their centres of mass are off their axles by up to {1e3 * most:.3g} mm: such"
            " wheels shake a robot as they turn; here they are balanced"
        )
        yield _Break(message, lines([link.mass_at for _, link in found]))


def _sides(reading: Reading) -> Iterator[_Break]:
    """Compare left and right, wheel by wheel in the order of the table."""
    table = reading.wheels
    left, right = (table["side"] == side for side in ("left", "right"))
    if left.sum() != right.sum():  # double wheels, paired by the reader
        return
    off = {
        name: np.abs(table[name][left] - table[name][right])
        for name in ("x", "y", "radius", "mass")
    }
    worst = max(float(off[name].max()) for name in ("x", "y", "radius"))
    heavier = float((off["mass"] / np.maximum(table["mass"][left], 1e-9)).max())
    if worst > _SAME or heavier > _SAME:
        index = int(np.argmax(sum(off.values())))
        name, *at = (
            table["name"][left][index],
            *(table["line"][each][index] for each in (left, right)),
        )
        message = (
            f"left and right differ by up to {1e3 * worst:.3g} mm and {heavier:.2g} of a wheel's"
            f" mass, most at {name}; here both have the mean"
        )
        yield _Break(message, f"{reading.tree.file}:{at[0]}, {at[1]}")


def _overlaps(reading: Reading) -> Iterator[_Break]:
    """Find overlapping wheels of one side, and whether an engine lets them collide."""
    places: list[Where] = []
    depths: list[float] = []
    names: set[str] = set()
    rows = [
        (shape.pose.place, shape.radius, shape.length, joint.axis, link)
        for link, joint in _wheel_links(reading)
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
                depths.append(depth)
                places += [link.at, its_link.at]
                names |= {link.name, its_link.name}
    if depths:
        severity, effect = _effect_of_overlap(reading, names)
        message = f"{len(depths)} pairs of wheels overlap, by up to {1e3 * max(depths):.0f} mm"
        yield _Break(f"{message}: {effect}", lines(places), severity)


def _effect_of_overlap(reading: Reading, names: set[str]) -> tuple[str, str]:
    """Say whether overlapping wheels of a model would collide with each other."""
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


def _opposed(reading: Reading) -> Iterator[_Break]:
    yield from (_Break(*each) for each in opposed(reading))


def _wheel_radius(reading: Reading) -> Iterator[_Break]:
    yield from (_Break(*each) for each in other_radius(reading))


def _warnings(reading: Reading) -> Iterator[_Break]:
    for warning in reading.warnings:
        line = re.search(re.escape(reading.tree.file) + r"[^:]*:[0-9]+", warning)
        yield _Break(warning, line[0] if line else reading.tree.file)


RULES = (
    Rule(
        "size",
        "error",
        "The length of the robot is typical of tracked robots.",
        robot=_size,
        stated=("robot.outline.axle_distance", "robot.outline.discs"),
    ),
    Rule(
        "mass",
        "warning",
        "The density of the robot is plausible.",
        robot=_mass,
        stated=("robot.mass",),
    ),
    Rule(
        "inertia",
        "error",
        "Moments of inertia are possible for bodies of their size.",
        robot=_gyration_of_robot,
        file=_impossible_inertia,
        stated=("robot.moment_of_inertia",),
    ),
    Rule("massless", "error", "Wheels and chassis have a mass.", file=_massless),
    Rule(
        "placeholder",
        "warning",
        "Only balls and cubes have three equal moments of inertia.",
        file=_placeholder,
    ),
    Rule(
        "no track",
        "error",
        "Round shapes cover the whole length of a track.",
        robot=_bare_stretches,
        stated=("robot.track",),
    ),
    Rule(
        "effort",
        "warning",
        "Motors have an effort limit, and tracks push with no more than floors can take.",
        robot=_torque,
        file=_no_effort_limit,
        stated=("robot.drivetrain.max_torque",),
    ),
    Rule("speed", "warning", "Wheels may turn.", file=_no_speed),
    Rule("not driven", "error", "Every wheel has a motor.", robot=_pushed, file=_no_motor),
    Rule(
        "opposed",
        "error",
        "A drive plugin turns all wheels of a side the same way.",
        file=_opposed,
    ),
    Rule(
        "wheel radius",
        "warning",
        "The radius in a drive plugin is that of its wheels.",
        file=_wheel_radius,
    ),
    Rule(
        "friction",
        "warning",
        "The friction of wheels and tracks is realistic.",
        file=_friction,
    ),
    Rule("balance", "warning", "The centre of mass of a wheel is on its axle.", file=_balance),
    Rule("sides", "note", "Left and right are the same.", file=_sides),
    Rule("overlap", "note", "Wheels of one side do not push each other apart.", file=_overlaps),
    Rule("other", "warning", "Reader and simulator have no other warnings.", file=_warnings),
)
"""All rules, in the order of checking."""
