"""Rules of the ground: profiles without overhangs, edges that are round, lanes side by side."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

from tests.fuzz.rules.fields import Json
from tests.fuzz.rules.verdict import ROUNDING, Verdict

RUN_OUT = 100.0
"""[m] Level ground before and behind an obstacle."""
SAME = 1e-9
"""[m] A corner that is off a straight line by less is none."""
MOST_FACETS = 1e6
FACET = 0.0175
"""[rad] Turn of a facet of a rounded edge."""

Point = tuple[float, float]


@dataclass
class Ground:
    """[m] Where a ground lies, and between what its first edge is, if it has one."""

    low: float
    high: float
    first_edge: tuple[float, float] | None


def _between_levels(corners: list[Point]) -> list[Point]:
    (x0, y0), (x1, y1) = corners[0], corners[-1]
    return [(x0 - RUN_OUT, y0), *corners, (x1 + RUN_OUT, y1)]


def corners_of(terrain: Json) -> tuple[list[Point], float, float]:
    """[m] The corners of a terrain with one profile, its goal and the radius of its edges."""
    get: Any = {k: float(v) for k, v in terrain.items() if isinstance(v, (int, float))}
    radius, kind = get.get("edge_radius", 0.0), terrain["kind"]
    if kind == "flat":
        return [(-RUN_OUT, 0.0), (get["length"] + RUN_OUT, 0.0)], get["length"], 0.0
    if kind == "points":
        points = [(float(x), float(y)) for x, y in terrain["points"]]
        return points, get["goal"], radius
    if kind == "step":
        corners = [(0.0, 0.0), (0.0, get["height"])]
    elif kind == "ramp":
        corners = [(0.0, 0.0), (get["length"], get["length"] * math.tan(get["angle"]))]
    elif kind == "ridge":
        half = get["height"] * math.tan(0.5 * get["edge_angle"])
        corners = [(0.0, 0.0), (half, get["height"]), (2.0 * half, 0.0)]
    elif kind == "stairs":
        corners = []
        for i in range(terrain["count"]):
            x = i * get["run"]
            corners += [(x, i * get["rise"]), (x, (i + 1) * get["rise"])]
    else:
        length, height = {
            "barrier": ("thickness", "height"),
            "gap": ("width", "depth"),
            "half_round": ("radius", "radius"),
        }[kind]
        long = get[length] * (2.0 if kind == "half_round" else 1.0)
        high = -get[height] if kind == "gap" else get[height]
        corners = [(0.0, 0.0), (0.0, high), (long, high), (long, 0.0)]
        # Half a pipe is two quarters of a circle that meet on top, and always fit.
    return _between_levels(corners), corners[-1][0], radius


def check_profile(path: str, terrain: Json, v: Verdict) -> Ground | None:
    """Check one profile; None if there is no ground."""
    given, goal, radius = corners_of(terrain)
    if terrain["kind"] == "points":
        frictions = terrain.get("segment_friction")
        if frictions is not None:
            kept = len(frictions) == len(given) - 1
            v.need("a friction for each segment", f"{path}.segment_friction", kept)
    numbered = list(enumerate(given))
    if numbered[0][1][0] > numbered[-1][1][0]:
        numbered.reverse()
    points = [each for i, each in enumerate(numbered) if i == 0 or each[1] != numbered[i - 1][1]]
    at = f"{path}.points"
    if not v.at_least("a profile has 2 points", at, len(points), 2):
        return None
    kept = True
    for (_, a), (row, b) in pairwise(points):
        kept &= v.at_least("no overhang", f"{at}[{row}]", b[0], a[0], at=f"{at}[{row}][0]")
    for (_, a), (row, b), (_, c) in zip(points, points[1:], points[2:], strict=False):
        spike = a[0] == b[0] == c[0] and (b[1] - a[1]) * (c[1] - b[1]) < 0.0
        kept &= v.need("no spike", f"{at}[{row}]", not spike)
    low, high = points[0][1][0], points[-1][1][0]
    if not v.need("a profile extends along x", at, low != high) or not kept:
        return None
    v.at_most("a goal is on its ground", f"{path}.goal", goal, high)
    v.at_least("a goal is on its ground", f"{path}.goal", goal, low)
    edges = _edges([point for _, point in points])
    if edges is None:
        v.doubt("edges fit", f"{path}.edge_radius")
        return Ground(low, high, (min(0.0, low), high))
    if radius > SAME:
        _check_arcs(path, edges, radius, v)
    places = [corner[0] for corner, *_ in edges]
    ahead = [x for x in places if x >= -SAME]
    edge = next(iter(ahead or places), None)
    return Ground(low, high, None if edge is None else (edge, edge))


Edge = tuple[Point, float, float, float]


def _edges(points: list[Point]) -> list[Edge] | None:
    """Corners with their turn, clockwise > 0, and the faces before and behind; None: not clear."""
    kept = [points[0]]
    for here, behind in pairwise(points[1:]):
        (x, y), last = here, kept[-1]
        back, chord = (x - last[0], y - last[1]), (behind[0] - last[0], behind[1] - last[1])
        long = math.hypot(*chord)
        off = abs(back[0] * chord[1] - back[1] * chord[0]) / long if long else math.inf
        inside = 0.0 <= back[0] * chord[0] + back[1] * chord[1] <= long * long
        if 0.5 * SAME < off < 2.0 * SAME:
            return None
        if off > SAME or not inside:
            kept.append(here)
    kept.append(points[-1])
    edges = []
    for before, here, behind in zip(kept, kept[1:], kept[2:], strict=False):
        to, on = (
            (here[0] - before[0], here[1] - before[1]),
            (behind[0] - here[0], behind[1] - here[1]),
        )
        cross, dot = to[1] * on[0] - to[0] * on[1], to[0] * on[0] + to[1] * on[1]
        turn, faces = math.atan2(cross, dot), (math.hypot(*to), math.hypot(*on))
        bend = abs(turn) * min(faces)
        if 0.5 * SAME < bend < 2.0 * SAME:
            return None
        if bend >= SAME:
            edges.append((here, turn, *faces))
    return edges


def _check_arcs(path: str, edges: list[Edge], radius: float, v: Verdict) -> None:
    """The arcs at both ends of a face must fit on it, and their facets in memory."""
    at = f"{path}.edge_radius"
    facets = sum(max(1.0, math.ceil(turn / FACET)) for _, turn, *_ in edges if turn > 0.0)
    rule = "facets of round edges are not too many"
    kept = v.at_most(rule, at, facets, MOST_FACETS, near=1e-3)
    if not kept:
        return
    limits = []
    tangents = [math.tan(0.5 * turn) if turn > 0.0 else 0.0 for _, turn, *_ in edges]
    for i, (_, _, before, behind) in enumerate(edges):
        limits.append(before / tangents[i] if tangents[i] else math.inf)
        beside = tangents[i + 1] if i + 1 < len(edges) else 0.0
        both = tangents[i] + beside
        limits.append(behind / both if both else math.inf)
    if limits and min(limits) < math.inf:
        v.at_most("arcs of edges fit on their faces", at, radius, min(limits), exact=False)


def check(scenario: Json, v: Verdict) -> Ground | None:
    """Check the ground of a scenario."""
    terrain, gauge = scenario["terrain"], scenario["robot"]["gauge"]
    kind = terrain["kind"]
    if kind == "lanes":
        return _check_lanes(terrain, v)
    if kind == "diagonal_barrier":
        return _check_barrier(terrain, gauge, v)
    if kind == "random_stepfield":
        return _check_field(terrain, gauge, v)
    return check_profile("terrain", terrain, v)


def check_lanes_apart(terrain: Json, v: Verdict) -> None:
    """Check the lanes that can be read if another one cannot."""
    if isinstance(terrain, dict) and terrain.get("kind") == "lanes":
        for name in ("left", "right", "middle"):
            lane, path = terrain.get(name), f"terrain.{name}"
            if isinstance(lane, dict) and v.is_clean(path):
                check_profile(path, lane, v)


def _as_read(value: Json) -> Json:
    """The same without optional fields; integers equal floats."""
    return {k: each for k, each in value.items() if k != "segment_friction" or each is not None}


def _check_lanes(terrain: Json, v: Verdict) -> Ground | None:
    left, right, middle = (terrain[name] for name in ("left", "right", "middle"))
    lanes = {"left": left, "right": right} | ({} if middle is None else {"middle": middle})
    made = {name: check_profile(f"terrain.{name}", lane, v) for name, lane in lanes.items()}
    grounds = [each for each in made.values() if each is not None]
    if len(grounds) < len(lanes):
        return None
    same = _as_read(left) == _as_read(right)
    low, high = max(each.low for each in grounds), min(each.high for each in grounds)
    goal = max(corners_of(left)[1], corners_of(right)[1])
    firsts = [each.first_edge for each in grounds if each.first_edge is not None]
    first = (min(e[0] for e in firsts), min(e[1] for e in firsts)) if firsts else (0.0, 0.0)
    if not same and middle is None:
        # Where the higher of two begins to be the other one there is an edge, too.
        if corners_of(left)[0] != corners_of(right)[0]:
            is_level = "points" not in (left["kind"], right["kind"])
            first = (0.0 if is_level else min(0.0, low), first[1])
        rule = "lanes have x in common"
        to = {"at": f"terrain.left.points[{len(left.get('points', [])) - 1}][0]", "there": low}
        if not v.at_least(rule, "terrain", high, low, more=True, **to):
            return None
    v.at_most("lanes reach their goal", "terrain", goal, high, at=_end(left))
    v.at_least("lanes reach their goal", "terrain", goal, low, at=_end(left))
    return Ground(low, high, first)


def _end(lane: Json) -> str:
    """The field by which a lane ends."""
    return f"terrain.left.{'length' if lane['kind'] == 'flat' else 'goal'}"


def _check_barrier(terrain: Json, gauge: float, v: Verdict) -> Ground:
    along = terrain["thickness"] / math.cos(terrain["yaw"])
    most, at = min(terrain["height"], 0.5 * along), "terrain.edge_radius"
    if terrain["edge_radius"] > SAME:
        if min(terrain["height"], along) < 2.0 * SAME:
            v.doubt("arcs of edges fit on their faces", at)
            most = math.inf
        rule, radius = "arcs of edges fit on their faces", terrain["edge_radius"]
        v.at_most(rule, at, radius, most, exact=False)
    end = along + gauge * abs(math.tan(terrain["yaw"]))
    return Ground(-RUN_OUT, end * (1.0 - ROUNDING) + RUN_OUT, (0.0, 0.0))


def _least_step(numbers: list[float]) -> float:
    """The smallest difference of two different values."""
    ordered = sorted(set(numbers))
    return min(b - a for a, b in pairwise(ordered))


def _check_field(terrain: Json, gauge: float, v: Verdict) -> Ground:
    """The core draws the heights of posts: check what is true for all heights."""
    radius, rise, post = (float(terrain[name]) for name in ("edge_radius", "rise", "post"))
    at, has_barrier = "terrain.edge_radius", terrain["barrier_height"] > 0.0
    length, yaw = terrain["posts"] * post, float(terrain["barrier_yaw"])
    apart, across = gauge * abs(math.tan(yaw)), terrain["barrier_thickness"] / math.cos(yaw)
    barrier = across + apart
    if radius > SAME:
        heights, places = [rise * k for k in range(terrain["levels"] + 1)], [0.0, post]
        if has_barrier:
            heights.append(float(terrain["barrier_height"]))
            begin = 0.5 * (length - barrier)
            ends = (0.0, across, apart, barrier)
            places = [post * k for k in range(terrain["posts"] + 1)] + [begin + e for e in ends]
        least = min(_least_step(heights), 0.5 * _least_step(places))
        if radius > 0.99 * least:
            v.doubt("arcs of edges fit on their faces", at)
    end = max(length, 0.5 * (length + barrier)) if has_barrier else length
    begin = min(0.0, 0.5 * (length - barrier)) if has_barrier else 0.0
    return Ground(begin - RUN_OUT, end + RUN_OUT, (begin, end))
