"""An oracle that knows the rules from the documentation agrees with the core."""

import ast
import copy
import dataclasses
import json
import random
import re
import time
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import crawler2d as c2d
from crawler2d.errors import Crawler2dError
from crawler2d.parameters.scenario import Scenario
from tests.fuzz.account import SEED, Account, cases
from tests.fuzz.drawn_borders import Borders, write
from tests.fuzz.rules.oracle import verdict_on
from tests.fuzz.rules.verdict import ANYWHERE
from tests.shared import GEAR, PLACEMENTS, ROBOT, TRAPEZOID, VARIANTS, with_flippers

Json = Any
Say = Callable[[str], None]

STEP = c2d.terrains.step(0.05)


def _driven(robot: c2d.Robot = ROBOT, **motor: Any) -> c2d.Robot:
    return dataclasses.replace(robot, drivetrain=dataclasses.replace(robot.drivetrain, **motor))


def _on(discs: Any, track: Any = None) -> c2d.Robot:
    outline = dataclasses.replace(TRAPEZOID.outline, discs=discs)
    robot = dataclasses.replace(ROBOT, outline=outline, belly=None)
    return robot if track is None else robot.with_track(track)


def _thin(robot: c2d.Robot) -> c2d.Robot:
    """With grousers so thin that hundreds fit on a belt."""
    outline = dataclasses.replace(robot.outline, grouser_thickness=5e-4)
    return dataclasses.replace(robot, outline=outline)


RAPIER = c2d.Solver(engine="rapier")
LEVEL = [[-3.0, 0.0], [0.0, 0.0], [2.0, 0.1], [3.0, 0.1]]
MORE = [
    Scenario(ROBOT.with_track(c2d.LineOfWheels(4)), STEP, solver=RAPIER),
    Scenario(ROBOT.with_track(c2d.ForceTrack()), STEP, solver=RAPIER),
    Scenario(_driven(torque_curve=((0.0, 6.0), (0.5, 4.0), (1.0, 1.0))), STEP),
    Scenario(_driven(controller=c2d.PI(2.0, 20.0)), STEP),
    Scenario(_driven(no_load_speed=1.0, rotor_inertia=0.01, self_locking=True), STEP),
    Scenario(_driven(ROBOT.with_track(c2d.LineOfWheels(4)), torque_sharing="wheel"), STEP),
    Scenario(ROBOT, c2d.terrains.lanes(STEP, c2d.terrains.flat())),
    Scenario(ROBOT, c2d.terrains.lanes(c2d.terrains.flat(length=10), c2d.terrains.flat())),
    Scenario(
        ROBOT,
        c2d.terrains.lanes(
            c2d.terrains.from_points(LEVEL, goal=0.0), c2d.terrains.from_points(LEVEL, goal=1.0)
        ),
    ),
    Scenario(
        ROBOT,
        c2d.terrains.from_points(
            LEVEL, goal=0.5, segment_friction=[0.9, 0.3, 0.9], edge_radius=0.1
        ),
    ),
    Scenario(ROBOT, c2d.terrains.random_stepfield(3, rise=0.01)),
    Scenario(ROBOT, c2d.terrains.random_stepfield(4, rise=0.01, edge_radius=0.002)),
    Scenario(
        with_flippers(c2d.ClosedTrack(c2d.LineOfWheels(4, wheel=GEAR))),
        STEP,
        drive=c2d.Drive(
            schedule=((1.0, 0.2), (2.0, -0.1)),
            gait=c2d.Hold(0.2, ((1.0, 0.3), (2.0, -0.3)), front=0.1, rear=-0.1),
        ),
    ),
    Scenario(with_flippers(c2d.HybridWheels(PLACEMENTS), c2d.LineOfWheels(3)), STEP),
    Scenario(with_flippers(c2d.CircumferentialWheels(24), ends="front"), STEP),
    Scenario(with_flippers(c2d.SegmentalTrack(shoe_count=30)), STEP),
    Scenario(_thin(with_flippers(c2d.GrouserBeltTrack())), STEP),
    Scenario(_thin(ROBOT.with_track(c2d.SegmentalTrack())), STEP),
    Scenario(ROBOT.with_track(c2d.SegmentalTrack(plate_thickness=0.004)), STEP),
    Scenario(ROBOT.with_track(c2d.ClosedTrack(c2d.SegmentalTrack(shoe_count=36))), STEP),
    Scenario(ROBOT.with_track(c2d.CircumferentialWheels(14)), STEP),
    Scenario(ROBOT.with_track(c2d.GrouserBeltTrack(grouser_count=40)), STEP),
    Scenario(
        ROBOT.with_track(c2d.LineOfWheels(3, wheel=dataclasses.replace(GEAR, grouser_count=5))),
        STEP,
    ),
    Scenario(
        ROBOT.with_track(c2d.HybridWheels(PLACEMENTS, wheel=GEAR)),
        c2d.terrains.gap(0.2),
        solver=c2d.Solver(time_step=1e-3),
    ),
    Scenario(_on(((-0.2, 0.0, 0.06), (0.0, -0.02, 0.05), (0.2, 0.0, 0.06))), STEP),
    Scenario(_on(((-6e-5, 0.0, 0.06), (6e-5, 0.0, 0.06), (0.0, -0.05, 0.05))), STEP),
    Scenario(_on(((-0.2, 0.0, 0.05), (0.0, 0.1, 0.2), (0.3, 0.0, 0.06))), STEP),
    Scenario(_on(((-0.2, 0.0, 0.07), (0.2, 0.01, 0.05))), STEP),
]
"""Scenarios of what the shared ones leave out."""


def _with(base: str | Scenario, fields: dict[str, Json]) -> Json:
    scenario = VARIANTS[base] if isinstance(base, str) else base
    tree = json.loads(scenario.to_json())
    for path, value in fields.items():
        assert write(tree, path, copy.deepcopy(value))
    return tree


FORCE: Json = {"kind": "force", "support": "wheels", "skid_friction": 0.0, "wheel_count": 3}
CHAIN: Json = json.loads(VARIANTS["segmental-step"].to_json())["robot"]["track"]
BELT: Json = {"kind": "belt"}
CLOSED: Json = {"kind": "closed", "of": BELT, "surface": "own"}
ARMS: Json = json.loads(VARIANTS["flippers-climb"].to_json())["robot"]["flippers"]


def _profile(points: Json, goal: float = 0.0) -> Json:
    return {"kind": "points", "points": points, "goal": goal, "edge_radius": 0.0, "friction": 0.5}


def _apart(gap: float) -> Json:
    left, right = _profile([[-3, 0], [1, 0]], 1.0), _profile([[1.0 + gap, 0], [3, 0]], 1.0 + gap)
    return {"kind": "lanes", "left": left, "right": right, "middle": None}


JOINED: list[tuple[str | Scenario, dict[str, Json]]] = [
    ("closed-barrier", {"robot.track.of": CLOSED}),
    ("flippers-climb", {"robot.flippers.track": CLOSED}),
    ("flippers-climb", {"robot.flippers.track": CHAIN}),
    ("flippers-climb", {"robot.flippers.track": FORCE}),
    ("flippers-climb", {"solver.engine": "rapier"}),
    (MORE[0], {"robot.flippers": ARMS}),
    (MORE[0], {"terrain": {**_profile(LEVEL), "segment_friction": [0.5] * 3}}),
    (MORE[3], {"robot.drivetrain.self_locking": True}),
    ("belt-on-discs-step", {"robot.track": FORCE}),
    ("belt-on-discs-step", {"robot.track": {**CHAIN, "mechanism": "sprocket"}}),
    ("segmental-step", {"robot.track.road_wheel_count": 3}),
    ("segmental-step", {"solver.restitution": 0.5}),
    (
        "belt-on-discs-step",
        {"robot.outline.discs": [[-5e-5, 0, 0.06], [5.0000001e-5, 0, 0.06], [0, -0.05, 0.05]]},
    ),
    ("belt-step", {"solver.accuracy": None}),
    ("belt-points", {"terrain.points": [[0, 0], [0, 1]]}),
    ("belt-points", {"terrain.points": [[0, 0], [0, 0]]}),
    ("belt-points", {"terrain.points": [[-3, 0], [0, 0], [0, 1], [0, 0.5], [3, 0.5]]}),
    ("belt-points", {"terrain.segment_friction": 0.5}),
    ("belt-lanes", {"terrain.left": _apart(0.0)}),
    ("belt-lanes", {"terrain": _apart(1e-7)}),
    ("belt-lanes", {"terrain": _apart(-1e-7)}),
]
"""What takes several fields to break, which are seldom drawn together."""


def _spikes(count: int) -> Json:
    """Ground with so many spikes, each of which takes 180 facets if it is rounded."""
    points = [[0.001 * i, float(i % 2)] for i in range(2 * count + 1)]
    changed = {"terrain.points": [[-9.0, 0.0], *points], "terrain.edge_radius": 2e-9}
    return _with("belt-points", changed)


def _long() -> list[Json]:
    """Lists of the largest length, and one longer."""
    step = [[0.001 * i, 0.0] for i in range(200_001)]
    level = {"goal": 0.0, "kind": "points", "edge_radius": 0.0, "friction": 0.5}
    made = [_spikes(5555), _spikes(5556)]
    for count in (200_000, 200_001):
        ground = {**level, "points": step[:count], "segment_friction": [0.5] * (count - 1)}
        made.append(_with("belt-points", {"terrain": ground}))
    for count in (200_000, 200_001):
        ground = {**level, "points": step[:9], "segment_friction": [0.5] * count}
        made.append(_with("belt-points", {"terrain": ground}))
    for count in (10_000, 10_001):
        rows = [[1.0 * i, 0.0] for i in range(count)]
        made.append(_with("belt-step", {"drive.schedule": rows}))
        hold = {"kind": "hold", "angle": 0.0, "schedule": rows}
        made.append(_with("belt-step", {"drive.gait": hold}))
    return made


class Agreement(Account):
    """How oracle and core judged the same scenarios: a disagreement is a fault."""

    def __init__(self, name: str) -> None:
        super().__init__(name)
        self.numeric: set[str] = set()
        """Rules with a limit."""
        self.broken: Counter[str] = Counter()
        self.at_border: Counter[str] = Counter()
        self.unknown: Counter[str] = Counter()
        self.texts: set[str] = set()
        """Rules as the core words them."""

    def judge(self, case: str, tree: Json) -> None:
        verdict, refused = verdict_on(tree), None
        try:
            Scenario.from_json(json.dumps(tree, allow_nan=False)).validate()
        except c2d.ScenarioError as error:
            refused = error
            self.texts.add(error.rule)
        except Crawler2dError as error:  # no memory: not a rule of scenarios
            self.counts[type(error).__name__] += 1
            return
        self.broken.update(verdict.rules_broken)
        self.at_border.update(verdict.at_border)
        unknown = {rule for rules in verdict.unknown.values() for rule in rules}
        if refused is None and verdict.broken:
            self.fault(f"accepted, but breaks {sorted(verdict.rules_broken)}", case)
        elif refused is None:
            self.counts["unknown" if unknown else "accepted"] += 1
            self.unknown.update(unknown)
        elif refused.path in verdict.broken:
            self.counts["refused"] += 1
        elif verdict.unknown.keys() & {refused.path, ANYWHERE}:
            self.counts["unknown"] += 1
            self.unknown.update(unknown)
        else:
            self.fault(f"refused at another path: {refused}", f"{case}: {verdict.broken}")


def judged(count: int) -> Agreement:
    """A number of drawn scenarios; a case is determined by its number and the seed."""
    borders = Borders([json.loads(scenario.to_json()) for scenario in MORE])
    account, begin = Agreement("rules"), time.process_time()
    account.numeric.update(borders.rules)
    for case, (base, fields) in enumerate(JOINED):
        account.judge(f"joined {case}", _with(base, fields))
    for case in range(count):
        account.judge(f"case {case}", borders.draw(random.Random(f"{SEED}:rules:{case}")))
    account.reasons.update({f"unknown: {rule}": n for rule, n in account.unknown.items()})
    account.took(time.process_time() - begin, "all of them")
    return account


RULES = Path(__file__).parent / "rules"


def named_rules() -> set[str]:
    """The rules that the oracle's sources name, but for those of fields by their tables."""
    found = set()
    for path in RULES.glob("*.py"):
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute):
                if node.func.attr in ("need", "at_least", "at_most") and node.args:
                    found.add(node.args[0])
            elif isinstance(node, ast.Assign):
                for target, value in _pairs(node):
                    if isinstance(target, ast.Name) and target.id == "rule":
                        found.add(value)
    values = {node.value for node in found if isinstance(node, ast.Constant)}
    return {value for value in values if isinstance(value, str)}


def _pairs(node: ast.Assign) -> list[tuple[ast.expr, ast.expr]]:
    target, value = node.targets[0], node.value
    if isinstance(target, ast.Tuple) and isinstance(value, ast.Tuple):
        return list(zip(target.elts, value.elts, strict=True))
    return [(target, value)]


CORE = Path(__file__).parents[2] / "rust_core" / "src"
SOURCES = (
    *("scenario/*.rs", "robot/**/*.rs", "terrain/*.rs", "engine/limits.rs", "geometry/gear.rs"),
    "run/valid_scenario.rs",
)
"""Where the rules of scenarios are worded."""


def worded_rules() -> set[str]:
    """The rules as the core's sources word them, with a gap {} for each value."""
    found = set()
    for path in (path for pattern in SOURCES for path in CORE.glob(pattern)):
        source = path.read_text().split("#[cfg(test)]")[0]
        source = re.sub(r"///.*|\.replacen\([^()]*\)", "", source)
        for text in re.findall(r'"((?:must |\{allowed\})(?:[^"\\]|\\.)*)"', source, re.DOTALL):
            found.add(re.sub(r"\\\n\s*", "", text).replace('\\"', '"'))
    return found


def _is_worded(rule: str, texts: set[str]) -> bool:
    """Whether one of these texts is that rule; some rules are the beginning of others."""
    gaps = ".*".join(map(re.escape, re.split(r"\{[^{}]*\}", rule)))
    return any(re.fullmatch(f"{gaps}(: .*)?", text, re.DOTALL) for text in texts)


TEXTS = {
    "{": "scenario must be JSON",
    '{"schema": 2, "schema": 2}': "schema must be given only once",
    '{"schema": 1}': "schema must be 2; in a file of version 1",
    " " * (65 << 20): "scenario must be at most 64 MiB",
}
"""What plain data cannot say, and what it is refused with."""


def _texts() -> set[str]:
    rules = set()
    for text, message in TEXTS.items():
        with pytest.raises(c2d.ScenarioError) as caught:
            Scenario.from_json(text)
        assert f"{caught.value.path} {caught.value.rule}".startswith(message)
        rules.add(caught.value.rule)
    return rules


# Doubtful values may give warnings, which are not tested here.
pytestmark = pytest.mark.filterwarnings("ignore::crawler2d.ScenarioWarning")


def check(account: Agreement, count: int, say: Say = print) -> None:
    say(str(account))
    assert not account.faults
    assert account.counts["accepted"] > 0.1 * count
    assert account.counts["refused"] > 0.5 * count
    assert account.counts["unknown"] < 0.03 * count


def test_the_oracle_agrees_with_the_core_about_two_thousand_scenarios() -> None:
    check(judged(2_000), 2_000)


def test_values_that_plain_data_cannot_represent_are_refused() -> None:
    assert len(_texts()) == len(TEXTS)


@pytest.mark.soak
def test_the_oracle_agrees_with_the_core_about_every_rule(say: Say) -> None:
    count = cases("RULES", 200_000)
    account = judged(count)
    for case, tree in enumerate(_long()):
        account.judge(f"long {case}", tree)
    check(account, count, say)
    rules = named_rules() | account.numeric | account.broken.keys()
    counts = {rule: (account.broken[rule], account.at_border[rule]) for rule in sorted(rules)}
    say("broken, just kept: " + "; ".join(f"{rule} {n}, {k}" for rule, (n, k) in counts.items()))
    assert [rule for rule in rules if not account.broken[rule]] == []
    assert [rule for rule in account.numeric if not account.at_border[rule]] == []
    worded, texts = worded_rules(), account.texts | _texts()
    say(f"{len(rules)} rules, {len(account.numeric)} of them with a limit; {len(worded)} texts")
    assert [rule for rule in worded if not _is_worded(rule, texts)] == []
