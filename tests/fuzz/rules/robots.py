"""Rules that take the geometry of a robot: what must fit, and what inertia must be left."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from tests.fuzz.rules.bodies import Body, Outline, Unbuilt, must, round_bodies
from tests.fuzz.rules.chains import chain
from tests.fuzz.rules.fields import Json
from tests.fuzz.rules.hulls import Discs, Walk, grown, hull_of, tight_radius, tight_room
from tests.fuzz.rules.parts import discs_of, ends_of, open_track
from tests.fuzz.rules.verdict import ANYWHERE, ROUNDING, Verdict

MOST_WHEELS, MOST_GROUSERS = 200, 200
LEAST_BEND = 1e-6
"""[rad] A belt that bends less round a disc does not bend."""
SAME = 1e-9
"""[m] Discs that differ by less are the same."""


@dataclass
class Model:
    """The bodies of a robot: on the chassis, and on each arm, in the frame of that."""

    chassis: list[Body]
    arms: list[list[Body]]

    def all(self) -> list[Body]:
        """All of them."""
        return [*self.chassis, *(body for arm in self.arms for body in arm)]


def check(robot: Json, v: Verdict) -> Model | None:
    """Check a robot; None if it cannot be built, or this is unknown."""
    discs: Discs = tuple((x, y, radius) for x, y, radius in discs_of(robot["outline"]))
    if len(discs) > 2:
        hull = hull_of(discs)
        for i in range(len(discs)):
            rule, path = "the track bends round each disc", f"robot.outline.discs[{i}]"
            bend, others = hull.bend(i), (*discs[:i], *discs[i + 1 :])
            # Either of two that are equal except for rounding may be the one that bends it.
            is_double = any(math.dist(discs[i], other) < SAME for other in others)
            if is_double or 0.3 * LEAST_BEND < bend < 3.0 * LEAST_BEND:
                v.doubt(rule, path)
            else:
                v.need(rule, path, bend > LEAST_BEND)
    if not v.is_clean("robot.outline"):
        return None
    track = robot["track"]
    path = "robot.track.of" if track["kind"] == "closed" else "robot.track"
    outline = Outline(discs, robot["outline"])
    arms = robot["flippers"]
    ends = ends_with_arms(arms) if arms is not None else []
    try:
        chassis = _bodies(path, open_track(track), outline, robot, v)
        model = Model(chassis, [_arm(robot, end, outline, v) for end in ends])
        _check_inertia(robot, outline, v)
        return _closed(model, robot, outline, v) if track["kind"] == "closed" else model
    except Unbuilt:
        if v.unknown:
            v.doubt("what else a robot breaks", ANYWHERE)
        return None


def ends_with_arms(arms: Json) -> list[str]:
    return ["front", "rear"] if arms["ends"] == "both" else [arms["ends"]]


def _line(outline: Outline, count: int, radius: float | None) -> Discs:
    rear, front = ends_of([list(disc) for disc in outline.discs])
    shares = [i / (count - 1) for i in range(count)]
    at = [[a + share * (b - a) for a, b in zip(rear, front, strict=True)] for share in shares]
    return tuple((x, y, own if radius is None else float(radius)) for x, y, own in at)


def _bodies(path: str, track: Json, outline: Outline, robot: Json, v: Verdict) -> list[Body]:
    """The round bodies of a model."""
    kind = track["kind"]
    if kind in ("belt", "force"):
        is_hull = kind == "belt" or track["support"] == "skids"
        line = [] if is_hull else _line(outline, track["wheel_count"], None)
        return round_bodies(outline.discs if is_hull else line)
    if kind == "grouser_belt":
        return _grouser_belt(path, track, outline, v)
    if kind == "segmental":
        return chain(path, track, outline, robot, v)
    wheels = _wheels(path, track, outline, v)
    if track["wheel"]["kind"] == "round":
        return round_bodies(wheels)
    roots = {
        wheel: _check_gear(f"{path}.wheel", track["wheel"], outline, wheel[2], v)
        for wheel in dict.fromkeys(wheels)
    }
    bodies = [(*wheel, roots[wheel]) for wheel in wheels]
    return [Body(x, y, tip, (root, root), tip - root) for x, y, tip, root in bodies]


def _wheels(path: str, track: Json, outline: Outline, v: Verdict) -> Discs:
    if track["kind"] == "line":
        return _line(outline, track["count"], track["wheel_radius"])
    if track["kind"] == "hybrid":
        placements: list[list[float]] = track["placements"]
        return tuple((float(x), float(y), float(radius)) for x, y, radius in placements)
    radius = track["wheel_radius"]
    if radius is None:
        radius = _tight(path, track["count"], outline, v)
    else:
        rule, at = "small wheels fit in the outline", f"{path}.wheel_radius"
        must(v.at_most(rule, at, float(radius), outline.smallest, less=True))
    # Their exact positions inside the outline matter little.
    count: int = track["count"]
    return ((math.nan, math.nan, float(radius)),) * count


def _tight(path: str, count: int, outline: Outline, v: Verdict) -> float:
    """[m] The radius of wheels that touch each other all round."""
    discs, most = outline.discs, MOST_WHEELS if outline.takes_more_wheels else count
    length, room = hull_of(discs).length, tight_room(discs, count)
    while room < -ROUNDING * length and count < most:
        count += 1
        room = tight_room(discs, count)
    rule, at = "enough small wheels to touch", f"{path}.count"
    if abs(room) <= ROUNDING * length:
        v.doubt(rule, at)
        raise Unbuilt
    must(v.need(rule, at, room > 0.0))
    return tight_radius(discs, count)


def _grouser_belt(path: str, track: Json, outline: Outline, v: Verdict) -> list[Body]:
    height, thickness = outline.height, float(outline.given["grouser_thickness"])
    for name, value in (("grouser_height", height), ("grouser_thickness", thickness)):
        at, rule = f"robot.outline.{name}", f"a belt with grousers has a {name}"
        must(v.at_least(rule, at, value, 0.0, more=True))
    length, count = hull_of(grown(outline.discs, -height)).length, track["grouser_count"]
    if count is None:
        count = outline.count(length, (1, MOST_GROUSERS), v)
    rule, place = "grousers fit on the belt", f"{path}.grouser_count"
    how = {"less": True, "exact": False, "at": "robot.outline.grouser_thickness"}
    must(v.at_most(rule, place, thickness, length / count, **how))
    return [Body(x, y, tip, (tip - height, tip - height), height) for x, y, tip in outline.discs]


def _check_gear(path: str, wheel: Json, outline: Outline, radius: float, v: Verdict) -> float:
    """[m] The root radius of a wheel with grousers."""
    given, of_robot = wheel["grouser_height"], outline.height
    height = float(min(of_robot, 0.25 * radius) if given is None else given)
    at = f"{path}.grouser_height"
    of_outline = "robot.outline.grouser_"
    to, rule = at if given is not None else f"{of_outline}height", "a gear wheel has grousers"
    must(v.at_least(rule, at, height, 0.0, more=True, at=to))
    rule = "grousers leave a root circle"
    must(v.at_most(rule, at, height, radius, less=True, exact=False))
    root = radius - height
    count = wheel["grouser_count"]
    if count is None:
        fitting = 2.0 * math.pi * root / outline.given["grouser_pitch"]
        if abs(fitting - math.floor(fitting) - 0.5) < 1e-9:
            v.doubt("the nearest number of grousers", at)
        count = min(round(fitting), MOST_GROUSERS) if round(fitting) >= 6 else 8
    tip, base = wheel["tip_thickness"], wheel["base_thickness"]
    if tip is None:
        shrunk = min(1.0, height / of_robot) if of_robot > 0.0 else 1.0
        tip = outline.given["grouser_thickness"] * shrunk
    at, rule = f"{path}.tip_thickness", "grousers of wheels are thick"
    to = at if wheel["tip_thickness"] is not None else f"{of_outline}thickness"
    must(v.at_least(rule, at, tip, 0.0, more=True, at=to))
    given_base, base = base is not None, float(tip if base is None else base)
    at = f"{path}.base_thickness"
    # What follows from the outline may differ in its last digit.
    exact = wheel["tip_thickness"] is not None or not given_base
    must(v.at_least("a base is as thick as the tip", at, base, tip, exact=exact))
    room = 2.0 * root * math.sin(math.pi / count)
    where = at if given_base else f"{path}.tip_thickness"
    rule = "grousers do not overlap on the root circle"
    must(v.at_most(rule, where, base, room, less=True, exact=False))
    # A flank from the tip that touches the root circle is a tangent of it.
    leaning = math.asin(min(1.0, 0.5 * tip / radius)) + math.acos(root / radius)
    widest = 2.0 * root * math.sin(min(leaning, 0.5 * math.pi))
    rule = "flanks stay outside the root circle"
    if base > tip:
        must(v.at_most(rule, at, base, max(tip, widest), exact=False))
    return root


def _arm(robot: Json, end: str, outline: Outline, v: Verdict) -> list[Body]:
    """The bodies of the arm at one end, the model that of the robot unless it has its own."""
    arms = robot["flippers"]
    half, root, tip = 0.5 * arms["length"], float(arms["root_radius"]), float(arms["tip_radius"])
    radii = (root, tip) if end == "front" else (tip, root)
    discs = ((-half, 0.0, radii[0]), (half, 0.0, radii[1]))
    own = Outline(discs, outline.given, takes_more_wheels=arms["track"] is None)
    track = arms["track"]
    if track is None:
        track = open_track(robot["track"])
        if track["kind"] == "segmental":
            track = {"kind": "grouser_belt", "grouser_count": None}
    return _bodies("robot.flippers.track", track, own, robot, v)


def _check_inertia(robot: Json, outline: Outline, v: Verdict) -> None:
    """The mass left for the chassis after all moving parts."""
    track, arms = robot["track"], robot["flippers"]
    rear, front = ends_of([list(disc) for disc in outline.discs])
    left, of_track = float(robot["moment_of_inertia"]), float(robot["track_mass"])
    mass, (x, y) = float(robot["mass"]), robot["center_of_mass"]
    chain = open_track(track)["kind"] == "segmental"
    moving = 0.0
    if arms is not None:
        pair, length = 2.0 * arms["mass"], float(arms["length"])
        at = {
            "front": (front[0] + 0.5 * length, front[1]),
            "rear": (rear[0] - 0.5 * length, rear[1]),
        }
        places = [at[end] for end in ends_with_arms(arms)]
        rest = mass - pair * len(places)
        new = (
            (mass * x - pair * sum(place[0] for place in places)) / rest,
            (mass * y - pair * sum(place[1] for place in places)) / rest,
        )
        moving += rest * ((new[0] - x) ** 2 + (new[1] - y) ** 2)
        for place in places:
            apart = (place[0] - x) ** 2 + (place[1] - y) ** 2
            moving += pair * (length * length / 12.0 + apart)
        if chain:
            moving += 0.1 * pair * len(places) * rear[2] ** 2
        mass, (x, y) = rest, new
    rule, path = "inertia exceeds that of all moving parts", "robot.moment_of_inertia"
    if not chain:
        limit = moving + of_track * rear[2] ** 2
        v.at_least(rule, path, left, limit, more=True, exact=False)
        return
    # The shoes of a chain lie evenly along the outline, about half a grouser inside it.
    belt = hull_of(grown(outline.discs, -outline.height))
    shoes = Walk(belt).spread(200)
    center = (
        sum(place[0] for place in shoes) / 200.0,
        sum(place[1] for place in shoes) / 200.0,
    )
    spread = sum((place[0] - x) ** 2 + (place[1] - y) ** 2 for place in shoes) / 200.0
    rest = mass - of_track
    offset = (center[0] - x) ** 2 + (center[1] - y) ** 2
    limit = moving + of_track * spread + of_track**2 / max(rest, 1e-300) * offset
    sprocket = (
        0.5 * of_track * rear[2] ** 2 if open_track(track)["mechanism"] == "sprocket" else 0.0
    )
    if 0.8 * limit < left < 1.1 * (limit + sprocket):
        v.doubt(rule, path)
        return
    v.at_least(rule, path, left, limit, more=True)


def _closed(model: Model, robot: Json, outline: Outline, v: Verdict) -> Model:
    """Belts round the bodies, with grousers as high as theirs."""
    given, of = outline.given, open_track(robot["track"])
    arms = robot["flippers"]
    models = [(model.chassis, of), *((arm, (arms["track"] or of)) for arm in model.arms)]
    closed = []
    for bodies, track in models:
        if track["kind"] == "line" and not track["as_track"]:
            closed.append(bodies)  # nothing runs round them
            continue
        height = 0.0
        if robot["track"]["surface"] == "own" and given["grouser_thickness"] > 0.0:
            has = track["kind"] in ("grouser_belt", "segmental")
            height = outline.height if has else min(body.grousers for body in bodies)
        if height > 0.0:
            tips = tuple((body.x, body.y, body.tip - height) for body in bodies)
            path, rule = "robot.outline.grouser_pitch", "at most 200 pitches on a belt"
            if any(math.isnan(x) for x, *_ in tips) or track["kind"] == "segmental":
                around = hull_of(outline.discs).length
                if around / given["grouser_pitch"] > 0.9 * MOST_GROUSERS:
                    v.doubt(rule, path)
            else:
                outline.count(hull_of(tuple(dict.fromkeys(tips))).length, (1, MOST_GROUSERS), v)
        closed.append([_covered(body, height) for body in bodies])
    return Model(closed[0], closed[1:])


def _covered(body: Body, height: float) -> Body:
    """The belt round a body, with grousers of a height [m]."""
    root = body.tip - height
    least = root if body.is_sure else body.root[0]
    return replace(body, root=(min(least, root), root), grousers=height)
