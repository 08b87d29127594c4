"""Legal scenarios, drawn over the whole range of every field: grounds, commands and settings."""

import math
from collections.abc import Callable
from typing import Any

import crawler2d as c2d
from crawler2d.parameters.scenario import Scenario
from crawler2d.parameters.terrain import Lane, Points, RandomStepfield, Terrain
from crawler2d.parameters.track import Track
from tests.fuzz.drawn_robots import TINY, Draw, drawn_robot, smallest_end

STEPS = 600
"""Longest run, about."""


def _friction(draw: Draw) -> float:
    return draw.size_or_zero(1e-12, 100.0, (0.1, 2.0))


def _rough(draw: Draw, size: float, reach: float) -> Points:
    """Random walls and slopes, some of them tiny, with level ground at both ends."""
    count = draw.whole(1, 2000, (3, 40))
    x, points = 0.0, [(-reach, 0.0), (0.0, 0.0)]
    for _ in range(count):
        y = draw.signed(1e4, 0.5 * size)
        if draw.random() < 0.5:
            points.append((x, y))
        x += draw.size(1e-9, 1e4, (0.05 * size, size))
        points.append((x, y))
    points.append((x + reach, points[-1][1]))
    if draw.random() < 0.2:
        points.reverse()
    edge_radius = draw.size_or_zero(1e-9, 10.0, (0.001 * size, 0.05 * size))
    goal = draw.signed(1e7, x)
    return c2d.terrains.from_points(
        points, goal=goal, edge_radius=edge_radius, friction=_friction(draw)
    )


def _lane(draw: Draw, size: float, reach: float) -> Lane:
    t = c2d.terrains
    height = draw.size(TINY, 100.0, (0.05 * size, 1.5 * size))
    length = draw.size(1e-3, 1e4, (0.1 * size, 5.0 * size))
    rest: dict[str, Any] = {"friction": _friction(draw)}
    edge = {**rest, "edge_radius": draw.size(1e-12, 10.0, (0.001 * size, 0.05 * size))}
    if draw.random() < 0.6:
        edge["edge_radius"] = 0.0
    slope = max(-1.55334, min(1.55334, draw.signed(1.55334, 0.8)))
    lanes: tuple[Callable[[], Lane], ...] = (
        lambda: t.flat(length=length, **rest),
        lambda: t.step(height, **edge),
        lambda: t.ramp(slope, length=length, **edge),
        lambda: t.barrier(height, length, **edge),
        lambda: t.ridge(height, draw.size(0.01, 3.13, (0.3, 2.5)), **edge),
        lambda: t.gap(length, depth=height, **edge),
        lambda: t.stairs(count=draw.whole(1, 1000, (1, 6)), rise=height, run=length, **edge),
        lambda: t.half_round(draw.size(1e-3, 100.0, (0.05 * size, size)), **rest),
        lambda: _rough(draw, size, reach),
    )
    return draw.choice(lanes)()


def drawn_terrain(draw: Draw, size: float, reach: float) -> Terrain:
    """Ground for a robot of a size [m], level for at least `reach` [m] at its ends."""
    chance = draw.random()
    if chance < 0.7:
        return _lane(draw, size, reach)
    if chance < 0.85:
        middle = _lane(draw, size, reach) if draw.random() < 0.4 else None
        return c2d.terrains.lanes(_lane(draw, size, reach), _lane(draw, size, reach), middle=middle)
    height = draw.size(TINY, 100.0, (0.05 * size, size))
    across = draw.size(1e-3, 1e4, (0.1 * size, size))
    yaw = max(-1.396, min(1.396, draw.signed(1.396, 1.0)))
    rest: dict[str, Any] = {
        "edge_radius": draw.size_or_zero(1e-9, 10.0, (0.001 * size, 0.05 * size)),
        "friction": _friction(draw),
    }
    if chance < 0.92:
        return c2d.terrains.diagonal_barrier(yaw, height=height, thickness=across, **rest)
    return RandomStepfield(
        draw.randrange(2**32),
        pattern=draw.choice(("flat", "hill", "diagonal")),
        posts=draw.whole(1, 1000, (2, 20)),
        post=draw.size(1e-3, 1e4, (0.1 * size, size)),
        rise=draw.size(TINY, 100.0, (0.01 * size, 0.3 * size)),
        levels=draw.whole(1, 1000, (1, 6)),
        barrier_height=0.0 if draw.random() < 0.5 else height,
        barrier_thickness=across,
        barrier_yaw=yaw,
        **rest,
    )


def _schedule(draw: Draw, duration: float, high: float) -> tuple[tuple[float, float], ...] | None:
    if draw.random() < 0.6:
        return None
    rows, time = [], 0.0
    for _ in range(draw.whole(0, 200, (1, 5))):
        time += draw.size(1e-12, 300.0, (0.05 * duration, 0.4 * duration))
        rows.append((time, max(-high, min(high, draw.signed(high, high)))))
    return tuple(rows)


def drawn_drive(draw: Draw, duration: float, max_speed: float, *, arms: bool) -> c2d.Drive:
    """Commands within a time [s]."""
    high = max_speed
    gait: c2d.Hold | c2d.Climb | None = None
    if arms and draw.random() < 0.8:
        angles = [max(-6.3, min(6.3, draw.signed(6.3, 1.5))) for _ in range(4)]
        gait = c2d.Hold(angles[0], _schedule(draw, duration, 6.3))
        if draw.random() < 0.5:
            reach, sweep, push, _ = angles
            level = draw.size(TINY, 1.5, (0.02, 0.3))
            gait = c2d.Climb(
                reach_angle=reach, sweep_angle=sweep, push_angle=push, level_angle=level
            )
    speed = draw.size_or_zero(min(TINY, high), high, (0.1 * high, high))
    sign = draw.choice((1.0, 1.0, -1.0))
    return c2d.Drive(speed=sign * speed, schedule=_schedule(draw, duration, high), gait=gait)


def drawn_criteria(draw: Draw, duration: float) -> c2d.SeizureCriteria:
    """Windows that end within a time [s], most of them."""

    def share(usual: float) -> float:
        return draw.size(TINY, 1.0, (0.3 * usual, min(1.0, 3.0 * usual)))

    def share_or_zero(usual: float) -> float:
        return draw.size_or_zero(TINY, 1.0, (0.3 * usual, min(1.0, 3.0 * usual)))

    def window(high: float) -> float:
        return draw.size(0.01, high, (0.02 * duration, 0.5 * duration))

    return c2d.SeizureCriteria(
        stop_window=window(1e4),
        stop_pitches=draw.size_or_zero(1e-9, 1e3, (0.01, 3.0)),
        stop_progress=share(0.05),
        stationary_distance=draw.size(TINY, 1.0, (1e-7, 1e-3)),
        stationary_windows=draw.whole(1, 1000, (1, 4)),
        clear_time=draw.size_or_zero(1e-9, 1e4, (0.02 * duration, 0.5 * duration)),
        clear_angle=draw.size(TINY, 3.15, (0.02, 0.5)),
        tip_over_angle=draw.size(TINY, 3.15, (0.8, 3.15)),
        intrusion_depth=draw.size_or_zero(1e-12, 0.1, (1e-4, 1e-3)),
        intrusion_load=share(0.02),
        belly_load=share(0.1),
        sliding_speed=share(0.02),
        torque_limit=share(0.98),
        cycling_distance=draw.size(TINY, 10.0, (1e-3, 0.05)),
        imbalance=share(1e-3),
        mean_imbalance=share(0.02),
        creep_from=share_or_zero(0.02),
        creep_to=share_or_zero(0.2),
        escape_distance=draw.size(TINY, 10.0, (0.01, 0.1)),
        escape_time=draw.size(0.01, 60.0, (0.1 * duration, duration)),
    )


def drawn_solver(draw: Draw, longest: float, track: Track) -> tuple[c2d.Solver, float]:
    """For a robot on a track, with a time step up to the longest [s]; and about that length."""
    is_chain = isinstance(track, c2d.SegmentalTrack)
    how: dict[str, Any] = {}
    if draw.random() < 0.25:
        step = draw.size(1e-5, max(1e-5, min(1.0 / 30.0, longest)), (2e-4, 4e-3))
        how["time_step"] = step
    else:
        how["accuracy"] = draw.size(1e-10, 1e-2, (1e-7, 1e-5))
        # In free fall.
        step = min(max(2e-5, math.sqrt(how["accuracy"] / 10.0)), 0.016)
    solver = c2d.Solver(
        contact="reference" if draw.random() < 0.25 else "own",
        **how,
        iterations=draw.whole(1, 1000, (1, 8) if is_chain else (5, 60)),
        contact_frequency=draw.size(1.0, 1e5, (300.0, 3000.0)),
        contact_damping_ratio=draw.size(TINY, 100.0, (1.0, 10.0)),
        max_push_speed=draw.size(TINY, 100.0, (0.1, 1.0)),
        prediction_distance=draw.size(1e-5, 0.1, (1e-4, 1e-3)),
        restitution=0.0 if is_chain or draw.random() < 0.7 else draw.random(),
    )
    return solver, step


def drawn_scenario(draw: Draw) -> Scenario:
    """A short run, from nearly usual in all fields to usual in none."""
    draw.wild = draw.choice((0.03, 0.1, 0.3, 1.0))
    robot = drawn_robot(draw)
    size = 2.0 * smallest_end(robot.outline)
    fastest = robot.drivetrain.max_speed / smallest_end(robot.outline)
    if robot.flippers is not None:
        fastest = max(fastest, robot.flippers.rate_limit)
    solver, step = drawn_solver(draw, 0.3 / fastest, robot.track)
    duration = step * min(STEPS, draw.whole(1, STEPS, (30, STEPS)))
    approach = draw.size_or_zero(1e-12, 1e4, (1e-3 * size, 0.5 * size))
    reach = approach + 10.0 * (robot.outline.axle_distance + size) + 300.0 * draw.random()
    speed = robot.drivetrain.max_speed
    return Scenario(
        robot,
        drawn_terrain(draw, size, reach),
        drive=drawn_drive(draw, duration, speed, arms=robot.flippers is not None),
        start=c2d.Start(
            approach=approach,
            track_phase=draw.signed(1e4, size),
            angle=max(-1.5, min(1.5, draw.signed(1.5, math.pi / 6.0))),
        ),
        goal=draw.signed(1e7, size) if draw.random() < 0.3 else None,
        gravity=draw.size_or_zero(1e-12, 1e3, (0.5, 20.0)),
        duration=duration,
        solver=solver,
        criteria=drawn_criteria(draw, duration),
    )
