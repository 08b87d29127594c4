"""Rules of chains of shoes: that they go round, and leave room for what is inside them."""

from __future__ import annotations

import math

from tests.fuzz.rules.bodies import Body, Outline, must
from tests.fuzz.rules.fields import Json
from tests.fuzz.rules.hulls import Discs, grown, hull_of
from tests.fuzz.rules.parts import ends_of
from tests.fuzz.rules.verdict import Verdict

MOST_SHOES = 400
LENGTHENED = 1.1
"""A chain is at most this much longer than the belt in its place."""
REST_TO_SHOE = 3000.0
PRESSED_IN = 0.07
"""By this share of a pitch the front end of a guide lies inside what the plates run on."""


def chain(path: str, track: Json, outline: Outline, robot: Json, v: Verdict) -> list[Body]:
    """Shoes that go round, and the guide or the wheels inside them."""
    height = outline.height
    rear, front = ends_of([list(disc) for disc in outline.discs])
    roots = hull_of(grown(outline.discs, -height)).length
    count = track["shoe_count"]
    if count is None:
        count = outline.count(roots, (3, MOST_SHOES), v)
    plate = track["plate_thickness"]
    plate = roots / count / 16.0 if plate is None else float(plate)
    inner = outline.smallest - height - plate
    rule, at = "plates leave room for a guide", f"{path}.plate_thickness"
    room = outline.smallest - height
    must(v.at_most(rule, at, plate, room, less=True, exact=False))
    pins = grown(outline.discs, -height - 0.5 * plate)
    least = hull_of(pins).length / count
    most = LENGTHENED * least
    apart = math.hypot(rear[0] - front[0], rear[1] - front[1])
    fitting = min(0.5 * apart, 2.0 * min(disc[2] for disc in pins))
    rule, at = "shoes are short enough to go round", f"{path}.shoe_count"
    whole = {"near": 1.0 / count, "there": math.ceil(most * count / max(fitting, 1e-9))}
    must(v.at_most(rule, at, most, fitting, exact=False, **whole))
    _check_runs(at, track["mechanism"], (pins, most, fitting), v)
    mass, of_track = float(robot["mass"]), float(robot["track_mass"])
    rule, at = "a shoe is not too light", "robot.track_mass"
    limit = mass * count / (REST_TO_SHOE + count)
    must(v.at_least(rule, at, of_track, limit, exact=False))
    if track["mechanism"] == "guide":
        return _guide(outline, plate, least)
    # Sprocket and rollers are of sizes that follow from the pitch, within some tenths.
    counts = [track["road_wheel_count"], track["return_roller_count"]]
    counts = [apart / least / (k + 1) if n is None else n for k, n in enumerate(counts)]
    smallest = [inner, *(0.48 * apart / (n + 1) for n in counts if n)]
    smallest += [0.25 * inner] if counts[1] else []
    roots_of = (0.4 * min(smallest), 1.3 * inner)
    return [Body(x, y, r, roots_of, height, is_sure=False) for x, y, r in outline.discs]


def _guide(outline: Outline, plate: float, least: float) -> list[Body]:
    """A guide is inside the plates by a fraction of their pitch, at most by half of its radius."""

    def root(outer: float, pitch: float) -> float:
        inside = outer - outline.height - plate
        return max(inside - PRESSED_IN * pitch, 0.5 * inside)

    most, inner = LENGTHENED * least, outline.smallest - outline.height - plate
    sure = PRESSED_IN * most < 0.5 * inner
    return [
        Body(x, y, r, (root(r, most), root(r, least)), outline.height, sure)
        for x, y, r in outline.discs
    ]


def _check_runs(at: str, mechanism: str, how: tuple[Discs, float, float], v: Verdict) -> None:
    """A shoe goes on every straight run, also with the front end pressed in by half of it."""
    rule, (pins, most, fitting) = "shoes are short enough to go round", how
    rear, front = ends_of([list(disc) for disc in pins])
    apart, step = math.hypot(rear[0] - front[0], rear[1] - front[1]), abs(rear[2] - front[2])
    runs, two = hull_of(pins).runs(), len(pins) == 2
    if two and mechanism == "guide":
        pressed = apart - 0.5 * most
        short = math.sqrt(max(0.0, pressed * pressed - step * step))
        must(v.at_most(rule, at, most, short, exact=False, there=math.nan))
    elif two:
        # A sprocket of whole teeth has a size and a place of its own, within half its radius.
        own, longest = 0.5 * rear[2], 1.2 * most
        step, pressed = step + own, apart - own - 0.5 * longest
        if pressed < 0.0 or pressed * pressed - step * step < longest * longest:
            v.doubt(rule, at)
    elif most > 0.5 * min(*runs, fitting):
        # Round many discs a chain finds its own length.
        must(most <= 1.5 * min(runs) or v.need(rule, at, kept=False))
        v.doubt(rule, at)
