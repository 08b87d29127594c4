"""Rules of lint about single links: inertias that no body has, and wheels that collide."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator

import numpy as np

from crawler2d.audits.finding import Finding
from crawler2d.audits.lint_model import wheel_links
from crawler2d.models.tree import Link
from crawler2d.models.where import Where
from crawler2d.reading.parts import farthest
from crawler2d.reading.plausible import size_of
from crawler2d.reading.reading import Reading
from crawler2d.reading.sources import lines
from crawler2d.reading.telling import named

__all__ = ["of_bodies"]

_SLACK = 1.05
"""[-] Files round inertias: a body may be that much larger than its shapes."""

_MATTERS = 0.01
"""[-] A share of the robot's mass: links below it move nothing."""

_ON_SELF = re.compile(r"<self_collide>\s*(1|true)\s*<", re.IGNORECASE)
_LINK = re.compile(r"<link\s+name\s*=\s*[\"']([^\"']*)[\"'].*?</link>", re.DOTALL)
_FILTERED = re.compile(r"contype|conaffinity|<exclude")


def of_bodies(reading: Reading) -> Iterator[Finding]:
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
            told = f"{named([link.name for link in each])}: {what}"
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
