"""Whether a scenario is valid: all rules together, and those of the start of a run."""

from __future__ import annotations

import math

from tests.fuzz.rules import grounds, parts, robots
from tests.fuzz.rules.fields import Json, Reader
from tests.fuzz.rules.parts import discs_of, ends_of
from tests.fuzz.rules.verdict import ROUNDING, Verdict

FARTHEST_TURN = 0.7
"""[rad] A wheel or an arm turns by at most this in a step."""


def verdict_on(scenario: Json, *, with_limits: bool = False) -> Verdict:
    """Return the rules that a scenario, given as plain data, breaks."""
    v = Verdict(limits=[] if with_limits else None)
    reader = Reader(v)
    reader.whole_text(scenario)
    reader.part("", scenario, "scenario")
    if isinstance(scenario, dict):
        _check(scenario, v)
    for rule, path in reader.unknown:
        v.need(rule, path, kept=False)
    return v


def _check(scenario: Json, v: Verdict) -> None:
    """Check rules that involve several fields, as far as these can be read."""
    has_settings = v.is_clean("solver", "criteria")
    parts.check(scenario, v)
    robot = scenario.get("robot")
    is_robot = isinstance(robot, dict) and v.is_clean("robot")
    model = robots.check(robot, v) if is_robot else None
    if model is not None and has_settings:
        _check_sizes(scenario, model, v)
    ground = None
    if v.is_clean("terrain", "robot"):
        ground = grounds.check(scenario, v)
    else:
        grounds.check_lanes_apart(scenario.get("terrain"), v)
    if is_robot and has_settings:
        parts.check_engine(scenario, v)
    if ground is not None and model is not None and not v.broken:
        _check_start(scenario, model, ground, v)


def _check_sizes(scenario: Json, model: robots.Model, v: Verdict) -> None:
    """Steps must be short enough for the smallest wheel, and intrusions smaller than its radius."""
    robot, step = scenario["robot"], scenario["solver"]["time_step"]
    bodies, arms = model.all(), robot["flippers"]
    chain = robot["track"]["kind"] == "segmental"
    if step is not None:
        tip = min(body.tip for body in bodies)
        turn = max(robot["drivetrain"]["max_speed"] / tip, arms["rate_limit"] if arms else 0.0)
        rule, path, limit = "no part turns far in a step", "solver.time_step", FARTHEST_TURN / turn
        if chain and limit / 20.0 < step < 3.0 * limit:
            v.doubt(rule, path)
        else:
            v.at_most(rule, path, step, limit, exact=False)
    rule, path = "intrusions are less deep than the smallest radius", "criteria.intrusion_depth"
    depth = scenario["criteria"]["intrusion_depth"]
    low, high = (min(body.root[k] for body in bodies) for k in (0, 1))
    if low != high and low * (1.0 - ROUNDING) < depth < high * (1.0 + ROUNDING):
        v.doubt(rule, path)
    else:
        # Zero is always less.
        v.at_most(rule, path, depth, low if depth <= low else high, less=True, exact=False)


def _check_start(scenario: Json, model: robots.Model, ground: grounds.Ground, v: Verdict) -> None:
    """The ground must reach under the whole robot where it starts."""
    robot, start = scenario["robot"], scenario["start"]
    discs, belly = discs_of(robot["outline"]), robot["belly"] or []
    angle, arms = float(start["angle"]), robot["flippers"]
    certain = [(x, y, radius) for x, y, radius in discs]
    maybe = [(float(x), float(y), 0.0) for x, y in belly]
    if robot["track"]["kind"] != "closed":
        certain, maybe = [*certain, *maybe], []
    for body in model.chassis:
        if not math.isnan(body.x):
            own = (body.x, body.y, body.tip if body.is_sure else 1.5 * body.tip)
            (certain if body.is_sure else maybe).append(own)
    for bodies, end in zip(model.arms, robots.ends_with_arms(arms) if arms else [], strict=True):
        is_front = end == "front"
        (pivot_x, pivot_y, _), sign = ends_of(discs)[is_front], 1.0 if is_front else -1.0
        half, turn = 0.5 * arms["length"], sign * arms["angle"]
        arm = [(b.x, b.y, b.tip) for b in bodies]
        known = not any(math.isnan(b.x) for b in bodies)
        if not known:  # somewhere inside the outline of the arm
            largest = max(arms["root_radius"], arms["tip_radius"])
            arm = [(-half, 0.0, largest), (half, 0.0, largest)]
        turned = [_turned(x + sign * half, y, turn, radius) for x, y, radius in arm]
        placed = [(pivot_x + x, pivot_y + y, radius) for x, y, radius in turned]
        (certain if known else maybe).extend(placed)
    # Grousers of belts reach a little farther out than their circle where they are thick.
    thick = float(robot["outline"]["grouser_thickness"])
    reach = max(math.hypot(b.tip, thick) - b.tip for b in model.all())
    sides = []
    for bodies_ in (certain, [*certain, *maybe]):
        at = [_turned(x, y, angle, radius) for x, y, radius in bodies_]
        sides.append((min(x - r for x, _, r in at), max(x + r for x, _, r in at)))
    rear, front = (sides[0][0], sides[1][0] - reach), (sides[0][1], sides[1][1] + reach)
    approach = float(start["approach"])
    rule, path = "the ground reaches under the robot at its start", "terrain"
    low_edge, high_edge = ground.first_edge or (0.0, 0.0)
    rounding = 1e-9 * (1.0 + abs(ground.low) + abs(ground.high))
    # Its foremost point at x, its rearmost one its length behind.
    x, long = (low_edge - approach, high_edge - approach), (front[0] - rear[0], front[1] - rear[1])
    most = x[1] - long[0] - ground.low, ground.high - x[0]
    least = x[0] - long[1] - ground.low, ground.high - x[1]
    if v.limits is not None:
        v.limits.append((rule, "start.approach", approach + min(least)))
    if min(least) > rounding:
        v.need(rule, path, kept=True)
    elif min(most) < -rounding:
        v.need(rule, path, kept=False)
    else:
        v.doubt(rule, path)


def _turned(x: float, y: float, angle: float, radius: float) -> tuple[float, float, float]:
    c, s = math.cos(angle), math.sin(angle)
    return c * x - s * y, s * x + c * y, radius
