"""Quantities monitored during endless driving: numbers, pins, overlap with ground, speeds."""

import math
import random
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

import crawler2d as c2d
from crawler2d import _core
from crawler2d.common.bodies import POSE_COLUMNS, BodyKind
from crawler2d.parameters.scenario import Scenario
from crawler2d.runs.simulation import State

Array = NDArray[np.float64]

BETWEEN = 0.1
"""[s] From look to look."""
AT_ONCE = 20
"""Looks whose poses are computed together."""
FALL = 0.15
"""[m] What falls from so high, the height of the robot, is faster than its tracks."""
MIDDLE, REACH = 0.4, 1.4
"""[m] Where the obstacles are, about, and how far from there the robot turns back."""


@dataclass
class Seen:
    """The worst values of one or several robots."""

    seconds: float = 0.0
    pin_gap: float = 0.0  # [m]
    overlap: float = 0.0  # [m] by our own geometry
    penetration: float = 0.0  # [m] in the table of contacts
    speed: float = 0.0  # [-] speed of the tracks, relative to the command
    outcomes: Counter[str] = field(default_factory=Counter)
    faults: list[str] = field(default_factory=list)

    def add(self, other: "Seen") -> None:
        self.seconds += other.seconds
        for name in ("pin_gap", "overlap", "penetration", "speed"):
            setattr(self, name, max(getattr(self, name), getattr(other, name)))
        self.outcomes += other.outcomes
        self.faults += other.faults

    def judge(self, case: str) -> None:
        """Record values beyond their bounds."""
        bounds = {"pin_gap": 0.5e-3, "overlap": 2e-3, "penetration": 2e-3, "speed": 3.0}
        for name, bound in bounds.items():
            if (worst := getattr(self, name)) > bound:
                self.faults.append(f"{case}: {name} {worst:.3g}")

    def __str__(self) -> str:
        outcomes = ", ".join(f"{count} {name}" for name, count in self.outcomes.most_common())
        return (
            f"{self.seconds:.0f} s, pins {1e3 * self.pin_gap:.3f} mm, overlap"
            f" {1e3 * self.overlap:.4f} mm (said {1e3 * self.penetration:.4f}), speed"
            f" {self.speed:.2f}; {outcomes}"
        )


def off(points: Array, line: Array) -> Array:
    """[m] Distance of each point from a polyline."""
    begin, along = line[:-1], np.diff(line, axis=0)
    squared = np.maximum((along**2).sum(axis=1), 1e-300)
    spokes = points[:, None] - begin
    share = np.clip((spokes * along).sum(axis=-1) / squared, 0.0, 1.0)
    away = spokes - share[..., None] * along
    return np.asarray(np.hypot(away[..., 0], away[..., 1]).min(axis=1))


class Ground:
    """The ground under a robot, as one polyline from the left."""

    def __init__(self, profile: Array) -> None:
        self.profile = profile

    def near(self, low: float, high: float) -> Array:
        """The part between two positions, and a little more."""
        x = self.profile[:, 0]
        first = max(int(np.searchsorted(x, low)) - 1, 0)
        last = int(np.searchsorted(x, high, side="right")) + 1
        return self.profile[first:last]

    def overlap_of_discs(self, centers: Array, radii: Array) -> float:
        """[m] Depth of the deepest disc."""
        reach = radii.max()
        part = self.near(centers[:, 0].min() - reach, centers[:, 0].max() + reach)
        distance = off(centers, part)
        under = centers[:, 1] < np.interp(centers[:, 0], part[:, 0], part[:, 1])
        return float((radii + np.where(under, distance, -distance)).max())

    def overlap_of_polygons(self, polygons: Array) -> float:
        """[m] Depth of the deepest convex polygon, shape (n, corners, 2)."""
        x = polygons[..., 0]
        part = self.near(x.min(), x.max())
        corners = polygons.reshape(-1, 2)
        under = corners[:, 1] < np.interp(corners[:, 0], part[:, 0], part[:, 1])
        depth = float(off(corners[under], part).max()) if under.any() else 0.0
        # Edges of the ground that reach into a polygon: how far they are inside all of its sides.
        sides = np.roll(polygons, -1, axis=1) - polygons
        lengths = np.maximum(np.hypot(sides[..., 0], sides[..., 1]), 1e-12)
        normals = np.stack([-sides[..., 1], sides[..., 0]], axis=-1) / lengths[..., None]
        spokes = part[None, :, None] - polygons[:, None]
        inside = (spokes * normals[:, None]).sum(axis=-1).min(axis=-1)
        return max(depth, float(inside.max()))


class Side:
    """The bodies of a robot that can touch the ground of one lane, as discs and convex polygons."""

    def __init__(self, bodies: dict[str, Any], lane: int, profile: Array) -> None:
        self.ground = Ground(profile)
        touching = np.asarray(bodies["lane"]) == lane
        touching &= [not BodyKind(kind).is_in_chain for kind in bodies["kind"]]
        is_disc = ~np.isnan(bodies["radius"])
        self.discs = np.flatnonzero(touching & is_disc)
        self.radii = np.asarray(bodies["radius"])[self.discs]
        self.polygons = [
            (place, convex)
            for place in np.flatnonzero(touching & ~is_disc)
            for convex in pieces(bodies["outline"][place])
        ]

    def overlap(self, pose: Array) -> float:
        """[m] Depth of its deepest body in the ground."""
        worst = 0.0
        if len(self.discs):
            worst = self.ground.overlap_of_discs(pose[self.discs, :2], self.radii)
        by_corners: dict[int, list[Array]] = {}
        for place, convex in self.polygons:
            x, y, angle = pose[place]
            c, s = math.cos(angle), math.sin(angle)
            placed = convex @ np.array([[c, s], [-s, c]]) + (x, y)
            by_corners.setdefault(len(convex), []).append(placed)
        for some in by_corners.values():
            worst = max(worst, self.ground.overlap_of_polygons(np.array(some)))
        return worst


class Robot:
    """The bodies of a robot on all lanes."""

    def __init__(self, scenario: Scenario) -> None:
        self.text = scenario.to_json()
        geometry = _core.geometry(self.text)
        lanes = ((lane, np.asarray(profile)) for lane, profile in geometry["lanes"])
        self.sides = [Side(geometry["bodies"], lane, profile) for lane, profile in lanes]
        self.chains = 1 if len(self.sides) == 1 else 2

    def overlap(self, states: list[State]) -> float:
        """[m] Depth of its deepest body in the ground at several instants."""
        trace = {name: np.array([getattr(each, name) for each in states]) for name in POSE_COLUMNS}
        trace["time"] = np.array([each.time for each in states])
        poses = _core.poses(self.text, trace)["bodies"]
        return max(side.overlap(pose) for pose in poses for side in self.sides)

    def chains_of(self, state: State) -> list[Array]:
        """Poses of the shoes of each chain."""
        shoes = state.shoe_poses
        return np.split(shoes, self.chains) if len(shoes) else []


def _cross(one: Array, other: Array) -> Array:
    return np.asarray(one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0])


def pieces(outline: Array) -> Iterator[Array]:
    """A convex outline anticlockwise; others, such as that of a gear, as triangles."""
    after = np.roll(outline, -1, axis=0) - outline
    turns = _cross(after, np.roll(after, -1, axis=0))
    area = _cross(outline, np.roll(outline, -1, axis=0)).sum()
    if (turns * np.sign(area) > -1e-12).all():
        yield outline if area > 0.0 else outline[::-1]
        return
    middle = outline.mean(axis=0)
    for first, second in zip(outline, np.roll(outline, -1, axis=0), strict=True):
        triangle = np.array([middle, first, second])
        yield triangle if area > 0.0 else triangle[::-1]


def pitch_of(poses: Array) -> float:
    """[m] Distance of the pins, with which the chain closes best."""
    along = np.column_stack([np.cos(poses[:, 2]), np.sin(poses[:, 2])])
    between = np.roll(poses[:, :2], -1, axis=0) - poses[:, :2]
    halves = 0.5 * (along + np.roll(along, -1, axis=0))
    return float((between * halves).sum() / (halves**2).sum())


def pin_gap(poses: Array, pitch: float) -> float:
    """[m] Largest distance of the ends of two shoes with a common pin."""
    along = 0.5 * pitch * np.column_stack([np.cos(poses[:, 2]), np.sin(poses[:, 2])])
    gaps = np.roll(poses[:, :2] - along, -1, axis=0) - (poses[:, :2] + along)
    return float(np.hypot(*gaps.T).max())


def numbers(state: State) -> list[Any]:
    fields = ["time", "position", "velocity", "chassis_angle", "angular_velocity", "track_speed"]
    fields += ["commanded_speed", "drive_positions", "shoe_poses", "flipper_angles"]
    return [getattr(state, name) for name in fields] + [state.contacts[c] for c in state.contacts]


def driven(case: str, scenario: Scenario, seconds: float, draw: random.Random) -> Seen:
    """Drive to and fro over the obstacle, with other commands every second."""
    seen = Seen(seconds=seconds)
    robot, sim = Robot(scenario), c2d.Simulation(scenario)
    looks: list[State] = []
    way, fastest = 1.0, 0.0
    pitches = [pitch_of(chain) for chain in robot.chains_of(sim.state())]

    def close_looks() -> None:
        if looks:
            seen.overlap = max(seen.overlap, robot.overlap(looks))
            looks.clear()

    for number in range(round(seconds / BETWEEN)):
        if number % 10 == 0:
            speed = draw.uniform(0.1, 0.5)
            arms = {"flipper_angle": draw.uniform(-0.5, 1.0)} if scenario.robot.flippers else {}
            sim.command(speed=way * speed, **arms)
            fastest = max(speed, 0.5 * fastest)
        sim.advance(BETWEEN)
        state = sim.state()
        looks.append(state)
        where = f"{case} at {state.time:.1f} s"
        if not all(np.isfinite(values).all() for values in numbers(state)):
            seen.faults.append(f"{where}: no number")
        if len(state.contacts["penetration"]):
            seen.penetration = max(seen.penetration, float(state.contacts["penetration"].max()))
        for chain, pitch in zip(robot.chains_of(state), pitches, strict=True):
            seen.pin_gap = max(seen.pin_gap, pin_gap(chain, pitch))
        seen.speed = max(seen.speed, abs(state.track_speed) / fastest)
        falling = math.sqrt(2.0 * 9.81 * FALL)
        if math.hypot(*state.velocity) > 3.0 * fastest + falling and state.outcome is None:
            seen.faults.append(f"{where}: {math.hypot(*state.velocity):.2f} m/s")
        x = state.position[0]
        if x > MIDDLE + REACH:
            way = -1.0
        elif x < MIDDLE - REACH:
            way = 1.0
        lost = abs(state.chassis_angle) > 1.2 or abs(x - MIDDLE) > 2.0 * REACH
        detracked = state.outcome is c2d.Outcome.DETRACKED
        if lost or detracked or (number + 1) % 200 == 0:
            seen.outcomes[str(state.outcome)] += 1
            close_looks()
            sim.reset()
            way, fastest = 1.0, 0.0
            sim.command(speed=0.3)
            fastest = 0.3
        if len(looks) == AT_ONCE:
            close_looks()
    close_looks()
    seen.judge(case)
    return seen
