"""Plane geometry of the second judge: taut belts round circles, and the ground along its length.

The ground is met by arc length. A coordinate along x could not tell the foot of a vertical face
from its top, and so not what bears on a piece of ground from what bears beside it.
"""

import itertools
import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

# Between these directions a circle of 64 mm and its tangents differ by less than 0.1 um.
ANGLES = np.linspace(0.0, 2.0 * math.pi, 3600, endpoint=False)
# [m] Circles this close to a tangent carry it.
TOUCHING = 1e-9
# [m] Depths that differ by less are equal; the left edge counts.
EQUALLY_DEEP = 1e-6


def right_of(v: Array) -> Array:
    """Vectors turned by -90 degrees."""
    return np.stack([v[..., 1], -v[..., 0]], axis=-1)


def cross(a: Array, b: Array) -> Array:
    """The z components of products."""
    return np.asarray(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0])


def placed(circles: Array, x: float, y: float, angle: float) -> Array:
    """Transform circles, rows of x, y, radius, from the chassis frame by a pose."""
    c, s = math.cos(angle), math.sin(angle)
    turned = circles[:, :2] @ np.array([[c, s], [-s, c]])
    return np.column_stack([turned + np.array([x, y]), circles[:, 2]])


def nearest(point: Array, starts: Array, ends: Array) -> tuple[Array, Array]:
    """[-], [m] Position of a point along each of several lines, and its distance."""
    along = ends - starts
    squared = np.maximum((along**2).sum(axis=1), 1e-30)
    share = np.clip(((point - starts) * along).sum(axis=1) / squared, 0.0, 1.0)
    off = np.hypot(*(starts + share[:, None] * along - point).T)
    return share, np.asarray(off)


class WayRound:
    """The belt anticlockwise as a polyline with outward normals."""

    def __init__(self, points: Array, normals: Array) -> None:
        self.points, self.normals = points, normals
        self.ends = np.roll(points, -1, axis=0)
        self.lengths = np.hypot(*(self.ends - points).T)
        self.way = np.cumsum(self.lengths) - self.lengths
        self.total = float(self.lengths.sum())

    def along(self, point: Array) -> float:
        """[m] Position along the belt of the point nearest to a given one."""
        share, off = nearest(point, self.points, self.ends)
        k = int(off.argmin())
        return float(self.way[k] + share[k] * self.lengths[k])

    def nearest_between(self, point: Array, first: Array, last: Array) -> tuple[Array, Array]:
        """The nearest place to a point anticlockwise from one place to another, and its normal."""
        a, b = self.along(first), self.along(last)
        span = (b - a) % self.total
        start = (self.way - a) % self.total
        # Pieces that begin before the first place and extend beyond it are cut there.
        wraps = start + self.lengths > self.total
        low = np.where(wraps, self.total - start, 0.0)
        high = np.where(wraps, self.lengths, np.minimum(self.lengths, span - start))
        high = np.where(wraps, np.minimum(high, low + span), high)
        lengths = np.maximum(self.lengths, 1e-30)
        share, _ = nearest(point, self.points, self.ends)
        share = np.clip(share, low / lengths, np.maximum(high, low) / lengths)
        places = self.points + share[:, None] * (self.ends - self.points)
        off = np.hypot(*(places - point).T)
        off[high < low] = np.inf
        k = int(off.argmin())
        following = self.normals[(k + 1) % len(self.normals)]
        normal = self.normals[k] + share[k] * (following - self.normals[k])
        return places[k], normal / np.hypot(*normal)


class Hull:
    """The taut belt round circles, run by `inside` within them."""

    def __init__(self, circles: Array, inside: float = 0.0) -> None:
        self.centers, self.radii = circles[:, :2], circles[:, 2] - inside
        # Straight runs would be rounded between even directions, by 0.1 mm; theirs are added.
        # One direction twice would walk its run there, back and there again.
        angles = np.unique(np.round(np.concatenate([ANGLES, self._straight_runs()]), 12))
        self.directions = np.column_stack([np.cos(angles), np.sin(angles)])
        self.support = (self.directions @ self.centers.T + self.radii).max(axis=1)

    def _straight_runs(self) -> Array:
        """[rad] Outward normals of the straight runs."""
        i, j = np.array(list(itertools.permutations(range(len(self.radii)), 2))).reshape(-1, 2).T
        way = self.centers[j] - self.centers[i]
        distance = np.hypot(*way.T)
        shrinks = self.radii[i] - self.radii[j]
        apart = distance > abs(shrinks)  # else one circle holds the other
        i, way, shrinks, distance = i[apart], way[apart], shrinks[apart], distance[apart]
        angles = np.arctan2(way[:, 1], way[:, 0]) - np.arccos(shrinks / distance)
        u = np.column_stack([np.cos(angles), np.sin(angles)])
        reach = u @ self.centers.T + self.radii
        outermost = reach[np.arange(len(i)), i] > reach.max(axis=1) - TOUCHING
        return np.asarray(angles[outermost] % (2.0 * math.pi))

    @cached_property
    def way_round(self) -> WayRound:
        """Anticlockwise: where each run and arc begins and ends."""
        reach = self.directions @ self.centers.T + self.radii
        carries = reach > self.support[:, None] - TOUCHING
        # Several circles carry a straight run; it goes from the first to the last of them.
        ahead = -right_of(self.directions) @ self.centers.T
        first = np.where(carries, ahead, np.inf).argmin(axis=1)
        last = np.where(carries, ahead, -np.inf).argmax(axis=1)
        normals = np.repeat(self.directions, 2, axis=0)
        on = np.column_stack([first, last]).ravel()
        points = self.centers[on] + self.radii[on, None] * normals
        return WayRound(points, normals)

    def carriers(self, u: Array) -> list[int]:
        """The circles that the belt touches where it has an outward normal."""
        reach = self.centers @ u + self.radii
        return [int(i) for i in np.flatnonzero(reach > reach.max() - TOUCHING)]

    def depth(self, point: Array) -> float:
        """[m] Depth of a point inside; negative outside."""
        return float((self.support - self.directions @ point).min())

    def neighbours(self, place: Array, normal: Array) -> tuple[int, int]:
        """The circles on either side of a place of the belt; the same one twice on its arc."""
        ahead = -right_of(normal)
        on = sorted(self.carriers(normal), key=lambda i: float(self.centers[i] @ ahead))
        at = float(place @ ahead)
        before = [i for i in on if self.centers[i] @ ahead <= at + TOUCHING]
        behind = [i for i in on if self.centers[i] @ ahead >= at - TOUCHING]
        return (before or on)[-1], (behind or on)[0]


class Ground:
    """A polyline, parametrized by arc length."""

    def __init__(self, profile: Array) -> None:
        self.starts, self.ends = profile[:-1], profile[1:]
        self.lengths = np.hypot(*(self.ends - self.starts).T)
        self.way = np.cumsum(self.lengths) - self.lengths

    def along(self, points: Array) -> Array:
        """[m] Arc lengths of the nearest ground to some points."""
        along = self.ends - self.starts
        squared = np.maximum(self.lengths**2, 1e-30)
        apart = points[:, None] - self.starts
        share = np.clip((apart * along).sum(axis=2) / squared, 0.0, 1.0)
        off = np.linalg.norm(apart - share[..., None] * along, axis=2)
        k = off.argmin(axis=1)
        return np.asarray(self.way[k] + share[np.arange(len(k)), k] * self.lengths[k])

    def at(self, way: float) -> Array:
        """The point at an arc length."""
        k = max(int(np.searchsorted(self.way, way, side="right")) - 1, 0)
        share = (way - self.way[k]) / max(self.lengths[k], 1e-30)
        return np.asarray(self.starts[k] + share * (self.ends[k] - self.starts[k]))

    def inside(self, hull: Hull) -> list[list[tuple[float, float]]]:
        """[m] The stretches inside a belt, those that bound one connected piece together."""
        spans = self._spans(hull)
        if len(spans) < 2:
            return [[span] for span in spans]
        # The ground lies to the right of its own way: its rim on the belt runs clockwise from
        # where one stretch goes out to where another one, or itself, comes in.
        belt = hull.way_round
        comes_in, goes_out = np.array([[belt.along(self.at(x)) for x in span] for span in spans]).T
        follows = [int(((out - comes_in) % belt.total).argmin()) for out in goes_out]
        found, left = [], set(range(len(spans)))
        while left:
            first = k = min(left)
            piece: list[tuple[float, float]] = []
            while k in left:
                left.remove(k)
                piece.append(spans[k])
                k = follows[k]
            assert k == first, "the ground crosses itself"
            found.append(piece)
        return found

    def _spans(self, hull: Hull) -> list[tuple[float, float]]:
        spans: list[tuple[float, float]] = []
        room = hull.support - self.starts @ hull.directions.T
        rate = (self.ends - self.starts) @ hull.directions.T
        with np.errstate(divide="ignore", invalid="ignore"):
            share = room / rate
        low = np.where(rate < 0.0, share, -np.inf).max(axis=1)
        high = np.where(rate > 0.0, share, np.inf).min(axis=1)
        out = ((rate == 0.0) & (room < 0.0)).any(axis=1)
        low, high = np.maximum(low, 0.0), np.minimum(high, 1.0)
        for k in np.flatnonzero((low < high) & ~out):
            a, b = (self.way[k] + share * self.lengths[k] for share in (low[k], high[k]))
            if spans and a <= spans[-1][1] + TOUCHING:
                spans[-1] = (spans[-1][0], b)
            else:
                spans.append((a, b))
        return spans


@dataclass(frozen=True)
class Piece:
    """A connected piece of the ground inside the track."""

    spans: tuple[tuple[float, float], ...]
    """[m] The stretches of ground that bound it."""
    edge: Array
    """Where the edge is that stands out and reaches deepest."""
    root_normal: Array | None
    """Outward, of the root belt where the ground came in, nearest to the edge; None: above it."""
    neighbours: tuple[int, int]
    """The circles on either side of that place."""


def pieces(ground: Ground, edges: Array, tips: Array, roots: Array, depth: float) -> list[Piece]:
    """Every piece, with an edge that stands out, deeper than the criterion.

    `edges` are the corners that stand out, rows of x, y.
    """
    envelope, inner, root = Hull(tips), Hull(tips, depth), Hull(roots, depth)
    below_root = ground.inside(root)
    found = []
    ways = ground.along(edges)
    for spans in ground.inside(inner):
        among = edges[_within(ways, spans)]
        if not len(among):
            continue
        depths = np.array([envelope.depth(edge) for edge in among])
        edge = among[int(np.flatnonzero(depths > depths.max() - EQUALLY_DEEP)[0])]
        deep = [
            piece
            for piece in below_root
            if any(a <= d and c <= b for a, b in piece for c, d in spans)
        ]
        normal, neighbours = None, (0, 0)
        if deep:
            way = ground.along(edge[None])[0]
            piece = min(deep, key=lambda piece: _distance(way, piece))
            place, normal = _nearest_on_rim(ground, root.way_round, piece, edge)
            neighbours = root.neighbours(place, normal)
        found.append(Piece(tuple(spans), edge, normal, neighbours))
    return found


def _within(ways: Array, spans: list[tuple[float, float]]) -> NDArray[np.bool_]:
    return np.asarray(np.any([(ways >= a) & (ways <= b) for a, b in spans], axis=0))


def _distance(way: float, spans: list[tuple[float, float]]) -> float:
    return min(max(a - way, way - b) for a, b in spans)


def _nearest_on_rim(
    ground: Ground, belt: WayRound, piece: list[tuple[float, float]], point: Array
) -> tuple[Array, Array]:
    """The place of a belt round a piece nearest to a point of it, and the outward normal there."""
    # The belt runs anticlockwise from where a stretch comes in to where the one before went out.
    goes_out = [piece[-1][1], *(b for _, b in piece[:-1])]
    rims = [
        belt.nearest_between(point, ground.at(a), ground.at(b))
        for (a, _), b in zip(piece, goes_out, strict=True)
    ]
    return min(rims, key=lambda rim: float(np.hypot(*(rim[0] - point))))
