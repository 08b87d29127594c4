"""Scenarios with one to three fields at the borders of their rules, or with odd values in them."""

import copy
import json
import math
import random
import re
from collections import defaultdict
from collections.abc import Iterator
from typing import Any

from crawler2d.parameters.scenario import Scenario
from tests.fuzz.drawn_robots import Draw
from tests.fuzz.drawn_scenes import drawn_scenario
from tests.fuzz.rules.oracle import verdict_on
from tests.shared import VARIANTS

Json = Any

ODD: tuple[Any, ...] = (
    *(0, 0.0, -0.0, 1, 1.0, 2, 2.5, -1, math.nan, math.inf, -math.inf, "NaN", "Infinity"),
    *(1e308, -1e308, 5e-324, -5e-324, 1e-310, 2.2250738585072014e-308, 1e-20, 2**31, 2**32, 2**53),
    *(2**63, 2**64, 10**30, 10**400, -(10**400), 2**1024 - 1, True, False, None, "", "x", "12"),
    *("\ud800", "\U0001f600", "x" * 1000, "x" * 1001, [], {}, [[]], [None], [0], [0, 0], [0, 0, 0]),
    *([[0, 0]], [[0.0, 0.0]] * 2, [[0.0, 1.0], [1.0, 0.5]], [[0, 0, 0.05]], {"kind": "belt"}),
    *(
        {"kind": "x"},
        {"kind": None},
        {"kind": "round"},
        {"kind": "flat", "length": 1, "friction": 1},
    ),
    json.loads("[" * 12 + "]" * 12),
)
NAMES = (
    *("track", "wheel", "front", "rear", "both", "guide", "sprocket", "rectangle", "trapezoid"),
    *("skids", "wheels", "own", "smooth", "reference", "rapier", "flat", "hill", "diagonal"),
)
SWAPPED = (
    *("robot", "robot.track", "robot.flippers", "robot.outline", "robot.drivetrain", "robot.belly"),
    *("terrain", "drive", "drive.gait", "start", "solver", "robot.track.wheel", "terrain.left"),
    *("terrain.right", "terrain.middle", "robot.flippers.track", "robot.track.of"),
)
_STEP = re.compile(r"([^.\[\]]+)|\[(\d+)\]")


def read(tree: Json, path: str) -> Json:
    """The value at a path; KeyError, IndexError or TypeError if there is none."""
    for name, index in _STEP.findall(path):
        tree = tree[name] if name else tree[int(index)]
    return tree


def write(tree: Json, path: str, value: Json) -> bool:
    """Set the value at a path; False if there is no such path."""
    *parents, (name, index) = _STEP.findall(path)
    try:
        for step, number in parents:
            tree = tree[step] if step else tree[int(number)]
        if name and isinstance(tree, dict):
            tree[name] = value
            return True
        if index and isinstance(tree, list):
            tree[int(index)] = value
            return True
    except (KeyError, IndexError, TypeError):
        pass
    return False


def places(tree: Json, path: str = "") -> Iterator[str]:
    """Every path; of long lists only the ends."""
    if path:
        yield path
    if isinstance(tree, dict):
        for name, each in tree.items():
            yield from places(each, f"{path}.{name}".removeprefix("."))
    elif isinstance(tree, list):
        for i in {*range(min(3, len(tree))), len(tree) - 1} - {-1}:
            yield from places(tree[i], f"{path}[{i}]")


def near(draw: random.Random, limit: float) -> Json:
    """A number at a limit, just inside, just outside, or beyond."""
    if isinstance(limit, int):
        whole = limit + draw.choice((-1, 0, 0, 1))
        return draw.choice((whole, whole, whole, float(whole), float(limit), limit + 0.5))
    if limit == 0.0:
        tiny = (0, 0.0, -0.0, 5e-324, -5e-324, 1e-300, -1e-300, 2.2250738585072014e-308)
        return draw.choice((*tiny, 1e-12, -1e-12))
    chance, sign = draw.random(), draw.choice((-1.0, 1.0))
    if chance < 0.3:
        return int(limit) if limit == int(limit) and draw.random() < 0.3 else limit
    if chance < 0.5:
        return math.nextafter(limit, sign * math.inf)
    if chance < 0.8:
        return limit * (1.0 + sign * draw.choice((1e-7, 3e-8, 1e-8)))
    return limit * (1.0 + sign * draw.choice((1e-5, 0.01, 0.3, 0.9)))


def resized(draw: random.Random, value: Json, limit: float) -> Json:
    """A list or a text with about a given number of entries."""
    count = max(0, int(limit) + draw.choice((-1, 0, 0, 1)))
    if isinstance(value, str):
        return "n" * count
    if not isinstance(value, list):
        return [[0.0, 0.0]] * count
    return (value * (count // max(1, len(value)) + 1))[:count] if value else [[0.0, 0.0]] * count


class Base:
    """A scenario to start from, with the limits of its rules."""

    def __init__(self, tree: Json) -> None:
        self.tree, self.text = tree, json.dumps(tree)
        verdict = verdict_on(tree, with_limits=True)
        self.known = not verdict.unknown and not verdict.broken
        self.limits: dict[str, list[tuple[str, float]]] = defaultdict(list)
        for rule, path, limit in verdict.limits or []:
            # Lists of more are few and made one by one.
            if math.isfinite(limit) and not (rule.endswith("not longer") and limit >= 10_000):
                self.limits[rule].append((path, limit))
        self.rules = sorted(self.limits)
        self.places = list(places(tree))


class Borders:
    """Draws scenarios, the same for the same seed."""

    def __init__(self, more: list[Json]) -> None:
        trees = [*(json.loads(scenario.to_json()) for scenario in VARIANTS.values()), *more]
        self.bases = [Base(tree) for tree in trees]
        # Each rule as often as any other: from the bases that have it.
        self.by_rule: dict[str, list[Base]] = defaultdict(list)
        for base in self.bases:
            for rule in base.rules:
                self.by_rule[rule].append(base)
        self.rules = sorted(self.by_rule)

    def draw(self, draw: random.Random) -> Json:
        """One scenario as JSON data, with non-finite numbers as strings."""
        return _finite(self._drawn(draw))

    def _drawn(self, draw: random.Random) -> Json:
        chance = draw.random()
        if chance < 0.03:
            tree = json.loads(_drawn(draw).to_json())
            base = draw.choice(self.bases)
        elif chance < 0.55:
            rule = draw.choice(self.rules)
            base = draw.choice(self.by_rule[rule])
            tree = json.loads(base.text)
            self._at_limit(draw, tree, base, rule)
        else:
            base = draw.choice(self.bases)
            tree = json.loads(base.text)
            self._change(draw, tree, base)
        for _ in range(draw.choice((0, 0, 0, 1, 2))):
            self._change(draw, tree, base)
        return tree

    def _at_limit(self, draw: random.Random, tree: Json, base: Base, rule: str) -> None:
        path, limit = draw.choice(base.limits[rule])
        try:
            now = read(tree, path)
        except (KeyError, IndexError, TypeError):
            now = None
        if rule.endswith(("not longer", "not shorter", "2 points")):
            write(tree, path, resized(draw, now, limit))
        elif not isinstance(now, (list, dict)):
            write(tree, path, near(draw, limit))

    def _change(self, draw: random.Random, tree: Json, base: Base) -> None:
        chance, path = draw.random(), draw.choice(base.places)
        if chance < 0.35:
            self._at_limit(draw, tree, base, draw.choice(base.rules))
        elif chance < 0.6:
            write(tree, path, copy.deepcopy(draw.choice(ODD)))
        elif chance < 0.85:
            part, other = draw.choice(SWAPPED), draw.choice(self.bases).tree
            try:
                write(tree, part, copy.deepcopy(read(other, part)))
            except (KeyError, IndexError, TypeError):
                write(tree, part, None)
        elif chance < 0.92:
            self._rename(draw, tree, path)
        else:
            self._lose_or_add(draw, tree, path)

    def _rename(self, draw: random.Random, tree: Json, path: str) -> None:
        """Replace names and flags, if there are any."""
        named = [p for p in places(tree) if p.rpartition(".")[2] not in ("kind", "name")]
        named = [p for p in named if isinstance(_at(tree, p), (str, bool))] or [path]
        at = draw.choice(named)
        now = _at(tree, at)
        write(tree, at, not now if isinstance(now, bool) else draw.choice(NAMES))

    def _lose_or_add(self, draw: random.Random, tree: Json, path: str) -> None:
        now, (parent, _, name) = _at(tree, path), path.rpartition(".")
        holder = _at(tree, parent) if parent else tree
        if draw.random() < 0.4 and isinstance(now, dict):
            now[draw.choice(("unknown", "Mass", "kind", "discs", "axle_distance"))] = 0.1
        elif isinstance(now, list) and now:
            del now[draw.randrange(len(now))]
        elif isinstance(holder, dict) and name in holder:
            del holder[name]


def _at(tree: Json, path: str) -> Json:
    try:
        return read(tree, path)
    except (KeyError, IndexError, TypeError):
        return None


def _drawn(draw: random.Random) -> Scenario:
    while True:
        try:
            return drawn_scenario(Draw(draw.getrandbits(64)))
        except ValueError:
            continue


def _finite(tree: Json) -> Json:
    if isinstance(tree, dict):
        return {name: _finite(each) for name, each in tree.items()}
    if isinstance(tree, list):
        return [_finite(each) for each in tree]
    if isinstance(tree, float) and not math.isfinite(tree):
        return "NaN" if math.isnan(tree) else "Infinity" if tree > 0.0 else "-Infinity"
    return tree
