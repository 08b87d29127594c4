"""Errors of a recorded motion: overlap with the ground, gaps of the pins.

The same geometry for every engine. It knows the scene and the poses, and nothing of any engine's
contacts.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from benches.peers.motion import Array, Motion
    from benches.peers.scenes import Body, Scene


def penetration(scene: Scene, motion: Motion) -> float:
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
            _to_world(motion.poses[:, joint.a], joint.pa)
            - _to_world(motion.poses[:, joint.b], joint.pb),
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
        """Which points, shape (n, 2), lie below the profile."""
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
    points = np.concatenate([_to_world(poses, corner) for corner in corners])
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
    """[m] How deep points lie in a convex polygon, negative outside.

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


def _to_world(poses: Array, point: tuple[float, float] | Array) -> Array:
    """[m] A point of a body in the world, shape (n, 2)."""
    cosine, sine = np.cos(poses[:, 2]), np.sin(poses[:, 2])
    x, y = point
    offset = np.stack([cosine * x - sine * y, sine * x + cosine * y], axis=1)
    return np.asarray(poses[:, :2] + offset)
