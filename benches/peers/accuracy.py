"""Equal accuracy: each engine's cheapest setting within the same error limits.

The rule, for one engine on one scene:

1. Its *limit* is its finest setting. Its path over the first draws is compared, at equal times,
   with that of the next finest setting, which is coarser in every respect by a factor of two; in
   crawler2d, whose steps are then twice as long, by a factor of four in accuracy. If they differ by
   more than 1 cm in any draw, the scene is *chaotic* for the engine.
2. Settings are tried in the order of their measured cost. One is rejected as soon as a draw exceeds
   1 mm of overlap with the ground or a pin gap of 0.2 mm, or the robot flies off.
3. If the scene is not chaotic, the path must stay within 1 cm of the limit's in each of the first
   draws. If it is, the 95 % Wilson interval of the setting's rate of clearing, over all draws, must
   contain the limit's rate over the same draws.

The first accepted setting is the cheapest. If there is none, the engine has no setting of that
accuracy in the grid. crawler2d has to do with its one default accuracy in every scene.
"""

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from benches.adapters.planar import (
    Array,
    Body,
    Draw,
    Engine,
    Motion,
    Scene,
    Setting,
    draws,
    load_engine,
    load_engines,
    load_scene,
    to_world,
)
from benches.shared.measuring import Key, interleaved
from benches.shared.results import progress
from crawler2d import wilson

PENETRATION = 1e-3
"""[m] Largest accurate overlap with the ground."""
JOINT_GAP = 0.2e-3
"""[m] Largest accurate gap of a pin."""
PATH = 0.01
"""[m] Largest accurate distance from the limit's path."""

# [s] Time between samples.
_INTERVAL = 0.002


class Errors(NamedTuple):
    """A run and its errors.

    Attributes
    ----------
    motion : Motion
        The recorded motion.
    penetration, gap : float
        [m] Deepest overlap with the ground, largest gap of a pin; infinite if the robot flew off.
    cleared : bool
        Whether the rear axle passed the last edge.
    """

    motion: Motion
    penetration: float
    gap: float
    cleared: bool

    @property
    def is_sound(self) -> bool:
        """Whether the bodies stay out of the ground and on their pins."""
        return self.penetration <= PENETRATION and self.gap <= JOINT_GAP


def measure(engine: Engine, scene: Scene, setting: Setting) -> Errors:
    """Run an engine and measure its errors, by the same geometry for all."""
    motion = engine.record(scene, setting, scene.duration, _INTERVAL)
    if not scene.keeps_course(motion):
        return Errors(motion, math.inf, math.inf, cleared=False)
    return Errors(
        motion,
        max(deepest_overlap(scene, motion), motion.penetration),
        joint_gap(scene, motion),
        scene.cleared(motion),
    )


def deepest_overlap(scene: Scene, motion: Motion) -> float:
    """[m] Deepest overlap of any part with the ground, over all samples."""
    ground = _Ground(scene.profile())
    deepest = 0.0
    for index, body in enumerate(scene.bodies):
        poses = motion.poses[:, index]
        if body.radius > 0.0:
            deepest = max(deepest, ground.circle_depth(poses[:, :2], body.radius))
        if body.polygons:
            deepest = max(deepest, _corner_depth(ground, body, poses))
            deepest = max(deepest, _edge_depth(ground, body, poses))
    return deepest


def joint_gap(scene: Scene, motion: Motion) -> float:
    """[m] Largest distance between the two points that a pin holds together."""
    gaps = [
        np.linalg.norm(
            to_world(motion.poses[:, joint.a], joint.pa)
            - to_world(motion.poses[:, joint.b], joint.pb),
            axis=1,
        ).max()
        for joint in scene.joints
    ]
    return float(max(gaps))


class _Ground:
    """The region below a profile of level tops and vertical faces."""

    def __init__(self, profile: Array) -> None:
        self._starts = profile[:-1]
        self._spans = np.diff(profile, axis=0)
        level = self._spans[:, 0] > 0.0
        self._lefts, self._tops = profile[:-1][level].T
        before, after = self._spans[:-1], self._spans[1:]
        convex = before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0] < 0.0
        self.edges = profile[1:-1][convex]

    def inside(self, points: Array) -> Array:
        """Return which points, shape (n, 2), lie below the profile."""
        column = np.searchsorted(self._lefts, points[:, 0], side="right") - 1
        return np.asarray(points[:, 1] < self._tops[np.maximum(column, 0)])

    def distance(self, points: Array) -> Array:
        """[m] Distance from points, shape (n, 2), to the profile."""
        away = points[:, None, :] - self._starts
        along = (away * self._spans).sum(-1) / (self._spans**2).sum(-1)
        nearest = away - np.clip(along, 0.0, 1.0)[..., None] * self._spans
        return np.asarray(np.sqrt((nearest**2).sum(-1)).min(axis=1))

    def circle_depth(self, centers: Array, radius: float) -> float:
        """[m] Deepest overlap of a circle, over all its centres."""
        centers = centers[centers[:, 1] < self._tops.max() + radius]
        if len(centers) == 0:
            return 0.0
        distance = self.distance(centers)
        depth = radius + np.where(self.inside(centers), distance, -distance)
        return float(max(depth.max(), 0.0))


def _corner_depth(ground: _Ground, body: Body, poses: Array) -> float:
    """[m] Largest depth of a body's corners in the ground, except those within its circle."""
    corners = np.concatenate(body.polygons)
    corners = corners[np.hypot(*corners.T) > body.radius]
    points = np.concatenate([to_world(poses, corner) for corner in corners])
    points = points[ground.inside(points)]
    return float(ground.distance(points).max()) if len(points) else 0.0


def _edge_depth(ground: _Ground, body: Body, poses: Array) -> float:
    """[m] Largest depth of the ground's edges in the polygons of a body."""
    reach = max(float(np.hypot(*polygon.T).max()) for polygon in body.polygons)
    deepest = 0.0
    for edge in ground.edges:
        away = edge - poses[:, :2]
        near = (away**2).sum(1) < reach**2
        cosine, sine = np.cos(poses[near, 2]), np.sin(poses[near, 2])
        x, y = away[near].T
        local = np.stack([cosine * x + sine * y, cosine * y - sine * x], axis=1)
        for polygon in body.polygons:
            if len(local):
                deepest = max(deepest, float(_depth_in(polygon, body.radius, local).max()))
    return deepest


def _depth_in(polygon: Array, radius: float, points: Array) -> Array:
    """[m] Return the depth of points in a convex polygon, negative outside.

    The side within the body's circle, the base of a grouser, does not count as a way out.
    """
    ends = np.roll(polygon, -1, axis=0)
    spans = ends - polygon
    covered = (np.hypot(*polygon.T) <= radius) & (np.hypot(*ends.T) <= radius)
    normals = np.stack([-spans[:, 1], spans[:, 0]], axis=1)
    normals /= np.hypot(*spans.T)[:, None]
    depths = ((points[:, None, :] - polygon) * normals).sum(-1)
    is_inside = (depths > 0.0).all(axis=1)
    return np.asarray(np.where(is_inside, depths[:, ~covered].min(axis=1), -1.0))


COST_SPAN = 2.5
"""[s] Simulated time of the first measurement of cost: up to the obstacle and onto it."""


@dataclass(frozen=True)
class Effort:
    """Effort of the search.

    Attributes
    ----------
    paths : int
        Number of draws whose paths are compared.
    ensemble : int
        Number of draws for a rate.
    finest_step : float
        [s] Time steps below this are not tried.
    """

    paths: int
    ensemble: int
    finest_step: float = 0.0


@dataclass(frozen=True)
class Limit:
    """The limit to which an engine converges.

    Attributes
    ----------
    spread : float
        [m] Largest distance between the paths of the two finest settings.
    paths : list of Motion
        Paths of the first draws.
    cleared, count : int
        Over the ensemble, or over the first draws if the scene is not chaotic.
    penetration, gap : float
        [m] Errors of the finest setting.
    """

    spread: float
    paths: list[Motion]
    cleared: int
    count: int
    penetration: float
    gap: float

    @property
    def is_chaotic(self) -> bool:
        """Whether single runs cannot be compared."""
        return self.spread > PATH


def search(engine: Engine, scene: Scene, draws: list[Draw], effort: Effort) -> dict[str, Any]:
    """Find the cheapest accurate setting of an engine on a scene.

    Returns
    -------
    dict
        `limit`, `tried` in the order of cost, and `found`: a setting's fields or None.
    """
    variants = [scene.vary(draw) for draw in draws[: effort.ensemble]]
    limit = find_limit(engine, variants, effort)
    kind = "chaotic" if limit.is_chaotic else "converged"
    progress(f"  {engine.name}: {kind}, finest settings {limit.spread * 1e3:.2f} mm apart")
    tried: list[dict[str, Any]] = []
    found = None
    for cost, setting in by_cost(engine, scene, effort):
        verdict = _verdict(engine, variants, setting, limit, effort)
        tried.append({"setting": str(setting), "cost": cost, **verdict})
        if verdict["accepted"]:
            found = asdict(setting)
            break
    outcome = tried[-1]["setting"] if found else "nothing"
    progress(f"  {engine.name}: {outcome} after {len(tried)} settings")
    kept = ("spread", "is_chaotic", "cleared", "count", "penetration", "gap")
    data = {name: getattr(limit, name) for name in kept}
    data["final_x"] = float(limit.paths[0].poses[-1, 0, 0])
    return {"limit": data, "tried": tried, "found": found}


def find_limit(engine: Engine, variants: list[Scene], effort: Effort) -> Limit:
    """Run the two finest settings, and the ensemble only if they differ."""
    first = [measure(engine, scene, engine.finest) for scene in variants[: effort.paths]]
    spread = max(
        measure(engine, scene, engine.next_finest).motion.distance(run.motion)
        for scene, run in zip(variants, first, strict=False)
    )
    runs = list(first)
    if spread > PATH:
        runs += [measure(engine, scene, engine.finest) for scene in variants[effort.paths :]]
    return Limit(
        spread,
        [run.motion for run in first],
        sum(run.cleared for run in runs),
        len(runs),
        max(run.penetration for run in runs),
        max(run.gap for run in runs),
    )


def by_cost(engine: Engine, scene: Scene, effort: Effort) -> list[tuple[float, Setting]]:
    """Sort the grid by wall time per simulated second, measured on the scene."""
    finest = effort.finest_step
    grid = [each for each in engine.grid if each.accuracy or each.time_step >= finest]
    costs = [engine.wall_time(scene, setting, COST_SPAN) / COST_SPAN for setting in grid]
    return sorted(zip(costs, grid, strict=True), key=lambda row: row[0])


def _verdict(
    engine: Engine, variants: list[Scene], setting: Setting, limit: Limit, effort: Effort
) -> dict[str, Any]:
    """Try a setting; stop at the first broken rule."""
    worst = {"penetration": 0.0, "gap": 0.0, "distance": 0.0}
    cleared, count = 0, effort.ensemble if limit.is_chaotic else effort.paths
    for index, scene in enumerate(variants[:count]):
        run = measure(engine, scene, setting)
        distance = run.motion.distance(limit.paths[index]) if index < effort.paths else 0.0
        for name, error in zip(worst, (run.penetration, run.gap, distance), strict=True):
            worst[name] = max(worst[name], error)
        cleared += run.cleared
        if not run.is_sound or (worst["distance"] > PATH and not limit.is_chaotic):
            return {**worst, "accepted": False}
    if not limit.is_chaotic:
        return {**worst, "accepted": True}
    _, low, high = wilson(cleared, count)
    accepted = low <= limit.cleared / limit.count <= high
    return {**worst, "accepted": accepted, "cleared": cleared, "count": count}


def wall_times(
    cases: Mapping[Key, tuple[Engine, Scene, Setting]], repeats: int
) -> dict[Key, float]:
    """Time whole runs of several engines, scenes and settings in turns."""
    jobs = {
        key: partial(engine.wall_time, scene, setting, scene.duration)
        for key, (engine, scene, setting) in cases.items()
    }
    return interleaved(jobs, repeats)


def equal_accuracy(name: str, effort: Effort, repeats: int) -> list[dict[str, Any]]:
    """Find each engine's cheapest accurate setting on a scene, then time them together."""
    progress(f"equal accuracy: {name}")
    scene, varied = load_scene(name), draws(effort.ensemble)
    found = {each.name: search(each, scene, varied, effort) for each in load_engines()}
    settings = {name: Setting(**each["found"]) for name, each in found.items() if each["found"]}
    cases = {name: (load_engine(name), scene, setting) for name, setting in settings.items()}
    times = wall_times(cases, repeats)
    rows = []
    for each, result in found.items():
        row = {"scene": name, "engine": each, **result}
        if each in times:
            row["per_second"] = times[each] / scene.duration
            row["setting"] = str(settings[each])
        rows.append(row)
    return rows
