"""Rules that join fields of a robot, of a command and of the settings."""

from __future__ import annotations

import math

from tests.fuzz.rules.fields import ENDS, Json
from tests.fuzz.rules.verdict import Verdict

LEAST_FRACTION = 1e-5
"""Least mass of a moving part as a share of the robot's."""
WITH_WHEELS = ("line", "circumferential", "hybrid")


def check(scenario: Json, verdict: Verdict) -> None:
    """Check all of them, each if its own fields can be read."""
    v = verdict
    robot = scenario.get("robot")
    if isinstance(robot, dict):
        _check_robot(robot, v)
    _check_lanes(scenario.get("terrain"), v)
    _check_schedules(scenario.get("drive"), v)
    if v.is_clean("solver"):
        _check_steps(scenario["solver"], v)
    if v.is_clean("drive", "robot.drivetrain") and isinstance(robot, dict):
        _check_speeds(scenario["drive"], robot["drivetrain"]["max_speed"], v)


def _check_schedules(drive: Json, v: Verdict) -> None:
    """Each where it can be read itself."""
    if isinstance(drive, dict):
        if v.is_clean("drive.schedule"):
            _check_times("drive.schedule", drive.get("schedule"), v)
        gait: Json = drive.get("gait")
        if _kind(gait) == "hold" and v.is_clean("drive.gait.schedule"):
            _check_times("drive.gait.schedule", gait.get("schedule"), v)


def _check_times(path: str, rows: Json, v: Verdict) -> None:
    for i, (before, row) in enumerate(zip(rows or [], (rows or [])[1:], strict=False)):
        at = f"{path}[{i + 1}][0]"
        v.at_least("times of a schedule increase", at, row[0], before[0], more=True)


def _check_steps(solver: Json, v: Verdict) -> None:
    accuracy, step = solver["accuracy"], solver["time_step"]
    either = accuracy is not None or step is not None
    v.need("an accuracy or a time step", "solver.accuracy", either)
    both = accuracy is not None and step is not None
    v.need("not an accuracy and a time step", "solver.time_step", not both)


def _check_speeds(drive: Json, most: float, v: Verdict) -> None:
    rule = "no commanded speed exceeds the largest"
    v.at_most(rule, "drive.speed", abs(drive["speed"]), most)
    for i, row in enumerate(drive["schedule"] or []):
        v.at_most(rule, f"drive.schedule[{i}][1]", abs(row[1]), most)


def check_engine(scenario: Json, v: Verdict) -> None:
    """Chains have no restitution, and rapier none of our own settings."""
    solver, robot, terrain = scenario["solver"], scenario["robot"], scenario.get("terrain")
    if robot["track"]["kind"] == "segmental":
        bounces = solver.get("restitution", 0.0) > 0.0
        v.need("a chain does not bounce", "solver.restitution", not bounces)
    if solver.get("engine", "own") == "own":
        return
    own = {
        "accuracy": None,
        "contact": "own",
        "iterations": None,
        "contact_frequency": 1000.0,
        "contact_damping_ratio": 5.0,
        "max_push_speed": 0.5,
        "prediction_distance": 0.0002,
        "restitution": 0.0,
    }
    for name, default in own.items():
        kept = solver.get(name, default) == default
        v.need(f"rapier has no {name}", f"solver.{name}", kept)
    motors = {
        "rotor_inertia": 0.0,
        "no_load_speed": None,
        "torque_curve": None,
        "controller": None,
        "self_locking": False,
    }
    for name, default in motors.items():
        kept = robot["drivetrain"].get(name, default) == default
        v.need(f"rapier has no {name}", f"robot.drivetrain.{name}", kept)
    held = robot["track"]["kind"] in (*WITH_WHEELS, "force")
    v.need("rapier has wheels and forces", "robot.track.kind", held)
    v.need("rapier has no flippers", "robot.flippers", robot["flippers"] is None)
    if v.is_clean("terrain") and terrain is not None:
        lanes = {"terrain": terrain}
        if terrain["kind"] == "lanes":
            lanes = {f"terrain.{name}": terrain[name] for name in ("left", "right", "middle")}
        for path, lane in lanes.items():
            if lane is not None and lane["kind"] == "points":
                kept = lane.get("segment_friction") is None
                v.need("rapier has one friction", f"{path}.segment_friction", kept)


def discs_of(outline: Json) -> list[list[float]]:
    """[m] Centres and radii of an outline, as `discs` or by the ends."""
    if "discs" in outline:
        return [list(map(float, disc)) for disc in outline["discs"]]
    distance, front, rear = (float(outline[name]) for name in ENDS)
    return [[-0.5 * distance, 0.0, rear], [0.5 * distance, 0.0, front]]


def ends_of(discs: list[list[float]]) -> tuple[list[float], list[float]]:
    """[m] The discs that reach farthest back and forwards; the higher one of two."""
    rear = max(discs, key=lambda disc: (disc[2] - disc[0], disc[1]))
    front = max(discs, key=lambda disc: (disc[2] + disc[0], disc[1]))
    return rear, front


def open_track(track: Json) -> Json:
    """The model itself, or the one inside a closed track."""
    return track["of"] if track["kind"] == "closed" else track


def _check_robot(robot: Json, v: Verdict) -> None:
    outline = robot.get("outline")
    if v.is_clean("robot.outline.discs") and isinstance(outline, dict) and "discs" in outline:
        _check_discs(discs_of({"discs": outline["discs"]}), v)
    if v.is_clean("robot.outline"):
        _check_outline(robot["outline"], v)
    if v.is_clean("robot.belly") and robot["belly"] is not None:
        _check_belly(robot["belly"], v)
    drivetrain = robot.get("drivetrain")
    if isinstance(drivetrain, dict):
        curve, most = drivetrain.get("torque_curve"), "robot.drivetrain.max_torque"
        if curve and v.is_clean("robot.drivetrain.torque_curve", most):
            _check_curve(curve, drivetrain["max_torque"], v)
    if v.is_clean("robot.drivetrain"):
        _check_drivetrain(robot["drivetrain"], v)
    _check_track("robot.track", robot.get("track"), v)
    arms = robot.get("flippers")
    if isinstance(arms, dict):
        _check_track("robot.flippers.track", arms.get("track"), v)
    if v.is_clean("robot.flippers") and arms is not None:
        apart = abs(arms["root_radius"] - arms["tip_radius"])
        at, length = "robot.flippers.tip_radius", arms["length"]
        rule, there = "no end of an arm encloses the other", arms["root_radius"] + length
        v.at_most(rule, at, apart, length, less=True, there=there)
    if v.is_clean("robot"):
        _check_masses(robot, v)
        _check_models(robot, v)
        if arms is not None:
            _check_arms(robot, arms, v)


def _check_discs(discs: list[list[float]], v: Verdict) -> None:
    path = "robot.outline.discs"
    for i, (x, y, radius) in enumerate(discs):
        for k, (other_x, other_y, other) in enumerate(discs):
            if i == k or other < radius:
                continue
            apart, least = math.hypot(x - other_x, y - other_y), other - radius
            aside = math.sqrt(max(0.0, least**2 - (y - other_y) ** 2))
            to = {"at": f"{path}[{i}][0]", "there": other_x + math.copysign(aside, x - other_x)}
            # The last digit of a distance is unknown.
            exact, rule = y == other_y or apart == least == 0.0, "no disc lies in another"
            v.at_least(rule, f"{path}[{i}]", apart, least, more=True, exact=exact, **to)


def _check_outline(outline: Json, v: Verdict) -> None:
    path, discs = "robot.outline", discs_of(outline)
    if "discs" in outline:
        rear, front = ends_of(discs)
        at, to = f"{path}.discs", f"{path}.discs[{discs.index(front)}][0]"
        rule, apart, there = "ends are apart", front[0] - rear[0], rear[0] + 1e-4
        v.at_least(rule, at, apart, 1e-4, at=to, there=there)
        v.need("the origin is between the ends", at, rear[0] < 0.0 < front[0])
    else:
        (rear_x, _, rear_radius), (front_x, _, front_radius) = discs
        differ, at = abs(front_radius - rear_radius), f"{path}.front_radius"
        rule, apart = "no end encloses the other", front_x - rear_x
        v.at_most(rule, at, differ, apart, less=True, there=rear_radius + apart)
    smallest = min(radius for _, _, radius in discs)
    height, thickness = outline["grouser_height"], outline["grouser_thickness"]
    rule = "grousers leave a belt"
    v.at_most(rule, f"{path}.grouser_height", height, smallest, less=True)
    rule, pitch = "grousers are thinner than their pitch", outline["grouser_pitch"]
    v.at_most(rule, f"{path}.grouser_thickness", thickness, pitch, less=True)


def _check_belly(corners: Json, v: Verdict) -> None:
    """Left turns only, and once round."""
    count, round_ = len(corners), 0.0
    for i in range(count):
        (ax, ay), (bx, by), (cx, cy) = (corners[(i + k) % count] for k in range(3))
        before, behind = (bx - ax, by - ay), (cx - bx, cy - by)
        turn = before[0] * behind[1] - before[1] * behind[0]
        v.need("a belly is convex", f"robot.belly[{(i + 1) % count}]", turn > 0.0)
        round_ += math.atan2(turn, before[0] * behind[0] + before[1] * behind[1])
    if v.is_clean("robot.belly"):
        v.need("a belly goes round once", "robot.belly", round_ < 3.0 * math.pi)


def _check_drivetrain(drivetrain: Json, v: Verdict) -> None:
    path = "robot.drivetrain"
    curve, locking = drivetrain.get("torque_curve"), drivetrain.get("self_locking", False)
    if drivetrain.get("controller") is not None:
        v.need("no controller on a gear that locks", f"{path}.self_locking", not locking)
    if curve is not None:
        none = drivetrain.get("no_load_speed") is None
        v.need("a curve or a speed without load", f"{path}.no_load_speed", none)


def _check_curve(curve: Json, most: float, v: Verdict) -> None:
    at = "robot.drivetrain.torque_curve"
    v.need("a curve starts at rest", f"{at}[0][0]", curve[0][0] == 0.0)
    same = abs(curve[0][1] - most) <= 1e-9 * most
    v.need("a curve starts with the largest torque", f"{at}[0][1]", same)
    for i in range(1, len(curve)):
        (speed, torque), (next_speed, next_torque) = curve[i - 1], curve[i]
        rule = "speeds of a curve increase"
        v.at_least(rule, f"{at}[{i}][0]", next_speed, speed, more=True)
        v.at_most("torques of a curve do not rise", f"{at}[{i}][1]", next_torque, torque)


def _check_track(path: str, track: Json, v: Verdict) -> None:
    """Check rules of a model itself, which may be incomplete."""
    kind, inner = _kind(track), f"{path}.of"
    if kind == "closed" and "of" in track:
        if v.is_clean(inner):
            v.need("a closed track is closed once", inner, _kind(track["of"]) != "closed")
        _check_track(inner, track["of"], v)
    if kind == "segmental" and v.is_clean(path) and track["mechanism"] == "guide":
        for name in ("road_wheel_count", "return_roller_count"):
            v.need("a guide has no wheels", f"{path}.{name}", track[name] is None)


def _kind(value: Json) -> Json:
    """The kind of an object, or nothing if it is not an object."""
    return value.get("kind") if isinstance(value, dict) else None


def _check_lanes(terrain: Json, v: Verdict) -> None:
    if _kind(terrain) == "lanes":
        for name in ("left", "right", "middle"):
            several = ("lanes", "diagonal_barrier", "random_stepfield")
            kept = _kind(terrain.get(name)) not in several
            v.need("a lane has one profile", f"terrain.{name}", kept)


def _check_masses(robot: Json, v: Verdict) -> None:
    mass, of_track = robot["mass"], robot["track_mass"]
    rule, least = "tracks weigh a hundred-thousandth", LEAST_FRACTION * mass
    v.at_most("tracks leave as much for the chassis", "robot.track_mass", of_track, mass - least)
    v.at_least(rule, "robot.track_mass", of_track, least)
    radius = max(disc[2] for disc in discs_of(robot["outline"]))
    at, inertia = "robot.moment_of_inertia", robot["moment_of_inertia"]
    rule = "inertia exceeds that of tracks as far out as the largest radius"
    v.at_least(rule, at, inertia, of_track * radius * radius, more=True)
    rotors = {"drivetrain": robot["drivetrain"], "flippers": robot["flippers"] or {}}
    for name, part in rotors.items():
        rotor, rule = part.get("rotor_inertia", 0.0), f"rotors of {name} leave digits"
        v.at_most(rule, f"robot.{name}.rotor_inertia", rotor, inertia / LEAST_FRACTION)


def _has_wheels(track: Json) -> bool:
    return open_track(track)["kind"] in WITH_WHEELS


def _check_models(robot: Json, v: Verdict) -> None:
    """Check the motors and the number of discs that a model needs."""
    track, drivetrain, discs = robot["track"], robot["drivetrain"], discs_of(robot["outline"])
    if drivetrain.get("self_locking", False):
        is_force = open_track(track)["kind"] == "force"
        v.need("no force locks", "robot.drivetrain.self_locking", not is_force)
    arms = robot["flippers"]
    if drivetrain["torque_sharing"] == "wheel":
        of_arms = arms["track"] if arms is not None else None
        kept = _has_wheels(track) and (of_arms is None or _has_wheels(of_arms))
        v.need("only wheels have motors each", "robot.drivetrain.torque_sharing", kept)
    if len(discs) > 2:
        path = "robot.track.of" if track["kind"] == "closed" else "robot.track"
        model = open_track(track)
        v.need("a line has two ends", f"{path}.kind", model["kind"] != "line")
        if model["kind"] == "force":
            v.need("free wheels have two ends", f"{path}.support", model["support"] == "skids")
        if model["kind"] == "segmental":
            kept = model["mechanism"] == "guide"
            v.need("a sprocket is of two discs", f"{path}.mechanism", kept)


def _check_arms(robot: Json, arms: Json, v: Verdict) -> None:
    path, height = "robot.flippers", robot["outline"]["grouser_height"]
    smallest = min(arms["root_radius"], arms["tip_radius"])
    rule = "radii of arms exceed the grousers"
    v.at_least(rule, f"{path}.tip_radius", smallest, height, more=True)
    rule, least = "an arm weighs a hundred-thousandth", LEAST_FRACTION * robot["mass"]
    v.at_least(rule, f"{path}.mass", arms["mass"], least)
    count = 4 if arms["ends"] == "both" else 2
    left = (robot["mass"] - least - robot["track_mass"]) / count
    rule = "arms leave as much for the chassis"
    # A sum or a quotient: the result is unknown if both are equal except for rounding.
    v.at_most(rule, f"{path}.mass", arms["mass"], left, exact=False)
    own, track = open_track(robot["track"])["kind"], arms["track"]
    at = f"{path}.track"
    if track is None:
        v.need("wheels by hand are given for arms, too", at, own != "hybrid")
        return
    kind = track["kind"]
    v.need("no chain on arms", at, kind != "segmental")
    v.need("no closed track on arms", at, kind != "closed")
    v.need("forces on arms and chassis", at, (kind == "force") == (own == "force"))
